//! Seeded random problems in which exact zeros, ties, parallel rows, bounds that coincide and inactive bounds
//! come up as often as generic numbers; horizons to 100, spectral radii to 1.4 without a limit of the growth.
//!
//! Half of the problems have bounds around a reference that keeps them. The bounds of the others lie around
//! zero, as users choose them, and may be out of reach.

use super::random_qp::{Random, spectral_radius};
use super::wide_qp::{advance, reference, row_value};
use gelenk_runtime::qp::{Penalty, QpProblem, QpRows};

/// Horizons that come up.
const HORIZONS: [usize; 10] = [1, 2, 3, 5, 8, 15, 25, 40, 70, 100];
/// Numbers that ties are made of.
const EXACT: [f64; 8] = [0.0, 0.0, 0.0, 1.0, -1.0, 0.5, -0.5, 2.0];

/// The random numbers of one problem.
struct Draw {
    random: Random,
    /// True where all stages are alike.
    constant: bool,
    /// Share of exact numbers, in quarters.
    exact: usize,
}

impl Draw {
    fn number(&mut self) -> f64 {
        if self.random.below(4) < self.exact {
            EXACT[self.random.below(EXACT.len())]
        } else {
            self.random.sym()
        }
    }
    fn vector<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.number())
    }
    fn matrix<const R: usize, const C: usize>(&mut self) -> [[f64; C]; R] {
        core::array::from_fn(|_| self.vector())
    }
    /// A change from stage to stage.
    fn noise(&mut self, size: f64) -> f64 {
        if self.constant { 0.0 } else { size * self.random.sym() }
    }
    /// `GᵀG + least·I`, a diagonal of exact numbers or a multiple of the identity.
    fn weight<const N: usize>(&mut self, least: f64) -> [[f64; N]; N] {
        match self.random.below(3) {
            0 => self.random.positive(least),
            1 => diagonal(core::array::from_fn(|_| least + self.number().abs())),
            _ => diagonal([least + self.number().abs(); N]),
        }
    }
    fn penalty(&mut self) -> Penalty {
        let quadratic = if self.random.one_of(2) { 0.0 } else { self.random.power(-1.0, 5.0) };
        Penalty { linear: self.random.power(-1.0, 5.0), quadratic }
    }
}

fn diagonal<const N: usize>(d: [f64; N]) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { d[i] } else { 0.0 }))
}

/// The problem of a seed.
pub fn tied_qp<const NX: usize, const NU: usize, const NR: usize>(seed: u64) -> QpProblem<NX, NU, NR> {
    let mut random = Random::new(seed);
    let (constant, exact) = (random.one_of(2), random.below(4));
    let horizon = HORIZONS[random.below(HORIZONS.len())];
    let mut draw = Draw { random, constant, exact };
    let mut p = QpProblem::new(horizon);
    set_costs(&mut draw, &mut p);
    set_dynamics(&mut draw, &mut p);
    let (inputs, states) = if draw.random.one_of(3) { at_rest(&p) } else { reference(&mut draw.random, &p) };
    if draw.random.one_of(2) {
        set_bounds_around(&mut draw, &mut p, &inputs, &states);
    } else {
        set_symmetric_bounds(&mut draw, &mut p);
    }
    set_rows(&mut draw, &mut p, &inputs, &states);
    p
}

fn set_costs<const NX: usize, const NU: usize, const NR: usize>(d: &mut Draw, p: &mut QpProblem<NX, NU, NR>) {
    p.state_weight = match d.random.below(4) {
        0 => [[0.0; NX]; NX],
        _ => d.weight(0.0),
    };
    p.terminal_weight = match d.random.below(3) {
        0 => p.state_weight,
        1 => d.weight::<NX>(1.0).map(|row| row.map(|w| 100.0 * w)),
        _ => d.weight(0.0),
    };
    let size = d.random.power(-4.0, 1.0);
    p.input_weight = d.weight::<NU>(0.05).map(|row| row.map(|w| size * w));
    if d.random.one_of(2) {
        let size = d.random.power(-4.0, 1.0);
        p.input_rate_weight = d.weight::<NU>(0.05).map(|row| row.map(|w| size * w));
        p.previous_input = if d.random.one_of(2) { [0.0; NU] } else { d.vector() };
    }
    let soft = d.random.below(4);
    p.state_penalty = core::array::from_fn(|_| (d.random.below(4) < soft).then(|| d.penalty()));
    p.row_penalty = core::array::from_fn(|_| (d.random.below(4) < soft).then(|| d.penalty()));
}

fn set_dynamics<const NX: usize, const NU: usize, const NR: usize>(
    d: &mut Draw,
    p: &mut QpProblem<NX, NU, NR>,
) {
    p.initial_state = if d.random.one_of(3) { [0.0; NX] } else { d.vector() };
    let mut mean = d.matrix::<NX, NX>();
    match d.random.below(4) {
        // Integrators in a chain
        0 => {
            mean =
                core::array::from_fn(|i| core::array::from_fn(|j| [1.0, 0.1, 0.0][j.wrapping_sub(i).min(2)]));
        }
        1 => mean = diagonal(d.vector().map(|v: f64| 1.4 * v.clamp(-1.0, 1.0))),
        _ => {
            let (radius, wanted) = (spectral_radius(&mean), d.random.between(0.3, 1.4));
            // Zeros can make a matrix nilpotent.
            let scale = if radius > 0.1 { wanted / radius } else { 1.0 };
            mean.iter_mut().flatten().for_each(|v| *v *= scale);
        }
    }
    let mut b = d.matrix::<NX, NU>();
    if d.random.one_of(4) {
        b.iter_mut().for_each(|row| row[NU - 1] = row[0]); // two inputs that do the same
    }
    let (affine, gradients) = (d.random.one_of(2), d.random.one_of(2));
    let [offset, of_states] = [(); 2].map(|()| d.vector::<NX>());
    let of_inputs = d.vector::<NU>();
    for stage in &mut p.stages {
        stage.state_matrix = mean.map(|row| row.map(|v| v + d.noise(0.02)));
        stage.input_matrix = b.map(|row| row.map(|v| v + d.noise(0.02)));
        if affine {
            stage.affine = offset.map(|v| 0.1 * v + d.noise(0.1));
        }
        if gradients {
            stage.input_gradient = of_inputs.map(|v| 0.1 * v + d.noise(0.1));
            stage.state_gradient = of_states.map(|v| 0.3 * v + d.noise(0.3));
        }
    }
}

