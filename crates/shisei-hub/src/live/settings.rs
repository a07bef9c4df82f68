//! How the hub works.

use std::path::PathBuf;

use serde_json::json;
use shisei_core::Lang;
use shisei_core::estimator::BridgeSettings;
use shisei_core::frames::Axes;
use shisei_core::fuse::delayed::DelayedSettings;

/// How the hub works.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Axes of the cameras' world.
    pub axes: Axes,
    /// How well the cameras see.
    pub optics: BridgeSettings,
    /// Positions in gaps longer than this are not shown, s.
    pub position_trust_s: f64,
    /// The estimate that is recorded with a delay waits so long, s, 0 … 10.
    pub lag_s: f64,
    /// Nodes that are on a body, by names; without one, bodies are found by their motion.
    pub pairs: Vec<(String, String)>,
    /// Where recordings go; the first begins at once where `record_now`.
    pub record: PathBuf,
    /// Record from the start.
    pub record_now: bool,
    /// The inputs are simulated.
    pub demo: bool,
    /// What `hello` tells clients.
    pub lang: Lang,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            axes: Axes::YUp,
            optics: BridgeSettings { lever_m: 0.005, ..BridgeSettings::default() },
            position_trust_s: 5.0,
            lag_s: DelayedSettings::default().lag_s,
            pairs: Vec::new(),
            record: PathBuf::from("take.mcap"),
            record_now: false,
            demo: false,
            lang: Lang::En,
        }
    }
}

/// The first message to a client.
pub fn hello(settings: &Settings) -> String {
    let lang = if settings.lang == Lang::Ja { "ja" } else { "en" };
    json!({
        "type": "hello", "protocol": 1, "version": env!("CARGO_PKG_VERSION"), "lang": lang,
        "demo": settings.demo, "may": ["record", "align", "heading", "name"],
    })
    .to_string()
}
