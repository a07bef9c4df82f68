//! Units, gravity, axes and clipping: the last steps to a recording.

use crate::error::{Error, Problem, Result};
use crate::judge::{self, Agreement, Level};
use crate::names;
use crate::open::Part;
use crate::options::{Options, Permutation};
use crate::recording::{Channel, Extra, Recording};
use crate::units::{self, Unit};
use shisei_core::{STANDARD_GRAVITY_M_S2 as G, Vec3};

/// Makes the recording.
pub(crate) fn settle(part: Part, options: &Options) -> Result<Recording> {
    let fail = |problem| Error::of_file(&part.name, problem);
    let names = || part.channels.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    let (Some(acc), Some(gyro)) = (part.acc.clone(), part.gyro.clone()) else {
        let columns = names();
        return Err(fail(if part.acc.is_some() {
            Problem::NoGyro { columns }
        } else {
            Problem::NoAcc { columns }
        }));
    };
    let mut out = Recording {
        dialect: part.dialect,
        sensor: if acc.label.is_empty() { gyro.label.clone() } else { acc.label.clone() },
        findings: part.findings.clone(),
        ..Recording::default()
    };
    out.assumptions.extend(part.assumptions.iter().cloned());
    // Advice about axes is spent once axes are given.
    let advice = ["axes-z-down", "apple-sign", "orientation-not-applied"];
    out.warnings.extend(
        part.warnings.iter().filter(|w| options.axes.is_none() || !advice.contains(&w.code)).cloned(),
    );
    let mut acc_values = part.body.acc;
    let mut gyro_values = part.body.gyro;
    let window = (out.findings.rate_hz.clamp(4.0, 10_000.0)).round() as usize;
    let raw_rest = judge::rest(&acc_values, &gyro_values, window);
    let whole = part.body.whole_numbers;

    // Acceleration.
    let acc_unit = options.units.acc.or(acc.unit).or(part.reading.acc_unit);
    let acc_factor = match (options.scale.and_then(|s| s.acc_counts_per_g), acc_unit) {
        (Some(counts), None | Some(Unit::Counts)) => Some(G / counts),
        (None, Some(Unit::Counts)) => None,
        (_, Some(Unit::Acceleration(factor, name))) => {
            if options.units.acc.is_none() && acc.unit.is_none() {
                out.assume(
                    "unit-acc-dialect",
                    format!("the acceleration is in {name}, as this kind of file has it"),
                    format!("この形式の仕様により、加速度の単位は {name} です"),
                );
            }
            Some(factor)
        }
        _ => infer_acc(&mut out, raw_rest.norm, whole).map_err(fail)?,
    };
    // Angular rate.
    let gyro_unit = options.units.gyro.or(gyro.unit).or(part.reading.gyro_unit);
    let gyro_factor = match (options.scale.and_then(|s| s.gyro_counts_per_deg_s), gyro_unit) {
        (Some(counts), None | Some(Unit::Counts)) => Some(units::RAD_PER_DEG / counts),
        (None, Some(Unit::Counts)) => None,
        (_, Some(Unit::AngularRate(factor, name))) => {
            if options.units.gyro.is_none() && gyro.unit.is_none() {
                out.assume(
                    "unit-gyro-dialect",
                    format!("the angular rate is in {name}, as this kind of file has it"),
                    format!("この形式の仕様により、角速度の単位は {name} です"),
                );
            }
            Some(factor)
        }
        _ if acc_factor.is_none() || (whole && options.scale.is_some()) => None,
        _ => infer_gyro(
            &mut out,
            &acc_values,
            &gyro_values,
            &part.dt_s,
            window,
            acc_factor,
            part.reading.gyro_guess,
        ),
    };
    match (acc_factor, gyro_factor) {
        (Some(a), Some(g)) => {
            scale(&mut acc_values, a);
            scale(&mut gyro_values, g);
        }
        _ if options.counts_ok => out.counts = true,
        _ => return Err(fail(Problem::RawCounts { norm: raw_rest.norm })),
    }
    if part.rate_missing {
        return Err(fail(Problem::RateNeeded));
    }
    let given = options.scale;
    scale_notes(&mut out, "acceleration", "加速度", given.and_then(|s| s.acc_counts_per_g), acc_unit);
    scale_notes(&mut out, "angular rate", "角速度", given.and_then(|s| s.gyro_counts_per_deg_s), gyro_unit);
    let mut channels = part.channels;
    unknown_units(&mut out, &channels);
    for channel in channels.iter_mut().filter(|c| c.used && c.unit.is_empty()) {
        let unit = match channel.role.get(..4) {
            Some("acc_") => unit_name(acc_factor, &[units::STANDARD_G, units::M_S2, units::MILLI_G]),
            Some("gyr_") => unit_name(gyro_factor, &[units::RAD_S, units::DEG_S]),
            _ => "",
        };
        unit.clone_into(&mut channel.unit);
    }
    out.channels = channels;
    if let Some(axes) = options.axes {
        turn(&mut acc_values, &axes.acc);
        turn(&mut gyro_values, &axes.gyro);
    }
    out.time_s = part.time_s;
    out.dt_s = part.dt_s;
    out.acc_m_s2 = acc_values;
    out.gyro_rad_s = gyro_values;
    out.start_unix_s =
        part.origin_ns.filter(|ns| *ns > 300_000_000 * 1_000_000_000).map(|ns| ns as f64 / 1e9);
    temperature(&mut out, part.body.temp);
    for (name, cells) in part.keep_names.into_iter().zip(part.body.keep) {
        out.extra.push(Extra { name, cells });
    }
    out.findings.skipped_rows += part.body.skipped + part.body.trimmed;
    row_notes(&mut out, part.body.skipped, part.body.trimmed);
    let turned = options.axes.map_or(Permutation::IDENTITY, |a| a.acc);
    let rest = raw_rest.converted(acc_factor.unwrap_or(1.0), gyro_factor.unwrap_or(1.0), &turned);
    judge_values(&mut out, &rest, window, part.name.as_str(), options)?;
    Ok(out)
}

