//! Smooth scalar functions of time with exact derivatives.
//!
//! A curve is a constant plus a sum of terms: transitions, sinusoids and products of two curves. A
//! transition is the septic smoothstep s(u) = 35u⁴ − 84u⁵ + 70u⁶ − 20u⁷, whose first three derivatives are 0
//! at both ends: a movement made of it starts and ends without a step in rate, acceleration or jerk.

use shisei_core::math;

/// A value with its first and second derivative by time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// f(t).
    pub value: f64,
    /// f′(t), per s.
    pub rate: f64,
    /// f″(t), per s².
    pub acceleration: f64,
}

impl Jet {
    fn plus(self, other: Jet) -> Jet {
        Jet {
            value: self.value + other.value,
            rate: self.rate + other.rate,
            acceleration: self.acceleration + other.acceleration,
        }
    }

    fn times(self, other: Jet) -> Jet {
        Jet {
            value: self.value * other.value,
            rate: self.rate * other.value + self.value * other.rate,
            acceleration: self.acceleration * other.value
                + 2.0 * self.rate * other.rate
                + self.value * other.acceleration,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Term {
    Step { start_s: f64, duration_s: f64, amount: f64 },
    Sine { amplitude: f64, frequency_hz: f64, phase_rad: f64 },
    Product(Box<(Curve, Curve)>),
}

/// A smooth function of time, in the unit its user gives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    constant: f64,
    terms: Vec<Term>,
}

impl Curve {
    /// The same value at all times.
    pub fn constant(value: f64) -> Self {
        Curve { constant: value, terms: Vec::new() }
    }

    /// Plus a transition by `amount` that begins at `start_s` and takes `duration_s` (> 0).
    pub fn step(mut self, start_s: f64, duration_s: f64, amount: f64) -> Self {
        self.terms.push(Term::Step { start_s, duration_s, amount });
        self
    }

    /// Plus a transition by `amount` and back: up within `rise_s`, held for `hold_s`, down within `rise_s`.
    pub fn bump(self, start_s: f64, rise_s: f64, hold_s: f64, amount: f64) -> Self {
        self.step(start_s, rise_s, amount).step(start_s + rise_s + hold_s, rise_s, -amount)
    }

    /// Plus `amplitude · sin(2π frequency t + phase)`.
    pub fn sine(mut self, amplitude: f64, frequency_hz: f64, phase_rad: f64) -> Self {
        self.terms.push(Term::Sine { amplitude, frequency_hz, phase_rad });
        self
    }

    /// The product of two curves, such as a sinusoid that fades in and out.
    pub fn times(self, other: Curve) -> Self {
        Curve { constant: 0.0, terms: vec![Term::Product(Box::new((self, other)))] }
    }

    /// Value and derivatives at a time.
    pub fn at(&self, time_s: f64) -> Jet {
        let mut sum = Jet { value: self.constant, ..Jet::default() };
        for term in &self.terms {
            sum = sum.plus(match term {
                Term::Step { start_s, duration_s, amount } => {
                    transition(time_s - start_s, *duration_s, *amount)
                }
                Term::Sine { amplitude, frequency_hz, phase_rad } => {
                    sinusoid(time_s, *amplitude, *frequency_hz, *phase_rad)
                }
                Term::Product(pair) => pair.0.at(time_s).times(pair.1.at(time_s)),
            });
        }
        sum
    }
}

fn transition(since_start_s: f64, duration_s: f64, amount: f64) -> Jet {
    let u = since_start_s / duration_s;
    if u <= 0.0 {
        return Jet::default();
    }
    if u >= 1.0 {
        return Jet { value: amount, ..Jet::default() };
    }
    let (u2, v) = (u * u, 1.0 - u);
    let uv = u * v;
    Jet {
        value: amount * (u2 * u2 * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)))),
        rate: amount * (140.0 * uv * uv * uv) / duration_s,
        acceleration: amount * (420.0 * uv * uv * (1.0 - 2.0 * u)) / (duration_s * duration_s),
    }
}

fn sinusoid(time_s: f64, amplitude: f64, frequency_hz: f64, phase_rad: f64) -> Jet {
    let omega = 2.0 * core::f64::consts::PI * frequency_hz;
    let (sin, cos) = math::sin_cos(omega * time_s + phase_rad);
    Jet {
        value: amplitude * sin,
        rate: amplitude * omega * cos,
        acceleration: -amplitude * omega * omega * sin,
    }
}
