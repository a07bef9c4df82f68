//! The examples as JSON, for the tests of Calc and Python.

use serde_json::{Value, json};
use shisei_functions::{ExampleArg, Expected, FUNCTIONS, Function, Shape};

pub fn json() -> String {
    let mut out = String::from("[\n");
    for (i, f) in FUNCTIONS.iter().enumerate() {
        out += &entry(f).to_string();
        out += if i + 1 < FUNCTIONS.len() { ",\n" } else { "\n" };
    }
    out + "]\n"
}

fn entry(f: &Function) -> Value {
    let args: Vec<Value> = f
        .example
        .args
        .iter()
        .map(|a| match a {
            ExampleArg::Missing => Value::Null,
            ExampleArg::Number(x) => json!(x),
            ExampleArg::Range { data, cols } => rows(data, *cols),
        })
        .collect();
    let expected = match f.example.expected {
        Expected::Numbers { data, cols, .. } => rows(data, cols),
        Expected::Truth(truth) => json!(truth),
        Expected::Sentence => Value::Null,
    };
    let tolerance = match f.example.expected {
        Expected::Numbers { tolerance, .. } => tolerance,
        _ => 0.0,
    };
    let shapes: Vec<String> = f.args.iter().map(|a| shape(a.shape)).collect();
    json!({
        "name": f.name,
        "export": f.export,
        "arg_names": f.args.iter().map(|a| a.name).collect::<Vec<_>>(),
        "arg_shapes": shapes,
        "required": f.required(),
        "takes_not_finite": f.takes_not_finite,
        "args": args,
        "expected": expected,
        "tolerance": tolerance,
    })
}

fn shape(shape: Shape) -> String {
    match shape {
        Shape::Number => "number".into(),
        Shape::Vector(n) => format!("vector {n}"),
        Shape::VectorEither(a, b) => format!("vector {a} {b}"),
        Shape::Series(n) => format!("series {n}"),
        Shape::SeriesEither(a, b) => format!("series {a} {b}"),
    }
}

fn rows(data: &[f64], cols: usize) -> Value {
    json!(data.chunks(cols).collect::<Vec<_>>())
}
