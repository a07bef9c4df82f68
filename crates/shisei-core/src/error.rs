//! What can be wrong, and the sentence that says so.
//!
//! One small `Copy` enum; a door adds the place (file, line, cell) it knows. The three kinds are the three
//! cell errors of a spreadsheet and the negative codes of the C ABI.

use core::fmt;

/// Result of a core function.
pub type Result<T> = core::result::Result<T, Error>;

/// Language of a sentence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lang {
    /// English.
    #[default]
    En,
    /// Japanese.
    Ja,
}

/// The kind of an error, which decides the cell error, the exit code and the C return value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Wrong shape or type: `#VALUE!`, exit 2, −1.
    Shape,
    /// Out of the function's domain: `#NUM!`, exit 2, −2.
    Domain,
    /// The data do not meet a condition: `#N/A`, exit 1, −3.
    Condition,
}

/// A face of a sensor: the axis that points up while it rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// 0, 1, 2 for x, y, z.
    pub axis: u8,
    /// True for the positive axis up.
    pub positive: bool,
}

impl Face {
    /// All six, in the order +x, −x, +y, −y, +z, −z.
    pub const ALL: [Face; 6] = [
        Face { axis: 0, positive: true },
        Face { axis: 0, positive: false },
        Face { axis: 1, positive: true },
        Face { axis: 1, positive: false },
        Face { axis: 2, positive: true },
        Face { axis: 2, positive: false },
    ];

    /// The unit vector of the axis, in sensor coordinates.
    pub fn unit(self) -> [f64; 3] {
        let mut v = [0.0; 3];
        v[usize::from(self.axis.min(2))] = if self.positive { 1.0 } else { -1.0 };
        v
    }
}

impl fmt::Display for Face {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.positive { '+' } else { '-' };
        write!(f, "{sign}{}", ['x', 'y', 'z'][usize::from(self.axis.min(2))])
    }
}

