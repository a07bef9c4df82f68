//! What `shisei fuse` can be asked. The Japanese texts are in `args_ja.rs`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::args::Report;

/// How the two clocks are brought together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SyncName {
    Rates,
    Sequence,
    PulseFile,
}

/// What the sensor is fixed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModeName {
    Bridge,
    Relative,
}

/// Where and how a tool is held: m in the parent's axes, and degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    pub at_m: [f64; 3],
    pub ypr_deg: [f64; 3],
}

fn grip(text: &str) -> Result<Grip, String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Grip { at_m: [x, y, z], ypr_deg: [0.0; 3] }),
        Some(&[x, y, z, yaw, pitch, roll]) => Ok(Grip { at_m: [x, y, z], ypr_deg: [yaw, pitch, roll] }),
        _ => Err("X,Y,Z in m, or X,Y,Z,YAW,PITCH,ROLL in m and degrees".to_owned()),
    }
}

#[derive(Args, Debug)]
pub struct Fuse {
    /// The take: Motive's tracking CSV
    #[arg(value_name = "OPTICAL.csv")]
    pub optical: PathBuf,
    /// The inertial recording of the same object (two files where accelerometer and gyroscope are apart)
    #[arg(required = true, value_name = "IMU.csv")]
    pub imu: Vec<PathBuf>,
    /// Where the fused take goes, by its ending: .csv, .parquet, .sto, .mot, .glb, .mcap; may be given several times (default: NAME.fused.csv here)
    #[arg(short, long = "output", value_name = "OUT", id = "fused")]
    pub outputs: Vec<PathBuf>,
    /// Write the take with its gaps filled as Motive's CSV too
    #[arg(long, value_name = "OUT.csv")]
    pub motive: Option<PathBuf>,
    /// Which rigid body, or SKELETON:BONE, the sensor is fixed to, where the take has several
    #[arg(long, value_name = "NAME")]
    pub body: Option<String>,
    /// bridge: the sensor is on the body, whose gaps it fills; relative: it is on a tool without markers that a body or bone (--parent) holds
    #[arg(long = "mode", id = "fuse_mode", value_enum, default_value = "bridge", value_name = "MODE")]
    pub mode: ModeName,
    /// With --mode relative: what holds the tool, a rigid body or SKELETON:BONE
    #[arg(long, value_name = "NAME", conflicts_with = "body")]
    pub parent: Option<String>,
    /// With --mode relative: where the tool is in the parent's axes (m), and how its sensor is turned there at the reference frame (yaw, pitch, roll in degrees)
    #[arg(long, value_name = "X,Y,Z[,YAW,PITCH,ROLL]", value_parser = grip, allow_hyphen_values = true)]
    pub grip: Option<Grip>,
    /// With --mode relative: the frame at which the tool is held as --grip says (default: the first with both)
    #[arg(long, value_name = "FRAME")]
    pub reference: Option<i64>,
    /// How the clocks are brought together: by the rotation rates, by the receiver's frame sequence (column frame), or by a file of camera pulses (--pulses)
    #[arg(long, value_enum, default_value = "rates")]
    pub sync: SyncName,
    /// With --sync pulse-file: the time of each camera pulse on the recording's clock in seconds, one a row, from frame 0 on
    #[arg(long, value_name = "FILE")]
    pub pulses: Option<PathBuf>,
    /// World of the results: z-up, y-up or unity (default: the take's)
    #[arg(long = "axes", id = "world", value_name = "WORLD", value_parser = ["z-up", "y-up", "unity"])]
    pub axes: Option<String>,
    /// A pose repeated bit for bit so often counts as lost; 0 leaves such poses alone
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub frozen: usize,
    /// Gravity where the recording was made, m/s²
    #[arg(long, value_name = "M/S2", default_value_t = shisei_core::STANDARD_GRAVITY_M_S2)]
    pub gravity: f64,
    /// Which column of the inertial recording is what: time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z in the file's order ('-' for others), or acc_x=NAME,…
    #[arg(long, value_name = "LIST")]
    pub columns: Option<String>,
    /// Its units, where the file does not say them: e.g. acc=g,gyr=deg/s,time=ms
    #[arg(long, value_name = "UNITS")]
    pub units: Option<String>,
    /// Its sampling rate in Hz, instead of the time stamps
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
    /// Which sensor, where the file holds several
    #[arg(long, value_name = "NAME")]
    pub sensor: Option<String>,
    #[command(flatten)]
    pub report: Report,
    /// Overwrite files that shisei did not write
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output: what was done and found
    #[arg(long)]
    pub json: bool,
}
