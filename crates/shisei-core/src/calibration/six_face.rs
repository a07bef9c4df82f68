//! Bias and scale of an accelerometer from six rests, one on each face, and the gyroscope's bias.
//!
//! Of every face the steadiest window is kept (`search_faces`); bias b and scale s make
//! `Σ (|s ∘ (m − b)| − g)²` over the six windows' means m smallest (Levenberg and Marquardt). The faces need not
//! be level: the norm does not ask where down is.
//!
//! Six windows and six parameters leave no degree of freedom, so the residual (which comes out as zero) says
//! nothing of the result's quality. The covariance given is therefore what the windows' own noise explains:
//! the variance of each window's mean, from the scatter of up to 30 parts of the window, carried through
//! the fit. It does not know of temperature, of non-linearity, or of a table that shakes.

use super::apply::{Calibration, SensorModel};
use super::fit;
use crate::STANDARD_GRAVITY_M_S2;
use crate::error::{Error, Face, Result};
use crate::filter::{not_negative, positive};
use crate::vector::{self, Vec3};

/// How the windows are searched and what result is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SixFaceSettings {
    /// Length of a window, s; default 3. A window has round(windowSec/dt) rows.
    pub window_s: f64,
    /// Distance from one window's start to the next, s; default 0.1.
    pub step_s: f64,
    /// Largest angle between a window's mean and a face's axis, rad; default 15°.
    pub max_tilt_rad: f64,
    /// Largest variance of an axis in a stable window, (m/s²)²; default 0.01.
    pub variance_max: f64,
    /// |a| at rest, m/s²; default 9.80665.
    pub gravity_m_s2: f64,
    /// Smallest scale that is believed; default 0.9.
    pub min_acc_scale: f64,
    /// Largest scale that is believed; default 1.1.
    pub max_acc_scale: f64,
}

impl Default for SixFaceSettings {
    fn default() -> Self {
        SixFaceSettings {
            window_s: 3.0,
            step_s: 0.1,
            max_tilt_rad: 0.261799387799149,
            variance_max: 0.01,
            gravity_m_s2: STANDARD_GRAVITY_M_S2,
            min_acc_scale: 0.9,
            max_acc_scale: 1.1,
        }
    }
}

impl SixFaceSettings {
    /// Refused unless all are finite, lengths, gravity and scales greater than zero, the variance and the tilt
    /// not negative, and minAccScale < maxAccScale.
    pub fn check(&self) -> Result<()> {
        positive("windowSec", self.window_s)?;
        positive("stepSec", self.step_s)?;
        not_negative("maxTiltRad", self.max_tilt_rad)?;
        not_negative("varThreshold", self.variance_max)?;
        positive("gravity", self.gravity_m_s2)?;
        positive("minAccScale", self.min_acc_scale)?;
        positive("maxAccScale", self.max_acc_scale)?;
        if self.min_acc_scale >= self.max_acc_scale {
            return Err(Error::OutOfOrder { rule: "minAccScale < maxAccScale" });
        }
        Ok(())
    }
}

/// One window of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceWindow {
    /// First row.
    pub start_row: usize,
    /// Rows.
    pub rows: usize,
    /// Mean acceleration, m/s².
    pub acc_mean: Vec3,
    /// Population variance of the accelerations, (m/s²)².
    pub acc_variance: Vec3,
    /// Variance of `acc_mean`, (m/s²)².
    pub acc_mean_variance: Vec3,
    /// Mean rate, rad/s.
    pub gyro_mean: Vec3,
    /// Variance of `gyro_mean`, (rad/s)².
    pub gyro_mean_variance: Vec3,
    /// Angle between the mean acceleration and the face's axis, rad.
    pub tilt_rad: f64,
}

impl FaceWindow {
    /// The largest variance of an axis, (m/s²)².
    pub fn worst_variance(&self) -> f64 {
        self.acc_variance[0].max(self.acc_variance[1]).max(self.acc_variance[2])
    }

