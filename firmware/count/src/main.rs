//! Instructions a sample, mean and worst, printed through the debugger's console: `cargo run --release` here.
//!
//! With `-icount shift=0` QEMU's clock advances by 1 ns an instruction, so a tick of the board's 25 MHz timer is 40.
#![no_std]
#![no_main]

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{Peripherals, SYST};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use panic_semihosting as _;
use shisei_core::Quaternion;
use shisei_core::estimator::{Estimator, LightEstimator, Sample, Settings};
use shisei_core::filter::{Filter, Mahony};

const INSTRUCTIONS_PER_TICK: u32 = 40;
/// The timer counts down through 24 bits.
const RELOAD: u32 = 0x00FF_FFFF;
/// Samples before counting (start and level), and counted, at 100 Hz.
const BEFORE: u32 = 200;
const COUNTED: u32 = 500;

/// D. Knuth's MMIX generator: numbers in −1 … 1.
struct Random(u64);

impl Random {
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 - 4_503_599_627_370_496.0) / 4_503_599_627_370_496.0
    }

    /// Readings within `size` rad/s and m/s² of those of a level sensor.
    fn sample(&mut self, size: f64) -> Sample {
        let mut three = || [size * self.signed(), size * self.signed(), size * self.signed()];
        let (gyro_rad_s, [x, y, z]) = (three(), three());
        Sample { gyro_rad_s, acc_m_s2: [x, y, 9.8 + z], dt_s: 0.01 }
    }
}

/// In motion, and at rest, which is known after a second and measures more.
fn count(name: &str, mut update: impl FnMut(&Sample) -> Quaternion) {
    count_at(name, "moving", 1.0, &mut update);
    count_at(name, "at rest", 0.002, &mut update);
}

fn count_at(name: &str, how: &str, size: f64, mut update: impl FnMut(&Sample) -> Quaternion) {
    let mut random = Random(7);
    let (mut sum, mut worst) = (0, 0);
    for k in 0..BEFORE + COUNTED {
        let sample = random.sample(size);
        let start = SYST::get_current();
        core::hint::black_box(update(&sample));
        let ticks = start.wrapping_sub(SYST::get_current()) & RELOAD;
        if k >= BEFORE {
            sum += u64::from(ticks * INSTRUCTIONS_PER_TICK);
            worst = worst.max(ticks * INSTRUCTIONS_PER_TICK);
        }
    }
    hprintln!("{} {}: mean {}, worst {} instructions a sample", name, how, sum / u64::from(COUNTED), worst);
}

#[entry]
fn main() -> ! {
    if let Some(mut peripherals) = Peripherals::take() {
        let timer = &mut peripherals.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
    }
    if let Ok(mut filter) = Mahony::new(Quaternion::IDENTITY, 0.2, 0.0) {
        count("Mahony", |s| filter.update(s.gyro_rad_s, s.acc_m_s2, s.dt_s));
    }
    if let Ok(mut estimator) = LightEstimator::new(&Settings::default()) {
        count("LightEstimator", |sample| estimator.update(sample).world_from_body);
    }
    if let Ok(mut estimator) = Estimator::new(&Settings::default()) {
        count("Estimator", |sample| estimator.update(sample).world_from_body);
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
