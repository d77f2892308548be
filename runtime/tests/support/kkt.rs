//! Residuals of the Karush–Kuhn–Tucker conditions, from the problem's own data and nothing of the solver's.

use super::wide_qp::row_value;
use gelenk_runtime::qp::{Penalty, QpProblem, QpRows, QpSolver};

fn times<const R: usize, const C: usize>(m: &[[f64; C]; R], v: &[f64; C]) -> [f64; R] {
    m.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}

/// Multipliers `λ ≥ 0` times slacks, and violations, of one bound, hard or soft.
fn complementarity(z: f64, lower: f64, upper: f64, multipliers: [f64; 2], penalty: Option<Penalty>) -> f64 {
    let mut worst = 0.0_f64;
    for (slack, multiplier) in [(z - lower, multipliers[0]), (upper - z, multipliers[1])] {
        assert!(multiplier >= 0.0);
        if slack.is_infinite() {
            assert_eq!(multiplier, 0.0);
            continue;
        }
        let violation = (-slack).max(0.0);
        match penalty {
            None => worst = worst.max(violation).max(multiplier * slack.abs()),
            // λ ≤ w₁ + w₂ v, with equality where v > 0.
            Some(p) => {
                let limit = p.linear + p.quadratic * violation;
                worst = worst
                    .max(multiplier - limit)
                    .max(violation * (limit - multiplier))
                    .max(multiplier * slack.max(0.0));
            }
        }
    }
    worst
}

/// Largest residual of the KKT conditions, from the problem's own data and nothing of the solver's.
pub fn kkt<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    solver: &QpSolver<NX, NU, NR>,
) -> f64 {
    let n = p.stages.len();
    let mut worst = 0.0_f64;
    let mut costate = [0.0; NX];
    for k in 0..n {
        let x = if k == 0 { p.initial_state } else { solver.state(k) };
        worst = worst.max(row_complementarity(p, solver, k, (&p.stages[k].rows, &x, &solver.input(k))));
    }
    worst = worst.max(row_complementarity(p, solver, n, (&p.terminal_rows, &solver.state(n), &[])));
    for k in (0..n).rev() {
        let stage = &p.stages[k];
        let (u, x) = (solver.input(k), solver.state(k + 1));
        let last = if k == 0 { p.initial_state } else { solver.state(k) };
        let (ax, bu) = (times(&stage.state_matrix, &last), times(&stage.input_matrix, &u));
        let weight = if k + 1 == n { &p.terminal_weight } else { &p.state_weight };
        let qx = times(weight, &x);
        let forces = solver.state_multipliers(k + 1);
        let next = costate;
        for i in 0..NX {
            worst = worst.max((ax[i] + bu[i] + stage.affine[i] - x[i]).abs());
            worst = worst.max(complementarity(
                x[i],
                stage.state_lower[i],
                stage.state_upper[i],
                forces[i],
                p.state_penalty[i],
            ));
            let pull: f64 = if k + 1 < n {
                (0..NX).map(|j| p.stages[k + 1].state_matrix[j][i] * next[j]).sum()
            } else {
                0.0
            };
            let rows = row_force(solver, k + 1, |r| match p.stages.get(k + 1) {
                Some(stage) => stage.rows.state_matrix[r][i],
                None => p.terminal_rows.state_matrix[r][i],
            });
            costate[i] = qx[i] + stage.state_gradient[i] - forces[i][0] + forces[i][1] + pull + rows;
        }
        let before = if k == 0 { p.previous_input } else { solver.input(k - 1) };
        let after = if k + 1 < n { solver.input(k + 1) } else { u };
        let bend: [f64; NU] = core::array::from_fn(|i| 2.0 * u[i] - before[i] - after[i]);
        let bend = if k + 1 < n { bend } else { core::array::from_fn(|i| u[i] - before[i]) };
        let (ru, wu) = (times(&p.input_weight, &u), times(&p.input_rate_weight, &bend));
        for (i, force) in solver.input_multipliers(k).into_iter().enumerate() {
            let pull: f64 = (0..NX).map(|j| stage.input_matrix[j][i] * costate[j]).sum();
            let rows = row_force(solver, k, |r| stage.rows.input_matrix[r][i]);
            let sum = ru[i] + wu[i] + stage.input_gradient[i] - force[0] + force[1] + pull + rows;
            worst = worst.max(sum.abs());
            worst = worst.max(complementarity(u[i], stage.input_lower[i], stage.input_upper[i], force, None));
        }
    }
    worst
}

/// `Σ_r g_r (λ_upper − λ_lower)` of the rows of node `k` with the coefficients `g`.
fn row_force<const NX: usize, const NU: usize, const NR: usize>(
    solver: &QpSolver<NX, NU, NR>,
    k: usize,
    g: impl Fn(usize) -> f64,
) -> f64 {
    solver.row_multipliers(k).iter().enumerate().map(|(r, [lower, upper])| g(r) * (upper - lower)).sum()
}

/// The worst of [`complementarity`] over the rows of node `k`.
fn row_complementarity<const NX: usize, const NU: usize, const ND: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    solver: &QpSolver<NX, NU, NR>,
    k: usize,
    (rows, x, u): (&QpRows<NX, ND, NR>, &[f64; NX], &[f64; ND]),
) -> f64 {
    let forces = solver.row_multipliers(k);
    let of = |r: usize| {
        let value = row_value(rows, r, x, u);
        complementarity(value, rows.lower[r], rows.upper[r], forces[r], p.row_penalty[r])
    };
    (0..NR).map(of).fold(0.0, f64::max)
}
