//! Two recordings of one rigid body by two clocks: an inertial sensor's and an optical system's.
//!
//! - [`gyro_path`]: the gyroscope's turns between any two times;
//! - [`fourier`]: the fast Fourier transform behind the correlation;
//! - [`correlate`]: where two speeds with holes in them are most alike;
//! - [`wahba`]: the rotation between two sets of vectors;
//! - [`rates`]: clock offset and skew, sensor-to-body rotation, and how far they can be trusted;
//! - [`lever`]: where on the body the sensor sits, and which way gravity points in the optical world.

pub mod correlate;
pub mod fourier;
pub mod gyro_path;
pub mod lever;
pub mod rates;
pub mod wahba;
