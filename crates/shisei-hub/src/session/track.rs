//! One start of one node: its counters unwrapped, its clock fitted, its samples held until their pulses are there.

use std::collections::VecDeque;

use shisei_core::Quaternion;
use shisei_core::clock::{ClockFit, Frame, Pair, PulseTrain, Settings, unwrap_near};
use shisei_wire::Packet;
use shisei_wire::message::Data;

use super::{PULSES, Sample};

/// Samples that wait at most.
const WAITING_MAX: usize = 2048;
/// Pairs before the clock is trusted.
const PAIRS_MIN: u32 = 4;
/// A sample waits for a clock no longer than this, µs.
const CLOCK_PATIENCE_US: u64 = 2_000_000;
/// A sample waits for its next pulse no longer than this, s of the receiver's clock.
const PULSE_PATIENCE_S: f64 = 0.25;
/// Arrivals over which the rate is counted, µs.
const RATE_WINDOW_US: u64 = 2_000_000;
/// And so many at most, when the receiver's clock stands still.
const ARRIVALS_MAX: usize = 4096;
/// Nominal samples a second, to tell how often the sequence number has wrapped in an outage.
const RATE_HZ: f64 = 120.0;

/// A link and a clock, as they are now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Samples a second over the last two seconds.
    pub rate_hz: f64,
    /// Samples since the node's start as seen here.
    pub samples: u64,
    /// Samples lost since then.
    pub lost: u64,
    /// How far pairs of the clocks are off the fit, root mean square, s.
    pub clock_residual_s: Option<f64>,
    /// How much faster the receiver's clock is, ppm.
    pub skew_ppm: f64,
    /// The newest sample's attitude.
    pub world_from_body: Quaternion,
    /// Time since the last packet, s.
    pub silent_s: f64,
}

#[derive(Debug)]
struct Waiting {
    node_us: i64,
    arrival_us: u64,
    sample: Sample,
}

#[derive(Debug)]
pub struct Track {
    node: u8,
    boot: u16,
    fit: ClockFit,
    waiting: VecDeque<Waiting>,
    /// Newest packet: node time unwrapped, its sequence number unwrapped, arrival.
    node_us: i64,
    sequence: i64,
    arrival_us: u64,
    next_sequence: Option<i64>,
    samples: u64,
    lost: u64,
    arrivals: VecDeque<(u64, u16)>,
    world_from_body: Quaternion,
}

impl Track {
    pub fn new(node: u8, packet: &Packet<'_>, arrival_us: u64) -> Self {
        Track {
            node,
            boot: packet.header.boot,
            fit: ClockFit::new(Settings::default()),
            waiting: VecDeque::new(),
            node_us: i64::from(packet.header.time_us),
            sequence: i64::from(packet.header.sequence),
            arrival_us,
            next_sequence: None,
            samples: 0,
            lost: 0,
            arrivals: VecDeque::new(),
            world_from_body: Quaternion::IDENTITY,
        }
    }

    pub fn boot(&self) -> u16 {
        self.boot
    }

    /// Takes a packet; returns how many samples are missing before it.
    pub fn push(&mut self, data: &Data<'_>, packet: &Packet<'_>) -> u64 {
        let header = &packet.header;
        let passed_us = data.arrival_us.saturating_sub(self.arrival_us) as i64;
        let node_us = unwrap_near(header.time_us, 32, self.node_us.saturating_add(passed_us));
        let steps = (node_us - self.node_us) as f64 * 1e-6 * RATE_HZ;
        let sequence =
            unwrap_near(u32::from(header.sequence), 16, self.sequence.saturating_add(steps as i64));
        if let (Some(anchor), Some(anchor_us)) = (header.anchor, data.anchor_us) {
            let remote_us = unwrap_near(anchor.time_us, 32, node_us);
            self.fit.push(Pair { remote_s: remote_us as f64 * 1e-6, local_s: anchor_us as f64 * 1e-6 });
        }
        let lost = self.next_sequence.map_or(0, |next| sequence.saturating_sub(next).max(0)) as u64;
        self.lost = self.lost.saturating_add(lost);
        self.next_sequence = Some(sequence.saturating_add(i64::from(packet.count())));
        (self.node_us, self.sequence) = (node_us, sequence);
        self.arrival_us = self.arrival_us.max(data.arrival_us);
        self.arrivals.push_back((self.arrival_us, packet.count()));
        while self.arrivals.len() > ARRIVALS_MAX
            || self.arrivals.front().is_some_and(|(us, _)| self.arrival_us - us > RATE_WINDOW_US)
        {
            self.arrivals.pop_front();
        }
        for (k, sample) in (0_u16..).zip(packet.samples()) {
            let attitude = Quaternion::from_array(sample.world_from_body());
            self.world_from_body = attitude.try_normalized().unwrap_or(Quaternion::IDENTITY);
            self.samples += 1;
            self.waiting.push_back(Waiting {
                node_us: node_us + i64::from(sample.dt_us),
                arrival_us: data.arrival_us,
                sample: Sample {
                    node: self.node,
                    boot: self.boot,
                    sequence: sequence + i64::from(k),
                    raw_sequence: header.sequence.wrapping_add(k),
                    stamp_us: header.time_us.wrapping_add(u32::from(sample.dt_us)),
                    time_s: None,
                    frame: None,
                    from_gate: false,
                    arrival_frame: data.pulse,
                    gyro_rad_s: sample.gyro_rad_s(header.flags.gyro_range),
                    acc_m_s2: sample.acc_m_s2(header.flags.acc_range),
                    world_from_body: self.world_from_body,
                    temperature_c: header.temperature_centi_c.map(|t| f64::from(t) * 0.01),
                    late: header.flags.late,
                    reading_missed: header.flags.reading_missed,
                    start: header.flags.start,
                    filter: header.flags.filter,
                    calibrated: header.flags.calibrated,
                },
            });
        }
        lost
    }