/// The trajectory without inputs.
fn at_rest<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
) -> (Vec<[f64; NU]>, Vec<[f64; NX]>) {
    let mut x = p.initial_state;
    let states = p.stages.iter().map(|stage| {
        x = advance(stage, &x, &[0.0; NU]);
        x
    });
    let states = states.collect();
    (vec![[0.0; NU]; p.stages.len()], states)
}

/// Bounds that keep `value`: far off, at an exact distance, through it, or at a generic distance; both sides
/// through it only if `equal`.
fn around(d: &mut Draw, value: f64, equal: bool) -> [f64; 2] {
    let width = 0.1 + 0.7 * value.abs();
    let mut side = |touching: bool| match d.random.below(6) {
        0 => f64::INFINITY,
        1 => 1e3 * width,
        2 => 1.0,
        3 if touching => 0.0,
        _ => width * d.random.between(0.02, 1.0),
    };
    let below = side(true);
    [value - below, value + side(equal || below > 0.0)]
}

fn set_bounds_around<const NX: usize, const NU: usize, const NR: usize>(
    d: &mut Draw,
    p: &mut QpProblem<NX, NU, NR>,
    inputs: &[[f64; NU]],
    states: &[[f64; NX]],
) {
    let (of_inputs, of_states) = (d.random.below(4), d.random.below(4));
    for (k, stage) in p.stages.iter_mut().enumerate() {
        for i in 0..NU {
            if d.random.below(4) < of_inputs {
                [stage.input_lower[i], stage.input_upper[i]] = around(d, inputs[k][i], true);
            }
        }
        for i in 0..NX {
            if d.random.below(4) < of_states {
                let shift = if p.state_penalty[i].is_some() { d.number() } else { 0.0 };
                [stage.state_lower[i], stage.state_upper[i]] = around(d, states[k][i] + shift, false);
            }
        }
    }
}

/// The same bounds for all stages, `±b` or `0 … b`.
fn set_symmetric_bounds<const NX: usize, const NU: usize, const NR: usize>(
    d: &mut Draw,
    p: &mut QpProblem<NX, NU, NR>,
) {
    let mut pair = |least: f64| {
        let b = if d.random.one_of(2) { 1.0 } else { d.random.power(-0.5, 1.5) }.max(least);
        match d.random.below(6) {
            0 => [f64::NEG_INFINITY, f64::INFINITY],
            1 => [if least > 0.0 { -b } else { 0.0 }, b],
            2 => [-1e4 * b, 1e4 * b],
            _ => [-b, b],
        }
    };
    let of_inputs: [[f64; 2]; NU] = core::array::from_fn(|_| pair(0.0));
    let of_states = p.initial_state.map(|x| pair(1.1 * x.abs()));
    for stage in &mut p.stages {
        (stage.input_lower, stage.input_upper) = (of_inputs.map(|b| b[0]), of_inputs.map(|b| b[1]));
        (stage.state_lower, stage.state_upper) = (of_states.map(|b| b[0]), of_states.map(|b| b[1]));
    }
}

/// Rows of exact and generic numbers around the reference. Some are multiples of the row before or of a state's
/// bound.
fn set_rows<const NX: usize, const NU: usize, const NR: usize>(
    d: &mut Draw,
    p: &mut QpProblem<NX, NU, NR>,
    inputs: &[[f64; NU]],
    states: &[[f64; NX]],
) {
    for row in 0..NR {
        let (mut c, mut v) = (d.vector::<NX>(), d.vector::<NU>());
        match d.random.below(4) {
            0 if row > 0 => {
                let before = &p.stages[0].rows;
                let factor = d.number();
                c = before.state_matrix[row - 1].map(|c| factor * c);
                v = before.input_matrix[row - 1].map(|v| factor * v);
            }
            1 => {
                (c, v) = ([0.0; NX], [0.0; NU]);
                c[row % NX] = 1.0;
            }
            _ => {}
        }
        let mut x = p.initial_state;
        for (k, stage) in p.stages.iter_mut().enumerate() {
            stage.rows.state_matrix[row] = c;
            stage.rows.input_matrix[row] = v;
            let shift = if p.row_penalty[row].is_some() { d.number() } else { 0.0 };
            let value = row_value(&stage.rows, row, &x, &inputs[k]);
            [stage.rows.lower[row], stage.rows.upper[row]] = around(d, value + shift, false);
            x = states[k];
        }
        let end: &mut QpRows<NX, 0, NR> = &mut p.terminal_rows;
        end.state_matrix[row] = c;
        let value = row_value(end, row, &x, &[]);
        [end.lower[row], end.upper[row]] = around(d, value, false);
    }
}
