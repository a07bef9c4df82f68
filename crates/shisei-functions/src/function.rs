//! What an entry of the table is, and the macro that writes one.

use crate::error::{Error, Result};
use crate::example::Example;
use crate::input::FromInput;
use crate::output::{Output, ReturnShape};
use crate::text::Text;
use crate::value::{Input, Shape};

/// Where a function is listed in a function wizard and in the manual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Means, variances and calibration of accelerations and rates.
    Readings,
    /// Identity, normalisation, conjugate.
    Quaternions,
    /// Vectors turned by quaternions.
    Rotation,
    /// Quaternion ↔ yaw, pitch, roll; axis and angle.
    Conversion,
    /// Attitudes relative to the start.
    Relative,
    /// Attitude from gyro and accelerometer.
    Update,
    /// TRUE or FALSE about data.
    Checks,
    /// Beyond the 44: diagnosis, other filters, motion.
    Extra,
}

impl Group {
    /// All groups, in the order of the manual.
    pub const ALL: [Group; 8] = [
        Group::Readings,
        Group::Quaternions,
        Group::Rotation,
        Group::Conversion,
        Group::Relative,
        Group::Update,
        Group::Checks,
        Group::Extra,
    ];

    /// The heading of the group.
    pub const fn title(self) -> Text {
        match self {
            Group::Readings => {
                Text { en: "Accelerations and rates", ja: "加速度・ジャイロの基本" }
            }
            Group::Quaternions => Text { en: "Quaternions", ja: "クォータニオンの基本" },
            Group::Rotation => Text { en: "Rotating vectors", ja: "ベクトルの回転" },
            Group::Conversion => Text { en: "Conversions", ja: "表現の変換" },
            Group::Relative => Text { en: "Relative attitudes", ja: "初期姿勢と相対姿勢" },
            Group::Update => Text { en: "Attitude from readings", ja: "計測値による姿勢更新" },
            Group::Checks => Text { en: "Checks", ja: "判定" },
            Group::Extra => Text { en: "Beyond the 44", ja: "追加の関数" },
        }
    }
}

/// An argument of a function.
#[derive(Clone, Copy, Debug)]
pub struct Arg {
    /// Its name, the same in every door and language.
    pub name: &'static str,
    /// What a function wizard calls it.
    pub label: Text,
    /// The shape it takes.
    pub shape: Shape,
    /// Its unit; empty where any unit serves.
    pub unit: &'static str,
    /// Its value when left out; `None` when it must be given.
    pub default: Option<f64>,
    /// One sentence about it.
    pub doc: Text,
}

/// The result of a function.
#[derive(Clone, Copy, Debug)]
pub struct ReturnDoc {
    /// Its shape.
    pub shape: ReturnShape,
    /// What the numbers are.
    pub doc: Text,
}

/// An entry of the table.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    /// The worksheet name.
    pub name: &'static str,
    /// The exported symbol of the dynamic library.
    pub export: &'static str,
    /// Where it is listed.
    pub group: Group,
    /// What it does.
    pub doc: Text,
    /// A formula as one writes it in a sheet.
    pub formula: &'static str,
    /// Its arguments, optional ones last.
    pub args: &'static [Arg],
    /// Its result.
    pub returns: ReturnDoc,
    /// Inputs and result from an independent reference.
    pub example: &'static Example,
    /// True where a number that is not finite is a legal input.
    pub takes_not_finite: bool,
    pub(crate) code: fn(&[Input<'_>]) -> Result<Output>,
}

impl Function {
    /// Calls the function; arguments beyond the given ones count as left out.
    pub fn call(&self, inputs: &[Input<'_>]) -> Result<Output> {
        if inputs.len() > self.args.len() {
            return Err(Error::TooMany { given: inputs.len(), takes: self.args.len() });
        }
        (self.code)(inputs)
    }

    /// Number of arguments that must be given.
    pub fn required(&self) -> usize {
        self.args.iter().filter(|a| a.default.is_none()).count()
    }
}

/// Reads one argument: the given value, else its default.
pub(crate) fn take<'a, T: FromInput<'a>>(
    inputs: &mut core::slice::Iter<'_, Input<'a>>,
    arg: &'static str,
    default: Option<f64>,
) -> Result<T> {
    match (inputs.next().copied().unwrap_or(Input::Missing), default) {
        (Input::Missing, Some(default)) => T::from_input(Input::Number(default), arg),
        (input, _) => T::from_input(input, arg),
    }
}

/// Writes one entry of the table so that it reads like the function's signature. Shapes come from the types.
macro_rules! function {
    (
        $name:literal = $export:ident in $group:ident, $formula:literal;
        $en:literal / $ja:literal;
        ($($arg:ident : $ty:ty $(= $default:literal)?, [$unit:literal] $label_en:literal / $label_ja:literal:
           $arg_en:literal / $arg_ja:literal;)*)
        -> $ret:ty, $ret_en:literal / $ret_ja:literal;
        example $example:ident $(, takes_not_finite $nan:literal)?;
        $body:expr
    ) => {
        $crate::function::Function {
            name: $name,
            export: stringify!($export),
            group: $crate::function::Group::$group,
            doc: $crate::text::Text { en: $en, ja: $ja },
            formula: $formula,
            args: &[$($crate::function::Arg {
                name: stringify!($arg),
                label: $crate::text::Text { en: $label_en, ja: $label_ja },
                shape: <$ty as $crate::input::FromInput<'_>>::SHAPE,
                unit: $unit,
                default: $crate::function::first_or_none!($($default)?),
                doc: $crate::text::Text { en: $arg_en, ja: $arg_ja },
            }),*],
            returns: $crate::function::ReturnDoc {
                shape: <$ret as $crate::output::IntoOutput>::SHAPE,
                doc: $crate::text::Text { en: $ret_en, ja: $ret_ja },
            },
            example: &$crate::examples::$example,
            takes_not_finite: $crate::function::or_false!($($nan)?),
            code: |inputs| {
                #[allow(unused_mut, unused_variables)] // functions without arguments
                let mut inputs = inputs.iter();
                $(#[allow(non_snake_case)] // the names are those of the worksheet
                let $arg: $ty = $crate::function::take(
                    &mut inputs,
                    stringify!($arg),
                    $crate::function::first_or_none!($($default)?),
                )?;)*
                let result: $ret = $body;
                Ok($crate::output::IntoOutput::into_output(result))
            },
        }
    };
}

/// `Some(x)` of one literal, `None` of none.
macro_rules! first_or_none {
    () => {
        None
    };
    ($x:literal) => {
        Some($x)
    };
}

/// The literal given, else false.
macro_rules! or_false {
    () => {
        false
    };
    ($x:literal) => {
        $x
    };
}

pub(crate) use {first_or_none, function, or_false};
