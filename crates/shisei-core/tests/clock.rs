//! Frame index errors against a simulated pair of clocks: 40 ppm skew that wanders, anchors every 15 ms of which
//! 30 % are missed, 16 µs of jitter on either side; the simple rule beside it.

use shisei_core::clock::{
    ClockFit, Frame, Pair, Pulse, PulseTrain, Settings, arrival_frame, frame_index, map_between,
};
use shisei_core::math;

/// Normal deviates from a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = math::sqrt(-2.0 * math::ln(1.0 - self.uniform()));
        radius * math::cos(core::f64::consts::TAU * self.uniform())
    }
}

/// The node's clock at a true time: offset, 40 ppm, and a drift of 0.05 ppm/s.
fn node_s(time_s: f64) -> f64 {
    1.234 + time_s * (1.0 + 40e-6) + 0.5 * 0.05e-6 * time_s * time_s
}

const RATE_HZ: f64 = 120.0;
const DURATION_S: f64 = 120.0;
const PERIOD_S: f64 = 1.0 / RATE_HZ;

struct Errors(Vec<f64>);

impl Errors {
    /// Median and largest, µs of camera time.
    fn median_and_max(mut self) -> (f64, f64) {
        self.0.sort_by(f64::total_cmp);
        (self.0[self.0.len() / 2] * 1e6, self.0[self.0.len() - 1] * 1e6)
    }
}

#[test]
fn frame_indices_are_within_microseconds() {
    let mut noise = Noise(1);
    let jitter_s = 16e-6;
    let pulses: Vec<Pulse> = (0..(RATE_HZ * DURATION_S) as u32)
        .map(|count| Pulse { time_s: math::round(f64::from(count) * PERIOD_S * 1e6) * 1e-6, count })
        .collect();
    let mut pairs = Vec::new();
    let mut anchors = Vec::new();
    for k in 0..(DURATION_S / 0.015) as u32 {
        let time_s = 0.003 + f64::from(k) * 0.015;
        if noise.uniform() < 0.3 {
            continue;
        }
        let (a, b) = (jitter_s * noise.normal(), jitter_s * noise.normal());
        pairs.push(Pair { remote_s: node_s(time_s) + a, local_s: time_s + b });
        anchors.push(time_s);
    }
    let mut fit = ClockFit::new(Settings::default());
    let mut train = PulseTrain::<64>::default();
    let (mut live, mut later, mut simple) = (Errors(vec![]), Errors(vec![]), Errors(vec![]));
    let (mut next_pair, mut next_pulse) = (0, 0);
    for k in 0..((DURATION_S - 1.0) * RATE_HZ) as u32 {
        // Off the pulses, and moved with the node's own clock.
        let time_s = 0.5 + (f64::from(k) + 0.37) * PERIOD_S * (1.0 + 40e-6);
        let truth = time_s * RATE_HZ;
        // A packet is sent at the next event that is heard, 10 ms later at most for this comparison.
        let arrival = anchors[anchors.partition_point(|&anchor_s| anchor_s < time_s)] + 0.001;
        while pairs.get(next_pair).is_some_and(|pair| pair.local_s <= arrival) {
            fit.push(pairs[next_pair]);
            next_pair += 1;
        }
        while pulses[next_pulse].time_s <= arrival + PERIOD_S {
            train.push(pulses[next_pulse]);
            next_pulse += 1;
        }
        let stamp_s = math::round(node_s(time_s) * 1e6) * 1e-6;
        let at = fit.map(stamp_s).expect("there are pairs");
        let Frame::At(frame) = train.frame(at) else { panic!("no frame at {time_s}") };
        live.0.push((frame - truth).abs() * PERIOD_S);
        let at = map_between(&pairs, stamp_s, &Settings::default()).expect("there are pairs");
        let Frame::At(frame) = frame_index(&pulses, at) else { panic!("no frame at {time_s}") };
        later.0.push((frame - truth).abs() * PERIOD_S);
        let rule = arrival_frame(&pulses, arrival).expect("there are pulses");
        simple.0.push((f64::from(rule) - truth).abs() * PERIOD_S);
    }
    let (live, later, simple) = (live.median_and_max(), later.median_and_max(), simple.median_and_max());
    println!("live µs {live:?}, afterwards µs {later:?}, at arrival µs {simple:?}");
    assert!(live.0 <= 20.0 && live.1 <= 200.0, "{live:?}");
    assert!(later.0 <= live.0 && later.1 <= 50.0, "{later:?}");
    assert!(simple.0 > 1000.0, "the simple rule is worse by far: {simple:?}");
}
