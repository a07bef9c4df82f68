//! Fits and what statistics say of them.

use alloc::vec::Vec;

use shisei_core::allan::{self, Coefficient};
use shisei_core::least_squares::{self as fit, Normal};
use shisei_core::{Vec3, math, matrix, sphere, statistics};

use crate::hash::Digest;
use crate::input::Input;

pub fn statistics(digest: &mut Digest) {
    let mut input = Input::new(40);
    for _ in 0..64 {
        let x = 10.0 * (1.0 + input.signed()) + 0.01;
        let p = 0.5 * (1.0 + input.signed());
        let a = 5.0 * (1.0 + input.signed()) + 0.1;
        digest.push_all(&[statistics::ln_gamma(x), statistics::gamma_p(a, x), statistics::beta_i(a, x, p)]);
        digest.push_all(&[statistics::chi_square_cdf(x, a), statistics::chi_square_quantile(p, x)]);
        digest.push_all(&[statistics::f_survival(p, x, a), statistics::student_one_sigma(x)]);
        let (low, high) = statistics::deviation_interval(x, 0.68);
        digest.push_all(&[low, high]);
    }
}

pub fn least_squares(digest: &mut Digest) {
    let mut input = Input::new(41);
    for _ in 0..32 {
        let mut normal = Normal::<4>::default();
        for _ in 0..8 {
            let [a, b, c] = input.vec3(1.0);
            normal.add(&[a, b, c, 1.0], input.signed(), 2.0);
        }
        digest.push_all(normal.matrix.as_flattened());
        digest.push_result(fit::inverse_spd(&normal.matrix), |digest, inverse| {
            digest.push_all(inverse.as_flattened());
        });
        digest.push(fit::quadratic_form(&normal.matrix, &normal.gradient));
    }
    curve_fit(digest, &mut input);
}

/// y = p₀ exp(p₁ x) + p₂ through points that scatter.
fn curve_fit(digest: &mut Digest, input: &mut Input) {
    let points: Vec<(f64, f64)> = (0..40)
        .map(|i| 0.05 * f64::from(i))
        .map(|x| (x, 2.0 * math::exp(-1.5 * x) + 0.3 + 0.01 * input.signed()))
        .collect();
    let found = fit::levenberg_marquardt([1.0, -1.0, 0.0], |p| {
        let mut normal = Normal::<3>::default();
        for &(x, y) in &points {
            let e = math::exp(p[1] * x);
            normal.add(&[e, p[0] * x * e, 1.0], p[0] * e + p[2] - y, 1.0);
        }
        normal
    });
    digest.push_result(found, |digest, found| {
        digest.push_all(&found.parameters);
        digest.push_all(found.inverse_normal.as_flattened());
        digest.push(found.cost);
        digest.push_u64(found.iterations as u64);
        if let Some(covariance) = found.covariance_from_residuals() {
            digest.push_all(covariance.as_flattened());
        }
    });
}

pub fn allan(digest: &mut Digest) {
    let mut input = Input::new(42);
    let mut walk = 0.0;
    let rate: Vec<f64> = (0..4000)
        .map(|_| {
            walk += 0.001 * input.signed();
            walk + 0.1 * input.signed()
        })
        .collect();
    for factor in [1, 7, 100] {
        digest.push_result(allan::overlapping_deviation(&rate, 0.01, factor), Digest::push);
        digest.push_result(allan::classical_deviation(&rate, 0.01, factor), Digest::push);
    }
    digest.push_result(allan::analyse(&rate, 0.01), |digest, analysis| {
        for point in &analysis.curve {
            digest.push_all(&[point.tau_s, point.deviation, point.low, point.high, point.degrees_of_freedom]);
        }
        let coefficients = [
            analysis.quantisation,
            analysis.random_walk,
            analysis.bias_instability,
            analysis.rate_random_walk,
        ];
        for Coefficient { value, sigma } in coefficients {
            digest.push_all(&[value, sigma]);
        }
        digest.push_all(&[analysis.floor, analysis.floor_tau_s]);
    });
}

pub fn matrix(digest: &mut Digest) {
    let mut input = Input::new(43);
    for _ in 0..16 {
        let a: matrix::Square<6> = core::array::from_fn(|_| core::array::from_fn(|_| input.signed()));
        let v: [f64; 6] = core::array::from_fn(|_| input.signed());
        let mut positive = matrix::product(&a, &matrix::transpose(&a));
        for i in 0..6 {
            positive[i][i] += 0.1;
        }
        digest.push_all(positive.as_flattened());
        digest.push_all(&matrix::times_vector(&a, &v));
        digest.push_result(matrix::inverse(&a), |digest, inverse| digest.push_all(inverse.as_flattened()));
        digest.push_result(matrix::cholesky(&positive), |digest, lower| {
            digest.push_all(lower.as_flattened());
            digest.push_all(&matrix::cholesky_solve(&lower, &v));
        });
        let (values, vectors) = matrix::symmetric_eigen(&positive);
        digest.push_all(&values);
        digest.push_all(vectors.as_flattened());
    }
}

pub fn sphere(digest: &mut Digest) {
    let mut input = Input::new(44);
    for flat in [1.0, 0.01] {
        let points: Vec<Vec3> = (0..12)
            .map(|_| {
                let [x, y, z] = input.quaternion().rotate([3.0, 0.0, 0.0]);
                let noise = input.vec3(0.01);
                [x + 1.0 + noise[0], y - 2.0 + noise[1], flat * z + noise[2]]
            })
            .collect();
        digest.push_result(sphere::fit_sphere(&points), |digest, fit| {
            digest.push_vec3(fit.center);
            digest.push_all(&[fit.radius, fit.residual_rms, fit.radius_sigma.unwrap_or(-1.0)]);
            digest.push_all(&[fit.condition, fit.plane_rms]);
        });
        digest.push_result(sphere::fit_circle(&points), |digest, fit| {
            digest.push_vec3(fit.center);
            digest.push_vec3(fit.normal);
            digest.push_all(&[fit.radius, fit.residual_rms, fit.radius_sigma.unwrap_or(-1.0)]);
            digest.push_all(&[fit.condition, fit.plane_rms]);
        });
    }
    digest.push_result(sphere::fit_sphere(&[[0.0; 3]; 3]).map(|_| ()), |_, ()| ());
}
