//! The topics: a file of the core each. What is added to the core is added here.

mod calibration;
mod clock;
mod earth;
mod estimator;
mod filters;
mod fits;
mod motion;
mod navigation;
mod rest;
mod rotation;
mod sync;

use crate::hash::Digest;

/// A part of the core and the run over it.
#[derive(Clone, Copy, Debug)]
pub struct Topic {
    /// The file of the core, from its src and without its ending: `filter/mahony`.
    pub name: &'static str,
    run: fn(&mut Digest),
}

impl Topic {
    /// Its 64 bits.
    pub fn digest(&self) -> u64 {
        self.run().value()
    }

    /// Runs it.
    pub fn run(&self) -> Digest {
        let mut digest = Digest::new();
        (self.run)(&mut digest);
        digest
    }
}

/// In a fixed order: the whole digest depends on it.
pub const TOPICS: &[Topic] = &[
    Topic { name: "math", run: rotation::math },
    Topic { name: "vector", run: rotation::vector },
    Topic { name: "quaternion", run: rotation::quaternion },
    Topic { name: "euler", run: rotation::euler },
    Topic { name: "relative", run: rotation::relative },
    Topic { name: "heading", run: rotation::heading },
    Topic { name: "frames", run: rotation::frames },
    Topic { name: "filter/exponential", run: filters::exponential },
    Topic { name: "filter/gyro", run: filters::gyro },
    Topic { name: "filter/mahony", run: filters::mahony },
    Topic { name: "filter/mahony_lanes", run: filters::mahony_lanes },
    Topic { name: "filter/mahony_adaptive", run: filters::mahony_adaptive },
    Topic { name: "filter/complementary", run: filters::complementary },
    Topic { name: "rest", run: rest::rest },
    Topic { name: "rest/search", run: rest::search },
    Topic { name: "initial", run: rest::initial },
    Topic { name: "statistics", run: fits::statistics },
    Topic { name: "least_squares", run: fits::least_squares },
    Topic { name: "matrix", run: fits::matrix },
    Topic { name: "sphere", run: fits::sphere },
    Topic { name: "allan", run: fits::allan },
    Topic { name: "calibration/apply", run: calibration::apply },
    Topic { name: "calibration/sensor_model", run: calibration::sensor_model },
    Topic { name: "calibration/search", run: calibration::search },
    Topic { name: "calibration/six_face", run: calibration::six_face },
    Topic { name: "calibration/still", run: calibration::still },
    Topic { name: "calibration/multi_pose", run: calibration::multi_pose },
    Topic { name: "calibration/recording", run: calibration::recording },
    Topic { name: "calibration/gyro_turns", run: calibration::gyro_turns },
    Topic { name: "calibration/known_turns", run: calibration::known_turns },
    Topic { name: "orient", run: motion::orient },
    Topic { name: "motion/dead_reckoning", run: motion::dead_reckoning },
    Topic { name: "motion/error_state", run: navigation::error_state },
    Topic { name: "motion/navigation", run: navigation::navigate },
    Topic { name: "motion/navigation/given_end", run: navigation::given_end },
    Topic { name: "motion/holes", run: navigation::holes },
    Topic { name: "motion/rest_to_rest", run: navigation::rest_to_rest },
    Topic { name: "motion/step_by_step", run: navigation::step_by_step },
    Topic { name: "earth", run: motion::earth },
    Topic { name: "earth/mean", run: motion::earth_mean },
    Topic { name: "estimator/online", run: estimator::online },
    Topic { name: "estimator/light", run: estimator::light },
    Topic { name: "estimator/lag", run: estimator::lag },
    Topic { name: "estimator/calibration", run: estimator::calibration },
    Topic { name: "estimator/smoother", run: estimator::smoother },
    Topic { name: "estimator/bridge", run: estimator::bridged },
    Topic { name: "estimator/live_bridge", run: estimator::live_bridge },
    Topic { name: "estimator/lag_bridge", run: estimator::lag_bridge },
    Topic { name: "earth/direction", run: earth::direction },
    Topic { name: "earth/fits", run: earth::all_fits },
    Topic { name: "earth/analysis", run: earth::analyse },
    Topic { name: "earth/advice", run: earth::advise },
    Topic { name: "motion/foot", run: earth::foot },
    Topic { name: "sync/fourier", run: sync::fourier },
    Topic { name: "sync/correlate", run: sync::correlate },
    Topic { name: "sync/wahba", run: sync::wahba },
    Topic { name: "sync/gyro_path", run: sync::gyro_path },
    Topic { name: "sync/rates", run: sync::rates },
    Topic { name: "sync/lever", run: sync::lever },
    Topic { name: "clock/fit", run: clock::fit },
    Topic { name: "clock/frames", run: clock::frames },
    Topic { name: "clock/unwrap", run: clock::unwrap },
    Topic { name: "alignment", run: sync::alignment },
    Topic { name: "fuse", run: sync::fuse },
    Topic { name: "fuse/relative", run: sync::relative },
    Topic { name: "fuse/delayed", run: sync::delayed },
];
