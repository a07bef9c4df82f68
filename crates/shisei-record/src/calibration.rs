//! The calibration JSON: what was found about one sensor, with units, date and how sure it is.
//!
//! `corrected = matrix · (raw − bias)` for both sensors. Keys that are not known here are kept, so that a file
//! passes through older versions unharmed.

use serde_json::{Map, Value, json};
use shisei_core::calibration::{Calibration, SensorModel};
use shisei_core::estimator::{CALIBRATION_STATES, Calibration as Learnt};
use shisei_core::{Lang, Vec3};

/// What the key `format` says.
pub const FORMAT: &str = "shisei-calibration";
/// The version written here, and the only one read.
pub const VERSION: u64 = 1;

/// What the key `method` says of a calibration that the estimator learnt.
const LEARNT_METHOD: &str = "estimator";
/// The order of the estimator's covariance: biases in rad/s and m/s², the gyroscope matrix row by row, scales.
const LEARNT_ORDER: [&str; CALIBRATION_STATES] = [
    "gyro_bias_x",
    "gyro_bias_y",
    "gyro_bias_z",
    "acc_bias_x",
    "acc_bias_y",
    "acc_bias_z",
    "gyro_matrix_xx",
    "gyro_matrix_xy",
    "gyro_matrix_xz",
    "gyro_matrix_yx",
    "gyro_matrix_yy",
    "gyro_matrix_yz",
    "gyro_matrix_zx",
    "gyro_matrix_zy",
    "gyro_matrix_zz",
    "acc_scale_x",
    "acc_scale_y",
    "acc_scale_z",
];

/// A calibration and everything its file says about it.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationFile {
    /// What is applied.
    pub calibration: Calibration,
    /// The whole JSON object, for all other keys.
    pub document: Map<String, Value>,
}

/// Why a calibration cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CalibrationError {
    /// Not JSON, or not an object; the parser's words.
    NotJson(String),
    /// `format` is missing or another.
    OtherFormat(String),
    /// `version` is missing or another.
    OtherVersion(String),
    /// A number is missing or not finite: where.
    BadNumber(String),
    /// A matrix that leaves nothing of a direction: which.
    Singular(String),
    /// `covariance` is not square, not as long as its order, not finite, or negative on the diagonal.
    BadCovariance,
}

impl CalibrationError {
    /// What was wrong, where, what was expected.
    pub fn sentence(&self, lang: Lang) -> String {
        match (self, lang) {
            (CalibrationError::NotJson(why), Lang::En) => {
                format!(
                    "this is not a calibration: it is not a JSON object ({why}); make one with shisei calibrate"
                )
            }
            (CalibrationError::NotJson(why), Lang::Ja) => {
                format!(
                    "キャリブレーションファイルではありません。JSON オブジェクトとして読めません ({why})。shisei calibrate で作成してください"
                )
            }
            (CalibrationError::OtherFormat(found), Lang::En) => {
                format!("this is not a calibration: \"format\" is {found}, expected \"{FORMAT}\"")
            }
            (CalibrationError::OtherFormat(found), Lang::Ja) => {
                format!(
                    "キャリブレーションファイルではありません。\"format\" が {found} です (\"{FORMAT}\" が必要です)"
                )
            }
            (CalibrationError::OtherVersion(found), Lang::En) => {
                format!(
                    "\"version\" is {found}; this shisei reads version {VERSION}: use a newer shisei or calibrate again"
                )
            }
            (CalibrationError::OtherVersion(found), Lang::Ja) => {
                format!(
                    "\"version\" が {found} です。この shisei が読めるのはバージョン {VERSION} です。新しい shisei を使うか、キャリブレーションをやり直してください"
                )
            }
            (CalibrationError::Singular(place), Lang::En) => {
                format!(
                    "{place} has no inverse: it would take a direction away; calibrate again or mend the file"
                )
            }
            (CalibrationError::Singular(place), Lang::Ja) => {
                format!(
                    "{place} に逆行列がなく、方向が失われます。キャリブレーションをやり直すか、ファイルを修正してください"
                )
            }
            (CalibrationError::BadNumber(place), Lang::En) => {
                format!("{place} is missing or not made of finite numbers; calibrate again or mend the file")
            }
            (CalibrationError::BadNumber(place), Lang::Ja) => {
                format!(
                    "{place} がないか、有限の数値ではありません。キャリブレーションをやり直すか、ファイルを修正してください"
                )
            }
            (CalibrationError::BadCovariance, Lang::En) => {
                "covariance must have an \"order\" of n names and \"values\" of n rows of n finite numbers, with none \
                 below 0 on the diagonal; take covariance out, or calibrate again"
                    .to_owned()
            }
            (CalibrationError::BadCovariance, Lang::Ja) => {
                "covariance には、n 個の名前を並べた \"order\" と、n 行 n 列の有限の数値の \"values\" が必要です (対角は 0 以上)。\
                 covariance を除くか、キャリブレーションをやり直してください"
                    .to_owned()
            }
        }
    }
}

