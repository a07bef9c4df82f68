//! Nine-parameter accelerometer calibration from many still poses, no equipment needed.
//!
//! At rest |M (a − b)| = g in every pose. M is upper triangular (three scales, three cross-axis terms): the
//! corrected frame shares its z axis with the sensor's. Levenberg–Marquardt on the pose means (Tedaldi, Pretto &
//! Menegatti, ICRA 2014). The covariance is s² (JᵀJ)⁻¹ with s² from the residuals; with exactly nine poses
//! there is no residual and the variance of the pose means stands in, which the result says.

use alloc::vec::Vec;

use crate::calibration::SensorModel;
use crate::error::{Error, Result};
use crate::least_squares::{Fit, Normal, levenberg_marquardt, quadratic_form};
use crate::math;
use crate::matrix::Square;
use crate::vector::{self, Vec3};

/// Parameters: bias x, y, z (raw unit), then the upper triangle m00, m01, m02, m11, m12, m22.
pub const PARAMETERS: usize = 9;

/// Names of the nine parameters, in the covariance's order.
pub const PARAMETER_NAMES: [&str; PARAMETERS] =
    ["bias_x", "bias_y", "bias_z", "m_xx", "m_xy", "m_xz", "m_yy", "m_yz", "m_zz"];

/// A pose: the mean reading and the variance of that mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Mean accelerometer reading, raw unit.
    pub mean: Vec3,
    /// Variance of the mean (of one axis, averaged over the three), raw unit squared.
    pub mean_variance: f64,
}

impl Pose {
    /// From a still segment: the variance of a mean of n rows is their variance / n.
    pub fn from_segment(segment: &super::still::StillSegment) -> Self {
        let v = segment.acc_variance;
        Pose {
            mean: segment.acc_mean,
            mean_variance: (v[0] + v[1] + v[2]) / (3.0 * segment.rows().max(1) as f64),
        }
    }
}

/// Where the stated errors come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SigmaSource {
    /// From the residuals of the fit.
    Residuals,
    /// From the noise of the means: as many poses as parameters, so the residual says nothing.
    MeanNoise,
}

/// A pose that would help most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuggestedPose {
    /// Direction that should point up, unit vector in the sensor's axes.
    pub up_body: Vec3,
    /// Standard error of |a| in that pose now, m/s².
    pub sigma_now: f64,
    /// Largest standard error of |a| over all poses once it (and the suggestions before it) is added, m/s².
    pub worst_sigma_after: f64,
}

/// The result.
#[derive(Clone, Debug)]
pub struct MultiPose {
    /// The calibration.
    pub accelerometer: SensorModel,
    /// Standard errors in the order of [`PARAMETER_NAMES`].
    pub sigma: [f64; PARAMETERS],
    /// Covariance in the same order.
    pub covariance: Square<PARAMETERS>,
    /// Where the errors come from.
    pub sigma_source: SigmaSource,
    /// |M (a − b)| − g of each pose, m/s².
    pub residuals: Vec<f64>,
    /// Root mean square of the residuals, m/s².
    pub residual_rms: f64,
    /// |M (a − b)| − g of each pose with the calibration of all the other poses, m/s²; empty with fewer than 10
    /// poses.
    pub held_out: Vec<f64>,
    /// Root mean square of `held_out`, m/s²; NaN when that is empty.
    pub held_out_rms: f64,
    /// Standard deviation of one pose's |a|, m/s².
    pub pose_sigma: f64,
    /// Gravity used, m/s².
    pub gravity_m_s2: f64,
}

fn unpack(p: &[f64; PARAMETERS]) -> SensorModel {
    SensorModel {
        bias: [p[0], p[1], p[2]],
        matrix: [[p[3], p[4], p[5]], [0.0, p[6], p[7]], [0.0, 0.0, p[8]]],
    }
}

