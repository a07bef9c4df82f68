//! Position between rests: the error state, the navigator, whole recordings.

use alloc::boxed::Box;

use shisei_core::filter::Dt;
use shisei_core::motion::error_state::{self, Adjoint, Covariance, ProcessNoise, STATES, Step};
use shisei_core::motion::navigation::{self, NavigationSettings, Phase, Track};
use shisei_core::motion::rest_to_rest::{self, RestToRestSettings};
use shisei_core::motion::step_by_step::{self, StepByStepSettings};

use crate::hash::Digest;
use crate::input::{Input, Recording, recording};

pub fn error_state(digest: &mut Digest) {
    let mut input = Input::new(70);
    let noise =
        ProcessNoise { acc_density: 1e-3, gyro_density: 1e-4, acc_bias_walk: 1e-4, gyro_bias_walk: 1e-5 };
    let mut covariance: Box<Covariance> = Box::new([[0.0; STATES]; STATES]);
    for i in 0..STATES {
        covariance[i][i] = 0.01;
    }
    let mut adjoint = Box::new(Adjoint::default());
    for _ in 0..12 {
        let step = Step {
            rotation: input.quaternion().to_matrix(),
            acc_body: input.vec3(10.0),
            rate_body: input.vec3(3.0),
            dt_s: 0.01,
        };
        error_state::propagate(&mut covariance, &step, &noise);
        let h = core::array::from_fn(|i| if i % 5 == 0 { input.signed() } else { 0.0 });
        let update = error_state::update(&mut covariance, &h, input.signed(), 0.01);
        digest.push_all(&update.gain);
        digest.push(update.variance);
        adjoint.back_over_update(&update);
        adjoint.back_over_step(&step);
    }
    digest.push_all(covariance.as_flattened());
    digest.push_all(&adjoint.vector);
    digest.push_all(adjoint.matrix.as_flattened());
}

/// A hole in the movement, and a sample that is no reading.
pub fn holes(digest: &mut Digest) {
    let mut made = short_movement();
    made.dt_s[230] = 0.2;
    made.acc_m_s2[220] = [1e6, 0.0, 0.0];
    let settings = RestToRestSettings::default();
    let dt = Dt::PerSample(&made.dt_s);
    let found = rest_to_rest::rest_to_rest(&made.acc_m_s2, &made.gyro_rad_s, dt, &settings);
    digest.push_result(found, |digest, track| {
        push_track(digest, &track);
        digest.push_u64(track.passed_over as u64);
        for hole in &track.holes {
            digest.push_u64(hole.row as u64);
            digest.push(hole.length_s);
        }
    });
}

pub fn given_end(digest: &mut Digest) {
    let made = short_movement();
    let dt = Dt::PerSample(&made.dt_s);
    let navigation = NavigationSettings {
        end: Some(([0.1, 0.2, 0.0], 0.01)),
        max_end_distance: f64::INFINITY,
        ..RestToRestSettings::default().navigation
    };
    let settings = RestToRestSettings { navigation, ..RestToRestSettings::default() };
    let found = rest_to_rest::rest_to_rest(&made.acc_m_s2, &made.gyro_rad_s, dt, &settings);
    digest.push_result(found, |digest, track| {
        if let Some(end) = track.given_end {
            [end.off_m, end.sigma_m, end.distance].into_iter().for_each(|value| digest.push(value));
        }
    });
}

pub fn navigate(digest: &mut Digest) {
    let Recording { gyro_rad_s, acc_m_s2, mut dt_s } = recording(71, 260);
    let mut phases = [Phase::Moving; 260];
    phases[..192].fill(Phase::Rest);
    phases[215..225].fill(Phase::Stance);
    let dt = Dt::PerSample(&dt_s);
    digest.push(navigation::longest_without_rest_s(&phases, dt));
    let settings = NavigationSettings {
        end: Some(([0.1, 0.2, 0.0], 0.01)),
        max_end_distance: f64::INFINITY,
        max_hole_s: f64::INFINITY,
        ..NavigationSettings::default()
    };
    dt_s[230] = 0.2;
    let dt = Dt::PerSample(&dt_s);
    let found = navigation::navigate(&acc_m_s2, &gyro_rad_s, dt, &phases, &settings);
    digest.push_result(found, |digest, track| push_track(digest, &track));
}

/// The movement is cut short: 60 of its 320 rows.
fn short_movement() -> Recording {
    let mut made = recording(72, 700);
    for column in [&mut made.gyro_rad_s, &mut made.acc_m_s2] {
        column.drain(252..512);
    }
    made.dt_s.drain(252..512);
    made
}

pub fn rest_to_rest(digest: &mut Digest) {
    let made = short_movement();
    let settings = RestToRestSettings::default();
    let dt = Dt::PerSample(&made.dt_s);
    let found = rest_to_rest::rest_to_rest(&made.acc_m_s2, &made.gyro_rad_s, dt, &settings);
    digest.push_result(found, |digest, track| push_track(digest, &track));
}

pub fn step_by_step(digest: &mut Digest) {
    let made = short_movement();
    let (settings, dt) = (StepByStepSettings::default(), Dt::PerSample(&made.dt_s));
    let found = step_by_step::step_by_step(&made.acc_m_s2, &made.gyro_rad_s, dt, &settings);
    digest.push_result(found, |digest, track| push_track(digest, &track));
}

pub fn push_track(digest: &mut Digest, track: &Track) {
    for row in 0..track.position_m.len() {
        digest.push_quaternion(track.world_from_body[row]);
        digest.push_vec3(track.velocity_m_s[row]);
        digest.push_vec3(track.position_m[row]);
        digest.push_vec3(track.sigma_position_m[row]);
        digest.push(track.sigma_total_m(row));
    }
    digest.push_vec3(track.gyro_bias_rad_s);
    digest.push_vec3(track.acc_bias_m_s2);
    digest.push(track.longest_without_rest_s);
}
