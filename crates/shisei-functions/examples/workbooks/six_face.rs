//! The second worked example: the six-face calibration, |a| before and after, and the six windows.

use crate::Done;
use crate::book::{Block, Book, recording};
use rust_xlsxwriter::{Chart, ChartFormat, ChartLine, ChartType, Formula, Worksheet};
use shisei_core::vector;
use shisei_functions::Input;

/// Where the chart draws the windows, m/s²: a strip below the curves.
const STRIP: f64 = 9.45;
const WINDOW_S: f64 = 3.0;

pub fn fill(book: &mut Book) -> Done {
    let mut sheet = Worksheet::new();
    sheet.set_name("Six faces")?;
    let data = recording(&mut sheet, "six-face.csv")?;
    let rows = data.rows();
    let (readings, last) = (data.part(0..rows, 0..6), rows + 1);
    let dt = Input::Number(0.01);
    let calib =
        book.formula(&mut sheet, (0, 8), &format!("GetIMUCalib(B2:G{last},0.01)"), &[readings.input(), dt])?;
    let corrected = book.formula(
        &mut sheet,
        (1, 8),
        &format!("ApplyIMUCalib(B2:G{last},I1:T1)"),
        &[readings.input(), calib.input()],
    )?;
    let mut faces = faces_sheet(book, &readings, last)?;
    norms(&mut sheet, &readings, &corrected)?;
    for (k, head) in ["t[s]", "|a| before", "|a| after", "window"].iter().enumerate() {
        sheet.write_string_with_format(0, 20 + k as u16, *head, &book.bold)?;
    }
    for face in faces.1.data.chunks(5).filter(|face| face[0] == 1.0) {
        let first = (face[1] / 0.01).round() as u32;
        for row in first..first + (WINDOW_S / 0.01) as u32 {
            sheet.write_number(1 + row, 23, STRIP)?;
        }
    }
    faces.0.insert_chart(9, 0, &chart(rows as u32))?;
    sheet.set_freeze_panes(1, 0)?;
    book.workbook.push_worksheet(faces.0);
    book.workbook.push_worksheet(sheet);
    Ok(())
}

/// |a| of every row as ordinary formulas.
fn norms(sheet: &mut Worksheet, before: &Block, after: &Block) -> Done {
    let norm = |row: &[f64]| vector::norm([row[0], row[1], row[2]]);
    for (i, (b, a)) in before.data.chunks(6).zip(after.data.chunks(6)).enumerate() {
        let (row, n) = (1 + i as u32, i + 2);
        sheet.write_number(row, 20, i as f64 * 0.01)?;
        let text = Formula::new(format!("=SQRT(SUMSQ(B{n}:D{n}))"));
        sheet.write_formula(row, 21, text.set_result(norm(b).to_string()))?;
        let text = Formula::new(format!("=SQRT(SUMSQ(I{n}:K{n}))"));
        sheet.write_formula(row, 22, text.set_result(norm(a).to_string()))?;
    }
    Ok(())
}

fn faces_sheet(
    book: &mut Book,
    readings: &Block,
    last: usize,
) -> Result<(Worksheet, Block), Box<dyn std::error::Error>> {
    let mut sheet = Worksheet::new();
    sheet.set_name("Faces")?;
    let heads = ["up / 上の面", "found / 検出", "start s", "worst variance", "tilt rad", "|a|"];
    for (k, head) in heads.iter().enumerate() {
        sheet.write_string_with_format(0, k as u16, *head, &book.bold)?;
    }
    for (k, face) in ["+x", "-x", "+y", "-y", "+z", "-z"].iter().enumerate() {
        sheet.write_string(1 + k as u32, 0, *face)?;
    }
    let text = format!("CalibFaces('Six faces'!B2:G{last},0.01)");
    let faces = book.formula(&mut sheet, (1, 1), &text, &[readings.input(), Input::Number(0.01)])?;
    sheet.set_column_width(0, 12)?;
    Ok((sheet, faces))
}

fn chart(rows: u32) -> Chart {
    let mut chart = Chart::new(ChartType::ScatterStraight);
    chart.title().set_name("|a| before and after, and the six windows / 補正前後の |a| と 6 つの区間");
    let series = [(21, "before / 補正前", "#BBBBBB"), (22, "after / 補正後", "#1F77B4")];
    for (col, name, colour) in series {
        let line = ChartLine::new().set_color(colour).set_width(0.75).clone();
        chart
            .add_series()
            .set_name(name)
            .set_categories(("Six faces", 1, 20, rows, 20))
            .set_values(("Six faces", 1, col, rows, col))
            .set_format(ChartFormat::new().set_line(&line));
    }
    let strip = ChartLine::new().set_color("#FF7F0E").set_width(5).clone();
    chart
        .add_series()
        .set_name("window / 区間")
        .set_categories(("Six faces", 1, 20, rows, 20))
        .set_values(("Six faces", 1, 23, rows, 23))
        .set_format(ChartFormat::new().set_line(&strip));
    chart.x_axis().set_name("t [s]");
    chart.y_axis().set_name("m/s²").set_min(9.4).set_max(10.2);
    chart.set_width(980).set_height(460);
    chart
}
