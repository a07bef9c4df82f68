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

/// The exception of an error met by `function` of the package, whose arguments have names of their own.
pub fn exception(function: &str, error: impl Into<Error>) -> PyErr {
    let error = error.into();
    let mut text = sentence(function, &error);
    for (name, argument) in [
        ("varThreshold", "max_variance"),
        ("maxTiltRad", "max_tilt_rad"),
        ("windowSec", "window_s"),
        ("stepSec", "step_s"),
        ("minAccScale", "min_acc_scale"),
        ("maxAccScale", "max_acc_scale"),
        ("kpMin", "kp_min"),
        ("kpMax", "kp_max"),
        ("accelLowerEnd", "lower_end"),
        ("accelLowerStart", "lower_start"),
        ("accelUpperStart", "upper_start"),
        ("accelUpperEnd", "upper_end"),
    ] {
        if text.contains(name) {
            text = text.replace(name, argument);
        }
    }
    of_kind(&error, text)
}

/// The exception of an error met by a worksheet function.
pub fn sheet_exception(function: &str, error: Error) -> PyErr {
    let text = sentence(function, &error);
    of_kind(&error, text)
}

fn sentence(function: &str, error: &Error) -> String {
    format!("{function}: {}", error.sentence(last_error::user_lang()))
}

fn of_kind(error: &Error, text: String) -> PyErr {
    match error.kind() {
        Some(Kind::Shape) => ShapeError::new_err(text),
        Some(Kind::Domain) => DomainError::new_err(text),
        Some(Kind::Condition) => ConditionError::new_err(text),
        None => PyRuntimeError::new_err(text),
    }
}
