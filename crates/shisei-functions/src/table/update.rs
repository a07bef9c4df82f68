//! Attitude from gyroscope and accelerometer.

use crate::function::{Function, function};
use crate::input::{FiniteVec3, Series, UnitQuat};
use crate::table::{filtered, series};
use shisei_core::filter::{
    AdaptiveGain, Dt, Filter, GyroIntegrator, GyroOnly, GyroRk4, Mahony, MahonyAdaptive,
};
use shisei_core::{Quaternion, Result, Vec3, Ypr};
use shisei_wide::Vectors;

/// One sample: a gyroscope step.
macro_rules! gyro_step {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal; $filter:ident; $example:ident) => {
        function! {
            $name = $export in Update, $formula;
            $en / $ja;
            (q: UnitQuat, [""] "attitude" / "姿勢": "attitude before the sample: w, x, y, z" / "サンプル前の姿勢 w, x, y, z";
            gyro: FiniteVec3, ["rad/s"] "rate" / "ジャイロ": "x, y, z in sensor axes" / "センサ軸の x, y, z";
            dt: f64, ["s"] "sample interval" / "サンプル間隔": "length of the step" / "1 ステップの時間";)
            -> Quaternion, "attitude after the sample: w, x, y, z" / "サンプル後の姿勢 w, x, y, z";
            example $example;
            {
                Dt::Constant(dt).check(1)?;
                $filter::new(q.0)?.update_gyro(gyro.0, dt)
            }
        }
    };
}

pub(super) const UPDATE_QUAT_BY_GYRO: Function = gyro_step! {
    "UpdateQuatByGyro" = UpdateQuaternionByGyro, "=UpdateQuatByGyro(A2:D2,F2:H2,0.01)";
    "Turns an attitude by one gyroscope sample; exact where the rate is constant over the step."
        / "ジャイロ 1 サンプルで姿勢を更新します。ステップ内で角速度が一定なら厳密です。";
    GyroIntegrator; UPDATE_QUAT_BY_GYRO
};

pub(super) const UPDATE_QUAT_BY_GYRO_RK4: Function = gyro_step! {
    "UpdateQuatByGyroRK4" = UpdateQuaternionByGyroRK4, "=UpdateQuatByGyroRK4(A2:D2,F2:H2,0.01)";
    "Turns an attitude by one gyroscope sample with the classical Runge-Kutta method of fourth order."
        / "ジャイロ 1 サンプルで、4 次の Runge-Kutta 法により姿勢を更新します。";
    GyroRk4; UPDATE_QUAT_BY_GYRO_RK4
};

/// A series of gyroscope steps, as quaternions (4) or yaw, pitch, roll (3).
macro_rules! gyro_series {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal; $filter:ident;
     $cols:literal, $ret_en:literal / $ret_ja:literal; $example:ident) => {
        function! {
            $name = $export in Update, $formula;
            $en / $ja;
            (qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢":
                "attitude before the first row: w, x, y, z" / "1 行目より前の姿勢 w, x, y, z";
            gyro: Series<'_, 3>, ["rad/s"] "rates" / "ジャイロ系列":
                "N×3, one sample a row" / "N 行 3 列、1 行に 1 サンプル";
            dt: f64, ["s"] "sample interval" / "サンプル間隔":
                "time from row to row" / "行と行の時間間隔";)
            -> Vec<[f64; $cols]>, $ret_en / $ret_ja;
            example $example;
            {
                let mut filter = $filter::new(qInitial.0)?;
                series("gyro", gyro.rows.len(), |out| {
                    Vectors::widest().run_gyro_into(&mut filter, gyro.rows, Dt::Constant(dt), out)
                })?
            }
        }
    };
}

pub(super) const UPDATE_QUATS_BY_GYRO: Function = gyro_series! {
    "UpdateQuatsByGyro" = UpdateQuaternionSeriesByGyro, "=UpdateQuatsByGyro(A2:D2,F2:H101,0.01)";
    "Integrates a series of rates; row k is the attitude after sample k."
        / "ジャイロ系列を積分し、各サンプル後の姿勢を返します。";
    GyroIntegrator; 4, "w, x, y, z" / "w, x, y, z"; UPDATE_QUATS_BY_GYRO
};

