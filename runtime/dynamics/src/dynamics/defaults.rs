//! Default implementations of methods, for modules that were generated without the corresponding functions.

use super::lanes::{LANES, Point};
use super::load_friction::{load, under_load};
use super::manifold::same;
use super::midpoint::{Columns, solve, times};
use super::solve::{product, solve_positive_definite};
use super::traits::{Differentiable, Discretizable, Dynamics};
use super::types::{Discretization, ForceDerivativesAndMass, Linearization, Step};
use core::cell::Cell;
use gelenk_kernels::discrete_time;

/// Computes the applied forces `gravity + springs − friction`, as default of [`Dynamics::applied_forces`].
#[inline]
pub fn applied_forces<D: Dynamics<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
) -> [f64; N] {
    let (gravity, springs) = (robot.gravity_forces(y), robot.spring_forces(y, v));
    let friction = robot.friction_torques(y, v);
    core::array::from_fn(|i| gravity[i] + springs[i] - friction[i])
}

/// Returns zero, which is [`Dynamics::load_friction`] of a robot without load-dependent friction.
#[inline]
pub fn load_friction<D: Dynamics<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    _: &D,
    _: &[f64; NY],
    _: &[f64; N],
) -> [f64; N] {
    [0.0; N]
}

/// Computes the bias forces, which are the Coriolis forces minus gravity, as default of
/// [`Dynamics::bias_forces`].
#[inline]
pub fn bias_forces<D: Dynamics<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
) -> [f64; N] {
    let (coriolis, gravity) = (robot.coriolis_forces(y, v), robot.gravity_forces(y));
    core::array::from_fn(|i| coriolis[i] - gravity[i])
}

/// Computes mass matrix, Coriolis forces and applied forces separately, as default of
/// [`Dynamics::equations_of_motion`].
#[inline]
pub fn equations_of_motion<
    D: Dynamics<N, M, NY> + ?Sized,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
) -> ([[f64; N]; N], [f64; N], [f64; N]) {
    (robot.mass_matrix(y), robot.coriolis_forces(y, v), robot.applied_forces(y, v))
}

/// Computes the forces `M ÿ + k − q` plus load-dependent friction from mass matrix M, Coriolis forces k and
/// applied forces q, as default of [`Dynamics::inverse_dynamics`].
#[inline]
pub fn inverse_dynamics<D: Dynamics<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    a: &[f64; N],
) -> [f64; N] {
    let (mass, coriolis, applied) = robot.equations_of_motion(y, v);
    let (friction, shares) = (robot.friction_torques(y, v), robot.load_friction(y, v));
    core::array::from_fn(|i| {
        let force = product(&mass[i], a) + coriolis[i] - applied[i];
        force + under_load(force - friction[i], shares[i])
    })
}

/// Computes the accelerations by a factorization of the mass matrix, as default of
/// [`Dynamics::forward_dynamics`].
#[inline]
pub fn forward_dynamics<D: Dynamics<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
) -> [f64; N] {
    let (mass, coriolis, applied) = robot.equations_of_motion(y, v);
    let input_matrix = robot.input_matrix(y);
    let (friction, shares) = (robot.friction_torques(y, v), robot.load_friction(y, v));
    let forces = core::array::from_fn(|i| {
        let input = product(&input_matrix[i], u);
        let load = load(input - friction[i], shares[i]);
        applied[i] + input - coriolis[i] - under_load(load, shares[i])
    });
    solve_positive_definite(mass, forces)
}

/// Computes the kinetic energy `½ vᵀ M v` from the mass matrix M and the velocities v, as default of
/// [`Dynamics::kinetic_energy`].
#[inline]
pub fn kinetic_energy<D: Dynamics<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
) -> f64 {
    let mass = robot.mass_matrix(y);
    let momentum: [f64; N] = core::array::from_fn(|i| product(&mass[i], v));
    0.5 * product(&momentum, v)
}

/// Computes derivatives of the inverse dynamics and the mass matrix separately, as default of
/// [`Differentiable::inverse_dynamics_derivatives_and_mass_matrix`].
#[inline]
pub fn inverse_dynamics_derivatives_and_mass_matrix<
    D: Differentiable<N, M, NY> + ?Sized,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    a: &[f64; N],
) -> ForceDerivativesAndMass<N> {
    let (forces, mut mass) = (robot.inverse_dynamics_derivatives(y, v, a), robot.mass_matrix(y));
    let shares = robot.load_friction(y, v);
    if shares == [0.0; N] {
        return (forces, mass);
    }
    let friction = robot.friction_torques(y, v);
    for i in 0..N {
        let load = load(forces.forces[i] - friction[i], shares[i]);
        let gain = if load < 0.0 { 1.0 - shares[i] } else { 1.0 + shares[i] };
        mass[i] = mass[i].map(|entry| gain * entry);
    }
    (forces, mass)
}

