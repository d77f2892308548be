//! A consistent program in variables of size one.
//!
//! A body's pseudo-inertia is `J = T S T` with a diagonal T of four sizes, chosen such that H has a diagonal
//! near one in the entries of S; a congruence keeps the cone. Other entries are scaled one by one. All are
//! scaled together, and so is the objective, by what it gains without cones. Without this a problem with
//! 100 kg and 10⁻⁶ kg m² loses its smaller digits, and the iteration starts far from its end.

use super::interior_point::{BLOCK, PLACES};
use super::problem::ConsistentProblem;
use super::pseudo_inertia::{PER_BODY, from_pseudo_inertia};
use crate::error::{IdentificationError, Result};
use crate::numeric::spectrum::symmetric_eigenvalues;
use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, Vector4};

/// A curvature below this share of the largest one is rounding: the direction is not seen.
const UNSEEN: f64 = 1e-24;

/// An eigenvalue of the scaled Hessian below this share of the largest is a direction that H does not
/// determine: `H = Wᵀ W` has the square of the condition of W.
const OPEN: f64 = 1e-12;

/// How negative an eigenvalue may be by rounding, as a share of the largest.
const NEGATIVE: f64 = 1e-9;

/// Share of the scaled distance from a body of unit sizes in the objective: rounding where H determines the body.
/// Where it does not, the multipliers would have no interior, and the iteration would stop early.
const PULL: f64 = 1e-12;

type Block = SMatrix<f64, PER_BODY, BLOCK>;

/// The scaled program, and the way back.
pub(super) struct Scaled {
    pub hessian: DMatrix<f64>,
    pub linear: DVector<f64>,
    /// Decrease of the objective from zero to its minimum without cones, in its own unit.
    pub energy: f64,
    /// Directions that H does not determine.
    pub open: usize,
    blocks: Vec<Block>,
    /// Entries behind the bodies which H does not contain; they are zero.
    pub unseen: Vec<usize>,
    /// Sizes of the entries behind the bodies.
    sizes: Vec<f64>,
}

/// Ten parameters of the entries of a body's S, `J = T S T`.
fn parameters_of_block(sizes: &Vector4<f64>) -> Block {
    let mut map = Block::zeros();
    for (k, &(r, c)) in PLACES.iter().enumerate() {
        let mut j = Matrix4::zeros();
        let x =
            if r == c { sizes[r] * sizes[r] } else { std::f64::consts::FRAC_1_SQRT_2 * sizes[r] * sizes[c] };
        j[(r, c)] = x;
        j[(c, r)] = x;
        map.column_mut(k).copy_from_slice(&from_pseudo_inertia(&j));
    }
    map
}

/// Sizes T of a body: least squares over the logarithms of H's diagonal in the entries of J.
fn balance(curvature: &[f64; BLOCK], largest: f64) -> Vector4<f64> {
    let (mut a, mut b) = (Matrix4::identity() * 1e-6, Vector4::zeros());
    for (&(r, c), &h) in PLACES.iter().zip(curvature).filter(|(_, h)| **h > UNSEEN * largest) {
        // h t_r² t_c² should be one: ln t_r + ln t_c = −½ ln h.
        let mut row = Vector4::zeros();
        row[r] += 1.0;
        row[c] += 1.0;
        a += row * row.transpose();
        b -= row * (0.5 * h.ln());
    }
    let logarithms = a.cholesky().map_or_else(Vector4::zeros, |factor| factor.solve(&b));
    logarithms.map(|x| x.clamp(-40.0, 40.0).exp())
}

impl Scaled {
    /// # Errors
    /// An H that is not positive semidefinite.
    pub(super) fn new(problem: &ConsistentProblem) -> Result<Self> {
        let largest = problem.hessian.diagonal().max();
        let unit = parameters_of_block(&Vector4::repeat(1.0));
        let blocks = (0..problem.bodies).map(|b| {
            let h = problem.hessian.fixed_view::<PER_BODY, PER_BODY>(PER_BODY * b, PER_BODY * b);
            let diagonal = (unit.transpose() * h * unit).diagonal();
            parameters_of_block(&balance(&std::array::from_fn(|k| diagonal[k]), largest))
        });
        let others = PER_BODY * problem.bodies;
        let further: Vec<f64> = problem.hessian.diagonal().iter().skip(others).copied().collect();
        let seen = |h: f64| h > UNSEEN * largest;
        let unseen = (0..further.len()).filter(|&i| !seen(further[i])).map(|i| others + i).collect();
        let size = |h: f64| if seen(h) { 1.0 / h.sqrt() } else { 1.0 };
        let mut scaled = Self {
            hessian: DMatrix::zeros(0, 0),
            linear: DVector::zeros(0),
            energy: 1.0,
            open: 0,
            blocks: blocks.collect(),
            sizes: further.iter().copied().map(size).collect(),
            unseen,
        };
        scaled.transform(problem);
        scaled.normalize()?;
        Ok(scaled)
    }

