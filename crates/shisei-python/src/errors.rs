//! A refusal as a Python exception with its full sentence.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use shisei_core::Error as CoreError;
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
    let condition = py.get_type::<ConditionError>();
    condition.setattr("faces", PyTuple::empty(py))?; // of six_face alone; no other has any
    module.add("ConditionError", condition)?;
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
#[allow(clippy::needless_pass_by_value)] // what PyO3 extracts
fn set_language(lang: Bound<'_, PyAny>) -> PyResult<()> {
    last_error::set_user_lang(match lang.extract::<String>().as_deref() {
        Ok("en") => Lang::En,
        Ok("ja") => Lang::Ja,
        _ => {
            let given = lang.repr()?;
            return Err(PyValueError::new_err(match last_error::user_lang() {
                Lang::En => format!("the language is {given}; it must be 'en' or 'ja'"),
                Lang::Ja => format!("言語が {given} です。'en' か 'ja' にしてください"),
            }));
        }
    });
    Ok(())
}

/// The exception of an error met by `function` of the package, whose arguments have names of their own.
pub fn exception(function: &str, error: impl Into<Error>) -> PyErr {
    let error = with_argument(error.into());
    let text = match own_words(function, &error, last_error::user_lang()) {
        Some(words) => format!("{function}: {words}"),
        None => ARGUMENTS
            .iter()
            .fold(sentence(function, &error), |text, (name, argument)| text.replace(name, argument)),
    };
    of_kind(&error, text)
}

/// Names of the core's parameters in its sentences, and the package's arguments.
const ARGUMENTS: [(&str, &str); 16] = [
    ("varThreshold", "max_variance"),
    ("maxTiltRad", "max_tilt_rad"),
    ("windowSec", "window_s"),
    ("stepSec", "step_s"),
    ("minAccScale", "min_acc_scale"),
    ("maxAccScale", "max_acc_scale"),
    ("maxWithoutRest", "max_without_rest_s"),
    ("maxHole", "max_hole_s"),
    ("maxEndDistance", "max_end_distance"),
    ("kpMin", "kp_min"),
    ("kpMax", "kp_max"),
    ("accelLowerEnd", "lower_end"),
    ("accelLowerStart", "lower_start"),
    ("accelUpperStart", "upper_start"),
    ("accelUpperEnd", "upper_end"),
    ("0 <= lag <= 10 s", "0 <= lag_s <= 10"),
];

/// With the argument's name for a parameter whose name is a common word, too.
fn with_argument(error: Error) -> Error {
    let argument = |name| match name {
        "dt" => "dt_s",
        "gravity" => "gravity_m_s2",
        "turns" => "turn_rad",
        other => other,
    };
    match error {
        Error::Core(CoreError::NotPositive { name, value }) => {
            Error::Core(CoreError::NotPositive { name: argument(name), value })
        }
        Error::Core(CoreError::Negative { name, value }) => {
            Error::Core(CoreError::Negative { name: argument(name), value })
        }
        other => other,
    }
}

/// The sentence where the core's speaks of points or of another door's option.
fn own_words(function: &str, error: &Error, lang: Lang) -> Option<String> {
    let Error::Core(error) = *error else { return None };
    let say = |en: &str, ja: &str| Some(if lang == Lang::Ja { ja } else { en }.to_owned());
    match (function, error) {
        ("allan_deviation", CoreError::TooFewPoints { given, needed }) => say(
            &format!("{given} readings were given and {needed} are needed; record for longer"),
            &format!("計測値が {given} 個しかありません ({needed} 個必要)。もっと長く計測してください"),
        ),
        ("allan_deviation", CoreError::Degenerate) => say(
            "the readings are all alike, so there is no noise to see; check the column",
            "計測値がすべて同じで、ノイズを求められません。列を確認してください",
        ),
        ("multi_pose", CoreError::TooFewPoints { given, needed }) => say(
            &format!(
                "{given} still poses (or turns between them) were found and {needed} are needed; rest the sensor for 1 s \
                 or more in 12 poses or more that point in all directions"
            ),
            &format!(
                "静止姿勢 (またはその間の回転) が {given} 個しか見つかりません ({needed} 個必要)。全方向に向けた 12 以上の姿勢で、\
                 それぞれ 1 秒以上静止させてください"
            ),
        ),
        ("multi_pose", CoreError::Degenerate) => say(
            "the poses, or the turns between them, do not determine the answer; rest the sensor for 1 s or more in 12 \
             poses or more that point in all directions",
            "静止姿勢やその間の回転から答えが決まりません。全方向に向けた 12 以上の姿勢で、それぞれ 1 秒以上静止させてください",
        ),
        ("known_turns", CoreError::FaceMissing { face }) => say(
            &format!(
                "no rest with {face} up was found; needed are rests on all six faces and one turn about each axis between \
                 two rests on the same face, or name their rows with parts"
            ),
            &format!(
                "{face} を上にした静止が見つかりません。6 面の静止と、同じ面での静止の間の各軸 1 回の回転が必要です。parts で行を\
                 指定することもできます"
            ),
        ),
        ("known_turns", CoreError::TooFewPoints { given, needed }) => say(
            &format!(
                "{given} turns were found and {needed} are needed: one about each axis, between two rests on the same face; \
                 or name their rows with parts"
            ),
            &format!(
                "回転が {given} 回しか見つかりません ({needed} 回必要)。各軸まわりに 1 回、同じ面での静止の間に回転させるか、parts で\
                 行を指定してください"
            ),
        ),
        ("known_turns", CoreError::Degenerate) => say(
            "the faces and turns do not determine the answer: each turn must be mostly about its own axis, each face must \
             point another way; check their order",
            "面と回転から答えが決まりません。各回転は主にその軸まわりで、各面は異なる向きでなければなりません。順序を確認してください",
        ),
        ("orient" | "estimate", CoreError::TooFewPoints { given, needed }) => say(
            &format!("the rest has {given} samples and {needed} are needed; give a longer one"),
            &format!(
                "静止区間が {given} サンプルしかありません ({needed} 以上必要)。もっと長い区間を指定してください"
            ),
        ),
        ("fuse", CoreError::TooFewPoints { given, needed }) => say(
            &format!(
                "{given} frames can be compared with the sensor's recording and {needed} are needed; check that the body \
                 was seen, and that both are of the same time"
            ),
            &format!(
                "センサの記録と比べられるフレームが {given} 個しかありません ({needed} 個必要)。剛体が見えていたか、同じ時間の記録か\
                 確認してください"
            ),
        ),
        ("earth_rate", CoreError::TooFewPoints { given, needed }) => say(
            &format!("{given} directions were given and {needed} are needed; measure more"),
            &format!("方向が {given} 個しかありません ({needed} 個必要)。計測を増やしてください"),
        ),
        ("earth_rate", CoreError::Degenerate) => say(
            "the directions do not determine the answer (all alike, or in one line); measure in directions that differ more",
            "方向の配置から答えが決まりません (同一、または一直線上)。もっと異なる向きで計測してください",
        ),
        _ => None,
    }
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