/// Computes the forces of the inputs and their derivatives from derivatives of the inverse dynamics, as
/// default of [`Differentiable::input_forces_derivatives`].
#[inline]
pub fn input_forces_derivatives<
    D: Differentiable<N, M, NY> + ?Sized,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    robot: &D,
    y: &[f64; NY],
    u: &[f64; M],
) -> ([f64; N], [[f64; N]; N]) {
    let input_forces = robot.input_matrix(y).map(|row| product(&row, u));
    if robot.drives() >= M {
        return (input_forces, [[0.0; N]; N]);
    }
    let rest = [0.0; N];
    let by_y = robot.linearize(y, &rest, u).by_coordinates;
    let a = robot.forward_dynamics(y, &rest, u);
    let (forces, mass) = robot.inverse_dynamics_derivatives_and_mass_matrix(y, &rest, &a);
    let mut derivatives = times(&mass, &by_y);
    for (row, by_coordinates) in derivatives.iter_mut().zip(&forces.by_coordinates) {
        row.iter_mut().zip(by_coordinates).for_each(|(entry, other)| *entry += other);
    }
    (input_forces, derivatives)
}

/// Computes the zero-order hold of the linearization, as default of [`Discretizable::discretize`].
#[inline]
pub fn discretize<D: Differentiable<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> Discretization<N, M, NY> {
    let linear = robot.linearize(y, v, u);
    // The compiler evaluates the condition. Arms use the first form, and robots with quaternions the second form.
    if NY == N { linear.held(period) } else { linear.discretize_with(&robot.drift(v), period) }
}

/// Computes Runge–Kutta steps of the forward dynamics, as default of [`Discretizable::step`]. Does not
/// compile for robots with quaternions.
#[inline]
pub fn step<D: Discretizable<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> ([f64; NY], [f64; N]) {
    let acceleration = |y: &[f64; N], v: &[f64; N]| robot.forward_dynamics(same(y), v, u);
    let (y, v) = discrete_time::runge_kutta(*same(y), *v, period, D::SUBSTEPS, acceleration);
    (*same(&y), v)
}

/// Computes Runge–Kutta steps with derivatives from linearizations, as default of
/// [`Discretizable::step_derivatives`]. Does not compile for robots with quaternions.
#[inline]
pub fn step_derivatives<
    D: Discretizable<N, M, NY> + ?Sized,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> Step<N, M, NY> {
    let linearize = |y: &[f64; N], v: &[f64; N]| {
        let linear = robot.linearize(same(y), v, u);
        (linear.by_coordinates, linear.by_velocities, linear.by_inputs, linear.affine)
    };
    let (coordinates, velocities, state, input) =
        discrete_time::runge_kutta_derivatives(same(y), v, u, period, D::SUBSTEPS, linearize);
    Step { coordinates: *same(&coordinates), velocities, state, input }
}

/// Computes a midpoint step from derivatives of the inverse dynamics, as default of
/// [`Discretizable::midpoint_step`].
#[inline]
pub fn midpoint_step<
    D: Differentiable<N, M, NY> + ?Sized,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    a: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> Step<N, M, NY> {
    let half = 0.5 * period;
    let (mut mean, mut way) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        mean[i] = v[i] + half * a[i];
        way[i] = half * mean[i];
    }
    let middle = robot.integrate(y, &way);
    let (forces, mut matrix) = robot.inverse_dynamics_derivatives_and_mass_matrix(&middle, &mean, a);
    let (driving, driving_by_y) = robot.input_forces_derivatives(&middle, u);
    let (mut by_y, by_u) = (forces.by_coordinates, robot.input_matrix(&middle));
    for i in 0..N {
        for j in 0..N {
            by_y[i][j] -= driving_by_y[i][j];
        }
    }
    let mut by_way = by_y;
    // The compiler evaluates the condition. For arms the tangents are the identity.
    if NY != N {
        let (by_position, by_displacement) = robot.integrate_derivatives(y, &way);
        (by_way, by_y) = (times(&by_y, &by_displacement), times(&by_y, &by_position));
    }
    let mut columns = Columns { by_y, by_v: forces.by_velocities, by_u, rest: driving };
    for i in 0..N {
        for j in 0..N {
            let by_v = -period * (columns.by_v[i][j] + half * by_way[i][j]);
            columns.by_v[i][j] = by_v;
            columns.by_y[i][j] *= -period;
            matrix[i][j] -= 0.5 * by_v;
        }
        columns.by_u[i].iter_mut().for_each(|entry| *entry *= period);
        columns.rest[i] = period * (columns.rest[i] - forces.forces[i]);
    }
    solve(&mut matrix, &mut columns);
    stepped(robot, y, v, a, &mean, &columns, period)
}