pub(super) const UPDATE_QUATS_BY_GYRO_RK4: Function = gyro_series! {
    "UpdateQuatsByGyroRK4" = UpdateQuaternionSeriesByGyroRK4, "=UpdateQuatsByGyroRK4(A2:D2,F2:H101,0.01)";
    "As UpdateQuatsByGyro, with the Runge-Kutta method of fourth order."
        / "UpdateQuatsByGyro と同じ計算を 4 次の Runge-Kutta 法で行います。";
    GyroRk4; 4, "w, x, y, z" / "w, x, y, z"; UPDATE_QUATS_BY_GYRO_RK4
};

pub(super) const UPDATE_YPRS_BY_GYRO: Function = gyro_series! {
    "UpdateYprsByGyro" = UpdateYawPitchRollSeriesByGyro, "=UpdateYprsByGyro(A2:D2,F2:H101,0.01)";
    "Integrates a series of rates; row k is yaw, pitch, roll after sample k."
        / "ジャイロ系列を積分し、各サンプル後のヨー・ピッチ・ロールを返します。";
    GyroIntegrator; 3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; UPDATE_YPRS_BY_GYRO
};

pub(super) const UPDATE_YPRS_BY_GYRO_RK4: Function = gyro_series! {
    "UpdateYprsByGyroRK4" = UpdateYawPitchRollSeriesByGyroRK4, "=UpdateYprsByGyroRK4(A2:D2,F2:H101,0.01)";
    "As UpdateYprsByGyro, with the Runge-Kutta method of fourth order."
        / "UpdateYprsByGyro と同じ計算を 4 次の Runge-Kutta 法で行います。";
    GyroRk4; 3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; UPDATE_YPRS_BY_GYRO_RK4
};

/// One Mahony step from an attitude; the integral starts at 0.
macro_rules! mahony_step {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $ret:ty, $ret_en:literal / $ret_ja:literal; $example:ident) => {
        function! {
            $name = $export in Update, $formula;
            $en / $ja;
            (q: UnitQuat, [""] "attitude" / "姿勢": "attitude before the sample: w, x, y, z" / "サンプル前の姿勢 w, x, y, z";
            gyro: FiniteVec3, ["rad/s"] "rate" / "ジャイロ": "x, y, z in sensor axes" / "センサ軸の x, y, z";
            acc: FiniteVec3, ["m/s²"] "acceleration" / "加速度": "x, y, z in sensor axes" / "センサ軸の x, y, z";
            dt: f64, ["s"] "sample interval" / "サンプル間隔": "length of the step" / "1 ステップの時間";
            kp: f64, ["1/s"] "kp" / "kp":
                "how fast tilt follows the accelerometer; 1/kp is the time constant"
                / "傾きを加速度に合わせる速さ。1/kp が時定数です";
            gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
                "must be > 0; the result does not depend on it"
                / "0 より大きい値。結果はこの値によりません";)
            -> $ret, $ret_en / $ret_ja;
            example $example;
            <$ret>::from(mahony_step(q.0, gyro.0, acc.0, dt, kp, gravity)?)
        }
    };
}

pub(super) const UPDATE_QUAT_BY_MAHONY: Function = mahony_step! {
    "UpdateQuatByMahony" = UpdateQuaternionByMahony, "=UpdateQuatByMahony(A2:D2,F2:H2,J2:L2,0.01,2)";
    "Updates an attitude by one sample with Mahony's filter: the gyroscope, and a pull towards the accelerometer's vertical."
        / "Mahony フィルタで 1 サンプル分の姿勢を更新します (ジャイロの積分に、加速度による傾きの補正を加えます)。";
    Quaternion, "attitude after the sample: w, x, y, z" / "サンプル後の姿勢 w, x, y, z"; UPDATE_QUAT_BY_MAHONY
};

pub(super) const UPDATE_YPR_BY_MAHONY: Function = mahony_step! {
    "UpdateYprByMahony" = UpdateYawPitchRollByMahony, "=UpdateYprByMahony(A2:D2,F2:H2,J2:L2,0.01,2)";
    "Yaw, pitch, roll of UpdateQuatByMahony." / "UpdateQuatByMahony の結果をヨー・ピッチ・ロールで返します。";
    Ypr, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; UPDATE_YPR_BY_MAHONY
};

