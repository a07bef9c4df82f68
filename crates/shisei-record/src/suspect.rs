//! Readings that no sensor gives, in a recording that is otherwise in order: an axis that never moves, values
//! beyond any range; for readings that come without a file, units that cannot be right; and attitudes that say little
//! of a heading. Nothing is changed; it is said.

use crate::judge::{self, Agreement, Level};
use crate::recording::{Findings, LONG_GAP_S, Note, Recording};
use shisei_core::{
    LARGEST_ACC_M_S2, LARGEST_RATE_RAD_S, Quaternion, STANDARD_GRAVITY_M_S2 as G, Vec3, heading,
};

/// No motion sensor gives more samples a second.
const LARGEST_RATE_HZ: f64 = 50_000.0;
/// No recording lasts longer, s: thirty years.
const LONGEST_S: f64 = 1e9;
/// Fewer rows than this may well be alike.
const FEW_ROWS: usize = 50;

/// Warns of what is found in a recording.
pub(crate) fn look(out: &mut Recording) {
    if !out.counts {
        out.warnings.extend(impossible(&out.acc_m_s2, &out.gyro_rad_s));
    }
    out.warnings.extend(one_wrong_stamp(&out.findings));
    let rate_hz = out.findings.rate_hz;
    out.warnings.extend(too_slow(rate_hz));
    if rate_hz > LARGEST_RATE_HZ {
        out.warn(
            "rate-odd",
            format!(
                "{rate_hz:.0} samples a second are more than any motion sensor gives; check the unit of the time, for \
                 example --units time=ms, or give --rate"
            ),
            format!(
                "1 秒あたり {rate_hz:.0} サンプルは、モーションセンサではありえない速さです。時刻の単位を確認するか (例 \
                 --units time=ms)、--rate を指定してください"
            ),
        );
    }
}

/// A gap that is most of the recording, or a time that no recording lasts: one wrong stamp does that.
fn one_wrong_stamp(found: &Findings) -> Option<Note> {
    let longest = found.gaps.iter().max_by(|a, b| a.length_s.total_cmp(&b.length_s))?;
    let gap = if found.duration_s > LONGEST_S { found.gaps.first()? } else { longest };
    let (length_s, number) = (gap.length_s, gap.row + 1);
    (found.duration_s > LONGEST_S || length_s > 0.5 * found.duration_s).then(|| {
        Note::new(
            "one-long-gap",
            format!(
                "time jumps by {length_s:.3e} s before sample {number}, which leaves the recording mostly empty; if \
                 that stamp is wrong, remove its row"
            ),
            format!(
                "{number} 番目のサンプルの前で時刻が {length_s:.3e} 秒飛び、記録の大半が空白になっています。その時刻が\
                 誤っている場合は、行を除いてください"
            ),
        )
    })
}

/// What to know before trusting readings in memory that are said to be in m/s² and rad/s, a step each: the doubts
/// that opening a file would raise.
pub fn doubts(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3], dt_s: &[f64]) -> Vec<Note> {
    let mut out = impossible(acc_m_s2, gyro_rad_s);
    let span_s: f64 = dt_s.iter().sum();
    if acc_m_s2.len() < FEW_ROWS || span_s <= 0.0 {
        return out;
    }
    let rate_hz = dt_s.len() as f64 / span_s;
    out.extend(too_slow(rate_hz));
    let window = rate_hz.clamp(4.0, 10_000.0).round() as usize;
    let norm = judge::rest(acc_m_s2, gyro_rad_s, window).norm;
    match judge::level(norm, false) {
        Level::MS2 => {}
        Level::G => out.push(Note::new(
            "acc-in-g",
            format!("|a| over the stillest stretches is {norm:.4}, as readings in g have it; m/s² are g times {G}"),
            format!("最も静かな区間の |a| が {norm:.4} で、g 単位と考えられます。m/s² にするには {G} を掛けてください"),
        )),
        _ => out.push(Note::new(
            "rest-norm-odd",
            format!(
                "|a| over the stillest stretches is {norm:.4} m/s² where about 9.8 is expected; check the unit and \
                 that accelerations and rates are not exchanged"
            ),
            format!(
                "最も静かな区間の |a| が {norm:.4} m/s² で、約 9.8 になりません。単位と、加速度と角速度が逆でないかを\
                 確認してください"
            ),
        )),
    }
    let agreement = Agreement::measure(acc_m_s2, gyro_rad_s, dt_s, (window / 8).max(1), norm.max(1e-3));
    let (factor, unexplained) = agreement.fit([0, 1, 2], [false; 3]);
    if agreement.steps >= 20 && unexplained < 0.35 && factor > 0.0 && !(0.25..=4.0).contains(&factor) {
        out.push(Note::new(
            "unit-gyro-doubtful",
            format!(
                "gravity turns {factor:.3} times as fast as the rates say; are they in deg/s, or is the sampling rate \
                 another?"
            ),
            format!(
                "重力方向は角速度の {factor:.3} 倍の速さで回っています。deg/s の値ではないか、サンプリング周波数が正しいかを\
                 確認してください"
            ),
        ));
    }
    out
}

