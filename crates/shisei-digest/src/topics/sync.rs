//! Two clocks on one body.

use alloc::vec::Vec;

use shisei_core::alignment::Alignment;
use shisei_core::estimator::Sample;
use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::delayed::{Delayed, DelayedSettings};
use shisei_core::fuse::relative::{self, RelativeSettings};
use shisei_core::fuse::{self, FuseSettings, FusedFrame, Inertial, Optical, Source};
use shisei_core::sync::fourier::{Complex, Fourier};
use shisei_core::sync::gyro_path::{GyroPath, Stamp};
use shisei_core::sync::rates::{RatesSettings, Start, Sync};
use shisei_core::sync::wahba::{Pairs, nearest_rotation};
use shisei_core::sync::{correlate, fourier, lever, rates};
use shisei_core::{Quaternion, Vec3, vector};

use crate::hash::Digest;
use crate::input::Input;

pub fn fourier(digest: &mut Digest) {
    let mut input = Input::new(80);
    let mut x: Vec<Complex> = (0..256).map(|_| [input.signed(), input.signed()]).collect();
    digest.push_all(&fourier::times(x[0], x[1]));
    let transform = Fourier::new(200);
    digest.push_result(transform, |digest, transform| {
        digest.push_u64(transform.len() as u64 + u64::from(transform.is_empty()));
        digest.push_result(transform.forward(&mut x), |_, ()| ());
        digest.push_all(x.as_flattened());
        digest.push_result(transform.inverse(&mut x), |_, ()| ());
        digest.push_all(x.as_flattened());
    });
}

pub fn correlate(digest: &mut Digest) {
    let mut input = Input::new(81);
    let mut y: Vec<f64> = (0..300).map(|_| input.signed()).collect();
    let mut x = y[80..200].to_vec();
    x[10..30].fill(f64::NAN);
    y[100] = f64::NAN;
    digest.push_result(correlate::peaks(&x, &y, 20, 4, 5), |digest, peaks| {
        for peak in peaks {
            digest.push_u64(peak.lag as u64);
            digest.push(peak.correlation);
        }
    });
}

pub fn wahba(digest: &mut Digest) {
    let mut input = Input::new(82);
    let mut pairs = Pairs::default();
    for _ in 0..20 {
        pairs.add(input.vec3(1.0), input.vec3(1.0), 0.5);
        digest.push(pairs.ratio());
        digest.push_result(pairs.rotation(), Digest::push_quaternion);
        digest.push_quaternion(nearest_rotation(&pairs.b_a));
    }
}

pub fn alignment(digest: &mut Digest) {
    let mut input = Input::new(85);
    for _ in 0..20 {
        let row = |input: &mut Input| vector::add([1.0, 0.0, 0.0], input.vec3(0.02));
        let alignment = Alignment {
            body_from_sensor: input.quaternion(),
            sensor_m: input.vec3(0.1),
            gyro_bias_rad_s: input.vec3(0.02),
            gyro_matrix: [row(&mut input), row(&mut input), row(&mut input)],
            acc_bias_m_s2: input.vec3(0.2),
            up: input.quaternion().rotate([0.0, 0.0, 1.0]),
            ..Alignment::default()
        };
        let pose = Pose { position_m: input.vec3(2.0), world_from_body: input.quaternion() };
        let sensor = alignment.sensor(&pose);
        digest.push_quaternion(sensor.world_from_body);
        digest.push_vec3(sensor.position_m);
        let body = alignment.body(&sensor);
        digest.push_quaternion(body.world_from_body);
        digest.push_vec3(body.position_m);
        digest.push_vec3(alignment.rate(input.vec3(3.0)));
        digest.push_vec3(alignment.force(input.vec3(9.0)));
    }
}

/// A sensor turned to and fro about three axes, with a hole; and the attitudes that cameras see.
struct Filmed {
    sensor_s: Vec<f64>,
    gyro: Vec<Vec3>,
    acc: Vec<Vec3>,
    optical_s: Vec<f64>,
    poses: Vec<Option<Pose>>,
}

fn filmed() -> Filmed {
    let mut input = Input::new(83);
    let mut made = Filmed {
        sensor_s: Vec::new(),
        gyro: Vec::new(),
        acc: Vec::new(),
        optical_s: Vec::new(),
        poses: Vec::new(),
    };
    let (mut q, mut rate) = (Quaternion::IDENTITY, [0.0; 3]);
    for k in 0..1600 {
        let push = input.vec3(0.6);
        rate = vector::add(vector::scale(rate, 0.97), push);
        q = q.product(Quaternion::from_rotation_vector(vector::scale(rate, 0.01))).normalized();
        let time_s = f64::from(k) * 0.01;
        made.sensor_s.push(time_s);
        made.gyro.push(vector::add(rate, [0.02, -0.01, 0.03]));
        made.acc.push(vector::scale(q.up_body(), 9.8));
        if (200..1500).contains(&k) {
            made.optical_s.push(time_s - 2.0);
            let seen = k % 100 > 4;
            let position_m = input.vec3(1e-4);
            made.poses.push(seen.then_some(Pose { position_m, world_from_body: q }));
        }
    }
    made
}

pub fn gyro_path(digest: &mut Digest) {
    let made = filmed();
    for stamp in [Stamp::End, Stamp::Instant] {
        digest.push_result(GyroPath::new(&made.sensor_s, &made.gyro, stamp), |digest, path| {
            digest.push(path.step_s());
            digest.push_all(&[path.span_s().0, path.span_s().1]);
            for k in 0..40 {
                let from_s = f64::from(k) * 0.313;
                digest.push_vec3(path.turn(from_s, from_s + 0.217).unwrap_or([f64::NAN; 3]));
            }
        });
    }
}

