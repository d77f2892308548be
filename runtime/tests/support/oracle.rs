//! The same QP as a sparse conic program for Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT,
};
use gelenk_runtime::qp::{Penalty, QpProblem};

/// Optimum by Clarabel.
#[derive(Debug, Clone)]
pub struct Solution<const NX: usize, const NU: usize> {
    pub status: SolverStatus,
    pub inputs: Vec<[f64; NU]>,
    pub states: Vec<[f64; NX]>,
    pub cost: f64,
}

/// A sparse matrix by entries, repeated ones added.
#[derive(Default)]
struct Entries {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Entries {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }
    fn csc(self, m: usize, n: usize) -> CscMatrix {
        CscMatrix::new_from_triplets(m, n, self.rows, self.columns, self.values)
    }
}

/// The QP `min ½ zᵀHz + qᵀz`, `Gz + s = b`, with the equalities first; z = (u_0 … u_{N−1}, x_1 … x_N,
/// violations of soft bounds).
pub struct Sparse {
    pub solver: DefaultSolver<f64>,
}

struct Builder {
    h: Entries,
    q: Vec<f64>,
    g: Entries,
    b: Vec<f64>,
}

impl Builder {
    /// The problem, whose first rows are equalities.
    fn solver(self, equalities: usize, tolerance: f64) -> Sparse {
        let (variables, rows) = (self.q.len(), self.b.len());
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .presolve_enable(false)
            .tol_gap_abs(tolerance)
            .tol_gap_rel(tolerance)
            .tol_feas(tolerance)
            .build()
            .unwrap();
        let cones = [ZeroConeT(equalities), NonnegativeConeT(rows - equalities)];
        let (h, g) = (self.h.csc(variables, variables), self.g.csc(rows, variables));
        Sparse { solver: DefaultSolver::new(&h, &self.q, &g, &self.b, &cones, settings).unwrap() }
    }

    fn upper(&mut self, i: usize, j: usize, v: f64) {
        if i <= j {
            self.h.add(i, j, v);
        }
    }
    /// `sign·z_i ≤ sign·bound (+ violation)`.
    fn bound(&mut self, i: usize, sign: f64, bound: f64, penalty: Option<Penalty>) {
        self.limit(&[(i, 1.0)], sign, bound, penalty);
    }
    /// `sign·Σ g_i z_i ≤ sign·bound (+ violation)`.
    fn limit(&mut self, terms: &[(usize, f64)], sign: f64, bound: f64, penalty: Option<Penalty>) {
        if !bound.is_finite() {
            return;
        }
        let row = self.b.len();
        for (i, factor) in terms {
            self.g.add(row, *i, sign * factor);
        }
        self.b.push(sign * bound);
        if let Some(penalty) = penalty {
            let t = self.q.len();
            self.q.push(penalty.linear);
            self.h.add(t, t, penalty.quadratic);
            self.g.add(row, t, -1.0);
            self.g.add(row + 1, t, -1.0);
            self.b.push(0.0);
        }
    }
}

/// Constant cost of the input before the horizon: a term that a quadratic form in z does not hold.
fn constant_cost<const NX: usize, const NU: usize, const NR: usize>(p: &QpProblem<NX, NU, NR>) -> f64 {
    let (w, u) = (&p.input_rate_weight, &p.previous_input);
    let terms = (0..NU).flat_map(|i| (0..NU).map(move |j| 0.5 * u[i] * w[i][j] * u[j]));
    terms.sum()
}

/// Clarabel's problem for a QP, with `tolerance` for gap and feasibility.
pub fn sparse<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    tolerance: f64,
) -> Sparse {
    let n = p.stages.len();
    let (u, x) = (|k: usize, i: usize| k * NU + i, |k: usize, i: usize| n * NU + (k - 1) * NX + i);
    let mut s =
        Builder { h: Entries::default(), q: vec![0.0; n * (NX + NU)], g: Entries::default(), b: vec![] };
    for (k, stage) in p.stages.iter().enumerate() {
        let weight = if k + 1 == n { &p.terminal_weight } else { &p.state_weight };
        for i in 0..NX {
            s.q[x(k + 1, i)] = stage.state_gradient[i];
            for j in 0..NX {
                s.upper(x(k + 1, i), x(k + 1, j), weight[i][j]);
            }
            let row = s.b.len();
            s.g.add(row, x(k + 1, i), 1.0);
            let mut c = stage.affine[i];
            for j in 0..NX {
                if k == 0 {
                    c += stage.state_matrix[i][j] * p.initial_state[j];
                } else {
                    s.g.add(row, x(k, j), -stage.state_matrix[i][j]);
                }
            }
            for j in 0..NU {
                s.g.add(row, u(k, j), -stage.input_matrix[i][j]);
            }
            s.b.push(c);
        }
        for i in 0..NU {
            s.q[u(k, i)] += stage.input_gradient[i];
            for j in 0..NU {
                let w = p.input_rate_weight[i][j];
                s.upper(u(k, i), u(k, j), p.input_weight[i][j] + w);
                if k > 0 {
                    s.upper(u(k - 1, i), u(k - 1, j), w);
                    s.upper(u(k - 1, i), u(k, j), -w);
                } else {
                    s.q[u(0, i)] -= w * p.previous_input[j];
                }
            }
        }
    }
    let equalities = s.b.len();
    for (k, stage) in p.stages.iter().enumerate() {
        for i in 0..NU {
            s.bound(u(k, i), 1.0, stage.input_upper[i], None);
            s.bound(u(k, i), -1.0, stage.input_lower[i], None);
        }
        for i in 0..NX {
            s.bound(x(k + 1, i), 1.0, stage.state_upper[i], p.state_penalty[i]);
            s.bound(x(k + 1, i), -1.0, stage.state_lower[i], p.state_penalty[i]);
        }
    }
    limit_rows(&mut s, p);
    s.solver(equalities, tolerance)
}

/// The rows of all nodes. What x_0 adds to those of the first stage is a number.
fn limit_rows<const NX: usize, const NU: usize, const NR: usize>(s: &mut Builder, p: &QpProblem<NX, NU, NR>) {
    let n = p.stages.len();
    for r in 0..NR {
        for k in 0..=n {
            let stage = p.stages.get(k);
            let end = &p.terminal_rows;
            let (c, lower, upper) = stage.map_or((end.state_matrix[r], end.lower[r], end.upper[r]), |s| {
                (s.rows.state_matrix[r], s.rows.lower[r], s.rows.upper[r])
            });
            let (mut terms, mut constant) = (vec![], 0.0);
            for j in 0..NX {
                if k == 0 {
                    constant += c[j] * p.initial_state[j];
                } else {
                    terms.push((n * NU + (k - 1) * NX + j, c[j]));
                }
            }
            if let Some(stage) = stage {
                terms.extend((0..NU).map(|j| (k * NU + j, stage.rows.input_matrix[r][j])));
            }
            s.limit(&terms, 1.0, upper - constant, p.row_penalty[r]);
            s.limit(&terms, -1.0, lower - constant, p.row_penalty[r]);
        }
    }
}

/// Solves by Clarabel.
pub fn solve<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    tolerance: f64,
) -> Solution<NX, NU> {
    let n = p.stages.len();
    let mut solver = sparse(p, tolerance).solver;
    solver.solve();
    let z = &solver.solution.x;
    Solution {
        status: solver.solution.status,
        inputs: (0..n).map(|k| core::array::from_fn(|i| z[k * NU + i])).collect(),
        states: (0..n).map(|k| core::array::from_fn(|i| z[n * NU + k * NX + i])).collect(),
        cost: solver.solution.obj_val + constant_cost(p),
    }
}
