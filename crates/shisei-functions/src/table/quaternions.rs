//! Quaternions, the vectors they turn, and yaw, pitch, roll.

use crate::function::{Function, function};
use crate::input::{FiniteVec3, RawQuat, Series, UnitQuat};
use crate::table::series;
use shisei_core::{Quaternion, Vec3, Ypr, relative};
use shisei_wide::Vectors;

pub(super) const IDENTITY_QUAT: Function = function! {
    "IdentityQuat" = IdentityQuaternion in Quaternions, "=IdentityQuat()";
    "The quaternion of no rotation, 1, 0, 0, 0." / "回転しないことを表すクォータニオン 1, 0, 0, 0 を返します。";
    ()
    -> Quaternion, "w, x, y, z" / "w, x, y, z";
    example IDENTITY_QUAT;
    Quaternion::IDENTITY
};

pub(super) const NORMALIZE_QUAT: Function = function! {
    "NormalizeQuat" = NormalizeQuaternion in Quaternions, "=NormalizeQuat(A2:D2)";
    "The quaternion divided by its norm." / "クォータニオンを正規化し、ノルムを 1 にします。";
    (quat: UnitQuat, [""] "quaternion" / "クォータニオン": "w, x, y, z" / "w, x, y, z";)
    -> Quaternion, "w, x, y, z" / "w, x, y, z";
    example NORMALIZE_QUAT;
    quat.0
};

pub(super) const CONJUGATE_QUAT: Function = function! {
    "ConjugateQuat" = ConjugateQuaternion in Quaternions, "=ConjugateQuat(A2:D2)";
    "The conjugate w, −x, −y, −z: the inverse rotation of a unit quaternion. It is not normalised."
        / "共役 w, −x, −y, −z を返します。単位クォータニオンなら逆回転です。正規化はしません。";
    (quat: RawQuat, [""] "quaternion" / "クォータニオン": "w, x, y, z" / "w, x, y, z";)
    -> Quaternion, "w, x, y, z" / "w, x, y, z";
    example CONJUGATE_QUAT;
    quat.finite("quat")?.conjugate()
};

pub(super) const QUAT_ROTATE_VEC3: Function = function! {
    "QuatRotateVec3" = QuaternionRotateVector3 in Rotation, "=QuatRotateVec3(A2:D2,F2:H2)";
    "Turns a vector from sensor to world coordinates: q v q*."
        / "ベクトルをセンサ座標からワールド座標へ回転します (q v q*)。";
    (quat: UnitQuat, [""] "quaternion" / "クォータニオン": "w, x, y, z" / "w, x, y, z";
    vec: FiniteVec3, [""] "vector" / "ベクトル": "x, y, z in sensor coordinates" / "センサ座標の x, y, z";)
    -> Vec3, "x, y, z in world coordinates" / "ワールド座標の x, y, z";
    example QUAT_ROTATE_VEC3;
    quat.0.rotate(vec.0)
};

pub(super) const QUATS_ROTATE_VEC3: Function = function! {
    "QuatsRotateVec3" = QuaternionSeriesRotateVector3 in Rotation, "=QuatsRotateVec3(A2:D101,F2:H2)";
    "Turns the same vector by every quaternion of a series."
        / "同じベクトルを、系列の各クォータニオンで回転します。";
    (quats: Series<'_, 4>, [""] "quaternions" / "クォータニオン系列":
        "N×4, one quaternion a row" / "N 行 4 列、1 行に 1 クォータニオン";
    vec: FiniteVec3, [""] "vector" / "ベクトル": "x, y, z in sensor coordinates" / "センサ座標の x, y, z";)
    -> Vec<Vec3>, "x, y, z in world coordinates" / "ワールド座標の x, y, z";
    example QUATS_ROTATE_VEC3;
    series("quats", quats.rows.len(), |out| relative::rotate_series(quats.rows, vec.0, out))?
};

pub(super) const QUAT2YPR: Function = function! {
    "Quat2Ypr" = GetYawPitchRoll in Conversion, "=Quat2Ypr(A2:D2)";
    "Yaw, pitch, roll of a quaternion: about z, then the turned y, then the turned x. \
     At pitch ±90° roll is 0 and yaw carries the rest."
        / "クォータニオンをヨー・ピッチ・ロールに変換します (z、回転後の y、回転後の x の順)。\
           ピッチが ±90° のとき、ロールは 0 とし、残りをヨーで表します。";
    (quat: UnitQuat, [""] "quaternion" / "クォータニオン": "w, x, y, z" / "w, x, y, z";)
    -> Ypr, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)";
    example QUAT2YPR;
    quat.0.to_ypr()
};

