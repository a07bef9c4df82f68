//! What crosses a door on the way in: numbers and rectangles of numbers, borrowed, never copied.

/// A rectangle of numbers, row-major.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range<'a> {
    data: &'a [f64],
    rows: usize,
    cols: usize,
}

impl<'a> Range<'a> {
    /// From row-major numbers; `None` unless there are `rows × cols` of them.
    pub fn new(data: &'a [f64], rows: usize, cols: usize) -> Option<Self> {
        (rows.checked_mul(cols) == Some(data.len())).then_some(Range { data, rows, cols })
    }

    /// The numbers, row-major.
    pub fn data(self) -> &'a [f64] {
        self.data
    }

    /// Number of rows.
    pub fn rows(self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(self) -> usize {
        self.cols
    }
}

/// One argument as a door hands it over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Input<'a> {
    /// Left out: an optional argument takes its default.
    Missing,
    /// A single number.
    Number(f64),
    /// A rectangle of numbers; 1×1 serves as a number.
    Range(Range<'a>),
}

/// The shape of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One number.
    Number,
    /// n numbers in a row or in a column.
    Vector(usize),
    /// One sample a row, n numbers each.
    Series(usize),
    /// One sample a row, one of two widths (`ApplyIMUCalib`: 3 or 6).
    SeriesEither(usize, usize),
    /// A row or column of one of two lengths (`ApplyIMUCalib`: 6 or 12).
    VectorEither(usize, usize),
}

impl Shape {
    /// True when a door passes this argument as one number.
    pub fn is_number(self) -> bool {
        self == Shape::Number
    }
}

impl core::fmt::Display for Shape {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Shape::Number => write!(f, "1×1"),
            Shape::Vector(n) => write!(f, "1×{n}"),
            Shape::Series(n) => write!(f, "N×{n}"),
            Shape::SeriesEither(a, b) => write!(f, "N×{a}, N×{b}"),
            Shape::VectorEither(a, b) => write!(f, "1×{a}, 1×{b}"),
        }
    }
}
