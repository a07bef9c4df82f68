//! Means, variances and the six-face calibration.

use crate::function::{Function, function};
use crate::input::{CalibParameters, Series, SixColumns};
use crate::output::SameAsFirst;
use crate::table::calibration;
use shisei_core::calibration::SixFaceSettings;
use shisei_core::{Vec3, rest};

pub(super) const VEC3_MEAN: Function = function! {
    "Vec3Mean" = GetMeanVector3 in Readings, "=Vec3Mean(B2:D301)";
    "Mean of each axis of a series of vectors." / "ベクトル系列の各軸の平均を返します。";
    (vecRange: Series<'_, 3>, [""] "vectors" / "ベクトル系列":
        "N×3, one vector a row" / "N 行 3 列、1 行に 1 ベクトル";)
    -> Vec3, "mean of x, y, z" / "x, y, z の平均";
    example VEC3_MEAN;
    rest::mean(vecRange.rows)?
};

pub(super) const VEC3_VARIANCE: Function = function! {
    "Vec3Variance" = GetVarianceVector3 in Readings, "=Vec3Variance(B2:D301)";
    "Population variance (divided by N) of each axis of a series of vectors; 0 for a single row."
        / "ベクトル系列の各軸の母分散 (N で割った値) を返します。1 行だけなら 0 です。";
    (vecRange: Series<'_, 3>, [""] "vectors" / "ベクトル系列":
        "N×3, one vector a row" / "N 行 3 列、1 行に 1 ベクトル";)
    -> Vec3, "variance of x, y, z" / "x, y, z の分散";
    example VEC3_VARIANCE;
    rest::variance(vecRange.rows)?
};

pub(super) const MEAN_NORM: Function = function! {
    "MeanNorm" = GetMeanNorm in Readings, "=MeanNorm(B2:D301)";
    "Mean of the lengths of the rows; for accelerations at rest it is close to gravity."
        / "各行のノルム (長さ) の平均を返します。静止中の加速度なら重力加速度に近い値になります。";
    (vecRange: Series<'_, 3>, [""] "vectors" / "ベクトル系列":
        "N×3, one vector a row" / "N 行 3 列、1 行に 1 ベクトル";)
    -> f64, "mean length" / "ノルムの平均";
    example MEAN_NORM;
    rest::mean_norm(vecRange.rows)?
};

/// The two calibrations have the same arguments.
macro_rules! six_face {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $ret:ty, $ret_en:literal / $ret_ja:literal; $example:ident; $result:expr) => {
        function! {
            $name = $export in Readings, $formula;
            $en / $ja;
            (dataRange: Series<'_, 6>, ["m/s², rad/s"] "readings" / "計測データ":
                "N×6: accX, accY, accZ, gyroX, gyroY, gyroZ, with all six faces at rest"
                / "N 行 6 列: 加速度 x, y, z、ジャイロ x, y, z。6 面すべての静止区間を含めます";
            dt: f64, ["s"] "sample interval" / "サンプル間隔":
                "time from row to row" / "行と行の時間間隔";
            windowSec: f64 = 3.0, ["s"] "window" / "窓の長さ":
                "length of still time looked for on each face; longer averages more noise away"
                / "各面で探す静止区間の長さ。長いほどノイズが平均されます";
            stepSec: f64 = 0.1, ["s"] "step" / "探索の刻み":
                "distance from one window to the next" / "窓をずらす間隔";
            maxTiltRad: f64 = 0.2617993877991494, ["rad"] "largest tilt" / "許容する傾き":
                "how far a face may be from vertical (15°)" / "面の向きが鉛直からずれてよい角度 (15°)";
            varThreshold: f64 = 0.01, ["(m/s²)²"] "largest variance" / "分散のしきい値":
                "largest variance of an axis in a still window; raise it for a noisy sensor"
                / "静止とみなす各軸の分散の上限。ノイズの大きいセンサでは大きくします";
            gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
                "local gravity in the unit of the data" / "その場所の重力加速度 (データと同じ単位)";
            minAccScale: f64 = 0.9, [""] "smallest scale" / "スケールの下限":
                "a scale below this is an error" / "これより小さいスケールはエラーになります";
            maxAccScale: f64 = 1.1, [""] "largest scale" / "スケールの上限":
                "a scale above this is an error" / "これより大きいスケールはエラーになります";)
            -> $ret, $ret_en / $ret_ja;
            example $example;
            {
                let settings = SixFaceSettings {
                    window_s: windowSec,
                    step_s: stepSec,
                    max_tilt_rad: maxTiltRad,
                    variance_max: varThreshold,
                    gravity_m_s2: gravity,
                    min_acc_scale: minAccScale,
                    max_acc_scale: maxAccScale,
                };
                let nine = calibration::nine(dataRange.rows, dt, &settings)?;
                let result: fn([f64; 9]) -> $ret = $result;
                result(nine)
            }
        }
    };
}

pub(super) const GET_BIAS_CALIB: Function = six_face! {
    "GetBiasCalib" = GetBiasCalibrationParameters6, "=GetBiasCalib(B2:G9241,0.01)";
    "Calibrates from six faces at rest: accelerometer bias and scale, gyroscope bias."
        / "6 面の静止データから、加速度のバイアスとスケール、ジャイロのバイアスを推定します。";
    [f64; 9], "acc bias x, y, z; acc scale x, y, z; gyro bias x, y, z"
        / "加速度バイアス x, y, z、加速度スケール x, y, z、ジャイロバイアス x, y, z";
    GET_BIAS_CALIB;
    |nine| nine
};

pub(super) const GET_IMU_CALIB: Function = six_face! {
    "GetIMUCalib" = GetIMUCalibrationParameters6, "=GetIMUCalib(B2:G9241,0.01)";
    "As GetBiasCalib, followed by the gyroscope's scale, which six faces cannot show: 1, 1, 1."
        / "GetBiasCalib の結果に、ジャイロのスケール (6 面では求められないため 1, 1, 1) を加えて返します。";
    [f64; 12], "the nine of GetBiasCalib; gyro scale 1, 1, 1"
        / "GetBiasCalib の 9 個、ジャイロスケール 1, 1, 1";
    GET_IMU_CALIB;
    |n| [n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], 1.0, 1.0, 1.0]
};

pub(super) const APPLY_IMU_CALIB: Function = function! {
    "ApplyIMUCalib" = ApplyIMUCalibration in Readings, "=ApplyIMUCalib(B2:G9241,I1:T1)";
    "Applies a calibration to every row: (x − bias) × scale."
        / "各行にキャリブレーションを適用します: (x − バイアス) × スケール。";
    (dataRange: SixColumns<'_>, ["m/s², rad/s"] "readings" / "計測データ":
        "N×3 (one sensor) or N×6 (acceleration, then rate)"
        / "N 行 3 列 (一つのセンサ)、または N 行 6 列 (加速度、ジャイロの順)";
    calibRange: CalibParameters, [""] "parameters" / "パラメータ":
        "6 values (bias, scale) for N×3; the 12 of GetIMUCalib for N×6"
        / "N 行 3 列には 6 個 (バイアス、スケール)、N 行 6 列には GetIMUCalib の 12 個";)
    -> SameAsFirst, "corrected readings, as dataRange" / "補正後のデータ (dataRange と同じ形)";
    example APPLY_IMU_CALIB;
    calibration::apply(dataRange, calibRange)?
};
