//! Headers of many loggers: which column is which, and in what unit.

use shisei_record::{Input, Options, Problem, inspect, open};

/// Builds a table: each header cell gets a plausible value, given as (header, value of row i).
fn table(cells: &[(&str, &str)], rows: usize) -> String {
    let mut out = cells.iter().map(|c| c.0).collect::<Vec<_>>().join(",") + "\n";
    for i in 0..rows {
        let row: Vec<String> = cells
            .iter()
            .map(|(_, kind)| match *kind {
                "s" => format!("{:.4}", i as f64 * 0.01),
                "ms" => format!("{}", i * 10),
                "us" => format!("{}", i * 10_000),
                "ns" => format!("{}", 1_600_000_000_000_000_000u64 + i as u64 * 10_000_000),
                "epoch_ms" => format!("{}", 1_600_000_000_000u64 + i as u64 * 10),
                "epoch_s" => format!("{:.3}", 1_600_000_000.0 + i as f64 * 0.01),
                "date" => format!("2024-02-03 04:05:{:06.3}", i as f64 * 0.01),
                "clock" => format!("04:05:{:06.3}", i as f64 * 0.01),
                "n" => format!("{i}"),
                "1" => "1".into(),
                "G" => format!("{:.5}", 0.99 + (i % 3) as f64 * 0.001),
                "M" => format!("{:.5}", 9.79 + (i % 3) as f64 * 0.01),
                "mG" => format!("{}", 990 + i % 3),
                "0" => format!("{:.4}", (i % 7) as f64 * 0.001),
                "w" => format!("{:.4}", 30.0 + (i % 7) as f64),
                other => other.to_owned(),
            })
            .collect();
        out += &(row.join(",") + "\n");
    }
    out
}

/// Column numbers (from 1) of acc x y z, gyr x y z; then |a| and the first gyro value in SI.
fn check(cells: &[(&str, &str)], columns: [usize; 6], norm: f64, gyro_x: Option<f64>) {
    let text = table(cells, 300);
    let head = text.lines().next().unwrap();
    let options = Options::default();
    let recording = open(&[Input { name: "log.csv", bytes: text.as_bytes() }], &options)
        .unwrap_or_else(|e| panic!("{head}: {e}"));
    for (role, number) in ["acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"].iter().zip(columns) {
        let found = recording.channels.iter().find(|c| c.role == *role).unwrap();
        assert_eq!(found.number, number, "{head}: {role}");
    }
    assert!((recording.findings.rest_norm - norm).abs() < 0.3, "{head}: {}", recording.findings.rest_norm);
    assert!((recording.findings.rate_hz - 100.0).abs() < 0.1, "{head}: {}", recording.findings.rate_hz);
    if let Some(gyro_x) = gyro_x {
        assert!((recording.gyro_rad_s[0][0] - gyro_x).abs() < 1e-6, "{head}: {:?}", recording.gyro_rad_s[0]);
    }
}

const DEG30: f64 = 30.0 * core::f64::consts::PI / 180.0;

