//! MU-01 files as the sensor and a spreadsheet write them, in every encoding.

use shisei_record::{Input, Options, Recording, open};

fn read(bytes: &[u8]) -> Recording {
    open(&[Input { name: "pelvis.csv", bytes }], &Options::default()).unwrap()
}

fn body(separator: char, decimal: char) -> String {
    let mut out = String::new();
    for i in 0..1000 {
        let stamp = ((27.83 + f64::from(i) * 0.01) * 10.0).floor() / 10.0;
        let row = format!(
            "31:{stamp:04.1};9.744401;0.081403;-0.780510;-0.00745;{};0.022338;4095",
            0.001 * f64::from(i % 7)
        );
        out.push_str(&row.replace('.', &decimal.to_string()).replace(';', &separator.to_string()));
        out.push_str("\r\n");
    }
    out
}

fn header(square: &str, separator: char) -> String {
    format!("Time,Ax[m/s{square}],Ay[m/s{square}],Az[m/s{square}],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp\r\n")
        .replace(',', &separator.to_string())
}

fn check(bytes: &[u8]) {
    let recording = read(bytes);
    assert_eq!(recording.dialect, "mu-01");
    assert_eq!(recording.len(), 1000);
    assert_eq!(recording.findings.rate_hz, 100.0);
    assert_eq!(recording.time_s[999], 9.99);
    assert_eq!(recording.acc_m_s2[0], [9.744401, 0.081403, -0.78051]);
    assert_eq!(recording.gyro_rad_s[6], [-0.00745, 0.001 * 6.0, 0.022338]);
    assert!(recording.temp_c.is_none());
    let codes: Vec<&str> = recording.assumptions.iter().map(|a| a.code).collect();
    assert!(codes.contains(&"rate-confirmed") && codes.contains(&"temp-none"), "{codes:?}");
}

#[test]
fn every_encoding_and_separator() {
    for square in ["2", "²", "^2"] {
        let text = header(square, ',') + &body(',', '.');
        check(text.as_bytes());
        check(format!("\u{feff}{text}").as_bytes());
        let utf16: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
        check(&utf16);
    }
    for separator in [';', '\t'] {
        check((header("2", separator) + &body(separator, '.')).as_bytes());
        check((header("2", separator) + &body(separator, ',')).as_bytes());
    }
    // Latin-1 and what a Shift_JIS editor leaves of the superscript.
    let latin: Vec<u8> = header("²", ',').chars().map(|c| c as u8).chain(body(',', '.').bytes()).collect();
    check(&latin);
    let asked = header("?", ',') + &body(',', '.');
    check(asked.as_bytes());
}

#[test]
fn japanese_header_in_shift_jis() {
    let text =
        "時刻[s],加速度X[m/s2],加速度Y[m/s2],加速度Z[m/s2],角速度X[dps],角速度Y[dps],角速度Z[dps],温度\r\n";
    let (bytes, _, _) = encoding_rs::SHIFT_JIS.encode(text);
    let mut bytes = bytes.into_owned();
    for i in 0..200 {
        bytes.extend(format!("{},0.1,0.2,9.8,180,0,-90,25.5\r\n", f64::from(i) / 100.0).bytes());
    }
    let recording = read(&bytes);
    assert_eq!(recording.len(), 200);
    assert!((recording.gyro_rad_s[0][0] - core::f64::consts::PI).abs() < 1e-15);
    assert_eq!(recording.temp_c.as_ref().unwrap()[3], 25.5);
    assert_eq!(recording.channels[1].name, "加速度X[m/s2]");
}
