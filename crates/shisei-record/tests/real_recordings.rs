//! Real recordings of many makers, with the facts of their ORIGIN.txt. Skipped, saying so, where absent.

use shisei_record::{AxisMap, Input, Options, Problem, Recording, Result, Scale, inspect, open};
use std::path::PathBuf;

fn data() -> Option<PathBuf> {
    let root = std::env::var_os("SHISEI_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    if root.is_dir() {
        return Some(root);
    }
    eprintln!("skipped: no recordings in {}", root.display());
    None
}

fn read(names: &[&str], options: &Options) -> Option<Result<Recording>> {
    let root = data()?;
    let files: Vec<Vec<u8>> = names.iter().map(|n| std::fs::read(root.join(n)).unwrap()).collect();
    let inputs: Vec<Input<'_>> =
        names.iter().zip(&files).map(|(name, bytes)| Input { name, bytes }).collect();
    Some(open(&inputs, options))
}

/// Facts about a file: columns of acc x y z then gyr x y z, units, nominal rate and its tolerance, rows.
struct Facts {
    files: &'static [&'static str],
    dialect: &'static str,
    columns: [&'static str; 6],
    units: [&'static str; 2],
    rate_hz: (f64, f64),
    rows: usize,
    /// First sample, SI.
    first_acc: [f64; 3],
    first_gyro: [f64; 3],
}

const XIO: [&str; 6] = [
    "Accelerometer X (g)",
    "Accelerometer Y (g)",
    "Accelerometer Z (g)",
    "Gyroscope X (deg/s)",
    "Gyroscope Y (deg/s)",
    "Gyroscope Z (deg/s)",
];
const MICROSTRAIN: [&str; 6] = [
    "inertial-6253.76535:scaledAccelX",
    "inertial-6253.76535:scaledAccelY",
    "inertial-6253.76535:scaledAccelZ",
    "inertial-6253.76535:scaledGyroX",
    "inertial-6253.76535:scaledGyroY",
    "inertial-6253.76535:scaledGyroZ",
];
const G: f64 = 9.80665;
const DEG: f64 = core::f64::consts::PI / 180.0;

#[test]
fn columns_units_and_rates() {
    let table = [
        Facts {
            files: &["dialect_xio_fusion/sensor_data.csv"],
            dialect: "x-io",
            columns: XIO,
            units: ["g", "deg/s"],
            rate_hz: (99.5, 0.6),
            rows: 13_514,
            first_acc: [0.001015204 * G, -0.02045836 * G, 0.9970807 * G],
            first_gyro: [0.01644619 * DEG, -0.1517251 * DEG, 0.1080897 * DEG],
        },
        Facts {
            files: &["zupt_xio_gait/short_walk.csv"],
            dialect: "x-io",
            columns: XIO,
            units: ["g", "deg/s"],
            rate_hz: (400.0, 2.0),
            rows: 16_539,
            first_acc: [-0.4937814 * G, 0.2420433 * G, 0.8312204 * G],
            first_gyro: [-0.1428319 * DEG, -0.7708032 * DEG, -0.2320606 * DEG],
        },
        Facts {
            files: &["zupt_gaitdriven_own/SensorConnectData_32.csv"],
            dialect: "microstrain",
            columns: MICROSTRAIN,
            units: ["g", "rad/s"],
            rate_hz: (200.0, 0.5),
            rows: 14_601,
            first_acc: [0.5472133159637451 * G, 0.1808090955018997 * G, -0.821807921 * G],
            first_gyro: [-0.025511449, 0.007650589, -0.013841595],
        },
        Facts {
            files: &["dialect_phyphox_ios/Accelerometer.csv", "dialect_phyphox_ios/Gyroscope.csv"],
            dialect: "phyphox",
            columns: ["X (m/s^2)", "Y (m/s^2)", "Z (m/s^2)", "X (rad/s)", "Y (rad/s)", "Z (rad/s)"],
            units: ["m/s²", "rad/s"],
            rate_hz: (100.0, 1.0),
            rows: 10_575,
            // Between the rows at 0.01337908334 and 0.02331108334 s.
            first_acc: [-0.6398, 1.5300, 9.7031],
            first_gyro: [1.314016283E-1, 1.265425533E-1, 7.930336893E-2],
        },
        Facts {
            files: &["dialect_android_ms/Gyroscope.csv", "dialect_android_ms/Accelerometer.csv"],
            dialect: "android-ms",
            columns: ["X", "Y", "Z", "X", "Y", "Z"],
            units: ["m/s²", "rad/s"],
            rate_hz: (20.0, 0.1),
            rows: 425,
            first_acc: [-0.035294134, 0.030508488, 9.870394],
            first_gyro: [-7.635591E-4, 1.5271181E-4, 3.0542363E-4],
        },
        Facts {
            files: &["earthrate_spresense/log_imu_090deg.txt"],
            dialect: "spresense",
            columns: [
                "acceleration x",
                "acceleration y",
                "acceleration z",
                "gyroscope x",
                "gyroscope y",
                "gyroscope z",
            ],
            units: ["m/s²", "rad/s"],
            rate_hz: (960.0, 10.0),
            rows: 4_354,
            // 3e48c26a, bca45828, 411ca971 and b9dc43c8, 3a29de8d, b96b3664 as float32 (Python's struct).
            first_acc: [0.196_054_130_8, -0.020_061_567_4, 9.791_367_530_8],
            first_gyro: [-0.000_420_121_71, 0.000_648_000_10, -0.000_224_316_09],
        },
    ];
    for facts in table {
        let Some(recording) = read(facts.files, &Options::default()) else { return };
        let recording = recording.unwrap_or_else(|e| panic!("{:?}: {e}", facts.files));
        assert_eq!(recording.dialect, facts.dialect);
        assert_eq!(recording.len(), facts.rows, "{:?}", facts.files);
        for (role, name) in ["acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"].iter().zip(facts.columns) {
            let channel = recording.channels.iter().find(|c| c.role == *role).unwrap();
            assert_eq!(channel.name, name);
            let unit = if role.starts_with("acc") { facts.units[0] } else { facts.units[1] };
            assert_eq!(channel.unit, unit, "{:?}", facts.files);
        }
        let (rate, tolerance) = facts.rate_hz;
        assert!((recording.findings.rate_hz - rate).abs() <= tolerance, "{}", recording.findings.rate_hz);
        for i in 0..3 {
            let tolerance = if facts.dialect == "phyphox" { 1e-3 } else { 1e-9 };
            assert!((recording.acc_m_s2[0][i] - facts.first_acc[i]).abs() < tolerance, "{:?}", facts.files);
            assert!((recording.gyro_rad_s[0][i] - facts.first_gyro[i]).abs() < 1e-8);
        }
        assert!(recording.dt_s.iter().all(|dt| *dt > 0.0));
    }
}

#[test]
fn gaps_repeats_and_wraps() {
    // Six headings in bursts of four: about every fourth step is a pause of 18 to 26 ms.
    for name in ["000", "090", "180", "270"] {
        let file = format!("earthrate_spresense/log_imu_{name}deg.txt");
        let Some(recording) = read(&[&file], &Options::default()) else { return };
        let f = recording.unwrap().findings;
        assert!(f.gap_count > f.rows / 5 && f.gap_count < f.rows / 3, "{name} {}", f.gap_count);
        assert!(f.gap_total_s > 0.8 * f.duration_s, "{name}");
    }
    let Some(walk) = read(&["zupt_xio_gait/short_walk.csv"], &Options::default()) else { return };
    let f = walk.unwrap().findings;
    // Counted with awk over the file: rows whose stamp equals the one before.
    assert_eq!(f.repeated_stamps, 205);
    assert!(f.gap_count > 0);
}

#[test]
fn axes_that_point_down_are_reported_and_mended() {
    let file = ["zupt_gaitdriven_own/SensorConnectData_31.csv"];
    let Some(recording) = read(&file, &Options::default()) else { return };
    let recording = recording.unwrap();
    assert!(recording.warnings.iter().any(|w| w.code == "axes-z-down"));
    assert!(recording.findings.rest_acc[2] < -7.0);
    let axes = Some(AxisMap::parse("x,-y,-z").unwrap());
    let mended = read(&file, &Options { axes, ..Options::default() }).unwrap().unwrap();
    assert!(mended.warnings.iter().all(|w| w.code != "axes-z-down" && w.code != "z-down"));
    assert!(mended.findings.rest_acc[2] > 7.0);
}

#[test]
fn raw_counts_ask_for_a_scale() {
    for file in [
        "calib_imucal_ferraris/annotated_session.csv",
        "calib_tomisuarez_mpu6050/example_data_calibration.csv",
        "calib_tomisuarez_mpu6050/example_data_tinit_calc.csv",
    ] {
        let Some(refused) = read(&[file], &Options::default()) else { return };
        assert!(matches!(refused.unwrap_err().problem, Problem::RawCounts { .. }), "{file}");
    }
    // MPU-6050: 16384 counts a g, 131 a deg/s, 100 Hz in the preamble.
    let options = Options { scale: Some(Scale::parse("acc=16384,gyr=131").unwrap()), ..Options::default() };
    let recording =
        read(&["calib_tomisuarez_mpu6050/example_data_calibration.csv"], &options).unwrap().unwrap();
    assert_eq!(recording.findings.rate_hz, 100.0);
    assert!((recording.findings.rest_norm - G).abs() < 1.5, "{}", recording.findings.rest_norm);
    assert_eq!(recording.acc_m_s2[0][2], 15032.0 * (G / 16384.0));
    // imucal: 204.8 Hz, no clock in the file.
    let scale = Some(Scale::parse("acc=2045,gyr=16").unwrap());
    let options = Options { scale, rate_hz: Some(204.8), ..Options::default() };
    let recording = read(&["calib_imucal_ferraris/annotated_session.csv"], &options).unwrap().unwrap();
    assert_eq!((recording.len(), recording.findings.rate_hz), (9_414, 204.8));
}

#[test]
fn numbers_without_a_header_ask_for_the_rate() {
    for file in ["calib_mikoff_mpu9150/imu0.log", "calib_mikoff_mpu9150/imu1.log"] {
        let Some(refused) = read(&[file], &Options::default()) else { return };
        assert_eq!(refused.unwrap_err().problem, Problem::RateNeeded);
        let options = Options { rate_hz: Some(100.0), ..Options::default() };
        let recording = read(&[file], &options).unwrap().unwrap();
        assert_eq!(recording.dialect, "headerless");
        assert!((recording.findings.rest_norm - G).abs() < 0.6, "{}", recording.findings.rest_norm);
        let unit = |role: &str| recording.channels.iter().find(|c| c.role == role).unwrap().unit.clone();
        assert_eq!((unit("acc_x").as_str(), unit("gyr_x").as_str()), ("m/s²", "rad/s"));
        let channel = recording.channels.iter().find(|c| c.role == "gyr_z").unwrap();
        assert_eq!(channel.number, 6);
    }
}

#[test]
fn files_that_are_no_recording() {
    for number in ["31", "32"] {
        let file =
            format!("zupt_gaitdriven_own/SensorConnectData_{number}_strideIndex_timestamp_gcpX_gcpY.csv");
        let Some(refused) = read(&[&file], &Options::default()) else { return };
        assert!(matches!(refused.unwrap_err().problem, Problem::NotARecording { .. }));
    }
    let motive = "motive/v1.21_quat_m_120Hz_rb_markers__hmv-s16.csv";
    let refused = read(&[motive], &Options::default()).unwrap();
    assert!(matches!(refused.unwrap_err().problem, Problem::NotARecording { .. }));
}

#[test]
fn xsens_dot_without_gyro_is_listed_and_refused() {
    let Some(root) = data() else { return };
    let name = "LTibia_20210820_202113_811.csv";
    let bytes = std::fs::read(root.join("dialect_xsensdot").join(name)).unwrap();
    let input = [Input { name, bytes: &bytes }];
    let error = open(&input, &Options::default()).unwrap_err();
    assert!(matches!(error.problem, Problem::GravityRemoved { .. }), "{error}");
    let seen = inspect(&input, &Options::default()).unwrap();
    assert_eq!(seen.dialect, "xsens-dot");
    assert_eq!(seen.channels.len(), 10);
    assert_eq!(seen.channels[6].role, "acceleration without gravity");
    assert!(seen.preamble.iter().any(|l| l.contains("60Hz")));
    assert_eq!(seen.refusal, Some(error));
}
