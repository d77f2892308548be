//! Value of a trajectory by the data of its QP alone.

use super::wide_qp;
use gelenk_runtime::qp::{Penalty, QpProblem, QpRows};

/// Value of a point by the problem's own data: cost, size of its quadratic terms, violation of hard bounds,
/// defect of the dynamics.
#[derive(Debug, Clone, Copy, Default)]
pub struct Value {
    pub cost: f64,
    pub size: f64,
    pub violation: f64,
    pub defect: f64,
    /// Largest violation of a hard bound of a state relative to its magnitude, if that is at least 1e-4.
    pub beside: f64,
}

fn times<const R: usize, const C: usize>(m: &[[f64; C]; R], v: &[f64; C]) -> [f64; R] {
    m.map(|row| dot(&row, v))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn form<const N: usize>(m: &[[f64; N]; N], v: &[f64; N]) -> f64 {
    0.5 * dot(&times(m, v), v)
}

/// How far `z` lies outside its bounds.
fn excess(z: f64, lower: f64, upper: f64) -> f64 {
    (lower - z).max(z - upper).max(0.0)
}

pub fn value<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    inputs: &[[f64; NU]],
    states: &[[f64; NX]],
) -> Value {
    let mut v = Value::default();
    let (mut last, mut x) = (p.previous_input, p.initial_state);
    for (k, s) in p.stages.iter().enumerate() {
        let (u, next) = (inputs[k], states[k]);
        let weight = if k + 1 == p.stages.len() { &p.terminal_weight } else { &p.state_weight };
        let change: [f64; NU] = core::array::from_fn(|i| u[i] - last[i]);
        let size = form(weight, &next) + form(&p.input_weight, &u) + form(&p.input_rate_weight, &change);
        v.size += size;
        v.cost += size + dot(&s.input_gradient, &u) + dot(&s.state_gradient, &next);
        let ideal = wide_qp::advance(s, &x, &u);
        for i in 0..NX {
            let defect = (ideal[i] - next[i]).abs() / ideal[i].abs().max(1.0);
            v.defect = v.defect.max(defect);
            let e = excess(next[i], s.state_lower[i], s.state_upper[i]);
            match p.state_penalty[i] {
                None => {
                    v.violation = v.violation.max(e / next[i].abs().max(1.0));
                    let side = if next[i] < s.state_lower[i] { s.state_lower[i] } else { s.state_upper[i] };
                    v.beside = v.beside.max(e / side.abs().max(1e-4));
                }
                Some(w) => v.cost += w.linear * e + 0.5 * w.quadratic * e * e,
            }
        }
        for i in 0..NU {
            let e = excess(u[i], s.input_lower[i], s.input_upper[i]);
            v.violation = v.violation.max(e);
        }
        add_rows(&mut v, (&s.rows, &x, &u), &p.row_penalty);
        (last, x) = (u, next);
    }
    add_rows(&mut v, (&p.terminal_rows, &x, &[]), &p.row_penalty);
    v
}

/// Violation of hard rows, in units of their largest coefficient, and cost of soft ones.
fn add_rows<const NX: usize, const NU: usize, const NR: usize>(
    v: &mut Value,
    (rows, x, u): (&QpRows<NX, NU, NR>, &[f64; NX], &[f64; NU]),
    penalties: &[Option<Penalty>; NR],
) {
    for (r, penalty) in penalties.iter().enumerate() {
        let value = wide_qp::row_value(rows, r, x, u);
        let e = excess(value, rows.lower[r], rows.upper[r]);
        let coefficients = rows.state_matrix[r].iter().chain(&rows.input_matrix[r]);
        let unit = coefficients.fold(0.0_f64, |max, c| c.abs().max(max));
        match penalty {
            _ if e == 0.0 => {}
            None => {
                let side = if value < rows.lower[r] { rows.lower[r] } else { rows.upper[r] };
                v.violation = v.violation.max(e / unit.max(side.abs()));
            }
            Some(w) => v.cost += w.linear * e + 0.5 * w.quadratic * e * e,
        }
    }
}
