//! Typed arrays as rows, and results as objects of typed arrays.

use crate::errors::named;
use js_sys::{Array, Float64Array, Object, Reflect};
use shisei_core::filter::Dt;
use wasm_bindgen::prelude::*;

/// Rows of N numbers, which follow each other; the package has checked that there are whole rows.
pub fn rows<const N: usize>(numbers: &[f64]) -> Result<&[[f64; N]], JsValue> {
    match numbers.as_chunks::<N>() {
        (rows, []) => Ok(rows),
        _ => Err(named("ShapeError", &format!("{} numbers are no rows of {N}", numbers.len()))),
    }
}

/// N numbers.
pub fn vector<const N: usize>(numbers: &[f64]) -> Result<[f64; N], JsValue> {
    let wrong = |_| named("ShapeError", &format!("{} numbers where {N} are expected", numbers.len()));
    numbers.try_into().map_err(wrong)
}

/// A step: one number for all samples, or one for each.
pub fn steps(dt_s: &[f64]) -> Dt<'_> {
    match dt_s {
        [one] => Dt::Constant(*one),
        each => Dt::PerSample(each),
    }
}

/// A result: named parts.
pub struct Parts(Object);

impl Parts {
    pub fn new() -> Self {
        Parts(Object::new())
    }

    /// Adds a part.
    pub fn put(self, name: &str, value: impl Into<JsValue>) -> Self {
        // An object of our own takes any property.
        let _ = Reflect::set(&self.0, &name.into(), &value.into());
        self
    }

    /// Adds numbers.
    pub fn numbers(self, name: &str, numbers: &[f64]) -> Self {
        self.put(name, Float64Array::from(numbers))
    }

    /// Adds rows, which the package makes a table of.
    pub fn rows<const N: usize>(self, name: &str, rows: &[[f64; N]]) -> Self {
        self.put(name, table(rows.as_flattened(), rows.len(), N))
    }

    pub fn object(self) -> JsValue {
        self.0.into()
    }
}

/// Numbers row after row, how many rows, how many columns.
pub fn table(numbers: &[f64], rows: usize, columns: usize) -> JsValue {
    let parts: [JsValue; 3] = [Float64Array::from(numbers).into(), rows.into(), columns.into()];
    Array::from_iter(parts).into()
}
