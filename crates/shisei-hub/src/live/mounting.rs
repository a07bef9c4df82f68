//! How a sensor sits on its body, as `shisei fuse --json` found it earlier: clocks and biases are of the day and are
//! learnt live, the mounting stays.

use serde_json::Value;
use shisei_core::alignment::Alignment;
use shisei_core::{Quaternion, Vec3};

/// A sensor on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounting {
    /// Turns sensor coordinates into body coordinates.
    pub body_from_sensor: Quaternion,
    /// The sensor in body coordinates, m; none where it was not found.
    pub sensor_m: Option<Vec3>,
}

impl Mounting {
    /// A body's name and its sensor, from what `shisei fuse --json` printed. None where the object is not of that
    /// form.
    pub fn parse(value: &Value) -> Option<(String, Self)> {
        let name = value["body"].as_str()?.to_owned();
        let [w, x, y, z] = numbers::<4>(&value["body_from_sensor_wxyz"])?;
        let body_from_sensor = Quaternion::new(w, x, y, z).try_normalized().ok()?;
        Some((name, Mounting { body_from_sensor, sensor_m: numbers::<3>(&value["lever_arm_m"]) }))
    }

    /// What was learnt live, with this mounting.
    pub fn onto(&self, learnt: &Alignment) -> Alignment {
        Alignment {
            body_from_sensor: self.body_from_sensor,
            sensor_m: self.sensor_m.unwrap_or(learnt.sensor_m),
            ..*learnt
        }
    }
}

fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_fuse_prints_is_understood_and_all_else_is_not() {
        let printed =
            json!({"body": "Tool 1", "body_from_sensor_wxyz": [0, 0, 2, 0], "lever_arm_m": [1, 2, 3]});
        let (name, mounting) = Mounting::parse(&printed).unwrap();
        assert_eq!((name.as_str(), mounting.sensor_m), ("Tool 1", Some([1.0, 2.0, 3.0])));
        assert_eq!(mounting.body_from_sensor, Quaternion::new(0.0, 0.0, 1.0, 0.0));
        for wrong in [
            json!(null),
            json!({"body": "Tool 1"}),
            json!({"body": "Tool 1", "body_from_sensor_wxyz": [0, 0, 0, 0]}),
            json!({"body": "Tool 1", "body_from_sensor_wxyz": [1, 0, 0]}),
            json!({"body": 1, "body_from_sensor_wxyz": [1, 0, 0, 0]}),
        ] {
            assert_eq!(Mounting::parse(&wrong), None, "{wrong}");
        }
    }
}
