//! Why a report could not be made.

use shisei_core::Lang;

/// Result of making a report.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a report could not be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// There is no row to draw.
    Empty,
    /// A series does not have one row for each time stamp.
    LengthMismatch {
        /// Which series.
        series: &'static str,
        /// Rows of the time column.
        expected: usize,
        /// Rows of the series.
        found: usize,
    },
    /// The picture's size is out of 320×200 … 16000×16000 pixels.
    ImageSize {
        /// Width asked for, pixels.
        width: u32,
        /// Height asked for, pixels.
        height: u32,
    },
    /// The PNG could not be encoded; our fault.
    Encode(String),
}

impl Error {
    /// The full sentence.
    pub fn message(&self, lang: Lang) -> String {
        match (self, lang) {
            (Error::Empty, Lang::En) => "There is nothing to draw: the recording has no row.".to_owned(),
            (Error::Empty, Lang::Ja) => "描くデータがありません: 記録に行がありません。".to_owned(),
            (Error::LengthMismatch { series, expected, found }, Lang::En) => {
                format!("{series} has {found} rows where the time column has {expected}: both must agree.")
            }
            (Error::LengthMismatch { series, expected, found }, Lang::Ja) => format!(
                "{series} は {found} 行ですが、時刻の列は {expected} 行です。行数を合わせてください。"
            ),
            (Error::ImageSize { width, height }, Lang::En) => format!(
                "A picture of {width}×{height} pixels cannot be drawn: choose 320×200 to 16000×16000."
            ),
            (Error::ImageSize { width, height }, Lang::Ja) => format!(
                "{width}×{height} 画素の画像は描けません。320×200 から 16000×16000 の間で指定してください。"
            ),
            (Error::Encode(why), Lang::En) => {
                format!("The PNG could not be encoded ({why}); please report this.")
            }
            (Error::Encode(why), Lang::Ja) => {
                format!("PNG に変換できませんでした ({why})。不具合としてご報告ください。")
            }
        }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message(Lang::En))
    }
}

impl std::error::Error for Error {}
