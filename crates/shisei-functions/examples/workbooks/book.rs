//! A workbook whose formulas carry their values.

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Formula, Workbook, Worksheet, XlsxError};
use serde_json::{Value, json};
use shisei_functions::{Input, Output, Range, find};
use std::path::Path;

/// Rows and columns from 0.
pub type At = (u32, u16);

/// A workbook being written.
pub struct Book {
    name: &'static str,
    pub workbook: Workbook,
    pub bold: Format,
    formulas: Vec<Value>,
}

/// A block of numbers, row-major.
#[derive(Clone, Debug)]
pub struct Block {
    pub data: Vec<f64>,
    pub cols: usize,
}

impl Block {
    pub fn rows(&self) -> usize {
        self.data.len() / self.cols.max(1)
    }

    pub fn input(&self) -> Input<'_> {
        Range::new(&self.data, self.rows(), self.cols).map_or(Input::Missing, Input::Range)
    }

    /// Some rows of some columns.
    pub fn part(&self, rows: std::ops::Range<usize>, cols: std::ops::Range<usize>) -> Block {
        let data = self.data.chunks(self.cols).skip(rows.start).take(rows.len());
        Block { data: data.flat_map(|row| row[cols.clone()].to_vec()).collect(), cols: cols.len() }
    }
}

impl Book {
    pub fn new(name: &'static str) -> Self {
        let mut workbook = Workbook::new();
        // a fixed date: the same bytes from the same input
        if let Ok(date) = ExcelDateTime::from_ymd(2026, 1, 1) {
            workbook.set_properties(&DocProperties::new().set_creation_datetime(&date));
        }
        Book { name, workbook, bold: Format::new().set_bold(), formulas: Vec::new() }
    }

    /// Calls a function of the table and writes the formula with its values. `text` is the call without `=`.
    pub fn formula(
        &mut self,
        sheet: &mut Worksheet,
        at: At,
        text: &str,
        inputs: &[Input<'_>],
    ) -> Result<Block, Box<dyn std::error::Error>> {
        let name = text.split('(').next().unwrap_or_default();
        let function = find(name).ok_or_else(|| format!("{name} is not in the table"))?;
        let output = function.call(inputs)?;
        let formula = Formula::new(format!("=_xll.{text}"));
        let (rows, cols) = output.shape();
        self.formulas.push(json!({
            "file": format!("{}.xlsx", self.name), "sheet": sheet.name(), "row": at.0, "col": at.1,
            "rows": rows, "cols": cols, "formula": format!("={}", text.replace(',', ";")),
        }));
        match output {
            Output::Truth(truth) => {
                let word = if truth { "TRUE" } else { "FALSE" };
                sheet.write_formula(at.0, at.1, formula.set_result(word))?;
                Ok(Block { data: vec![f64::from(u8::from(truth))], cols: 1 })
            }
            Output::Sentence(sentence) => {
                sheet.write_formula(at.0, at.1, formula.set_result(sentence))?;
                Ok(Block { data: vec![0.0], cols: 1 })
            }
            Output::Numbers { data, rows: 1, cols: 1 } => {
                sheet.write_formula(at.0, at.1, formula.set_result(data[0].to_string()))?;
                Ok(Block { data, cols: 1 })
            }
            Output::Numbers { data, rows, cols } => {
                let (last_row, last_col) = (at.0 + rows as u32 - 1, at.1 + cols as u16 - 1);
                let formula = formula.set_result(data[0].to_string());
                sheet.write_dynamic_array_formula(at.0, at.1, last_row, last_col, formula)?;
                let block = Block { data, cols };
                write_numbers(sheet, at, &block, true)?;
                Ok(block)
            }
        }
    }

    /// Saves the workbook; gives the formulas it holds.
    pub fn save(mut self, folder: &Path) -> Result<Vec<Value>, XlsxError> {
        self.workbook.save(folder.join(format!("{}.xlsx", self.name)))?;
        Ok(self.formulas)
    }
}

/// Numbers from a cell on; the first one is left to the formula that stands there. NaN is not available.
pub fn write_numbers(
    sheet: &mut Worksheet,
    at: At,
    block: &Block,
    formula_first: bool,
) -> Result<(), XlsxError> {
    for (i, &x) in block.data.iter().enumerate() {
        let (row, col) = (at.0 + (i / block.cols) as u32, at.1 + (i % block.cols) as u16);
        if x.is_finite() && !(formula_first && i == 0) {
            sheet.write_number(row, col, x)?;
        }
    }
    Ok(())
}

/// The columns Time … Temp of a recording of `examples/`, written as they stand; gives the numbers.
pub fn recording(sheet: &mut Worksheet, name: &str) -> Result<Block, Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name);
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut data = Vec::new();
    for (row, line) in text.lines().enumerate() {
        for (col, cell) in line.split(',').enumerate() {
            let (row, col) = (row as u32, col as u16);
            match cell.parse::<f64>() {
                Ok(x) if row > 0 => {
                    sheet.write_number(row, col, x)?;
                    data.push(x);
                }
                _ => {
                    sheet.write_string(row, col, cell)?;
                }
            }
        }
    }
    Ok(Block { data, cols: 7 })
}

/// `A1` of a cell.
pub fn address((row, col): At) -> String {
    let mut name = String::new();
    let mut col = u32::from(col) + 1;
    while col > 0 {
        let letter = char::from(b'A' + ((col - 1) % 26) as u8);
        name.insert(0, letter);
        col = (col - 1) / 26;
    }
    format!("{name}{}", row + 1)
}
