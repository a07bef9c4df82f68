//! The first worked example: the pelvis' yaw, pitch and roll, with the formulas as they are printed.

use crate::Done;
use crate::axes;
use crate::book::{Book, recording};
use rust_xlsxwriter::{Chart, ChartType, Worksheet};
use shisei_functions::Input;

pub fn fill(book: &mut Book) -> Done {
    let mut sheet = Worksheet::new();
    sheet.set_name("Pelvis")?;
    let data = recording(&mut sheet, "pelvis.csv")?;
    let rows = data.rows();
    for (col, head) in ["w", "x", "y", "z", "Yaw[rad]", "Pitch[rad]", "Roll[rad]", "t[s]"].iter().enumerate()
    {
        sheet.write_string_with_format(0, 8 + col as u16, *head, &book.bold)?;
    }
    // worksheet rows 2–301 are still; row 302 is the first of the motion
    let still = data.part(0..300, 0..3);
    let start = book.formula(
        &mut sheet,
        (300, 8),
        "Accs2InitialQuat(B2:D301,0.02,9.6,10)",
        &[still.input(), Input::Number(0.02), Input::Number(9.6), Input::Number(10.0)],
    )?;
    let (gyro, acc) = (data.part(300..rows, 3..6), data.part(300..rows, 0..3));
    let last = rows + 1;
    let moved = book.formula(
        &mut sheet,
        (301, 8),
        &format!("UpdateQuatsByMahony(I301:L301,E302:G{last},B302:D{last},0.01,2,0,9.80665)"),
        &[
            start.input(),
            gyro.input(),
            acc.input(),
            Input::Number(0.01),
            Input::Number(2.0),
            Input::Number(0.0),
            Input::Number(9.80665),
        ],
    )?;
    let mut all = start.clone();
    all.data.extend(&moved.data);
    book.formula(
        &mut sheet,
        (300, 12),
        &format!("Quats2WorldYprs(I301:L{last},I301:L301)"),
        &[all.input(), start.input()],
    )?;
    for row in 300..=rows as u32 {
        sheet.write_number(row, 15, f64::from(row - 300) * 0.01)?;
    }
    let mut chart = Chart::new(ChartType::ScatterStraight);
    chart.title().set_name("Yaw, pitch, roll / ヨー、ピッチ、ロール");
    for (k, name) in ["Yaw", "Pitch", "Roll"].iter().enumerate() {
        let col = 12 + k as u16;
        chart.add_series().set_name(*name).set_categories(("Pelvis", 300, 15, rows as u32, 15)).set_values((
            "Pelvis",
            300,
            col,
            rows as u32,
            col,
        ));
    }
    chart.x_axis().set_name("t [s]");
    chart.y_axis().set_name("rad");
    chart.set_width(820).set_height(420);
    sheet.insert_chart(302, 17, &chart)?;
    sheet.set_freeze_panes(1, 0)?;
    sheet.set_top_left_cell(298, 0)?;
    book.workbook.push_worksheet(sheet);
    Ok(axes::sheet(book)?)
}
