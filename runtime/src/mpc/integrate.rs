//! Integration of the nonlinear robot over one period with several Runge–Kutta steps. The number of steps depends on
//! the fastest rate of the robot.

use crate::control_loop::ControllerFault;
use crate::control_loop::zero_order_hold::{magnitude, rate, too_fast};
use crate::dynamics::{Discretizable, Linearization, Step};

/// Largest allowed product of the fastest rate of the robot and the length of a Runge–Kutta step. The method is stable
/// up to 2.78.
const STABLE: f64 = 2.5;
/// Largest number of steps in a period, even for a stiffer robot.
const MAX_SUBSTEPS: usize = 1000;

/// Number of Runge–Kutta steps in a period. The fastest rate of the robot is at most ν = (b + √(b² + 4a))/2 with
/// a = ‖∂ÿ/∂y‖ and b = ‖∂ÿ/∂ẏ‖.
pub(super) fn substeps<const N: usize, const M: usize, const NY: usize>(
    linear: &Linearization<N, M, NY>,
    period: f64,
) -> usize {
    let rate = rate(norm(&linear.by_coordinates), norm(&linear.by_velocities));
    ((period * rate / STABLE).ceil().max(1.0) as usize).min(MAX_SUBSTEPS)
}

/// Maximum norm: largest sum of the magnitudes in a row.
fn norm<const N: usize>(a: &[[f64; N]; N]) -> f64 {
    a.iter().map(magnitude).fold(0.0, f64::max)
}

/// A step of the implicit midpoint rule.
///
/// - `y`, `v`, `a`: positions and velocities before the step, and a guess of the accelerations
///
/// # Errors
/// The errors of [`discretize`](crate::control_loop::zero_order_hold::discretize).
pub(super) fn midpoint<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    y: &[f64; NY],
    v: &[f64; N],
    a: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> Result<Step<N, M, NY>, ControllerFault> {
    let step = model.midpoint_step(y, v, a, u, period);
    if step.is_finite() { Ok(step) } else { Err(too_fast(model, y, v, u, period)) }
}

/// A period of the integration.
#[derive(Clone, Copy)]
pub(super) struct Span {
    /// Time at which the period begins (s).
    pub start: f64,
    /// Length of the period (s).
    pub period: f64,
    /// Number of Runge–Kutta steps in the period.
    pub substeps: usize,
}

impl Span {
    /// Times at which the steps begin (s).
    pub fn steps(self) -> impl Iterator<Item = f64> {
        (0..self.substeps).map(move |k| self.start + k as f64 * self.length())
    }

    /// Length of a step (s).
    pub fn length(self) -> f64 {
        self.period / self.substeps as f64
    }
}

/// State after a period, and its derivatives by the chain rule over the steps.
pub(super) fn integrate<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    span: Span,
) -> Step<N, M, NY> {
    let length = span.length();
    let mut whole = model.at_time(span.start, |model| model.step_derivatives(y, v, u, length));
    for start in span.steps().skip(1) {
        let (y, v) = (&whole.coordinates, &whole.velocities);
        let next = model.at_time(start, |model| model.step_derivatives(y, v, u, length));
        let (state, input) = (whole.state, whole.input);
        whole = next;
        for row in 0..2 {
            for column in 0..2 {
                let mut block = [[0.0; N]; N];
                add_product(&mut block, &next.state[row][0], &state[0][column]);
                add_product(&mut block, &next.state[row][1], &state[1][column]);
                whole.state[row][column] = block;
            }
            add_product(&mut whole.input[row], &next.state[row][0], &input[0]);
            add_product(&mut whole.input[row], &next.state[row][1], &input[1]);
        }
    }
    whole
}

pub(super) fn add_product<const N: usize, const C: usize>(
    sum: &mut [[f64; C]; N],
    a: &[[f64; N]; N],
    b: &[[f64; C]; N],
) {
    for i in 0..N {
        for k in 0..N {
            for j in 0..C {
                sum[i][j] += a[i][k] * b[k][j];
            }
        }
    }
}

/// State vector with the positions before the velocities.
pub(super) fn join<const N: usize, const NX: usize>(y: &[f64; N], v: &[f64; N]) -> [f64; NX] {
    let mut state = [0.0; NX];
    state[..N].copy_from_slice(y);
    state[N..].copy_from_slice(v);
    state
}
