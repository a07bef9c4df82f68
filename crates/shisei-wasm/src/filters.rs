//! Whole recordings to attitudes, and filters a sample at a time.

use crate::arrays::{Parts, rows, steps, table, vector};
use crate::errors::{named, refusal};
use crate::recording::sentences;
use js_sys::Array;
use shisei_core::calibration::Calibration;
use shisei_core::estimator::{Calibration as Learnt, Estimator, Sample, Settings, State};
use shisei_core::filter::{AdaptiveGain, Dt, Mahony};
use shisei_core::orient::{self as whole, Method, Relative, RestChoice};
use shisei_core::{Error, Lang, Quaternion, Vec3};
use shisei_functions::last_error::user_lang;
use shisei_record::calibration::CalibrationFile;
use wasm_bindgen::prelude::*;

fn method(filter: &str, p: &[f64]) -> Result<Method, JsValue> {
    Ok(match filter {
        "shisei" => Method::Estimate,
        "shisei-online" => Method::EstimateOnline,
        "gyro" => Method::Gyro,
        "gyro-rk4" => Method::GyroRk4,
        "mahony" => {
            let [kp, ki] = vector(p)?;
            Method::Mahony { kp, ki }
        }
        "mahony-adaptive" => {
            let [kp_max, kp_min, upper_start, upper_end, lower_start, lower_end, ki] = vector(p)?;
            let gain = AdaptiveGain { kp_max, kp_min, upper_start, upper_end, lower_start, lower_end };
            Method::MahonyAdaptive { gain, ki }
        }
        "complementary" => {
            let [alpha] = vector(p)?;
            Method::Complementary { alpha }
        }
        other => return Err(named("DomainError", &format!("there is no filter {other:?}"))),
    })
}

/// What the estimator starts from, and what corrects the readings before a filter: one of the two, from the text of a
/// calibration file. Only the estimator takes what it learnt itself.
fn known(text: Option<&str>, by_estimator: bool) -> Result<(Option<Learnt>, Option<Calibration>), JsValue> {
    let Some(text) = text else { return Ok((None, None)) };
    let file = CalibrationFile::from_json(text.as_bytes())
        .map_err(|error| named("DomainError", &format!("calibration: {}", error.sentence(user_lang()))))?;
    let Some(learnt) = file.learnt().filter(|_| by_estimator) else {
        return Ok((None, Some(file.calibration)));
    };
    learnt.check().map_err(|error| refusal("calibration", error))?;
    Ok((Some(learnt), None))
}

/// Accelerations and rates, each series as long as the other or not.
type Corrected = (Vec<Vec3>, Vec<Vec3>);

fn corrected(by: &Calibration, acc: &[Vec3], gyro: &[Vec3]) -> shisei_core::Result<Corrected> {
    let (mut out_acc, mut out_gyro) = (vec![[0.0; 3]; acc.len()], vec![[0.0; 3]; gyro.len()]);
    by.accelerometer.apply_series(acc, &mut out_acc)?;
    by.gyroscope.apply_series(gyro, &mut out_gyro)?;
    Ok((out_acc, out_gyro))
}

/// A whole recording: rest, bias, start, filter. `rest` is empty, or the first row and the row after the last;
/// `forward` is empty, or an axis; `calibration` is the text of a file.
#[wasm_bindgen]
#[allow(clippy::too_many_arguments, clippy::needless_pass_by_value)] // named in the package; what is handed over
pub fn orient(
    filter: &str,
    parameters: &[f64],
    gyro_rad_s: &[f64],
    acc_m_s2: &[f64],
    dt_s: &[f64],
    auto_rest: bool,
    rest: &[usize],
    forward: &[f64],
    gravity_m_s2: f64,
    calibration: Option<String>,
) -> Result<JsValue, JsValue> {
    let (gyro, acc) = (rows::<3>(gyro_rad_s)?, rows::<3>(acc_m_s2)?);
    let method = method(filter, parameters)?;
    let (sensor, correct) = known(calibration.as_deref(), method.starts_in_motion())?;
    let settings = whole::Settings {
        method,
        rest: match *rest {
            [start, end] => RestChoice::Rows { start, end },
            _ if auto_rest => RestChoice::Auto,
            _ => RestChoice::None,
        },
        relative: Relative::None,
        forward_axis_body: if forward.is_empty() { None } else { Some(vector(forward)?) },
        gravity_m_s2,
        sensor,
    };
    let each = match steps(dt_s) {
        Dt::Constant(dt_s) => vec![dt_s; gyro.len()],
        Dt::PerSample(dt_s) => dt_s.to_vec(),
    };
    let found = match correct {
        None => whole::orient(acc, gyro, &each, &settings),
        Some(correct) => corrected(&correct, acc, gyro)
            .and_then(|(acc, gyro)| whole::orient(&acc, &gyro, &each, &settings)),
    };
    let found = found.map_err(|error| match error {
        Error::TooFewPoints { given, needed } => short_rest(given, needed),
        other => refusal("orient", other),
    })?;
    let quaternions: Vec<[f64; 4]> = found.world_from_body.iter().map(|q| q.to_array()).collect();
    // Raw readings may be of any size.
    let mut doubts = if calibration.is_some() { Vec::new() } else { shisei_record::doubts(acc, gyro, &each) };
    doubts.extend(shisei_record::doubts_of_attitudes(found.start, !forward.is_empty(), gravity_m_s2));
    let mut parts = Parts::new()
        .rows("worldFromBody", &quaternions)
        .numbers("start", &found.start.to_array())
        .numbers("gyroBiasRadS", &found.gyro_bias_rad_s)
        .put("warnings", sentences(&doubts));
    if let Some(rest) = found.rest {
        parts = parts.put("rest", Array::of2(&rest.start.into(), &rest.end.into()));
    }
    if let Some(certainty) = &found.certainty {
        parts = parts
            .numbers("sigmaTiltRad", &certainty.sigma_tilt_rad)
            .numbers("sigmaHeadingRad", &certainty.sigma_heading_rad);
    }
    Ok(parts.object())
}

