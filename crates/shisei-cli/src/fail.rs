//! How a command ends when it cannot do what was asked: a sentence and an exit code.

use shisei_core::error::Kind;
use shisei_core::{Error, Lang};

/// Exit codes of the command (INTERFACES: they are fixed, scripts rely on them). Of several refusals the greatest counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// The data do not meet a condition.
    Condition = 1,
    /// Bad input or usage.
    Input = 2,
    /// Our fault.
    Internal = 70,
}

/// A refusal: one sentence in the user's language, and the exit code.
#[derive(Clone, Debug)]
pub struct Failure {
    /// What the process ends with.
    pub exit: Exit,
    /// What was wrong, where, what was expected, what to do.
    pub sentence: String,
}

impl Failure {
    /// Bad input or usage: exit 2.
    pub fn input(sentence: impl Into<String>) -> Self {
        Failure { exit: Exit::Input, sentence: sentence.into() }
    }

    /// The data do not meet a condition: exit 1.
    pub fn condition(sentence: impl Into<String>) -> Self {
        Failure { exit: Exit::Condition, sentence: sentence.into() }
    }

    /// A refusal of the core about the data of `file`.
    pub fn core(file: &str, error: Error, lang: Lang) -> Self {
        let exit = match error.kind() {
            Kind::Shape | Kind::Domain => Exit::Input,
            Kind::Condition => Exit::Condition,
        };
        let colon = if lang == Lang::Ja { "：" } else { ": " };
        Failure { exit, sentence: format!("{file}{colon}{}", as_options(error.sentence(lang).to_string())) }
    }
}

/// The core names parameters as worksheets do; here they are options.
fn as_options(mut sentence: String) -> String {
    for (name, option) in [
        ("varThreshold", "--var-threshold"),
        ("maxTiltRad", "--max-tilt"),
        ("windowSec", "--window"),
        ("stepSec", "--step"),
        ("raise maxWithoutRest", "insist with --force"),
        ("maxWithoutRest を大きくして", "--force で続行して"),
        ("raise maxHole", "insist with --force"),
        ("maxHole を大きくして", "--force で続行して"),
        ("raise maxEndDistance", "insist with --force"),
        ("maxEndDistance を大きくして", "--force で続行して"),
        (
            "check the unit and the gravity, or widen minAccScale and maxAccScale",
            "check the unit of the accelerations (--units) and the gravity (--gravity)",
        ),
        (
            "単位と重力加速度を確認するか、minAccScale と maxAccScale を広げて",
            "加速度の単位 (--units) と重力加速度 (--gravity) を確認して",
        ),
        ("kpMin", "--kp-min"),
        ("kpMax", "--kp"),
        (
            "accelLowerEnd < accelLowerStart <= accelUpperStart < accelUpperEnd",
            "--accel-limits LE < LS <= US < UE",
        ),
    ] {
        if sentence.contains(name) {
            sentence = sentence.replace(name, option);
        }
    }
    sentence
}

/// `Ok` or a refusal.
pub type Outcome<T> = Result<T, Failure>;

/// The sentence of the language in use.
pub fn say(lang: Lang, en: impl Into<String>, ja: impl Into<String>) -> String {
    match lang {
        Lang::En => en.into(),
        Lang::Ja => ja.into(),
    }
}
