//! The worksheet functions.

use crate::arrays::table;
use crate::errors::sheet_refusal;
use js_sys::{Array, Float64Array};
use serde_json::{Value, json};
use shisei_functions::{Arg, Error, FUNCTIONS, Function, Input, Output, Range, ReturnShape, Shape, VERSION};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
pub fn version() -> String {
    VERSION.into()
}

/// What the package needs to know of every function, as JSON.
#[wasm_bindgen]
pub fn functions() -> String {
    let arg = |a: &Arg| {
        // A list of numbers alone is then as many samples.
        let columns = if let Shape::Series(columns) = a.shape { Some(columns) } else { None };
        json!({ "name": a.name, "number": a.shape.is_number(), "columns": columns })
    };
    let entry =
        |f: &Function| json!({ "name": f.name, "args": f.args.iter().map(arg).collect::<Vec<Value>>() });
    FUNCTIONS.iter().map(entry).collect::<Value>().to_string()
}

/// Calls function `index` of the table. An argument is a number, an array of numbers, rows and columns, or undefined.
#[wasm_bindgen]
pub fn call(index: usize, given: Vec<JsValue>) -> Result<JsValue, JsValue> {
    let function = FUNCTIONS.get(index).ok_or_else(|| sheet_refusal("call", Error::Internal))?;
    let refuse = |error: Error| sheet_refusal(function.name, error);
    let tables: Vec<Option<(Vec<f64>, usize, usize)>> = given.iter().map(rectangle).collect();
    let inputs: Vec<Input<'_>> = given
        .iter()
        .zip(&tables)
        .map(|(argument, table)| match (argument.as_f64(), table) {
            (Some(number), _) => Input::Number(number),
            (None, Some((data, rows, columns))) => {
                Range::new(data, *rows, *columns).map_or(Input::Missing, Input::Range)
            }
            (None, None) => Input::Missing,
        })
        .collect();
    Ok(match function.call(&inputs).map_err(refuse)? {
        Output::Truth(truth) => truth.into(),
        Output::Sentence(text) => text.into(),
        Output::Numbers { data, rows, cols } => match function.returns.shape {
            ReturnShape::Number => data.first().copied().ok_or_else(|| refuse(Error::Internal))?.into(),
            ReturnShape::Row(_) => Float64Array::from(data.as_slice()).into(),
            _ => table(&data, rows, cols),
        },
    })
}

fn rectangle(argument: &JsValue) -> Option<(Vec<f64>, usize, usize)> {
    let parts = argument.dyn_ref::<Array>()?;
    let count = |at: u32| parts.get(at).as_f64().map(|count| count as usize);
    Some((parts.get(0).dyn_ref::<Float64Array>()?.to_vec(), count(1)?, count(2)?))
}
