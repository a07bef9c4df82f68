//! Files whose numbers can be taken for something else: they are read as they are meant, or it is said.

use shisei_record::{Input, Options, Problem, Recording, Scale, open};

/// Samples of a sensor that lies level, with a time for each.
fn table(header: &str, rows: usize, time: impl Fn(usize) -> String) -> String {
    let mut text = format!("{header}\n");
    for k in 0..rows {
        let wave = (k % 7) as f64 * 0.01;
        text += &format!(
            "{},{:.3},{:.3},{:.3},{:.4},{:.4},{:.4}\n",
            time(k),
            wave,
            -wave,
            9.8 + wave,
            wave,
            0.0,
            -wave
        );
    }
    text
}

const HEADER: &str = "time,ax (m/s^2),ay (m/s^2),az (m/s^2),gx (rad/s),gy (rad/s),gz (rad/s)";

fn read_with(text: &str, options: &Options) -> shisei_record::Result<Recording> {
    open(&[Input { name: "a.csv", bytes: text.as_bytes() }], options)
}

fn read(text: &str) -> Recording {
    read_with(text, &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn problem(text: &str) -> Problem {
    read_with(text, &Options::default()).expect_err("a refusal").problem
}

fn warned(recording: &Recording, code: &str) -> bool {
    recording.warnings.iter().any(|note| note.code == code)
}

fn assert_rate(recording: &Recording, rate_hz: f64, duration_s: f64) {
    let found = &recording.findings;
    assert!((found.rate_hz - rate_hz).abs() < 1e-3 * rate_hz, "{} Hz", found.rate_hz);
    assert!((found.duration_s - duration_s).abs() < 1e-3 * duration_s, "{} s", found.duration_s);
}

#[test]
fn dates_without_seconds_are_hours_and_minutes() {
    // As Excel saves a date again: 100 Hz, three minutes.
    let time = |k: usize| format!("2024/5/1 10:{}", 31 + k / 6000);
    assert_rate(&read(&table(HEADER, 18_000, time)), 100.0, 180.0);
}

#[test]
fn dates_of_digits_alone() {
    let time = |k: usize| format!("20240501103{}{:02}{:03}", k / 6000, k / 100 % 60, k % 100 * 10);
    let recording = read(&table(HEADER, 7000, time));
    assert_rate(&recording, 100.0, 69.99);
    assert_eq!(recording.findings.gap_count, 0);
}

#[test]
fn whole_microseconds_without_a_unit() {
    let recording = read(&table(HEADER, 5000, |k| (k * 1000 - k % 3).to_string()));
    assert_rate(&recording, 1000.0, 4.999);
    assert!(warned(&recording, "unit-time-doubtful"));
    let slow = read(&table(HEADER, 500, |k| (k * 100).to_string()));
    assert_rate(&slow, 10.0, 49.9);
    assert!(warned(&slow, "unit-time-doubtful"));
    assert!(!warned(&read(&table(HEADER, 500, |k| (k * 10).to_string())), "unit-time-doubtful"));
    // Counted from 1970 there is no doubt.
    let since_1970 = |k: usize| (1_700_000_000_000 + k * 200).to_string();
    let recording = read(&table(HEADER, 500, since_1970));
    assert_rate(&recording, 5.0, 99.8);
    assert!(!warned(&recording, "unit-time-doubtful"));
}

#[test]
fn seconds_and_nanoseconds_are_one_number_in_pauses_too() {
    let header = "secs,nsecs,linear_acceleration.x,linear_acceleration.y,linear_acceleration.z,angular_velocity.x,\
                  angular_velocity.y,angular_velocity.z";
    let time = |k: usize| {
        let ms = 1_700_000_000_000_u64 + k as u64 * 10 + if k >= 1000 { 1100 } else { 0 };
        format!("{},{}", ms / 1000, ms % 1000 * 1_000_000)
    };
    let recording = read(&table(header, 2000, time));
    assert_rate(&recording, 100.0, 21.09);
    assert!((recording.findings.gap_total_s - 1.1).abs() < 1e-6);
}

#[test]
fn a_count_since_1970_beside_its_milliseconds() {
    let header = "timestamp,milliseconds,ax (m/s^2),ay (m/s^2),az (m/s^2),gx (rad/s),gy (rad/s),gz (rad/s)";
    let ms = |k: usize| 1_700_000_000_010_u64 + k as u64 * 10;
    assert_rate(&read(&table(header, 2000, |k| format!("{},{}", ms(k), ms(k) % 1000))), 100.0, 19.99);
    assert_rate(&read(&table(header, 2000, |k| format!("{},{}", ms(k) / 1000, ms(k) % 1000))), 100.0, 19.99);
}

#[test]
fn row_names_without_a_heading() {
    let recording = read(&table(HEADER, 500, |k| format!("{},{:.2}", k + 1, k as f64 * 0.02)));
    assert_rate(&recording, 50.0, 9.98);
    assert!((recording.acc_m_s2[0][2] - 9.8).abs() < 1e-9);
}

#[test]
fn letters_that_end_like_a_blank() {
    let text = table(&format!("追加,{HEADER}"), 500, |k| format!("7,{:.2}", k as f64 * 0.02));
    let options = Options { keep: vec!["追加".into()], ..Options::default() };
    assert_eq!(read_with(&text, &options).unwrap().extra[0].name, "追加");
    // And blanks that do not break about a number.
    assert_rate(&read(&table(HEADER, 500, |k| format!("\u{a0}{:.2}\u{a0}", k as f64 * 0.02))), 50.0, 9.98);
}

#[test]
fn signs_between_thousands() {
    let header = "time (s),ax (mg),ay (mg),az (mg),gx (mdps),gy (mdps),gz (mdps)";
    let rows: String = (0..300)
        .map(|k| format!("{:.2},\"1,{:03}\",24,-61,\"-96,964\",\"-2,499\",10\n", f64::from(k) * 0.02, k))
        .collect();
    let text = format!("{header}\n{rows}");
    assert!(matches!(problem(&text), Problem::Grouped { text } if text == "1,000"));
    assert!(matches!(
        problem(&text.replace(',', "\t").replace("1\t", "1,").replace('"', "")),
        Problem::Grouped { .. }
    ));
    // Decimal commas, also where three digits follow every one.
    let rows: String = (0..300)
        .map(|k| format!("{},{:03};0,012;0,024;9,806;0,100;0,200;1,{:03}\n", k / 50, k % 50 * 20, k))
        .collect();
    assert_rate(&read(&format!("{}\n{rows}", HEADER.replace(',', ";"))), 50.0, 5.98);
}

#[test]
fn rows_that_are_not_in_the_order_of_time() {
    let shuffled = |k: usize| format!("{:.2}", (k * 997 % 1000) as f64 * 0.01);
    assert!(matches!(problem(&table(HEADER, 1000, shuffled)), Problem::Unsorted { rows: 1000, .. }));
    // Packets that overtake each other are mended, and it is said.
    let pairs = |k: usize| format!("{:.2}", (k ^ 1) as f64 * 0.01);
    let recording = read(&table(HEADER, 1000, pairs));
    assert!(recording.findings.backward_stamps == 500 && recording.dt_s.iter().all(|dt| *dt > 0.0));
    let backwards = |k: usize| format!("{:.2}", (1000 - k) as f64 * 0.01);
    assert!(matches!(problem(&table(HEADER, 1000, backwards)), Problem::Unsorted { .. }));
}

#[test]
fn a_spreadsheets_dates_begin_at_zero() {
    let recording =
        read(&table(HEADER, 500, |k| format!("{:.10}", 45_352.999_9 + k as f64 * 0.02 / 86_400.0)));
    assert_rate(&recording, 50.0, 9.98);
    assert_eq!(recording.time_s[0], 0.0);
    // 8.64 s before the end of 2024-03-01.
    assert!((recording.start_unix_s.unwrap() - (1_709_337_600.0 - 8.64)).abs() < 1e-3);
}

#[test]
fn units_that_are_not_known() {
    let text = table(&HEADER.replace("time", "time (ticks)"), 500, |k| (k * 328).to_string());
    assert!(warned(&read(&text), "unit-unknown"));
    let text = table(&HEADER.replace("rad/s", "turns/h"), 500, |k| format!("{:.2}", k as f64 * 0.02));
    assert!(warned(&read(&text), "unit-unknown"));
    let text = table(&HEADER.replace("rad/s", "deg/min"), 500, |k| format!("{:.2}", k as f64 * 0.02));
    assert!((read(&text).gyro_rad_s[1][0] - 0.01 / 60.0 * std::f64::consts::PI / 180.0).abs() < 1e-15);
}

#[test]
fn a_scale_beside_a_unit_is_not_used_and_it_is_said() {
    let text = table(HEADER, 500, |k| format!("{:.2}", k as f64 * 0.02));
    let scale = Scale { acc_counts_per_g: Some(16_384.0), gyro_counts_per_deg_s: Some(131.0) };
    let recording = read_with(&text, &Options { scale: Some(scale), ..Options::default() }).unwrap();
    assert_eq!(recording.warnings.iter().filter(|note| note.code == "scale-unused").count(), 2);
    assert!(recording.assumptions.iter().all(|note| note.code != "scaled"));
    assert!((recording.acc_m_s2[0][2] - 9.8).abs() < 1e-9);
}

#[test]
fn two_files_keep_what_stands_beside() {
    let acc: String = (0..500).map(|k| format!("{:.2},0,0,9.8,note {k}\n", f64::from(k) * 0.02)).collect();
    let gyro = |shift: f64| -> String {
        (0..500).map(|k| format!("{:.3},0.1,0,0\n", f64::from(k) * 0.02 + shift)).collect()
    };
    let read = |shift: f64| {
        let acc = format!("time (s),acc x (m/s^2),acc y (m/s^2),acc z (m/s^2),note\n{acc}");
        let gyro = format!("time (s),gyro x (rad/s),gyro y (rad/s),gyro z (rad/s)\n{}", gyro(shift));
        let inputs = [
            Input { name: "acc.csv", bytes: acc.as_bytes() },
            Input { name: "gyro.csv", bytes: gyro.as_bytes() },
        ];
        open(&inputs, &Options { keep: vec!["*".into()], ..Options::default() }).unwrap()
    };
    let same = read(0.0);
    let note = same.extra.iter().find(|extra| extra.name == "note").unwrap();
    assert_eq!(&*note.cells[7], "note 7");
    assert!(warned(&read(0.005), "merged-columns"));
}

#[test]
fn a_counter_before_the_time_without_a_header() {
    let text = table("", 500, |k| format!("{},{:.2}", k + 1, k as f64 * 0.02));
    assert_rate(&read(text.trim_start()), 50.0, 9.98);
    let text = table("", 500, |k| format!("{:.2},{}", k as f64 * 0.02, k + 1));
    assert_rate(&read(text.trim_start()), 50.0, 9.98);
}

#[test]
fn samples_too_far_apart_to_be_integrated() {
    assert!(warned(
        &read(&table(&HEADER.replace("time", "time (s)"), 500, |k| k.to_string())),
        "rate-too-low"
    ));
    assert!(!warned(&read(&table(HEADER, 500, |k| format!("{:.1}", k as f64 * 0.2))), "rate-too-low"));
}
