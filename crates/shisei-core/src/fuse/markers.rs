//! Markers of a body that was lost: each that is still seen says where the body is, for the sensor tells how it is
//! turned.
//!
//! Where a marker sits on the body is learnt from the frames in which both are seen. A marker that is seen in a gap
//! puts the body at `m − R l`, with the attitude of the gap as it was filled without markers; what this differs by
//! from the place filled in changes slowly. Where it jumps, the marker was mistaken for another, and its sighting is
//! cut in two; so it is where it drifts as a marker does that stands still. A piece counts when it joins on to the body
//! as it was seen beside the gap, or to a piece that counts, and not when it joins on badly to one of them. What joins
//! on to nothing must be near where the gap, and the pieces that count, put the body.

use alloc::vec::Vec;

use super::{FusedFrame, NEIGHBOUR_STEPS, Optical, middle};
use crate::alignment::Alignment;
use crate::estimator::{POINTS, Point, Points};
use crate::frames::Pose;
use crate::math;
use crate::vector::{self, Vec3};

/// Standard deviation of a marker's position, m: one that is partly hidden is off by more than the cameras scatter.
const SIGMA_M: f64 = 0.001;
/// A marker nearer to its usual place on the body than this sits on it, m.
const RIGID_M: f64 = 0.005;
/// Frames that a marker's place takes, at least.
const LEAST_FRAMES: usize = 50;
/// Of the frames with body and marker in so many the marker must be at its place, at least.
const LEAST_SHARE: f64 = 0.75;
/// Errors of a solved body last: a frame counts for this share of one that is independent.
const INDEPENDENT: f64 = 0.02;
/// Sightings further apart than this, s, do not join on to each other.
const JOIN_S: f64 = 0.05;
/// What sightings that join on to each other may differ by, m, and how fast what a gap was filled with may drift: m/s,
/// and so many of its standard deviations in a second.
const JUMP_M: f64 = 0.004;
const DRIFT_M_S: f64 = 0.02;
const DRIFT_SIGMAS_S: f64 = 0.5;
/// What drifts faster must do so evenly: no faster than this, m/s, and with no more than this acceleration, m/s², which
/// is that of a tilt that is off by half a degree.
const FASTEST_M_S: f64 = 0.3;
const BEND_M_S2: f64 = 0.1;
/// A blow bends the way in an instant: what then goes on for so long, s, evenly, is believed.
const STRAIGHT_S: f64 = 0.6;
/// It must drift no faster over this time either, s; so much beside a cut is left out.
const WINDOW_S: f64 = 0.2;
/// A sighting that joins on to nothing must last so long, s, and be within so many standard deviations, and this
/// much, m, of where the body is thought to be.
const LONE_S: f64 = 0.5;
const LONE_SIGMAS: f64 = 3.0;
const LONE_M: f64 = 0.01;
/// Most pieces of one gap: a gap broken up more is left to the sensor.
const MOST_PIECES: usize = 2000;

/// Where a marker sits on its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// From the body's point to the marker, m, body axes.
    pub at_m: Vec3,
    /// Standard error of that, the root of the sum over the axes, m.
    pub sigma_m: f64,
    /// Frames that it was learnt from.
    pub frames: usize,
}

/// What became of the markers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Held {
    /// The place of each marker; none where it was not seen with the body for long enough, or moves on it.
    pub places: Vec<Option<Place>>,
    /// One a frame: true where the body was lost and a marker says where it is.
    pub frames: Vec<bool>,
}

/// The places of markers on their body.
pub(super) fn places(optical: &Optical<'_>, markers: &[&[Option<Vec3>]]) -> Vec<Option<Place>> {
    markers.iter().map(|marker| place(optical, marker)).collect()
}

