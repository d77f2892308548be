//! Rows `w = C x + D u` with limits `lo ≤ w ≤ hi`.
//!
//! For bounds, barrier and certificate, the values w are additional states. Each [`Trajectory`] stores them after
//! x_1 … x_N, node by node. The rules for hard, soft and equal bounds of states also apply to the values w. In contrast to
//! states, w depends on x and u. Therefore a linear cost e of w is the cost `Cᵀe` of x and the cost `Dᵀe` of u. Diagonal
//! terms ω of w add
//! ```text
//!     CᵀωC to Q̃     DᵀωC to BᵀP⁺A     DᵀωD to R̃
//! ```
//!
//! in the factorization, so gains and sweeps include the rows (Frison, Diehl, *HPIPM*, IFAC 2020, section 3). A row is
//! scaled by its largest coefficient, rounded to a power of two so that the scaling is exact. Without rows (`NR = 0`) every
//! function is empty.

use super::lanes::{Vector, at, dot, flat, flat_mut, lanes, pack, vectorized, zeros};
use super::problem::{QpProblem, unit};
use super::trajectory::Trajectory;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Limits of a scaled row.
pub(super) struct Limits {
    /// Position of the value of the row, counted from the end of the states.
    pub(super) place: usize,
    pub(super) sides: [f64; 2],
    pub(super) penalty: Option<(f64, f64)>,
}

