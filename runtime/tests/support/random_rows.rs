//! Random problems with rows of every sort around a trajectory that keeps what is hard.

use super::random_qp::{Kind, Random, random_qp};
use super::wide_qp::advance;
use gelenk_runtime::qp::{Penalty, QpProblem, QpRows, QpStage};

/// A problem of `kind` with rows. The trajectory that the hard limits leave room for is that of
/// [`random_qp`]: it is found again from the problem, since every input bound has a lower side.
pub fn random_rows<const NX: usize, const NU: usize, const NR: usize>(
    seed: u64,
    kind: Kind,
) -> QpProblem<NX, NU, NR> {
    let plain = random_qp::<NX, NU>(seed, kind);
    let mut r = Random::new(seed ^ 0x726f_7773);
    let mut p = with_room(&plain);
    p.row_penalty = core::array::from_fn(|_| r.one_of(2).then(|| penalty(&mut r)));
    let mut inner = plain.initial_state;
    for k in 0..kind.horizon {
        let stage = &mut p.stages[k];
        let u: [f64; NU] = core::array::from_fn(|i| stage.input_lower[i] + 0.005);
        let (c, d) = (r.matrix::<NR, NX>(), r.matrix::<NR, NU>());
        for row in 0..NR {
            let sort = Sort::pick(&mut r);
            let (c, d, u) = (sort.state(c[row]), sort.input(d[row]), &u);
            let value = dot(&c, &inner) + dot(&d, u);
            let soft = p.row_penalty[row].is_some();
            let sides = sides(&mut r, value, soft);
            let unit = if r.one_of(3) { r.power(-3.0, 3.0) } else { 1.0 };
            set(&mut stage.rows, row, (c, d, sides), unit);
        }
        inner = advance(&plain.stages[k], &inner, &u);
    }
    let c = r.matrix::<NR, NX>();
    for row in 0..NR {
        let sides = sides(&mut r, dot(&c[row], &inner), p.row_penalty[row].is_some());
        p.terminal_rows.state_matrix[row] = c[row];
        [p.terminal_rows.lower[row], p.terminal_rows.upper[row]] = sides;
    }
    p
}

/// The same problem without state bounds that the trajectory of least inputs may not keep.
fn with_room<const NX: usize, const NU: usize, const NR: usize>(
    plain: &QpProblem<NX, NU>,
) -> QpProblem<NX, NU, NR> {
    let mut p = QpProblem::<NX, NU, NR>::new(plain.stages.len());
    p.initial_state = plain.initial_state;
    p.state_weight = plain.state_weight;
    p.input_weight = plain.input_weight;
    p.terminal_weight = plain.terminal_weight;
    p.input_rate_weight = plain.input_rate_weight;
    p.previous_input = plain.previous_input;
    p.state_penalty = plain.state_penalty;
    let mut x = plain.initial_state;
    for (stage, from) in p.stages.iter_mut().zip(&plain.stages) {
        *stage = QpStage {
            state_matrix: from.state_matrix,
            input_matrix: from.input_matrix,
            affine: from.affine,
            input_gradient: from.input_gradient,
            state_gradient: from.state_gradient,
            input_lower: from.input_lower,
            input_upper: from.input_upper,
            state_lower: from.state_lower,
            state_upper: from.state_upper,
            rows: QpRows::default(),
        };
        let u: [f64; NU] = core::array::from_fn(|i| from.input_lower[i] + 0.005);
        x = advance(from, &x, &u);
        for i in 0..NX {
            stage.state_lower[i] = stage.state_lower[i].min(x[i] - 0.05);
            stage.state_upper[i] = stage.state_upper[i].max(x[i] + 0.05);
        }
    }
    p
}

/// Which coefficients of a row are not zero.
#[derive(Clone, Copy, PartialEq)]
enum Sort {
    Mixed,
    States,
    Inputs,
}

impl Sort {
    fn pick(r: &mut Random) -> Self {
        [Self::Mixed, Self::Mixed, Self::States, Self::Inputs][r.below(4)]
    }
    fn state<const N: usize>(self, c: [f64; N]) -> [f64; N] {
        if self == Self::Inputs { [0.0; N] } else { c }
    }
    fn input<const N: usize>(self, d: [f64; N]) -> [f64; N] {
        if self == Self::States { [0.0; N] } else { d }
    }
}

fn penalty(r: &mut Random) -> Penalty {
    let quadratic = if r.one_of(2) { 0.0 } else { r.between(0.1, 10.0) };
    Penalty { linear: r.between(0.5, 20.0), quadratic }
}

/// Sides that hold `value`, or, if `soft`, may exclude it.
fn sides(r: &mut Random, value: f64, soft: bool) -> [f64; 2] {
    let width = 0.05 + 0.5 * value.abs();
    let shift = if soft { width * r.sym() } else { 0.0 };
    let (below, above) = (width * r.between(0.02, 1.0), width * r.between(0.02, 1.0));
    let sides = [value + shift - below, value + shift + above];
    match r.below(4) {
        0 => [sides[0], f64::INFINITY],
        1 => [f64::NEG_INFINITY, sides[1]],
        _ => sides,
    }
}

fn set<const NX: usize, const NU: usize, const NR: usize>(
    rows: &mut QpRows<NX, NU, NR>,
    row: usize,
    (c, d, sides): ([f64; NX], [f64; NU], [f64; 2]),
    unit: f64,
) {
    rows.state_matrix[row] = c.map(|v| v * unit);
    rows.input_matrix[row] = d.map(|v| v * unit);
    [rows.lower[row], rows.upper[row]] = sides.map(|side| side * unit);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
