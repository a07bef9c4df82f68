//! `shisei._native`: NumPy arrays in, NumPy arrays out. No formula lives here, and no documentation for users:
//! the Python package in `python/shisei` wraps every function with keyword names, units and checks.
//!
//! C-contiguous float64 arrays are borrowed, never copied; results are handed over without a copy; the GIL is
//! released while the core works.
#![allow(unsafe_code)] // PyO3's macros

mod arrays;
mod calibration;
mod errors;
mod estimator;
mod filters;
mod fuse;
mod measure;
mod rotations;
mod sheet;
mod threads;

use pyo3::prelude::*;

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", shisei_functions::VERSION)?;
    errors::register(module)?;
    module.add_function(wrap_pyfunction!(sheet::functions, module)?)?;
    module.add_function(wrap_pyfunction!(sheet::call, module)?)?;
    module.add_function(wrap_pyfunction!(filters::run_filter, module)?)?;
    module.add_function(wrap_pyfunction!(filters::run_mahony_many, module)?)?;
    module.add_function(wrap_pyfunction!(filters::orient, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::normalize, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::to_ypr, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::from_ypr, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::relative, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::from_axis_angle, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::initial_attitude, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::slerp, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::multiply, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::rotate, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::to_matrix, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::from_matrix, module)?)?;
    module.add_function(wrap_pyfunction!(rotations::to_rotation_vector, module)?)?;
    module.add_function(wrap_pyfunction!(filters::ypr_rad, module)?)?;
    module.add_function(wrap_pyfunction!(filters::dead_reckon, module)?)?;
    module.add_function(wrap_pyfunction!(calibration::six_face, module)?)?;
    module.add_function(wrap_pyfunction!(calibration::apply, module)?)?;
    module.add_function(wrap_pyfunction!(calibration::check_calibration, module)?)?;
    module.add_function(wrap_pyfunction!(filters::doubts, module)?)?;
    module.add_function(wrap_pyfunction!(filters::doubts_of_attitudes, module)?)?;
    module.add_function(wrap_pyfunction!(calibration::multi_pose, module)?)?;
    module.add_function(wrap_pyfunction!(calibration::known_turns, module)?)?;
    module.add_function(wrap_pyfunction!(measure::mean_rate, module)?)?;
    module.add_function(wrap_pyfunction!(measure::allan_deviation, module)?)?;
    module.add_function(wrap_pyfunction!(measure::fit_sphere, module)?)?;
    module.add_function(wrap_pyfunction!(measure::earth_rate, module)?)?;
    module.add_function(wrap_pyfunction!(measure::navigate, module)?)?;
    module.add_function(wrap_pyfunction!(fuse::read_motive, module)?)?;
    module.add_function(wrap_pyfunction!(fuse::read_recording, module)?)?;
    module.add_function(wrap_pyfunction!(fuse::fuse, module)?)?;
    module.add_class::<filters::MahonyFilter>()?;
    module.add_function(wrap_pyfunction!(estimator::estimate, module)?)?;
    module.add_class::<estimator::EstimatorFilter>()?;
    module.add_class::<estimator::FixedLagFilter>()?;
    Ok(())
}
