//! gaitmap and imucal (FAU): `acc_x, acc_y, acc_z, gyr_x, gyr_y, gyr_z`, m/s² and deg/s, or raw counts.
//!
//! Units are not written: the acceleration's comes from |a| at rest, the angular rate's from how fast
//! gravity turns, and deg/s is the fallback.

use super::Dialect;
use crate::units::DEG_S;

/// The dialect.
pub const DIALECT: Dialect = Dialect {
    id: "gaitmap",
    name: "gaitmap / imucal",
    recognises: |s| ["acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"].iter().all(|n| s.has_column(n)),
    mend: |_, reading| reading.gyro_guess = Some(DEG_S),
};