fn place(optical: &Optical<'_>, marker: &[Option<Vec3>]) -> Option<Place> {
    let both = |(pose, seen): (&Option<Pose>, &Option<Vec3>)| {
        let (pose, seen) = (pose.as_ref()?, (*seen)?);
        Some(pose.world_from_body.conjugate().rotate(vector::sub(seen, pose.position_m)))
    };
    let arms: Vec<Vec3> = optical.poses.iter().zip(marker).filter_map(both).collect();
    let mut usual = [0.0; 3];
    for (axis, usual) in usual.iter_mut().enumerate() {
        let mut values: Vec<f64> = arms.iter().map(|arm| arm[axis]).collect();
        *usual = middle(&mut values);
    }
    let near = |arm: &&Vec3| vector::norm(vector::sub(**arm, usual)) < RIGID_M;
    let kept = arms.iter().filter(near).count();
    if kept < LEAST_FRAMES || (kept as f64) < LEAST_SHARE * arms.len() as f64 {
        return None;
    }
    let count = kept as f64;
    let mut at_m = [0.0; 3];
    for arm in arms.iter().filter(near) {
        at_m = vector::add(at_m, vector::scale(*arm, 1.0 / count));
    }
    let mut scatter = 0.0;
    for arm in arms.iter().filter(near) {
        let off = vector::sub(*arm, at_m);
        scatter += vector::dot(off, off) / count;
    }
    let sigma_m = math::sqrt(scatter / (INDEPENDENT * count).max(1.0));
    Some(Place { at_m, sigma_m, frames: kept })
}

/// A marker seen in a gap without a jump.
#[derive(Clone, Copy)]
struct Piece {
    marker: usize,
    /// First and last frame.
    first: usize,
    last: usize,
    /// The sighting was cut at its start, at its end.
    cut: [bool; 2],
    /// It begins where the sighting before it bends away, without a jump.
    bent: bool,
    verdict: Verdict,
}

#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Open,
    Counts,
    Rejected,
}

/// What the markers put the body off by from where a gap was filled, m; NaN where one is not seen.
struct Off<'a> {
    time_s: &'a [f64],
    /// The gap's first frame and the one after its last.
    first: usize,
    end: usize,
    /// How fast that may change in each of its frames, m/s.
    drift_m_s: Vec<f64>,
    by_marker: Vec<Vec<Vec3>>,
}

const UNSEEN: Vec3 = [f64::NAN; 3];

