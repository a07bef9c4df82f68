//! Calibration files on the command line.

use std::path::Path;

use shisei_core::Lang;
use shisei_record::calibration::CalibrationFile;
use shisei_record::{Note, Recording};

use crate::fail::{Failure, Outcome};
use crate::input;

/// Reads a calibration file.
pub fn read(path: &Path, lang: Lang) -> Outcome<CalibrationFile> {
    let bytes = input::read(path, lang)?;
    CalibrationFile::from_json(&bytes).map_err(|error| {
        let colon = if lang == Lang::Ja { "：" } else { ": " };
        Failure::input(format!("{}{colon}{}", path.display(), error.sentence(lang)))
    })
}

/// A file of what the estimator learnt now.
pub fn learnt(learnt: &shisei_core::estimator::Calibration, gravity_m_s2: f64) -> CalibrationFile {
    CalibrationFile::from_learnt(learnt, gravity_m_s2, &now())
}

/// This second, RFC 3339.
pub fn now() -> String {
    jiff::Timestamp::now().round(jiff::Unit::Second).map(|t| t.to_string()).unwrap_or_default()
}

/// Corrects a recording in place, and warns where gravity then has an odd size.
pub fn apply(file: &CalibrationFile, recording: &mut Recording, lang: Lang) -> Outcome<()> {
    let acc = recording.acc_m_s2.clone();
    let gyro = recording.gyro_rad_s.clone();
    let models = &file.calibration;
    models
        .accelerometer
        .apply_series(&acc, &mut recording.acc_m_s2)
        .and_then(|()| models.gyroscope.apply_series(&gyro, &mut recording.gyro_rad_s))
        .map_err(|error| Failure::core("calibration", error, lang))?;
    let mut norms: Vec<f64> = recording.acc_m_s2.iter().map(|a| shisei_core::vector::norm(*a)).collect();
    let middle = norms.len() / 2;
    if middle < norms.len() {
        let usual = *norms.select_nth_unstable_by(middle, f64::total_cmp).1;
        if !(0.7..1.4).contains(&(usual / shisei_core::STANDARD_GRAVITY_M_S2)) {
            recording.warnings.push(Note::new(
                "calibration-odd",
                format!(
                    "with the calibration |a| is mostly {usual:.4e} m/s² where about 9.8 is expected; check that it is this sensor's, and made for the same units"
                ),
                format!(
                    "キャリブレーション適用後の |a| の中央値が {usual:.4e} m/s² で、約 9.8 になりません。このセンサのもので、単位が同じか確認してください"
                ),
            ));
        }
    }
    Ok(())
}
