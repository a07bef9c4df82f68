//! Fewer rows, same picture: each bucket of rows keeps the row of every column's least and greatest value.
//!
//! What a plot of all rows shows at any zoom coarser than a bucket, a plot of the kept rows shows too. Kept
//! rows are rows of the recording; nothing is averaged, so a value read under the cursor was measured.

use crate::column::Column;

/// Row numbers to draw, ascending, at most `max_rows` (but never fewer than one bucket's worth).
///
/// Rows whose x is not finite or goes back are left out. Each bucket keeps its first row, the rows of
/// every column's minimum and maximum, and, where some value is not finite, the first such row, so that
/// holes stay visible. With no more than `max_rows` usable rows all are kept.
pub fn keep_rows(x: &Column<'_>, columns: &[&Column<'_>], max_rows: usize) -> Vec<usize> {
    let rows = usable_rows(x);
    if rows.len() <= max_rows {
        return rows;
    }
    // a bucket may keep: first row, first hole, two per column; the last row of all is kept besides
    let per_bucket = 2 + 2 * columns.len();
    let buckets = (max_rows.saturating_sub(1) / per_bucket).max(1);
    let mut kept = Vec::with_capacity(buckets * per_bucket + 1);
    let mut bucket_rows = Vec::with_capacity(per_bucket);
    for bucket in 0..buckets {
        let from = rows.len() * bucket / buckets;
        let to = rows.len() * (bucket + 1) / buckets;
        let Some(bucket_range) = rows.get(from..to) else { continue };
        bucket_rows.clear();
        bucket_rows.extend(bucket_range.first().copied());
        let mut hole: Option<usize> = None;
        for column in columns {
            let extremes = extreme_rows(column, bucket_range);
            bucket_rows.extend(extremes.least);
            bucket_rows.extend(extremes.greatest);
            hole = match (hole, extremes.first_hole) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
        }
        bucket_rows.extend(hole);
        bucket_rows.sort_unstable();
        bucket_rows.dedup();
        kept.extend_from_slice(&bucket_rows);
    }
    if let Some(&last) = rows.last()
        && kept.last() != Some(&last)
    {
        kept.push(last);
    }
    kept
}

/// About evenly spaced row numbers, at most `max_rows`, with the first and the last.
pub fn even_rows(x: &Column<'_>, max_rows: usize) -> Vec<usize> {
    let rows = usable_rows(x);
    let max_rows = max_rows.max(2);
    if rows.len() <= max_rows {
        return rows;
    }
    (0..max_rows).filter_map(|k| rows.get(k * (rows.len() - 1) / (max_rows - 1)).copied()).collect()
}

fn usable_rows(x: &Column<'_>) -> Vec<usize> {
    let mut last = f64::NEG_INFINITY;
    let usable = |row: &usize| {
        let value = x.get(*row);
        let forward = value.is_finite() && value >= last;
        if forward {
            last = value;
        }
        forward
    };
    (0..x.len()).filter(usable).collect()
}

struct Extremes {
    least: Option<usize>,
    greatest: Option<usize>,
    first_hole: Option<usize>,
}

fn extreme_rows(column: &Column<'_>, rows: &[usize]) -> Extremes {
    let mut found = Extremes { least: None, greatest: None, first_hole: None };
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for &row in rows {
        let value = column.get(row);
        if value.is_finite() {
            if value < least {
                least = value;
                found.least = Some(row);
            }
            if value > greatest {
                greatest = value;
                found.greatest = Some(row);
            }
        } else if found.first_hole.is_none() {
            found.first_hole = Some(row);
        }
    }
    found
}

/// At most `max_spans` intervals that cover the given ones: sorted, overlaps joined, and then the nearest
/// neighbours joined until few enough are left. Intervals that are not finite or end before they start are
/// left out.
pub fn merge_spans(spans: &[(f64, f64)], max_spans: usize) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> =
        spans.iter().copied().filter(|(a, b)| a.is_finite() && b.is_finite() && a <= b).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let joined = join_nearer_than(&sorted, 0.0);
    if joined.len() <= max_spans.max(1) {
        return joined;
    }
    let mut distances: Vec<f64> = joined.windows(2).map(|w| w[1].0 - w[0].1).collect();
    distances.sort_by(f64::total_cmp);
    let cut = distances.get(joined.len() - max_spans.max(1) - 1).copied().unwrap_or(f64::INFINITY);
    join_nearer_than(&joined, cut)
}

