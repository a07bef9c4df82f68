//! Why a take could not be read or used.

use shisei_core::Lang;
use std::fmt;

use crate::error::{Place, shorten};
use crate::error_text::list;

/// Result of this module.
pub type Result<T> = std::result::Result<T, Error>;

/// What is wrong with a take.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// The bytes could not be unpacked.
    Bytes(Box<crate::Problem>),
    /// There is no row whose first cell is `Frame`.
    NotMotive,
    /// There is a heading and no frame after it.
    NoFrames,
    /// A cell that must be a number is text.
    NotANumber {
        /// The text, shortened.
        text: String,
    },
    /// Frame numbers do not ascend.
    FrameOrder {
        /// The number before.
        before: i64,
        /// The number that follows it.
        now: i64,
    },
    /// Neither a frame rate nor a time column says how long a frame is.
    NoRate,
    /// Nearly all cells of the table are missing.
    Sparse {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// The unit of length is none of Motive's.
    LengthUnit {
        /// As written.
        text: String,
    },
    /// The rotation type is none of Motive's.
    RotationType {
        /// As written.
        text: String,
    },
    /// The take holds no body with rotation and position.
    NoBodies,
    /// There are several bodies and none was chosen.
    ManyBodies {
        /// Their names.
        names: Vec<String>,
    },
    /// The chosen body is not in the take.
    NoSuchBody {
        /// What was asked for.
        asked: String,
        /// The names there are.
        names: Vec<String>,
    },
    /// Bones were exported relative to their parents.
    LocalBones,
    /// The frame sequence of an inertial recording starts again.
    SequenceReset {
        /// Sample, from 1.
        sample: usize,
    },
    /// The sequence counted another number of frames than the take has.
    SequenceCount {
        /// Frames counted by the receiver.
        counted: u64,
        /// Total Frames in Take.
        total: u64,
    },
    /// A pulse file holds fewer than two pulses.
    FewPulses {
        /// How many.
        count: usize,
    },
    /// A pulse is not later than the one before.
    PulseOrder {
        /// Pulse, from 1.
        pulse: usize,
    },
    /// A pulse comes too late or too soon after the one before: one is missing, or one is too many.
    PulseStep {
        /// Pulse, from 1.
        pulse: usize,
        /// Time from the pulse before, s.
        step_s: f64,
        /// The usual time, s.
        usual_s: f64,
    },
    /// No sample of the recording lies between the first pulse and the last.
    PulseNone {
        /// First and last pulse, s.
        pulses_s: [f64; 2],
        /// First and last sample, s.
        samples_s: [f64; 2],
    },
    /// There is another number of pulses than the take has frames.
    PulseCount {
        /// Pulses in the file.
        counted: u64,
        /// Frames of the take.
        total: u64,
    },
}

/// A problem and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// What is wrong.
    pub problem: Problem,
    /// Where.
    pub place: Box<Place>,
}

impl Error {
    pub(super) fn of_file(file: &str, problem: Problem) -> Self {
        Error::at(file, None, None, problem)
    }

    pub(super) fn at(
        file: &str,
        line: Option<usize>,
        column: Option<(usize, String)>,
        problem: Problem,
    ) -> Self {
        Error { problem, place: Box::new(Place { file: file.to_owned(), line, column }) }
    }

    /// The sentence in a language.
    pub fn sentence(&self, lang: Lang) -> String {
        let place = self.place.text(lang);
        let text = match (&self.problem, lang) {
            (Problem::Bytes(problem), Lang::En) => crate::error_text::english(problem),
            (Problem::Bytes(problem), Lang::Ja) => crate::error_text::japanese(problem),
            (problem, Lang::En) => english(problem),
            (problem, Lang::Ja) => japanese(problem),
        };
        if place.is_empty() { text } else { format!("{place}: {text}") }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence(Lang::En))
    }
}

impl std::error::Error for Error {}