fn unit_name(factor: Option<f64>, known: &[Unit]) -> &'static str {
    match factor {
        None => "counts",
        Some(factor) => known
            .iter()
            .find(|u| matches!(u, Unit::Acceleration(f, _) | Unit::AngularRate(f, _) if *f == factor))
            .map_or("counts × scale", |u| u.name()),
    }
}

/// A warning for each quantity whose unit is written but not known, so that it was guessed.
fn unknown_units(out: &mut Recording, channels: &[Channel]) {
    for (role, option, guessed) in [
        ("time_s", "time", "unit-time-inferred"),
        ("acc_x", "acc", "unit-acc-inferred"),
        ("gyr_x", "gyr", "unit-gyro-inferred"),
    ] {
        let Some(channel) = channels.iter().find(|channel| channel.role == role) else { continue };
        if let Some(unit) = names::unknown_unit(&channel.name)
            && out.assumptions.iter().any(|note| note.code == guessed)
        {
            out.warn(
                "unit-unknown",
                format!(
                    "the unit {unit} of {} is not known, so that it was guessed; say what it is with --units {option}=…",
                    channel.name
                ),
                format!(
                    "{} の単位 {unit} は認識できないため、推定しました。--units {option}=… で単位を指定してください",
                    channel.name
                ),
            );
        }
    }
}

/// What `--scale` did to a quantity for which it was given.
fn scale_notes(out: &mut Recording, en: &str, ja: &str, given: Option<f64>, unit: Option<Unit>) {
    match (given, unit) {
        (None, _) => {}
        (Some(_), None | Some(Unit::Counts)) => out.assume(
            "scaled",
            format!("counts of the {en} are converted as given with --scale"),
            format!("{ja}のカウントは --scale の値で換算しました"),
        ),
        (Some(_), Some(unit)) => out.warn(
            "scale-unused",
            format!("--scale is not used for the {en}, which is in {} already", unit.name()),
            format!("{ja}はすでに {} のため、--scale は使いません", unit.name()),
        ),
    }
}