impl Off<'_> {
    fn at(&self, marker: usize, frame: usize) -> Vec3 {
        self.by_marker[marker][frame - self.first]
    }

    /// Whether two sightings, (marker, frame), can be of one body.
    fn agree(&self, a: (usize, usize), b: (usize, usize)) -> bool {
        let apart_s = (self.time_s[a.1] - self.time_s[b.1]).abs();
        let off = vector::norm(vector::sub(self.at(a.0, a.1), self.at(b.0, b.1)));
        let drift = |frame: usize| self.drift_m_s[frame - self.first];
        off <= JUMP_M + drift(a.1).max(drift(b.1)) * apart_s
    }

    /// Whether a marker's sightings in two frames that follow each other are free of a jump.
    fn whole(&self, marker: usize, last: usize, frame: usize) -> bool {
        let off = vector::norm(vector::sub(self.at(marker, frame), self.at(marker, last)));
        off <= JUMP_M + FASTEST_M_S * (self.time_s[frame] - self.time_s[last])
    }

    /// Whether both of two pieces of a sighting that bends between them go on evenly for long enough to tell.
    fn bends(&self, before: &Piece, after: &Piece) -> Option<bool> {
        let long = |piece: &Piece| self.time_s[piece.last] - self.time_s[piece.first] >= STRAIGHT_S;
        (long(before) && long(after)).then_some(true)
    }

    /// Whether the newest of a marker's sightings continues the way of those before it, two windows ago, one ago, and
    /// the last.
    fn straight(&self, marker: usize, [far, back, last, frame]: [usize; 4]) -> bool {
        let time = |k: usize| self.time_s[k];
        if time(frame) - time(far) < 1.8 * WINDOW_S || time(back) <= time(far) {
            return false;
        }
        let at = |k: usize| self.at(marker, k);
        let speed = vector::scale(vector::sub(at(back), at(far)), 1.0 / (time(back) - time(far)));
        let off = |from: usize| {
            let after_s = time(frame) - time(from);
            let expected = vector::add(at(from), vector::scale(speed, after_s));
            vector::norm(vector::sub(at(frame), expected)) - BEND_M_S2 * after_s * (after_s + WINDOW_S)
        };
        vector::norm(speed) <= FASTEST_M_S && off(last) <= JUMP_M && off(back) <= JUMP_M
    }

    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for marker in 0..self.by_marker.len() {
            let mut open: Option<Piece> = None;
            // the frames of the piece one window and two windows ago
            let (mut back, mut far) = (self.first, self.first);
            for frame in (self.first..self.end).filter(|frame| self.at(marker, *frame)[0].is_finite()) {
                let (mut cut, mut bent) = (false, false);
                if let Some(piece) = &mut open {
                    let time_s = self.time_s[frame];
                    let since = |from: usize, from_s: f64| {
                        let seen =
                            |k: &usize| self.time_s[*k] >= from_s && self.at(marker, *k)[0].is_finite();
                        (from..frame).find(seen).unwrap_or(piece.last)
                    };
                    back = since(back, time_s - WINDOW_S);
                    far = since(far, time_s - 2.0 * WINDOW_S);
                    let near = time_s - self.time_s[piece.last] <= JOIN_S;
                    let one = |earlier| self.agree((marker, earlier), (marker, frame));
                    let slow = one(piece.last) && one(back);
                    let whole = self.whole(marker, piece.last, frame);
                    let young = piece.bent && time_s - self.time_s[piece.first] < 2.0 * WINDOW_S;
                    let goes_on =
                        slow || whole && young || self.straight(marker, [far, back, piece.last, frame]);
                    if near && goes_on {
                        piece.last = frame;
                        continue;
                    }
                    (cut, bent) = (near, near && whole);
                    piece.cut[1] = near;
                    pieces.push(*piece);
                }
                (back, far) = (frame, frame);
                let piece = Piece {
                    marker,
                    first: frame,
                    last: frame,
                    cut: [cut, false],
                    bent,
                    verdict: Verdict::Open,
                };
                open = Some(piece);
            }
            pieces.extend(open);
        }
        pieces
    }

    /// Whether a piece joins on to the body as it was seen beside the gap, and well.
    fn beside(&self, piece: &Piece) -> Option<bool> {
        let well = |frame: usize, apart_s: f64| {
            let off = vector::norm(self.at(piece.marker, frame));
            (apart_s <= JOIN_S).then(|| off <= JUMP_M + self.drift_m_s[frame - self.first] * apart_s)
        };
        let (time_s, last) = (self.time_s, self.first.checked_sub(1));
        let before = last.and_then(|last| well(piece.first, time_s[piece.first] - time_s[last]));
        let after = time_s.get(self.end).and_then(|end_s| well(piece.last, end_s - time_s[piece.last]));
        both(before, after)
    }

    /// Whether two pieces join on to each other, and well.
    fn between(&self, a: &Piece, b: &Piece) -> Option<bool> {
        let (from, to) = (a.first.max(b.first), a.last.min(b.last));
        if from > to {
            let (earlier, later) = if a.last < b.first { (a, b) } else { (b, a) };
            let near = self.time_s[later.first] - self.time_s[earlier.last] <= JOIN_S;
            let seen = |frame| self.at(a.marker, frame)[0].is_finite();
            if near && a.marker == b.marker && !(earlier.last + 1..later.first).any(seen) {
                // one sighting: cut by a jump, or where it bends
                return if later.bent { self.bends(earlier, later) } else { Some(false) };
            }
            let well = || self.agree((earlier.marker, earlier.last), (later.marker, later.first));
            return near.then(well);
        }
        let mut all = None;
        for frame in from..=to {
            if self.at(a.marker, frame)[0].is_finite() && self.at(b.marker, frame)[0].is_finite() {
                all = both(all, Some(self.agree((a.marker, frame), (b.marker, frame))));
            }
        }
        all
    }
}

