//! A step of the implicit midpoint rule with its sensitivities.

use super::solve::product;
use super::traits::Differentiable;
use super::types::Step;

/// Right-hand sides, and then the changes of the velocities: by positions, by velocities, by inputs, and those of the
/// residual.
struct Columns<const N: usize, const M: usize> {
    by_y: [[f64; N]; N],
    by_v: [[f64; N]; N],
    by_u: [[f64; M]; N],
    rest: [f64; N],
}

impl<const N: usize, const M: usize> Columns<N, M> {
    /// Subtracts from row `i` so many times row `k`.
    #[inline]
    fn subtract(&mut self, i: usize, factor: f64, k: usize) {
        subtract(&mut self.by_y, i, factor, k);
        subtract(&mut self.by_v, i, factor, k);
        subtract(&mut self.by_u, i, factor, k);
        self.rest[i] -= factor * self.rest[k];
    }

    #[inline]
    fn scale(&mut self, i: usize, factor: f64) {
        self.by_y[i].iter_mut().for_each(|entry| *entry *= factor);
        self.by_v[i].iter_mut().for_each(|entry| *entry *= factor);
        self.by_u[i].iter_mut().for_each(|entry| *entry *= factor);
        self.rest[i] *= factor;
    }

    #[inline]
    fn swap(&mut self, i: usize, k: usize) {
        self.by_y.swap(i, k);
        self.by_v.swap(i, k);
        self.by_u.swap(i, k);
        self.rest.swap(i, k);
    }
}

/// Whole rows, which the compiler makes vectors of.
#[inline]
fn subtract<const N: usize, const C: usize>(rows: &mut [[f64; C]; N], i: usize, factor: f64, k: usize) {
    let other = rows[k];
    for (entry, other) in rows[i].iter_mut().zip(&other) {
        *entry -= factor * other;
    }
}

/// [`Discretizable::midpoint_step`](super::Discretizable::midpoint_step).
#[inline]
pub fn midpoint_step<
    D: Differentiable<N, M, NY> + ?Sized,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    robot: &D,
    (y, v, a): (&[f64; NY], &[f64; N], &[f64; N]),
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
    // Known to the compiler: of arms the tangents are the identity.
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
    stepped(robot, (y, v, a), &mean, &columns, period)
}

/// The step, whose changes of the velocities are `columns`.
#[inline]
fn stepped<D: Differentiable<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    (y, v, a): (&[f64; NY], &[f64; N], &[f64; N]),
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
    // T/2 times the sum of the velocities before and after.
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

/// Gaussian elimination with partial pivoting (Golub and Van Loan, Matrix Computations, 2013, section 3.4). Not finite where
/// the matrix is singular.
#[inline]
fn solve<const N: usize, const M: usize>(matrix: &mut [[f64; N]; N], columns: &mut Columns<N, M>) {
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if matrix[i][k].abs() > matrix[pivot][k].abs() {
                pivot = i;
            }
        }
        if pivot != k {
            matrix.swap(k, pivot);
            columns.swap(k, pivot);
        }
        let inverse = 1.0 / matrix[k][k];
        for i in k + 1..N {
            let factor = matrix[i][k] * inverse;
            subtract(matrix, i, factor, k);
            columns.subtract(i, factor, k);
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            columns.subtract(k, matrix[k][j], j);
        }
        columns.scale(k, 1.0 / matrix[k][k]);
    }
}

#[inline]
fn times<const N: usize, const C: usize>(a: &[[f64; N]; N], b: &[[f64; C]; N]) -> [[f64; C]; N] {
    let mut result = [[0.0; C]; N];
    for i in 0..N {
        for k in 0..N {
            for j in 0..C {
                result[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    result
}
