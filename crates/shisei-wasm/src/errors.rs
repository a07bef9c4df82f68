//! A refusal as a JavaScript error with its full sentence.

use shisei_core::Error as CoreError;
use shisei_functions::{Error, Kind, Lang, last_error};
use wasm_bindgen::prelude::*;

/// The language in use: "en" or "ja".
#[wasm_bindgen]
pub fn language() -> String {
    match last_error::user_lang() {
        Lang::En => "en".into(),
        Lang::Ja => "ja".into(),
    }
}

/// Japanese, or else English.
#[wasm_bindgen(js_name = setJapanese)]
pub fn set_japanese(japanese: bool) {
    last_error::set_user_lang(if japanese { Lang::Ja } else { Lang::En });
}

/// The error met by `function` of the package.
pub fn refusal(function: &str, error: impl Into<Error>) -> JsValue {
    sheet_refusal(function, with_argument(error.into()))
}

/// The error met by a worksheet function.
pub fn sheet_refusal(function: &str, error: Error) -> JsValue {
    let name = match error.kind() {
        Some(Kind::Shape) => "ShapeError",
        Some(Kind::Domain) => "DomainError",
        Some(Kind::Condition) => "ConditionError",
        None => "Error",
    };
    named(name, &format!("{function}: {}", error.sentence(last_error::user_lang())))
}

/// With the package's name for a parameter of the core.
fn with_argument(error: Error) -> Error {
    let argument = |name| match name {
        "dt" => "dtS",
        "gravity" => "gravityMS2",
        other => other,
    };
    match error {
        Error::Core(CoreError::NotPositive { name, value }) => {
            Error::Core(CoreError::NotPositive { name: argument(name), value })
        }
        other => other,
    }
}

/// An error with a name, by which a program tells one kind from another.
pub fn named(name: &str, sentence: &str) -> JsValue {
    let error = js_sys::Error::new(sentence);
    error.set_name(name);
    error.into()
}