    /// `Tᵀ H T` and `Tᵀ g`, block by block.
    fn transform(&mut self, problem: &ConsistentProblem) {
        let mut right = problem.hessian.clone();
        let (bodies, others) = (self.blocks.len(), PER_BODY * self.blocks.len());
        for b in 0..bodies {
            let columns = right.fixed_columns::<PER_BODY>(PER_BODY * b) * self.blocks[b];
            right.fixed_columns_mut::<PER_BODY>(PER_BODY * b).copy_from(&columns);
        }
        for (i, size) in self.sizes.iter().enumerate() {
            right.column_mut(others + i).scale_mut(*size);
        }
        // Hᵀ is H: the same for the rows.
        let mut both = right.transpose();
        for b in 0..bodies {
            let columns = both.fixed_columns::<PER_BODY>(PER_BODY * b) * self.blocks[b];
            both.fixed_columns_mut::<PER_BODY>(PER_BODY * b).copy_from(&columns);
        }
        for (i, size) in self.sizes.iter().enumerate() {
            both.column_mut(others + i).scale_mut(*size);
        }
        self.hessian = (&both + both.transpose()) * 0.5;
        self.linear = self.gradient(&problem.linear);
    }

    /// `Tᵀ g`.
    fn gradient(&self, g: &DVector<f64>) -> DVector<f64> {
        let mut scaled = g.clone();
        for (b, block) in self.blocks.iter().enumerate() {
            let part = block.transpose() * g.fixed_rows::<PER_BODY>(PER_BODY * b);
            scaled.fixed_rows_mut::<PER_BODY>(PER_BODY * b).copy_from(&part);
        }
        for (i, size) in self.sizes.iter().enumerate() {
            scaled[PER_BODY * self.blocks.len() + i] *= size;
        }
        scaled
    }

    /// Scales all entries together, and the objective, such that it gains one without cones.
    fn normalize(&mut self) -> Result<()> {
        self.open = open_directions(&self.hessian)?;
        let gain = 0.5 * free_gain(&self.hessian, &self.linear);
        if gain > 0.0 && gain.is_finite() {
            self.energy = gain;
            let size = gain.sqrt();
            // u = size · u', f = energy · f': H stays, g falls.
            self.linear /= size;
            self.blocks.iter_mut().for_each(|block| *block *= size);
            self.sizes.iter_mut().for_each(|s| *s *= size);
        }
        self.pull();
        Ok(())
    }

    /// Adds `½ · PULL · ‖u − unit bodies‖²`.
    fn pull(&mut self) {
        let share = PULL * self.hessian.diagonal().amax().max(f64::MIN_POSITIVE);
        for i in 0..self.linear.len() {
            self.hessian[(i, i)] += share;
        }
        for b in 0..self.blocks.len() {
            self.linear.rows_mut(BLOCK * b, 4).add_scalar_mut(share);
        }
    }

    /// x of scaled entries u.
    pub(super) fn parameters(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut x = u.clone();
        for (b, block) in self.blocks.iter().enumerate() {
            let part = block * u.fixed_rows::<BLOCK>(BLOCK * b);
            x.fixed_rows_mut::<PER_BODY>(PER_BODY * b).copy_from(&part);
        }
        for (i, size) in self.sizes.iter().enumerate() {
            x[BLOCK * self.blocks.len() + i] *= size;
        }
        for &i in &self.unseen {
            x[i] = 0.0;
        }
        x
    }
}

/// Number of eigenvalues that are zero up to rounding.
fn open_directions(h: &DMatrix<f64>) -> Result<usize> {
    let eigenvalues = symmetric_eigenvalues(h);
    let largest = eigenvalues.amax();
    match eigenvalues.iter().copied().fold(0.0, f64::min) {
        least if least < -NEGATIVE * largest => Err(IdentificationError::Setting {
            name: "least eigenvalue of the scaled Hessian".into(),
            value: least / largest,
            requirement: "the Hessian must be positive semidefinite".into(),
        }),
        _ => Ok(eigenvalues.iter().filter(|&&x| x <= OPEN * largest).count()),
    }
}

/// `gᵀ H⁻¹ g`, with a share of the diagonal that makes H definite.
fn free_gain(h: &DMatrix<f64>, g: &DVector<f64>) -> f64 {
    let mut definite = h.clone();
    let share = NEGATIVE * h.diagonal().amax().max(f64::MIN_POSITIVE);
    for i in 0..h.nrows() {
        definite[(i, i)] += share;
    }
    definite.cholesky().map_or(0.0, |factor| g.dot(&factor.solve(g)))
}