fn english(problem: &Problem) -> String {
    match problem {
        Problem::Bytes(problem) => crate::error_text::english(problem),
        Problem::NotMotive => {
            "this is no Motive tracking CSV: no row begins with the cell \"Frame\"; export the \
                               take from Motive with File > Export Tracking Data, format CSV"
                .into()
        }
        Problem::NoFrames => {
            "the take has a heading and no frames after it; export it again with its frames".into()
        }
        Problem::NotANumber { text } => {
            format!("\"{}\" is not a number; repair the cell or export the take again", shorten(text))
        }
        Problem::FrameOrder { before, now } => format!(
            "frame {now} follows frame {before}; frame numbers must ascend; export one take, unchanged, from \
             Motive"
        ),
        Problem::NoRate => {
            "the first row has no Export Frame Rate and there is no usable time column; export \
                            the take with its header information"
                .into()
        }
        Problem::Sparse { rows, columns } => format!(
            "the heading has {columns} columns and {rows} rows follow, but nearly all cells are missing; export \
             the take again"
        ),
        Problem::LengthUnit { text } => format!(
            "the length unit \"{}\" is not known; export with metres, centimetres or millimetres",
            shorten(text)
        ),
        Problem::RotationType { text } => format!(
            "the rotation type \"{}\" is not known; export with Quaternion or an Euler order such as XYZ",
            shorten(text)
        ),
        Problem::NoBodies => {
            "the take holds no rigid body and no bone with rotation and position; make a rigid \
                              body of the tool's markers in Motive and export it"
                .into()
        }
        Problem::ManyBodies { names } => {
            format!("there is more than one body in the take: {}; choose one with --body NAME", list(names))
        }
        Problem::NoSuchBody { asked, names } => format!(
            "there is no body \"{}\"; the take has: {}; choose one of them",
            shorten(asked),
            list(names)
        ),
        Problem::LocalBones => "the bones were exported relative to their parents (Coordinate Space Local); \
                                export the take with Coordinate Space Global"
            .into(),
        Problem::SequenceReset { sample } => format!(
            "the frame sequence of the inertial recording goes back at sample {sample}: the receiver's counter was \
             reset within the take; cut the recording there, or use --sync rates"
        ),
        Problem::SequenceCount { counted, total } => format!(
            "the receiver counted {counted} frames and the take has {total} (Total Frames in Take); the recording \
             belongs to another take or pulses were lost; choose the right one, or use --sync rates"
        ),
        Problem::FewPulses { count } => format!(
            "{count} pulses are too few; the file must hold the time of every camera pulse in seconds, one a row"
        ),
        Problem::PulseOrder { pulse } => format!(
            "pulse {pulse} is not later than the one before; the times must ascend; use the pulses of one take"
        ),
        Problem::PulseStep { pulse, step_s, usual_s } => format!(
            "pulse {pulse} comes {:.3} ms after the one before, where {:.3} ms is usual: {}; repair the pulse file, or \
             use --sync rates",
            step_s * 1e3,
            usual_s * 1e3,
            if step_s > usual_s { "pulses are missing" } else { "there is one too many" }
        ),
        Problem::PulseNone { pulses_s: [from, to], samples_s: [first, last] } => format!(
            "no sample lies between the first and the last pulse: the pulses go from {from:.3} to {to:.3} s and the \
             recording from {first:.3} to {last:.3} s; are they in seconds, and on the recording's clock?"
        ),
        Problem::PulseCount { counted, total } => format!(
            "the pulse file holds {counted} pulses and the take has {total} frames; it belongs to another take, or \
             pulses were lost at its ends; choose the right one, or use --sync rates"
        ),
    }
}