/// A word on samples so far apart that every step is a gap.
fn too_slow(rate_hz: f64) -> Option<Note> {
    (rate_hz * LONG_GAP_S < 1.0).then(|| {
        Note::new(
            "rate-too-low",
            format!(
                "at {rate_hz:.2} Hz the samples are too far apart to be integrated: there is a tilt for each, and no heading; \
                 is the unit of time right?"
            ),
            format!(
                "{rate_hz:.2} Hz ではサンプルの間隔が長すぎて積分できません。傾きはサンプルごとに求まりますが、方位は分かりません。時刻の\
                 単位を確認してください"
            ),
        )
    })
}

/// What to know before trusting attitudes: that `start` has no heading worth the name where no forward axis was said,
/// and that the gravity said is not of this Earth. Names are the command line's options ([`crate::with_names`]).
pub fn doubts_of_attitudes(start: Quaternion, forward_said: bool, gravity_m_s2: f64) -> Vec<Note> {
    let mut out = Vec::new();
    if !(9.7..9.9).contains(&gravity_m_s2) {
        out.push(Note::new(
            "gravity-odd",
            format!("--gravity {gravity_m_s2} is not found on the Earth, where it is 9.76 to 9.84 m/s²"),
            format!("--gravity {gravity_m_s2} は地球上の値 (9.76〜9.84 m/s²) ではありません"),
        ));
    }
    if !forward_said && heading::is_near_gimbal_lock(start) {
        out.push(Note::new(
            "no-forward",
            "the sensor's x axis is within 10° of the vertical at the start, so its heading is ill-defined and bending \
             and leaning mix in pitch and roll; say which sensor axis points forward, e.g. --forward -z"
                .to_owned(),
            "開始時にセンサの x 軸が鉛直から 10° 以内にあるため、方位が定まらず、前後の傾きと左右の傾きがピッチとロールに\
             混ざります。前方を向くセンサ軸を --forward -z のように指定してください"
                .to_owned(),
        ));
    }
    out
}

fn impossible(acc_m_s2: &[Vec3], gyro_rad_s: &[Vec3]) -> Vec<Note> {
    let mut out = Vec::new();
    if acc_m_s2.len() < FEW_ROWS {
        return out;
    }
    let mut dead = Vec::new();
    for (rows, names) in [(acc_m_s2, ["acc_x", "acc_y", "acc_z"]), (gyro_rad_s, ["gyr_x", "gyr_y", "gyr_z"])]
    {
        dead.extend(
            names.into_iter().enumerate().filter(|(axis, _)| is_dead(rows, *axis)).map(|(_, name)| name),
        );
    }
    if !dead.is_empty() {
        let names = dead.join(", ");
        out.push(Note::new(
            "dead-axis",
            format!(
                "{names}: the same value throughout, which no working sensor gives; check the columns and the sensor"
            ),
            format!(
                "{names} は最初から最後まで同じ値です。正常なセンサではありえません。列の指定とセンサを確認してください"
            ),
        ));
    }
    for (rows, limit, unit) in
        [(acc_m_s2, LARGEST_ACC_M_S2, "m/s²"), (gyro_rad_s, LARGEST_RATE_RAD_S, "rad/s")]
    {
        let large = |v: &Vec3| v.iter().any(|x| x.abs() > limit);
        // Whole stretches first: they go at the speed of the memory.
        let all_small =
            |part: &[Vec3]| !part.as_flattened().iter().fold(false, |any, x| any | (x.abs() > limit));
        if rows.chunks(1024).all(all_small) {
            continue;
        }
        let first = rows.iter().position(large).unwrap_or(0);
        let (count, number) = (rows.iter().filter(|v| large(v)).count(), first + 1);
        out.push(Note::new(
            "beyond-any-sensor",
            format!(
                "{count} sample(s), the first of them number {number}, are larger than sensors of motion read (more \
                 than {limit} {unit}); the filter shisei, fusion and motion pass over them, everything else takes them \
                 as they are; repair or remove them"
            ),
            format!(
                "モーションセンサの測定範囲を超える値 ({limit} {unit} 超) が {count} サンプルあります (最初は {number} 番目)。\
                 フィルタ shisei、fuse、motion は読み飛ばしますが、それ以外の計算ではそのまま使います。修正するか除いてください"
            ),
        ));
    }
    out
}

fn is_dead(rows: &[Vec3], axis: usize) -> bool {
    rows.first().is_some_and(|first| rows.iter().all(|v| v[axis] == first[axis]))
}