pub fn rates(digest: &mut Digest) {
    let made = filmed();
    let attitude: Vec<Option<Quaternion>> =
        made.poses.iter().map(|pose| pose.map(|pose| pose.world_from_body)).collect();
    for start in [Start::Search, Start::Near(2.03)] {
        let settings = RatesSettings { start, ..RatesSettings::default() };
        let found = rates::synchronise(&made.optical_s, &attitude, &made.sensor_s, &made.gyro, &settings);
        digest.push_result(found, |digest, sync| push_sync(digest, &sync));
    }
}

fn push_sync(digest: &mut Digest, sync: &Sync) {
    digest.push_all(&[sync.offset_s, sync.skew, sync.middle_s, sync.sigma_offset_s, sync.sigma_skew]);
    digest.push_quaternion(sync.body_from_sensor);
    digest.push_vec3(sync.sigma_mounting_rad);
    digest.push_vec3(sync.gyro_bias_rad_s);
    digest.push_all(sync.gyro_matrix.as_flattened());
    digest.push_all(&[sync.residual_rad_s, sync.explained, sync.runner_up, sync.axis_ratio]);
    digest.push_all(&[sync.sensor_time_s(3.0), sync.optical_time_s(5.0), sync.sigma_time_s(1.0)]);
    digest.push_u64(sync.turns as u64);
}

pub fn lever(digest: &mut Digest) {
    let made = filmed();
    let on_optical_clock: Vec<f64> = made.sensor_s.iter().map(|time_s| time_s - 2.0).collect();
    let mounting = Quaternion::IDENTITY;
    let found = lever::lever_arm(&made.optical_s, &made.poses, &on_optical_clock, &made.acc, mounting, 9.8);
    digest.push_result(found, |digest, lever| {
        digest.push_vec3(lever.sensor_m);
        digest.push_vec3(lever.sigma_m);
        digest.push_vec3(lever.acc_bias_m_s2);
        digest.push_vec3(lever.up);
        digest.push_all(&[lever.sigma_up_rad, lever.gravity_m_s2, lever.residual_m_s2]);
    });
}

pub fn fuse(digest: &mut Digest) {
    for source in [Source::Optical, Source::Bridged, Source::Inertial, Source::None] {
        digest.push_bytes(source.name().as_bytes());
    }
    // Three seconds: a whole take needs more memory than the emulated board has. What fusion is made of, sync
    // and bridging, has topics of its own.
    let made = filmed();
    let (frames, samples) = (made.optical_s.len().min(100), made.sensor_s.len().min(300));
    let optical = Optical { time_s: &made.optical_s[..frames], poses: &made.poses[..frames] };
    let inertial = Inertial {
        time_s: &made.sensor_s[..samples],
        acc_m_s2: &made.acc[..samples],
        gyro_rad_s: &made.gyro[..samples],
    };
    let settings = FuseSettings { axes: Axes::ZUp, ..FuseSettings::default() };
    digest.push_result(fuse::fuse(&optical, &inertial, &settings), |digest, fusion| {
        push_sync(digest, &fusion.sync);
        digest.push_vec3(fusion.up);
        push_frames(digest, &fusion.frames);
        for gap in &fusion.gaps {
            digest.push_all(&[gap.length_s, gap.sigma_rad, gap.sigma_m]);
        }
    });
}

fn push_frames(digest: &mut Digest, frames: &[FusedFrame]) {
    for frame in frames {
        digest.push_bytes(frame.source.name().as_bytes());
        digest.push_all(&[frame.gap_s, frame.sigma_rad, frame.sigma_m]);
        if let Some(pose) = frame.pose {
            digest.push_vec3(pose.position_m);
            digest.push_quaternion(pose.world_from_body);
        }
    }
}

pub fn relative(digest: &mut Digest) {
    // three seconds, as above; a second of the sensor before the first frame
    let made = filmed();
    let optical = Optical { time_s: &made.optical_s[..150], poses: &made.poses[..150] };
    let sensor_s: Vec<f64> = made.sensor_s.iter().map(|time_s| time_s - 2.0).collect();
    let rows = 100..320;
    let inertial = Inertial {
        time_s: &sensor_s[rows.clone()],
        acc_m_s2: &made.acc[rows.clone()],
        gyro_rad_s: &made.gyro[rows],
    };
    let settings = RelativeSettings {
        grip_m: [0.05, -0.02, 0.1],
        grip: Quaternion::from_rotation_vector([0.2, -0.1, 1.0]),
        axes: Axes::ZUp,
        ..RelativeSettings::default()
    };
    digest.push_result(relative::relative(&optical, &inertial, &settings), |digest, found| {
        push_frames(digest, &found.frames);
        digest.push_u64(found.reference as u64);
        digest.push(found.tilt_off_rad);
        for gap in &found.gaps {
            digest.push_all(&[gap.length_s, gap.sigma_rad, gap.sigma_m]);
        }
    });
}

pub fn delayed(digest: &mut Digest) {
    let made = filmed();
    let settings = DelayedSettings { lag_s: 0.3, ..DelayedSettings::default() };
    digest.push_result(Delayed::new(&Alignment::default(), &settings), |digest, mut delayed| {
        let mut rows = Vec::new();
        for row in 0..250 {
            let sample = Sample { gyro_rad_s: made.gyro[row], acc_m_s2: made.acc[row], dt_s: 0.01 };
            // a gap that is shorter than the lag, and one that is longer
            let hidden = (60..80).contains(&row) || (130..200).contains(&row);
            let pose = made.poses[row].filter(|_| !hidden);
            delayed.update(made.sensor_s[row], &sample, pose.as_ref(), &mut rows);
        }
        delayed.finish(&mut rows);
        for (time_s, frame) in &rows {
            digest.push(*time_s);
            push_frames(digest, &[*frame]);
        }
    });
}
