//! Recordings from the bytes of files.

use crate::arrays::Parts;
use crate::errors::named;
use js_sys::Array;
use shisei_functions::last_error::user_lang;
use shisei_record::options::{AxisMap, Columns, Scale, Units};
use shisei_record::{Error, Input, Note, Options, Recording};
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
    pub fn say(&mut self, what: &str, text: &str) -> Result<(), JsValue> {
        match what {
            "units" => self.0.units = Units::parse(text).map_err(refusal)?,
            "columns" => self.0.columns = Some(Columns::parse(text).map_err(refusal)?),
            "axes" => self.0.axes = Some(AxisMap::parse(text).map_err(refusal)?),
            _ => self.0.scale = Some(Scale::parse(text).map_err(refusal)?),
        }
        Ok(())
    }
}

fn refusal(error: Error) -> JsValue {
    named("RecordingError", &error.sentence(user_lang()))
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
    let sentences = |notes: &[Note]| -> JsValue {
        notes.iter().map(|note| JsValue::from(note.sentence(user_lang()))).collect::<Array>().into()
    };
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
