//! Small dense matrices of a fixed size: what the fits need, in a fixed order of operations.

use crate::error::{Error, Result};
use crate::math;

/// N × N, rows first.
pub type Square<const N: usize> = [[f64; N]; N];

/// The identity.
pub fn identity<const N: usize>() -> Square<N> {
    let mut m = [[0.0; N]; N];
    for i in 0..N {
        m[i][i] = 1.0;
    }
    m
}

/// M v.
pub fn times_vector<const N: usize>(m: &Square<N>, v: &[f64; N]) -> [f64; N] {
    let mut out = [0.0; N];
    for i in 0..N {
        for j in 0..N {
            out[i] += m[i][j] * v[j];
        }
    }
    out
}

/// A B.
pub fn product<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    let mut out = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            for k in 0..N {
                out[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    out
}

/// Mᵀ.
pub fn transpose<const N: usize>(m: &Square<N>) -> Square<N> {
    let mut out = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            out[j][i] = m[i][j];
        }
    }
    out
}

/// The inverse, by Gauss and Jordan with the largest pivot of each column; refused ([`Error::Degenerate`]) when
/// a pivot is below 1e-13 of its row's largest entry at the start, or anything is not finite.
pub fn inverse<const N: usize>(m: &Square<N>) -> Result<Square<N>> {
    let mut a = *m;
    let mut out = identity::<N>();
    let mut row_scale = [0.0; N];
    for i in 0..N {
        row_scale[i] = a[i].iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if row_scale[i] == 0.0 || a[i].iter().any(|x| !x.is_finite()) {
            return Err(Error::Degenerate);
        }
    }
    for column in 0..N {
        let mut pivot = column;
        for i in column + 1..N {
            if a[i][column].abs() * row_scale[pivot] > a[pivot][column].abs() * row_scale[i] {
                pivot = i;
            }
        }
        a.swap(column, pivot);
        out.swap(column, pivot);
        row_scale.swap(column, pivot);
        let p = a[column][column];
        if p.is_nan() || p.abs() <= 1e-13 * row_scale[column] {
            return Err(Error::Degenerate);
        }
        for j in 0..N {
            a[column][j] /= p;
            out[column][j] /= p;
        }
        for i in 0..N {
            if i != column {
                let factor = a[i][column];
                for j in 0..N {
                    a[i][j] -= factor * a[column][j];
                    out[i][j] -= factor * out[column][j];
                }
            }
        }
    }
    if out.iter().flatten().any(|x| !x.is_finite()) { Err(Error::Degenerate) } else { Ok(out) }
}

/// L of `M = L Lᵀ`, for a symmetric positive definite M (its lower half is read); refused
/// ([`Error::Degenerate`]) for any other.
pub fn cholesky<const N: usize>(m: &Square<N>) -> Result<Square<N>> {
    let mut l = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let mut sum = m[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            if i == j {
                if !(sum > 0.0 && sum.is_finite()) {
                    return Err(Error::Degenerate);
                }
                l[i][i] = math::sqrt(sum);
            } else {
                l[i][j] = sum / l[j][j];
            }
        }
    }
    Ok(l)
}

/// x of `L Lᵀ x = b`.
pub fn cholesky_solve<const N: usize>(l: &Square<N>, b: &[f64; N]) -> [f64; N] {
    let mut x = *b;
    for i in 0..N {
        for k in 0..i {
            x[i] -= l[i][k] * x[k];
        }
        x[i] /= l[i][i];
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] -= l[k][i] * x[k];
        }
        x[i] /= l[i][i];
    }
    x
}

/// Eigenvalues, ascending, and eigenvectors (columns, unit length) of a symmetric matrix, by Jacobi's
/// rotations. Entries must be finite; the lower half is taken to equal the upper one.
pub fn symmetric_eigen<const N: usize>(m: &Square<N>) -> ([f64; N], Square<N>) {
    let mut a = *m;
    let mut vectors = identity::<N>();
    for _ in 0..60 {
        let mut off = 0.0;
        let mut all = 0.0;
        for i in 0..N {
            for j in 0..N {
                all += a[i][j].abs();
                if i != j {
                    off += a[i][j].abs();
                }
            }
        }
        // not representable beside the diagonal any more
        if off <= 1e-18 * all {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut vectors, p, q);
            }
        }
    }
    sort_eigen(&a, &vectors)
}