#[test]
fn spellings() {
    let orders = [1, 2, 3, 4, 5, 6];
    let plus = |n: usize| orders.map(|c| c + n);
    let gyro_first = [5, 6, 7, 2, 3, 4];
    // Arduino sketches.
    check(
        &[("ax", "0"), ("ay", "0"), ("az", "G"), ("gx", "w"), ("gy", "0"), ("gz", "0"), ("t", "s")],
        orders,
        9.7,
        Some(DEG30),
    );
    check(
        &[("millis", "ms"), ("aX", "0"), ("aY", "0"), ("aZ", "G"), ("gX", "w"), ("gY", "0"), ("gZ", "0")],
        plus(1),
        9.7,
        None,
    );
    check(
        &[
            ("Timestamp", "ms"),
            ("AccX", "0"),
            ("AccY", "0"),
            ("AccZ", "M"),
            ("GyroX", "0"),
            ("GyroY", "0"),
            ("GyroZ", "0"),
        ],
        plus(1),
        9.8,
        None,
    );
    check(
        &[
            ("time_us", "us"),
            ("accel_x", "0"),
            ("accel_y", "0"),
            ("accel_z", "M"),
            ("gyro_x", "0"),
            ("gyro_y", "0"),
            ("gyro_z", "0"),
        ],
        plus(1),
        9.8,
        None,
    );
    check(
        &[
            ("timestamp", "epoch_ms"),
            ("x_acc", "0"),
            ("y_acc", "0"),
            ("z_acc", "G"),
            ("x_gyro", "0"),
            ("y_gyro", "0"),
            ("z_gyro", "0"),
        ],
        plus(1),
        9.7,
        None,
    );
    check(
        &[
            ("timestamp", "epoch_s"),
            ("xAcc", "0"),
            ("yAcc", "0"),
            ("zAcc", "G"),
            ("xGyro", "0"),
            ("yGyro", "0"),
            ("zGyro", "0"),
        ],
        plus(1),
        9.7,
        None,
    );
    // Written units.
    check(
        &[
            ("Time [s]", "s"),
            ("w_x [deg/s]", "w"),
            ("w_y [deg/s]", "0"),
            ("w_z [deg/s]", "0"),
            ("a_x [m/s^2]", "0"),
            ("a_y [m/s^2]", "0"),
            ("a_z [m/s^2]", "M"),
        ],
        gyro_first,
        9.8,
        Some(DEG30),
    );
    check(
        &[
            ("t_ms", "ms"),
            ("acc_x_mg", "0"),
            ("acc_y_mg", "0"),
            ("acc_z_mg", "mG"),
            ("gyr_x_dps", "w"),
            ("gyr_y_dps", "0"),
            ("gyr_z_dps", "0"),
        ],
        plus(1),
        9.71,
        Some(DEG30),
    );
    check(
        &[
            ("time", "s"),
            ("Acceleration X (g)", "0"),
            ("Acceleration Y (g)", "0"),
            ("Acceleration Z (g)", "G"),
            ("Angular Velocity X (°/s)", "w"),
            ("Angular Velocity Y (°/s)", "0"),
            ("Angular Velocity Z (°/s)", "0"),
        ],
        plus(1),
        9.7,
        Some(DEG30),
    );
    check(
        &[
            ("Time(s)", "s"),
            ("Ax(g)", "0"),
            ("Ay(g)", "0"),
            ("Az(g)", "G"),
            ("wx(deg/s)", "w"),
            ("wy(deg/s)", "0"),
            ("wz(deg/s)", "0"),
            ("AngleX(deg)", "0"),
            ("AngleY(deg)", "0"),
            ("AngleZ(deg)", "0"),
            ("T(°)", "w"),
        ],
        plus(1),
        9.7,
        Some(DEG30),
    );
    check(
        &[
            ("timestamp", "s"),
            ("accelerometer_m_s2[0]", "0"),
            ("accelerometer_m_s2[1]", "0"),
            ("accelerometer_m_s2[2]", "M"),
            ("gyro_rad[0]", "0"),
            ("gyro_rad[1]", "0"),
            ("gyro_rad[2]", "0"),
        ],
        plus(1),
        9.8,
        None,
    );
    check(
        &[
            ("時間[s]", "s"),
            ("加速度X[G]", "0"),
            ("加速度Y[G]", "0"),
            ("加速度Z[G]", "G"),
            ("角速度X[dps]", "w"),
            ("角速度Y[dps]", "0"),
            ("角速度Z[dps]", "0"),
            ("地磁気X[uT]", "w"),
            ("地磁気Y[uT]", "w"),
            ("地磁気Z[uT]", "w"),
        ],
        plus(1),
        9.7,
        Some(DEG30),
    );
    // Physics Toolbox, AndroSensor, Sensor Kinetics, Matlab Mobile.
    check(
        &[
            ("time", "s"),
            ("gFx", "0"),
            ("gFy", "0"),
            ("gFz", "G"),
            ("wx", "0"),
            ("wy", "0"),
            ("wz", "0"),
            ("p", "w"),
            ("Bx", "w"),
            ("By", "w"),
            ("Bz", "w"),
        ],
        plus(1),
        9.7,
        None,
    );
    check(
        &[
            ("ACCELEROMETER X (m/s²)", "0"),
            ("ACCELEROMETER Y (m/s²)", "0"),
            ("ACCELEROMETER Z (m/s²)", "M"),
            ("GRAVITY X (m/s²)", "0"),
            ("GRAVITY Y (m/s²)", "0"),
            ("GRAVITY Z (m/s²)", "M"),
            ("LINEAR ACCELERATION X (m/s²)", "0"),
            ("LINEAR ACCELERATION Y (m/s²)", "0"),
            ("LINEAR ACCELERATION Z (m/s²)", "0"),
            ("GYROSCOPE X (rad/s)", "0"),
            ("GYROSCOPE Y (rad/s)", "0"),
            ("GYROSCOPE Z (rad/s)", "0"),
            ("Time since start in ms", "ms"),
            ("YYYY-MO-DD HH-MI-SS_SSS", "x"),
        ],
        [1, 2, 3, 10, 11, 12],
        9.8,
        None,
    );
    check(
        &[
            ("Timestamp", "date"),
            ("imu_acc_x", "0"),
            ("imu_acc_y", "0"),
            ("imu_acc_z", "M"),
            ("imu_gyro_x", "0"),
            ("imu_gyro_y", "0"),
            ("imu_gyro_z", "0"),
            ("imu_mag_x", "w"),
            ("imu_mag_y", "w"),
            ("imu_mag_z", "w"),
            ("qw", "1"),
            ("qx", "0"),
            ("qy", "0"),
            ("qz", "0"),
        ],
        plus(1),
        9.8,
        None,
    );
    check(
        &[
            ("Date", "2024-02-03"),
            ("Time", "clock"),
            ("Accel_X", "0"),
            ("Accel_Y", "0"),
            ("Accel_Z", "G"),
            ("Gyro_X", "0"),
            ("Gyro_Y", "0"),
            ("Gyro_Z", "0"),
        ],
        plus(2),
        9.7,
        None,
    );
    check(
        &[
            ("loop", "n"),
            ("rotationRateX", "0"),
            ("rotationRateY", "0"),
            ("rotationRateZ", "0"),
            ("accelerationX", "0"),
            ("accelerationY", "0"),
            ("accelerationZ", "M"),
            ("timestamp_ns", "ns"),
        ],
        gyro_first,
        9.8,
        None,
    );
    check(
        &[
            ("Acc1", "0"),
            ("Acc2", "0"),
            ("Acc3", "M"),
            ("Gyr1", "0"),
            ("Gyr2", "0"),
            ("Gyr3", "0"),
            ("Time", "s"),
        ],
        orders,
        9.8,
        None,
    );
    check(
        &[
            ("SensorId", "1"),
            ("TimeStamp (s)", "s"),
            ("FrameNumber", "n"),
            ("AccX (g)", "0"),
            ("AccY (g)", "0"),
            ("AccZ (g)", "G"),
            ("GyroX (deg/s)", "w"),
            ("GyroY (deg/s)", "0"),
            ("GyroZ (deg/s)", "0"),
            ("EulerX (deg)", "0"),
            ("LinAccX (g)", "0"),
            ("LinAccY (g)", "0"),
            ("LinAccZ (g)", "0"),
        ],
        [4, 5, 6, 7, 8, 9],
        9.7,
        Some(DEG30),
    );
    check(
        &[
            ("time", "s"),
            ("acc.x", "0"),
            ("acc.y", "0"),
            ("acc.z", "M"),
            ("gyr.x", "0"),
            ("gyr.y", "0"),
            ("gyr.z", "0"),
        ],
        plus(1),
        9.8,
        None,
    );
    check(
        &[
            ("Sample", "n"),
            ("Time_ms", "ms"),
            ("Accelerometer_X", "0"),
            ("Accelerometer_Y", "0"),
            ("Accelerometer_Z", "G"),
            ("Gyroscope_X_DegPerS", "w"),
            ("Gyroscope_Y_DegPerS", "0"),
            ("Gyroscope_Z_DegPerS", "0"),
            ("Temp", "w"),
        ],
        plus(2),
        9.7,
        Some(DEG30),
    );
    check(
        &[
            ("acc_x_mps2", "0"),
            ("acc_y_mps2", "0"),
            ("acc_z_mps2", "M"),
            ("gyr_x_radps", "0"),
            ("gyr_y_radps", "0"),
            ("gyr_z_radps", "0"),
            ("time", "s"),
        ],
        orders,
        9.8,
        None,
    );
    check(
        &[
            ("time", "s"),
            ("omega_x (rad/s)", "0"),
            ("omega_y (rad/s)", "0"),
            ("omega_z (rad/s)", "0"),
            ("f_x (m/s^2)", "0"),
            ("f_y (m/s^2)", "0"),
            ("f_z (m/s^2)", "M"),
        ],
        gyro_first,
        9.8,
        None,
    );
    check(
        &[
            ("Elapsed Time (s)", "s"),
            ("X-Axis Acceleration", "0"),
            ("Y-Axis Acceleration", "0"),
            ("Z-Axis Acceleration", "G"),
            ("X-Axis Angular Rate", "0"),
            ("Y-Axis Angular Rate", "0"),
            ("Z-Axis Angular Rate", "0"),
        ],
        plus(1),
        9.7,
        None,
    );
    check(
        &[
            ("attitude_roll(radians)", "0"),
            ("rotation_rate_x(radians/s)", "0"),
            ("rotation_rate_y(radians/s)", "0"),
            ("rotation_rate_z(radians/s)", "0"),
            ("accelerometer_x(G)", "0"),
            ("accelerometer_y(G)", "0"),
            ("accelerometer_z(G)", "G"),
            ("user_acc_x(G)", "0"),
            ("user_acc_y(G)", "0"),
            ("user_acc_z(G)", "0"),
            ("time", "s"),
        ],
        gyro_first,
        9.7,
        None,
    );
}

