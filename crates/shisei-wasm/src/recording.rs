//! Recordings from the bytes of files.

use crate::arrays::Parts;
use crate::errors::named;
use js_sys::Array;
use shisei_functions::last_error::user_lang;
use shisei_record::{Error, Input, Names, Note, Options, Recording, with_names};
use wasm_bindgen::prelude::*;

/// What a user says of a file, each as the command line takes it.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Reading(Options);

#[wasm_bindgen]
impl Reading {
    #[wasm_bindgen(constructor)]
    pub fn new(rate_hz: Option<f64>, sensor: Option<String>, skip_bad_rows: bool) -> Reading {
        Reading(Options { rate_hz, sensor, skip_bad_rows, ..Options::default() })
    }

    /// One of `units`, `columns`, `axes`, `scale`.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), JsValue> {
        self.0.set(name, text).map_err(refusal)
    }
}

fn refusal(error: Error) -> JsValue {
    named("RecordingError", &in_javascript(&error.sentence(user_lang())))
}

/// With the package's names for the command line's options.
pub fn in_javascript(sentence: &str) -> String {
    with_names(sentence, Names { rate: "rateHz", skip_bad_rows: "skipBadRows", gravity: "gravityMS2" })
}

/// A sentence each, for the package.
pub fn sentences(notes: &[Note]) -> Array {
    notes.iter().map(|note| JsValue::from(in_javascript(note.sentence(user_lang())))).collect()
}

/// A recording of one file, or of two that belong together.
#[wasm_bindgen(js_name = readRecording)]
pub fn read_recording(
    names: Vec<String>,
    files: Vec<js_sys::Uint8Array>,
    reading: &Reading,
) -> Result<JsValue, JsValue> {
    let bytes: Vec<Vec<u8>> = files.iter().map(js_sys::Uint8Array::to_vec).collect();
    let inputs: Vec<Input<'_>> =
        names.iter().zip(&bytes).map(|(name, bytes)| Input { name, bytes }).collect();
    let recording = shisei_record::open(&inputs, &reading.0).map_err(refusal)?;
    Ok(told(&recording))
}

fn told(recording: &Recording) -> JsValue {
    let found = &recording.findings;
    let mut parts = Parts::new()
        .put("dialect", recording.dialect)
        .put("rateHz", found.rate_hz)
        .put("durationS", found.duration_s)
        .numbers("timeS", &recording.time_s)
        .numbers("dtS", &recording.dt_s)
        .rows("accMS2", &recording.acc_m_s2)
        .rows("gyroRadS", &recording.gyro_rad_s)
        .put("assumptions", sentences(&recording.assumptions))
        .put("warnings", sentences(&recording.warnings));
    if let Some(temp_c) = &recording.temp_c {
        parts = parts.numbers("tempC", temp_c);
    }
    parts.object()
}
