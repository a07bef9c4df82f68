//! Mahony's filter over several recordings side by side.
//!
//! One attitude must wait for the one before, but not for those of another recording: several of them go together, and
//! a recording that ends makes room for the next. Every recording gets the bits that it gets alone.

use super::exponential::{POLYNOMIAL_LIMIT, correction, is_ordinary, polynomials, turned};
use super::mahony::{Mahony, Prepared, half_up, integrated, pulled};
use super::{Dt, Filter, check_rows, run_into, same_length};
use core::array::from_fn;

use crate::error::{Error, Result};
use crate::euler::AttitudeRow;
use crate::lanes::{Lanes, Portable};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Samples between two looks at which recording is in which lane.
const TILE: usize = 64;

/// The numbers of a tile's readings, and one more: they are read by fours.
const READINGS: usize = 3 * TILE + 1;

/// With fewer recordings than this, one after another is faster.
const WORTHWHILE: usize = 3;

/// A recording, its filter, and room for its attitudes.
#[derive(Debug)]
pub struct Readings<'a, O> {
    /// Starts from its attitude; afterwards as if it had been updated with every sample.
    pub filter: Mahony,
    /// Rates in body axes.
    pub gyro_rad_s: &'a [Vec3],
    /// Specific forces in body axes, as many.
    pub acc_m_s2: &'a [Vec3],
    /// Times between them.
    pub dt: Dt<'a>,
    /// Row k is the attitude, `world_from_body`, after sample k; as many rows.
    pub out: &'a mut [O],
}

impl<O: AttitudeRow> Readings<'_, O> {
    fn check(&self) -> Result<()> {
        let rows = self.gyro_rad_s.len();
        same_length(rows, self.acc_m_s2.len())?;
        same_length(rows, self.out.len())?;
        self.dt.check(rows)
    }

    /// One after another, from row `start` on.
    #[inline(never)]
    fn finish(&mut self, start: usize) -> Result<()> {
        let dt = match self.dt {
            Dt::Constant(dt_s) => Dt::Constant(dt_s),
            Dt::PerSample(dt_s) => Dt::PerSample(&dt_s[start..]),
        };
        let (gyro, acc) = (&self.gyro_rad_s[start..], &self.acc_m_s2[start..]);
        run_into(&mut self.filter, gyro, acc, dt, &mut self.out[start..]).map_err(|error| match error {
            Error::NotFinite { row } => error.at_row(start + row),
            other => other,
        })
    }
}

