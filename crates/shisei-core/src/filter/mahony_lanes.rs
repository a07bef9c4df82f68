//! Mahony's filter over several recordings side by side.
//!
//! One attitude must wait for the one before, but not for those of another recording: eight of them go together, and a
//! recording that ends makes room for the next. Every recording gets the bits that it gets alone.

use super::exponential::{POLYNOMIAL_LIMIT, advance_by, cos_sinc, is_ordinary, ordinary_direction};
use super::gyro::half_turn;
use super::lanes::{LANES, Lane, Lanes};
use super::mahony::{Mahony, half_up, integrated, pulled};
use super::{Dt, Filter, check_rows, run_into, same_length};
use crate::error::{Error, Result};
use crate::euler::AttitudeRow;
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// Samples of every recording that are taken before those of the next: two kilobytes of readings.
const TILE: usize = 32;

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
#[inline(always)]
pub fn run_many_into<O: AttitudeRow>(
    recordings: &mut [Readings<'_, O>],
) -> core::result::Result<(), (usize, Error)> {
    let mut refused: Option<(usize, Error)> = None;
    let mut refuse = |index: usize, error: Error| {
        if refused.is_none_or(|(first, _)| index < first) {
            refused = Some((index, error));
        }
    };
    let mut waiting = recordings.iter_mut().enumerate();
    let mut lanes: [Slot<'_, '_, O>; LANES] = core::array::from_fn(|_| Slot::empty());
    loop {
        for slot in &mut lanes {
            slot.take(&mut waiting, &mut refuse);
        }
        if lanes.iter().filter(|slot| slot.recording.is_some()).count() < WORTHWHILE {
            break;
        }
        let mut tile = Tile::of(&lanes);
        let mut ended = false;
        while !ended {
            // This also brings every tile into the nearest cache, a recording after the other.
            let mut refused_one = false;
            for slot in &mut lanes {
                refused_one |= slot.refuses(&mut refuse);
            }
            if refused_one {
                break;
            }
            let readings = gather(&mut lanes, &mut tile);
            if tile.ki == [0.0; LANES] {
                tile.run::<false, O>(readings);
            } else {
                tile.run::<true, O>(readings);
            }
            for (lane, slot) in lanes.iter_mut().enumerate() {
                if let Some((_, recording)) = &mut slot.recording {
                    tile.save(lane, &mut recording.filter);
                    slot.done += TILE;
                    ended |= slot.ends();
                }
            }
        }
    }
    for slot in &mut lanes {
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
        Slot { recording: None, done: 0, idle: core::array::from_fn(|_| O::from(Quaternion::IDENTITY)) }
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

    /// Whether no whole tile is left.
    fn ends(&self) -> bool {
        self.recording.as_ref().is_some_and(|(_, recording)| recording.out.len() - self.done < TILE)
    }

    /// Drops a recording whose next tile has numbers that are not finite.
    #[inline(always)]
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

/// A tile of every lane's readings, and room for its attitudes.
struct Sources<'t, O> {
    gyro_rad_s: [&'t [Vec3; TILE]; LANES],
    acc_m_s2: [&'t [Vec3; TILE]; LANES],
    rows: [&'t mut [O; TILE]; LANES],
}

/// Level and still.
const NO_RATES: [Vec3; TILE] = [[0.0; 3]; TILE];
const LEVEL: [Vec3; TILE] = [[0.0, 0.0, 1.0]; TILE];

/// The next tile of all lanes.
#[inline(always)]
fn gather<'t, O: AttitudeRow>(lanes: &'t mut [Slot<'_, '_, O>; LANES], tile: &mut Tile) -> Sources<'t, O> {
    let mut gyro_rad_s = [&NO_RATES; LANES];
    let mut acc_m_s2 = [&LEVEL; LANES];
    for (lane, slot) in lanes.iter_mut().enumerate() {
        let Some((_, recording)) = &slot.recording else {
            continue;
        };
        let start = slot.done;
        let (gyro, acc) =
            (recording.gyro_rad_s[start..].first_chunk(), recording.acc_m_s2[start..].first_chunk());
        let (Some(gyro), Some(acc)) = (gyro, acc) else {
            continue; // never: a lane holds a recording only while a tile is left
        };
        (gyro_rad_s[lane], acc_m_s2[lane]) = (gyro, acc);
        if let Dt::PerSample(dt_s) = recording.dt {
            for (steps, &dt_s) in tile.dt_s.iter_mut().zip(&dt_s[start..]) {
                steps[lane] = dt_s;
            }
        }
    }
    let rows = lanes.each_mut().map(|slot| {
        let Slot { recording, done, idle } = slot;
        let rows = recording.as_mut().and_then(|(_, recording)| recording.out[*done..].first_chunk_mut());
        rows.unwrap_or(idle)
    });
    Sources { gyro_rad_s, acc_m_s2, rows }
}

/// The filters of all lanes.
struct Tile {
    kp: Lane,
    ki: Lane,
    world_from_body: Lanes,
    integral_rad_s: [Lane; 3],
    dt_s: [Lane; TILE],
}

impl Tile {
    fn of<O>(lanes: &[Slot<'_, '_, O>; LANES]) -> Tile {
        let mut tile = Tile {
            kp: [0.0; LANES],
            ki: [0.0; LANES],
            world_from_body: Lanes::IDENTITY,
            integral_rad_s: [[0.0; LANES]; 3],
            dt_s: [[1.0; LANES]; TILE],
        };
        for (lane, slot) in lanes.iter().enumerate() {
            if let Some((_, recording)) = &slot.recording {
                tile.load(lane, &recording.filter);
                if let Dt::Constant(dt_s) = recording.dt {
                    for steps in &mut tile.dt_s {
                        steps[lane] = dt_s;
                    }
                }
            }
        }
        tile
    }

    fn load(&mut self, lane: usize, filter: &Mahony) {
        (self.kp[lane], self.ki[lane]) = (filter.kp, filter.chain.ki);
        self.world_from_body.set(lane, filter.chain.world_from_body);
        for axis in 0..3 {
            self.integral_rad_s[axis][lane] = filter.chain.integral_rad_s[axis];
        }
    }

    #[inline(always)]
    fn save(&self, lane: usize, filter: &mut Mahony) {
        filter.chain.world_from_body = self.world_from_body.at(lane);
        filter.chain.integral_rad_s = vector_at(&self.integral_rad_s, lane);
    }

    #[inline(always)]
    fn run<const LEARNS: bool, O: AttitudeRow>(&mut self, sources: Sources<'_, O>) {
        let Sources { gyro_rad_s, acc_m_s2, rows } = sources;
        let (kp, ki) = (self.kp, self.ki);
        let (mut attitudes, mut integrals) = (self.world_from_body, self.integral_rad_s);
        for k in 0..TILE {
            let dt_s = self.dt_s[k];
            let (before, integrals_before) = (attitudes, integrals);
            let mut ordinary = true;
            for lane in 0..LANES {
                let q = before.at(lane);
                let dt_s = dt_s[lane];
                let acc = acc_m_s2[lane][k];
                let square = vector::dot(acc, acc);
                ordinary &= is_ordinary(square);
                let (acc_unit, _) = ordinary_direction(acc, square);
                let pull = vector::scale(acc_unit, kp[lane] * dt_s);
                let v = half_up(q);
                let mut base = half_turn(gyro_rad_s[lane][k], dt_s);
                if LEARNS {
                    let i = integrated(vector_at(&integrals_before, lane), acc_unit, v, ki[lane], dt_s);
                    ordinary &= i[0].is_finite() & i[1].is_finite() & i[2].is_finite();
                    let with_integral = vector::add(base, half_turn(i, dt_s));
                    let learns = ki[lane] != 0.0;
                    for axis in 0..3 {
                        integrals[axis][lane] = if learns { i[axis] } else { integrals_before[axis][lane] };
                        base[axis] = if learns { with_integral[axis] } else { base[axis] };
                    }
                }
                let h = pulled(base, pull, v);
                let x = vector::dot(h, h);
                ordinary &= x < POLYNOMIAL_LIMIT;
                let (c, s) = cos_sinc(x);
                attitudes.set(lane, advance_by(q, (c, s, h)));
            }
            if !ordinary {
                let sample = |lane: usize| (gyro_rad_s[lane][k], acc_m_s2[lane][k], dt_s[lane]);
                (attitudes, integrals) =
                    one_by_one((kp, ki), (before, integrals_before), &core::array::from_fn(sample));
            }
            attitudes.write(|lane, row| rows[lane][k] = row);
        }
        (self.world_from_body, self.integral_rad_s) = (attitudes, integrals);
    }
}

#[inline(always)]
fn vector_at(vectors: &[Lane; 3], lane: usize) -> Vec3 {
    [vectors[0][lane], vectors[1][lane], vectors[2][lane]]
}

/// A sample of every lane the long way: with a zero acceleration, a fast turn, or very large or small numbers.
#[cold]
#[inline(never)]
fn one_by_one(
    (kp, ki): (Lane, Lane),
    (mut attitudes, mut integrals): (Lanes, [Lane; 3]),
    samples: &[(Vec3, Vec3, f64); LANES],
) -> (Lanes, [Lane; 3]) {
    for (lane, (gyro_rad_s, acc_m_s2, dt_s)) in samples.iter().enumerate() {
        let q = attitudes.at(lane);
        let mut filter = Mahony::in_the_middle(kp[lane], ki[lane], q, vector_at(&integrals, lane));
        attitudes.set(lane, filter.update(*gyro_rad_s, *acc_m_s2, *dt_s));
        for (axis, i) in filter.integral_rad_s().into_iter().enumerate() {
            integrals[axis][lane] = i;
        }
    }
    (attitudes, integrals)
}
