//! Seeded random problems of all kinds that are well-posed: horizons to 100, unstable systems, bounds of
//! every sort, scales far apart.
//!
//! A reference trajectory that keeps the hard bounds exists by construction, strictly inside them where they
//! leave room.

use super::random_qp::{Random, spectral_radius};
use gelenk_runtime::lqr::TimeVaryingLqr;
use gelenk_runtime::qp::{Penalty, QpProblem, QpRows, QpSolver, QpStage};

/// Horizons that come up.
const HORIZONS: [usize; 12] = [1, 2, 3, 4, 6, 9, 13, 20, 30, 45, 70, 100];
/// The open loop grows by no more than this over the horizon: beyond, inputs in double precision do not
/// determine the states.
const GROWTH: f64 = 1e5;

/// A problem of one stage more than the horizon, of which any window can be solved.
#[derive(Debug, Clone)]
pub struct Wide<const NX: usize, const NU: usize, const NR: usize = 0> {
    pub horizon: usize,
    /// `horizon + 1` stages.
    pub long: QpProblem<NX, NU, NR>,
    /// x_1 of the reference.
    pub reference: [f64; NX],
}

impl<const NX: usize, const NU: usize, const NR: usize> Wide<NX, NU, NR> {
    /// The first problem.
    pub fn first(&self) -> QpProblem<NX, NU, NR> {
        let mut p = self.long.clone();
        p.stages.truncate(self.horizon);
        if let Some(next) = self.long.stages.last() {
            p.terminal_rows = without_inputs(&next.rows);
        }
        p
    }

    /// The problem one stage on from that of `plan`, from `state`. The bounds of its last stage hold what
    /// repeating the last input leads to, so that the plan, moved on, is feasible.
    pub fn next(&self, plan: &QpSolver<NX, NU, NR>, state: [f64; NX]) -> QpProblem<NX, NU, NR> {
        let mut p = self.long.clone();
        p.stages.remove(0);
        p.initial_state = state;
        p.previous_input = plan.input(0);
        let n = self.horizon;
        let (x, mut u) = (plan.state(n), plan.input(n - 1));
        if let Some(stage) = p.stages.last_mut() {
            for i in 0..NU {
                let [low, high] = [&mut stage.input_lower[i], &mut stage.input_upper[i]];
                if low == high {
                    u[i] = *low;
                } else {
                    include(u[i], low, high);
                }
            }
            let end = advance(stage, &x, &u);
            include_rows(&mut stage.rows, &x, &u);
            include_rows(&mut p.terminal_rows, &end, &[]);
            for i in 0..NX {
                let [low, high] = [&mut stage.state_lower[i], &mut stage.state_upper[i]];
                if low == high {
                    (*low, *high) = (f64::NEG_INFINITY, f64::INFINITY);
                } else {
                    include(end[i], low, high);
                }
            }
        }
        p
    }
}

/// The rows of the states alone, where nothing but states is limited.
fn without_inputs<const NX: usize, const NU: usize, const NR: usize>(
    rows: &QpRows<NX, NU, NR>,
) -> QpRows<NX, 0, NR> {
    let mut alone = QpRows { state_matrix: rows.state_matrix, ..QpRows::default() };
    for r in 0..NR {
        if rows.input_matrix[r] == [0.0; NU] {
            (alone.lower[r], alone.upper[r]) = (rows.lower[r], rows.upper[r]);
        }
    }
    alone
}

/// Moves the sides that exclude a point beyond it; equalities are dropped.
fn include_rows<const NX: usize, const NU: usize, const NR: usize>(
    rows: &mut QpRows<NX, NU, NR>,
    x: &[f64; NX],
    u: &[f64; NU],
) {
    for r in 0..NR {
        let value = row_value(rows, r, x, u);
        let [low, high] = [&mut rows.lower[r], &mut rows.upper[r]];
        if low == high {
            (*low, *high) = (f64::NEG_INFINITY, f64::INFINITY);
        } else {
            include(value, low, high);
        }
    }
}

/// `C x + D u` of row `r`.
pub fn row_value<const NX: usize, const NU: usize, const NR: usize>(
    rows: &QpRows<NX, NU, NR>,
    r: usize,
    x: &[f64; NX],
    u: &[f64; NU],
) -> f64 {
    let cx: f64 = (0..NX).map(|j| rows.state_matrix[r][j] * x[j]).sum();
    cx + (0..NU).map(|j| rows.input_matrix[r][j] * u[j]).sum::<f64>()
}

/// Moves the bound that excludes `value` beyond it.
fn include(value: f64, low: &mut f64, high: &mut f64) {
    if value < *low {
        *low = value - 0.1 * (*low - value);
    } else if value > *high {
        *high = value + 0.1 * (value - *high);
    }
}

