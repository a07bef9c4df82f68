//! The choice of the filter on a node.

use shisei_core::estimator::{LightEstimator, Settings};
use shisei_core::filter::{Complementary, DEFAULT_ALPHA, Filter};
use shisei_core::{Quaternion, STANDARD_GRAVITY_M_S2, Vec3};
use shisei_wire::packet::FilterKind;

/// However still a sensor lies, its bias wanders by this within minutes, rad/s: 0.006 °/s.
const BIAS_SIGMA_MIN_RAD_S: f64 = 1e-4;

/// A node's filter: what every tick is fed to.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one, and no allocator")]
pub enum Attitude {
    /// Before the start is done: identity.
    Waiting,
    /// The complementary filter, bias removed before.
    Complementary(Complementary),
    /// The light estimator, which finds the start itself and goes on looking for bias.
    Estimator(LightEstimator),
}

impl Attitude {
    /// Begins a filter of this kind. `bias_sigma_rad_s`: how sure the bias is that was removed; none where none was.
    pub fn begin(kind: FilterKind, world_from_body: Quaternion, bias_sigma_rad_s: Option<f64>) -> Self {
        let begun = match kind {
            FilterKind::Complementary => {
                Complementary::new(world_from_body, DEFAULT_ALPHA, STANDARD_GRAVITY_M_S2)
                    .map(Attitude::Complementary)
            }
            FilterKind::Estimator => {
                let mut settings = Settings::default();
                if let Some(sigma) = bias_sigma_rad_s {
                    let unknown = settings.quick.gyro_bias_start;
                    settings.quick.gyro_bias_start = sigma.clamp(BIAS_SIGMA_MIN_RAD_S, unknown);
                }
                LightEstimator::new(&settings).map(Attitude::Estimator)
            }
        };
        begun.unwrap_or(Attitude::Waiting)
    }

    /// One tick.
    pub fn update(&mut self, gyro_rad_s: Vec3, acc_m_s2: Vec3, dt_s: f64) -> Quaternion {
        match self {
            Attitude::Waiting => Quaternion::IDENTITY,
            Attitude::Complementary(filter) => filter.update(gyro_rad_s, acc_m_s2, dt_s),
            Attitude::Estimator(filter) => Filter::update(filter, gyro_rad_s, acc_m_s2, dt_s),
        }
    }
}
