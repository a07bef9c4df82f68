//! One column of numbers, read in place: a recording of millions of rows is never copied to be drawn.

/// A column of f64.
#[derive(Clone, Debug)]
pub enum Column<'a> {
    /// Every value of a slice.
    Slice(&'a [f64]),
    /// One component (0, 1, 2) of rows of three.
    Component(&'a [[f64; 3]], usize),
    /// Values made for the plot.
    Owned(Vec<f64>),
}

impl Column<'_> {
    /// Rows.
    pub fn len(&self) -> usize {
        match self {
            Column::Slice(values) => values.len(),
            Column::Component(rows, _) => rows.len(),
            Column::Owned(values) => values.len(),
        }
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a row; NaN beyond the end.
    #[inline]
    pub fn get(&self, row: usize) -> f64 {
        let value = match self {
            Column::Slice(values) => values.get(row).copied(),
            Column::Component(rows, axis) => rows.get(row).and_then(|r| r.get(*axis)).copied(),
            Column::Owned(values) => values.get(row).copied(),
        };
        value.unwrap_or(f64::NAN)
    }
}
