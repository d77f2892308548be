//! Time of the elementary functions compared with the standard library's, as the ratio that counts on a noisy
//! machine.
//!
//! `cargo bench -p gelenk-codegen --bench elementary_functions`, with and without
//! `RUSTFLAGS=-Ctarget-cpu=native`.

#![allow(clippy::disallowed_methods, reason = "what ours are compared with")]

use std::hint::black_box;
use std::time::Instant;

use gelenk_kernels::math;

type Angles = [f64; 6];

#[inline(never)]
fn std_six(y: &Angles) -> [Angles; 2] {
    let pairs = y.map(f64::sin_cos);
    [pairs.map(|pair| pair.0), pairs.map(|pair| pair.1)]
}

#[inline(never)]
fn scalar_six(y: &Angles) -> [Angles; 2] {
    let pairs = y.map(math::sin_cos);
    [pairs.map(|pair| pair.0), pairs.map(|pair| pair.1)]
}

/// As four and two: powers of two fill the registers.
#[inline(never)]
fn array_six(y: &Angles) -> [Angles; 2] {
    let (s, c) = math::sin_cos_array([y[0], y[1], y[2], y[3]]);
    let (t, d) = math::sin_cos_array([y[4], y[5]]);
    [[s[0], s[1], s[2], s[3], t[0], t[1]], [c[0], c[1], c[2], c[3], d[0], d[1]]]
}

/// `function` of each entry; a branch-free one becomes SIMD code.
#[inline(always)]
fn each<T: Copy, const L: usize>(x: &[T; L], result: &mut [T; L], function: impl Fn(T) -> T) {
    for i in 0..L {
        result[i] = function(x[i]);
    }
}

macro_rules! lanes {
    ($name:ident, $scalar:ty, $function:expr) => {
        #[inline(never)]
        fn $name(x: &[$scalar; 64], result: &mut [$scalar; 64]) {
            each(x, result, $function);
        }
    };
}

lanes!(std_exp, f64, f64::exp);
lanes!(exp, f64, math::exp);
lanes!(std_tanh, f64, f64::tanh);
lanes!(tanh, f64, math::tanh);
lanes!(std_exp_f32, f32, f32::exp);
lanes!(exp_f32, f32, math::exp_f32);
lanes!(std_tanh_f32, f32, f32::tanh);
lanes!(tanh_f32, f32, math::tanh_f32);

#[inline(never)]
fn std_sin_cos_lanes<const L: usize>(x: &[[f64; L]; 64], result: &mut [([f64; L], [f64; L]); 64]) {
    for (x, result) in x.iter().zip(result) {
        *result = (x.map(f64::sin), x.map(f64::cos));
    }
}

#[inline(never)]
fn sin_cos_lanes<const L: usize>(x: &[[f64; L]; 64], result: &mut [([f64; L], [f64; L]); 64]) {
    for (x, result) in x.iter().zip(result) {
        *result = math::sin_cos_array(*x);
    }
}

#[inline(never)]
fn sin_cos_lanes_f32<const L: usize>(x: &[[f32; L]; 64], result: &mut [([f32; L], [f32; L]); 64]) {
    for (x, result) in x.iter().zip(result) {
        *result = math::sin_cos_array_f32(*x);
    }
}

/// Least time of one call of `function`, over 50 batches, per value.
fn time(values: usize, mut function: impl FnMut()) -> f64 {
    let batch = 2000;
    let seconds = (0..50).map(|_| {
        let start = Instant::now();
        (0..batch).for_each(|_| function());
        start.elapsed().as_secs_f64()
    });
    seconds.fold(f64::MAX, f64::min) * 1e9 / (batch * values) as f64
}

fn report(name: &str, own: f64, std: f64) {
    println!("{name:34} {own:7.2} ns, std {std:7.2} ns, ratio {:5.2}", std / own);
}

fn pair<T: Copy>(
    first: T,
    own: fn(&[T; 64], &mut [T; 64]),
    std: fn(&[T; 64], &mut [T; 64]),
    x: [T; 64],
) -> [f64; 2] {
    let mut result = [first; 64];
    [own, std].map(|function| time(64, || function(black_box(&x), black_box(&mut result))))
}

fn main() {
    let y = [0.3, -1.2, 2.5, 0.7, -3.0, 1.1];
    let std = time(1, || {
        black_box(std_six(black_box(&y)));
    });
    let scalar = time(1, || {
        black_box(scalar_six(black_box(&y)));
    });
    let array = time(1, || {
        black_box(array_six(black_box(&y)));
    });
    report("sin_cos, six angles", scalar, std);
    report("sin_cos_array, six angles (4 + 2)", array, std);

    let x = [[0.3, -1.2, 2.5, 0.7, -3.0, 1.1, 9.0, 100.0]; 64];
    let mut result = [([0.0; 8], [0.0; 8]); 64];
    let std = time(512, || std_sin_cos_lanes(black_box(&x), black_box(&mut result)));
    let own = time(512, || sin_cos_lanes(black_box(&x), black_box(&mut result)));
    report("sin_cos_array, lanes of 8, each", own, std);
    let x = x.map(|x| x.map(|x| x as f32));
    let mut result = [([0.0; 8], [0.0; 8]); 64];
    let own = time(512, || sin_cos_lanes_f32(black_box(&x), black_box(&mut result)));
    report("sin_cos_array_f32, lanes of 8, each", own, std);

    let x: [f64; 64] = std::array::from_fn(|k| 0.1 * k as f64 - 3.0);
    let [own, std] = pair(0.0, exp, std_exp, x);
    report("exp, each", own, std);
    let [own, std] = pair(0.0, tanh, std_tanh, x);
    report("tanh, each", own, std);
    let x = x.map(|x| x as f32);
    let [own, std] = pair(0.0, exp_f32, std_exp_f32, x);
    report("exp_f32, each", own, std);
    let [own, std] = pair(0.0, tanh_f32, std_tanh_f32, x);
    report("tanh_f32, each", own, std);
}
