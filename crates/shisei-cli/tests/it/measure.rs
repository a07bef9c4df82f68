//! `shisei earth`, `allan`, `motion` and the further methods of `calibrate`.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::Value;

use crate::run::{Desk, example};

/// A real recording beside the repository; none, said aloud, where it is absent.
fn recording(path: &str) -> Option<String> {
    let root = std::env::var_os("SHISEI_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let file = root.join(path);
    if file.is_file() {
        Some(file.display().to_string())
    } else {
        eprintln!("skipped: {path} is not in {}", root.display());
        None
    }
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn the_articles_table_gives_the_articles_number_and_a_warning() {
    let desk = Desk::new();
    let ran = desk.run(&["earth", &example("eight-directions.csv"), "--json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found = json(&ran.stdout);
    // SPEC: 7.657707e-5 rad/s printed, 22.8 h
    assert!((found["article_sphere_rad_s"].as_f64().unwrap() - 7.657707e-5).abs() <= 5e-11);
    assert_eq!(format!("{:.1}", found["article_sphere_day_h"].as_f64().unwrap()), "22.8");
    assert_eq!(found["flat"], true);
    assert_eq!(found["believed"], "circle");
    assert!(found["sidereal_day_h"].is_null());
    assert!(ran.stderr.contains("nearly in one plane"), "{}", ran.stderr);
    assert!(ran.stderr.contains("22.8 h"));
    let page = desk.text("earth.html");
    assert!(page.contains("<svg") && page.contains("nearly in one plane") && !page.contains("NaN"));

    let ran = desk.run(&[
        "earth",
        &example("eight-directions.csv"),
        "--latitude",
        "35.7",
        "--json",
        "--lang",
        "ja",
    ]);
    let found = json(&ran.stdout);
    assert_eq!(found["believed"], "circle-with-latitude");
    assert!(found["sidereal_day_h"]["value"].as_f64().unwrap() > 20.0);
    assert!(ran.stderr.contains("一平面"), "{}", ran.stderr);
}

#[test]
fn sonys_headings_from_their_names() {
    let files: Option<Vec<String>> = ["000", "090", "180", "270"]
        .iter()
        .map(|d| recording(&format!("earthrate_spresense/log_imu_{d}deg.txt")))
        .collect();
    let Some(files) = files else { return };
    let desk = Desk::new();
    let mut args = vec!["earth", "--json"];
    args.extend(files.iter().map(String::as_str));
    let ran = desk.run(&args);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found = json(&ran.stdout);
    let unit = 180.0 / std::f64::consts::PI * 3600.0;
    let (r, s) = (
        found["circle_rad_s"]["value"].as_f64().unwrap() * unit,
        found["circle_rad_s"]["sigma"].as_f64().unwrap() * unit,
    );
    assert!((r - 11.4).abs() <= 2.0 * s && s <= 1.2, "{r} {s}");
    assert!(found["by_headings"]["opposite_sense_cost_ratio"].as_f64().unwrap() > 20.0);
    // the article's weights let the samples after gaps count too much
    args.extend(["--weights", "article"]);
    let article = json(&desk.run(&args).stdout);
    assert!((article["circle_rad_s"]["value"].as_f64().unwrap() * unit - 12.29).abs() < 0.05);
}

#[test]
fn earth_refuses_what_determines_nothing() {
    let desk = Desk::new();
    desk.put("one.csv", "gyr_x,gyr_y,gyr_z\n1e-5,2e-5,3e-5\n");
    let ran = desk.run(&["earth", "one.csv"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("three or more different headings"), "{}", ran.stderr);
    desk.put("same.csv", format!("gyr_x,gyr_y,gyr_z\n{}", "1e-5,2e-5,3e-5\n".repeat(8)));
    assert_eq!(desk.run(&["earth", "same.csv"]).code, 1);
    desk.put("bad.csv", "gyr_x,gyr_y,gyr_z\n1e-5,x,3e-5\n1e-5,2e-5,3e-5\n1e-5,2e-5,4e-5\n");
    let ran = desk.run(&["earth", "bad.csv"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("row 1"), "{}", ran.stderr);
    desk.put("garbage.txt", "zz,41d8,nothex\n\u{0}\u{1}\n");
    assert_eq!(desk.run(&["earth", "garbage.txt"]).code, 2);
    // a counter that goes back
    let mut text = String::new();
    for k in 0..400_u32 {
        let ticks = if k < 200 { 4_000_000_000 + k * 10_000 } else { 1_000_000_000 + k * 10_000 };
        writeln!(text, "{ticks:08x},41d84d00,b9685f6a,39738705,b8c2bdea,3e823bd9,bc5bae10,411c758a").unwrap();
    }
    desk.put("back.txt", &text);
    let ran = desk.run(&["earth", "back.txt", "back.txt", "back.txt"]);
    assert_ne!(ran.code, 0);
    assert!(ran.stderr.contains("back.txt"), "{}", ran.stderr);
    assert_eq!(desk.names().iter().filter(|n| n.contains(".html")).count(), 0);
}

#[test]
fn a_direction_in_which_the_sensor_moves_is_named() {
    let desk = Desk::new();
    for name in ["a.csv", "b.csv"] {
        desk.put(name, still(2_000));
    }
    let pelvis = example("pelvis.csv");
    for (lang, words) in [("en", "the sensor moves"), ("ja", "センサが動いています")] {
        let ran = desk.run(&["earth", "a.csv", &pelvis, "b.csv", "--lang", lang]);
        assert_eq!(ran.code, 1, "{}", ran.stderr);
        assert!(ran.stderr.contains("pelvis.csv") && ran.stderr.contains(words), "{}", ran.stderr);
        assert!(!ran.stderr.contains("°/h"), "{}", ran.stderr);
    }
    let ran = desk.run(&["earth", "a.csv", "b.csv", "a.csv", "--lang", "en"]);
    assert!(!ran.stderr.contains("the sensor moves"), "{}", ran.stderr);
}

#[test]
fn the_noise_of_counts_is_in_counts() {
    let desk = Desk::new();
    let mut text = String::from("time_s,ax,ay,az,gx,gy,gz\n");
    for k in 0..2_000_i64 {
        let n = (k * 16_807) % 2_147 % 40;
        writeln!(text, "{:.2},{n},{},{},{},{n},{}", k as f64 / 100.0, 7 - n, 16_384 + n, 3 * n, -n).unwrap();
    }
    desk.put("counts.csv", text);
    for (lang, words) in [("en", "are raw counts of the sensor"), ("ja", "生カウント")] {
        let ran = desk.run(&["allan", "counts.csv", "--report", "c.html", "--lang", lang]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
        assert!(ran.stderr.contains("counts/√s") && !ran.stderr.contains("SI/√s"), "{}", ran.stderr);
        assert!(desk.text("c.html").contains("counts/√s") && desk.text("c.html").contains(words));
    }
}

/// Noise of known density: 2^15 samples at 100 Hz, from a multiplicative generator.
fn still(rows: usize) -> String {
    let mut n: u64 = 1_234_567_890;
    let mut next = || {
        n = n * 16_807 % 2_147_483_647;
        n as f64 / 2_147_483_647.0 - 0.5
    };
    let mut text = String::from("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n");
    for k in 0..rows {
        let v: Vec<f64> = (0..6).map(|_| next()).collect();
        writeln!(
            text,
            "{:.2},{},{},{},{},{},{}",
            k as f64 / 100.0,
            0.1 * v[0],
            0.1 * v[1],
            9.80665 + 0.1 * v[2],
            0.01 * v[3],
            0.01 * v[4],
            0.01 * v[5]
        )
        .unwrap();
    }
    text
}

#[test]
fn allan_finds_the_noise() {
    let desk = Desk::new();
    desk.put("still.csv", still(20_000));
    let ran = desk.run(&["allan", "still.csv", "--json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    // uniform in ± 0.005 rad/s at 100 Hz: N = 0.01/√12 · √0.01
    let n = json(&ran.stdout)["axes"]["gyr_x"]["random_walk"]["value"].as_f64().unwrap();
    assert!((n / (0.001 / 12f64.sqrt()) - 1.0).abs() < 0.05, "{n}");
    assert!(desk.text("still.allan.csv").starts_with("axis,tau_s,deviation"));
    assert!(desk.text("still.allan.html").contains("<svg"));
    // a short one says so
    desk.put("short.csv", still(20));
    assert_eq!(desk.run(&["allan", "short.csv"]).code, 1);
}

#[test]
fn motion_has_its_columns_and_refuses_without_rest() {
    let desk = Desk::new();
    // 1 s rest, 1 s back and forth along x, 1 s rest
    let mut text = String::from("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n");
    for k in 0..400 {
        let t = f64::from(k) / 100.0;
        let a = if (1.0..2.0).contains(&t) {
            shisei_core::math::sin(std::f64::consts::TAU * (t - 1.0))
        } else {
            0.0
        };
        let n = 1e-3 * f64::from((k * 37) % 11 - 5);
        writeln!(text, "{t:.2},{},{n},{},{n},0.01,{n}", a + n, 9.80665 - n).unwrap();
    }
    desk.put("move.csv", &text);
    let ran = desk.run(&["motion", "move.csv", "--json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let end = json(&ran.stdout);
    // ∬ sin(2πt) over one period: 1/2π m
    let x = end["end_m"][0].as_f64().unwrap();
    assert!((x - 1.0 / std::f64::consts::TAU).abs() < 0.005, "{x}");
    assert!(end["sigma_end_m"].as_f64().unwrap() < 0.02);
    let table = desk.text("move.motion.csv");
    assert!(table.starts_with("time_s,vel_x,vel_y,vel_z,pos_x,pos_y,pos_z,sigma_pos_m\n"));
    assert_eq!(table.lines().count(), 401);
    for more in [&["naive", "--scheme", "trapezoid"][..], &["naive"], &["foot"]] {
        let ran = desk.run(&[&["motion", "move.csv", "--no-report", "--mode"], more].concat());
        assert_eq!(ran.code, 0, "{more:?}: {}", ran.stderr);
    }
    let ran = desk.run(&["motion", "move.csv", "--end", "1,2"]);
    assert_eq!(ran.code, 2);
    // never at rest
    let shaken: String = text
        .lines()
        .enumerate()
        .map(|(k, l)| {
            if k == 0 {
                format!("{l}\n")
            } else {
                format!("{},{},1,{},3,{},2\n", l.split(',').next().unwrap(), 9 * (k % 3), 5 * (k % 4), k % 5)
            }
        })
        .collect();
    desk.put("shaken.csv", shaken);
    let ran = desk.run(&["motion", "shaken.csv", "-o", "no.csv"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(!desk.names().contains(&"no.csv".to_owned()));
}

#[test]
fn many_poses_and_known_turns() {
    let Some(imu0) = recording("calib_mikoff_mpu9150/imu0.log") else { return };
    let desk = Desk::new();
    let ran = desk.run(&[
        "calibrate",
        "--method",
        "gyro-turns",
        &imu0,
        "--rate",
        "100",
        "--columns",
        "acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z",
        "--units",
        "acc=m/s2,gyr=rad/s",
        "-o",
        "cal.json",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found = json(&desk.text("cal.json"));
    for (i, published) in [0.1026, 0.0971, 0.3439].into_iter().enumerate() {
        let b = found["accelerometer"]["bias_m_s2"][i].as_f64().unwrap();
        assert!((b - published).abs() < 0.002, "{i}: {b}");
    }
    assert!(found["checks"]["held_out_rms_m_s2"].as_f64().unwrap() <= 0.005);
    assert_eq!(found["covariance"]["order"].as_array().unwrap().len(), 9);
    assert!(desk.text("imu0.calibration.html").contains("<svg"));

    let Some(annotated) = recording("calib_imucal_ferraris/annotated_session.csv") else { return };
    let ran = desk.run(&[
        "calibrate",
        "--method",
        "gyro-turns",
        "--turns",
        "360",
        "--gravity",
        "9.81",
        "--rate",
        "204.8",
        &annotated,
        "-o",
        "turns.json",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found = json(&desk.text("turns.json"));
    // the reference's bias, raw counts
    for (i, reference) in
        [-6.018868019671572, -48.287874016760156, -28.96636637224333].into_iter().enumerate()
    {
        let b = found["accelerometer"]["bias_m_s2"][i].as_f64().unwrap();
        assert!((b / reference - 1.0).abs() < 1e-3, "{i}: {b}");
    }
}

/// The sketch, run on this machine, behind a pseudo-terminal.
#[cfg(unix)]
#[test]
fn earth_over_a_serial_port() {
    use std::io::{Read, Write};
    use std::process::{Command, Stdio};
    use std::sync::atomic::{AtomicBool, Ordering};

    let desk = Desk::new();
    let sketch = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../apps/spresense/test");
    let program = desk.file("board");
    let built = Command::new("g++")
        .args(["-std=c++14", "-O1", "-I"])
        .arg(sketch.join("stubs"))
        .arg(sketch.join("host_test.cpp"))
        .arg("-o")
        .arg(&program)
        .status();
    if !built.is_ok_and(|s| s.success()) {
        eprintln!("skipped: g++ is not here, or cannot build the sketch");
        return;
    }
    let (master, slave) = serialport::TTYPort::pair().expect("a pseudo-terminal");
    let port = serialport::SerialPort::name(&slave).expect("its name");
    // the command wants the port for itself; until it opens it, reading the other end fails
    drop(slave);
    let mut board = Command::new(&program)
        .arg("serve")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the sketch");
    let (mut to_board, mut from_board) = (board.stdin.take().unwrap(), board.stdout.take().unwrap());
    let over = AtomicBool::new(false);
    let mut back = serialport::SerialPort::try_clone(&master).expect("two ends");
    // the command may be kept from reading for longer than the usual tenth of a second
    serialport::SerialPort::set_timeout(&mut *back, std::time::Duration::from_secs(30)).expect("patience");
    let mut forth = master;
    let ran = std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut bytes = [0; 4096];
            while let Ok(n) = from_board.read(&mut bytes) {
                if n == 0 {
                    break;
                }
                // while nobody has the port open, what the board says is lost
                let _ = back.write_all(&bytes[..n]);
            }
        });
        scope.spawn(|| {
            let mut bytes = [0; 256];
            while !over.load(Ordering::Relaxed) {
                match forth.read(&mut bytes) {
                    Ok(n) => {
                        if to_board.write_all(&bytes[..n]).and_then(|()| to_board.flush()).is_err() {
                            break;
                        }
                    }
                    Err(_) => std::thread::sleep(std::time::Duration::from_millis(5)),
                }
            }
            drop(to_board); // the sketch ends with its input
        });
        let ran = desk.pipe(
            &["earth", "--serial", &port, "--directions", "8", "--seconds", "4", "--json"],
            b"\n\n\n\n\n\n\n\n",
            1,
        );
        over.store(true, Ordering::Relaxed);
        ran
    });
    board.wait().expect("the sketch's end");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found = json(&ran.stdout);
    // the fake board stands at 35.7° north on the turning Earth, upright and upside down
    assert_eq!(found["believed"], "levelled");
    assert!((found["sidereal_day_h"]["value"].as_f64().unwrap() - 23.934).abs() < 1.0, "{}", ran.stdout);
    assert!((found["latitude_deg"]["value"].as_f64().unwrap() - 35.7).abs() < 2.0, "{}", ran.stdout);
    // the directions were kept as a table that gives the same result
    let again = desk.run(&["earth", "directions.csv", "--json"]);
    assert_eq!(again.code, 0, "{}", again.stderr);
    assert_eq!(json(&again.stdout)["sidereal_day_h"], found["sidereal_day_h"]);

    let ran = desk.run(&["earth", "--serial", "/dev/no-such-port"]);
    assert_eq!(ran.code, 2);
}