fn scale(values: &mut [Vec3], factor: f64) {
    if factor != 1.0 {
        for v in values {
            *v = v.map(|x| x * factor);
        }
    }
}

fn turn(values: &mut [Vec3], by: &Permutation) {
    if *by != Permutation::IDENTITY {
        for v in values {
            *v = by.apply(*v);
        }
    }
}

/// The unit of an acceleration that has none, from |a| at rest; `Ok(None)` for counts.
fn infer_acc(out: &mut Recording, rest_norm: f64, whole: bool) -> std::result::Result<Option<f64>, Problem> {
    let unit = match judge::level(rest_norm, whole) {
        Level::G => units::STANDARD_G,
        Level::MS2 => units::M_S2,
        Level::MilliG => units::MILLI_G,
        Level::Counts => return Ok(None),
        Level::NoGravity => {
            return Err(Problem::GravityRemoved { column: String::new(), norm_m_s2: Some(rest_norm) });
        }
        Level::Unclear => return Err(Problem::UnitUnclear { norm: rest_norm }),
    };
    let Unit::Acceleration(factor, name) = unit else { return Ok(None) };
    out.assume(
        "unit-acc-inferred",
        format!("the acceleration has no unit: taken as {name}, since |a| at rest is {rest_norm:.4}"),
        format!(
            "加速度に単位がないため、静止時の |a| が {rest_norm:.4} であることから {name} とみなしました"
        ),
    );
    Ok(Some(factor))
}

/// The unit of an angular rate that has none: from how fast gravity turns in the sensor, else from size.
fn infer_gyro(
    out: &mut Recording,
    acc: &[Vec3],
    gyro: &[Vec3],
    dt_s: &[f64],
    window: usize,
    acc_factor: Option<f64>,
    guess: Option<Unit>,
) -> Option<f64> {
    let gravity = G / acc_factor.unwrap_or(1.0);
    let agreement = Agreement::measure(acc, gyro, dt_s, (window / 8).max(1), gravity);
    let (factor, unexplained) = agreement.fit([0, 1, 2], [false; 3]);
    let largest = gyro.iter().flatten().fold(0.0f64, |m, v| m.max(if *v < 0.0 { -v } else { *v }));
    let size = if factor < 0.0 { -factor } else { factor };
    let (unit, why, why_ja) = if agreement.steps >= 10 && unexplained < 0.5 && size > 0.3 && size < 3.0 {
        (units::RAD_S, "it turns as gravity does", "重力方向の変化と一致するため")
    } else if agreement.steps >= 10 && unexplained < 0.5 && size > 0.3 / 57.3 && size < 3.0 / 57.3 {
        (units::DEG_S, "it turns as gravity does", "重力方向の変化と一致するため")
    } else if largest > 40.0 {
        (units::DEG_S, "its largest value is too large for rad/s", "最大値が rad/s としては大きすぎるため")
    } else {
        let still = judge::rest(gyro, &[], window);
        if let Some(guess) = guess {
            (guess, "as this kind of file has it", "この形式の仕様のため")
        } else if still.norm > 0.4 {
            (
                units::DEG_S,
                "its value at rest is too large for rad/s",
                "静止時の値が rad/s としては大きすぎるため",
            )
        } else {
            (
                units::RAD_S,
                "its values are small; --units gyr=deg/s sets the other",
                "値が小さいため。deg/s なら --units gyr=deg/s",
            )
        }
    };
    out.assume(
        "unit-gyro-inferred",
        format!("the angular rate has no unit: taken as {} ({why})", unit.name()),
        format!("角速度に単位がないため {} とみなしました ({why_ja})", unit.name()),
    );
    match unit {
        Unit::AngularRate(factor, _) => Some(factor),
        _ => None,
    }
}

/// A temperature that stands at 4095 or is nowhere a number is none.
fn temperature(out: &mut Recording, temp: Vec<f64>) {
    if temp.is_empty() {
        return;
    }
    if temp.iter().all(|t| *t == 4095.0) {
        out.assume(
            "temp-none",
            "the temperature is 4095 throughout, which means that there is none".into(),
            "温度がすべて 4095 のため、温度なしとして扱います".into(),
        );
        for channel in out.channels.iter_mut().filter(|c| c.role == "temp_c") {
            channel.used = false;
        }
    } else if temp.iter().any(|t| t.is_finite()) {
        out.temp_c = Some(temp);
    }
}