/// How a kind of variable is bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Bounded {
    No,
    OneSided,
    TwoSided,
    Some,
}

impl Bounded {
    fn pick(r: &mut Random) -> Self {
        [Self::No, Self::OneSided, Self::TwoSided, Self::Some][r.below(4)]
    }

    /// Bounds around `value`, at distances below `width`.
    fn around(self, r: &mut Random, value: f64, width: f64) -> [f64; 2] {
        let (below, above) = (value - width * r.between(0.02, 1.0), value + width * r.between(0.02, 1.0));
        let free = [f64::NEG_INFINITY, f64::INFINITY];
        match self {
            Self::No => free,
            Self::TwoSided => [below, above],
            Self::OneSided if r.one_of(2) => [below, free[1]],
            Self::OneSided => [free[0], above],
            Self::Some => match r.below(4) {
                0 => free,
                1 => [below, free[1]],
                2 => [free[0], above],
                _ => [below, above],
            },
        }
    }
}

/// A random problem.
pub fn wide_qp<const NX: usize, const NU: usize, const NR: usize>(seed: u64) -> Wide<NX, NU, NR> {
    let mut r = Random::new(seed);
    let horizon = HORIZONS[r.below(HORIZONS.len())];
    let mut p = QpProblem::<NX, NU, NR>::new(horizon + 1);
    p.initial_state = r.vector();
    set_costs(&mut r, &mut p);
    set_dynamics(&mut r, &mut p);
    let (inputs, states) = reference(&mut r, &p);
    set_bounds(&mut r, &mut p, &inputs, &states);
    set_rows(&mut r, &mut p, &inputs, &states);
    let reference = states[0];
    let mut wide = Wide { horizon, long: p, reference };
    rescale(&mut r, &mut wide);
    wide
}

fn set_costs<const NX: usize, const NU: usize, const NR: usize>(
    r: &mut Random,
    p: &mut QpProblem<NX, NU, NR>,
) {
    p.state_weight = match r.below(4) {
        0 => [[0.0; NX]; NX],
        1 => r.positive(0.0),
        _ => r.positive(0.1),
    };
    p.terminal_weight = match r.below(4) {
        0 => p.state_weight,
        1 => r.positive::<NX>(1.0).map(|row| row.map(|w| 100.0 * w)),
        _ => r.positive(1.0),
    };
    let size = r.power(-3.0, 0.5);
    p.input_weight = r.positive::<NU>(0.05).map(|row| row.map(|w| size * w));
    if r.one_of(3) {
        p.input_rate_weight = r.positive::<NU>(0.1).map(|row| row.map(|w| size * w));
        p.previous_input = r.vector();
        if r.one_of(4) {
            p.input_weight = [[0.0; NU]; NU];
        }
    }
    if r.one_of(3) {
        p.state_penalty = core::array::from_fn(|_| {
            let penalty = Penalty {
                linear: r.power(-1.0, 4.0),
                quadratic: if r.one_of(2) { 0.0 } else { r.power(-1.0, 5.0) },
            };
            r.one_of(2).then_some(penalty)
        });
    }
}

fn set_dynamics<const NX: usize, const NU: usize, const NR: usize>(
    r: &mut Random,
    p: &mut QpProblem<NX, NU, NR>,
) {
    let horizon = p.stages.len();
    let robot = NX == 2 * NU && r.one_of(2);
    let period = r.power(-3.0, -1.0);
    let mut mean = r.matrix::<NX, NX>();
    let radius = r.between(0.3, 1.4).min(GROWTH.powf(1.0 / horizon as f64));
    let scale = radius / spectral_radius(&mean).max(1e-3);
    mean.iter_mut().flatten().for_each(|v| *v *= scale);
    let mut b = r.matrix::<NX, NU>();
    if robot {
        for i in 0..NX {
            for j in 0..NX {
                let identity = f64::from(u8::from(i == j));
                mean[i][j] = if i < NU {
                    identity + f64::from(u8::from(j == i + NU)) * period
                } else {
                    identity + period * (2.0 * r.sym() - 2.0 * identity)
                };
            }
            for j in 0..NU {
                let identity = f64::from(u8::from(i % NU == j));
                let lever = 5.0 * identity + r.sym();
                b[i][j] = if i < NU { 0.5 * period } else { 1.0 } * period * lever;
            }
        }
    }
    let noise = if robot { 0.1 * period } else { 0.02 };
    for stage in &mut p.stages {
        stage.state_matrix = mean.map(|row| row.map(|v| v + noise * r.sym()));
        stage.input_matrix = b.map(|row| row.map(|v| v + noise * r.sym()));
        stage.affine = r.vector().map(|v| 5.0 * noise * v);
        stage.input_gradient = r.vector().map(|v| 0.1 * v);
        stage.state_gradient = r.vector().map(|v| 0.3 * v);
    }
    while growth(p) > GROWTH {
        for entry in p.stages.iter_mut().flat_map(|s| s.state_matrix.as_flattened_mut()) {
            *entry *= 0.95;
        }
    }
}