pub(super) const QUATS2YPRS: Function = function! {
    "Quats2Yprs" = GetYawPitchRollSeries in Conversion, "=Quats2Yprs(A2:D101)";
    "Yaw, pitch, roll of every quaternion of a series."
        / "クォータニオン系列をヨー・ピッチ・ロールの系列に変換します。";
    (quats: Series<'_, 4>, [""] "quaternions" / "クォータニオン系列":
        "N×4, one quaternion a row" / "N 行 4 列、1 行に 1 クォータニオン";)
    -> Vec<Vec3>, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)";
    example QUATS2YPRS;
    series("quats", quats.rows.len(), |out| Vectors::widest().convert_series(quats.rows, out))?
};

pub(super) const YPR2QUAT: Function = function! {
    "Ypr2Quat" = GetQuaternionFromYawPitchRoll in Conversion, "=Ypr2Quat(A2:C2)";
    "The quaternion of yaw, pitch, roll." / "ヨー・ピッチ・ロールからクォータニオンを作ります。";
    (ypr: FiniteVec3, ["rad"] "yaw, pitch, roll" / "ヨー・ピッチ・ロール":
        "yaw, pitch, roll" / "ヨー、ピッチ、ロールの順";)
    -> Quaternion, "w, x, y, z" / "w, x, y, z";
    example YPR2QUAT;
    Quaternion::from_ypr(Ypr::from_array(ypr.0))
};

pub(super) const YPRS2QUATS: Function = function! {
    "Yprs2Quats" = GetQuaternionSeriesFromYawPitchRollSeries in Conversion, "=Yprs2Quats(A2:C101)";
    "The quaternions of a series of yaw, pitch, roll."
        / "ヨー・ピッチ・ロールの系列をクォータニオン系列に変換します。";
    (yprs: Series<'_, 3>, ["rad"] "yaw, pitch, roll" / "ヨー・ピッチ・ロール系列":
        "N×3, yaw, pitch, roll in each row" / "N 行 3 列、各行にヨー、ピッチ、ロール";)
    -> Vec<[f64; 4]>, "w, x, y, z" / "w, x, y, z";
    example YPRS2QUATS;
    series("yprs", yprs.rows.len(), |out| relative::from_ypr_series(yprs.rows, out))?
};

pub(super) const AXIS_ANGLE2QUAT: Function = function! {
    "AxisAngle2Quat" = GetQuaternionFromAxisAngle in Conversion, "=AxisAngle2Quat(0,0,1,PI()/2)";
    "The quaternion of a turn about an axis; the axis may have any length but zero."
        / "回転軸と角度からクォータニオンを作ります。軸の長さは 0 以外なら何でもかまいません。";
    (ax: f64, [""] "axis x" / "軸 x": "x of the axis" / "回転軸の x 成分";
    ay: f64, [""] "axis y" / "軸 y": "y of the axis" / "回転軸の y 成分";
    az: f64, [""] "axis z" / "軸 z": "z of the axis" / "回転軸の z 成分";
    angleRad: f64, ["rad"] "angle" / "角度":
        "angle, counter-clockwise when the axis points at you" / "回転角。軸の正の向きに対して右ねじの回転が正";)
    -> Quaternion, "w, x, y, z" / "w, x, y, z";
    example AXIS_ANGLE2QUAT;
    Quaternion::from_axis_angle([ax, ay, az], angleRad)?
};

pub(super) const GRAVITY_BODY: Function = function! {
    "GravityBody" = GetGravityBody in Conversion, "=GravityBody(A2:D2)";
    "What a resting accelerometer in this attitude reads, divided by g: world up in sensor coordinates."
        / "その姿勢で静止した加速度計の値を g で割ったもの (センサ座標で見た鉛直上向きの単位ベクトル) を返します。";
    (quat: UnitQuat, [""] "quaternion" / "クォータニオン": "w, x, y, z" / "w, x, y, z";)
    -> Vec3, "unit vector x, y, z" / "単位ベクトル x, y, z";
    example GRAVITY_BODY;
    quat.0.up_body()
};
