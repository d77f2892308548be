//! Eight states at once beside one by one: time per state, and the same bits. `lanes.sh` compiles it, once
//! for each instruction set.

#[allow(dead_code, reason = "some functions are called")]
mod robot {
    include!(env!("GELENK_MODULE"));
}

#[cfg(form = "avx2")]
use robot::{
    inverse_dynamics_lanes_avx2 as inverse_dynamics_lanes, linearize_lanes_avx2 as linearize_lanes,
};
#[cfg(form = "avx512")]
use robot::{
    inverse_dynamics_lanes_avx512 as inverse_dynamics_lanes,
    linearize_lanes_avx512 as linearize_lanes,
};

use robot::{Lanes, N};
use std::hint::black_box;
use std::time::Instant;

#[cfg(form = "avx2")]
const FORM: &str = "avx2";
#[cfg(form = "avx512")]
const FORM: &str = "avx512";

type Many = [Lanes; N];
type One = [f64; N];

const STATES: usize = 64;
const ROUNDS: usize = 400;
/// Passes over all states in each round: some ten microseconds.
const PASSES: usize = 5;

/// Seconds of so many passes.
fn time(mut pass: impl FnMut()) -> f64 {
    let start = Instant::now();
    (0..PASSES).for_each(|_| pass());
    start.elapsed().as_secs_f64()
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

fn state(many: &Many, i: usize) -> One {
    core::array::from_fn(|k| many[k].0[i])
}

/// The states one by one.
fn singles(inputs: &[[Many; 3]]) -> Vec<[One; 3]> {
    let of = |input: &[Many; 3]| {
        (0..8)
            .map(|i| input.each_ref().map(|x| state(x, i)))
            .collect::<Vec<_>>()
    };
    inputs.iter().flat_map(of).collect()
}

fn bits(x: One) -> [u64; N] {
    x.map(f64::to_bits)
}

/// Alternates both, since other work on the machine comes and goes.
fn report(name: &str, mut scalar: impl FnMut(), mut lanes: impl FnMut()) {
    let rounds: Vec<[f64; 2]> = (0..ROUNDS)
        .map(|_| [time(&mut scalar), time(&mut lanes)])
        .collect();
    let least = |k: usize| {
        let seconds = rounds.iter().map(|round| round[k]).fold(f64::MAX, f64::min);
        seconds * 1e9 / (STATES * PASSES) as f64
    };
    let mut ratios: Vec<f64> = rounds
        .iter()
        .map(|[scalar, lanes]| scalar / lanes)
        .collect();
    ratios.sort_by(f64::total_cmp);
    println!(
        "{name:18} {:>7} {FORM:>7} {:>11.1} {:>10.1}   {:.2} ({:.2} to {:.2})",
        std::env::args().nth(1).unwrap_or_default(),
        least(0),
        least(1),
        ratios[ROUNDS / 2],
        ratios[ROUNDS / 4],
        ratios[ROUNDS * 3 / 4]
    );
}

fn inverse_dynamics(inputs: &[[Many; 3]]) {
    let single = singles(inputs);
    let mut forces = [Lanes([0.0; 8]); N];
    for (input, states) in inputs.iter().zip(single.chunks(8)) {
        let [y, v, a] = input;
        // SAFETY: `main` asked the processor for the instructions, here and below.
        unsafe { inverse_dynamics_lanes(y, v, a, &mut forces) };
        for (i, [y, v, a]) in states.iter().enumerate() {
            let expected = robot::inverse_dynamics(y, v, a);
            assert_eq!(bits(state(&forces, i)), bits(expected));
        }
    }
    report(
        "inverse_dynamics",
        || {
            for [y, v, a] in black_box(&single) {
                black_box(robot::inverse_dynamics(y, v, a));
            }
        },
        || {
            for [y, v, a] in black_box(inputs) {
                unsafe { inverse_dynamics_lanes(y, v, a, &mut forces) };
                black_box(&forces);
            }
        },
    );
}

fn linearize(inputs: &[[Many; 3]]) {
    let single = singles(inputs);
    let mut many = [[[Lanes([0.0; 8]); N]; N]; 3];
    let mut many_affine = [Lanes([0.0; 8]); N];
    for (input, states) in inputs.iter().zip(single.chunks(8)) {
        let ([y, v, u], [dy, dv, du]) = (input, &mut many);
        unsafe { linearize_lanes(y, v, u, dy, dv, du, &mut many_affine) };
        for (i, [y, v, u]) in states.iter().enumerate() {
            let (dy, dv, du, affine) = robot::linearize(y, v, u);
            for (found, expected) in many.iter().zip([dy, dv, du]) {
                assert_eq!(
                    found.each_ref().map(|row| bits(state(row, i))),
                    expected.map(bits)
                );
            }
            assert_eq!(bits(state(&many_affine, i)), bits(affine));
        }
    }
    let mut blocks = [[[0.0; N]; N]; 3];
    let mut affine = [0.0; N];
    report(
        "linearize",
        || {
            for [y, v, u] in black_box(&single) {
                let [dy, dv, du] = &mut blocks;
                robot::linearize_into(y, v, u, dy, dv, du, &mut affine);
                black_box((&blocks, &affine));
            }
        },
        || {
            for [y, v, u] in black_box(inputs) {
                let [dy, dv, du] = &mut many;
                unsafe { linearize_lanes(y, v, u, dy, dv, du, &mut many_affine) };
                black_box((&many, &many_affine));
            }
        },
    );
}

fn has_instructions() -> bool {
    match FORM {
        "avx512" => {
            is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
        }
        _ => is_x86_feature_detected!("avx2"),
    }
}

fn main() {
    if !has_instructions() {
        println!("{FORM}: not on this processor");
        return;
    }
    let mut number = numbers();
    let mut many = || core::array::from_fn(|_| Lanes(core::array::from_fn(|_| number())));
    let inputs: Vec<[Many; 3]> = (0..STATES / 8).map(|_| [many(), many(), many()]).collect();
    inverse_dynamics(&inputs);
    linearize(&inputs);
}