fn join_nearer_than(sorted: &[(f64, f64)], distance: f64) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for &(from, to) in sorted {
        match out.last_mut() {
            Some(last) if from - last.1 <= distance => last.1 = last.1.max(to),
            _ => out.push((from, to)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fixed sequence of numbers in −1 … 1 (Lehmer, 48271 mod 2³¹ − 1).
    fn noise(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..n)
            .map(|_| {
                state = state * 48271 % 2147483647;
                state as f64 / 1073741823.5 - 1.0
            })
            .collect()
    }

    #[test]
    fn every_bucket_keeps_every_extreme() {
        let n = 100_003;
        let x: Vec<f64> = (0..n).map(|k| k as f64 * 0.01).collect();
        let mut a = noise(n, 7);
        a[54_321] = 99.0;
        a[54_322] = -99.0;
        let b = noise(n, 11);
        let columns = [Column::Slice(&a), Column::Slice(&b)];
        let refs: Vec<&Column<'_>> = columns.iter().collect();
        let kept = keep_rows(&Column::Slice(&x), &refs, 3_000);
        assert!(kept.len() <= 3_000, "{}", kept.len());
        assert!(kept.windows(2).all(|w| w[0] < w[1]));
        assert!(kept.contains(&54_321) && kept.contains(&54_322));
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, n - 1));
        let buckets = 2_999 / 6;
        for bucket in 0..buckets {
            let (from, to) = (n * bucket / buckets, n * (bucket + 1) / buckets);
            for column in [&a, &b] {
                let all = column[from..to].iter();
                let (least, greatest) = all.fold((f64::MAX, f64::MIN), |(l, g), &v| (l.min(v), g.max(v)));
                let seen = || kept.iter().filter(|&&r| (from..to).contains(&r)).map(|&r| column[r]);
                assert!(seen().any(|v| v == least) && seen().any(|v| v == greatest));
            }
        }
    }

    #[test]
    fn short_series_are_kept_whole_and_bad_times_left_out() {
        let x = [0.0, 1.0, f64::NAN, 0.5, 2.0, f64::INFINITY, 2.0, 3.0];
        let y = [0.0; 8];
        let kept = keep_rows(&Column::Slice(&x), &[&Column::Slice(&y)], 100);
        assert_eq!(kept, [0, 1, 4, 6, 7]);
        assert!(keep_rows(&Column::Slice(&[]), &[], 10).is_empty());
    }

    #[test]
    fn holes_stay_visible() {
        let n = 10_000;
        let x: Vec<f64> = (0..n).map(|k| k as f64).collect();
        let mut y = noise(n, 3);
        y[7_777] = f64::NAN;
        let all_nan = vec![f64::NAN; n];
        let kept = keep_rows(&Column::Slice(&x), &[&Column::Slice(&y), &Column::Slice(&all_nan)], 500);
        assert!(kept.iter().any(|&r| y[r].is_nan()) || kept.iter().any(|&r| all_nan[r].is_nan()));
        let kept = keep_rows(&Column::Slice(&x), &[&Column::Slice(&y)], 500);
        assert!(kept.contains(&7_777));
    }

    #[test]
    fn even_rows_span_the_recording() {
        let x: Vec<f64> = (0..1_000).map(f64::from).collect();
        let rows = even_rows(&Column::Slice(&x), 11);
        assert_eq!(rows, [0, 99, 199, 299, 399, 499, 599, 699, 799, 899, 999]);
        assert_eq!(even_rows(&Column::Slice(&x), 5_000).len(), 1_000);
    }

    #[test]
    fn spans_join_and_stay_few() {
        let spans = [(5.0, 6.0), (0.0, 1.0), (0.5, 2.0), (f64::NAN, 1.0), (9.0, 8.0)];
        assert_eq!(merge_spans(&spans, 10), [(0.0, 2.0), (5.0, 6.0)]);
        let many: Vec<(f64, f64)> = (0..100_000).map(|k| (f64::from(k), f64::from(k) + 0.25)).collect();
        let few = merge_spans(&many, 50);
        assert!(few.len() <= 50);
        assert_eq!((few[0].0, few[few.len() - 1].1), (0.0, 99_999.25));
        let uneven = [(0.0, 1.0), (1.1, 2.0), (50.0, 51.0)];
        assert_eq!(merge_spans(&uneven, 2), [(0.0, 2.0), (50.0, 51.0)]);
    }
}
