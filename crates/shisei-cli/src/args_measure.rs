//! The command line of `motion`, `allan` and `earth`, and the methods of `calibrate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::args::{Reading, Report};

/// How `calibrate` works.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CalibrationMethod {
    SixFace,
    MultiPose,
    GyroTurns,
}

/// How `motion` works.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MotionMode {
    RestToRest,
    Foot,
    Naive,
}

/// Order of the naive integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemeName {
    SemiImplicit,
    Euler,
    Trapezoid,
}

#[allow(clippy::struct_excessive_bools)] // each is a switch of the command line
#[derive(Args, Debug)]
pub struct Motion {
    /// A recording that begins (and for rest-to-rest ends) at rest
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Where the motion goes (default: NAME.motion.csv here); - is standard output
    #[arg(short, long, value_name = "OUT.csv")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// How: rest-to-rest, foot (walking with the sensor on a foot), or naive (step by step, nothing corrected)
    #[arg(long, value_enum, default_value = "rest-to-rest")]
    pub mode: MotionMode,
    /// With --mode naive: order of the integration (default: semi-implicit)
    #[arg(long, value_enum)]
    pub scheme: Option<SchemeName>,
    /// Where the movement ends, m, where that is known (rest-to-rest and foot)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub end: Option<String>,
    /// The movement ends where it began (rest-to-rest and foot)
    #[arg(long, conflicts_with = "end")]
    pub closed: bool,
    /// Gravity where the recording was made, m/s²
    #[arg(long, value_name = "M/S2", default_value_t = shisei_core::STANDARD_GRAVITY_M_S2)]
    pub gravity: f64,
    /// Correct the recording with a calibration first
    #[arg(long, value_name = "CAL.json")]
    pub calibration: Option<PathBuf>,
    #[command(flatten)]
    pub report: Report,
    /// Overwrite files that shisei did not write, and go on where position can hardly be trusted: too long without a
    /// rest, long holes in the samples, an end that contradicts the readings
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Allan {
    /// A recording of a sensor that does not move; the longer the better
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Where the curves go as a table (default: NAME.allan.csv here); - is standard output
    #[arg(short, long, value_name = "OUT.csv")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub report: Report,
    /// Overwrite files that shisei did not write
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Earth {
    /// Recordings, one a direction, or one table of mean rates (gyr_x,gyr_y,gyr_z in rad/s, optionally acc_x … and heading_deg)
    #[arg(value_name = "FILE", required_unless_present = "serial")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// Latitude of the place, degrees, north positive
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub latitude: Option<f64>,
    /// Heading of each direction, degrees clockwise from above, e.g. 0,90,180,270 (default: from names like _090deg)
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub headings: Option<String>,
    /// What a sample after a gap weighs: capped (one usual step) or article (its whole step, as printed)
    #[arg(long, value_name = "RULE", value_parser = ["capped", "article"], default_value = "capped")]
    pub weights: String,
    /// Measure now: the serial port of a Spresense with apps/spresense/earth_rate
    #[arg(long, value_name = "PORT", conflicts_with = "files")]
    pub serial: Option<String>,
    /// With --serial: speed of the port (default 115200)
    #[arg(long, value_name = "BAUD")]
    pub baud: Option<u32>,
    /// With --serial: how many directions (default 8)
    #[arg(long, value_name = "N")]
    pub directions: Option<usize>,
    /// With --serial: seconds a direction (default 65)
    #[arg(long, value_name = "S")]
    pub seconds: Option<u32>,
    /// With --serial: where the directions go as a table (default: directions.csv here)
    #[arg(short, long, value_name = "OUT.csv")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub report: Report,
    /// Overwrite files that shisei did not write
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output
    #[arg(long)]
    pub json: bool,
}
