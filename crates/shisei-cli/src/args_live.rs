//! The command line of `devices`, `record`, `live` and `simulate`.

use std::net::Ipv4Addr;
use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

#[derive(Args, Debug)]
pub struct Devices {
    /// Serial ports to ask; without any, receivers are looked for on USB
    #[arg(value_name = "PORT")]
    pub ports: Vec<String>,
    /// Let a node blink for ten seconds: its number, or all
    #[arg(long, value_name = "NODE")]
    pub identify: Option<String>,
    /// Let a node find its gyroscope bias anew; it must lie still for two seconds
    #[arg(long, value_name = "NODE")]
    pub recalibrate: Option<String>,
    /// Give a node a name of at most 20 bytes, e.g. 0=left-hand
    #[arg(long, value_name = "NODE=NAME")]
    pub rename: Option<String>,
    /// Set a node: filter (complementary or estimator), samples a packet, °/s, g, e.g. 0=estimator,4,2000,8
    #[arg(long, value_name = "NODE=FILTER,N,DPS,G")]
    pub configure: Option<String>,
    /// Give a node a calibration to keep: it corrects its readings with it before its filter; NODE=none takes it away
    #[arg(long, value_name = "NODE=CAL.json")]
    pub store_calibration: Option<String>,
    /// One JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Record {
    /// The receiver's serial port; a file of its bytes works as well
    #[arg(required = true, value_name = "PORT")]
    pub port: String,
    /// Where the recording goes
    #[arg(short, long, value_name = "TAKE.mcap", required = true)]
    pub output: PathBuf,
    /// Stop after so many seconds (default: Ctrl-C stops)
    #[arg(long = "for", value_name = "S")]
    pub for_s: Option<f64>,
    /// How long to wait for a port that was unplugged to come back, s
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    pub wait: f64,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
    /// One JSON object on standard output: what was recorded
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Live {
    /// A receiver's serial port; may be repeated
    #[arg(long = "serial", value_name = "PORT")]
    pub serial: Vec<String>,
    /// Motive's address, HOST or HOST:PORT; auto finds it on the network
    #[arg(long, value_name = "HOST")]
    pub natnet: Option<String>,
    /// Play a recording as if it happened now; may be repeated
    #[arg(long, value_name = "TAKE.mcap")]
    pub replay: Vec<PathBuf>,
    /// How fast recordings are played: 1 as they were, 0 as fast as possible
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    pub speed: f64,
    /// A simulated laboratory and cameras: works without any hardware
    #[arg(long)]
    pub demo: bool,
    /// Record from the start; without it, recordings begun in the viewer go to shisei-live.mcap
    #[arg(long, value_name = "TAKE.mcap")]
    pub record: Option<PathBuf>,
    /// How long the recorded estimate /smoothed waits for what comes next, s, 0.5 to 3: gaps of half of it come out as `shisei fuse` fills them
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    pub lag: f64,
    /// Address of the viewer, ADDR or ADDR:PORT; another than this machine's needs the token that is printed
    #[arg(long, value_name = "ADDR")]
    pub listen: Option<String>,
    /// Give the fused bodies out as Motive would, to existing clients: this machine's address and two ports (1510, 1511)
    #[arg(long, value_name = "ADDR[:CMD:DATA]")]
    pub natnet_out: Option<String>,
    /// With --natnet-out: send to a multicast group, as Motive does unless told otherwise, on the network of that address
    #[arg(long, value_name = "GROUP", num_args = 0..=1, default_missing_value = "239.255.42.99", requires = "natnet_out")]
    pub natnet_multicast: Option<Ipv4Addr>,
    /// Send poses over OSC (and VMC trackers and bones) to ADDR:PORT
    #[arg(long, value_name = "ADDR:PORT")]
    pub osc: Option<String>,
    /// Axes of the cameras' world: y-up (Motive's default) or z-up
    #[arg(long, value_name = "AXES", default_value = "y-up", value_parser = ["y-up", "z-up"])]
    pub optical_axes: String,
    /// A node that is on a body, by names; without it bodies are found by their motion. May be repeated
    #[arg(long, value_name = "NODE=BODY")]
    pub pair: Vec<String>,
    /// What `shisei fuse --json` printed: how the sensor sits on its body
    #[arg(long, value_name = "FUSE.json")]
    pub alignment: Vec<PathBuf>,
    /// Stop after so many seconds (default: Ctrl-C stops)
    #[arg(long = "for", value_name = "S")]
    pub for_s: Option<f64>,
    /// One JSON object on standard output at the start: the viewer's address
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Simulate {
    #[command(subcommand)]
    pub what: Simulated,
}

#[derive(Debug, Subcommand)]
pub enum Simulated {
    /// Nodes, radio, camera pulses and a receiver whose serial port can be used like a real one
    Lab(Lab),
}

/// What simulated nodes do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MovementName {
    Free,
    Poses,
}

#[derive(Args, Debug)]
pub struct Lab {
    /// How many nodes, 1 to 6
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub nodes: usize,
    /// Seed of all that is random
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Camera frames a second
    #[arg(long, value_name = "HZ", default_value_t = 120.0)]
    pub camera_rate: f64,
    /// When the recording gate rises, s (default: no gate)
    #[arg(long, value_name = "S")]
    pub gate: Option<f64>,
    /// Share of connection events that are missed, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.02)]
    pub missed: f64,
    /// Deviation of anchor points, µs
    #[arg(long, value_name = "US", default_value_t = 1.0)]
    pub jitter: f64,
    /// Largest skew of a clock, ppm
    #[arg(long, value_name = "PPM", default_value_t = 40.0)]
    pub skew: f64,
    /// A node out of reach, NODE:FROM:TO in seconds; may be repeated
    #[arg(long, value_name = "NODE:FROM:TO")]
    pub outage: Vec<String>,
    /// A node that restarts, NODE:AT in seconds; may be repeated
    #[arg(long, value_name = "NODE:AT")]
    pub reboot: Vec<String>,
    /// What the nodes do: move freely, or rest on six faces and in many poses, to be calibrated (112 s)
    #[arg(long, value_enum, default_value = "free")]
    pub movement: MovementName,
    /// A calibration that a node keeps from the start; may be repeated
    #[arg(long = "calibration", id = "kept_calibration", value_name = "NODE=CAL.json")]
    pub calibrations: Vec<String>,
    /// Stop after so many seconds (default: Ctrl-C stops; 60 with -o)
    #[arg(long = "for", value_name = "S")]
    pub for_s: Option<f64>,
    /// Write the receiver's bytes to a file, faster than real time, instead of offering a port
    #[arg(short, long, value_name = "BYTES")]
    pub output: Option<PathBuf>,
}