/// A series of Mahony steps.
macro_rules! mahony_series {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $cols:literal, $ret_en:literal / $ret_ja:literal; $example:ident) => {
        function! {
            $name = $export in Update, $formula;
            $en / $ja;
            (qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢":
                "attitude before the first row: w, x, y, z" / "1 行目より前の姿勢 w, x, y, z";
            gyro: Series<'_, 3>, ["rad/s"] "rates" / "ジャイロ系列":
                "N×3, one sample a row" / "N 行 3 列、1 行に 1 サンプル";
            acc: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
                "N×3, the same rows" / "N 行 3 列、ジャイロと同じ行数";
            dt: f64, ["s"] "sample interval" / "サンプル間隔": "time from row to row" / "行と行の時間間隔";
            kp: f64, ["1/s"] "kp" / "kp":
                "how fast tilt follows the accelerometer; 1/kp is the time constant"
                / "傾きを加速度に合わせる速さ。1/kp が時定数です";
            ki: f64, ["1/s²"] "ki" / "ki":
                "how fast a constant gyroscope bias is learnt; 0 switches it off"
                / "ジャイロの一定のバイアスを学習する速さ。0 なら学習しません";
            gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
                "must be > 0; the result does not depend on it" / "0 より大きい値。結果はこの値によりません";)
            -> Vec<[f64; $cols]>, $ret_en / $ret_ja;
            example $example;
            {
                positive("gravity", gravity)?;
                filtered(Mahony::new(qInitial.0, kp, ki)?, gyro.rows, acc.rows, dt)?
            }
        }
    };
}

pub(super) const UPDATE_QUATS_BY_MAHONY: Function = mahony_series! {
    "UpdateQuatsByMahony" = UpdateQuaternionSeriesByMahony,
    "=UpdateQuatsByMahony(I301:L301,E302:G1672,B302:D1672,0.01,2,0,9.80665)";
    "Attitudes of a series with Mahony's filter; row k is the attitude after sample k."
        / "Mahony フィルタで系列の姿勢を求めます。各行はそのサンプル後の姿勢です。";
    4, "w, x, y, z" / "w, x, y, z"; UPDATE_QUATS_BY_MAHONY
};

pub(super) const UPDATE_YPRS_BY_MAHONY: Function = mahony_series! {
    "UpdateYprsByMahony" = UpdateYawPitchRollSeriesByMahony,
    "=UpdateYprsByMahony(I301:L301,E302:G1672,B302:D1672,0.01,2,0,9.80665)";
    "Yaw, pitch, roll of UpdateQuatsByMahony." / "UpdateQuatsByMahony の結果をヨー・ピッチ・ロールで返します。";
    3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; UPDATE_YPRS_BY_MAHONY
};

/// The arguments all adaptive functions end with, after those that differ.
macro_rules! adaptive {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     ($($first:tt)*); $ret:ty, $ret_en:literal / $ret_ja:literal; $example:ident;
     |$dt:ident, $gain:ident, $ki:ident, $gravity:ident| $body:expr) => {
        function! {
            $name = $export in Update, $formula;
            $en / $ja;
            ($($first)*
            $dt: f64, ["s"] "sample interval" / "サンプル間隔": "time from sample to sample" / "サンプルとサンプルの時間間隔";
            kpMax: f64, ["1/s"] "largest kp" / "kp の最大値": "kp while |a| is near gravity" / "|a| が重力に近いときの kp";
            kpMin: f64, ["1/s"] "smallest kp" / "kp の最小値": "kp while |a| is far from gravity" / "|a| が重力から離れたときの kp";
            accelUpperStart: f64, ["m/s²"] "upper start" / "上側の開始": "|a| above which kp falls" / "これを超えると kp が下がり始めます";
            accelUpperEnd: f64, ["m/s²"] "upper end" / "上側の終了": "|a| from which kp is kpMin" / "これ以上で kp は kpMin になります";
            accelLowerStart: f64, ["m/s²"] "lower start" / "下側の開始": "|a| below which kp falls" / "これを下回ると kp が下がり始めます";
            accelLowerEnd: f64, ["m/s²"] "lower end" / "下側の終了": "|a| down to which kp falls to kpMin" / "これ以下で kp は kpMin になります";
            $ki: f64, ["1/s²"] "ki" / "ki":
                "how fast a constant gyroscope bias is learnt; 0 switches it off"
                / "ジャイロの一定のバイアスを学習する速さ。0 なら学習しません";
            $gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
                "|a| at rest in the unit of the data; 1 for data in g" / "静止時の |a| (データと同じ単位)。g 単位のデータなら 1";)
            -> $ret, $ret_en / $ret_ja;
            example $example;
            {
                let $gain = AdaptiveGain {
                    kp_max: kpMax,
                    kp_min: kpMin,
                    upper_start: accelUpperStart,
                    upper_end: accelUpperEnd,
                    lower_start: accelLowerStart,
                    lower_end: accelLowerEnd,
                };
                $body
            }
        }
    };
}

