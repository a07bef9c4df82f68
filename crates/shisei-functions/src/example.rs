//! An example of a function: inputs and a result computed by other software than ours.

use crate::value::{Input, Range};

/// One argument of an example.
#[derive(Clone, Copy, Debug)]
pub enum ExampleArg {
    /// Left out.
    Missing,
    /// One number.
    Number(f64),
    /// A rectangle, row-major.
    Range {
        /// The numbers.
        data: &'static [f64],
        /// How many stand in a row.
        cols: usize,
    },
}

impl ExampleArg {
    /// As a door would hand it over.
    pub fn input(&self) -> Input<'static> {
        match *self {
            ExampleArg::Missing => Input::Missing,
            ExampleArg::Number(x) => Input::Number(x),
            ExampleArg::Range { data, cols } => {
                Range::new(data, data.len() / cols.max(1), cols).map_or(Input::Missing, Input::Range)
            }
        }
    }
}

/// What an example gives.
#[derive(Clone, Copy, Debug)]
pub enum Expected {
    /// Numbers, row-major, `cols` in a row, each to `tolerance`.
    Numbers {
        /// The numbers.
        data: &'static [f64],
        /// How many stand in a row.
        cols: usize,
        /// Largest absolute difference allowed.
        tolerance: f64,
    },
    /// TRUE or FALSE.
    Truth(bool),
    /// A sentence; which one depends on the door.
    Sentence,
}

/// Inputs of a function and its result from an independent reference.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// The arguments; optional ones may be missing at the end.
    pub args: &'static [ExampleArg],
    /// The result.
    pub expected: Expected,
    /// Where the result comes from.
    pub source: &'static str,
}
