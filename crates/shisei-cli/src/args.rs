//! The command line: what can be asked. The Japanese texts are in `args_ja.rs`.

use std::path::PathBuf;

pub use crate::args_measure::{Allan, CalibrationMethod, Earth, Motion, MotionMode, SchemeName};
use clap::{Args, Parser, Subcommand, ValueEnum};

/// Orientation, motion and calibration from accelerometer and gyroscope recordings.
#[derive(Debug, Parser)]
#[command(name = "shisei", version, arg_required_else_help = true, disable_help_subcommand = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    /// Language of messages, help and reports: en or ja (default: the locale's)
    #[arg(long, global = true, display_order = 900, value_name = "LANG", value_parser = ["en", "ja"])]
    pub lang: Option<String>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say what a recording is: columns, units, rate, gaps, rests, and what was assumed
    Info(Info),
    /// Compute orientation: yaw, pitch and roll of a recording, as numbers and as a picture
    Orient(Orient),
    /// Find a sensor's calibration: from rests on six faces, from many poses, or from known turns
    Calibrate(Calibrate),
    /// Apply a calibration to a recording
    Apply(Apply),
    /// Write a recording in shisei's own columns, as CSV or Parquet
    Convert(Convert),
    /// Fill the gaps of an optical take (Motive CSV) from an inertial recording of the same object
    Fuse(crate::args_fuse::Fuse),
    /// Compute velocity and position with an error band: between rests, or walking with the sensor on a foot
    Motion(Motion),
    /// Allan deviation of all axes: noise, bias instability, how long to average
    Allan(Allan),
    /// Measure the Earth's rotation: the day, the latitude, true north
    Earth(Earth),
    /// List serial ports, receivers and their nodes; find, name and set nodes
    Devices(crate::args_live::Devices),
    /// Record what a receiver sends
    Record(crate::args_live::Record),
    /// Show sensors and cameras together, live, in a browser; record, replay and pass on
    Live(crate::args_live::Live),
    /// Simulate what is not at hand
    Simulate(crate::args_live::Simulate),
}

/// Numbers may be negative, so that what is wrong with one can be said, and must be finite.
pub fn with_checked_numbers(command: clap::Command) -> clap::Command {
    let number = std::any::TypeId::of::<f64>();
    command
        .mut_args(|arg| {
            if arg.is_positional() || !arg.get_action().takes_values() || arg.is_allow_hyphen_values_set() {
                return arg;
            }
            let checked = arg.get_value_parser().type_id() == number;
            let arg = arg.allow_negative_numbers(true);
            if checked { arg.value_parser(finite) } else { arg }
        })
        .mut_subcommands(with_checked_numbers)
}

fn finite(text: &str) -> Result<f64, &'static str> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite()).ok_or("a finite number is needed")
}

/// How to read the input where it does not say so itself.
#[derive(Args, Clone, Debug, Default)]
pub struct Reading {
    /// Which column is what: time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z in the file's order ('-' for others), or acc_x=NAME,…
    #[arg(long, value_name = "LIST")]
    pub columns: Option<String>,
    /// Units, where the file does not say them: e.g. acc=g,gyr=deg/s,time=ms
    #[arg(long, value_name = "UNITS")]
    pub units: Option<String>,
    /// Sampling rate in Hz, instead of the time stamps
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
    /// New x, y, z in terms of the recorded axes: e.g. x,-y,-z mends a z-down sensor
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub axes: Option<String>,
    /// Counts per g and per deg/s of raw data, as data sheets print them: e.g. acc=16384,gyr=131
    #[arg(long, value_name = "COUNTS")]
    pub scale: Option<String>,
    /// Leave out rows with missing or unreadable numbers instead of refusing the file
    #[arg(long)]
    pub skip_bad_rows: bool,
    /// Which sensor, where a file holds several
    #[arg(long, value_name = "NAME")]
    pub sensor: Option<String>,
}

/// Whether there is a report, and where it goes.
#[derive(Args, Clone, Debug, Default)]
pub struct Report {
    /// Where the report goes (default: an .html file here, named like the other results)
    #[arg(long = "report", id = "report", value_name = "OUT.html")]
    pub path: Option<PathBuf>,
    /// Write no report
    #[arg(long = "no-report", id = "no_report", conflicts_with = "report")]
    pub none: bool,
}

impl Report {
    /// Where it goes; none where none is wanted.
    pub fn or(&self, usual: impl Into<PathBuf>) -> Option<PathBuf> {
        (!self.none).then(|| self.path.clone().unwrap_or_else(|| usual.into()))
    }
}

#[derive(Args, Debug)]
pub struct Info {
    /// Recordings; - is standard input
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// One JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

/// The filters `orient` can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FilterName {
    Shisei,
    ShiseiOnline,
    Mahony,
    MahonyAdaptive,
    Complementary,
    Gyro,
    GyroRk4,
}

impl FilterName {
    /// As the user writes it.
    pub fn name(self) -> &'static str {
        match self {
            FilterName::Shisei => "shisei",
            FilterName::ShiseiOnline => "shisei-online",
            FilterName::Mahony => "mahony",
            FilterName::MahonyAdaptive => "mahony-adaptive",
            FilterName::Complementary => "complementary",
            FilterName::Gyro => "gyro",
            FilterName::GyroRk4 => "gyro-rk4",
        }
    }
}

/// What yaw, pitch and roll are relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Relative {
    World,
    Body,
    None,
}

