//! From camera pulses to the frame index of a moment, a real number.

/// A sync pulse: one a camera frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pulse {
    /// When, s, by the clock that counts.
    pub time_s: f64,
    /// Which, counted by hardware.
    pub count: u32,
}

/// A moment against the pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// Between two pulses: their counts, interpolated.
    At(f64),
    /// After the newest pulse: ask again when the next has come.
    NotYet,
    /// Before the first pulse, or in a pause between two takes.
    Outside,
}

/// Longer than this many times the period beside it, an interval is a pause.
const PAUSE: f64 = 1.5;

/// Where a moment lies in a train of pulses that ascends in time.
///
/// Missing pulses do no harm, for the counts say how many there were. Where the count does not rise, or the period is
/// half as long again as the one before or after, the cameras stopped: [`Frame::Outside`].
pub fn frame_index(pulses: &[Pulse], time_s: f64) -> Frame {
    let after = pulses.partition_point(|pulse| pulse.time_s <= time_s);
    let Some(index) = after.checked_sub(1) else { return Frame::Outside };
    let Some(&left) = pulses.get(index) else { return Frame::Outside };
    if left.time_s == time_s {
        return Frame::At(f64::from(left.count));
    }
    let Some(&right) = pulses.get(after) else { return Frame::NotYet };
    let Some(period_s) = period(left, right) else { return Frame::Outside };
    let before = index.checked_sub(1).and_then(|k| period(*pulses.get(k)?, left));
    let next = pulses.get(after + 1).and_then(|&pulse| period(right, pulse));
    if [before, next].iter().flatten().any(|beside| period_s > PAUSE * beside) {
        return Frame::Outside;
    }
    Frame::At(f64::from(left.count) + (time_s - left.time_s) / period_s)
}

/// Time from frame to frame; none where the count does not rise.
fn period(left: Pulse, right: Pulse) -> Option<f64> {
    let frames = right.count.checked_sub(left.count).filter(|&frames| frames > 0)?;
    let period_s = (right.time_s - left.time_s) / f64::from(frames);
    (period_s > 0.0).then_some(period_s)
}

/// The simple rule, for comparison: the newest pulse when something arrived.
pub fn arrival_frame(pulses: &[Pulse], arrival_s: f64) -> Option<u32> {
    let after = pulses.partition_point(|pulse| pulse.time_s <= arrival_s);
    pulses.get(after.checked_sub(1)?).map(|pulse| pulse.count)
}

/// The newest pulses, at most `N`, as they come.
#[derive(Clone, Copy, Debug)]
pub struct PulseTrain<const N: usize> {
    pulses: [Pulse; N],
    length: usize,
}

impl<const N: usize> Default for PulseTrain<N> {
    fn default() -> Self {
        PulseTrain { pulses: [Pulse::default(); N], length: 0 }
    }
}

impl<const N: usize> PulseTrain<N> {
    /// Adds a pulse; one that is not later than the newest is left out, and false is returned.
    pub fn push(&mut self, pulse: Pulse) -> bool {
        let late = self.newest().is_none_or(|newest| pulse.time_s > newest.time_s);
        if !late || N == 0 {
            return false;
        }
        if self.length == N {
            // Half is forgotten at once, so that pushing costs little.
            let dropped = N.div_ceil(2);
            self.pulses.copy_within(dropped.., 0);
            self.length -= dropped;
        }
        self.pulses[self.length] = pulse;
        self.length += 1;
        true
    }

    /// The newest pulse.
    pub fn newest(&self) -> Option<Pulse> {
        self.pulses().last().copied()
    }

    /// Those that are kept, ascending.
    pub fn pulses(&self) -> &[Pulse] {
        &self.pulses[..self.length]
    }

    /// [`frame_index`] among those that are kept.
    pub fn frame(&self, time_s: f64) -> Frame {
        frame_index(self.pulses(), time_s)
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.length = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn train(counts: impl Iterator<Item = u32>) -> Vec<Pulse> {
        counts.map(|count| Pulse { time_s: 10.0 + 0.01 * f64::from(count), count }).collect()
    }

    fn near(frame: Frame, expected: f64) -> bool {
        matches!(frame, Frame::At(x) if (x - expected).abs() < 1e-9)
    }

    #[test]
    fn between_two_pulses_and_over_missing_ones() {
        let pulses = train([0, 1, 2, 7, 8].into_iter());
        assert!(near(frame_index(&pulses, 10.0125), 1.25));
        assert!(near(frame_index(&pulses, 10.055), 5.5));
        assert_eq!(frame_index(&pulses, 9.9), Frame::Outside);
        assert_eq!(frame_index(&pulses, 10.09), Frame::NotYet);
        assert_eq!(frame_index(&[], 10.0), Frame::Outside);
        assert_eq!(arrival_frame(&pulses, 10.0199), Some(1));
    }

    #[test]
    fn a_pause_and_a_new_take_are_outside() {
        let mut pulses = train(0..5);
        pulses.extend((5..9).map(|count| Pulse { time_s: 20.0 + 0.01 * f64::from(count), count }));
        assert_eq!(frame_index(&pulses, 15.0), Frame::Outside);
        pulses.extend((0..3).map(|count| Pulse { time_s: 30.0 + 0.01 * f64::from(count), count }));
        assert_eq!(frame_index(&pulses, 25.0), Frame::Outside);
        assert!(near(frame_index(&pulses, 30.015), 1.5));
    }

    #[test]
    fn the_newest_pulses_are_kept() {
        let mut ring = PulseTrain::<8>::default();
        for pulse in train(0..100) {
            assert!(ring.push(pulse));
        }
        assert!(!ring.push(Pulse { time_s: 1.0, count: 200 }));
        assert_eq!(ring.newest().map(|pulse| pulse.count), Some(99));
        assert!(ring.pulses().len() >= 4 && near(ring.frame(10.975), 97.5));
    }
}
