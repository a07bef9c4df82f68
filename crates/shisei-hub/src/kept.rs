//! The calibration that a node keeps, and the calibration of a file.

use serde_json::json;
use shisei_core::calibration::{Calibration, SensorModel};
use shisei_wire::calibration::{Calibration as Kept, Correction};

/// For a node; rounded to f32. Whether a node would take it says [`Kept::is_sound`].
pub fn for_node(calibration: &Calibration) -> Kept {
    let half = |model: &SensorModel| Correction::from_f64(model.bias, model.matrix);
    Kept { accelerometer: half(&calibration.accelerometer), gyroscope: half(&calibration.gyroscope) }
}

/// Ready for use.
pub fn of_node(kept: &Kept) -> Calibration {
    let model = |half: &Correction| {
        let (bias, matrix) = half.to_f64();
        SensorModel { bias, matrix }
    };
    Calibration { accelerometer: model(&kept.accelerometer), gyroscope: model(&kept.gyroscope) }
}

/// As a calibration file says it.
pub fn json(kept: &Kept) -> serde_json::Value {
    let half = |correction: &Correction, bias_name: &str| {
        let (bias, matrix) = correction.to_f64();
        json!({bias_name: bias, "matrix": matrix})
    };
    json!({
        "id": format!("{:04x}", kept.id()),
        "accelerometer": half(&kept.accelerometer, "bias_m_s2"),
        "gyroscope": half(&kept.gyroscope, "bias_rad_s"),
    })
}