/// Largest entry of the products `A_k … A_0`.
fn growth<const NX: usize, const NU: usize, const NR: usize>(p: &QpProblem<NX, NU, NR>) -> f64 {
    let mut product: [[f64; NX]; NX] =
        core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
    let mut largest = 0.0_f64;
    for stage in &p.stages {
        product = stage
            .state_matrix
            .map(|row| core::array::from_fn(|j| (0..NX).map(|i| row[i] * product[i][j]).sum()));
        let entries = product.as_flattened().iter();
        largest = entries.fold(largest, |max, v| v.abs().max(max));
    }
    largest
}

/// Inputs u_k and states x_{k+1} that a regulator makes from random pushes.
pub fn reference<const NX: usize, const NU: usize, const NR: usize>(
    r: &mut Random,
    p: &QpProblem<NX, NU, NR>,
) -> (Vec<[f64; NU]>, Vec<[f64; NX]>) {
    let identity = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
    let weight = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
    let (mut inputs, mut states, mut x) = (vec![], vec![], p.initial_state);
    for chunk in p.stages.chunks(50) {
        let mut lqr = TimeVaryingLqr::<NX, NU>::new(chunk.len()).unwrap();
        for (k, stage) in chunk.iter().enumerate() {
            lqr.set_stage(k, &stage.state_matrix, &stage.input_matrix);
        }
        lqr.solve(&identity, &weight, &identity).unwrap();
        for (k, stage) in chunk.iter().enumerate() {
            let u = core::array::from_fn(|i| {
                let feedback: f64 = (0..NX).map(|j| lqr.gain(k)[i][j] * x[j]).sum();
                feedback + 0.3 * r.sym()
            });
            x = advance(stage, &x, &u);
            inputs.push(u);
            states.push(x);
        }
    }
    (inputs, states)
}

/// x⁺.
pub fn advance<const NX: usize, const NU: usize, const NR: usize>(
    stage: &QpStage<NX, NU, NR>,
    x: &[f64; NX],
    u: &[f64; NU],
) -> [f64; NX] {
    core::array::from_fn(|i| {
        let ax: f64 = (0..NX).map(|j| stage.state_matrix[i][j] * x[j]).sum();
        let bu: f64 = (0..NU).map(|j| stage.input_matrix[i][j] * u[j]).sum();
        ax + bu + stage.affine[i]
    })
}

fn set_bounds<const NX: usize, const NU: usize, const NR: usize>(
    r: &mut Random,
    p: &mut QpProblem<NX, NU, NR>,
    inputs: &[[f64; NU]],
    states: &[[f64; NX]],
) {
    let (of_inputs, of_states) = (Bounded::pick(r), Bounded::pick(r));
    let equal_inputs = of_inputs != Bounded::No && r.one_of(4);
    let penalties = p.state_penalty;
    let last = p.stages.len() - 2;
    // Fewer than the inputs can place, and only where no input is fixed: otherwise rounding decides whether
    // the problem is feasible.
    let equal_states = if !equal_inputs && last >= NX && r.one_of(4) { 1 + r.below(NU.min(NX)) } else { 0 };
    for (k, stage) in p.stages.iter_mut().enumerate() {
        for i in 0..NU {
            let [low, high] = of_inputs.around(r, inputs[k][i], 0.4);
            (stage.input_lower[i], stage.input_upper[i]) = (low, high);
            if equal_inputs && r.one_of(5) {
                (stage.input_lower[i], stage.input_upper[i]) = (inputs[k][i], inputs[k][i]);
            }
        }
        for i in 0..NX {
            let width = 0.1 + 0.7 * states[k][i].abs();
            // Soft bounds may exclude the reference.
            let shift = match penalties[i] {
                Some(_) => width * r.sym(),
                None => 0.0,
            };
            let [low, high] = of_states.around(r, states[k][i] + shift, width);
            (stage.state_lower[i], stage.state_upper[i]) = (low, high);
            if k >= last && i < equal_states {
                (stage.state_lower[i], stage.state_upper[i]) = (states[k][i], states[k][i]);
            }
        }
    }
}

