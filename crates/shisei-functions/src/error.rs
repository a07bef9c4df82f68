//! Why a call was refused, and the sentence that says so.

use crate::value::Shape;
use core::fmt;
use shisei_core::Lang;
use shisei_core::error::Kind;

/// Result of a call through the table.
pub type Result<T> = core::result::Result<T, Error>;

/// Why a function refused its arguments. Rows and columns count from 0; sentences count from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// An argument that has no default was left out.
    Missing {
        /// The argument.
        arg: &'static str,
    },
    /// More arguments than the function takes.
    TooMany {
        /// Arguments given.
        given: usize,
        /// Arguments the function takes.
        takes: usize,
    },
    /// A range has the wrong shape.
    WrongShape {
        /// The argument.
        arg: &'static str,
        /// What it must be.
        expected: Shape,
        /// Rows given.
        rows: usize,
        /// Columns given.
        cols: usize,
    },
    /// A cell holds text, nothing, or something else that is not a number.
    NotANumber {
        /// The argument.
        arg: &'static str,
        /// Row in the range.
        row: usize,
        /// Column in the range.
        col: usize,
        /// True when the cell is blank.
        blank: bool,
    },
    /// The core refused an argument that can be named.
    InArgument {
        /// The argument.
        arg: &'static str,
        /// Why.
        error: shisei_core::Error,
    },
    /// The core refused.
    Core(shisei_core::Error),
    /// A C caller's buffer is too small for the result.
    OutTooSmall {
        /// Numbers the result has.
        needed: usize,
        /// Numbers the buffer holds.
        given: usize,
    },
    /// A fault of ours that was caught at the door.
    Internal,
}

impl From<shisei_core::Error> for Error {
    fn from(error: shisei_core::Error) -> Self {
        Error::Core(error)
    }
}

impl Error {
    /// Which of the three kinds this is. `None` for a small buffer and for a fault of ours.
    pub fn kind(self) -> Option<Kind> {
        match self {
            Error::Missing { .. }
            | Error::TooMany { .. }
            | Error::WrongShape { .. }
            | Error::NotANumber { .. } => Some(Kind::Shape),
            Error::InArgument { error, .. } | Error::Core(error) => Some(error.kind()),
            Error::OutTooSmall { .. } | Error::Internal => None,
        }
    }

    /// The sentence: what was wrong, where, what was expected, what to do.
    pub fn sentence(self, lang: Lang) -> String {
        Sentence { error: self, lang }.to_string()
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        english(*self, f)
    }
}

impl std::error::Error for Error {}

struct Sentence {
    error: Error,
    lang: Lang,
}

impl fmt::Display for Sentence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lang {
            Lang::En => english(self.error, f),
            Lang::Ja => japanese(self.error, f),
        }
    }
}

fn english(error: Error, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match error {
        Error::Missing { arg } => write!(f, "the argument {arg} is missing; give a value or a range"),
        Error::TooMany { given, takes } => {
            write!(f, "{given} arguments were given and the function takes {takes}; remove the rest")
        }
        Error::WrongShape { arg, expected, rows, cols } => {
            write!(f, "{arg} is a range of {rows}×{cols} (rows × columns) and must be {expected}")?;
            match expected {
                Shape::Series(_) | Shape::SeriesEither(..) => {
                    write!(f, "; select one sample a row, without the header")
                }
                _ => write!(f, "; a column of as many cells serves too"),
            }
        }
        Error::NotANumber { arg, row, col, blank } => write!(
            f,
            "{arg} has {} in row {}, column {}; every cell must hold a number",
            if blank { "a blank cell" } else { "text" },
            row + 1,
            col + 1
        ),
        Error::InArgument { arg, error } => write!(f, "{arg}: {}", error.sentence(Lang::En)),
        Error::Core(error) => write!(f, "{}", error.sentence(Lang::En)),
        Error::OutTooSmall { needed, given } => {
            write!(f, "the result has {needed} numbers and the buffer holds {given}; give a larger buffer")
        }
        Error::Internal => write!(
            f,
            "shisei met a fault of its own; please report it with the formula and the data that show it"
        ),
    }
}

fn japanese(error: Error, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match error {
        Error::Missing { arg } => {
            write!(f, "引数 {arg} がありません。値または範囲を指定してください")
        }
        Error::TooMany { given, takes } => {
            write!(
                f,
                "引数が {given} 個ありますが、この関数の引数は {takes} 個までです。余分な引数を除いてください"
            )
        }
        Error::WrongShape { arg, expected, rows, cols } => {
            write!(f, "{arg} が {rows} 行 {cols} 列です。{expected} の範囲を指定してください")?;
            match expected {
                Shape::Series(_) | Shape::SeriesEither(..) => {
                    write!(f, " (1 行に 1 サンプル、見出しは含めません)")
                }
                _ => write!(f, " (同じ個数の縦の並びでもかまいません)"),
            }
        }
        Error::NotANumber { arg, row, col, blank } => write!(
            f,
            "{arg} の {} 行 {} 列が{}。すべてのセルに数値を入れてください",
            row + 1,
            col + 1,
            if blank { "空白です" } else { "数値ではありません" }
        ),
        Error::InArgument { arg, error } => write!(f, "{arg}: {}", error.sentence(Lang::Ja)),
        Error::Core(error) => write!(f, "{}", error.sentence(Lang::Ja)),
        Error::OutTooSmall { needed, given } => {
            write!(f, "結果は {needed} 個ですが、バッファは {given} 個分です。大きなバッファを渡してください")
        }
        Error::Internal => {
            write!(f, "shisei の内部で不具合が起きました。お手数ですが、数式とデータを添えてご報告ください")
        }
    }
}
