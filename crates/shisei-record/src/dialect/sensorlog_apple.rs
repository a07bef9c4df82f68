//! SensorLog (Apple): `loggingTime(txt),…,accelerometerAccelerationX(G),…,motionRotationRateX(rad/s),…`,
//! separated by comma or bar.
//!
//! `motionUserAcceleration` lacks gravity. Apple's frameworks give the acceleration with its sign turned.

use super::{Dialect, names_with};
use crate::recording::Note;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "sensorlog",
    name: "SensorLog (Apple)",
    recognises: |s| {
        names_with(s, "accelerometerAccelerationX")
            || names_with(s, "motionRotationRateX") && names_with(s, "motion")
    },
    mend: |_, reading| {
        reading.warnings.push(Note::new(
            "apple-sign",
            "Apple's frameworks give the acceleration with its sign turned (face up reads −1 g); mend it with \
             --axes \"acc=-x,-y,-z;gyr=x,y,z\""
                .into(),
            "Apple のフレームワークは加速度の符号が逆です (表を上にすると −1 g)。--axes \
             \"acc=-x,-y,-z;gyr=x,y,z\" で直せます"
                .into(),
        ));
    },
};
