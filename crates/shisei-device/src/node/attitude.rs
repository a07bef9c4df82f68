//! The choice of the filter on a node.

use shisei_core::estimator::{LightEstimator, Settings};
use shisei_core::filter::{Complementary, DEFAULT_ALPHA, Filter};
use shisei_core::{Quaternion, STANDARD_GRAVITY_M_S2, Vec3};
use shisei_wire::packet::FilterKind;

/// A node's filter: what every tick is fed to.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one, and no allocator")]
pub enum Attitude {
    /// Before the start is done: identity.
    Waiting,
    /// The complementary filter, bias removed before.
    Complementary(Complementary),
    /// The light estimator, which finds bias and start itself.
    Estimator(LightEstimator),
}

impl Attitude {
    /// Begins a filter of this kind.
    pub fn begin(kind: FilterKind, world_from_body: Quaternion) -> Self {
        let begun = match kind {
            FilterKind::Complementary => {
                Complementary::new(world_from_body, DEFAULT_ALPHA, STANDARD_GRAVITY_M_S2)
                    .map(Attitude::Complementary)
            }
            FilterKind::Estimator => LightEstimator::new(&Settings::default()).map(Attitude::Estimator),
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