macro_rules! adaptive_step {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $ret:ty, $ret_en:literal / $ret_ja:literal; $example:ident) => {
        adaptive! {
            $name = $export, $formula; $en / $ja;
            (q: UnitQuat, [""] "attitude" / "姿勢": "attitude before the sample: w, x, y, z" / "サンプル前の姿勢 w, x, y, z";
            gyro: FiniteVec3, ["rad/s"] "rate" / "ジャイロ": "x, y, z in sensor axes" / "センサ軸の x, y, z";
            acc: FiniteVec3, ["m/s²"] "acceleration" / "加速度": "x, y, z in sensor axes" / "センサ軸の x, y, z";);
            $ret, $ret_en / $ret_ja; $example;
            |dt, gain, ki, gravity| {
                Dt::Constant(dt).check(1)?;
                let mut filter = MahonyAdaptive::new(q.0, gain, ki, gravity)?;
                <$ret>::from(filter.update(gyro.0, acc.0, dt))
            }
        }
    };
}

pub(super) const UPDATE_QUAT_BY_MAHONY_ADAPTIVE: Function = adaptive_step! {
    "UpdateQuatByMahonyAdaptive" = UpdateQuaternionByMahonyAdaptive,
    "=UpdateQuatByMahonyAdaptive(A2:D2,F2:H2,J2:L2,0.01,2,0.05,10.3,14.7,9.3,4.9,0)";
    "Updates an attitude by one sample with Mahony's filter whose gain falls while |a| is far from gravity."
        / "|a| が重力から離れるほど kp を下げる Mahony フィルタで、1 サンプル分の姿勢を更新します。";
    Quaternion, "attitude after the sample: w, x, y, z" / "サンプル後の姿勢 w, x, y, z";
    UPDATE_QUAT_BY_MAHONY_ADAPTIVE
};

pub(super) const UPDATE_YPR_BY_MAHONY_ADAPTIVE: Function = adaptive_step! {
    "UpdateYprByMahonyAdaptive" = UpdateYawPitchRollByMahonyAdaptive,
    "=UpdateYprByMahonyAdaptive(A2:D2,F2:H2,J2:L2,0.01,2,0.05,10.3,14.7,9.3,4.9,0)";
    "Yaw, pitch, roll of UpdateQuatByMahonyAdaptive."
        / "UpdateQuatByMahonyAdaptive の結果をヨー・ピッチ・ロールで返します。";
    Ypr, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; UPDATE_YPR_BY_MAHONY_ADAPTIVE
};

macro_rules! adaptive_series {
    ($name:literal = $export:ident, $formula:literal; $en:literal / $ja:literal;
     $cols:literal, $ret_en:literal / $ret_ja:literal; $example:ident) => {
        adaptive! {
            $name = $export, $formula; $en / $ja;
            (qInitial: UnitQuat, [""] "attitude at the start" / "初期姿勢":
                "attitude before the first row: w, x, y, z" / "1 行目より前の姿勢 w, x, y, z";
            gyro: Series<'_, 3>, ["rad/s"] "rates" / "ジャイロ系列":
                "N×3, one sample a row" / "N 行 3 列、1 行に 1 サンプル";
            acc: Series<'_, 3>, ["m/s²"] "accelerations" / "加速度系列":
                "N×3, the same rows" / "N 行 3 列、ジャイロと同じ行数";);
            Vec<[f64; $cols]>, $ret_en / $ret_ja; $example;
            |dt, gain, ki, gravity| {
                filtered(MahonyAdaptive::new(qInitial.0, gain, ki, gravity)?, gyro.rows, acc.rows, dt)?
            }
        }
    };
}

