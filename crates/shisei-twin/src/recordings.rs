//! The recordings in `examples/`: what they contain and how they are written.
//!
//! `cargo run -p shisei-twin --example make_examples` writes them; a test holds the committed files against
//! what this module makes.

use std::fmt::Write;

use shisei_core::Vec3;

use crate::movements;
use crate::sensor::{Calibration, Correction, Sensor};
use crate::simulate::{Errors, Sample, Settings, Simulation, simulate};

/// Header of a recording of the MU-01.
pub const MU_01_HEADER: &str = "Time,Ax[m/s2],Ay[m/s2],Az[m/s2],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp";
/// The MU-01's temperature column when there is no temperature.
const MU_01_NO_TEMPERATURE: u32 = 4095;
const RATE_HZ: f64 = 100.0;

/// A file of `examples/`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name.
    pub name: &'static str,
    /// What is in it.
    pub text: String,
}

/// All files of `examples/` that this crate writes.
pub fn files() -> Vec<File> {
    let (pelvis, six_face) = (pelvis(), six_face());
    vec![
        File { name: "pelvis.csv", text: mu_01_csv(&pelvis.samples, 31, 278) },
        File { name: "pelvis.truth.csv", text: truth_csv(&pelvis) },
        File { name: "six-face.csv", text: mu_01_csv(&six_face.samples, 0, 482) },
        File { name: "six-face.truth.json", text: calibration_json(&six_face.calibration) },
        File { name: "eight-directions.csv", text: eight_directions_csv() },
    ]
}

/// [`movements::pelvis`], 1,671 samples at 100 Hz, with an MU-01-like sensor whose gyroscope is ten times
/// quieter than that of the printed rows: with theirs 3 s of rest leave 0.1 °/s of bias, and the recording
/// would show the sensor's noise rather than the movement.
pub fn pelvis() -> Simulation {
    pelvis_with_noise(0.1, 1)
}

/// [`pelvis`] with the gyroscope's noise as a share of that of the printed rows, and a seed.
pub fn pelvis_with_noise(gyroscope_noise: f64, seed: u64) -> Simulation {
    let mut sensor = Sensor::mu_01_like();
    sensor.gyroscope.noise_density *= gyroscope_noise;
    let mut gyroscope = Correction::diagonal([0.0117, -0.0213, 0.0234], [1.002, 0.9985, 1.0015]);
    gyroscope.matrix[0][1] = 0.003;
    gyroscope.matrix[2][0] = -0.002;
    let accelerometer = Correction::diagonal([-0.027, 0.012, 0.018], [0.9994, 0.9996, 0.9996]);
    let calibration = Calibration { accelerometer, gyroscope };
    let settings = Settings { errors: Errors::Given(calibration), ..Settings::new(RATE_HZ, seed) };
    simulate(&movements::pelvis(), &sensor, &settings)
}

/// [`movements::six_faces`], 9,240 samples at 100 Hz: 13.4 s a face, turns of 2.4 s, tilts of up to 4°.
pub fn six_face() -> Simulation {
    let tilts_rad = [
        [0.021, -0.013, 0.0],
        [0.035, 0.010, 0.022],
        [-0.012, 0.040, 0.0],
        [-0.030, 0.0, -0.028],
        [0.0, 0.024, -0.031],
        [0.012, -0.045, 0.019],
    ];
    let mut path = movements::six_faces(13.4, 2.4, &tilts_rad);
    path.duration_s = 92.39;
    let accelerometer = Correction::diagonal([-0.031, -0.068, 0.094], [0.9962, 1.0027, 0.9984]);
    let gyroscope = Correction::diagonal([0.0068, 0.0093, -0.0086], [1.0; 3]);
    let calibration = Calibration { accelerometer, gyroscope };
    let settings = Settings { errors: Errors::Given(calibration), ..Settings::new(RATE_HZ, 2) };
    simulate(&path, &Sensor::mu_01_like(), &settings)
}

