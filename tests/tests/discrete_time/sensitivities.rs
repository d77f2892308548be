//! `step_derivatives` against differences of `step`, and of the adaptive integrator.

use fastrand::Rng;
use gelenk_runtime::dynamics::Discretizable;

use super::integrator::{integrated, time_without_turning};
use super::{for_each_robot, robots, rows, smooth_state};

/// Inputs are moved by so much at most, and velocities with them: friction bends within a few hundredths of rad/s.
const INPUT: f64 = 0.02;
const VELOCITY: f64 = 2e-3;

/// How far each input is moved: as far as velocities allow, since rounding then matters less.
///
/// - `by_inputs`: ∂ẏ⁺/∂u, which need not be right for that
fn widths<const N: usize, const M: usize>(by_inputs: &[[f64; M]; N]) -> [f64; M] {
    core::array::from_fn(|input| {
        let fastest = by_inputs.iter().map(|row| row[input].abs()).fold(0.0, f64::max);
        INPUT.min(VELOCITY / fastest)
    })
}

/// Central differences of order 6 of a function of x = (y, ẏ) and u, row by row.
fn differences<const N: usize, const M: usize>(
    function: impl Fn(&[f64], &[f64; M]) -> Vec<f64>,
    state: &[f64],
    u: &[f64; M],
    widths: [f64; M],
) -> Vec<Vec<f64>> {
    const WEIGHTS: [(f64, f64); 3] = [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)];
    let mut rows = vec![vec![0.0; 2 * N + M]; 2 * N];
    for column in 0..2 * N + M {
        for (distance, weight) in WEIGHTS {
            for sign in [-1.0, 1.0] {
                let (mut state, mut u) = (state.to_vec(), *u);
                let (moved, width) = match column.checked_sub(2 * N) {
                    None => (&mut state[column], 2e-4),
                    Some(input) => (&mut u[input], widths[input]),
                };
                *moved += sign * distance * width;
                let values = function(&state, &u);
                for (row, value) in rows.iter_mut().zip(values) {
                    row[column] += sign * weight / width * value;
                }
            }
        }
    }
    rows
}

/// Relative to the largest entry of the same half and block of columns.
fn error(found: &[Vec<f64>], expected: &[Vec<f64>], n: usize) -> f64 {
    let mut worst = 0.0_f64;
    for rows in [0..n, n..2 * n] {
        for columns in [0..n, n..2 * n, 2 * n..found[0].len()] {
            let entries = rows.clone().flat_map(|i| columns.clone().map(move |j| (i, j)));
            let scale = entries.clone().map(|(i, j)| expected[i][j].abs()).fold(0.0, f64::max);
            let difference = entries.map(|(i, j)| (found[i][j] - expected[i][j]).abs());
            worst = worst.max(difference.fold(0.0, f64::max) / scale);
        }
    }
    worst
}

fn check<const N: usize, const M: usize>(name: &str, robot: &impl Discretizable<N, M>) {
    let mut rng = Rng::with_seed(3);
    for _ in 0..3 {
        let (y, v, u) = smooth_state(robot, &mut rng);
        let state = [y, v].concat();
        let halves = |state: &[f64]| {
            let half = |from: usize| -> [f64; N] { core::array::from_fn(|i| state[from + i]) };
            (half(0), half(N))
        };

        // The states of the differences lie around; they shall not turn either.
        let quiet = time_without_turning(robot, &state, &u, 0.02);
        let period = quiet / 4.0;
        let step = robot.step_derivatives(&y, &v, &u, period);
        let (coordinates, velocities) = robot.step(&y, &v, &u, period);
        for (a, b) in [(step.coordinates, coordinates), (step.velocities, velocities)] {
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{name}: {a} and {b}");
            }
        }
        let of_steps = |state: &[f64], u: &[f64; M]| {
            let (y, v) = halves(state);
            let (y, v) = robot.step(&y, &v, u, period);
            [y, v].concat()
        };
        let found = rows(&step.state, &step.input);
        let exactness =
            error(&found, &differences::<N, M>(of_steps, &state, &u, widths::<N, M>(&step.input[1])), N);

        // A short time, so that the steps' own error stays small; the integrator's 13 digits leave seven of
        // differences by inputs, which move coordinates by millionths in it.
        let period = quiet / 10.0;
        let step = robot.step_derivatives(&y, &v, &u, period);
        let of_flow = |state: &[f64], u: &[f64; M]| integrated(robot, state, u, period);
        let found = rows(&step.state, &step.input);
        let agreement =
            error(&found, &differences::<N, M>(of_flow, &state, &u, widths::<N, M>(&step.input[1])), N);
        println!("{name}: of steps {exactness:.1e}, of the flow {agreement:.1e}");
        assert!(exactness <= 1e-7, "{name}: {exactness:e}");
        assert!(agreement <= 1e-5, "{name}: {agreement:e}");
    }
}

#[test]
fn they_are_the_derivatives_of_steps_and_close_to_those_of_the_flow() {
    for_each_robot!(check);
}