fn row_notes(out: &mut Recording, skipped: usize, trimmed: usize) {
    if skipped > 0 {
        out.warn(
            "rows-skipped",
            format!("{skipped} row(s) with missing or unreadable numbers were left out"),
            format!("数値が欠けているか読めない {skipped} 行を除きました"),
        );
    }
    if trimmed > 0 {
        out.warn(
            "rows-trimmed",
            format!("{trimmed} incomplete row(s) at the start or the end were left out"),
            format!("先頭または末尾の不完全な {trimmed} 行を除きました"),
        );
    }
}

/// Rest, gravity, axes, clipping, gaps.
fn judge_values(
    out: &mut Recording,
    rest: &judge::Rest,
    window: usize,
    file: &str,
    options: &Options,
) -> Result<()> {
    out.findings.rest_norm = rest.norm;
    out.findings.rest_acc = rest.acc;
    out.findings.rest_gyro_sigma = rest.gyro_sigma;
    clipping(out);
    time_notes(out);
    if out.counts {
        return Ok(());
    }
    if rest.norm < 2.0 && options.scale.is_none() && options.units.acc.is_none() {
        let problem = Problem::GravityRemoved { column: String::new(), norm_m_s2: Some(rest.norm) };
        return Err(Error::of_file(file, problem));
    }
    if !(7.0..=12.5).contains(&rest.norm) {
        out.warn(
            "rest-norm-odd",
            format!(
                "|a| over the stillest stretches is {:.3} m/s² where about 9.8 is expected; check the unit \
                 (--units) or that the sensor was ever still",
                rest.norm
            ),
            format!(
                "最も静かな区間の |a| が {:.3} m/s² で、約 9.8 になりません。単位 (--units) と静止区間の有無を\
                 確認してください",
                rest.norm
            ),
        );
    }
    axes_notes(out, rest, window);
    Ok(())
}

fn axes_notes(out: &mut Recording, rest: &judge::Rest, window: usize) {
    if judge::z_down(rest) && !out.warnings.iter().any(|w| w.code == "axes-z-down") {
        out.warn(
            "z-down",
            format!(
                "at rest z reads {:.2} m/s²: the sensor lay upside down or its z axis points down (NED); if \
                 the axes are z-down, mend them with --axes x,-y,-z; if only the accelerometer's sign is \
                 turned (as Apple's frameworks give it), with --axes \"acc=-x,-y,-z;gyr=x,y,z\"",
                rest.acc[2]
            ),
            format!(
                "静止時の z が {:.2} m/s² です。センサが裏返しか、z 軸が下向き (NED) です。軸が下向きなら --axes \
                 x,-y,-z、加速度の符号だけが逆 (Apple 系) なら --axes \"acc=-x,-y,-z;gyr=x,y,z\" で直せます",
                rest.acc[2]
            ),
        );
    }
    let block = (window / 8).max(1);
    let agreement = Agreement::measure(&out.acc_m_s2, &out.gyro_rad_s, &out.dt_s, block, rest.norm.max(1.0));
    if agreement.steps < 20 {
        return;
    }
    let (factor, unexplained) = agreement.fit([0, 1, 2], [false; 3]);
    let mut best = (unexplained, Permutation::IDENTITY, factor);
    for from in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for signs in 0..8u8 {
            let negative = [signs & 1 != 0, signs & 2 != 0, signs & 4 != 0];
            let (factor, rest) = agreement.fit(from, negative);
            if factor > 0.0 && (rest < best.0 - 1e-12 || best.2 <= 0.0) {
                best = (rest, Permutation { from, negative }, factor);
            }
        }
    }
    let (left, map, factor_best) = best;
    if map != Permutation::IDENTITY && left < 0.35 && (factor <= 0.0 || unexplained > left + 0.35) {
        out.warn(
            "axes-disagree",
            format!(
                "the gyroscope and the accelerometer turn against each other: left-handed axes or another \
                 order; the data fit with --axes \"acc=x,y,z;gyr={}\"",
                map.text()
            ),
            format!(
                "ジャイロと加速度の回転の向きが合いません。左手系か軸の順序が異なります。--axes \
                 \"acc=x,y,z;gyr={}\" とするとデータに合います",
                map.text()
            ),
        );
    } else if left < 0.35 && map == Permutation::IDENTITY && !(0.25..=4.0).contains(&factor_best) {
        out.warn(
            "unit-gyro-doubtful",
            format!(
                "gravity turns {factor_best:.3} times as fast as the gyroscope says; check the gyroscope's \
                 unit with --units gyr=deg/s or gyr=rad/s"
            ),
            format!(
                "重力方向はジャイロの {factor_best:.3} 倍の速さで回っています。ジャイロの単位を --units \
                 gyr=deg/s または gyr=rad/s で確認してください"
            ),
        );
    }
}