fn japanese(problem: &Problem) -> String {
    match problem {
        Problem::Bytes(problem) => crate::error_text::japanese(problem),
        Problem::NotMotive => {
            "Motive のトラッキング CSV ではありません (先頭のセルが \"Frame\" の行がありません)。\
                               Motive の File > Export Tracking Data で CSV 形式を選んで書き出してください"
                .into()
        }
        Problem::NoFrames => {
            "見出しだけでフレームがありません。フレームを含めて書き出し直してください".into()
        }
        Problem::NotANumber { text } => format!(
            "\"{}\" は数値ではありません。セルを修正するか、テイクを書き出し直してください",
            shorten(text)
        ),
        Problem::FrameOrder { before, now } => format!(
            "フレーム {before} の次がフレーム {now} です。フレーム番号は増加していく必要があります。\
             1 つのテイクをそのまま Motive から書き出してください"
        ),
        Problem::NoRate => "先頭行に Export Frame Rate がなく、使える時刻の列もありません。\
                            ヘッダ情報を付けて書き出してください"
            .into(),
        Problem::Sparse { rows, columns } => format!(
            "見出しは {columns} 列、データは {rows} 行ですが、ほとんどのセルがありません。\
             テイクを書き出し直してください"
        ),
        Problem::LengthUnit { text } => format!(
            "長さの単位 \"{}\" が分かりません。メートル、センチメートル、ミリメートルのいずれかで書き出してください",
            shorten(text)
        ),
        Problem::RotationType { text } => format!(
            "回転の形式 \"{}\" が分かりません。Quaternion、または XYZ などのオイラー角で書き出してください",
            shorten(text)
        ),
        Problem::NoBodies => {
            "回転と位置を持つ剛体もボーンもありません。Motive で道具のマーカーから剛体を作り、\
                              書き出してください"
                .into()
        }
        Problem::ManyBodies { names } => {
            format!("剛体が複数あります: {}。--body NAME で 1 つ選んでください", list(names))
        }
        Problem::NoSuchBody { asked, names } => format!(
            "\"{}\" という剛体はありません。このテイクにあるのは {} です。この中から選んでください",
            shorten(asked),
            list(names)
        ),
        Problem::LocalBones => {
            "ボーンが親に対する相対座標 (Coordinate Space が Local) で書き出されています。\
                                Global で書き出してください"
                .into()
        }
        Problem::SequenceReset { sample } => format!(
            "慣性センサの記録のフレーム番号が {sample} サンプル目で戻っています (テイクの途中で受信機のカウンタが\
             リセットされました)。そこで記録を切るか、--sync rates を使ってください"
        ),
        Problem::SequenceCount { counted, total } => format!(
            "受信機が数えたフレームは {counted}、テイクは {total} (Total Frames in Take) です。別のテイクの記録か、\
             パルスの欠落です。正しい記録を選ぶか、--sync rates を使ってください"
        ),
        Problem::FewPulses { count } => format!(
            "パルスが {count} 個しかありません。カメラのパルスの時刻を 1 行に 1 つ、秒で書いたファイルが必要です"
        ),
        Problem::PulseOrder { pulse } => format!(
            "{pulse} 番目のパルスが、その前のパルスより後になっていません。時刻は増加していく必要があります。\
             1 つのテイクのパルスだけを使ってください"
        ),
        Problem::PulseStep { pulse, step_s, usual_s } => format!(
            "{pulse} 番目のパルスが前のパルスから {:.3} ms 後にあります (通常は {:.3} ms)。{}。パルスファイルを修正するか、\
             --sync rates を使ってください",
            step_s * 1e3,
            usual_s * 1e3,
            if step_s > usual_s { "パルスの欠落です" } else { "余分なパルスです" }
        ),
        Problem::PulseNone { pulses_s: [from, to], samples_s: [first, last] } => format!(
            "最初のパルスから最後のパルスまでの間にサンプルがありません。パルスは {from:.3}〜{to:.3} 秒、記録は \
             {first:.3}〜{last:.3} 秒です。パルスの時刻は秒単位で、慣性センサの記録と同じ時計で書かれていますか"
        ),
        Problem::PulseCount { counted, total } => format!(
            "パルスは {counted} 個、テイクは {total} フレームです。別のテイクのパルスか、両端での欠落です。\
             正しいファイルを選ぶか、--sync rates を使ってください"
        ),
    }
}