/// Matrices of the constraint rows of nodes 0 … N.
#[derive(Debug, Clone)]
pub(crate) struct Rows<V, const NX: usize, const NU: usize, const NR: usize> {
    /// Coefficients `C_k` of the states, `NR` padded rows per node; zero for node 0, because x_0 is not a
    /// variable.
    c: Vec<V>,
    /// Coefficients `D_k` of the inputs; zero for the last node.
    d: Vec<[[f64; NU]; NR]>,
    unit: Vec<[f64; NR]>,
    /// Contribution of the initial state x_0 to the values of node 0.
    offset: [f64; NR],
}

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Rows<V, NX, NU, NR> {
    const RX: usize = lanes::<V>(NX);
    /// Number of lanes of the values of a node.
    const RR: usize = lanes::<V>(NR);

    /// Number of lanes of the values over a horizon.
    pub(super) const fn lanes(horizon: usize) -> usize {
        (horizon + 1) * Self::RR
    }

    /// Memory for the rows of `horizon` stages and of the last node.
    pub(crate) fn new(horizon: usize) -> Self {
        let nodes = if NR > 0 { horizon + 1 } else { 0 };
        Self {
            c: zeros(nodes * NR * Self::RX),
            d: vec![[[0.0; NU]; NR]; nodes],
            unit: vec![[1.0; NR]; nodes],
            offset: [0.0; NR],
        }
    }

    /// Loads the matrices of a problem, and passes the limits of each row to `limit`.
    pub(super) fn load(&mut self, problem: &QpProblem<NX, NU, NR>, mut limit: impl FnMut(Limits)) {
        for r in 0..NR {
            for (k, stage) in problem.stages.iter().enumerate() {
                let rows = &stage.rows;
                let (c, d) = (&rows.state_matrix[r], &rows.input_matrix[r]);
                if k == 0 {
                    let unit = unit(c, d);
                    self.offset[r] = c.iter().zip(&problem.initial_state).map(|(c, x)| c / unit * x).sum();
                }
                self.set(k, r, c, d);
                limit(self.limits(k, r, [rows.lower[r], rows.upper[r]], problem));
            }
            let (k, end) = (problem.stages.len(), &problem.terminal_rows);
            self.set(k, r, &end.state_matrix[r], &[0.0; NU]);
            limit(self.limits(k, r, [end.lower[r], end.upper[r]], problem));
        }
    }

    fn set(&mut self, k: usize, r: usize, c: &[f64; NX], d: &[f64; NU]) {
        let unit = unit(c, d);
        let c = if k > 0 { c.map(|v| v / unit) } else { [0.0; NX] };
        pack(&mut self.c[(k * NR + r) * Self::RX..][..Self::RX], &c);
        self.d[k][r] = d.map(|v| v / unit);
        self.unit[k][r] = unit;
    }

    fn limits(&self, k: usize, r: usize, sides: [f64; 2], problem: &QpProblem<NX, NU, NR>) -> Limits {
        let unit = self.unit[k][r];
        let mut sides = sides.map(|side| side / unit);
        let constant = if k == 0 { self.offset[r] } else { 0.0 };
        // A row that does not depend on a variable leaves no interior, so it is removed if it is satisfied. If it is not
        // satisfied, it remains and cannot be kept.
        if self.is_constant(k, r) && sides[0] <= constant && constant <= sides[1] {
            sides = [f64::NEG_INFINITY, f64::INFINITY];
        }
        let penalty = problem.row_penalty[r].map(|p| (p.linear * unit, p.quadratic * unit * unit));
        Limits { place: k * Self::RR * V::WIDTH + r, sides, penalty }
    }

    /// Whether row `r` of node `k` does not depend on a variable.
    fn is_constant(&self, k: usize, r: usize) -> bool {
        self.d[k][r] == [0.0; NU] && flat(self.state_row(k, r)).iter().all(|c| *c == 0.0)
    }

    /// Scaling unit of row `r` of node `k`, the largest power of two that does not exceed its largest coefficient.
    #[inline(always)]
    pub(super) fn unit(&self, k: usize, r: usize) -> f64 {
        self.unit[k][r]
    }

    #[inline(always)]
    fn state_row(&self, k: usize, r: usize) -> &[V] {
        &self.c[(k * NR + r) * Self::RX..][..Self::RX]
    }

    /// Range of the lanes of node `k` in the states of a [`Trajectory`].
    #[inline(always)]
    fn of_node(&self, k: usize) -> core::ops::Range<usize> {
        let start = (self.d.len() - 1) * Self::RX + k * Self::RR;
        start..start + Self::RR
    }

    /// Sets the values `w = C x + D u` of the rows at the states x and inputs u of a point, with the
    /// contribution of the initial state.
    pub(super) fn evaluate(&self, z: &mut Trajectory<V>) {
        if NR > 0 {
            self.follow(z);
            let first = self.of_node(0);
            for (value, offset) in flat_mut(&mut z.x[first]).iter_mut().zip(&self.offset) {
                *value += offset;
            }
        }
    }

    /// Sets the values of the rows of a step dx, du of states and inputs: `dw = C dx + D du`.
    pub(super) fn follow(&self, z: &mut Trajectory<V>) {
        if NR == 0 {
            return;
        }
        vectorized!(V, {
            for k in 0..self.d.len() {
                for r in 0..NR {
                    let mut sum = 0.0;
                    if k > 0 {
                        sum = dot(self.state_row(k, r), &z.x[(k - 1) * Self::RX..][..Self::RX]);
                    }
                    if k + 1 < self.d.len() {
                        for j in 0..NU {
                            sum += self.d[k][r][j] * flat(&z.u)[k * NU + j];
                        }
                    }
                    flat_mut(&mut z.x[self.of_node(k)])[r] = sum;
                }
            }
        })
    }

    /// Converts the linear cost e of the values `C x + D u` to costs `Cᵀe` of the states x and `Dᵀe` of the
    /// inputs u. e becomes 0.
    pub(super) fn fold(&self, gradient: &mut Trajectory<V>) {
        if NR == 0 {
            return;
        }
        vectorized!(V, {
            for k in 0..self.d.len() {
                for r in 0..NR {
                    let cost = core::mem::take(&mut flat_mut(&mut gradient.x[self.of_node(k)])[r]);
                    self.add(k, r, cost, gradient);
                }
            }
        })
    }

    /// Adds `factor` times row `r` of node `k`, with the coefficients c of states and d of inputs: `(x, u) +=
    /// (cᵀ, dᵀ) factor`.
    #[inline(always)]
    fn add(&self, k: usize, r: usize, factor: f64, z: &mut Trajectory<V>) {
        if k > 0 {
            let x = &mut z.x[(k - 1) * Self::RX..][..Self::RX];
            for (x, c) in x.iter_mut().zip(self.state_row(k, r)) {
                *x = c.mul_add(V::splat(factor), *x);
            }
        }
        if k + 1 < self.d.len() {
            let u = &mut flat_mut(&mut z.u)[k * NU..][..NU];
            for j in 0..NU {
                u[j] += self.d[k][r][j] * factor;
            }
        }
    }

    /// Changes states and inputs so that each row changes by its value in `step`. The change is the shortest step for each row
    /// separately. The values in `step` become 0.
    pub(super) fn move_along(&self, step: &mut Trajectory<V>) {
        if NR == 0 {
            return;
        }
        vectorized!(V, {
            for k in 0..self.d.len() {
                for r in 0..NR {
                    let change = core::mem::take(&mut flat_mut(&mut step.x[self.of_node(k)])[r]);
                    let c = self.state_row(k, r);
                    let square = dot(c, c) + self.d[k][r].iter().map(|d| d * d).sum::<f64>();
                    // The coefficients of variables can be much smaller than the largest coefficient. The lower bound of 1
                    // prevents huge steps in this case.
                    self.add(k, r, change / square.max(1.0), step);
                }
            }
        })
    }

    /// Adds the contribution of the initial state to the gradient of the quadratic terms `½ ω w²` of the
    /// values w with the weights ω.
    pub(super) fn attract(&self, weight: &Trajectory<V>, gradient: &mut Trajectory<V>) {
        if NR > 0 {
            let first = self.of_node(0);
            let weight = flat(&weight.x[first.clone()]);
            let gradient = flat_mut(&mut gradient.x[first]);
            for r in 0..NR {
                gradient[r] += weight[r] * self.offset[r];
            }
        }
    }

    /// Adds `CᵀωC` of node `k` to the cost-to-go matrix, which is stored in padded columns. C are the
    /// coefficients of the states, and ω are the weights of the values.
    #[inline(always)]
    pub(super) fn add_to_cost(&self, k: usize, weight: &Trajectory<V>, p: &mut [V]) {
        for r in 0..NR {
            let (c, weight) = (self.state_row(k, r), at(&weight.x[self.of_node(k)], r));
            for j in 0..NX {
                let factor = V::splat(weight * at(c, j));
                for (entry, c) in p[j * Self::RX..][..Self::RX].iter_mut().zip(c) {
                    *entry = c.mul_add(factor, *entry);
                }
            }
        }
    }

    /// Adds `DᵀωD` of node `k` to the lower triangle of the input Hessian. D are the coefficients of the
    /// inputs, and ω are the weights of the values.
    #[inline(always)]
    pub(super) fn add_to_pivot(&self, k: usize, weight: &Trajectory<V>, h: &mut [[f64; NU]; NU]) {
        for r in 0..NR {
            let (d, weight) = (&self.d[k][r], at(&weight.x[self.of_node(k)], r));
            for i in 0..NU {
                for j in 0..=i {
                    h[i][j] += weight * d[i] * d[j];
                }
            }
        }
    }

    /// Adds `DᵀωC` of node `k` to the product `BᵀP⁺A`, which is stored in padded rows. C and D are the
    /// coefficients of states and inputs, and ω are the weights of the values.
    #[inline(always)]
    pub(super) fn add_to_coupling(&self, k: usize, weight: &Trajectory<V>, y: &mut [V]) {
        for r in 0..NR {
            let (c, weight) = (self.state_row(k, r), at(&weight.x[self.of_node(k)], r));
            for i in 0..NU {
                let factor = V::splat(weight * self.d[k][r][i]);
                for (entry, c) in y[i * Self::RX..][..Self::RX].iter_mut().zip(c) {
                    *entry = c.mul_add(factor, *entry);
                }
            }
        }
    }
}
