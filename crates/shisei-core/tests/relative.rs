//! A simulated tool without markers in a filmed hand, against the simulator's truth.

use shisei_core::frames::{Axes, Pose};
use shisei_core::fuse::relative::{Relative, RelativeSettings, relative};
use shisei_core::fuse::{Inertial, Optical, Source};
use shisei_core::{Error, Quaternion, vector};
use shisei_twin::motion::Motion;
use shisei_twin::optics::{Cameras, Frame, Rig, film};
use shisei_twin::simulate::{Errors, Settings, simulate};
use shisei_twin::{Sensor, Simulation, movements};

const GRIP_M: [f64; 3] = [0.05, 0.02, -0.08];

fn y_up(pose: Pose) -> Pose {
    Axes::ZUp.to(Axes::YUp).world_of_pose(pose).expect("right-handed")
}

/// The hand moves in one way, the tool turns in another; the hand is lost for 0.2 s and for 2 s.
fn take() -> (Vec<Frame>, Vec<Quaternion>, Simulation) {
    let (hand, tool) = (movements::wander(5, 3.0, 40.0), movements::wander(6, 3.0, 40.0));
    let rig = Rig { body_from_sensor: Quaternion::IDENTITY, sensor_m: [0.0; 3], markers_m: Vec::new() };
    let cameras = Cameras { lost_s: vec![(9.0, 9.2), (20.0, 22.0)], ..Cameras::new(120.0, 40.0, 5) };
    let frames = film(&hand, &rig, &cameras);
    let turned = frames.iter().map(|frame| {
        let pose = Pose { position_m: [0.0; 3], world_from_body: tool.state(frame.time_s).world_from_body };
        y_up(pose).world_from_body
    });
    let turned = turned.collect();
    let settings = Settings { errors: Errors::DrawnAligned, ..Settings::new(200.0, 6) };
    (frames, turned, simulate(&tool, &Sensor::lsm6ds3tr_c(), &settings))
}

fn placed(frames: &[Frame], simulation: &Simulation, settings: &RelativeSettings) -> Result<Relative, Error> {
    let time_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    let poses: Vec<Option<Pose>> = frames.iter().map(|frame| frame.pose.map(y_up)).collect();
    let (sensor_s, acc, gyro) = (simulation.time_s(), simulation.acc_m_s2(), simulation.gyro_rad_s());
    relative(
        &Optical { time_s: &time_s, poses: &poses },
        &Inertial { time_s: &sensor_s, acc_m_s2: &acc, gyro_rad_s: &gyro },
        settings,
    )
}

#[test]
fn a_tool_in_a_hand_is_placed_and_turned() {
    let (frames, tool, simulation) = take();
    let reference = 360;
    let holder = frames[reference].pose.map(y_up).expect("seen");
    let grip = holder.world_from_body.conjugate().product(tool[reference]);
    let settings =
        RelativeSettings { grip_m: GRIP_M, grip, reference: Some(reference), ..RelativeSettings::default() };
    let found = placed(&frames, &simulation, &settings).expect("both are there");
    assert_eq!(found.reference, reference);
    let (mut squares, mut count, mut inside) = (0.0, 0.0, 0.0);
    for (row, frame) in found.frames.iter().enumerate() {
        let time_s = frames[row].time_s;
        if (20.0..22.0).contains(&time_s) {
            assert_eq!((frame.source, frame.pose), (Source::None, None), "{time_s}");
            continue;
        }
        let Some(pose) = frame.pose else { panic!("no pose at {time_s} s") };
        assert_eq!(frame.source, Source::Inertial);
        let truth = y_up(frames[row].truth);
        let place = vector::add(truth.position_m, truth.world_from_body.rotate(GRIP_M));
        let off_m = vector::norm(vector::sub(pose.position_m, place));
        // the cameras' noise; in the short gap a straight line
        assert!(off_m < if frames[row].pose.is_some() { 1e-3 } else { 0.02 }, "{time_s} s: {off_m} m");
        let off = pose.world_from_body.conjugate().product(tool[row]).angle();
        squares += off * off;
        count += 1.0;
        inside += f64::from(off < 2.0 * frame.sigma_rad);
    }
    let rms_deg = (squares / count).sqrt().to_degrees();
    println!(
        "attitude over 40 s: {rms_deg:.2} degrees RMS, {:.0} % within two sigma",
        100.0 * inside / count
    );
    assert!(rms_deg < 1.5 && inside / count > 0.8, "{rms_deg} {}", inside / count);
    let at = found.frames[reference].pose.expect("there").world_from_body;
    assert!(at.conjugate().product(tool[reference]).angle() < 1e-9);
    assert_eq!(found.gaps.len(), 2);
    assert_eq!((found.gaps[0].source, found.gaps[1].source), (Source::Inertial, Source::None));
}

#[test]
fn what_cannot_be_placed_is_refused() {
    let (mut frames, _, simulation) = take();
    let default = RelativeSettings::default();
    let lost = RelativeSettings { reference: Some(2500), ..default };
    assert!(matches!(placed(&frames, &simulation, &lost), Err(Error::NoReference { silent: false })));
    let beyond = RelativeSettings { reference: Some(1 << 40), ..default };
    assert!(matches!(placed(&frames, &simulation, &beyond), Err(Error::OutOfRange { .. })));
    let weightless = RelativeSettings { gravity_m_s2: 0.0, ..default };
    assert!(placed(&frames, &simulation, &weightless).is_err());
    let nowhere = RelativeSettings { grip_m: [f64::NAN; 3], ..default };
    assert!(placed(&frames, &simulation, &nowhere).is_err());
    for frame in &mut frames {
        frame.pose = None;
    }
    assert!(matches!(placed(&frames, &simulation, &default), Err(Error::TooFewPoints { .. })));
}
