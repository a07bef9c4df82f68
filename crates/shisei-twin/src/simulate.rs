//! A movement, sampled by a sensor: readings and truth side by side.

use shisei_core::{Quaternion, Vec3, math};

use crate::imu::{World, ideal_imu};
use crate::motion::Motion;
use crate::random::Random;
use crate::sensor::{Calibration, Correction, Matrix, Sensor, Triad};

/// Streams of one seed, so that one option does not shift the numbers of another.
const STREAM_CLOCK: u64 = 1;
const STREAM_ERRORS: u64 = 2;
const STREAM_ACCELEROMETER: u64 = 3;
const STREAM_GYROSCOPE: u64 = 4;

/// Where a simulated sensor's calibration comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Errors {
    /// Drawn from the sensor's deviations from part to part.
    #[default]
    Drawn,
    /// Drawn, but without misalignment: the matrices are diagonal.
    DrawnAligned,
    /// Given.
    Given(Calibration),
}

/// How a movement is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Samples a second, Hz; > 0.
    pub rate_hz: f64,
    /// The seed of all that is random.
    pub seed: u64,
    /// Gravity and the world's rotation.
    pub world: World,
    /// The sensor's true calibration.
    pub errors: Errors,
    /// Each sample but the first comes up to this fraction of an interval early or late (uniform); its stamp
    /// says when. Below 0.5 the stamps ascend.
    pub jitter: f64,
    /// Probability that a sample is lost; the first and the last are kept.
    pub lost: f64,
}

impl Settings {
    /// Even sampling without losses, standard gravity, errors drawn.
    pub fn new(rate_hz: f64, seed: u64) -> Self {
        Settings { rate_hz, seed, world: World::default(), errors: Errors::Drawn, jitter: 0.0, lost: 0.0 }
    }
}

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When it was taken, s.
    pub time_s: f64,
    /// Accelerometer, m/s², raw.
    pub acc_m_s2: Vec3,
    /// Gyroscope, rad/s, raw.
    pub gyro_rad_s: Vec3,
}

/// The truth at the time of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Attitude.
    pub world_from_body: Quaternion,
    /// Position of the sensor, world, m.
    pub position_m: Vec3,
    /// Velocity of the sensor, world, m/s.
    pub velocity_m_s: Vec3,
    /// Gyroscope bias with its random walk, rad/s.
    pub gyro_bias_rad_s: Vec3,
    /// Accelerometer bias with its random walk, m/s².
    pub acc_bias_m_s2: Vec3,
}

/// Readings and their truth; equal in length.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// What the sensor wrote.
    pub samples: Vec<Sample>,
    /// What was so, one a sample.
    pub truth: Vec<Truth>,
    /// The sensor's true calibration.
    pub calibration: Calibration,
}

impl Simulation {
    /// When the samples were taken, s.
    pub fn time_s(&self) -> Vec<f64> {
        self.samples.iter().map(|sample| sample.time_s).collect()
    }

    /// The accelerometer's raw readings, m/s².
    pub fn acc_m_s2(&self) -> Vec<Vec3> {
        self.samples.iter().map(|sample| sample.acc_m_s2).collect()
    }

    /// The gyroscope's raw readings, rad/s.
    pub fn gyro_rad_s(&self) -> Vec<Vec3> {
        self.samples.iter().map(|sample| sample.gyro_rad_s).collect()
    }
}

/// Samples a movement from time 0 to its duration, both included.
pub fn simulate(motion: &dyn Motion, sensor: &Sensor, settings: &Settings) -> Simulation {
    let calibration = part(sensor, settings);
    let mut clock = Random::new(settings.seed, STREAM_CLOCK);
    let new_channel = |triad, correction, stream| Channel::new(triad, correction, settings, stream);
    let mut accelerometer =
        new_channel(sensor.accelerometer, calibration.accelerometer, STREAM_ACCELEROMETER);
    let mut gyroscope = new_channel(sensor.gyroscope, calibration.gyroscope, STREAM_GYROSCOPE);

    // The small addend keeps the last sample where duration · rate is a whole number but for rounding.
    let last = math::floor(motion.duration_s() * settings.rate_hz + 1e-6).max(0.0) as usize;
    let mut simulation = Simulation {
        samples: Vec::with_capacity(last + 1),
        truth: Vec::with_capacity(last + 1),
        calibration,
    };
    for k in 0..=last {
        let early_or_late = settings.jitter * clock.between(-1.0, 1.0);
        let is_lost = clock.uniform() < settings.lost;
        let time_s = (k as f64 + if k == 0 { 0.0 } else { early_or_late }) / settings.rate_hz;
        let state = motion.state(time_s);
        let (acc_ideal, gyro_ideal) = ideal_imu(&state, &settings.world);
        // A lost sample was measured all the same: noise and walk go on.
        let (acc_m_s2, acc_bias_m_s2) = accelerometer.read(acc_ideal);
        let (gyro_rad_s, gyro_bias_rad_s) = gyroscope.read(gyro_ideal);
        if is_lost && k != 0 && k != last {
            continue;
        }
        simulation.samples.push(Sample { time_s, acc_m_s2, gyro_rad_s });
        simulation.truth.push(Truth {
            world_from_body: state.world_from_body,
            position_m: state.position_m,
            velocity_m_s: state.velocity_m_s,
            gyro_bias_rad_s,
            acc_bias_m_s2,
        });
    }
    simulation
}

/// The true calibration of the part that these settings' seed and errors give.
pub fn part(sensor: &Sensor, settings: &Settings) -> Calibration {
    let mut random = Random::new(settings.seed, STREAM_ERRORS);
    let mut draw = |mut triad: Triad, aligned: bool| {
        if aligned {
            triad.misalignment_sigma = 0.0;
        }
        Correction::draw(&triad, &mut random)
    };
    match settings.errors {
        Errors::Given(calibration) => calibration,
        Errors::Drawn | Errors::DrawnAligned => {
            let aligned = settings.errors == Errors::DrawnAligned;
            Calibration {
                accelerometer: draw(sensor.accelerometer, aligned),
                gyroscope: draw(sensor.gyroscope, aligned),
            }
        }
    }
}

/// One triad at work.
struct Channel {
    triad: Triad,
    correction: Correction,
    inverse: Matrix,
    noise_sigma: f64,
    walk_sigma: f64,
    walk: Vec3,
    random: Random,
}

impl Channel {
    fn new(triad: Triad, correction: Correction, settings: &Settings, stream: u64) -> Self {
        Channel {
            triad,
            correction,
            inverse: correction.inverse(),
            noise_sigma: triad.noise_density * math::sqrt(0.5 * settings.rate_hz),
            walk_sigma: triad.bias_walk / math::sqrt(settings.rate_hz),
            walk: [0.0; 3],
            random: Random::new(settings.seed, stream),
        }
    }

    /// The reading and the bias it contains.
    fn read(&mut self, ideal: Vec3) -> (Vec3, Vec3) {
        let raw = self.correction.raw(&self.inverse, ideal);
        let noise = self.random.normal3(self.noise_sigma);
        let (mut reading, mut bias) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            bias[axis] = self.correction.bias[axis] + self.walk[axis];
            reading[axis] = self.triad.quantise(raw[axis] + self.walk[axis] + noise[axis]);
        }
        let step = self.random.normal3(self.walk_sigma);
        for axis in 0..3 {
            self.walk[axis] += step[axis];
        }
        (reading, bias)
    }
}