fn short_rest(given: usize, needed: usize) -> JsValue {
    let sentence = match user_lang() {
        Lang::En => {
            format!("orient: the rest has {given} samples and {needed} are needed; give a longer one")
        }
        Lang::Ja => format!(
            "orient: 静止区間が {given} サンプルしかありません ({needed} 以上必要)。もっと長い区間を指定してください"
        ),
    };
    named("ConditionError", &sentence)
}

/// Yaw, pitch, roll of attitudes of unit norm, relative to the start in "world" or "body" axes, or themselves ("none").
#[wasm_bindgen(js_name = yprRad)]
pub fn ypr_rad(world_from_body: &[f64], start: &[f64], relative: &str) -> Result<JsValue, JsValue> {
    let relative = match relative {
        "world" => Relative::World,
        "body" => Relative::Body,
        _ => Relative::None,
    };
    let quats: Vec<Quaternion> = rows(world_from_body)?.iter().copied().map(Quaternion::from_array).collect();
    let ypr_rad = whole::ypr_rad(&quats, Quaternion::from_array(vector(start)?), relative);
    Ok(table(ypr_rad.as_flattened(), ypr_rad.len(), 3))
}

/// Mahony's filter, one sample at a time.
#[wasm_bindgen]
#[derive(Debug)]
pub struct MahonyFilter(Mahony);

#[wasm_bindgen]
impl MahonyFilter {
    #[wasm_bindgen(constructor)]
    pub fn new(start: &[f64], kp: f64, ki: f64) -> Result<MahonyFilter, JsValue> {
        let filter = Mahony::new(Quaternion::from_array(vector(start)?), kp, ki);
        filter.map(MahonyFilter).map_err(|error| refusal("Mahony", error))
    }

    pub fn update(&mut self, gyro_rad_s: &[f64], acc_m_s2: &[f64], dt_s: f64) -> Result<Vec<f64>, JsValue> {
        use shisei_core::filter::Filter;
        let q = self.0.update(vector(gyro_rad_s)?, vector(acc_m_s2)?, dt_s);
        Ok(q.to_array().to_vec())
    }

    #[wasm_bindgen(js_name = integralRadS)]
    pub fn integral_rad_s(&self) -> Vec<f64> {
        self.0.integral_rad_s().to_vec()
    }
}

/// The estimator, one sample at a time.
#[wasm_bindgen]
#[derive(Debug)]
pub struct EstimatorFilter {
    estimator: Box<Estimator>,
    correct: Option<Calibration>,
}

#[wasm_bindgen]
impl EstimatorFilter {
    #[wasm_bindgen(constructor)]
    #[allow(clippy::needless_pass_by_value)] // what wasm-bindgen hands over
    pub fn new(gravity_m_s2: f64, calibration: Option<String>) -> Result<EstimatorFilter, JsValue> {
        let (calibration, correct) = known(calibration.as_deref(), true)?;
        let settings = Settings { gravity_m_s2, calibration, ..Settings::default() };
        let estimator = Estimator::new(&settings).map_err(|error| refusal("Estimator", error))?;
        Ok(EstimatorFilter { estimator: Box::new(estimator), correct })
    }

    pub fn update(&mut self, gyro_rad_s: &[f64], acc_m_s2: &[f64], dt_s: f64) -> Result<JsValue, JsValue> {
        let (mut gyro_rad_s, mut acc_m_s2): (Vec3, Vec3) = (vector(gyro_rad_s)?, vector(acc_m_s2)?);
        if let Some(correct) = &self.correct {
            gyro_rad_s = correct.gyroscope.apply(gyro_rad_s);
            acc_m_s2 = correct.accelerometer.apply(acc_m_s2);
        }
        Ok(told(&self.estimator.update(&Sample { gyro_rad_s, acc_m_s2, dt_s })))
    }

    pub fn state(&self) -> JsValue {
        told(&self.estimator.state())
    }
}

fn told(state: &State) -> JsValue {
    Parts::new()
        .numbers("worldFromBody", &state.world_from_body.to_array())
        .numbers("rateRadS", &state.rate_rad_s)
        .numbers("gyroBiasRadS", &state.gyro_bias_rad_s)
        .put("sigmaTiltRad", state.sigma_tilt_rad)
        .put("sigmaHeadingRad", state.sigma_heading_rad)
        .put("rest", state.rest)
        .object()
}
