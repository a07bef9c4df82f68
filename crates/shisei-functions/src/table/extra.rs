//! Beyond the 44: why a calibration fails, the sentence behind an error, and what the published add-in lacks.

use crate::function::{Function, function};
use crate::input::{Series, UnitQuat};
use crate::last_error;
use crate::output::Table;
use crate::table::{calibration, estimate, filtered, motion};
use shisei_core::calibration::SixFaceSettings;
use shisei_core::filter::Complementary;
use shisei_core::sphere::fit_sphere;

pub(super) const CALIB_FACES: Function = function! {
    "CalibFaces" = GetCalibrationFaces in Extra, "=CalibFaces(B2:G9241,0.01)";
    "Shows why a calibration fails: for each face the steadiest window that points at it, \
     or where none does the one that points nearest to it."
        / "キャリブレーションが失敗する理由を調べます。面ごとに、その面を向いた最も静かな窓を、\
           なければ最も近い向きの窓を返します。";
    (dataRange: Series<'_, 6>, ["m/s², rad/s"] "readings" / "計測データ":
        "N×6: accX, accY, accZ, gyroX, gyroY, gyroZ" / "N 行 6 列: 加速度 x, y, z、ジャイロ x, y, z";
    dt: f64, ["s"] "sample interval" / "サンプル間隔": "time from row to row" / "行と行の時間間隔";
    windowSec: f64 = 3.0, ["s"] "window" / "窓の長さ": "as in GetIMUCalib" / "GetIMUCalib と同じ";
    stepSec: f64 = 0.1, ["s"] "step" / "探索の刻み": "as in GetIMUCalib" / "GetIMUCalib と同じ";
    maxTiltRad: f64 = 0.2617993877991494, ["rad"] "largest tilt" / "許容する傾き":
        "as in GetIMUCalib" / "GetIMUCalib と同じ";
    varThreshold: f64 = 0.01, ["(m/s²)²"] "largest variance" / "分散のしきい値":
        "as in GetIMUCalib" / "GetIMUCalib と同じ";)
    -> Table<6, 5>, "rows +x, −x, +y, −y, +z, −z up; columns found (1 or 0), start s, worst variance, tilt rad, |a|"
        / "行は +x, −x, +y, −y, +z, −z が上の面。列は 検出 (1 か 0)、開始時刻 (s)、最大の分散、傾き (rad)、|a|";
    example CALIB_FACES;
    {
        let settings = SixFaceSettings {
            window_s: windowSec,
            step_s: stepSec,
            max_tilt_rad: maxTiltRad,
            variance_max: varThreshold,
            ..SixFaceSettings::default()
        };
        calibration::faces(dataRange.rows, dt, &settings)?
    }
};

pub(super) const SHISEI_LAST_ERROR: Function = function! {
    "ShiseiLastError" = GetShiseiLastError in Extra, "=ShiseiLastError()";
    "The sentence behind the latest error of a shisei function: what was wrong, where, and what to do."
        / "shisei の関数で最後に起きたエラーの説明 (何が、どこで、どうすればよいか) を返します。";
    ()
    -> String, "a sentence, empty when there was no error" / "説明の文。エラーがなければ空です";
    example SHISEI_LAST_ERROR;
    last_error::of_all(last_error::user_lang())
};

pub(super) const SHISEI_VERSION: Function = function! {
    "ShiseiVersion" = GetShiseiVersion in Extra, "=ShiseiVersion()";
    "The version of shisei." / "shisei のバージョンを返します。";
    ()
    -> String, "for example 0.1.0" / "例: 0.1.0";
    example SHISEI_VERSION;
    String::from(crate::VERSION)
};

pub(super) const UPDATE_QUATS_BY_COMPLEMENTARY: Function = function! {
    "UpdateQuatsByComplementary" = UpdateQuaternionSeriesByComplementary in Extra,
    "=UpdateQuatsByComplementary(A2:D2,F2:H101,J2:L101,0.01)";
    "Attitudes of a series with the complementary filter: the gyroscope, and while 0.5 < |a|/g < 1.5 \
     a share of the accelerometer's roll and pitch."
        / "相補フィルタで系列の姿勢を求めます (ジャイロの積分に、0.5 < |a|/g < 1.5 の間だけ加速度による傾きを混ぜます)。";
    (qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢":
        "attitude before the first row: w, x, y, z" / "1 行目より前の姿勢 w, x, y, z";
    gyro: Series<'_, 3>, ["rad/s"] "rates" / "ジャイロ系列":
        "N×3, one sample a row" / "N 行 3 列、1 行に 1 サンプル";
    acc: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
        "N×3, the same rows" / "N 行 3 列、ジャイロと同じ行数";
    dt: f64, ["s"] "sample interval" / "サンプル間隔": "time from row to row" / "行と行の時間間隔";
    alpha: f64 = 0.98, [""] "gyro's share" / "ジャイロの比率":
        "0 … 1; nearer to 1 trusts the gyroscope more" / "0 ～ 1。1 に近いほどジャイロを重視します";
    gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
        "|a| at rest in the unit of the data" / "静止時の |a| (データと同じ単位)";)
    -> Vec<[f64; 4]>, "w, x, y, z" / "w, x, y, z";
    example UPDATE_QUATS_BY_COMPLEMENTARY;
    filtered(Complementary::new(qInitial.0, alpha, gravity)?, gyro.rows, acc.rows, dt)?
};