impl Off<'_> {
    /// Whether a piece that joins on to nothing can be of the body: near where the gap puts it and no farther from the
    /// pieces that count, before and after, than drift explains.
    fn fits(&self, piece: &Piece, pieces: &[Piece], frames: &[FusedFrame]) -> bool {
        let near = |frame: usize| {
            let off = vector::norm(self.at(piece.marker, frame));
            off <= LONE_SIGMAS * frames[frame].sigma_m + LONE_M
        };
        let counts = |other: &&Piece| other.verdict == Verdict::Counts;
        let before = pieces.iter().filter(counts).filter(|other| other.last < piece.first);
        let after = pieces.iter().filter(counts).filter(|other| other.first > piece.last);
        let own = |frame: usize| (piece.marker, frame);
        self.time_s[piece.last] - self.time_s[piece.first] >= LONE_S
            && near(piece.first)
            && near(piece.last)
            && before
                .max_by_key(|other| other.last)
                .is_none_or(|other| self.agree((other.marker, other.last), own(piece.first)))
            && after
                .min_by_key(|other| other.first)
                .is_none_or(|other| self.agree((other.marker, other.first), own(piece.last)))
    }

    /// The frames of a piece that counts, without what is beside a cut.
    fn used(&self, piece: &Piece) -> core::ops::Range<usize> {
        let (mut first, mut end) = (piece.first, piece.last + 1);
        if piece.cut[0] {
            let from_s = self.time_s[piece.first] + WINDOW_S;
            first = (first..end).find(|&frame| self.time_s[frame] > from_s).unwrap_or(end);
        }
        if piece.cut[1] {
            let to_s = self.time_s[piece.last] - WINDOW_S;
            end = (first..end).rfind(|&frame| self.time_s[frame] < to_s).map_or(first, |last| last + 1);
        }
        first..end
    }
}

/// Of two opinions, if any: a bad one weighs more.
fn both(a: Option<bool>, b: Option<bool>) -> Option<bool> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a && b),
        (a, b) => a.or(b),
    }
}

fn verdict(well: Option<bool>) -> Verdict {
    match well {
        None => Verdict::Open,
        Some(true) => Verdict::Counts,
        Some(false) => Verdict::Rejected,
    }
}

/// Lets the pieces that count, from `start` of the list on, decide on those that are open.
fn spread(off: &Off<'_>, pieces: &mut [Piece], counting: &mut Vec<usize>, mut start: usize) {
    while let Some(&one) = counting.get(start) {
        start += 1;
        for k in 0..pieces.len() {
            if pieces[k].verdict != Verdict::Open {
                continue;
            }
            pieces[k].verdict = verdict(off.between(&pieces[one], &pieces[k]));
            if pieces[k].verdict == Verdict::Counts {
                counting.push(k);
            }
        }
    }
}

/// The sightings that can be believed: those of markers whose place is known, in the frames of gaps.
///
/// `frames`: the take as it was filled before.
pub(super) fn believed(
    optical: &Optical<'_>,
    markers: &[&[Option<Vec3>]],
    places: &[Option<Place>],
    frames: &[FusedFrame],
) -> Vec<Vec<Option<Vec3>>> {
    let rows = frames.len();
    let off_of = |marker: usize, frame: usize| {
        let (seen, place) = (markers[marker][frame]?, places[marker]?);
        let pose = frames[frame].pose?;
        let arm = pose.world_from_body.rotate(place.at_m);
        Some(vector::sub(vector::sub(seen, arm), pose.position_m))
    };
    let mut believed: Vec<Vec<Option<Vec3>>> = markers.iter().map(|_| alloc::vec![None; rows]).collect();
    let mut first = 0;
    while first < rows {
        if optical.poses[first].is_some() {
            for (marker, kept) in believed.iter_mut().enumerate() {
                let near = off_of(marker, first).is_some_and(|off| vector::norm(off) < RIGID_M);
                kept[first] = markers[marker][first].filter(|_| near);
            }
            first += 1;
            continue;
        }
        let end = (first..rows).find(|&k| optical.poses[k].is_some()).unwrap_or(rows);
        let by_frame =
            |marker| (first..end).map(move |frame| off_of(marker, frame).unwrap_or(UNSEEN)).collect();
        let by_marker = (0..markers.len()).map(by_frame).collect();
        let drift = |frame: &FusedFrame| DRIFT_M_S + DRIFT_SIGMAS_S * frame.sigma_m;
        let drift_m_s = frames[first..end].iter().map(drift).collect();
        let off = Off { time_s: optical.time_s, first, end, drift_m_s, by_marker };
        for piece in counting(&off, frames) {
            let (kept, seen, used) = (&mut believed[piece.marker], markers[piece.marker], off.used(&piece));
            kept[used.clone()].copy_from_slice(&seen[used]);
        }
        first = end;
    }
    believed
}

