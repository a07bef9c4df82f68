//! Times of camera pulses in a sensor's clock: one a row, s, in the order of the frames.
//!
//! The first row is frame 0 of the take. Blank lines, lines that begin with `#` and one line of words at the top are
//! passed over. What counts is the middle of the exposure; where the file holds rising edges of the Exposure Time
//! signal, half its width is added before.

use super::error::{Error, Problem, Result};
use super::take::Take;
use crate::Input;
use crate::encoding;
use crate::open::unpack;
use crate::sheet::line_at;

/// An interval longer than this many usual ones misses a pulse; a shorter one than its inverse has one too many.
const LONG: f64 = 1.5;

/// Reads a pulse file; gzip is unpacked. Refused: text where a number is needed, times that do not ascend, fewer than
/// two pulses.
pub fn read_pulses(input: &Input<'_>) -> Result<Vec<f64>> {
    let bytes =
        unpack(input).map_err(|error| Error::of_file(input.name, Problem::Bytes(Box::new(error.problem))))?;
    let (encoding, text) = encoding::detect(&bytes);
    let mut pulses: Vec<f64> = Vec::new();
    let (mut at, mut number, mut worded) = (0, 0, false);
    while let Some((line, next)) = line_at(&text, at) {
        (at, number) = (next, number + 1);
        let line = encoding.decode(line);
        let cell = line.trim().trim_matches('"').trim();
        if cell.is_empty() || cell.starts_with('#') {
            continue;
        }
        let refuse = |problem| Err(Error::at(input.name, Some(number), None, problem));
        match cell.parse::<f64>().ok().filter(|time_s| time_s.is_finite()) {
            None if pulses.is_empty() && !worded => worded = true,
            None => return refuse(Problem::NotANumber { text: cell.to_owned() }),
            Some(time_s) => {
                if pulses.last().is_some_and(|last| time_s <= *last) {
                    return refuse(Problem::PulseOrder { pulse: pulses.len() + 1 });
                }
                pulses.push(time_s);
            }
        }
    }
    if pulses.len() < 2 {
        return Err(Error::of_file(input.name, Problem::FewPulses { count: pulses.len() }));
    }
    Ok(pulses)
}

impl Take {
    /// Times of an inertial recording's samples on the take's clock, s, from the times of the camera pulses on the
    /// recording's clock ([`read_pulses`]); NaN before the first pulse and after the last.
    ///
    /// Refused: another number of pulses than `Total Frames in Take` (than the last frame's number, where the take does
    /// not say it), an interval that is half as long again as the usual one, or shorter than two thirds of it, and
    /// samples of which none lies between the first pulse and the last.
    pub fn pulses_s(&self, pulses_s: &[f64], sample_s: &[f64]) -> Result<Vec<f64>> {
        let rate_hz = self.rate_hz()?;
        let mut steps: Vec<f64> = pulses_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = steps.len() / 2;
        let usual_s = match steps.get_mut(..) {
            Some(steps) if !steps.is_empty() => *steps.select_nth_unstable_by(middle, f64::total_cmp).1,
            _ => return Err(self.refuse(Problem::FewPulses { count: pulses_s.len() })),
        };
        for (k, pair) in pulses_s.windows(2).enumerate() {
            let step_s = pair[1] - pair[0];
            if !(step_s * LONG >= usual_s && step_s <= usual_s * LONG) {
                return Err(self.refuse(Problem::PulseStep { pulse: k + 2, step_s, usual_s }));
            }
        }
        let counted = pulses_s.len() as u64;
        if let Some(total) = self.total_frames() {
            if counted != total {
                return Err(self.refuse(Problem::PulseCount { counted, total }));
            }
        } else if self.frame.last().is_some_and(|last| *last >= counted as i64) {
            let total = self.frame.last().map_or(0, |last| last.unsigned_abs().saturating_add(1));
            return Err(self.refuse(Problem::PulseCount { counted, total }));
        }
        let frame = |time_s: &f64| {
            let after = pulses_s.partition_point(|pulse| pulse <= time_s);
            let last = pulses_s.len() - 1;
            if after > last {
                return if pulses_s[last] == *time_s { last as f64 } else { f64::NAN };
            }
            let Some(before) = after.checked_sub(1) else { return f64::NAN };
            before as f64 + (time_s - pulses_s[before]) / (pulses_s[after] - pulses_s[before])
        };
        let times_s: Vec<f64> = sample_s.iter().map(|time_s| frame(time_s) / rate_hz).collect();
        if let ([from, .., to], [first, .., last], true) =
            (pulses_s, sample_s, times_s.iter().all(|time_s| time_s.is_nan()))
        {
            let problem = Problem::PulseNone { pulses_s: [*from, *to], samples_s: [*first, *last] };
            return Err(self.refuse(problem));
        }
        Ok(times_s)
    }
}
