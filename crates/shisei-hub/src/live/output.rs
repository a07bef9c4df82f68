//! Where poses go besides the viewer.

use std::fmt::Debug;

use super::scene::Scene;

/// Something that passes poses on. It is called in the hub's thread and must not wait.
pub trait Output: Debug + Send {
    /// What users call it.
    fn name(&self) -> String;
    /// How many listen, as far as it knows.
    fn clients(&self) -> usize;
    /// What there is has changed.
    fn scene(&mut self, scene: &Scene);
    /// Where it is now; number and exposure time of the cameras' newest frame, s.
    fn poses(&mut self, scene: &Scene, frame: Option<i64>, exposure_s: f64);
}