pub(super) const UPDATE_QUATS_BY_MAHONY_ADAPTIVE: Function = adaptive_series! {
    "UpdateQuatsByMahonyAdaptive" = UpdateQuaternionSeriesByMahonyAdaptive,
    "=UpdateQuatsByMahonyAdaptive(A2:D2,F2:H101,J2:L101,0.01,2,0.05,10.3,14.7,9.3,4.9,0)";
    "Attitudes of a series with Mahony's filter whose gain falls while |a| is far from gravity."
        / "|a| が重力から離れるほど kp を下げる Mahony フィルタで、系列の姿勢を求めます。";
    4, "w, x, y, z" / "w, x, y, z"; UPDATE_QUATS_BY_MAHONY_ADAPTIVE
};

pub(super) const UPDATE_YPRS_BY_MAHONY_ADAPTIVE: Function = adaptive_series! {
    "UpdateYprsByMahonyAdaptive" = UpdateYawPitchRollSeriesByMahonyAdaptive,
    "=UpdateYprsByMahonyAdaptive(A2:D2,F2:H101,J2:L101,0.01,2,0.05,10.3,14.7,9.3,4.9,0)";
    "Yaw, pitch, roll of UpdateQuatsByMahonyAdaptive."
        / "UpdateQuatsByMahonyAdaptive の結果をヨー・ピッチ・ロールで返します。";
    3, "yaw, pitch, roll, rad" / "ヨー、ピッチ、ロール (rad)"; UPDATE_YPRS_BY_MAHONY_ADAPTIVE
};

pub(super) const ADAPTIVE_KP: Function = function! {
    "AdaptiveKp" = ComputeAdaptiveKp in Update, "=AdaptiveKp(M2,2,0.05,10.3,14.7,9.3,4.9)";
    "The gain the adaptive Mahony functions use for a given |a|."
        / "Adaptive Mahony の関数が、与えられた |a| に対して使う kp を返します。";
    (accelNorm: f64, ["m/s²"] "|a|" / "|a|": "length of the acceleration" / "加速度のノルム";
    kpMax: f64, ["1/s"] "largest kp" / "kp の最大値": "kp while |a| is near gravity" / "|a| が重力に近いときの kp";
    kpMin: f64, ["1/s"] "smallest kp" / "kp の最小値": "kp while |a| is far from gravity" / "|a| が重力から離れたときの kp";
    accelUpperStart: f64, ["m/s²"] "upper start" / "上側の開始": "|a| above which kp falls" / "これを超えると kp が下がり始めます";
    accelUpperEnd: f64, ["m/s²"] "upper end" / "上側の終了": "|a| from which kp is kpMin" / "これ以上で kp は kpMin になります";
    accelLowerStart: f64, ["m/s²"] "lower start" / "下側の開始": "|a| below which kp falls" / "これを下回ると kp が下がり始めます";
    accelLowerEnd: f64, ["m/s²"] "lower end" / "下側の終了": "|a| down to which kp falls to kpMin" / "これ以下で kp は kpMin になります";
    gravity: f64 = 9.80665, ["m/s²"] "gravity" / "重力加速度":
        "|a| at rest in the unit of the data; 1 for data in g" / "静止時の |a| (データと同じ単位)。g 単位のデータなら 1";)
    -> f64, "kp, 1/s" / "kp (1/s)";
    example ADAPTIVE_KP;
    AdaptiveGain {
        kp_max: kpMax,
        kp_min: kpMin,
        upper_start: accelUpperStart,
        upper_end: accelUpperEnd,
        lower_start: accelLowerStart,
        lower_end: accelLowerEnd,
    }
    .kp(accelNorm, gravity)?
};

fn mahony_step(q: Quaternion, gyro: Vec3, acc: Vec3, dt: f64, kp: f64, gravity: f64) -> Result<Quaternion> {
    positive("gravity", gravity)?;
    Dt::Constant(dt).check(1)?;
    Ok(Mahony::new(q, kp, 0.0)?.update(gyro, acc, dt))
}

/// Plain Mahony takes gravity for the sake of its signature; only its sign matters.
fn positive(name: &'static str, value: f64) -> Result<f64> {
    if value > 0.0 { Ok(value) } else { Err(shisei_core::Error::NotPositive { name, value }) }
}
