//! A generated module as a program: states come in, what the functions make of them goes out, as text.
//!
//! `compare.py` compiles it, with the module's path in `GELENK_MODULE` and `--cfg has_forward_dynamics` where
//! there is one. Each line of standard input holds y, v, a and u of one state; the answer has one line for
//! each array, rows first.

#[allow(dead_code, reason = "the comparison calls some of the functions")]
mod robot {
    include!(env!("GELENK_MODULE"));
}

use robot::{JOINT_NAMES, M, N};
use std::io::BufRead;

/// Unoptimized code of a large robot keeps a million values on the stack.
const STACK: usize = 1 << 30;

fn main() {
    let calls = std::thread::Builder::new().stack_size(STACK).spawn(answer);
    calls.expect("a thread").join().expect("an answer");
}

fn answer() {
    println!("{N} {M}");
    for name in JOINT_NAMES {
        println!("{name}");
    }
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("standard input is text");
        let numbers = line
            .split_whitespace()
            .map(|word| word.parse().expect("a number"));
        let numbers: Vec<f64> = numbers.collect();
        assert_eq!(numbers.len(), 3 * N + M);
        let part = |at: usize| -> [f64; N] {
            numbers[at * N..(at + 1) * N].try_into().expect("N numbers")
        };
        let inputs: [f64; M] = numbers[3 * N..].try_into().expect("M numbers");
        state(&part(0), &part(1), &part(2), &inputs);
    }
}

fn state(y: &[f64; N], v: &[f64; N], a: &[f64; N], u: &[f64; M]) {
    print("mass_matrix", robot::mass_matrix(y).as_flattened());
    print("coriolis_forces", &robot::coriolis_forces(y, v));
    print("gravity_forces", &robot::gravity_forces(y));
    print("inverse_dynamics", &robot::inverse_dynamics(y, v, a));
    let (_, by_y, by_v) = robot::inverse_dynamics_derivatives(y, v, a);
    print("inverse_dynamics_by_y", by_y.as_flattened());
    print("inverse_dynamics_by_v", by_v.as_flattened());
    #[cfg(has_forward_dynamics)]
    print("forward_dynamics", &robot::forward_dynamics(y, v, u));
    #[cfg(not(has_forward_dynamics))]
    let _ = u;
}

fn print(name: &str, array: &[f64]) {
    let numbers: Vec<String> = array.iter().map(|x| format!("{x:?}")).collect();
    println!("{name} {}", numbers.join(" "));
}