pub(super) const DEAD_RECKON: Function = function! {
    "DeadReckon" = GetDeadReckoning in Extra, "=DeadReckon(A2:D2,F2:H101,J2:L101,0.01)";
    "Velocity and position by integrating gyroscope and accelerometer from rest; drifts fast, \
     so use it for seconds and remove the gyroscope's bias first."
        / "静止状態からジャイロと加速度を積分して速度と位置を求めます。誤差は急速に増えるため、\
           数秒の区間に、ジャイロのバイアスを除いてからお使いください。";
    (qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢":
        "attitude before the first row: w, x, y, z" / "1 行目より前の姿勢 w, x, y, z";
    gyro: Series<'_, 3>, ["rad/s"] "rates" / "ジャイロ系列":
        "N×3, one sample a row, bias removed" / "N 行 3 列、1 行に 1 サンプル、バイアス除去後";
    acc: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
        "N×3, the same rows" / "N 行 3 列、ジャイロと同じ行数";
    dt: f64, ["s"] "sample interval" / "サンプル間隔": "time from row to row" / "行と行の時間間隔";
    gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
        "mean |a| at rest (MeanNorm); it is subtracted from world z"
        / "静止時の |a| の平均 (MeanNorm)。ワールド z から引きます";
    scheme: f64 = 0.0, [""] "scheme" / "積分法":
        "0 semi-implicit (new v moves p), 1 Euler (old v), 2 trapezoid (mean of both)"
        / "0 半陰的 (新しい v で p を更新)、1 オイラー (前の v)、2 台形 (両者の平均)";)
    -> Vec<[f64; 6]>, "velocity x, y, z, m/s; position x, y, z, m; world axes"
        / "速度 x, y, z (m/s)、位置 x, y, z (m)、ワールド座標";
    example DEAD_RECKON;
    motion::dead_reckon(qInitial.0, gyro.rows, acc.rows, dt, gravity, scheme)?
};

/// Two functions with the same arguments: the estimator's attitudes as quaternions (4) or yaw, pitch, roll (3).
macro_rules! estimate {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $cols:literal, $ret_en:literal / $ret_ja:literal; $example:ident) => {
        function! {
            $name = $export in Extra, $formula;
            $en / $ja;
            (gyro: Series<'_, 3>, ["rad/s"] "rates" / "ジャイロ系列":
                "N×3, one sample a row, as measured" / "N 行 3 列、1 行に 1 サンプル、計測したまま";
            acc: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
                "N×3, the same rows" / "N 行 3 列、ジャイロと同じ行数";
            dt: f64, ["s"] "sample interval" / "サンプル間隔":
                "time from row to row" / "行と行の時間間隔";
            gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
                "local gravity" / "その場所の重力加速度";)
            -> Vec<[f64; $cols]>, $ret_en / $ret_ja;
            example $example;
            estimate::smoothed(gyro.rows, acc.rows, dt, gravity)?
        }
    };
}

pub(super) const ESTIMATE_QUATS: Function = estimate! {
    "EstimateQuats" = EstimateQuaternionSeries, "=EstimateQuats(E2:G1672,B2:D1672,0.01)";
    "Attitudes of a whole recording with the best estimator: it finds the start and the rests, learns bias and \
     scale, and uses later samples too. Yaw is 0 at the start; give the whole recording, with its rests."
        / "最も精度の高い推定器で、記録全体の姿勢を求めます。開始姿勢と静止区間を自動で見つけ、バイアスとスケールを\
           学習し、後のサンプルも使います。開始時のヨーは 0 です。静止区間を含む記録全体を指定してください。";
    4, "w, x, y, z" / "w, x, y, z"; ESTIMATE_QUATS
};

pub(super) const ESTIMATE_YPRS: Function = estimate! {
    "EstimateYprs" = EstimateYawPitchRollSeries, "=EstimateYprs(E2:G1672,B2:D1672,0.01)";
    "Yaw, pitch, roll of EstimateQuats." / "EstimateQuats の結果をヨー・ピッチ・ロールで返します。";
    3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; ESTIMATE_YPRS
};

pub(super) const FIT_SPHERE: Function = function! {
    "FitSphere" = GetSphereFit in Extra, "=FitSphere(A2:C9)";
    "The sphere nearest to points, by least squares: for mean rates in several directions its radius is the Earth's rate."
        / "点群に最も近い球を最小二乗法で求めます。複数の方向で測った角速度の平均なら、半径が地球の自転角速度です。";
    (points: Series<'_, 3>, [""] "points" / "点群": "N×3, at least four points" / "N 行 3 列、4 点以上";)
    -> [f64; 4], "centre x, y, z; radius" / "中心 x, y, z、半径";
    example FIT_SPHERE;
    {
        let sphere = fit_sphere(points.rows)?;
        [sphere.center[0], sphere.center[1], sphere.center[2], sphere.radius]
    }
};