/// Mean rates of eight directions of a resting sensor, rad/s: the table published with "地球の自転を測る"
/// (a Spresense with the multi-IMU board turned about one axis), as printed.
pub const EIGHT_DIRECTIONS_RAD_S: [[&str; 3]; 8] = [
    ["-8.590145e-05", "1.027719e-04", "-4.973161e-06"],
    ["-3.489062e-05", "1.068568e-04", "-6.999941e-06"],
    ["2.255051e-06", "8.227464e-05", "-2.155673e-06"],
    ["9.418819e-06", "3.407280e-05", "-5.446403e-06"],
    ["-1.600360e-05", "-8.387869e-06", "-7.528374e-06"],
    ["-8.068976e-05", "-1.206517e-05", "-2.698692e-06"],
    ["-1.060789e-04", "1.037688e-05", "-3.234577e-06"],
    ["-1.059256e-04", "6.629112e-05", "-1.036393e-05"],
];

fn eight_directions_csv() -> String {
    let mut text = String::from("gyr_x,gyr_y,gyr_z\n");
    for row in EIGHT_DIRECTIONS_RAD_S {
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

/// The MU-01's CSV as it looks when a spreadsheet has saved it: time as minutes and tenths of a second from a
/// clock that starts at `minutes` and `tenths_s`.
pub fn mu_01_csv(samples: &[Sample], minutes: u64, tenths_s: u64) -> String {
    let mut text = String::from(MU_01_HEADER);
    text.push('\n');
    for sample in samples {
        let since_start_tenths = shisei_core::math::floor(sample.time_s * 10.0 + 0.5 + 1e-6) as u64;
        let tenths = minutes * 600 + tenths_s + since_start_tenths;
        let _ = write!(text, "{:02}:{:02}.{}", tenths / 600 % 60, tenths / 10 % 60, tenths % 10);
        for value in sample.acc_m_s2.iter().chain(&sample.gyro_rad_s) {
            let _ = write!(text, ",{}", fixed(*value, 6));
        }
        let _ = writeln!(text, ",{MU_01_NO_TEMPERATURE}");
    }
    text
}

/// Attitude at each sample; yaw, pitch and roll relative to the first in world axes.
fn truth_csv(simulation: &Simulation) -> String {
    let mut text = String::from("time_s,q_w,q_x,q_y,q_z,yaw_rad,pitch_rad,roll_rad\n");
    let start = simulation.truth[0].world_from_body.conjugate();
    for (sample, truth) in simulation.samples.iter().zip(&simulation.truth) {
        let q = truth.world_from_body;
        let _ = write!(text, "{}", fixed(sample.time_s, 2));
        for value in q.to_array().iter().chain(&q.product(start).to_ypr().to_array()) {
            let _ = write!(text, ",{}", fixed(*value, 8));
        }
        text.push('\n');
    }
    text
}

/// A number with so many decimals, and no minus before zero.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        _ => text,
    }
}

/// The true calibration in the form of the calibration file.
pub fn calibration_json(calibration: &Calibration) -> String {
    let vector = |v: Vec3| format!("[{}, {}, {}]", v[0], v[1], v[2]);
    let matrix = |c: &Correction| {
        format!("[{}, {}, {}]", vector(c.matrix[0]), vector(c.matrix[1]), vector(c.matrix[2]))
    };
    let (acc, gyr) = (&calibration.accelerometer, &calibration.gyroscope);
    format!(
        "{{\n  \"format\": \"shisei-calibration\",\n  \"version\": 1,\n  \"sensor\": \"simulated\",\n  \
         \"method\": \"truth\",\n  \"gravity_m_s2\": 9.80665,\n  \
         \"accelerometer\": {{\n    \"bias_m_s2\": {},\n    \"matrix\": {}\n  }},\n  \
         \"gyroscope\": {{\n    \"bias_rad_s\": {},\n    \"matrix\": {}\n  }}\n}}\n",
        vector(acc.bias),
        matrix(acc),
        vector(gyr.bias),
        matrix(gyr)
    )
}