/// The pieces of a gap that count.
fn counting(off: &Off<'_>, frames: &[FusedFrame]) -> Vec<Piece> {
    let mut pieces = off.pieces();
    if pieces.len() > MOST_PIECES {
        return Vec::new();
    }
    let mut counting = Vec::new();
    for k in 0..pieces.len() {
        pieces[k].verdict = verdict(off.beside(&pieces[k]));
        if pieces[k].verdict == Verdict::Counts {
            counting.push(k);
        }
    }
    spread(off, &mut pieces, &mut counting, 0);
    // what joins on to nothing: two that contradict each other are both in doubt
    for k in 0..pieces.len() {
        if pieces[k].verdict != Verdict::Open {
            continue;
        }
        let piece = pieces[k];
        let alone =
            |other: &Piece| other.verdict != Verdict::Open || off.between(&piece, other) != Some(false);
        if pieces.iter().all(alone) && off.fits(&piece, &pieces, frames) {
            pieces[k].verdict = Verdict::Counts;
            counting.push(k);
            let start = counting.len() - 1;
            spread(off, &mut pieces, &mut counting, start);
        }
    }
    pieces.retain(|piece| piece.verdict == Verdict::Counts);
    // of two that both seemed right, but contradict each other, neither is believed
    let well =
        |k: usize| (0..pieces.len()).all(|l| l == k || off.between(&pieces[k], &pieces[l]) != Some(false));
    (0..pieces.len()).filter(|&k| well(k)).map(|k| pieces[k]).collect()
}

/// The markers seen at inertial samples, between the frames, in the smoother's level world.
pub(super) fn points(
    optical: &Optical<'_>,
    believed: &[Vec<Option<Vec3>>],
    places: &[Option<Place>],
    alignment: &Alignment,
    sample_s: &[f64],
) -> Vec<Points> {
    let times = optical.time_s;
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let longest_s = NEIGHBOUR_STEPS * middle(&mut steps);
    let at = |time_s: f64| {
        let mut points: Points = [None; POINTS];
        let next = times.partition_point(|t| *t < time_s);
        let (Some(last), Some(next_s)) = (next.checked_sub(1), times.get(next)) else { return points };
        let width = next_s - times[last];
        if width > longest_s {
            return points;
        }
        let share = (time_s - times[last]) / width;
        let mut free = points.iter_mut();
        for (seen, place) in believed.iter().zip(places) {
            let (Some(place), Some(a), Some(b)) = (place, seen[last], seen[next]) else { continue };
            let Some(slot) = free.next() else { break };
            let position_m = vector::add(a, vector::scale(vector::sub(b, a), share));
            let variance_m2 = SIGMA_M * SIGMA_M + place.sigma_m * place.sigma_m;
            let (arm_m, position_m) = alignment.marker(place.at_m, position_m);
            *slot = Some(Point { arm_m, position_m, variance_m2 });
        }
        points
    };
    sample_s.iter().map(|time_s| at(*time_s)).collect()
}
