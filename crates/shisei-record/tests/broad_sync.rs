//! Clock offset and mounting on real recordings: BROAD's sensor is 2.5 ms later than its optics, and its frames
//! agree; the sensor's readings are turned by a known rotation first, so that there is something to find.

use shisei_core::sync::rates::{RatesSettings, synchronise};
use shisei_core::{Quaternion, Vec3};
use shisei_record::{Input, Options, Recording, open};

fn column(recording: &Recording, name: &str) -> Vec<f64> {
    let extra = recording.extra.iter().find(|extra| extra.name == name).expect("an optical column");
    extra.cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn the_offset_and_mounting_of_broad() {
    let root = std::env::var_os("SHISEI_DATA").map_or_else(
        || concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").into(),
        std::path::PathBuf::from,
    );
    let mut trials = 0;
    for name in
        ["06_undisturbed_fast_rotation_A", "16_undisturbed_fast_translation_B", "24_disturbed_tapping_A"]
    {
        let Ok(bytes) = std::fs::read(root.join("broad").join(name).with_extension("parquet")) else {
            eprintln!("skipped: BROAD trial {name} is absent (SHISEI_DATA)");
            continue;
        };
        trials += 1;
        let options = Options { keep: vec!["*".into()], ..Options::default() };
        let recording = open(&[Input { name: "trial.parquet", bytes: &bytes }], &options).expect("a trial");
        let q = ["opt_q_w", "opt_q_x", "opt_q_y", "opt_q_z"].map(|name| column(&recording, name));
        let attitude: Vec<Option<Quaternion>> = (0..recording.len())
            .map(|k| Quaternion::new(q[0][k], q[1][k], q[2][k], q[3][k]).try_normalized().ok())
            .collect();
        let mounting = Quaternion::from_rotation_vector([1.1, -2.0, 0.7]);
        let gyro: Vec<Vec3> =
            recording.gyro_rad_s.iter().map(|rate| mounting.conjugate().rotate(*rate)).collect();
        let sync =
            synchronise(&recording.time_s, &attitude, &recording.time_s, &gyro, &RatesSettings::default())
                .expect("one object");
        let offset_s = sync.sensor_time_s(sync.middle_s) - sync.middle_s;
        let turned = sync.body_from_sensor.conjugate().product(mounting).angle().to_degrees();
        println!(
            "{name}: offset {:.3} ± {:.3} ms, skew {:.2} ± {:.2} ppm, mounting {turned:.3}°, explained {:.5}",
            offset_s * 1e3,
            sync.sigma_offset_s * 1e3,
            sync.skew * 1e6,
            sync.sigma_skew * 1e6,
            sync.explained
        );
        assert!((offset_s - 0.0025).abs() < 0.0005, "{name}: {sync:?}");
        assert!(turned < 0.3, "{name}: {turned}");
    }
    assert!(trials == 0 || trials == 3, "trials are missing");
}