/// One Jacobi rotation, which makes `a[p][q]` zero.
fn rotate<const N: usize>(a: &mut Square<N>, vectors: &mut Square<N>, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let root = math::hypot(theta, 1.0);
    let t = if theta >= 0.0 { 1.0 / (theta + root) } else { 1.0 / (theta - root) };
    let c = 1.0 / math::sqrt(t * t + 1.0);
    let s = t * c;
    for k in 0..N {
        let (x, y) = (a[k][p], a[k][q]);
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for k in 0..N {
        let (x, y) = (a[p][k], a[q][k]);
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
    }
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    for k in 0..N {
        let (x, y) = (vectors[k][p], vectors[k][q]);
        vectors[k][p] = c * x - s * y;
        vectors[k][q] = s * x + c * y;
    }
}

fn sort_eigen<const N: usize>(a: &Square<N>, vectors: &Square<N>) -> ([f64; N], Square<N>) {
    let mut order = [0; N];
    for i in 0..N {
        order[i] = i;
        let mut k = i;
        while k > 0 && a[order[k]][order[k]] < a[order[k - 1]][order[k - 1]] {
            order.swap(k, k - 1);
            k -= 1;
        }
    }
    let mut values = [0.0; N];
    let mut sorted = [[0.0; N]; N];
    for (column, &from) in order.iter().enumerate() {
        values[column] = a[from][from];
        for i in 0..N {
            sorted[i][column] = vectors[i][from];
        }
    }
    (values, sorted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Condition number about 1e5 and integer entries, so that products are exact: the 5 × 5 Hilbert matrix
    /// times 2520, whose inverse is known.
    fn hilbert() -> Square<5> {
        let mut m = [[0.0; 5]; 5];
        for i in 0..5 {
            for j in 0..5 {
                m[i][j] = 2520.0 / (i + j + 1) as f64;
            }
        }
        m
    }

    /// The Hilbert matrix's inverse is published (integer entries): D.-L. Choi 1983.
    const INVERSE_HILBERT_5: Square<5> = [
        [25.0, -300.0, 1050.0, -1400.0, 630.0],
        [-300.0, 4800.0, -18900.0, 26880.0, -12600.0],
        [1050.0, -18900.0, 79380.0, -117600.0, 56700.0],
        [-1400.0, 26880.0, -117600.0, 179200.0, -88200.0],
        [630.0, -12600.0, 56700.0, -88200.0, 44100.0],
    ];

    #[test]
    fn inverse_of_a_hilbert_matrix() {
        let inverse = inverse(&hilbert()).unwrap();
        for i in 0..5 {
            for j in 0..5 {
                let expected = INVERSE_HILBERT_5[i][j] / 2520.0;
                assert!((inverse[i][j] / expected - 1.0).abs() < 1e-10, "{i} {j}: {}", inverse[i][j]);
            }
        }
    }

    #[test]
    fn cholesky_solves() {
        let l = cholesky(&hilbert()).unwrap();
        let x = cholesky_solve(&l, &[2520.0, 0.0, 0.0, 0.0, 0.0]);
        for i in 0..5 {
            assert!((x[i] / INVERSE_HILBERT_5[i][0] - 1.0).abs() < 1e-10);
        }
        assert_eq!(cholesky(&[[1.0, 2.0], [2.0, 1.0]]), Err(Error::Degenerate));
    }

    #[test]
    fn eigenvalues_of_a_second_difference_matrix() {
        // tridiagonal −1, 2, −1 of size 4: 2 − 2 cos(kπ/5), which are whole numbers ∓ the golden ratio
        let m =
            [[2.0, -1.0, 0.0, 0.0], [-1.0, 2.0, -1.0, 0.0], [0.0, -1.0, 2.0, -1.0], [0.0, 0.0, -1.0, 2.0]];
        let (values, vectors) = symmetric_eigen(&m);
        let golden = 1.618033988749895;
        let expected = [2.0 - golden, 3.0 - golden, 1.0 + golden, 2.0 + golden];
        for k in 0..4 {
            assert!((values[k] - expected[k]).abs() < 1e-14);
            let column = [vectors[0][k], vectors[1][k], vectors[2][k], vectors[3][k]];
            let image = times_vector(&m, &column);
            for i in 0..4 {
                assert!((image[i] - values[k] * column[i]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert_eq!(inverse(&[[1.0, 2.0], [2.0, 4.0]]), Err(Error::Degenerate));
        assert_eq!(inverse(&[[0.0, 0.0], [0.0, 1.0]]), Err(Error::Degenerate));
        assert_eq!(inverse(&[[f64::NAN, 0.0], [0.0, 1.0]]), Err(Error::Degenerate));
    }
}