/// Derivatives of |M (a − b)| with respect to the nine parameters, and the corrected vector's norm.
fn derivatives(affine: &SensorModel, raw: Vec3) -> ([f64; PARAMETERS], f64) {
    let d = vector::sub(raw, affine.bias);
    let c = affine.apply(raw);
    let n = vector::norm(c);
    let u = if n > 0.0 { vector::scale(c, 1.0 / n) } else { [0.0, 0.0, 1.0] };
    let m = &affine.matrix;
    (
        [
            -(u[0] * m[0][0]),
            -(u[0] * m[0][1] + u[1] * m[1][1]),
            -(u[0] * m[0][2] + u[1] * m[1][2] + u[2] * m[2][2]),
            u[0] * d[0],
            u[0] * d[1],
            u[0] * d[2],
            u[1] * d[1],
            u[1] * d[2],
            u[2] * d[2],
        ],
        n,
    )
}

fn solve(poses: &[Pose], skip: usize, gravity: f64, start: [f64; PARAMETERS]) -> Result<Fit<PARAMETERS>> {
    levenberg_marquardt(start, |p| {
        let affine = unpack(p);
        let mut normal = Normal::default();
        for (i, pose) in poses.iter().enumerate() {
            if i != skip {
                let (j, n) = derivatives(&affine, pose.mean);
                normal.add(&j, n - gravity, 1.0);
            }
        }
        normal
    })
}

/// Starting point: the middle of the box around the readings and one scale that gives g on average.
fn starting_point(poses: &[Pose], gravity: f64) -> Result<[f64; PARAMETERS]> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for pose in poses {
        for i in 0..3 {
            low[i] = low[i].min(pose.mean[i]);
            high[i] = high[i].max(pose.mean[i]);
        }
    }
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])];
    let reach = |b: Vec3| {
        poses.iter().map(|p| vector::norm(vector::sub(p.mean, b))).sum::<f64>() / poses.len() as f64
    };
    // poses on one side only have no middle; then the bias starts at zero
    let (with_zero, with_middle) = (reach([0.0; 3]), reach(middle));
    let (b, mean) = if with_middle > 0.7 * with_zero { (middle, with_middle) } else { ([0.0; 3], with_zero) };
    if !(mean > 0.0 && mean.is_finite()) {
        return Err(Error::Degenerate);
    }
    let s = gravity / mean;
    Ok([b[0], b[1], b[2], s, 0.0, 0.0, s, 0.0, s])
}

/// Calibrates an accelerometer from still poses (nine at least, twelve or more spread over all directions are
/// better) and the local gravity in m/s².
///
/// Refuses with [`Error::TooFewPoints`], [`Error::NotFinite`], [`Error::Degenerate`] (poses that do not
/// determine all nine parameters; turn the sensor to other sides too) or [`Error::NoConvergence`].
pub fn calibrate(poses: &[Pose], gravity_m_s2: f64) -> Result<MultiPose> {
    if !(gravity_m_s2 > 0.0 && gravity_m_s2.is_finite()) {
        return Err(Error::NotPositive { name: "gravity", value: gravity_m_s2 });
    }
    if poses.len() < PARAMETERS {
        return Err(Error::TooFewPoints { given: poses.len(), needed: PARAMETERS });
    }
    if let Some(row) = poses.iter().position(|p| !vector::is_finite(p.mean)) {
        return Err(Error::NotFinite { row });
    }
    let fit = solve(poses, usize::MAX, gravity_m_s2, starting_point(poses, gravity_m_s2)?)?;
    let accelerometer = unpack(&fit.parameters);
    let m = &accelerometer.matrix;
    if [m[0][0], m[1][1], m[2][2]].iter().any(|s| *s <= 0.0) {
        return Err(Error::Degenerate);
    }
    let residuals: Vec<f64> =
        poses.iter().map(|p| vector::norm(accelerometer.apply(p.mean)) - gravity_m_s2).collect();
    // the noise of |a| in a pose from that of its mean, through the mean scale
    let scale = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
    let noise = poses.iter().map(|p| p.mean_variance).sum::<f64>() / poses.len() as f64 * scale * scale;
    let dof = fit.degrees_of_freedom();
    let (s2, sigma_source) = if dof == 0 {
        (noise, SigmaSource::MeanNoise)
    } else {
        (fit.cost / dof as f64, SigmaSource::Residuals)
    };
    let mut covariance = fit.inverse_normal;
    let mut sigma = [0.0; PARAMETERS];
    for i in 0..PARAMETERS {
        for j in 0..PARAMETERS {
            covariance[i][j] *= s2;
        }
        sigma[i] = math::sqrt(covariance[i][i].max(0.0));
    }
    // a bias unknown to a tenth of g, or a scale to a tenth: the poses do not hold the parameters
    if sigma[..3].iter().any(|s| s * scale > 0.1 * gravity_m_s2)
        || sigma[3..].iter().any(|s| *s > 0.1 * scale)
    {
        return Err(Error::Degenerate);
    }
    let mut held_out = Vec::new();
    if poses.len() > PARAMETERS {
        for i in 0..poses.len() {
            match solve(poses, i, gravity_m_s2, fit.parameters) {
                Ok(f) => {
                    held_out.push(vector::norm(unpack(&f.parameters).apply(poses[i].mean)) - gravity_m_s2);
                }
                // without this pose the rest does not determine the calibration: no check for it
                Err(_) => held_out.push(f64::NAN),
            }
        }
    }
    Ok(MultiPose {
        accelerometer,
        sigma,
        covariance,
        sigma_source,
        residual_rms: rms(&residuals),
        residuals,
        held_out_rms: rms(&held_out),
        held_out,
        pose_sigma: math::sqrt(s2),
        gravity_m_s2,
    })
}

