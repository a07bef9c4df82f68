//! Mahony over a series against the plain form of the same exact step (square roots and divisions where the
//! equations have them), interleaved in one process: `cargo bench -p shisei-core --bench mahony`.
//!
//! Prints medians in ns a sample and the ratios. The plain form comes twice: with the same polynomials, and
//! with sine and cosine from the maths doorway.

use std::hint::black_box;
use std::time::Instant;

use shisei_core::filter::exponential::cos_sinc;
use shisei_core::filter::{Dt, Filter, GyroIntegrator, Mahony, run_gyro_into, run_into};
use shisei_core::{Quaternion, Vec3, math, vector};

const SAMPLES: usize = 200_000;
const ROUNDS: usize = 21;

fn main() {
    let (gyro, acc) = series(SAMPLES);
    let mut out = vec![[0.0; 4]; SAMPLES];
    let start = Quaternion::IDENTITY;
    let (kp, dt_s) = (0.2, 0.01);
    let mut times = [const { Vec::new() }; 6];
    for _ in 0..ROUNDS {
        times[0].push(timed(|| {
            let mut filter = Mahony::new(start, kp, 0.0).unwrap();
            run_into(&mut filter, &gyro, &acc, Dt::Constant(dt_s), &mut out).unwrap();
            black_box(&mut out);
        }));
        times[1].push(timed(|| {
            let mut filter = Mahony::new(start, kp, 0.0).unwrap();
            for k in 0..SAMPLES {
                out[k] = filter.update(gyro[k], acc[k], dt_s).to_array();
            }
            black_box(&mut out);
        }));
        times[2].push(timed(|| {
            plain(&gyro, &acc, kp, dt_s, &mut out, |angle| cos_sinc(angle * angle));
            black_box(&mut out);
        }));
        times[3].push(timed(|| {
            plain(&gyro, &acc, kp, dt_s, &mut out, |angle| {
                let (sin, cos) = math::sin_cos(angle);
                (cos, if angle > 0.0 { sin / angle } else { 1.0 })
            });
            black_box(&mut out);
        }));
        times[4].push(timed(|| {
            let mut filter = Mahony::new(start, kp, 0.01).unwrap();
            run_into(&mut filter, &gyro, &acc, Dt::Constant(dt_s), &mut out).unwrap();
            black_box(&mut out);
        }));
        times[5].push(timed(|| {
            let mut filter = GyroIntegrator::new(start).unwrap();
            run_gyro_into(&mut filter, &gyro, Dt::Constant(dt_s), &mut out).unwrap();
            black_box(&mut out);
        }));
    }
    let ns: Vec<f64> = times.into_iter().map(median).collect();
    println!("{SAMPLES} samples, {ROUNDS} interleaved rounds, medians");
    println!("Mahony, series                 {:6.2} ns/sample", ns[0]);
    println!("Mahony, streaming              {:6.2} ns/sample", ns[1]);
    println!("Mahony, series, with ki        {:6.2} ns/sample", ns[4]);
    println!("Mahony, plain, polynomials     {:6.2} ns/sample", ns[2]);
    println!("Mahony, plain, sine and cosine {:6.2} ns/sample", ns[3]);
    println!("gyroscope only, series         {:6.2} ns/sample", ns[5]);
    println!("ratio series / plain with polynomials     {:.3} (aim 0.75)", ns[0] / ns[2]);
    println!("ratio series / plain with sine and cosine {:.3}", ns[0] / ns[3]);
}

fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e9 / SAMPLES as f64
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Slow turns under gravity with a little noise from a linear congruential generator.
fn series(samples: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut gyro = Vec::with_capacity(samples);
    let mut acc = Vec::with_capacity(samples);
    for k in 0..samples {
        let t = k as f64 * 0.01;
        gyro.push([math::sin(t), 0.5 * math::cos(0.7 * t), 0.3 + 0.1 * noise()]);
        acc.push([math::sin(0.5 * t) + noise(), math::cos(0.3 * t) + noise(), 9.5 + noise()]);
    }
    (gyro, acc)
}

/// The equations as they stand: a/|a|, the angle's root, and q/|q|, one after another.
fn plain(
    gyro: &[Vec3],
    acc: &[Vec3],
    kp: f64,
    dt_s: f64,
    out: &mut [[f64; 4]],
    cos_sinc: impl Fn(f64) -> (f64, f64),
) {
    let mut q = Quaternion::IDENTITY;
    for ((&gyro, &acc), row) in gyro.iter().zip(acc).zip(out) {
        let norm = vector::norm(acc);
        let mut rate = gyro;
        if norm > 0.0 {
            let unit = [acc[0] / norm, acc[1] / norm, acc[2] / norm];
            rate = vector::add(rate, vector::scale(vector::cross(unit, q.up_body()), kp));
        }
        let half = vector::scale(rate, 0.5 * dt_s);
        let (c, s) = cos_sinc(vector::norm(half));
        q = q.product(Quaternion::new(c, s * half[0], s * half[1], s * half[2])).normalized();
        *row = q.to_array();
    }
}
