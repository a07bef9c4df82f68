//! Result types. Each says its shape and becomes a rectangle of numbers.

use crate::error::{Error, Result};
use shisei_core::{Quaternion, Vec3, Ypr};

/// The shape of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnShape {
    /// One number.
    Number,
    /// TRUE or FALSE.
    Truth,
    /// One row of n numbers.
    Row(usize),
    /// One row a sample of n numbers.
    Series(usize),
    /// Rows of n numbers, no more than the first argument has.
    Rows(usize),
    /// As the first argument.
    SameAsFirst,
    /// A fixed number of rows and columns.
    Table(usize, usize),
    /// A sentence.
    Sentence,
}

impl core::fmt::Display for ReturnShape {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            ReturnShape::Number => write!(f, "1×1"),
            ReturnShape::Truth => write!(f, "TRUE / FALSE"),
            ReturnShape::Row(n) => write!(f, "1×{n}"),
            ReturnShape::Series(n) => write!(f, "N×{n}"),
            ReturnShape::Rows(n) => write!(f, "K×{n}"),
            ReturnShape::SameAsFirst => write!(f, "N×3, N×6"),
            ReturnShape::Table(rows, cols) => write!(f, "{rows}×{cols}"),
            ReturnShape::Sentence => write!(f, "text"),
        }
    }
}

/// What a function gives: numbers, row-major, or a sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// A rectangle of numbers, `data.len() == rows × cols`.
    Numbers {
        /// The numbers, row-major.
        data: Vec<f64>,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        cols: usize,
    },
    /// TRUE or FALSE.
    Truth(bool),
    /// A sentence (`ShiseiVersion`, `ShiseiLastError`).
    Sentence(String),
}

/// A type that can be the result of a worksheet function.
pub trait IntoOutput {
    /// Its shape.
    const SHAPE: ReturnShape;

    /// As a rectangle.
    fn into_output(self) -> Output;
}

impl IntoOutput for f64 {
    const SHAPE: ReturnShape = ReturnShape::Number;

    fn into_output(self) -> Output {
        Output::Numbers { data: vec![self], rows: 1, cols: 1 }
    }
}

impl IntoOutput for bool {
    const SHAPE: ReturnShape = ReturnShape::Truth;

    fn into_output(self) -> Output {
        Output::Truth(self)
    }
}

impl IntoOutput for String {
    const SHAPE: ReturnShape = ReturnShape::Sentence;

    fn into_output(self) -> Output {
        Output::Sentence(self)
    }
}

impl<const N: usize> IntoOutput for [f64; N] {
    const SHAPE: ReturnShape = ReturnShape::Row(N);

    fn into_output(self) -> Output {
        Output::Numbers { data: self.to_vec(), rows: 1, cols: N }
    }
}

impl IntoOutput for Quaternion {
    const SHAPE: ReturnShape = ReturnShape::Row(4);

    fn into_output(self) -> Output {
        self.to_array().into_output()
    }
}

impl IntoOutput for Ypr {
    const SHAPE: ReturnShape = ReturnShape::Row(3);

    fn into_output(self) -> Output {
        self.to_array().into_output()
    }
}

impl<const N: usize> IntoOutput for Vec<[f64; N]> {
    const SHAPE: ReturnShape = ReturnShape::Series(N);

    fn into_output(self) -> Output {
        let rows = self.len();
        Output::Numbers { data: self.into_flattened(), rows, cols: N }
    }
}

impl IntoOutput for Vec<Quaternion> {
    const SHAPE: ReturnShape = ReturnShape::Series(4);

    fn into_output(self) -> Output {
        // collects in place: both types are four f64
        self.into_iter().map(Quaternion::to_array).collect::<Vec<[f64; 4]>>().into_output()
    }
}

impl IntoOutput for Vec<Ypr> {
    const SHAPE: ReturnShape = ReturnShape::Series(3);

    fn into_output(self) -> Output {
        self.into_iter().map(Ypr::to_array).collect::<Vec<Vec3>>().into_output()
    }
}

/// A series with the first argument's number of columns.
#[derive(Clone, Debug)]
pub enum SameAsFirst {
    /// N×3.
    Three(Vec<[f64; 3]>),
    /// N×6.
    Six(Vec<[f64; 6]>),
}

impl IntoOutput for SameAsFirst {
    const SHAPE: ReturnShape = ReturnShape::SameAsFirst;

    fn into_output(self) -> Output {
        match self {
            SameAsFirst::Three(rows) => rows.into_output(),
            SameAsFirst::Six(rows) => rows.into_output(),
        }
    }
}

/// Rows of N numbers whose count depends on the data, never more than the first argument has.
#[derive(Clone, Debug)]
pub struct Rows<const N: usize>(pub Vec<[f64; N]>);

impl<const N: usize> IntoOutput for Rows<N> {
    const SHAPE: ReturnShape = ReturnShape::Rows(N);

    fn into_output(self) -> Output {
        Output::Numbers { rows: self.0.len(), data: self.0.into_flattened(), cols: N }
    }
}

/// A table with a fixed number of rows.
#[derive(Clone, Copy, Debug)]
pub struct Table<const R: usize, const C: usize>(pub [[f64; C]; R]);

impl<const R: usize, const C: usize> IntoOutput for Table<R, C> {
    const SHAPE: ReturnShape = ReturnShape::Table(R, C);

    fn into_output(self) -> Output {
        Output::Numbers { data: self.0.as_flattened().to_vec(), rows: R, cols: C }
    }
}

impl Output {
    /// The numbers of a result that is not a sentence; TRUE is 1 and FALSE 0.
    pub fn numbers(&self) -> Result<&[f64]> {
        match self {
            Output::Numbers { data, .. } => Ok(data),
            Output::Truth(true) => Ok(&[1.0]),
            Output::Truth(false) => Ok(&[0.0]),
            Output::Sentence(_) => Err(Error::Internal),
        }
    }

    /// Rows and columns; 1×1 for a truth or a sentence.
    pub fn shape(&self) -> (usize, usize) {
        match self {
            Output::Numbers { rows, cols, .. } => (*rows, *cols),
            Output::Truth(_) | Output::Sentence(_) => (1, 1),
        }
    }
}