/// Root mean square of the finite values; NaN without any.
fn rms(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|v| v.is_finite());
    let n = finite.clone().count();
    if n == 0 { f64::NAN } else { math::sqrt(finite.map(|v| v * v).sum::<f64>() / n as f64) }
}

impl MultiPose {
    /// Standard error of |a| from the calibration alone when `up_body` (unit vector) points up, m/s².
    pub fn sigma_of_norm(&self, up_body: Vec3) -> f64 {
        math::sqrt(self.variance_of_norm(&self.covariance, up_body).max(0.0))
    }

    fn row_of(&self, up_body: Vec3) -> [f64; PARAMETERS] {
        let raw = self
            .accelerometer
            .unapply(vector::scale(up_body, self.gravity_m_s2))
            .unwrap_or(self.accelerometer.bias);
        derivatives(&self.accelerometer, raw).0
    }

    fn variance_of_norm(&self, covariance: &Square<PARAMETERS>, up_body: Vec3) -> f64 {
        quadratic_form(covariance, &self.row_of(up_body))
    }

    /// The `count` poses that would lower the uncertainty most, best first, each counted as measured before the
    /// next is looked for.
    pub fn suggest(&self, count: usize) -> Vec<SuggestedPose> {
        let candidates = sphere_directions(200);
        let mut covariance = self.covariance;
        let worst = |c: &Square<PARAMETERS>| {
            candidates
                .iter()
                .map(|u| (self.variance_of_norm(c, *u), *u))
                .fold((0.0, [0.0, 0.0, 1.0]), |a, b| if b.0 > a.0 { b } else { a })
        };
        let mut suggestions = Vec::new();
        for _ in 0..count.min(12) {
            let (now, up_body) = worst(&covariance);
            // one more pose with the noise of the others: C ← C − C j jᵀ C / (s² + jᵀ C j)
            let j = self.row_of(up_body);
            let mut cj = [0.0; PARAMETERS];
            for a in 0..PARAMETERS {
                for b in 0..PARAMETERS {
                    cj[a] += covariance[a][b] * j[b];
                }
            }
            let total = self.pose_sigma * self.pose_sigma + now;
            if total <= 0.0 {
                break;
            }
            for a in 0..PARAMETERS {
                for b in 0..PARAMETERS {
                    covariance[a][b] -= cj[a] * cj[b] / total;
                }
            }
            suggestions.push(SuggestedPose {
                up_body,
                sigma_now: math::sqrt(now.max(0.0)),
                worst_sigma_after: math::sqrt(worst(&covariance).0.max(0.0)),
            });
        }
        suggestions
    }
}

/// `count` directions spread evenly over the sphere (Fibonacci's spiral), unit vectors.
pub fn sphere_directions(count: usize) -> Vec<Vec3> {
    let golden = core::f64::consts::PI * (3.0 - math::sqrt(5.0));
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let r = math::sqrt((1.0 - z * z).max(0.0));
            let (s, c) = math::sin_cos(golden * i as f64);
            [r * c, r * s, z]
        })
        .collect()
}
