//! A picture of the axes and of yaw, pitch and roll, drawn as a chart.

use crate::book::Book;
use rust_xlsxwriter::{Chart, ChartFormat, ChartLine, ChartMarker, ChartType, Worksheet, XlsxError};
use shisei_core::math;

const COLOURS: [&str; 3] = ["#D62728", "#2CA02C", "#1F77B4"];
const STEPS: usize = 24;

/// Seen from above, left and in front: x to the viewer, y to the left, z up.
fn project([x, y, z]: [f64; 3]) -> [f64; 2] {
    [0.80 * -y - 0.45 * x, 0.95 * z + 0.22 * y - 0.42 * x]
}

/// A three-quarter turn about axis k, at 0.7 along it, right-handed.
fn arc(k: usize) -> Vec<[f64; 2]> {
    let point = |i: usize| {
        let (sin, cos) = math::sin_cos(4.7 * i as f64 / STEPS as f64);
        let mut p = [0.0; 3];
        p[k] = 0.7;
        p[(k + 1) % 3] = 0.22 * cos;
        p[(k + 2) % 3] = 0.22 * sin;
        project(p)
    };
    (0..=STEPS).map(point).collect()
}

fn axis(k: usize) -> Vec<[f64; 2]> {
    let mut tip = [0.0; 3];
    tip[k] = 1.0;
    vec![project([0.0; 3]), project(tip)]
}

/// A sheet with the picture and what it says.
pub fn sheet(book: &mut Book) -> Result<(), XlsxError> {
    let bold = book.bold.clone();
    let mut sheet = Worksheet::new();
    sheet.set_name("Axes")?;
    let lines = [
        (
            "World axes: right-handed, z up. A level sensor at rest reads (0, 0, +9.80665) m/s².",
            "ワールド座標系: 右手系、z が上。水平に静止したセンサの値は (0, 0, +9.80665) m/s² です。",
        ),
        (
            "Yaw turns about z, then pitch about y, then roll about x; each positive as the arcs show.",
            "ヨーは z、次にピッチは y、次にロールは x まわりの回転で、弧の向きが正です。",
        ),
        (
            "The sensor need not be mounted along these axes: the turn since the start is what is shown.",
            "センサをこの軸に合わせて取り付ける必要はありません。開始時からの回転を表示します。",
        ),
    ];
    sheet.write_string_with_format(0, 0, "x, y, z; yaw, pitch, roll", &bold)?;
    for (i, (en, ja)) in lines.iter().enumerate() {
        sheet.write_string(1 + 2 * i as u32, 0, *en)?;
        sheet.write_string(2 + 2 * i as u32, 0, *ja)?;
    }
    let mut chart = Chart::new(ChartType::ScatterStraight);
    chart.title().set_name("x, y, z");
    let names = [["x", "roll"], ["y", "pitch"], ["z", "yaw"]];
    for k in 0..3 {
        for (part, points) in [axis(k), arc(k)].into_iter().enumerate() {
            let col = 20 + 2 * (2 * k + part) as u16;
            sheet.write_string(0, col, names[k][part])?;
            for (i, [u, v]) in points.iter().enumerate() {
                sheet.write_number(1 + i as u32, col, *u)?;
                sheet.write_number(1 + i as u32, col + 1, *v)?;
            }
            let last = points.len() as u32;
            let width = if part == 0 { 2.5 } else { 1.25 };
            let line = ChartLine::new().set_color(COLOURS[k]).set_width(width).clone();
            chart
                .add_series()
                .set_name(names[k][part])
                .set_categories(("Axes", 1, col, last, col))
                .set_values(("Axes", 1, col + 1, last, col + 1))
                .set_marker(ChartMarker::new().set_none())
                .set_format(ChartFormat::new().set_line(&line));
        }
    }
    chart.x_axis().set_min(-1.2).set_max(1.2).set_hidden(true);
    chart.y_axis().set_min(-0.8).set_max(1.2).set_hidden(true).set_major_gridlines(false);
    chart.set_width(560).set_height(420);
    sheet.insert_chart(8, 0, &chart)?;
    book.workbook.push_worksheet(sheet);
    Ok(())
}