/// Returns the result of a midpoint step. `columns` contains the changes of the velocities and their derivatives.
#[inline]
fn stepped<D: Differentiable<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    y: &[f64; NY],
    v: &[f64; N],
    a: &[f64; N],
    mean: &[f64; N],
    columns: &Columns<N, M>,
    period: f64,
) -> Step<N, M, NY> {
    let half = 0.5 * period;
    let mut step = Step {
        coordinates: *y,
        velocities: *v,
        state: [[columns.by_y, columns.by_v]; 2],
        input: [columns.by_u; 2],
    };
    let (mut whole, mut correction) = ([0.0; N], [0.0; N]);
    // The change of the positions is T/2 times the sum of the velocities before and after the step.
    for i in 0..N {
        (whole[i], correction[i]) = (period * mean[i], half * columns.rest[i]);
        step.velocities[i] += period * a[i] + columns.rest[i];
        step.state[1][1][i][i] += 1.0;
        for j in 0..N {
            step.state[0][0][i][j] *= half;
            step.state[0][1][i][j] *= half;
        }
        step.state[0][1][i][i] += period;
        step.input[0][i].iter_mut().for_each(|entry| *entry *= half);
    }
    if NY == N {
        for i in 0..N {
            whole[i] += correction[i];
            step.state[0][0][i][i] += 1.0;
        }
        step.coordinates = robot.integrate(y, &whole);
        return step;
    }
    let (by_position, by_displacement) = robot.integrate_derivatives(y, &whole);
    for block in &mut step.state[0] {
        *block = times(&by_displacement, block);
    }
    step.input[0] = times(&by_displacement, &step.input[0]);
    let correction = by_displacement.map(|row| product(&row, &correction));
    for i in 0..N {
        for j in 0..N {
            step.state[0][0][i][j] += by_position[i][j];
        }
    }
    step.coordinates = robot.integrate(&robot.integrate(y, &whole), &correction);
    step
}

/// Computes Runge–Kutta steps from `time` (s) on, for a robot with time-dependent equations. Each stage of
/// the method uses the robot at the time of the stage.
#[inline]
pub fn step_from<D: Discretizable<N, M>, const N: usize, const M: usize>(
    robot: &D,
    time: f64,
    y: &[f64; N],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> ([f64; N], [f64; N]) {
    let stages = StageTimes::new(time, period / D::SUBSTEPS as f64);
    let acceleration =
        |y: &[f64; N], v: &[f64; N]| robot.at_time(stages.next(), |robot| robot.forward_dynamics(y, v, u));
    discrete_time::runge_kutta(*y, *v, period, D::SUBSTEPS, acceleration)
}

/// Computes Runge–Kutta steps with derivatives from `time` (s) on, for a robot with time-dependent equations.
#[inline]
pub fn step_derivatives_from<D: Discretizable<N, M>, const N: usize, const M: usize>(
    robot: &D,
    time: f64,
    y: &[f64; N],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> Step<N, M> {
    let stages = StageTimes::new(time, period / D::SUBSTEPS as f64);
    let linearize = |y: &[f64; N], v: &[f64; N]| {
        let linear = robot.at_time(stages.next(), |robot| robot.linearize(y, v, u));
        (linear.by_coordinates, linear.by_velocities, linear.by_inputs, linear.affine)
    };
    let (coordinates, velocities, state, input) =
        discrete_time::runge_kutta_derivatives(y, v, u, period, D::SUBSTEPS, linearize);
    Step { coordinates, velocities, state, input }
}

/// Times of the stages of Runge–Kutta steps (s), in the order in which the method evaluates accelerations. Each step has one
/// stage at its beginning, two stages in its middle, and one stage at its end.
struct StageTimes {
    start: f64,
    step: f64,
    taken: Cell<usize>,
}

impl StageTimes {
    fn new(start: f64, step: f64) -> Self {
        Self { start, step, taken: Cell::new(0) }
    }

    fn next(&self) -> f64 {
        let taken = self.taken.replace(self.taken.get() + 1);
        let within = [0.0, 0.5, 0.5, 1.0][taken % 4];
        self.start + ((taken / 4) as f64 + within) * self.step
    }
}

/// Linearizes a robot at several points, eight points at a time if the module has functions for eight states.
///
/// - `by_lanes`: linearizes at up to eight points; false if the module has no function for this
#[inline]
pub fn linearize_along<D, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    points: &[Point<N, M, NY>],
    results: &mut [Linearization<N, M, NY>],
    by_lanes: impl Fn(&[Point<N, M, NY>], &mut [Linearization<N, M, NY>]) -> bool,
) where
    D: Differentiable<N, M, NY>,
{
    let count = points.len().min(results.len());
    for (points, results) in points[..count].chunks(LANES).zip(results[..count].chunks_mut(LANES)) {
        // A call for eight points takes as long as two or three calls for a single point.
        if points.len() < 3 || !by_lanes(points, results) {
            linearize_one_by_one(robot, points, results);
        }
    }
}

/// Linearizes a robot at several points by one call for each point.
pub fn linearize_one_by_one<D, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    points: &[Point<N, M, NY>],
    results: &mut [Linearization<N, M, NY>],
) where
    D: Differentiable<N, M, NY>,
{
    for (Point { time, positions, velocities, inputs }, result) in points.iter().zip(results) {
        *result = robot.at_time(*time, |robot| robot.linearize(positions, velocities, inputs));
    }
}
