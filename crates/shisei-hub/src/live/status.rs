//! How everything is, as one message.

use std::time::Instant;

use serde_json::{Value, json};

use super::hub::Hub;
use super::node::round;

impl Hub {
    /// The status message.
    pub fn status(&mut self, now: Instant) -> Value {
        let inputs: Vec<Value> = self
            .inputs
            .iter_mut()
            .map(|input| {
                json!({
                    "name": input.name, "kind": input.kind.name(), "state": input.state.name(),
                    "rate_hz": round(input.rate.hz(now), 1), "lost": input.lost, "bad": input.bad,
                })
            })
            .collect();
        let nodes: Vec<Value> = self.nodes.iter_mut().map(|node| node.status(now)).collect();
        let latency = self.latency.ms();
        let outputs: Vec<Value> = self
            .outputs
            .iter()
            .map(|output| json!({"name": output.name(), "clients": output.clients()}))
            .collect();
        let recording = self.recorder.as_ref().map(|recorder| {
            json!({
                "file": recorder.file(), "seconds": round(recorder.seconds(now), 1), "bytes": recorder.bytes(),
            })
        });
        json!({
            "type": "status",
            "uptime_s": round(now.saturating_duration_since(self.started).as_secs_f64(), 1),
            "inputs": inputs,
            "nodes": nodes,
            "sync": {"frames": self.optical.frames, "pulse_rate_hz": round(self.pulses.hz(now), 1)},
            "latency_ms": {
                "median": latency.map(|(median, _)| round(median, 3)),
                "p99": latency.map(|(_, p99)| round(p99, 3)),
            },
            "outputs": outputs,
            "clients": self.board.clients(),
            "recording": recording,
        })
    }
}