#[derive(Args, Debug)]
pub struct Orient {
    /// Recordings or directories of them; - is standard input
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Where the orientation goes, .csv or .parquet (default: NAME.orientation.csv here); a directory for several files; - is standard output
    #[arg(short, long, value_name = "OUT.csv")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// How orientation is estimated: shisei uses the whole recording, shisei-online only what came before; the others are classic
    #[arg(long, value_enum, default_value = "shisei")]
    pub filter: FilterName,
    /// Mahony's proportional gain, 1/s: small trusts the gyroscope, large the accelerometer (default 0.2)
    #[arg(long, value_name = "GAIN")]
    pub kp: Option<f64>,
    /// Mahony's integral gain, 1/s²: learns gyroscope bias; 0 is off (default 0)
    #[arg(long, value_name = "GAIN")]
    pub ki: Option<f64>,
    /// Least gain of mahony-adaptive, 1/s (default 0.05; kp is the greatest, default 2)
    #[arg(long, value_name = "GAIN")]
    pub kp_min: Option<f64>,
    /// Where mahony-adaptive's gain falls, m/s²: lower end, lower start, upper start, upper end (default 4.9,9.3,10.3,14.7)
    #[arg(long, value_name = "LE,LS,US,UE")]
    pub accel_limits: Option<String>,
    /// Share of the gyroscope in the complementary filter, 0 to 1 (default 0.98)
    #[arg(long, value_name = "SHARE")]
    pub alpha: Option<f64>,
    /// Gravity where the recording was made, m/s²
    #[arg(long, value_name = "M/S2", default_value_t = shisei_core::STANDARD_GRAVITY_M_S2)]
    pub gravity: f64,
    /// The rest that gives gyroscope bias and start: auto, START:END in seconds, or none
    #[arg(long, value_name = "auto|START:END|none", default_value = "auto")]
    pub rest: String,
    /// Yaw, pitch and roll relative to the rest in world axes, to the rest in body axes, or as they are
    #[arg(long, value_enum, default_value = "world")]
    pub relative: Relative,
    /// Sensor axis that points forward: laid flat at the start, it becomes world x (±x, ±y, ±z)
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub forward: Option<String>,
    /// Correct the recording with a calibration first
    #[arg(long, value_name = "CAL.json")]
    pub calibration: Option<PathBuf>,
    /// Keep what was learnt of the sensor (with shisei, shisei-online), to give it to --calibration next time
    #[arg(long, value_name = "CAL.json")]
    pub save_calibration: Option<PathBuf>,
    /// Write angles in degrees instead of radians
    #[arg(long)]
    pub degrees: bool,
    /// Keep the input's other columns in the output
    #[arg(long)]
    pub keep: bool,
    #[command(flatten)]
    pub report: Report,
    /// Draw yaw, pitch and roll to a picture as well
    #[arg(long, value_name = "OUT.png")]
    pub plot: Option<PathBuf>,
    /// Overwrite files that shisei did not write
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output: what was done and found
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Calibrate {
    /// A recording with rests of 3 s or more on all six faces, or with many still poses
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Where the calibration goes (default: NAME.calibration.json here); - is standard output
    #[arg(short, long, value_name = "CAL.json")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// How: six-face (bias and scale from rests on six faces), multi-pose (nine parameters from many poses), gyro-turns (the gyroscope's matrix too)
    #[arg(long, value_enum, default_value = "six-face")]
    pub method: CalibrationMethod,
    /// gyro-turns: six faces and one known turn about each axis, of this many degrees; a negative angle is taken with its sign
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub turns: Option<f64>,
    #[command(flatten)]
    pub report: Report,
    /// six-face: length of a rest, s (default 3)
    #[arg(long, value_name = "S")]
    pub window: Option<f64>,
    /// six-face: step of the search, s (default 0.1)
    #[arg(long, value_name = "S")]
    pub step: Option<f64>,
    /// six-face: how far a face may be from level, degrees (default 15)
    #[arg(long, value_name = "DEG")]
    pub max_tilt: Option<f64>,
    /// six-face: largest variance of a rest, (m/s²)² (default 0.01)
    #[arg(long, value_name = "VAR")]
    pub var_threshold: Option<f64>,
    /// Gravity where the recording was made, m/s²
    #[arg(long, value_name = "M/S2", default_value_t = shisei_core::STANDARD_GRAVITY_M_S2)]
    pub gravity: f64,
    /// Name of the sensor, kept in the calibration
    #[arg(long, value_name = "ID")]
    pub sensor_id: Option<String>,
    /// Overwrite a file that shisei did not write
    #[arg(long)]
    pub force: bool,
    /// Print the calibration as JSON on standard output too
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Apply {
    /// A recording
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// The calibration to apply
    #[arg(long, value_name = "CAL.json", required = true)]
    pub calibration: PathBuf,
    /// Where the corrected recording goes, .csv or .parquet; - is standard output
    #[arg(short, long, value_name = "OUT.csv", required = true)]
    pub output: PathBuf,
    #[command(flatten)]
    pub reading: Reading,
    /// Keep the input's other columns in the output
    #[arg(long)]
    pub keep: bool,
    /// Overwrite a file that shisei did not write
    #[arg(long)]
    pub force: bool,
}

#[derive(Args, Debug)]
pub struct Convert {
    /// A recording: one file, or an accelerometer file and a gyroscope file; - is standard input
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Where it goes: .csv or .parquet; - is standard output (CSV)
    #[arg(short, long, value_name = "OUT", required = true)]
    pub output: PathBuf,
    #[command(flatten)]
    pub reading: Reading,
    /// Keep the input's other columns in the output
    #[arg(long)]
    pub keep: bool,
    /// Overwrite a file that shisei did not write
    #[arg(long)]
    pub force: bool,
}