#[test]
fn gravity_and_the_rest_add_up() {
    let cells = [
        ("time", "s"),
        ("userAccelerationX", "0"),
        ("userAccelerationY", "0"),
        ("userAccelerationZ", "0"),
        ("gravityX", "0"),
        ("gravityY", "0"),
        ("gravityZ", "G"),
        ("rotationRateX", "0"),
        ("rotationRateY", "0"),
        ("rotationRateZ", "0"),
    ];
    let text = table(&cells, 300);
    let recording =
        open(&[Input { name: "watch.csv", bytes: text.as_bytes() }], &Options::default()).unwrap();
    assert!(recording.assumptions.iter().any(|a| a.code == "gravity-added"));
    assert!((recording.findings.rest_norm - 9.72).abs() < 0.1);
    // Without the gravity columns it is refused.
    let without: Vec<(&str, &str)> = cells.iter().copied().filter(|c| !c.0.starts_with("gravity")).collect();
    let text = table(&without, 300);
    let error =
        open(&[Input { name: "watch.csv", bytes: text.as_bytes() }], &Options::default()).unwrap_err();
    assert!(matches!(error.problem, Problem::GravityRemoved { .. }), "{error}");
}

#[test]
fn several_sensors_are_asked_about() {
    let cells = [
        ("time", "s"),
        ("LeftFoot_AccX", "0"),
        ("LeftFoot_AccY", "0"),
        ("LeftFoot_AccZ", "M"),
        ("LeftFoot_GyroX", "0"),
        ("LeftFoot_GyroY", "0"),
        ("LeftFoot_GyroZ", "0"),
        ("Pelvis_AccX", "0"),
        ("Pelvis_AccY", "0"),
        ("Pelvis_AccZ", "M"),
        ("Pelvis_GyroX", "0"),
        ("Pelvis_GyroY", "0"),
        ("Pelvis_GyroZ", "0"),
    ];
    let text = table(&cells, 100);
    let input = [Input { name: "body.csv", bytes: text.as_bytes() }];
    let error = open(&input, &Options::default()).unwrap_err();
    let Problem::ManySensors { names } = &error.problem else { panic!("{error}") };
    assert_eq!(names, &["left foot", "pelvis"]);
    let options = Options { sensor: Some("Pelvis".into()), ..Options::default() };
    let recording = open(&input, &options).unwrap();
    assert_eq!((recording.sensor.as_str(), recording.channels[7].role.as_str()), ("pelvis", "acc_x"));
    let options = Options { sensor: Some("LeftFoot".into()), ..Options::default() };
    assert_eq!(open(&input, &options).unwrap().channels[1].role, "acc_x");

    // Shimmer's two accelerometers.
    let cells = [
        ("Shimmer_6AX3_Timestamp_Unix_CAL", "epoch_ms"),
        ("Shimmer_6AX3_Accel_LN_X_CAL", "0"),
        ("Shimmer_6AX3_Accel_LN_Y_CAL", "0"),
        ("Shimmer_6AX3_Accel_LN_Z_CAL", "M"),
        ("Shimmer_6AX3_Accel_WR_X_CAL", "0"),
        ("Shimmer_6AX3_Accel_WR_Y_CAL", "0"),
        ("Shimmer_6AX3_Accel_WR_Z_CAL", "M"),
        ("Shimmer_6AX3_Gyro_X_CAL", "0"),
        ("Shimmer_6AX3_Gyro_Y_CAL", "0"),
        ("Shimmer_6AX3_Gyro_Z_CAL", "0"),
        ("Shimmer_6AX3_Gyro_X_RAW", "n"),
        ("Shimmer_6AX3_Gyro_Y_RAW", "n"),
        ("Shimmer_6AX3_Gyro_Z_RAW", "n"),
    ];
    let text = table(&cells, 100);
    let input = [Input { name: "s.csv", bytes: text.as_bytes() }];
    let error = open(&input, &Options::default()).unwrap_err();
    let Problem::ManySensors { names } = &error.problem else { panic!("{error}") };
    assert_eq!(names, &["ln", "wr"]);
    let recording = open(&input, &Options { sensor: Some("wr".into()), ..Options::default() }).unwrap();
    assert_eq!(recording.channels[4].role, "acc_x");
    assert_eq!(recording.channels[7].role, "gyr_x");
}