/// Runs every filter over its recording, with the bits of [`run_into`] of each.
///
/// Recordings may have any lengths; longest first keeps all lanes busy to the end. A recording is refused as by
/// [`run_into`]; of several refused ones the first is told, with its place in `recordings`. The others are complete.
pub fn run_many_into<O: AttitudeRow>(
    recordings: &mut [Readings<'_, O>],
) -> core::result::Result<(), (usize, Error)> {
    run_many_in_lanes::<4, Portable<4>, O>(recordings)
}

/// [`run_many_into`] with `N` recordings side by side.
#[inline(always)]
pub fn run_many_in_lanes<const N: usize, L: Lanes<N>, O: AttitudeRow>(
    recordings: &mut [Readings<'_, O>],
) -> core::result::Result<(), (usize, Error)> {
    let mut refused: Option<(usize, Error)> = None;
    let mut refuse = |index: usize, error: Error| {
        if refused.is_none_or(|(first, _)| index < first) {
            refused = Some((index, error));
        }
    };
    let mut waiting = recordings.iter_mut().enumerate();
    let mut slots: [Slot<'_, '_, O>; N] = from_fn(|_| Slot::empty());
    loop {
        for slot in &mut slots {
            slot.take(&mut waiting, &mut refuse);
        }
        if slots.iter().filter(|slot| slot.recording.is_some()).count() < N.min(WORTHWHILE) {
            break;
        }
        let mut state = State::of(&slots);
        let mut stay = true;
        while stay {
            state.next_steps(&slots);
            let mut tile = Tile::next(&mut slots);
            let ordinary = if state.ki == [0.0; N] {
                state.run::<false, L, O>(&mut tile)
            } else {
                state.run::<true, L, O>(&mut tile)
            };
            if !ordinary {
                state.one_by_one(&mut tile);
            }
            for (lane, slot) in slots.iter_mut().enumerate() {
                stay &= ordinary || !slot.refuses(&mut refuse);
                if let Some((_, recording)) = &mut slot.recording {
                    state.save(lane, &mut recording.filter);
                    slot.done += TILE;
                    stay &= !slot.ends();
                }
            }
        }
    }
    for slot in &mut slots {
        slot.finish(&mut refuse);
    }
    refused.map_or(Ok(()), Err)
}

/// A recording in a lane.
struct Slot<'r, 'a, O> {
    recording: Option<(usize, &'r mut Readings<'a, O>)>,
    /// Its rows so far.
    done: usize,
    /// Where the lane writes while it has none.
    idle: [O; TILE],
}

impl<'r, 'a, O: AttitudeRow> Slot<'r, 'a, O> {
    fn empty() -> Self {
        Slot { recording: None, done: 0, idle: from_fn(|_| O::from(Quaternion::IDENTITY)) }
    }

    /// Ends a recording that has no whole tile left, and takes the next one that has.
    fn take(
        &mut self,
        waiting: &mut impl Iterator<Item = (usize, &'r mut Readings<'a, O>)>,
        refuse: &mut impl FnMut(usize, Error),
    ) {
        while self.recording.is_none() || self.ends() {
            self.finish(refuse);
            let Some((index, recording)) = waiting.next() else {
                return;
            };
            match recording.check() {
                Ok(()) => self.recording = Some((index, recording)),
                Err(error) => refuse(index, error),
            }
        }
    }

    /// Whether no whole tile with a row behind it is left.
    fn ends(&self) -> bool {
        self.recording.as_ref().is_some_and(|(_, recording)| recording.out.len() - self.done <= TILE)
    }

    /// Drops a recording whose last tile had numbers that are not finite.
    #[cold]
    fn refuses(&mut self, refuse: &mut impl FnMut(usize, Error)) -> bool {
        let Some((index, recording)) = &self.recording else {
            return false;
        };
        let tile = self.done..self.done + TILE;
        let (gyro, acc) = (&recording.gyro_rad_s[tile.clone()], &recording.acc_m_s2[tile]);
        if let Err(error) = check_rows(gyro, self.done).and_then(|()| check_rows(acc, self.done)) {
            refuse(*index, error);
            self.recording = None;
            return true;
        }
        false
    }

    /// The rest of a recording, alone; the lane is empty then.
    fn finish(&mut self, refuse: &mut impl FnMut(usize, Error)) {
        if let Some((index, recording)) = self.recording.take()
            && let Err(error) = recording.finish(self.done)
        {
            refuse(index, error);
        }
        self.done = 0;
    }
}

/// What a lane reads while it has no recording: level and still.
static NO_RATES: [f64; READINGS] = [0.0; READINGS];
static LEVEL: [f64; READINGS] = [1.0; READINGS];

/// The next samples of every lane, and room for their attitudes.
struct Tile<'t, const N: usize, O> {
    gyro_rad_s: [&'t [f64; READINGS]; N],
    acc_m_s2: [&'t [f64; READINGS]; N],
    rows: [&'t mut [O; TILE]; N],
}

impl<'t, const N: usize, O> Tile<'t, N, O> {
    #[inline(always)]
    fn next(slots: &'t mut [Slot<'_, '_, O>; N]) -> Self {
        let (mut gyro_rad_s, mut acc_m_s2) = ([&NO_RATES; N], [&LEVEL; N]);
        for (lane, slot) in slots.iter().enumerate() {
            if let Some((_, recording)) = &slot.recording {
                let rates: &'t [Vec3] = recording.gyro_rad_s;
                let forces: &'t [Vec3] = recording.acc_m_s2;
                gyro_rad_s[lane] = readings(&rates[slot.done..]).unwrap_or(&NO_RATES);
                acc_m_s2[lane] = readings(&forces[slot.done..]).unwrap_or(&LEVEL);
            }
        }
        let rows = slots.each_mut().map(|slot| {
            let Slot { recording, done, idle } = slot;
            let rows = recording.as_mut().and_then(|(_, recording)| recording.out[*done..].first_chunk_mut());
            rows.unwrap_or(idle)
        });
        Tile { gyro_rad_s, acc_m_s2, rows }
    }

    /// Sample k of every lane, rates and specific forces.
    #[inline(always)]
    fn sample<L: Lanes<N>>(&self, k: usize) -> ([L; 3], [L; 3]) {
        (L::columns(self.gyro_rad_s.map(|r| row(r, k))), L::columns(self.acc_m_s2.map(|r| row(r, k))))
    }
}

fn readings(rows: &[Vec3]) -> Option<&[f64; READINGS]> {
    rows.as_flattened().first_chunk()
}

/// Row k of a tile and the number behind it.
#[inline(always)]
fn row(readings: &[f64; READINGS], k: usize) -> &[f64; 4] {
    readings[3 * k..].first_chunk().unwrap_or(&[1.0; 4])
}

/// The filters of all lanes, a number of all of them in a row.
struct State<const N: usize> {
    kp: [f64; N],
    ki: [f64; N],
    world_from_body: [[f64; N]; 4],
    integral_rad_s: [[f64; N]; 3],
    /// Of the next tile; where all are constant, only the first is looked at.
    steps: [Step<N>; TILE],
    constant: bool,
}

/// The time since the sample before, and what it is multiplied with.
#[derive(Clone, Copy)]
struct Step<const N: usize> {
    dt_s: [f64; N],
    half_dt_s: [f64; N],
    kp_dt: [f64; N],
    ki_dt: [f64; N],
}

impl<const N: usize> State<N> {
    fn of<O>(slots: &[Slot<'_, '_, O>; N]) -> Self {
        let still = Step { dt_s: [1.0; N], half_dt_s: [0.5; N], kp_dt: [0.0; N], ki_dt: [0.0; N] };
        let mut state = State {
            kp: [0.0; N],
            ki: [0.0; N],
            world_from_body: [[1.0; N], [0.0; N], [0.0; N], [0.0; N]],
            integral_rad_s: [[0.0; N]; 3],
            steps: [still; TILE],
            constant: true,
        };
        for (lane, slot) in slots.iter().enumerate() {
            if let Some((_, recording)) = &slot.recording {
                (state.kp[lane], state.ki[lane]) = (recording.filter.kp, recording.filter.chain.ki);
                state.load(lane, &recording.filter);
                match recording.dt {
                    Dt::Constant(dt_s) => state.take_steps(lane, &[dt_s; TILE]),
                    Dt::PerSample(_) => state.constant = false,
                }
            }
        }
        state
    }

    fn take_steps(&mut self, lane: usize, dt_s: &[f64; TILE]) {
        for (step, &dt_s) in self.steps.iter_mut().zip(dt_s) {
            step.dt_s[lane] = dt_s;
            step.half_dt_s[lane] = 0.5 * dt_s;
            step.kp_dt[lane] = self.kp[lane] * dt_s;
            step.ki_dt[lane] = self.ki[lane] * dt_s;
        }
    }

    /// Steps of the next tile where they are given one by one.
    #[inline(always)]
    fn next_steps<O>(&mut self, slots: &[Slot<'_, '_, O>; N]) {
        for (lane, slot) in slots.iter().enumerate() {
            if let Some((_, Readings { dt: Dt::PerSample(dt_s), .. })) = &slot.recording
                && let Some(dt_s) = dt_s[slot.done..].first_chunk()
            {
                self.take_steps(lane, dt_s);
            }
        }
    }

    fn load(&mut self, lane: usize, filter: &Mahony) {
        for (row, value) in self.world_from_body.iter_mut().zip(filter.chain.world_from_body.to_array()) {
            row[lane] = value;
        }
        for (row, value) in self.integral_rad_s.iter_mut().zip(filter.chain.integral_rad_s) {
            row[lane] = value;
        }
    }

    fn save(&self, lane: usize, filter: &mut Mahony) {
        filter.chain.world_from_body = Quaternion::from_array(self.world_from_body.map(|row| row[lane]));
        filter.chain.integral_rad_s = self.integral_rad_s.map(|row| row[lane]);
    }

    #[inline(always)]
    fn step(&self, k: usize) -> &Step<N> {
        &self.steps[if self.constant { 0 } else { k }]
    }

    /// What of step k depends on its sample alone, and whether all of it is of ordinary size.
    #[inline(always)]
    fn prepare<L: Lanes<N>, O>(&self, tile: &Tile<'_, N, O>, k: usize) -> (Prepared<L>, bool) {
        let (gyro_rad_s, acc) = tile.sample::<L>(k);
        let square = vector::dot(acc, acc);
        let step = self.step(k);
        let (kp_dt, half_dt_s) = (L::from_array(step.kp_dt), L::from_array(step.half_dt_s));
        let sample = Prepared::ordinary(gyro_rad_s, acc, square.sqrt(), kp_dt, half_dt_s);
        (sample, is_ordinary(square))
    }

    /// A tile; false, and nothing of it is to be used, where a sample asks for [the long way](State::one_by_one).
    #[inline(always)]
    fn run<const LEARNS: bool, L: Lanes<N>, O: AttitudeRow>(&mut self, tile: &mut Tile<'_, N, O>) -> bool {
        let mut q = self.world_from_body.map(L::from_array);
        let mut i = self.integral_rad_s.map(L::from_array);
        // a step ahead, so that square roots and divisions have time
        let (mut next, mut ordinary) = self.prepare::<L, O>(tile, 0);
        for k in 0..TILE {
            let sample = next;
            let next_ordinary;
            (next, next_ordinary) = self.prepare(tile, (k + 1).min(TILE - 1));
            ordinary &= next_ordinary;
            let v = half_up(q);
            let mut base = sample.half_turn;
            if LEARNS {
                let step = self.step(k);
                let (zero, ki, ki_dt) = (L::of(0.0), L::from_array(self.ki), L::from_array(step.ki_dt));
                let learnt = integrated(i, &sample, v, ki_dt);
                let turned = vector::add(base, vector::scale(learnt, L::from_array(step.half_dt_s)));
                for axis in 0..3 {
                    ordinary &= L::of(f64::NEG_INFINITY).below(learnt[axis]);
                    ordinary &= learnt[axis].below(L::of(f64::INFINITY));
                    i[axis] = zero.if_below(ki, learnt[axis], i[axis]);
                    base[axis] = zero.if_below(ki, turned[axis], base[axis]);
                }
            }
            let h = pulled(base, sample.pull, v);
            let x = vector::dot(h, h);
            ordinary &= x.below(L::of(POLYNOMIAL_LIMIT));
            let (c, s) = polynomials(correction(q), x);
            q = turned(q, c, s, h);
            O::write(q, tile.rows.each_mut().map(|rows| &mut rows[k]));
        }
        if ordinary {
            (self.world_from_body, self.integral_rad_s) = (q.map(L::to_array), i.map(L::to_array));
        }
        ordinary
    }

    /// A tile the long way: with a zero acceleration, a fast turn, very large or small numbers, or such as are to be
    /// refused.
    #[cold]
    #[inline(never)]
    fn one_by_one<O: AttitudeRow>(&mut self, tile: &mut Tile<'_, N, O>) {
        for lane in 0..N {
            let mut filter = Mahony::in_the_middle(self.kp[lane], self.ki[lane]);
            self.save(lane, &mut filter);
            for k in 0..TILE {
                let [gx, gy, gz, _] = *row(tile.gyro_rad_s[lane], k);
                let [ax, ay, az, _] = *row(tile.acc_m_s2[lane], k);
                let q = filter.update([gx, gy, gz], [ax, ay, az], self.step(k).dt_s[lane]);
                tile.rows[lane][k] = O::from(q);
            }
            self.load(lane, &filter);
        }
    }
}
