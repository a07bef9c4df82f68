//! The same values whatever the layout: order of columns, separator, decimal sign, line ends, byte-order
//! mark, units rows, trailing separators, preambles.
#![allow(clippy::struct_excessive_bools)] // each is one switch of the layout

use proptest::prelude::*;
use shisei_record::{Input, Options, open};

#[derive(Clone, Debug)]
struct Layout {
    order: Vec<usize>,
    separator: char,
    decimal_comma: bool,
    crlf: bool,
    bom: bool,
    units_row: bool,
    trailing: bool,
    quoted: bool,
    preamble: usize,
    blank_end: bool,
    exponent: bool,
}

fn layouts() -> impl Strategy<Value = Layout> {
    let flags = (
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
    );
    let order = Just((0..8).collect::<Vec<usize>>()).prop_shuffle();
    let separator = prop_oneof![Just(','), Just(';'), Just('\t'), Just('|'), Just(' ')];
    (order, separator, flags, any::<bool>(), 0usize..4).prop_map(
        |(
            order,
            separator,
            (decimal_comma, crlf, bom, units_row, trailing, quoted, blank_end),
            exponent,
            preamble,
        )| Layout {
            order,
            separator,
            decimal_comma: decimal_comma && separator != ',',
            crlf,
            bom,
            units_row,
            trailing: trailing && separator != ' ',
            quoted: quoted && separator != ' ',
            preamble,
            blank_end,
            exponent,
        },
    )
}

const NAMES: [&str; 8] = ["time", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z", "temp"];
const UNITS: [&str; 8] = ["s", "g", "g", "g", "deg/s", "deg/s", "deg/s", "°C"];

/// A row's values, with at most nine digits after the point.
fn values(i: usize) -> [f64; 8] {
    let k = i as f64;
    [
        (k * 0.01 * 1e3).round() / 1e3,
        ((k * 7.0) % 13.0 - 6.0) / 1000.0,
        -0.01,
        1.0,
        (k % 5.0) / 8.0,
        -12.5,
        0.000_125 * k,
        25.0 + (k % 3.0) / 10.0,
    ]
}

fn write(layout: &Layout, rows: usize) -> Vec<u8> {
    let end = if layout.crlf { "\r\n" } else { "\n" };
    let mut out = String::new();
    if layout.bom {
        out.push('\u{feff}');
    }
    for i in 0..layout.preamble {
        out += ["Device: imu 7", "Firmware, 2.1", "# recorded outdoors"][i % 3];
        out += end;
    }
    let separator = layout.separator.to_string();
    let mut line = |cells: Vec<String>, quoted: bool| {
        let cells: Vec<String> =
            cells.into_iter().map(|c| if quoted { format!("\"{c}\"") } else { c }).collect();
        out += &cells.join(&separator);
        if layout.trailing {
            out.push(layout.separator);
        }
        out += end;
    };
    let head = |i: &usize| {
        if layout.units_row { NAMES[*i].to_owned() } else { format!("{}[{}]", NAMES[*i], UNITS[*i]) }
    };
    line(layout.order.iter().map(head).collect(), layout.quoted);
    if layout.units_row {
        line(layout.order.iter().map(|i| UNITS[*i].to_owned()).collect(), layout.quoted);
    }
    for row in 0..rows {
        let v = values(row);
        let cell = |i: &usize| {
            let text = if layout.exponent { format!("{:e}", v[*i]) } else { format!("{}", v[*i]) };
            if layout.decimal_comma { text.replace('.', ",") } else { text }
        };
        line(layout.order.iter().map(cell).collect(), false);
    }
    if layout.blank_end {
        out += end;
        out += end;
    }
    out.into_bytes()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn the_layout_does_not_matter(layout in layouts()) {
        let bytes = write(&layout, 150);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let recording = open(&[Input { name: "a.csv", bytes: &bytes }], &Options::default());
        let recording = recording.map_err(|e| TestCaseError::fail(format!("{e}\n{}", &text[..text.len().min(600)])))?;
        prop_assert_eq!(recording.len(), 150);
        for i in 0..150 {
            let v = values(i);
            prop_assert_eq!(recording.time_s[i], v[0]);
            for k in 0..3 {
                prop_assert_eq!(recording.acc_m_s2[i][k], v[1 + k] * 9.80665);
                prop_assert_eq!(recording.gyro_rad_s[i][k], v[4 + k] * (core::f64::consts::PI / 180.0));
            }
            prop_assert_eq!(recording.temp_c.as_ref().unwrap()[i], v[7]);
        }
    }

    #[test]
    fn gzip_does_not_matter(layout in layouts()) {
        use std::io::Write;
        let bytes = write(&layout, 50);
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packed.write_all(&bytes).unwrap();
        let packed = packed.finish().unwrap();
        let plain = open(&[Input { name: "a.csv", bytes: &bytes }], &Options::default()).unwrap();
        let packed = open(&[Input { name: "a.csv.gz", bytes: &packed }], &Options::default()).unwrap();
        prop_assert_eq!(plain.acc_m_s2, packed.acc_m_s2);
    }

    /// Nothing hostile panics; whatever is refused has a sentence.
    #[test]
    fn damaged_files_are_refused_with_a_sentence(
        layout in layouts(), cut in 0usize..4000, at in 0usize..4000, byte in any::<u8>()
    ) {
        let mut bytes = write(&layout, 40);
        bytes.truncate(bytes.len().saturating_sub(cut).max(1));
        let at = at % bytes.len();
        bytes[at] = byte;
        if let Err(error) = open(&[Input { name: "a.csv", bytes: &bytes }], &Options::default()) {
            prop_assert!(error.to_string().len() > 20);
        }
    }
}