#[test]
fn columns_are_listed_even_where_nothing_fits() {
    let text = table(&[("price", "0"), ("size", "0"), ("n", "n")], 20);
    let seen = inspect(&[Input { name: "x.csv", bytes: text.as_bytes() }], &Options::default()).unwrap();
    assert_eq!(seen.channels.len(), 3);
    assert!(seen.recording.is_none() && seen.refusal.is_some());
}

#[test]
fn japanese_axes_before_the_quantity_and_full_width_letters() {
    for (x, sensor, time) in [
        ("X軸", "加速度", "計測時間"),
        ("Ｘ軸", "加速度", "サンプリング時間"),
        ("X", "加速度センサー", "時刻"),
    ] {
        let axis = |of: &str, to: char| of.replace(['X', 'Ｘ'], &to.to_string());
        let rate = if sensor == "加速度" { "角速度" } else { "ジャイロセンサー" };
        let names: Vec<String> = ['x', 'Y', 'Ｚ']
            .into_iter()
            .map(|to| axis(x, to) + sensor)
            .chain(['x', 'Y', 'Ｚ'].into_iter().map(|to| format!("{rate}（{}）", axis(x, to))))
            .collect();
        let cells: Vec<(&str, &str)> = std::iter::once((time, "s"))
            .chain(names.iter().map(String::as_str).zip(["0", "0", "M", "0", "0", "0"]))
            .collect();
        check(&cells, [2, 3, 4, 5, 6, 7], 9.8, None);
    }
}

