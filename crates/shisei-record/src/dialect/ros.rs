//! `sensor_msgs/Imu` of ROS as CSV: `field.angular_velocity.x`, `field.linear_acceleration.x`, …
//!
//! ROS's `linear_acceleration` has gravity in it; seconds and nanoseconds may be two columns.

use super::{Dialect, names_with};
use crate::names::Quantity;
use crate::plan::{CoarseTime, Reading};
use crate::sheet::Sheet;
use crate::units::{M_S2, NANOSECOND, RAD_S, SECOND};

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "ros",
    name: "ROS sensor_msgs/Imu",
    recognises: |s| {
        names_with(s, "angular_velocity") && names_with(s, "linear_acceleration")
            || names_with(s, "angular_vel") && names_with(s, "linear_acc") && names_with(s, "orientation")
    },
    mend,
};

fn mend(sheet: &Sheet<'_>, reading: &mut Reading) {
    let (mut secs, mut nsecs) = (None, None);
    let stamped = sheet.header.iter().any(|n| n.to_lowercase().contains("stamp"));
    for (i, (m, name)) in reading.meanings.iter_mut().zip(&sheet.header).enumerate() {
        let lower = name.to_lowercase();
        if lower.contains("covariance") || lower.contains("orientation") {
            m.quantity = Quantity::Other;
        } else if m.quantity == Quantity::LinearAcceleration {
            m.quantity = Quantity::Acceleration;
            m.unit = m.unit.or(Some(M_S2));
        } else if m.quantity == Quantity::AngularRate {
            m.unit = m.unit.or(Some(RAD_S));
        } else if lower.ends_with("nsecs") || lower.ends_with("nanosec") || lower.ends_with("nsec") {
            nsecs = Some(i);
        } else if lower.ends_with("secs") || lower.ends_with("sec") {
            secs = Some(i);
        } else if stamped && m.quantity == Quantity::Time && !lower.contains("stamp") {
            // The time of arrival in the bag is not that of the sample.
            m.quantity = Quantity::Other;
        }
    }
    if let (Some(secs), Some(nsecs)) = (secs, nsecs) {
        for m in &mut reading.meanings {
            if m.quantity == Quantity::Time {
                m.quantity = Quantity::Other;
            }
        }
        if let Some(m) = reading.meanings.get_mut(nsecs) {
            m.quantity = Quantity::Time;
            m.unit = Some(NANOSECOND);
        }
        if let Some(m) = reading.meanings.get_mut(secs) {
            m.quantity = Quantity::Other;
            m.unit = Some(SECOND);
        }
        reading.time_cycle = Some(1e9);
        reading.coarse_time = Some(CoarseTime { column: secs, exact: true });
    }
}
