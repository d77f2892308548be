//! Seeded random problems: stable and unstable systems, active bounds, a feasible trajectory by construction.

use gelenk_runtime::qp::{Penalty, QpProblem};
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Properties of a random problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    pub horizon: usize,
    /// Spectral radius of the mean state matrix; above 1 unstable.
    pub spectral_radius: f64,
    pub state_bounds: bool,
    pub soft: bool,
    pub rate: bool,
}

/// The kind of the problem with this seed: all combinations in turn. At a spectral radius of 1.3 over 20
/// stages Clarabel itself no longer reaches 1e-6.
pub fn kind_of(seed: u64) -> Kind {
    let horizon = [1, 2, 3, 5, 8, 13, 20][(seed % 7) as usize];
    let spectral_radius = [0.5, 0.9, 1.0, 1.1, 1.2][(seed % 5) as usize];
    Kind {
        horizon,
        spectral_radius,
        state_bounds: !seed.is_multiple_of(3),
        soft: seed % 4 == 1,
        rate: seed % 6 >= 4,
    }
}

pub struct Random(ChaCha8Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }
    /// Uniform in −1 … 1.
    pub fn sym(&mut self) -> f64 {
        self.0.random_range(-1.0..1.0)
    }
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }
    /// 0 … n − 1.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }
    /// True once in `n` times.
    pub fn one_of(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }
    /// A power of ten with the exponent between these.
    pub fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }
    pub fn vector<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.sym())
    }
    pub fn matrix<const R: usize, const C: usize>(&mut self) -> [[f64; C]; R] {
        core::array::from_fn(|_| self.vector())
    }
    /// `GᵀG/N + least·I` with random G.
    pub fn positive<const N: usize>(&mut self, least: f64) -> [[f64; N]; N] {
        let g = self.matrix::<N, N>();
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let sum: f64 = (0..N).map(|k| g[k][i] * g[k][j]).sum();
                sum / N as f64 + if i == j { least } else { 0.0 }
            })
        })
    }
}

pub fn spectral_radius<const N: usize>(a: &[[f64; N]; N]) -> f64 {
    let m = DMatrix::from_fn(N, N, |i, j| a[i][j]);
    m.complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max)
}

/// A random problem of one kind.
pub fn random_qp<const NX: usize, const NU: usize>(seed: u64, kind: Kind) -> QpProblem<NX, NU> {
    let mut r = Random::new(seed);
    let mut p = QpProblem::<NX, NU>::new(kind.horizon);
    p.initial_state = r.vector();
    p.state_weight = r.positive(0.1);
    p.terminal_weight = r.positive(1.0);
    p.input_weight = r.positive(0.05);
    if kind.rate {
        p.input_rate_weight = r.positive(0.1);
        p.previous_input = r.vector();
    }
    if kind.soft {
        p.state_penalty = core::array::from_fn(|i| {
            let penalty = Penalty {
                linear: r.between(0.5, 20.0),
                quadratic: if i % 2 == 0 { 0.0 } else { r.between(0.1, 10.0) },
            };
            (i % 3 != 2).then_some(penalty)
        });
    }
    let mut mean = r.matrix::<NX, NX>();
    let scale = kind.spectral_radius / spectral_radius(&mean).max(1e-3);
    mean.iter_mut().flatten().for_each(|v| *v *= scale);
    let b = r.matrix::<NX, NU>();
    let mut x = p.initial_state;
    for stage in &mut p.stages {
        stage.state_matrix = mean.map(|row| row.map(|v| v + 0.02 * r.sym()));
        stage.input_matrix = b.map(|row| row.map(|v| v + 0.02 * r.sym()));
        stage.affine = r.vector().map(|v| 0.1 * v);
        stage.input_gradient = r.vector().map(|v| 0.1 * v);
        stage.state_gradient = r.vector().map(|v| 0.3 * v);
        let u: [f64; NU] = r.vector().map(|v| 0.3 * v);
        x = core::array::from_fn(|i| {
            let ax: f64 = (0..NX).map(|j| stage.state_matrix[i][j] * x[j]).sum();
            let bu: f64 = (0..NU).map(|j| stage.input_matrix[i][j] * u[j]).sum();
            ax + bu + stage.affine[i]
        });
        for i in 0..NU {
            stage.input_lower[i] = u[i] - r.between(0.01, 0.3);
            if r.sym() > -0.8 {
                stage.input_upper[i] = u[i] + r.between(0.01, 0.3);
            }
        }
        for i in 0..NX {
            let width = 0.05 + 0.5 * x[i].abs();
            let (below, above) = (r.between(0.05, 1.0) * width, r.between(0.05, 1.0) * width);
            if kind.state_bounds && r.sym() > -0.6 {
                // Soft bounds may exclude the trajectory that keeps the hard ones.
                let shift = if p.state_penalty[i].is_some() { width * r.sym() } else { 0.0 };
                stage.state_lower[i] = x[i] - below + shift;
                stage.state_upper[i] = if r.sym() > 0.0 { x[i] + above + shift } else { f64::INFINITY };
            }
        }
    }
    p
}
