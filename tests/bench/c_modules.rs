//! Time per call of a module in C over that of the same module in Rust, round by round.
//!
//! `c_modules.sh` compiles it, with the path of the Rust module in `GELENK_MODULE`, and links the module in C.

#[allow(dead_code, reason = "only some functions are measured")]
mod robot {
    include!(env!("GELENK_MODULE"));
}

use robot::{M, N};
use std::hint::black_box;
use std::time::Instant;

const STATES: usize = 64;
/// Many short rounds: a median of long ones is that of the machine's other work where its processors are shared.
const ROUNDS: usize = 8001;
const CALLS: usize = 1;

type Vector = [f64; N];
type Matrix = [[f64; N]; N];

unsafe extern "C" {
    fn c_inverse_dynamics(y: *const f64, v: *const f64, a: *const f64, tau: *mut f64);
    fn c_forward_dynamics(y: *const f64, v: *const f64, u: *const f64, a: *mut f64);
    fn c_linearize(
        y: *const f64,
        v: *const f64,
        u: *const f64,
        by_y: *mut f64,
        by_v: *mut f64,
        by_u: *mut f64,
        c: *mut f64,
    );
}

struct State {
    y: Vector,
    v: Vector,
    a: Vector,
    u: [f64; M],
}

/// Random states, the same in each run.
fn states() -> Vec<State> {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut number = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        4.0 * (seed >> 11) as f64 / (1_u64 << 53) as f64 - 2.0
    };
    let mut state = || State {
        y: core::array::from_fn(|_| number()),
        v: core::array::from_fn(|_| number()),
        a: core::array::from_fn(|_| number()),
        u: core::array::from_fn(|_| number()),
    };
    (0..STATES).map(|_| state()).collect()
}

/// Nanoseconds per call, over all states.
fn time(states: &[State], call: &mut dyn FnMut(&State)) -> f64 {
    let start = Instant::now();
    for _ in 0..CALLS {
        for state in states {
            call(black_box(state));
        }
    }
    start.elapsed().as_nanos() as f64 / (CALLS * STATES) as f64
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn compare(name: &str, states: &[State], rust: &mut dyn FnMut(&State), c: &mut dyn FnMut(&State)) {
    let (mut times, mut ratios) = (vec![], vec![]);
    for round in 0..ROUNDS {
        // Either is the first one in turn.
        let (in_rust, in_c) = if round % 2 == 0 {
            let rust = time(states, rust);
            (rust, time(states, c))
        } else {
            let c = time(states, c);
            (time(states, rust), c)
        };
        times.push(in_rust);
        ratios.push(in_c / in_rust);
    }
    println!("{name:<20} Rust {:7.1} ns   C/Rust {:.3}", median(times), median(ratios));
}

fn main() {
    let states = states();
    let (mut out, mut c_out) = ([0.0; N], [0.0; N]);
    compare(
        "inverse_dynamics",
        &states,
        &mut |s| out = black_box(robot::inverse_dynamics(&s.y, &s.v, &s.a)),
        // SAFETY: the arrays are as long as the header says.
        &mut |s| unsafe {
            c_inverse_dynamics(s.y.as_ptr(), s.v.as_ptr(), s.a.as_ptr(), c_out.as_mut_ptr());
            black_box(&c_out);
        },
    );
    compare(
        "forward_dynamics",
        &states,
        &mut |s| out = black_box(robot::forward_dynamics(&s.y, &s.v, &s.u)),
        // SAFETY: as above.
        &mut |s| unsafe {
            c_forward_dynamics(s.y.as_ptr(), s.v.as_ptr(), s.u.as_ptr(), c_out.as_mut_ptr());
            black_box(&c_out);
        },
    );
    let mut in_rust: (Matrix, Matrix, [[f64; M]; N], Vector) =
        ([[0.0; N]; N], [[0.0; N]; N], [[0.0; M]; N], [0.0; N]);
    let mut in_c = in_rust;
    compare(
        "linearize",
        &states,
        &mut |s| {
            #[cfg(has_linearize_into)]
            robot::linearize_into(
                &s.y,
                &s.v,
                &s.u,
                &mut in_rust.0,
                &mut in_rust.1,
                &mut in_rust.2,
                &mut in_rust.3,
            );
            #[cfg(not(has_linearize_into))]
            {
                in_rust = robot::linearize(&s.y, &s.v, &s.u);
            }
            black_box(&in_rust);
        },
        // SAFETY: as above.
        &mut |s| unsafe {
            c_linearize(
                s.y.as_ptr(),
                s.v.as_ptr(),
                s.u.as_ptr(),
                in_c.0.as_mut_ptr().cast(),
                in_c.1.as_mut_ptr().cast(),
                in_c.2.as_mut_ptr().cast(),
                in_c.3.as_mut_ptr(),
            );
            black_box(&in_c);
        },
    );
}
