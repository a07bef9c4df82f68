//! The attitude at rest, and attitudes relative to it.

use crate::function::{Function, function};
use crate::input::{Series, UnitQuat};
use crate::table::series;
use shisei_core::{Quaternion, Ypr, initial, relative};
use shisei_wide::Vectors;

pub(super) const ACCS2INITIAL_QUAT: Function = function! {
    "Accs2InitialQuat" = GetInitialQuaternionFromAcc in Relative, "=Accs2InitialQuat(B2:D301,0.02,9.6,10)";
    "The attitude of a sensor at rest from its mean acceleration, with yaw 0; #N/A unless IsAccStable."
        / "静止中の加速度の平均から姿勢を求めます (ヨーは 0)。IsAccStable を満たさないときは #N/A です。";
    (accRange: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
        "N×3, at rest" / "N 行 3 列、静止中のもの";
    varThreshold: f64, ["(m/s²)²"] "largest variance" / "分散のしきい値":
        "largest variance of an axis at rest" / "静止とみなす各軸の分散の上限";
    normMeanMin: f64, ["m/s²"] "smallest mean norm" / "平均ノルムの下限":
        "smallest mean length at rest" / "静止とみなすノルムの平均の下限";
    normMeanMax: f64, ["m/s²"] "largest mean norm" / "平均ノルムの上限":
        "largest mean length at rest" / "静止とみなすノルムの平均の上限";)
    -> Quaternion, "w, x, y, z" / "w, x, y, z";
    example ACCS2INITIAL_QUAT;
    initial::from_stable_window(accRange.rows, varThreshold, normMeanMin, normMeanMax)?
};

/// Four functions of one quaternion and four of a series have the same arguments.
macro_rules! relative {
    (one $name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $ret:ty, $ret_en:literal / $ret_ja:literal; $example:ident; $code:expr) => {
        function! {
            $name = $export in Relative, $formula;
            $en / $ja;
            (qCurrent: UnitQuat, [""] "attitude now" / "現在の姿勢": "w, x, y, z" / "w, x, y, z";
            qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢": "w, x, y, z" / "w, x, y, z";)
            -> $ret, $ret_en / $ret_ja;
            example $example;
            <$ret>::from($code(qCurrent.0, qInitial.0)?)
        }
    };
    (series $name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $cols:literal, $ret_en:literal / $ret_ja:literal; $example:ident; $code:ident) => {
        function! {
            $name = $export in Relative, $formula;
            $en / $ja;
            (quats: Series<'_, 4>, [""] "attitudes" / "姿勢の系列":
                "N×4, one quaternion a row" / "N 行 4 列、1 行に 1 クォータニオン";
            qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢": "w, x, y, z" / "w, x, y, z";)
            -> Vec<[f64; $cols]>, $ret_en / $ret_ja;
            example $example;
            series("quats", quats.rows.len(), |out| Vectors::widest().$code(quats.rows, qInitial.0, out))?
        }
    };
}

pub(super) const QUAT2BODY_QUAT: Function = relative! {
    one "Quat2BodyQuat" = GetBodyQuaternion, "=Quat2BodyQuat(A3:D3,$A$2:$D$2)";
    "The turn since the start, seen in the sensor's axes at the start: qInitial* qCurrent."
        / "開始時からの回転を、開始時のセンサ軸で表します (qInitial* qCurrent)。";
    Quaternion, "w, x, y, z" / "w, x, y, z"; QUAT2BODY_QUAT; relative::body
};

pub(super) const QUAT2BODY_YPR: Function = relative! {
    one "Quat2BodyYpr" = GetBodyYawPitchRoll, "=Quat2BodyYpr(A3:D3,$A$2:$D$2)";
    "Yaw, pitch, roll of Quat2BodyQuat: the turn since the start in the sensor's axes."
        / "Quat2BodyQuat のヨー・ピッチ・ロール (センサ軸で見た、開始時からの回転) を返します。";
    Ypr, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; QUAT2BODY_YPR; relative::body
};

pub(super) const QUAT2WORLD_QUAT: Function = relative! {
    one "Quat2WorldQuat" = GetWorldQuaternion, "=Quat2WorldQuat(A3:D3,$A$2:$D$2)";
    "The turn since the start, seen in world axes: qCurrent qInitial*."
        / "開始時からの回転を、ワールド軸で表します (qCurrent qInitial*)。";
    Quaternion, "w, x, y, z" / "w, x, y, z"; QUAT2WORLD_QUAT; relative::world
};

pub(super) const QUAT2WORLD_YPR: Function = relative! {
    one "Quat2WorldYpr" = GetWorldYawPitchRoll, "=Quat2WorldYpr(A3:D3,$A$2:$D$2)";
    "Yaw, pitch, roll of Quat2WorldQuat: the turn since the start in world axes."
        / "Quat2WorldQuat のヨー・ピッチ・ロール (ワールド軸で見た、開始時からの回転) を返します。";
    Ypr, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; QUAT2WORLD_YPR; relative::world
};

pub(super) const QUATS2BODY_QUATS: Function = relative! {
    series "Quats2BodyQuats" = GetBodyQuaternionSeries, "=Quats2BodyQuats(A2:D101,$A$2:$D$2)";
    "Quat2BodyQuat of every row of a series." / "系列の各行について Quat2BodyQuat を返します。";
    4, "w, x, y, z" / "w, x, y, z"; QUATS2BODY_QUATS; body_series
};

pub(super) const QUATS2BODY_YPRS: Function = relative! {
    series "Quats2BodyYprs" = GetBodyYawPitchRollSeries, "=Quats2BodyYprs(A2:D101,$A$2:$D$2)";
    "Quat2BodyYpr of every row of a series." / "系列の各行について Quat2BodyYpr を返します。";
    3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; QUATS2BODY_YPRS; body_series
};

pub(super) const QUATS2WORLD_QUATS: Function = relative! {
    series "Quats2WorldQuats" = GetWorldQuaternionSeries, "=Quats2WorldQuats(A2:D101,$A$2:$D$2)";
    "Quat2WorldQuat of every row of a series." / "系列の各行について Quat2WorldQuat を返します。";
    4, "w, x, y, z" / "w, x, y, z"; QUATS2WORLD_QUATS; world_series
};

pub(super) const QUATS2WORLD_YPRS: Function = relative! {
    series "Quats2WorldYprs" = GetWorldYawPitchRollSeries, "=Quats2WorldYprs(I301:L1672,I301:L301)";
    "Quat2WorldYpr of every row of a series." / "系列の各行について Quat2WorldYpr を返します。";
    3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; QUATS2WORLD_YPRS; world_series
};
