//! Eight states at once compared with one by one: time per state, and the same bits. `lanes.sh` compiles it, once
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

#[cfg(has_quaternions)]
use robot::NY;
use robot::{Lanes, M, N};
use std::hint::black_box;
use std::time::Instant;

#[cfg(form = "avx2")]
const FORM: &str = "avx2";
#[cfg(form = "avx512")]
const FORM: &str = "avx512";

#[cfg(not(has_quaternions))]
const NY: usize = N;

/// Numbers of which each state has its own.
type Many<const K: usize> = [Lanes; K];

/// Positions, velocities, accelerations and inputs of eight states.
struct Input {
    y: Many<NY>,
    v: Many<N>,
    a: Many<N>,
    u: Many<M>,
}

/// The same of one state.
struct Single {
    y: [f64; NY],
    v: [f64; N],
    a: [f64; N],
    u: [f64; M],
}

impl Input {
    fn states(&self) -> impl Iterator<Item = Single> {
        (0..8).map(|i| Single {
            y: state(&self.y, i),
            v: state(&self.v, i),
            a: state(&self.a, i),
            u: state(&self.u, i),
        })
    }
}

const STATES: usize = 64;
const ROUNDS: usize = 400;
/// Passes over all states in each round: some ten microseconds.
const PASSES: usize = 5;

/// Seconds of all passes.
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

fn state<const K: usize>(many: &Many<K>, i: usize) -> [f64; K] {
    core::array::from_fn(|k| many[k].0[i])
}

/// The states one by one.
fn singles(inputs: &[Input]) -> Vec<Single> {
    inputs.iter().flat_map(Input::states).collect()
}

fn bits<const K: usize>(x: [f64; K]) -> [u64; K] {
    x.map(f64::to_bits)
}

fn same_rows<const K: usize>(many: &[Many<K>; N], i: usize, expected: [[f64; K]; N]) {
    assert_eq!(
        many.each_ref().map(|row| bits(state(row, i))),
        expected.map(bits)
    );
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

fn inverse_dynamics(inputs: &[Input]) {
    let single = singles(inputs);
    let mut forces = [Lanes([0.0; 8]); N];
    for (Input { y, v, a, .. }, states) in inputs.iter().zip(single.chunks(8)) {
        // SAFETY: `main` asked the processor for the instructions, here and below.
        unsafe { inverse_dynamics_lanes(y, v, a, &mut forces) };
        for (i, Single { y, v, a, .. }) in states.iter().enumerate() {
            let expected = robot::inverse_dynamics(y, v, a);
            assert_eq!(bits(state(&forces, i)), bits(expected));
        }
    }
    report(
        "inverse_dynamics",
        || {
            for Single { y, v, a, .. } in black_box(&single) {
                black_box(robot::inverse_dynamics(y, v, a));
            }
        },
        || {
            for Input { y, v, a, .. } in black_box(inputs) {
                unsafe { inverse_dynamics_lanes(y, v, a, &mut forces) };
                black_box(&forces);
            }
        },
    );
}

/// The results of `linearize` over eight states.
struct Linear {
    by_y: [Many<N>; N],
    by_v: [Many<N>; N],
    by_u: [Many<M>; N],
    affine: Many<N>,
    #[cfg(has_quaternions)]
    drift: [Many<N>; N],
}

impl Linear {
    fn new() -> Self {
        const NONE: Lanes = Lanes([0.0; 8]);
        Self {
            by_y: [[NONE; N]; N],
            by_v: [[NONE; N]; N],
            by_u: [[NONE; M]; N],
            affine: [NONE; N],
            #[cfg(has_quaternions)]
            drift: [[NONE; N]; N],
        }
    }

    fn compute(&mut self, Input { y, v, u, .. }: &Input) {
        let Self {
            by_y,
            by_v,
            by_u,
            affine,
            ..
        } = self;
        // SAFETY: `main` asked the processor for the instructions.
        #[cfg(has_quaternions)]
        unsafe {
            linearize_lanes(y, v, u, by_y, by_v, by_u, affine, &mut self.drift)
        };
        #[cfg(not(has_quaternions))]
        unsafe {
            linearize_lanes(y, v, u, by_y, by_v, by_u, affine)
        };
    }

    /// Fails where a state has other bits than the scalar function gives.
    fn same(&self, i: usize, Single { y, v, u, .. }: &Single) {
        #[cfg(has_quaternions)]
        let (by_y, by_v, by_u, affine, drift) = robot::linearize(y, v, u);
        #[cfg(not(has_quaternions))]
        let (by_y, by_v, by_u, affine) = robot::linearize(y, v, u);
        #[cfg(has_quaternions)]
        same_rows(&self.drift, i, drift);
        same_rows(&self.by_y, i, by_y);
        same_rows(&self.by_v, i, by_v);
        same_rows(&self.by_u, i, by_u);
        assert_eq!(bits(state(&self.affine, i)), bits(affine));
    }
}

fn linearize(inputs: &[Input]) {
    let single = singles(inputs);
    let mut many = Box::new(Linear::new());
    for (input, states) in inputs.iter().zip(single.chunks(8)) {
        many.compute(input);
        (0..).zip(states).for_each(|(i, state)| many.same(i, state));
    }
    let mut scalar = Box::new(Scalar::new());
    report(
        "linearize",
        || {
            for state in black_box(&single) {
                scalar.compute(state);
                black_box(&scalar);
            }
        },
        || {
            for input in black_box(inputs) {
                many.compute(input);
                black_box(&many);
            }
        },
    );
}

/// The results of `linearize` of one state.
struct Scalar {
    by_y: [[f64; N]; N],
    by_v: [[f64; N]; N],
    by_u: [[f64; M]; N],
    affine: [f64; N],
    #[cfg(has_quaternions)]
    drift: [[f64; N]; N],
}

impl Scalar {
    fn new() -> Self {
        Self {
            by_y: [[0.0; N]; N],
            by_v: [[0.0; N]; N],
            by_u: [[0.0; M]; N],
            affine: [0.0; N],
            #[cfg(has_quaternions)]
            drift: [[0.0; N]; N],
        }
    }

    fn compute(&mut self, Single { y, v, u, .. }: &Single) {
        let Self {
            by_y,
            by_v,
            by_u,
            affine,
            ..
        } = self;
        #[cfg(has_quaternions)]
        robot::linearize_into(y, v, u, by_y, by_v, by_u, affine, &mut self.drift);
        #[cfg(not(has_quaternions))]
        robot::linearize_into(y, v, u, by_y, by_v, by_u, affine);
    }
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
    let inputs: Vec<Input> = (0..STATES / 8).map(|_| input(&mut number)).collect();
    inverse_dynamics(&inputs);
    linearize(&inputs);
}

fn input(number: &mut impl FnMut() -> f64) -> Input {
    let mut lanes = || Lanes(core::array::from_fn(|_| number()));
    #[cfg_attr(not(has_quaternions), allow(unused_mut, reason = "no quaternion"))]
    let mut input = Input {
        y: core::array::from_fn(|_| lanes()),
        v: core::array::from_fn(|_| lanes()),
        a: core::array::from_fn(|_| lanes()),
        u: core::array::from_fn(|_| lanes()),
    };
    #[cfg(has_quaternions)]
    for i in 0..8 {
        let mut y = state(&input.y, i);
        assert!(robot::normalize(&mut y));
        (input.y.iter_mut().zip(y)).for_each(|(many, x)| many.0[i] = x);
    }
    input
}
