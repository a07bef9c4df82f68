//! A refusal as a Python exception with its full sentence.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use shisei_functions::{Error, Kind, Lang, last_error};

create_exception!(shisei, ShapeError, PyValueError, "An array has the wrong shape, or lengths differ.");
create_exception!(
    shisei,
    DomainError,
    PyValueError,
    "A value is out of range, zero where it may not be, or not finite."
);
create_exception!(
    shisei,
    ConditionError,
    PyException,
    "The data do not meet a condition: not at rest, a face missing."
);

pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("ShapeError", py.get_type::<ShapeError>())?;
    module.add("DomainError", py.get_type::<DomainError>())?;
    module.add("ConditionError", py.get_type::<ConditionError>())?;
    module.add_function(wrap_pyfunction!(language, module)?)?;
    module.add_function(wrap_pyfunction!(set_language, module)?)
}

/// The language in use: "en" or "ja".
#[pyfunction]
fn language() -> &'static str {
    match last_error::user_lang() {
        Lang::En => "en",
        Lang::Ja => "ja",
    }
}

/// "en" or "ja".
#[pyfunction]
fn set_language(lang: &str) -> PyResult<()> {
    let lang = match lang {
        "en" => Lang::En,
        "ja" => Lang::Ja,
        other => {
            return Err(PyValueError::new_err(format!("the language is {other:?}; it must be 'en' or 'ja'")));
        }
    };
    last_error::set_user_lang(lang);
    Ok(())
}

/// The exception of an error met by `function`.
pub fn exception(function: &str, error: impl Into<Error>) -> PyErr {
    let error = error.into();
    let text = format!("{function}: {}", error.sentence(last_error::user_lang()));
    match error.kind() {
        Some(Kind::Shape) => ShapeError::new_err(text),
        Some(Kind::Domain) => DomainError::new_err(text),
        Some(Kind::Condition) => ConditionError::new_err(text),
        None => PyRuntimeError::new_err(text),
    }
}
