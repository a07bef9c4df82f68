//! Every function of the table with its example, alive.

use crate::Done;
use crate::book::{Block, Book, address, write_numbers};
use rust_xlsxwriter::{Format, Worksheet};
use shisei_functions::{ExampleArg, FUNCTIONS, Function, Input};

pub fn fill(book: &mut Book) -> Done {
    let mut sheet = Worksheet::new();
    sheet.set_name("Tour")?;
    sheet.write_string_with_format(0, 0, "All functions with an example / すべての関数と例", &book.bold)?;
    let mut row = 2;
    let mut group = None;
    for function in &FUNCTIONS {
        if group != Some(function.group) {
            group = Some(function.group);
            let title = function.group.title();
            let heading = Format::new().set_bold().set_font_size(14);
            sheet.write_string_with_format(row, 0, format!("{} / {}", title.en, title.ja), &heading)?;
            row += 2;
        }
        row = block(book, &mut sheet, row, function)? + 2;
    }
    sheet.set_column_width(0, 16)?;
    book.workbook.push_worksheet(sheet);
    Ok(())
}

/// Name and help; then, side by side, every argument under its name, and the result. Gives the row after.
fn block(
    book: &mut Book,
    sheet: &mut Worksheet,
    row: u32,
    function: &Function,
) -> Result<u32, Box<dyn std::error::Error>> {
    sheet.write_string_with_format(row, 0, function.name, &book.bold)?;
    sheet.write_string(row, 1, function.doc.en)?;
    sheet.write_string(row + 1, 1, function.doc.ja)?;
    let (names, values) = (row + 2, row + 3);
    let (mut col, mut height) = (1_u16, 1);
    let (mut words, mut inputs) = (Vec::new(), Vec::new());
    for (arg, given) in function.args.iter().zip(function.example.args) {
        sheet.write_string_with_format(names, col, arg.name, &Format::new().set_italic())?;
        let block = match *given {
            ExampleArg::Missing => continue,
            ExampleArg::Number(x) => Block { data: vec![x], cols: 1 },
            ExampleArg::Range { data, cols } => Block { data: data.to_vec(), cols },
        };
        write_numbers(sheet, (values, col), &block, false)?;
        let end = (values + block.rows() as u32 - 1, col + block.cols as u16 - 1);
        let first = address((values, col));
        words.push(if block.data.len() == 1 { first } else { format!("{first}:{}", address(end)) });
        height = height.max(block.rows() as u32);
        col = end.1 + 2;
        inputs.push(block);
    }
    let inputs: Vec<Input<'_>> =
        inputs.iter().map(|b| if b.data.len() == 1 { Input::Number(b.data[0]) } else { b.input() }).collect();
    sheet.write_string_with_format(names, col, "=", &book.bold)?;
    sheet.write_string(names, col + 1, function.returns.doc.en)?;
    let text = format!("{}({})", function.name, words.join(","));
    let result = book.formula(sheet, (values, col), &text, &inputs)?;
    Ok(values + height.max(result.rows() as u32))
}
