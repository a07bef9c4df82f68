//! Ranges of axes and round numbers on them.

use shisei_core::math;

/// What an axis spans; a log range holds decades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    from: f64,
    to: f64,
    log: bool,
    degrees: bool,
}

/// A labelled place on an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    pub label: String,
}

impl Range {
    /// Spans the finite values (those above zero on a log axis), with a share of itself free at both ends.
    pub fn of(values: impl Iterator<Item = f64>, log: bool, free: f64) -> Self {
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.map(|v| if log { decades(v) } else { v }).filter(|v| v.is_finite()) {
            from = from.min(value);
            to = to.max(value);
        }
        if from > to {
            (from, to) = (0.0, 1.0);
        }
        if to - from <= 1e-12 * from.abs().max(to.abs()) {
            let half = if from == 0.0 { 1.0 } else { 0.1 * from.abs() };
            (from, to) = (from - half, to + half);
        }
        let margin = free * (to - from);
        Range { from: from - margin, to: to + margin, log, degrees: false }
    }

    /// With steps that are parts of a turn, for an axis in degrees.
    pub fn in_degrees(self, degrees: bool) -> Self {
        Range { degrees, ..self }
    }

    /// 0 at the start, 1 at the end.
    pub fn share(self, value: f64) -> f64 {
        let value = if self.log { decades(value) } else { value };
        (value - self.from) / (self.to - self.from)
    }

    /// Round numbers inside, about `wanted` of them.
    pub fn ticks(self, wanted: usize) -> Vec<Tick> {
        let rough = (self.to - self.from) / wanted.max(2) as f64;
        let power = math::floor(decades(rough));
        let unit = ten_to(power);
        let step = [1.0, 2.0, 5.0, 10.0].iter().map(|k| k * unit).find(|s| *s >= rough * 0.999);
        let mut step = step.unwrap_or(10.0 * unit);
        if self.degrees && rough > 10.0 {
            let parts = [15.0, 30.0, 45.0, 90.0, 180.0, 360.0];
            step = parts.into_iter().find(|s| *s >= rough).unwrap_or(step);
        }
        if self.log {
            step = step.max(1.0);
        }
        let first = math::floor(self.from / step) as i64;
        let digits = (-math::floor(decades(step) + 1e-9)).max(0.0) as usize;
        (first..first.saturating_add(200))
            .map(|k| k as f64 * step)
            .skip_while(|v| *v < self.from - 1e-9 * step)
            .take_while(|v| *v <= self.to + 1e-9 * step)
            .map(|v| {
                if self.log {
                    let value = ten_to(v);
                    let label =
                        if (-4.0..5.0).contains(&v) { format!("{value}") } else { format!("{value:e}") };
                    Tick { value, label: label.replace('-', "−") }
                } else {
                    let v = if v == 0.0 { 0.0 } else { v };
                    Tick { value: v, label: format!("{v:.digits$}").replace('-', "−") }
                }
            })
            .collect()
    }
}

fn decades(value: f64) -> f64 {
    math::ln(value) / core::f64::consts::LN_10
}

fn ten_to(power: f64) -> f64 {
    format!("1e{power:.0}").parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(from: f64, to: f64, wanted: usize) -> Vec<String> {
        let range = Range { from, to, log: false, degrees: false };
        range.ticks(wanted).into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(0.0, 16.7, 9), ["0", "2", "4", "6", "8", "10", "12", "14", "16"]);
        assert_eq!(labels(-0.31, 0.3, 6), ["−0.2", "0.0", "0.2"]);
        assert_eq!(labels(0.0, 1e-3, 4), ["0.0000", "0.0005", "0.0010"]);
    }

    #[test]
    fn angles_are_ticked_in_parts_of_a_turn() {
        let range = Range { from: -200.0, to: 200.0, log: false, degrees: true };
        let labels: Vec<String> = range.ticks(10).into_iter().map(|t| t.label).collect();
        assert_eq!(labels, ["−180", "−135", "−90", "−45", "0", "45", "90", "135", "180"]);
    }

    #[test]
    fn log_ticks_are_decades() {
        let range = Range::of([0.02, 300.0, -1.0, 0.0].into_iter(), true, 0.0);
        let ticks: Vec<f64> = range.ticks(8).iter().map(|t| t.value).collect();
        assert_eq!(ticks, [0.1, 1.0, 10.0, 100.0]);
        assert!((range.share(0.02)).abs() < 1e-12 && (range.share(300.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn flat_and_empty_ranges_have_a_width() {
        assert!(Range::of([f64::NAN].into_iter(), false, 0.0).share(0.5).is_finite());
        assert!(Range::of([7.0, 7.0].into_iter(), false, 0.0).share(7.0) == 0.5);
    }
}
