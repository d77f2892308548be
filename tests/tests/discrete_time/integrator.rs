//! `step` against an adaptive integrator of order 8 (DOP853: Hairer, Nørsett and Wanner 1993, section II.5).

use differential_equations::prelude::*;
use fastrand::Rng;
use gelenk_runtime::dynamics::Discretizable;

use super::{for_each_robot, robots, smooth_state};

/// ẋ over x = (y, ẏ).
struct Rates<F>(F);

impl<F: Fn(&[f64], &mut [f64])> ODE<f64, Vec<f64>> for Rates<F> {
    fn diff(&self, _: f64, state: &Vec<f64>, rates: &mut Vec<f64>) {
        (self.0)(state, rates);
    }
}

fn halves<const N: usize>(state: &[f64]) -> ([f64; N], [f64; N]) {
    (core::array::from_fn(|i| state[i]), core::array::from_fn(|i| state[N + i]))
}

/// The state after a time, to about 13 digits.
pub fn integrated<const N: usize, const M: usize>(
    robot: &impl Discretizable<N, M>,
    state: &[f64],
    u: &[f64; M],
    time: f64,
) -> Vec<f64> {
    let rates = Rates(|state: &[f64], rates: &mut [f64]| {
        let (y, v) = halves::<N>(state);
        rates[..N].copy_from_slice(&v);
        rates[N..].copy_from_slice(&robot.forward_dynamics(&y, &v, u));
    });
    let method = ExplicitRungeKutta::dop853().rtol(1e-13).atol(1e-15);
    let solution = IVP::ode(&rates, 0.0, time, state.to_vec()).method(method).solve();
    let solution = solution.unwrap_or_else(|_| panic!("no solution over {time} s"));
    let (end, state) = solution.last().expect("an end");
    assert!((end - time).abs() < 1e-16, "{end} of {time} s");
    state.clone()
}

/// A time, at most that given, in which no velocity passes zero, where `sign` jumps.
pub fn time_without_turning<const N: usize, const M: usize>(
    robot: &impl Discretizable<N, M>,
    state: &[f64],
    u: &[f64; M],
    longest: f64,
) -> f64 {
    let mut time = longest;
    let turns = |end: Vec<f64>| (N..2 * N).any(|i| end[i] * state[i] <= 0.0);
    while turns(integrated(robot, state, u, time)) {
        time /= 2.0;
    }
    time
}

/// The state after `count` steps.
fn stepped<const N: usize, const M: usize>(
    robot: &impl Discretizable<N, M>,
    state: &[f64],
    u: &[f64; M],
    time: f64,
    count: usize,
) -> Vec<f64> {
    let (mut y, mut v) = halves::<N>(state);
    for _ in 0..count {
        (y, v) = robot.step(&y, &v, u, time / count as f64);
    }
    [y, v].concat()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    differences.sum::<f64>().sqrt()
}

/// Halving the steps divides the error by 2⁴, once they are short enough.
fn check<const N: usize, const M: usize>(name: &str, robot: &impl Discretizable<N, M>) {
    // Below this the integrator's own error shows: such a state tells nothing of the steps.
    const JUDGED: f64 = 2e-10;
    let mut rng = Rng::with_seed(2);
    let mut judged = 0;
    while judged < 3 {
        let (y, v, u) = smooth_state(robot, &mut rng);
        let state = [y, v].concat();
        let time = time_without_turning(robot, &state, &u, 0.04);
        let exact = integrated(robot, &state, &u, time);
        let error = |count| distance(&stepped(robot, &state, &u, time, count), &exact);
        let one = error(1);
        if one < JUDGED {
            continue;
        }
        judged += 1;
        // Long enough that rounding does not matter, short enough that order 4 shows: steep friction asks for
        // errors far below that of one step, and above rounding.
        let small = 1e-7_f64.min((1e-4 * one).max(2e-12));
        let mut count = 1;
        while error(2 * count) > small {
            count *= 2;
        }
        let (coarse, fine) = (error(count), error(2 * count));
        println!("{name}: {count} steps {coarse:.2e}, ratio {:.2}", coarse / fine);
        assert!(count <= 512, "{name}: {count} steps");
        let ratio = coarse / fine;
        assert!((13.0..20.0).contains(&ratio), "{name}: {coarse:e} / {fine:e} = {ratio}");
    }
}

#[test]
fn the_error_falls_with_the_fourth_power_of_the_period() {
    for_each_robot!(check);
}
