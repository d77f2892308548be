//! The convex program of physically possible bodies, scaled to variables with sizes near one.
//!
//! A body's pseudo-inertia is `J = T S T` with a diagonal matrix T of four sizes. The sizes are chosen such that the Hessian H
//! has a diagonal near one in the entries of S. This congruence keeps the cone. Other entries are scaled one by one. Then all
//! entries are multiplied by a common factor, with which the minimum without cones decreases the objective by one. Without the
//! scaling, a problem with 100 kg and 10⁻⁶ kg m² would lose its smaller digits, and the iteration would start far from its
//! solution.

use super::consistent::ConsistentProblem;
use super::interior_point::{BLOCK, PLACES};
use super::pseudo_inertia::{PER_BODY, from_pseudo_inertia};
use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, Vector4};

/// Share of the largest curvature below which a curvature counts as rounding. The data do not determine such a direction.
const UNSEEN: f64 = 1e-24;

/// Share of the diagonal that is added to a Hessian that rounding made indefinite.
const ROUNDING: f64 = 1e-9;

/// Weight of the scaled distance from a body of unit sizes in the objective. If the Hessian determines the
/// body, this term has the size of rounding. If the Hessian does not determine the body, the multipliers
/// would have no interior without this term, and the iteration would stop early.
const PULL: f64 = 1e-12;

type Block = SMatrix<f64, PER_BODY, BLOCK>;

/// The scaled program, and the map of its solution to the parameters.
pub(super) struct Scaled {
    pub hessian: DMatrix<f64>,
    pub linear: DVector<f64>,
    blocks: Vec<Block>,
    /// Sizes of the entries after those of the bodies.
    sizes: Vec<f64>,
}

/// Matrix that maps the entries of a body's scaled pseudo-inertia S to its ten parameters. The pseudo-inertia
/// is `J = T S T` with the diagonal matrix T of the sizes.
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

/// Diagonal matrix T of a body's sizes, by least squares over the logarithms of the Hessian's diagonal in the
/// entries of the pseudo-inertia.
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
    pub(super) fn new(problem: &ConsistentProblem) -> Self {
        let largest = problem.hessian.diagonal().max();
        let unit = parameters_of_block(&Vector4::repeat(1.0));
        let blocks = (0..problem.bodies).map(|b| {
            let h = problem.hessian.fixed_view::<PER_BODY, PER_BODY>(PER_BODY * b, PER_BODY * b);
            let diagonal = (unit.transpose() * h * unit).diagonal();
            parameters_of_block(&balance(&std::array::from_fn(|k| diagonal[k]), largest))
        });
        let others = PER_BODY * problem.bodies;
        let further = problem.hessian.diagonal();
        let size = |h: &f64| if *h > 0.0 { 1.0 / h.sqrt() } else { 1.0 };
        let mut scaled = Self {
            hessian: DMatrix::zeros(0, 0),
            linear: DVector::zeros(0),
            blocks: blocks.collect(),
            sizes: further.iter().skip(others).map(size).collect(),
        };
        scaled.transform(problem);
        scaled.normalize();
        scaled
    }

    /// Computes the scaled Hessian `Tᵀ H T` and linear term `Tᵀ g` of the objective `½ xᵀ H x − gᵀ x`, block
    /// by block, for x = T u with the scaled entries u.
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
        // H is symmetric, so the rows are scaled as the columns of the transpose.
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

    /// Scaled linear term `Tᵀ g` of the objective, from the linear term g and the sizes T.
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

    /// Scales all entries by a common factor, such that the minimum without cones decreases the objective by one.
    fn normalize(&mut self) {
        let gain = 0.5 * free_gain(&self.hessian, &self.linear);
        if gain > 0.0 && gain.is_finite() {
            let size = gain.sqrt();
            // With u = size · u' and f = energy · f', H stays the same and g decreases.
            self.linear /= size;
            self.blocks.iter_mut().for_each(|block| *block *= size);
            self.sizes.iter_mut().for_each(|s| *s *= size);
        }
        self.pull();
    }

    /// Adds `½ · PULL · ‖u − unit bodies‖²` to the objective, with the scaled entries u and the largest
    /// diagonal entry of the Hessian as a factor.
    fn pull(&mut self) {
        let share = PULL * self.hessian.diagonal().amax().max(f64::MIN_POSITIVE);
        for i in 0..self.linear.len() {
            self.hessian[(i, i)] += share;
        }
        for b in 0..self.blocks.len() {
            self.linear.rows_mut(BLOCK * b, 4).add_scalar_mut(share);
        }
    }

    /// Parameters x of scaled entries u.
    pub(super) fn parameters(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut x = u.clone();
        for (b, block) in self.blocks.iter().enumerate() {
            let part = block * u.fixed_rows::<BLOCK>(BLOCK * b);
            x.fixed_rows_mut::<PER_BODY>(PER_BODY * b).copy_from(&part);
        }
        for (i, size) in self.sizes.iter().enumerate() {
            x[BLOCK * self.blocks.len() + i] *= size;
        }
        x
    }
}

/// Twice the decrease of the objective from zero to its minimum, `gᵀ H⁻¹ g` with the Hessian H and the linear
/// term g. A share of the diagonal is added to H, which makes H definite.
fn free_gain(h: &DMatrix<f64>, g: &DVector<f64>) -> f64 {
    let mut definite = h.clone();
    let share = ROUNDING * h.diagonal().amax().max(f64::MIN_POSITIVE);
    for i in 0..h.nrows() {
        definite[(i, i)] += share;
    }
    definite.cholesky().map_or(0.0, |factor| g.dot(&factor.solve(g)))
}
