//! A step of the implicit midpoint rule with its sensitivities.

use super::solve::product;
use super::traits::Differentiable;
use super::types::Step;

/// One row of the right-hand sides: by positions, by velocities, by inputs, and the residual.
#[derive(Clone, Copy)]
struct Row<const N: usize, const M: usize> {
    by_y: [f64; N],
    by_v: [f64; N],
    by_u: [f64; M],
    rest: f64,
}

impl<const N: usize, const M: usize> Row<N, M> {
    #[inline]
    fn subtract(&mut self, factor: f64, other: &Self) {
        for j in 0..N {
            self.by_y[j] -= factor * other.by_y[j];
            self.by_v[j] -= factor * other.by_v[j];
        }
        for j in 0..M {
            self.by_u[j] -= factor * other.by_u[j];
        }
        self.rest -= factor * other.rest;
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
    let mean: [f64; N] = core::array::from_fn(|i| v[i] + half * a[i]);
    let way = mean.map(|v| half * v);
    let middle = robot.integrate(y, &way);
    let (forces, mut matrix) = robot.inverse_dynamics_derivatives_and_mass_matrix(&middle, &mean, a);
    let (driving, driving_by_y) = robot.input_forces_derivatives(&middle, u);
    let input_matrix = robot.input_matrix(&middle);
    let mut by_y = forces.by_coordinates;
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
    let mut rows: [Row<N, M>; N] = core::array::from_fn(|i| Row {
        by_y: by_y[i].map(|k| -period * k),
        by_v: core::array::from_fn(|j| -period * (forces.by_velocities[i][j] + half * by_way[i][j])),
        by_u: input_matrix[i].map(|b| period * b),
        rest: period * (driving[i] - forces.forces[i]),
    });
    for i in 0..N {
        for j in 0..N {
            matrix[i][j] -= 0.5 * rows[i].by_v[j];
        }
    }
    solve(&mut matrix, &mut rows);
    stepped(robot, (y, v, a), &mean, &rows, period)
}

/// The step, whose changes of the velocities are `rows`.
#[inline]
fn stepped<D: Differentiable<N, M, NY> + ?Sized, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    (y, v, a): (&[f64; NY], &[f64; N], &[f64; N]),
    mean: &[f64; N],
    rows: &[Row<N, M>; N],
    period: f64,
) -> Step<N, M, NY> {
    let half = 0.5 * period;
    let lower = |column: fn(&Row<N, M>) -> [f64; N]| -> [[f64; N]; N] { rows.map(|row| column(&row)) };
    let (by_y, mut by_v) = (lower(|row| row.by_y), lower(|row| row.by_v));
    // T/2 times the sum of the velocities before and after.
    let way_by_y = by_y.map(|row| row.map(|x| half * x));
    let mut way_by_v = by_v.map(|row| row.map(|x| half * x));
    for i in 0..N {
        way_by_v[i][i] += period;
        by_v[i][i] += 1.0;
    }
    let by_u = rows.map(|row| row.by_u);
    let way_by_u = by_u.map(|row| row.map(|x| half * x));
    let correction: [f64; N] = core::array::from_fn(|i| half * rows[i].rest);
    let whole = mean.map(|v| period * v);
    let velocities = core::array::from_fn(|i| v[i] + period * a[i] + rows[i].rest);
    let mut state = [[way_by_y, way_by_v], [by_y, by_v]];
    let mut input = [way_by_u, by_u];
    if NY == N {
        (0..N).for_each(|i| state[0][0][i][i] += 1.0);
        let way = core::array::from_fn(|i| whole[i] + correction[i]);
        return Step { coordinates: robot.integrate(y, &way), velocities, state, input };
    }
    let (by_position, by_displacement) = robot.integrate_derivatives(y, &whole);
    state[0] = state[0].map(|block| times(&by_displacement, &block));
    input[0] = times(&by_displacement, &input[0]);
    for i in 0..N {
        for j in 0..N {
            state[0][0][i][j] += by_position[i][j];
        }
    }
    let correction = by_displacement.map(|row| product(&row, &correction));
    let coordinates = robot.integrate(&robot.integrate(y, &whole), &correction);
    Step { coordinates, velocities, state, input }
}

/// Gaussian elimination with partial pivoting (Golub and Van Loan, Matrix Computations, 2013, section 3.4). Not finite where
/// the matrix is singular.
#[inline]
fn solve<const N: usize, const M: usize>(matrix: &mut [[f64; N]; N], rows: &mut [Row<N, M>; N]) {
    let mut inverse = [0.0; N];
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if matrix[i][k].abs() > matrix[pivot][k].abs() {
                pivot = i;
            }
        }
        matrix.swap(k, pivot);
        rows.swap(k, pivot);
        inverse[k] = 1.0 / matrix[k][k];
        let (above, row) = (matrix[k], rows[k]);
        for i in k + 1..N {
            let factor = matrix[i][k] * inverse[k];
            for j in k + 1..N {
                matrix[i][j] -= factor * above[j];
            }
            rows[i].subtract(factor, &row);
        }
    }
    for k in (0..N).rev() {
        let mut row = rows[k];
        for j in k + 1..N {
            row.subtract(matrix[k][j], &rows[j]);
        }
        row.by_y = row.by_y.map(|x| x * inverse[k]);
        row.by_v = row.by_v.map(|x| x * inverse[k]);
        row.by_u = row.by_u.map(|x| x * inverse[k]);
        row.rest *= inverse[k];
        rows[k] = row;
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