fn clipping(out: &mut Recording) {
    // An axis that only ever reads gravity, or a slow turn, is not at its range's end.
    let floors = if out.counts { (0.0, 0.0) } else { (1.5 * G, 1.9) };
    let (acc, acc_level) = judge::clipped(&out.acc_m_s2, floors.0);
    let (gyro, gyro_level) = judge::clipped(&out.gyro_rad_s, floors.1);
    let [ax, ay, az] = acc;
    let [gx, gy, gz] = gyro;
    out.findings.clipped = [ax, ay, az, gx, gy, gz];
    let [ax, ay, az] = acc_level;
    let [gx, gy, gz] = gyro_level;
    out.findings.clip_level = [ax, ay, az, gx, gy, gz];
    let total: usize = out.findings.clipped.iter().sum();
    if total > 0 {
        out.warn(
            "clipped",
            format!("{total} value(s) stand at the end of the sensor's range; motion beyond it is lost"),
            format!("センサの測定範囲の端に達した値が {total} 個あります。それを超える動きは失われています"),
        );
    }
}

fn time_notes(out: &mut Recording) {
    let found = out.findings.clone();
    let long = out.dt_s.iter().skip(1).filter(|d| **d > crate::LONG_GAP_S).count();
    if found.gap_count > 0 {
        out.warn(
            "gaps",
            format!(
                "{} gap(s) in the samples, {:.3} s in all, {long} of them longer than 0.5 s",
                found.gap_count, found.gap_total_s
            ),
            format!(
                "サンプルの欠落が {} か所 (合計 {:.3} s、うち 0.5 s 超が {long} か所) あります",
                found.gap_count, found.gap_total_s
            ),
        );
    }
    if found.repeated_stamps > 0 && !found.time_from_rate {
        out.warn(
            "repeats",
            format!(
                "{} stamp(s) repeat the one before; their rows were spread evenly",
                found.repeated_stamps
            ),
            format!(
                "直前と同じ時刻が {} 個あります。該当する行は等間隔に割り振りました",
                found.repeated_stamps
            ),
        );
    }
    if found.backward_stamps > 0 {
        out.warn(
            "backward",
            format!(
                "{} stamp(s) lie before the one before; their rows were spread evenly",
                found.backward_stamps
            ),
            format!(
                "直前より戻る時刻が {} 個あります。該当する行は等間隔に割り振りました",
                found.backward_stamps
            ),
        );
    }
    if found.wild_stamps > 0 {
        out.warn(
            "wild-stamps",
            format!(
                "{} stamp(s) lie far from those before and after; they were put in the middle between them",
                found.wild_stamps
            ),
            format!(
                "前後の時刻から大きく外れた時刻が {} 個あります。前後の中間に置きました",
                found.wild_stamps
            ),
        );
    }
    if found.resets > 0 {
        out.warn(
            "resets",
            format!(
                "the clock started again {} time(s); time goes on from there without the pause",
                found.resets
            ),
            format!("時計が {} 回リセットされています。休止時間を除いて時刻を続けます", found.resets),
        );
    }
}