/// Rows of states, of inputs and of both, around the reference; some twice, some in other units.
fn set_rows<const NX: usize, const NU: usize, const NR: usize>(
    r: &mut Random,
    p: &mut QpProblem<NX, NU, NR>,
    inputs: &[[f64; NU]],
    states: &[[f64; NX]],
) {
    for row in 0..NR {
        let of_values = Bounded::pick(r);
        let (sort, unit) = (r.below(3), if r.one_of(3) { r.power(-3.0, 3.0) } else { 1.0 });
        let (c, d) = (r.vector::<NX>(), r.vector::<NU>());
        if r.one_of(3) {
            let quadratic = if r.one_of(2) { 0.0 } else { r.power(-1.0, 5.0) / (unit * unit) };
            p.row_penalty[row] = Some(Penalty { linear: r.power(-1.0, 4.0) / unit, quadratic });
        }
        let twice =
            row > 0 && r.one_of(6) && p.row_penalty[row].is_some() == p.row_penalty[row - 1].is_some();
        let mut x = p.initial_state;
        for (k, stage) in p.stages.iter_mut().enumerate() {
            let rows = &mut stage.rows;
            let (with_states, with_inputs) = (f64::from(u8::from(sort != 1)), f64::from(u8::from(sort != 2)));
            rows.state_matrix[row] = c.map(|v| (v + 0.1 * r.sym()) * unit * with_states);
            rows.input_matrix[row] = d.map(|v| (v + 0.1 * r.sym()) * unit * with_inputs);
            let value = row_value(rows, row, &x, &inputs[k]);
            let width = 0.1 * unit + 0.7 * value.abs();
            let shift = if p.row_penalty[row].is_some() { width * r.sym() } else { 0.0 };
            [rows.lower[row], rows.upper[row]] = of_values.around(r, value + shift, width);
            if twice {
                rows.state_matrix[row] = rows.state_matrix[row - 1];
                rows.input_matrix[row] = rows.input_matrix[row - 1];
                (rows.lower[row], rows.upper[row]) = (rows.lower[row - 1], rows.upper[row - 1]);
            }
            x = states[k];
        }
    }
    if let Some(last) = p.stages.last() {
        let end = without_inputs(&last.rows);
        p.terminal_rows = end;
        for row in 0..NR {
            let value = row_value(&p.terminal_rows, row, &states[states.len() - 1], &[]);
            include(value, &mut p.terminal_rows.lower[row], &mut p.terminal_rows.upper[row]);
        }
    }
}

/// Other units for states, inputs and cost.
fn rescale<const NX: usize, const NU: usize, const NR: usize>(r: &mut Random, wide: &mut Wide<NX, NU, NR>) {
    let p = &mut wide.long;
    let mut scale = |of: usize| {
        if r.one_of(of) { r.power(-2.0, 2.0) } else { 1.0 }
    };
    let cost = scale(3) * scale(3);
    let all = scale(3);
    let x: [f64; NX] = core::array::from_fn(|_| all * scale(6));
    let u: [f64; NU] = core::array::from_fn(|_| scale(6));
    let weight = |w: &mut f64, a: f64, b: f64| *w *= cost / (a * b);
    for i in 0..NX {
        for j in 0..NX {
            weight(&mut p.state_weight[i][j], x[i], x[j]);
            weight(&mut p.terminal_weight[i][j], x[i], x[j]);
        }
        p.initial_state[i] *= x[i];
        wide.reference[i] *= x[i];
        if let Some(penalty) = &mut p.state_penalty[i] {
            penalty.linear *= cost / x[i];
            penalty.quadratic *= cost / (x[i] * x[i]);
        }
    }
    for i in 0..NU {
        for j in 0..NU {
            weight(&mut p.input_weight[i][j], u[i], u[j]);
            weight(&mut p.input_rate_weight[i][j], u[i], u[j]);
        }
        p.previous_input[i] *= u[i];
    }
    p.stages.iter_mut().for_each(|stage| rescale_stage(stage, &x, &u, cost));
    for row in &mut p.terminal_rows.state_matrix {
        for i in 0..NX {
            row[i] /= x[i];
        }
    }
    for penalty in p.row_penalty.iter_mut().flatten() {
        penalty.linear *= cost;
        penalty.quadratic *= cost;
    }
}

/// The same for a stage.
fn rescale_stage<const NX: usize, const NU: usize, const NR: usize>(
    stage: &mut QpStage<NX, NU, NR>,
    x: &[f64; NX],
    u: &[f64; NU],
    cost: f64,
) {
    for i in 0..NX {
        for j in 0..NX {
            stage.state_matrix[i][j] *= x[i] / x[j];
        }
        for j in 0..NU {
            stage.input_matrix[i][j] *= x[i] / u[j];
        }
        stage.affine[i] *= x[i];
        stage.state_gradient[i] *= cost / x[i];
        stage.state_lower[i] *= x[i];
        stage.state_upper[i] *= x[i];
    }
    for i in 0..NU {
        stage.input_gradient[i] *= cost / u[i];
        stage.input_lower[i] *= u[i];
        stage.input_upper[i] *= u[i];
    }
    for row in 0..NR {
        for i in 0..NX {
            stage.rows.state_matrix[row][i] /= x[i];
        }
        for i in 0..NU {
            stage.rows.input_matrix[row][i] /= u[i];
        }
    }
}