/// Why a core function refused. Rows count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// A series has no rows.
    Empty,
    /// Two series that belong together differ in length.
    LengthMismatch {
        /// Rows of the first.
        first: usize,
        /// Rows of the second.
        second: usize,
    },
    /// A number is NaN or infinite.
    NotFinite {
        /// Row of the number.
        row: usize,
    },
    /// A quaternion has norm zero.
    ZeroQuaternion {
        /// Row of the quaternion.
        row: usize,
    },
    /// A rotation axis has norm zero.
    ZeroAxis,
    /// A matrix is not a rotation.
    NotARotation,
    /// A parameter must be finite and greater than zero.
    NotPositive {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter must be finite and not negative.
    Negative {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter lies outside its range.
    OutOfRange {
        /// The rule, as an inequality with the parameter's name.
        rule: &'static str,
        /// Its value.
        value: f64,
    },
    /// The reference frame of a tool that is held shows no holder, or no samples of its sensor.
    NoReference {
        /// True where the samples are missing, false where the holder is.
        silent: bool,
    },
    /// An acceleration is zero and shows no direction.
    ZeroAcceleration,
    /// An axis is too near to the vertical to have a heading.
    AxisNearVertical {
        /// Its angle from the vertical, rad.
        angle_rad: f64,
    },
    /// No rest of the needed length was found.
    NoRest {
        /// The needed length, s.
        needed_s: f64,
    },
    /// The sensor moved for longer without a rest than a result can be trusted for.
    TooLongWithoutRest {
        /// Longest time without a rest, s.
        seconds: f64,
        /// The limit, s.
        limit_s: f64,
    },
    /// The samples have a hole that is too long to bridge.
    HoleTooLong {
        /// Where it begins, s after the first sample.
        at_s: f64,
        /// Its length, s.
        seconds: f64,
        /// The limit, s.
        limit_s: f64,
    },
    /// The end that was given is not where the movement can end.
    EndContradicted {
        /// How far the two are apart in standard deviations of both.
        distance: f64,
        /// The same, m.
        off_m: f64,
        /// The standard deviation of where the readings lead (root of the three axes' sum), m.
        sigma_m: f64,
    },
    /// Parameters must ascend in a stated order.
    OutOfOrder {
        /// The rule, as an inequality.
        rule: &'static str,
    },
    /// No window of the series is stable.
    NotStable {
        /// The largest variance of an axis, (m/s²)².
        variance: f64,
        /// The mean norm, m/s².
        mean_norm: f64,
    },
    /// Six-face calibration: no stable window belongs to this face.
    FaceMissing {
        /// The face.
        face: Face,
    },
    /// Six-face calibration: a scale lies outside its bounds.
    ScaleOutOfBounds {
        /// 0, 1, 2 for x, y, z.
        axis: u8,
        /// The scale found.
        scale: f64,
    },
    /// A fit has too few points.
    TooFewPoints {
        /// Points given.
        given: usize,
        /// Points needed.
        needed: usize,
    },
    /// A fit's points do not determine its answer (all alike, or in one plane or line).
    Degenerate,
    /// An iteration did not converge.
    NoConvergence,
    /// Two recordings that should show one body's motion do not.
    NoCommonMotion {
        /// Share of the optical turns' squares that the gyroscope explains, 0 … 1.
        explained: f64,
    },
    /// The body turned about one axis only.
    OneAxisOnly {
        /// Spread of the turns across their main axis as a share of that along it.
        ratio: f64,
    },
}

impl Error {
    /// Which of the three kinds this is.
    pub fn kind(self) -> Kind {
        match self {
            Error::Empty | Error::LengthMismatch { .. } => Kind::Shape,
            Error::NotFinite { .. }
            | Error::ZeroQuaternion { .. }
            | Error::ZeroAxis
            | Error::NotARotation
            | Error::ZeroAcceleration
            | Error::OutOfRange { .. }
            | Error::NoReference { .. }
            | Error::NotPositive { .. }
            | Error::Negative { .. }
            | Error::OutOfOrder { .. } => Kind::Domain,
            Error::NotStable { .. }
            | Error::AxisNearVertical { .. }
            | Error::NoRest { .. }
            | Error::TooLongWithoutRest { .. }
            | Error::HoleTooLong { .. }
            | Error::EndContradicted { .. }
            | Error::FaceMissing { .. }
            | Error::ScaleOutOfBounds { .. }
            | Error::TooFewPoints { .. }
            | Error::Degenerate
            | Error::NoConvergence
            | Error::NoCommonMotion { .. }
            | Error::OneAxisOnly { .. } => Kind::Condition,
        }
    }

    /// The same error with the row of a series in place of row 0.
    pub fn at_row(self, row: usize) -> Self {
        match self {
            Error::NotFinite { .. } => Error::NotFinite { row },
            Error::ZeroQuaternion { .. } => Error::ZeroQuaternion { row },
            other => other,
        }
    }

    /// The sentence in a language: what was wrong, where, what was expected, what to do.
    pub fn sentence(self, lang: Lang) -> Sentence {
        Sentence { error: self, lang }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.sentence(Lang::En).fmt(f)
    }
}

impl core::error::Error for Error {}

/// An error with its language; `Display` writes the sentence.
#[derive(Clone, Copy, Debug)]
pub struct Sentence {
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

fn axis_name(axis: u8) -> char {
    ['x', 'y', 'z'][usize::from(axis.min(2))]
}

fn english(error: Error, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match error {
        Error::Empty => write!(f, "the series has no rows; give at least one sample"),
        Error::LengthMismatch { first, second } => {
            write!(f, "the series have {first} and {second} rows; give series of equal length")
        }
        Error::NotFinite { row } => {
            write!(f, "row {} has a value that is not a finite number; remove or repair it", row + 1)
        }
        Error::ZeroQuaternion { row } => write!(
            f,
            "the quaternion in row {} is zero and has no direction; give w, x, y, z of a rotation",
            row + 1
        ),
        Error::ZeroAxis => write!(f, "the rotation axis is zero; give an axis with a direction"),
        Error::NotARotation => {
            write!(f, "the matrix is not a rotation; its rows must be orthonormal and right-handed")
        }
        Error::NotPositive { name, value } | Error::Negative { name, value } if !value.is_finite() => {
            write!(f, "{name} is {value}; it must be a finite number")
        }
        Error::NotPositive { name, value } => {
            write!(f, "{name} is {value}; it must be greater than 0")
        }
        Error::Negative { name, value } => write!(f, "{name} is {value}; it must be 0 or more"),
        Error::OutOfRange { rule, value } => {
            write!(f, "a parameter is {value}, out of its range; needed: {rule}")
        }
        Error::NoReference { silent } => write!(
            f,
            "in the reference frame {}; choose a frame in which the parent is seen and the sensor has samples",
            if silent { "there are no samples of the sensor" } else { "the parent is lost" }
        ),
        Error::ZeroAcceleration => write!(
            f,
            "the acceleration is zero and does not show where up is; give one that contains gravity"
        ),
        Error::AxisNearVertical { angle_rad } => write!(
            f,
            "the axis stands {:.1} degrees from the vertical and has no heading; choose an axis that lies \
             nearer to the horizontal at the start",
            angle_rad.to_degrees()
        ),
        Error::TooLongWithoutRest { seconds, limit_s } => write!(
            f,
            "the sensor moved for {seconds:.1} s without a rest, more than the {limit_s} s for which position \
             can be trusted; rest more often, or raise maxWithoutRest"
        ),
        Error::HoleTooLong { at_s, seconds, limit_s } => write!(
            f,
            "the samples have a hole of {seconds:.2} s, {at_s:.2} s after the first of them, longer than the \
             {limit_s} s over which motion can be bridged; split the recording there, or raise maxHole"
        ),
        Error::EndContradicted { distance, off_m, sigma_m } => write!(
            f,
            "the end that was given is {off_m:.3} m from where the readings lead to within {sigma_m:.3} m: \
             {distance:.0} standard deviations, which cannot be; check the end, the axes and the rests, or \
             raise maxEndDistance"
        ),
        Error::NoRest { needed_s } => write!(
            f,
            "no rest of {needed_s} s or more was found; keep the sensor still at the start, or state the rest"
        ),
        Error::OutOfOrder { rule } => write!(f, "the thresholds are out of order; needed: {rule}"),
        Error::NotStable { variance, mean_norm } => write!(
            f,
            "the sensor was not at rest: largest variance {variance:.6}, mean norm {mean_norm:.6}; \
             choose still samples or wider limits"
        ),
        Error::FaceMissing { face } => write!(
            f,
            "no stable window with {face} up was found; rest the sensor on that face for the window's \
             length, or raise varThreshold or maxTiltRad"
        ),
        Error::ScaleOutOfBounds { axis, scale } => write!(
            f,
            "the scale found for axis {} is {scale:.6}, outside its bounds; check the unit and the \
             gravity, or widen minAccScale and maxAccScale",
            axis_name(axis)
        ),
        Error::TooFewPoints { given, needed } => {
            write!(f, "{given} points were given and {needed} are needed; measure more")
        }
        Error::Degenerate => write!(
            f,
            "the points do not determine the answer (all alike, or in one line or plane); measure in \
             directions that differ more"
        ),
        Error::NoConvergence => write!(f, "the fit did not converge; check the data and their unit"),
        Error::NoCommonMotion { explained } => write!(
            f,
            "the two recordings show no common motion (at best {:.0} % of the optical turns are in the \
             gyroscope's); check that both are of the same object and the same time, and that it is turned for \
             some seconds while the cameras see it",
            100.0 * explained.max(0.0)
        ),
        Error::OneAxisOnly { ratio } => write!(
            f,
            "the object turned about one axis only (across it {:.1} % of the turning), which leaves the sensor's \
             mounting open; turn it about two axes while the cameras see it",
            100.0 * ratio
        ),
    }
}

fn japanese(error: Error, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match error {
        Error::Empty => write!(f, "系列に行がありません。1 サンプル以上を指定してください"),
        Error::LengthMismatch { first, second } => {
            write!(f, "系列の行数が {first} と {second} で異なります。同じ行数にしてください")
        }
        Error::NotFinite { row } => {
            write!(f, "{} 行目に有限でない数値があります。取り除くか修正してください", row + 1)
        }
        Error::ZeroQuaternion { row } => write!(
            f,
            "{} 行目のクォータニオンがゼロで、向きが決まりません。回転を表す w, x, y, z を指定してください",
            row + 1
        ),
        Error::ZeroAxis => write!(f, "回転軸がゼロです。向きのある軸を指定してください"),
        Error::NotARotation => {
            write!(f, "回転行列ではありません。各行が正規直交で右手系である必要があります")
        }
        Error::NotPositive { name, value } | Error::Negative { name, value } if !value.is_finite() => {
            write!(f, "{name} が {value} です。有限の数値にしてください")
        }
        Error::NotPositive { name, value } => {
            write!(f, "{name} が {value} です。0 より大きい値にしてください")
        }
        Error::Negative { name, value } => {
            write!(f, "{name} が {value} です。0 以上の値にしてください")
        }
        Error::OutOfRange { rule, value } => {
            write!(f, "パラメータの値 {value} が範囲外です。必要な条件: {rule}")
        }
        Error::NoReference { silent } => write!(
            f,
            "基準フレーム{}。親が見えていて、センサの記録もあるフレームを指定してください",
            if silent {
                "の時刻にセンサの記録がありません"
            } else {
                "で親が失われています"
            }
        ),
        Error::ZeroAcceleration => {
            write!(f, "加速度がゼロのため上向きが決まりません。重力を含む加速度を指定してください")
        }
        Error::AxisNearVertical { angle_rad } => write!(
            f,
            "指定した軸が鉛直から {:.1} 度しか離れておらず、方位が決まりません。\
             開始時に水平に近い軸を選んでください",
            angle_rad.to_degrees()
        ),
        Error::TooLongWithoutRest { seconds, limit_s } => write!(
            f,
            "静止なしで {seconds:.1} 秒動いています。位置を信頼できる上限は {limit_s} 秒です。\
             途中で静止させるか、maxWithoutRest を大きくしてください"
        ),
        Error::HoleTooLong { at_s, seconds, limit_s } => write!(
            f,
            "最初のサンプルから {at_s:.2} 秒の位置でサンプルが {seconds:.2} 秒間欠けています。運動を補間できる上限は \
             {limit_s} 秒です。そこで記録を分けるか、maxHole を大きくしてください"
        ),
        Error::EndContradicted { distance, off_m, sigma_m } => write!(
            f,
            "指定した終点は、計測値から求めた終点 (標準偏差 {sigma_m:.3} m) から {off_m:.3} m 離れています。標準偏差の \
             {distance:.0} 倍で、ありえません。終点、軸の向き、静止区間を確認するか、maxEndDistance を大きくしてください"
        ),
        Error::NoRest { needed_s } => write!(
            f,
            "{needed_s} 秒以上の静止区間が見つかりません。開始時にセンサを静止させるか、静止区間を指定してください"
        ),
        Error::OutOfOrder { rule } => {
            write!(f, "しきい値の順序が正しくありません。必要な条件: {rule}")
        }
        Error::NotStable { variance, mean_norm } => write!(
            f,
            "センサが静止していません (最大分散 {variance:.6}、平均ノルム {mean_norm:.6})。\
             静止したサンプルを選ぶか、しきい値を広げてください"
        ),
        Error::FaceMissing { face } => write!(
            f,
            "{face} を上にした安定区間が見つかりません。その面で窓の長さだけ静止させるか、\
             varThreshold または maxTiltRad を大きくしてください"
        ),
        Error::ScaleOutOfBounds { axis, scale } => write!(
            f,
            "{} 軸のスケール {scale:.6} が範囲外です。単位と重力加速度を確認するか、\
             minAccScale と maxAccScale を広げてください",
            axis_name(axis)
        ),
        Error::TooFewPoints { given, needed } => {
            write!(f, "点が {given} 個しかありません ({needed} 個必要)。計測を増やしてください")
        }
        Error::Degenerate => write!(
            f,
            "点の配置から答えが決まりません (同一、または一直線・一平面上)。もっと異なる向きで計測してください"
        ),
        Error::NoConvergence => {
            write!(f, "最適化が収束しませんでした。データと単位を確認してください")
        }
        Error::NoCommonMotion { explained } => write!(
            f,
            "2 つの記録に共通の動きがありません (光学計測の回転のうち、ジャイロで説明できるのは最大 {:.0} % です)。\
             同じ物体・同じ時間の記録か確認し、カメラに見える状態で数秒間回転させてください",
            100.0 * explained.max(0.0)
        ),
        Error::OneAxisOnly { ratio } => write!(
            f,
            "物体が 1 つの軸まわりにしか回転していないため (それ以外の軸の回転は {:.1} %)、センサの取り付け向きが\
             決まりません。カメラに見える状態で 2 つの軸まわりに回転させてください",
            100.0 * ratio
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stays_small() {
        assert!(size_of::<Error>() <= 32);
    }

    /// Every sentence ends without a full stop, has no NaN in it and is Japanese where it says so.
    #[test]
    fn sentences_in_both_languages() {
        let face = Face::ALL[3];
        for error in [
            Error::Empty,
            Error::LengthMismatch { first: 1, second: 2 },
            Error::NotFinite { row: 4 },
            Error::ZeroQuaternion { row: 4 },
            Error::ZeroAxis,
            Error::NotARotation,
            Error::NotPositive { name: "dt", value: 0.0 },
            Error::Negative { name: "kp", value: -1.0 },
            Error::OutOfRange { rule: "0 <= alpha <= 1", value: 2.0 },
            Error::NoReference { silent: true },
            Error::NoReference { silent: false },
            Error::ZeroAcceleration,
            Error::AxisNearVertical { angle_rad: 0.1 },
            Error::NoRest { needed_s: 1.0 },
            Error::TooLongWithoutRest { seconds: 30.0, limit_s: 20.0 },
            Error::HoleTooLong { at_s: 20.0, seconds: 3.0, limit_s: 0.5 },
            Error::EndContradicted { distance: 40.0, off_m: 15.5, sigma_m: 0.4 },
            Error::OutOfOrder { rule: "a < b" },
            Error::NotStable { variance: 1.0, mean_norm: 9.8 },
            Error::FaceMissing { face },
            Error::ScaleOutOfBounds { axis: 1, scale: 1.5 },
            Error::TooFewPoints { given: 3, needed: 4 },
            Error::Degenerate,
            Error::NoConvergence,
            Error::NoCommonMotion { explained: 0.3 },
            Error::OneAxisOnly { ratio: 0.01 },
        ] {
            let english = std::format!("{error}");
            let japanese = std::format!("{}", error.sentence(Lang::Ja));
            assert!(english.is_ascii() && english.len() > 20 && !english.contains("  "), "{english}");
            assert!(japanese.chars().any(|c| ('ぁ'..='ん').contains(&c)) && !japanese.contains("  "));
        }
        assert!(std::format!("{}", Error::NotFinite { row: 4 }).contains("row 5"));
        assert!(std::format!("{}", Error::FaceMissing { face }.sentence(Lang::Ja)).starts_with("-y"));
    }
}
