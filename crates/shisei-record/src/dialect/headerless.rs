//! Numbers without a header: six columns (acceleration and angular rate in either order), with a time or
//! counter before them and other columns after them allowed.
//!
//! The acceleration is the triple whose norm stays near one value; its unit comes from that value.

use super::Dialect;
use crate::names::{Meaning, Quantity};
use crate::plan::Reading;
use crate::recording::Note;
use crate::sheet::Sheet;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "headerless",
    name: "numbers without a header",
    recognises: |sheet| sheet.header.is_empty() && sheet.columns() >= 6,
    mend,
};

fn mend(sheet: &Sheet<'_>, reading: &mut Reading) {
    let columns = sheet.columns();
    let number = |row: &Vec<String>, column: usize| -> Option<f64> {
        let text = row.get(column)?.replace(char::from(sheet.decimal), ".");
        text.parse::<f64>().ok().filter(|v| v.is_finite())
    };
    let values =
        |column: usize| -> Option<Vec<f64>> { sheet.sample.iter().map(|r| number(r, column)).collect() };
    // Leading columns that only rise are time or counter; other text is passed over.
    let mut first = 0;
    let mut time = None;
    while first + 6 < columns {
        let is_time = match values(first) {
            Some(v) if v.windows(2).all(|w| w[1] >= w[0]) && v.first() < v.last() => {
                time.is_none() || v.windows(2).any(|w| w[1] - w[0] != 1.0)
            }
            Some(_) => break,
            None => {
                let cell = sheet.sample.first().and_then(|row| row.get(first));
                time.is_none() && cell.is_some_and(|cell| crate::stamp::parse(cell.as_bytes()).is_some())
            }
        };
        if is_time {
            time = Some(first);
        }
        first += 1;
    }
    if first + 6 > columns {
        return;
    }
    // Mean norm and its relative spread of both triples.
    let judge = |start: usize| -> Option<(f64, f64)> {
        let (x, y, z) = (values(start)?, values(start + 1)?, values(start + 2)?);
        let norms: Vec<f64> = (0..x.len()).map(|i| shisei_core::vector::norm([x[i], y[i], z[i]])).collect();
        let mean = norms.iter().sum::<f64>() / norms.len().max(1) as f64;
        let spread = norms.iter().map(|n| (n - mean) * (n - mean)).sum::<f64>() / norms.len().max(1) as f64;
        Some((mean, spread / (mean * mean).max(1e-12)))
    };
    let (Some(a), Some(b)) = (judge(first), judge(first + 3)) else { return };
    let known = |norm: f64| {
        [(0.8, 1.25), (7.8, 12.3), (850.0, 1180.0)].iter().any(|(low, high)| (*low..=*high).contains(&norm))
    };
    let acc_first = match (known(a.0), known(b.0)) {
        (true, false) => true,
        (false, true) => false,
        _ => a.1 <= b.1,
    };
    let (acc, gyro) = if acc_first { (first, first + 3) } else { (first + 3, first) };
    for (start, quantity) in [(acc, Quantity::Acceleration), (gyro, Quantity::AngularRate)] {
        for axis in 0..3u8 {
            if let Some(place) = reading.meanings.get_mut(start + usize::from(axis)) {
                *place = Meaning { quantity, axis: Some(axis), ..Meaning::other() };
            }
        }
    }
    if let Some(place) = time.and_then(|t| reading.meanings.get_mut(t)) {
        place.quantity = Quantity::Time;
    }
    reading.assumptions.push(Note::new(
        "columns-by-values",
        format!(
            "there is no header: columns {}–{} are taken as the acceleration (their norm stays near {:.3}), \
             {}–{} as the angular rate; --columns sets others",
            acc + 1,
            acc + 3,
            if acc_first { a.0 } else { b.0 },
            gyro + 1,
            gyro + 3
        ),
        format!(
            "見出しがないため、{}–{} 列を加速度 (ノルムがほぼ {:.3})、{}–{} 列を角速度とみなしました。--columns \
             で変更できます",
            acc + 1,
            acc + 3,
            if acc_first { a.0 } else { b.0 },
            gyro + 1,
            gyro + 3
        ),
    ));
}