impl CalibrationFile {
    /// A new file: method, gravity, and the calibration; further keys through [`CalibrationFile::set`].
    pub fn new(calibration: Calibration, method: &str, gravity_m_s2: f64, created: &str) -> Self {
        let mut document = Map::new();
        for (key, value) in [
            ("format", json!(FORMAT)),
            ("version", json!(VERSION)),
            ("sensor", Value::Null),
            ("created", json!(created)),
            ("temperature_c", Value::Null),
            ("method", json!(method)),
            ("gravity_m_s2", json!(gravity_m_s2)),
            ("accelerometer", model_json(&calibration.accelerometer, "bias_m_s2")),
            ("gyroscope", model_json(&calibration.gyroscope, "bias_rad_s")),
        ] {
            document.insert(key.to_owned(), value);
        }
        CalibrationFile { calibration, document }
    }

    /// Sets a further key of the document: `sensor`, `temperature_c`, `sigma`, `covariance`, `checks` …
    pub fn set(&mut self, key: &str, value: Value) {
        self.document.insert(key.to_owned(), value);
    }

    /// The key `sigma` in the calibration's shape: standard deviations of biases and matrices.
    pub fn set_sigma(&mut self, sigma: &Calibration) {
        let value = json!({
            "accelerometer": model_json(&sigma.accelerometer, "bias_m_s2"),
            "gyroscope": model_json(&sigma.gyroscope, "bias_rad_s"),
        });
        self.set("sigma", value);
    }

    /// Reads the text of a file.
    pub fn from_json(text: &[u8]) -> Result<Self, CalibrationError> {
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let value: Value =
            serde_json::from_slice(text).map_err(|error| CalibrationError::NotJson(error.to_string()))?;
        let Value::Object(document) = value else {
            return Err(CalibrationError::NotJson("no { … }".to_owned()));
        };
        let shown = |key: &str| document.get(key).map_or_else(|| "–".to_owned(), Value::to_string);
        if document.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(CalibrationError::OtherFormat(shown("format")));
        }
        if document.get("version").and_then(Value::as_u64) != Some(VERSION) {
            return Err(CalibrationError::OtherVersion(shown("version")));
        }
        let calibration = Calibration {
            accelerometer: model(&document, "accelerometer", "bias_m_s2")?,
            gyroscope: model(&document, "gyroscope", "bias_rad_s")?,
        };
        if let Some(covariance) = document.get("covariance").filter(|value| !value.is_null())
            && !is_covariance(covariance)
        {
            return Err(CalibrationError::BadCovariance);
        }
        Ok(CalibrationFile { calibration, document })
    }

    /// A file of what the estimator learnt of a sensor, with its covariance.
    pub fn from_learnt(learnt: &Learnt, gravity_m_s2: f64, created: &str) -> Self {
        let calibration = Calibration {
            accelerometer: SensorModel { bias: learnt.acc_bias_m_s2, matrix: learnt.acc_matrix },
            gyroscope: SensorModel { bias: learnt.gyro_bias_rad_s, matrix: learnt.gyro_matrix },
        };
        let mut file = CalibrationFile::new(calibration, LEARNT_METHOD, gravity_m_s2, created);
        file.set("covariance", json!({ "order": LEARNT_ORDER, "values": learnt.covariance }));
        file
    }

    /// What the estimator starts from: nothing where the file has no covariance of its kind.
    pub fn learnt(&self) -> Option<Learnt> {
        let covariance = self.document.get("covariance")?;
        let order: Vec<&str> =
            covariance.get("order")?.as_array()?.iter().filter_map(Value::as_str).collect();
        if order != LEARNT_ORDER {
            return None;
        }
        let rows: Vec<[f64; CALIBRATION_STATES]> =
            covariance.get("values")?.as_array()?.iter().filter_map(numbers).collect();
        let (acc, gyro) = (&self.calibration.accelerometer, &self.calibration.gyroscope);
        Some(Learnt {
            gyro_bias_rad_s: gyro.bias,
            gyro_matrix: gyro.matrix,
            acc_bias_m_s2: acc.bias,
            acc_matrix: acc.matrix,
            covariance: rows.try_into().ok()?,
        })
    }

    /// The text of a file, ending in a line feed.
    pub fn to_json(&self) -> String {
        // A map of finite numbers and strings always serialises.
        let mut text = serde_json::to_string_pretty(&self.document).unwrap_or_default();
        text.push('\n');
        text
    }
}