    /// |mean acceleration|, m/s².
    pub fn mean_norm(&self) -> f64 {
        vector::norm(self.acc_mean)
    }
}

/// Whether a face has its window, and if not why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceState {
    /// The window is stable and within the tilt.
    Found,
    /// The face was up, but never still: the window is the steadiest of those.
    Unsteady,
    /// The sensor was still with this axis nearest to up, but too far tilted: the window is the least tilted
    /// of those.
    Tilted,
    /// The axis was never nearest to up in a still or little tilted window.
    NeverUp,
}

/// What was found for one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceRow {
    /// The face.
    pub face: Face,
    /// Whether it was found.
    pub state: FaceState,
    /// Its window, or the best candidate; none for [`FaceState::NeverUp`].
    pub window: Option<FaceWindow>,
}

/// What was found, in the order +x, −x, +y, −y, +z, −z; available also when faces are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceTable {
    /// One row a face.
    pub faces: [FaceRow; 6],
}

impl FaceTable {
    /// The faces without a stable window.
    pub fn missing(&self) -> impl Iterator<Item = &FaceRow> {
        self.faces.iter().filter(|row| row.state != FaceState::Found)
    }

    /// All six windows; refused ([`Error::FaceMissing`], the first missing one) when one has none.
    pub fn windows(&self) -> Result<[FaceWindow; 6]> {
        let mut windows = [None; 6];
        for (slot, row) in windows.iter_mut().zip(&self.faces) {
            *slot = match (row.state, row.window) {
                (FaceState::Found, Some(window)) => Some(window),
                _ => return Err(Error::FaceMissing { face: row.face }),
            };
        }
        match windows {
            [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] => Ok([a, b, c, d, e, f]),
            _ => Err(Error::Empty),
        }
    }
}

/// A six-face calibration with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SixFace {
    /// Diagonal matrices; the gyroscope's is the identity.
    pub calibration: Calibration,
    /// Covariance of accelerometer bias x, y, z (m/s²), then scale x, y, z; from the windows' own noise.
    pub acc_covariance: [[f64; 6]; 6],
    /// Variance of the gyroscope bias, (rad/s)²; the axes are independent.
    pub gyro_bias_variance: Vec3,
    /// Where it comes from.
    pub table: FaceTable,
}

/// Bias and scale from windows found before. Refused: settings, a missing face, a scale outside its bounds,
/// means that do not determine the answer, an iteration that does not converge.
pub fn solve(table: &FaceTable, settings: &SixFaceSettings) -> Result<SixFace> {
    settings.check()?;
    let windows = table.windows()?;
    let found = fit::fit(&windows, settings.gravity_m_s2)?;
    for axis in 0..3 {
        let scale = found.scale[axis];
        if !(settings.min_acc_scale..=settings.max_acc_scale).contains(&scale) {
            return Err(Error::ScaleOutOfBounds { axis: axis as u8, scale });
        }
    }
    let mut gyro_bias = [0.0; 3];
    let mut gyro_bias_variance = [0.0; 3];
    for window in &windows {
        for axis in 0..3 {
            gyro_bias[axis] += window.gyro_mean[axis] / 6.0;
            gyro_bias_variance[axis] += window.gyro_mean_variance[axis] / 36.0;
        }
    }
    Ok(SixFace {
        calibration: Calibration {
            accelerometer: SensorModel::from_bias_scale(found.bias, found.scale),
            gyroscope: SensorModel::from_bias_scale(gyro_bias, [1.0; 3]),
        },
        acc_covariance: found.covariance,
        gyro_bias_variance,
        table: *table,
    })
}

/// Finds the windows and solves. Refused as [`search_faces`](super::search_faces) and [`solve`].
#[cfg(feature = "alloc")]
pub fn six_face(
    acc_m_s2: &[Vec3],
    gyro_rad_s: &[Vec3],
    dt_s: f64,
    settings: &SixFaceSettings,
) -> Result<SixFace> {
    solve(&super::search_faces(acc_m_s2, gyro_rad_s, dt_s, settings)?, settings)
}
