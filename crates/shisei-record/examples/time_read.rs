//! Times reading and writing of one CSV: `cargo run --release -p shisei-record --example time_read FILE [ROUNDS]`.
use shisei_record::write::{Decimals, recording_csv};
use shisei_record::{Input, Options, open};
use std::time::Instant;

fn main() {
    let name = std::env::args().nth(1).unwrap_or_default();
    let rounds: usize = std::env::args().nth(2).and_then(|r| r.parse().ok()).unwrap_or(5);
    let bytes = std::fs::read(&name).unwrap_or_default();
    let megabytes = bytes.len() as f64 / 1e6;
    let mut times = [f64::INFINITY; 3];
    for _ in 0..rounds {
        let start = Instant::now();
        let recording = match open(&[Input { name: &name, bytes: &bytes }], &Options::default()) {
            Ok(recording) => recording,
            Err(error) => return println!("{error}"),
        };
        times[0] = times[0].min(start.elapsed().as_secs_f64());
        for (slot, decimals) in [(1, Decimals::Shortest), (2, Decimals::Fixed(6))] {
            let start = Instant::now();
            let _ = recording_csv(&mut std::io::sink(), &recording, decimals);
            times[slot] = times[slot].min(start.elapsed().as_secs_f64());
        }
    }
    for (what, time) in ["open", "write shortest", "write 6 decimals"].iter().zip(times) {
        println!("{what:18} {:8.1} ms  {:6.0} MB/s of input", time * 1e3, megabytes / time);
    }
}
