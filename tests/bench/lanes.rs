//! Eight states at once beside one by one: time per state, and the same bits. `lanes.sh` compiles it.

#[allow(dead_code, reason = "some functions are called")]
mod robot {
    include!(env!("GELENK_MODULE"));
}

use robot::{Lanes, N};
use std::hint::black_box;
use std::time::Instant;

type Vector = [f64; N];
type Many = [Lanes; N];
type Matrix = [[f64; N]; N];
type ManyMatrices = [[Lanes; N]; N];

const STATES: usize = 64;

/// Least time of a block of calls over many rounds: what other work on the machine adds is left out.
fn time(states: usize, mut calls: impl FnMut()) -> f64 {
    let rounds = (0..400).map(|_| {
        let start = Instant::now();
        calls();
        start.elapsed().as_secs_f64()
    });
    rounds.fold(f64::MAX, f64::min) * 1e9 / states as f64
}

/// Repeatable numbers: Knuth's linear congruential generator.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 6.0
    }
}

fn lane(many: &Many, i: usize) -> Vector {
    core::array::from_fn(|k| many[k].0[i])
}

fn report(name: &str, scalar: f64, forms: [Option<f64>; 3]) {
    print!("{name:18} scalar {scalar:7.1} ns/state");
    for (form, time) in ["baseline", "avx2", "avx512"].iter().zip(forms) {
        match time {
            Some(time) => print!("   {form} {time:6.1} ns, {:4.2}×", scalar / time),
            None => print!("   {form}: not here"),
        }
    }
    println!();
}

fn inverse_dynamics(inputs: &[[Many; 3]]) {
    let scalar: Vec<[Vector; 3]> = inputs
        .iter()
        .flat_map(|[y, v, a]| {
            (0..8)
                .map(|i| [lane(y, i), lane(v, i), lane(a, i)])
                .collect::<Vec<_>>()
        })
        .collect();
    let one = time(scalar.len(), || {
        for [y, v, a] in black_box(&scalar) {
            black_box(robot::inverse_dynamics(y, v, a));
        }
    });
    let mut forces = [Lanes([0.0; 8]); N];
    for (k, [y, v, a]) in inputs.iter().enumerate() {
        robot::inverse_dynamics_lanes(y, v, a, &mut forces);
        for i in 0..8 {
            let [y, v, a] = &scalar[8 * k + i];
            let bits = |x: Vector| x.map(f64::to_bits);
            assert_eq!(
                bits(robot::inverse_dynamics(y, v, a)),
                bits(lane(&forces, i))
            );
        }
    }
    type Form = unsafe fn(&Many, &Many, &Many, &mut Many);
    let mut run = |form: Form| {
        time(scalar.len(), || {
            for [y, v, a] in black_box(inputs) {
                // SAFETY: the processor was asked for the instructions.
                unsafe { form(y, v, a, &mut forces) };
                black_box(&forces);
            }
        })
    };
    let baseline = Some(run(robot::inverse_dynamics_lanes));
    let avx2 = is_x86_feature_detected!("avx2").then(|| run(robot::inverse_dynamics_lanes_avx2));
    let avx512 =
        is_x86_feature_detected!("avx512dq").then(|| run(robot::inverse_dynamics_lanes_avx512));
    report("inverse_dynamics", one, [baseline, avx2, avx512]);
}

fn linearize(inputs: &[[Many; 3]]) {
    let scalar: Vec<[Vector; 3]> = inputs
        .iter()
        .flat_map(|[y, v, a]| {
            (0..8)
                .map(|i| [lane(y, i), lane(v, i), lane(a, i)])
                .collect::<Vec<_>>()
        })
        .collect();
    let mut blocks: [Matrix; 3] = [[[0.0; N]; N]; 3];
    let mut affine = [0.0; N];
    let one = time(scalar.len(), || {
        for [y, v, u] in black_box(&scalar) {
            let [dy, dv, du] = &mut blocks;
            robot::linearize_into(y, v, u, dy, dv, du, &mut affine);
            black_box((&blocks, &affine));
        }
    });
    let mut many: [ManyMatrices; 3] = [[[Lanes([0.0; 8]); N]; N]; 3];
    let mut rest = [Lanes([0.0; 8]); N];
    for (k, [y, v, u]) in inputs.iter().enumerate() {
        let [dy, dv, du] = &mut many;
        robot::linearize_lanes(y, v, u, dy, dv, du, &mut rest);
        for i in 0..8 {
            let [y, v, u] = &scalar[8 * k + i];
            let expected = robot::linearize(y, v, u);
            for (matrix, expected) in many.iter().zip([expected.0, expected.1, expected.2]) {
                for (row, expected) in matrix.iter().zip(expected) {
                    assert_eq!(lane(row, i).map(f64::to_bits), expected.map(f64::to_bits));
                }
            }
            assert_eq!(
                lane(&rest, i).map(f64::to_bits),
                expected.3.map(f64::to_bits)
            );
        }
    }
    type Form = unsafe fn(
        &Many,
        &Many,
        &Many,
        &mut ManyMatrices,
        &mut ManyMatrices,
        &mut ManyMatrices,
        &mut Many,
    );
    let mut run = |form: Form| {
        time(scalar.len(), || {
            for [y, v, u] in black_box(inputs) {
                let [dy, dv, du] = &mut many;
                // SAFETY: the processor was asked for the instructions.
                unsafe { form(y, v, u, dy, dv, du, &mut rest) };
                black_box((&many, &rest));
            }
        })
    };
    let baseline = Some(run(robot::linearize_lanes));
    let avx2 = is_x86_feature_detected!("avx2").then(|| run(robot::linearize_lanes_avx2));
    let avx512 = is_x86_feature_detected!("avx512dq").then(|| run(robot::linearize_lanes_avx512));
    report("linearize", one, [baseline, avx2, avx512]);
}

fn main() {
    let mut number = numbers();
    let mut many = || core::array::from_fn(|_| Lanes(core::array::from_fn(|_| number())));
    let inputs: Vec<[Many; 3]> = (0..STATES / 8).map(|_| [many(), many(), many()]).collect();
    inverse_dynamics(&inputs);
    linearize(&inputs);
}