    /// Tells the samples whose pulses are there, in their order; with `all`, the rest as it is.
    pub fn release(
        &mut self,
        pulses: &PulseTrain<PULSES>,
        from_gate: bool,
        now_us: u64,
        all: bool,
        mut told: impl FnMut(Sample),
    ) {
        let crowded = self.waiting.len() > WAITING_MAX;
        while let Some(first) = self.waiting.front() {
            let time_s = match self.fit.map(first.node_us as f64 * 1e-6) {
                Some(time_s) if self.fit.pairs() >= PAIRS_MIN => Some(time_s),
                _ if all || crowded || now_us.saturating_sub(first.arrival_us) > CLOCK_PATIENCE_US => None,
                _ => return,
            };
            let frame = match time_s.map(|time_s| (time_s, pulses.frame(time_s))) {
                Some((_, Frame::At(frame))) => Some(frame),
                Some((time_s, Frame::NotYet)) => {
                    let patient = now_us as f64 * 1e-6 - time_s < PULSE_PATIENCE_S;
                    if patient && !all && !crowded {
                        return;
                    }
                    None
                }
                Some((_, Frame::Outside)) | None => None,
            };
            let Some(first) = self.waiting.pop_front() else { return };
            told(Sample { time_s, frame, from_gate: frame.is_some() && from_gate, ..first.sample });
        }
    }

    pub fn quality(&self, now_us: u64) -> Quality {
        let in_window = |us: u64| now_us.saturating_sub(us) <= RATE_WINDOW_US;
        let counted: u64 =
            self.arrivals.iter().filter(|(us, _)| in_window(*us)).map(|(_, count)| u64::from(*count)).sum();
        let since = self.arrivals.front().map_or(0, |(us, _)| now_us.saturating_sub(*us));
        let window_us = since.clamp(1, RATE_WINDOW_US);
        Quality {
            rate_hz: counted as f64 / (window_us as f64 * 1e-6),
            samples: self.samples,
            lost: self.lost,
            clock_residual_s: self.fit.residual_s(),
            skew_ppm: self.fit.skew() * 1e6,
            world_from_body: self.world_from_body,
            silent_s: now_us.saturating_sub(self.arrival_us) as f64 * 1e-6,
        }
    }
}

#[cfg(test)]
mod tests {
    use shisei_wire::packet::{self, Header, PACKET_MAX, Sample as Sent};

    use super::*;

    /// A receiver that gives every packet the same time.
    #[test]
    fn a_clock_that_stands_still_costs_no_memory() {
        let mut bytes = [0; PACKET_MAX];
        let length = packet::encode(&Header::default(), &[Sent::default()], &mut bytes).unwrap();
        let packet = Packet::decode(&bytes[..length]).unwrap();
        let data = Data { node: 0, arrival_us: 5, anchor_us: None, pulse: None, packet: &bytes[..length] };
        let mut track = Track::new(0, &packet, 5);
        for _ in 0..3 * ARRIVALS_MAX {
            track.push(&data, &packet);
            track.release(&PulseTrain::default(), false, 5, false, |_| {});
        }
        assert!(track.arrivals.len() <= ARRIVALS_MAX && track.waiting.len() <= WAITING_MAX + 1);
    }
}
