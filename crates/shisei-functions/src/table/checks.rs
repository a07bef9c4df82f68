//! TRUE or FALSE about data.

use crate::function::{Function, function};
use crate::input::{RawQuat, Series};
use shisei_core::{Vec3, rest, vector};

pub(super) const IS_ACC_STABLE: Function = function! {
    "IsAccStable" = IsStableAccWindow in Checks, "=IsAccStable(B2:D301,0.02,9.6,10)";
    "TRUE when accelerations are at rest: every axis' variance and the mean norm are within their limits."
        / "加速度系列が静止しているとき TRUE を返します (各軸の分散とノルムの平均が範囲内)。";
    (accRange: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
        "N×3, one sample a row" / "N 行 3 列、1 行に 1 サンプル";
    varThreshold: f64, ["(m/s²)²"] "largest variance" / "分散のしきい値":
        "largest variance of an axis at rest" / "静止とみなす各軸の分散の上限";
    normMeanMin: f64, ["m/s²"] "smallest mean norm" / "平均ノルムの下限":
        "smallest mean length at rest" / "静止とみなすノルムの平均の下限";
    normMeanMax: f64, ["m/s²"] "largest mean norm" / "平均ノルムの上限":
        "largest mean length at rest" / "静止とみなすノルムの平均の上限";)
    -> bool, "TRUE at rest" / "静止していれば TRUE";
    example IS_ACC_STABLE;
    rest::is_stable(accRange.rows, varThreshold, normMeanMin, normMeanMax)?
};

pub(super) const IS_FINITE_QUAT: Function = function! {
    "IsFiniteQuat" = IsFiniteQuaternion in Checks, "=IsFiniteQuat(A2:D2)";
    "TRUE when all four components are finite numbers; FALSE also for an error cell."
        / "四つの成分がすべて有限の数値なら TRUE を返します。エラーのセルがあれば FALSE です。";
    (quat: RawQuat, [""] "quaternion" / "クォータニオン": "w, x, y, z" / "w, x, y, z";)
    -> bool, "TRUE when finite" / "有限なら TRUE";
    example IS_FINITE_QUAT, takes_not_finite true;
    quat.0.is_finite()
};

pub(super) const IS_FINITE_VEC3: Function = function! {
    "IsFiniteVec3" = IsFiniteVector3 in Checks, "=IsFiniteVec3(F2:H2)";
    "TRUE when all three components are finite numbers; FALSE also for an error cell."
        / "三つの成分がすべて有限の数値なら TRUE を返します。エラーのセルがあれば FALSE です。";
    (vec: Vec3, [""] "vector" / "ベクトル": "x, y, z" / "x, y, z";)
    -> bool, "TRUE when finite" / "有限なら TRUE";
    example IS_FINITE_VEC3, takes_not_finite true;
    vector::is_finite(vec)
};
