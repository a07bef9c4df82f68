//! What every worksheet function does: the cell rules on the way in, the cell errors on the way out.

use crate::xl::{
    BLANK, ERROR, ERROR_NA, ERROR_NUM, ERROR_VALUE, INTEGER, MISSING, NUMBER, TEXT, TRUTH, WE_FREE, Xloper12,
};
use shisei_functions::{Error, FUNCTIONS, Function, Input, Kind, Output, Range, last_error};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An argument as Excel passes it.
pub type Argument = *const Xloper12;

/// Why there is no result.
enum Refusal {
    /// An error cell in an argument: passed on.
    PassedOn(i32),
    Ours(Error),
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Refusal::Ours(error)
    }
}

/// An argument with its numbers collected.
enum Collected {
    Missing,
    Number(f64),
    Cells(Vec<f64>, usize, usize),
}

/// Calls function `index` of the table.
///
/// # Safety
/// The arguments must be values of Excel.
pub unsafe fn call(index: usize, arguments: &[Argument]) -> *mut Xloper12 {
    let Some(function) = FUNCTIONS.get(index) else { return hand_over(Xloper12::error(ERROR_VALUE)) };
    // SAFETY: as of this function
    let result = catch_unwind(AssertUnwindSafe(|| unsafe { run(function, arguments) }));
    hand_over(match result {
        Ok(Ok(value)) => value,
        Ok(Err(Refusal::PassedOn(code))) => Xloper12::error(code),
        Ok(Err(Refusal::Ours(error))) => refuse(function, error),
        Err(_) => refuse(function, Error::Internal),
    })
}

fn refuse(function: &Function, error: Error) -> Xloper12 {
    last_error::record(function.name, error);
    Xloper12::error(match error.kind() {
        Some(Kind::Shape) | None => ERROR_VALUE,
        Some(Kind::Domain) => ERROR_NUM,
        Some(Kind::Condition) => ERROR_NA,
    })
}

/// Excel frees the result with xlAutoFree12.
fn hand_over(mut value: Xloper12) -> *mut Xloper12 {
    value.xltype |= WE_FREE;
    Box::into_raw(Box::new(value))
}

unsafe fn run(function: &Function, arguments: &[Argument]) -> Result<Xloper12, Refusal> {
    let mut collected = Vec::with_capacity(arguments.len());
    for (&argument, described) in arguments.iter().zip(function.args) {
        // SAFETY: a value of Excel by the caller's word
        collected.push(match unsafe { argument.as_ref() } {
            None => Collected::Missing,
            Some(value) if value.kind() == MISSING => Collected::Missing,
            // SAFETY: as of this function
            Some(value) => unsafe {
                collect(value, described.name, described.shape.is_number(), function.takes_not_finite)
            }?,
        });
    }
    let inputs: Vec<Input<'_>> = collected
        .iter()
        .map(|argument| match argument {
            Collected::Missing => Input::Missing,
            Collected::Number(x) => Input::Number(*x),
            Collected::Cells(data, rows, cols) => {
                Range::new(data, *rows, *cols).map_or(Input::Missing, Input::Range)
            }
        })
        .collect();
    Ok(match function.call(&inputs)? {
        Output::Truth(truth) => Xloper12::truth(truth),
        Output::Sentence(text) => Xloper12::text(&text),
        Output::Numbers { data, rows: 1, cols: 1 } => {
            Xloper12::number(data.first().copied().unwrap_or(f64::NAN))
        }
        Output::Numbers { data, rows, cols } => {
            Xloper12::array(data.into_iter().map(Xloper12::number).collect(), rows, cols)
        }
    })
}

/// The numbers of an argument. Wholly blank rows at the end are dropped; an error cell is passed on, or is not
/// finite where that may be asked; text and other blanks are refused.
unsafe fn collect(
    value: &Xloper12,
    name: &'static str,
    is_number: bool,
    errors_are_nan: bool,
) -> Result<Collected, Refusal> {
    // SAFETY: as of this function
    let (cells, mut rows, cols) = unsafe { value.cells() };
    while !is_number && rows > 0 && cells[(rows - 1) * cols..rows * cols].iter().all(|c| c.kind() == BLANK) {
        rows -= 1;
    }
    let mut data = Vec::with_capacity(rows * cols);
    // nearly always all cells are numbers
    data.extend(cells[..rows * cols].iter().map_while(Xloper12::as_number));
    for (i, cell) in cells[..rows * cols].iter().enumerate().skip(data.len()) {
        // SAFETY: the kind says which member is meant
        data.push(unsafe {
            match cell.kind() {
                NUMBER => cell.value.number,
                INTEGER => f64::from(cell.value.integer),
                TRUTH => f64::from(cell.value.truth),
                ERROR if errors_are_nan => f64::NAN,
                ERROR => return Err(Refusal::PassedOn(cell.value.error)),
                kind => {
                    let blank = kind != TEXT;
                    let (row, col) = (i / cols, i % cols);
                    return Err(Error::NotANumber { arg: name, row, col, blank }.into());
                }
            }
        });
    }
    Ok(match data[..] {
        [x] if is_number => Collected::Number(x),
        _ => Collected::Cells(data, rows, cols),
    })
}