fn model_json(model: &SensorModel, bias_key: &str) -> Value {
    json!({ bias_key: model.bias, "matrix": model.matrix })
}

fn model(
    document: &Map<String, Value>,
    sensor: &str,
    bias_key: &str,
) -> Result<SensorModel, CalibrationError> {
    let bad = |key: &str| CalibrationError::BadNumber(format!("{sensor}.{key}"));
    let part = document.get(sensor).ok_or_else(|| CalibrationError::BadNumber(sensor.to_owned()))?;
    let bias = part.get(bias_key).and_then(vector).ok_or_else(|| bad(bias_key))?;
    let rows: Vec<Vec3> = match part.get("matrix") {
        Some(Value::Array(rows)) => rows.iter().map(vector).collect::<Option<_>>().unwrap_or_default(),
        _ => Vec::new(),
    };
    let matrix: [Vec3; 3] = rows.try_into().map_err(|_| bad("matrix"))?;
    if shisei_core::matrix::inverse(&matrix).is_err() {
        return Err(CalibrationError::Singular(format!("{sensor}.matrix")));
    }
    Ok(SensorModel { bias, matrix })
}

fn is_covariance(value: &Value) -> bool {
    let list = |key: &str| value.get(key).and_then(Value::as_array);
    let (Some(order), Some(rows)) = (list("order"), list("values")) else { return false };
    let finite = |x: &Value| x.as_f64().filter(|x| x.is_finite());
    let is_row = |(k, row): (usize, &Value)| {
        row.as_array().is_some_and(|row| {
            row.len() == order.len()
                && row.iter().all(|x| finite(x).is_some())
                && row.get(k).and_then(finite).is_some_and(|variance| variance >= 0.0)
        })
    };
    order.iter().all(Value::is_string) && rows.len() == order.len() && rows.iter().enumerate().all(is_row)
}

fn vector(value: &Value) -> Option<Vec3> {
    numbers(value)
}

fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let finite = |value: &Value| value.as_f64().filter(|v| v.is_finite());
    value.as_array()?.iter().map(finite).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> CalibrationFile {
        let calibration = Calibration::from_twelve([
            -0.0272, -0.07121, 0.106377, 0.999356, 0.999585, 0.999567, 0.006784, 0.009346, 0.008648, 1.0,
            1.0, 1.0,
        ]);
        let mut file = CalibrationFile::new(calibration, "six-face", 9.80665, "2026-01-02T03:04:05Z");
        file.set("sensor", json!("MU-01 #7"));
        file
    }

    #[test]
    fn what_is_written_is_read() {
        let file = example();
        assert_eq!(CalibrationFile::from_json(file.to_json().as_bytes()).unwrap(), file);
    }

    #[test]
    fn what_the_estimator_learnt_survives_the_file() {
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.01, 0.0], [0.002, 0.0, 1.0]];
        let learnt = Learnt::with_sigmas(
            ([0.1, -0.2, 0.3], identity),
            ([0.01, 0.0, 0.02], identity),
            1e-3,
            0.02,
            1e-4,
            2e-4,
        );
        let file = CalibrationFile::from_learnt(&learnt, 9.8, "2026-01-02T03:04:05Z");
        let again = CalibrationFile::from_json(file.to_json().as_bytes()).unwrap();
        assert_eq!(again.learnt(), Some(learnt));
        assert_eq!(example().learnt(), None);
    }

    /// A scale that a reader of JSON in a hurry gets wrong by one bit, and others about it.
    #[test]
    fn every_bit_is_kept() {
        let mut calibration = example().calibration;
        for k in 0..1000_u64 {
            let scale = f64::from_bits(0.998_491_247_572_211_9_f64.to_bits() + 7919 * k);
            calibration.accelerometer.matrix[2][2] = scale;
            let file = CalibrationFile::new(calibration, "six-face", 9.8, "2026-01-02T03:04:05Z");
            let again = CalibrationFile::from_json(file.to_json().as_bytes()).unwrap();
            assert_eq!(again.calibration.accelerometer.matrix[2][2].to_bits(), scale.to_bits(), "{scale:?}");
        }
    }

    #[test]
    fn a_covariance_is_whole_or_refused() {
        let with = |covariance: Value| {
            let mut file = example();
            file.set("covariance", covariance);
            CalibrationFile::from_json(file.to_json().as_bytes())
        };
        for good in [Value::Null, json!({ "order": ["a", "b"], "values": [[1, -0.5], [-0.5, 0]] })] {
            assert!(with(good).is_ok());
        }
        for bad in [
            json!(5),
            json!({ "order": LEARNT_ORDER, "values": [[1]] }),
            json!({ "order": ["a"], "values": [[-1]] }),
            json!({ "order": ["a"], "values": [["1"]] }),
            json!({ "order": [1], "values": [[1]] }),
            json!({ "order": ["a", "b"], "values": [[1, 0], [0]] }),
        ] {
            let error = with(bad).unwrap_err();
            assert_eq!(error, CalibrationError::BadCovariance);
            assert!(error.sentence(Lang::En).contains("\"order\" of n names"));
            assert!(error.sentence(Lang::Ja).contains("対角は 0 以上"));
        }
    }

    #[test]
    fn unknown_keys_are_kept() {
        let mut file = example();
        file.set("lab", json!({ "room": 7 }));
        let again = CalibrationFile::from_json(file.to_json().as_bytes()).unwrap();
        assert_eq!(again.document.get("lab"), Some(&json!({ "room": 7 })));
    }

    #[test]
    fn wrong_files_are_named() {
        type Expected = fn(&CalibrationError) -> bool;
        let cases: [(&str, Expected); 6] = [
            ("", |e| matches!(e, CalibrationError::NotJson(_))),
            ("[1]", |e| matches!(e, CalibrationError::NotJson(_))),
            ("{}", |e| matches!(e, CalibrationError::OtherFormat(_))),
            (r#"{"format":"other"}"#, |e| matches!(e, CalibrationError::OtherFormat(_))),
            (r#"{"format":"shisei-calibration","version":2}"#, |e| {
                matches!(e, CalibrationError::OtherVersion(_))
            }),
            (
                r#"{"format":"shisei-calibration","version":1,"accelerometer":{"bias_m_s2":[1,2]}}"#,
                |e| matches!(e, CalibrationError::BadNumber(place) if place == "accelerometer.bias_m_s2"),
            ),
        ];
        for (text, is_expected) in cases {
            let error = CalibrationFile::from_json(text.as_bytes()).unwrap_err();
            assert!(is_expected(&error), "{text}: {error:?}");
            for lang in [Lang::En, Lang::Ja] {
                assert!(error.sentence(lang).len() > 20);
            }
        }
    }
}