#[test]
fn a_remark_between_header_and_rows_hides_no_name() {
    let cells = [
        ("t_ms", "ms"),
        ("gx_deg_s", "w"),
        ("gy_deg_s", "0"),
        ("gz_deg_s", "0"),
        ("ax_g", "0"),
        ("ay_g", "0"),
        ("az_g", "G"),
    ];
    let plain = table(&cells, 300);
    let read =
        |text: &str| open(&[Input { name: "a.csv", bytes: text.as_bytes() }], &Options::default()).unwrap();
    let expected = read(&plain);
    for remark in ["# sensor 7, left thigh", "% started late", "// no filter"] {
        let found = read(&plain.replacen('\n', &format!("\n{remark}\n"), 1));
        assert_eq!(found.gyro_rad_s, expected.gyro_rad_s, "{remark}");
        assert_eq!(found.acc_m_s2, expected.acc_m_s2, "{remark}");
        assert_eq!(found.time_s, expected.time_s, "{remark}");
    }
}

#[test]
fn japanese_dates_in_either_encoding() {
    let cells =
        [("時刻", "和"), ("ax", "0"), ("ay", "0"), ("az", "M"), ("gx", "0"), ("gy", "0"), ("gz", "0")];
    let plain = table(&cells, 300);
    let mut parts = plain.split('和');
    let mut dated = parts.next().unwrap().to_owned();
    for (row, part) in parts.enumerate() {
        dated += &format!("2026年11月29日 9時59分{:05.2}秒{part}", row as f64 * 0.01);
    }
    let shift_jis = encoding_rs::SHIFT_JIS.encode(&dated).0.into_owned();
    for bytes in [dated.as_bytes(), &shift_jis] {
        let recording = open(&[Input { name: "記録.csv", bytes }], &Options::default()).unwrap();
        assert_eq!(recording.len(), 300);
        assert!((recording.time_s[299] - 2.99).abs() < 1e-9);
        // `date -u -d "2026-11-29 09:59:00" +%s`
        assert_eq!(recording.start_unix_s, Some(1_795_946_340.0));
    }
}
