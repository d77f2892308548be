//! Primal-dual interior-point method for a quadratic function over positive semidefinite 4 × 4 blocks.
//!
//! The problem is `minimize ½ uᵀ H u − gᵀ u`. The first `10 · blocks` entries of u are symmetric 4 × 4
//! matrices `S ⪰ 0`. The ten entries of a matrix are its diagonal, then the entries above the diagonal times
//! √2. Scalar products of vectors therefore equal scalar products of matrices. The entries with the indices
//! `scalars` are ≥ 0. All other entries are free. The solution and the multipliers z of the cones satisfy `H
//! u − g − z = 0`, `z ⪰ 0` and `uᵀ z = 0`, and z is zero for the free entries.
//!
//! Each iteration linearizes `S Z = μ 1` in the scaling of Nesterov and Todd (1998), in which S and Z are the
//! same diagonal matrix Λ. It has a predictor and a corrector (Mehrotra 1992). The steps of u and z have the
//! same length, as a quadratic objective requires.

use crate::numeric::spectrum;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix4, Vector4};

/// Number of entries of a symmetric 4 × 4 block.
pub(super) const BLOCK: usize = 10;

/// Row and column of each entry of a block.
pub(super) const PLACES: [(usize, usize); BLOCK] =
    [(0, 0), (1, 1), (2, 2), (3, 3), (0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)];

/// Largest length of a step, as a share of the distance to the boundary of the cones.
const TO_BOUNDARY: f64 = 0.99;

/// Gap and residual at which the iteration ends. Better values are below rounding.
const TARGET: f64 = 1e-13;

/// Largest number of iterations. Ten to thirty are usual.
const LIMIT: usize = 100;

/// Number that is added to the diagonal of free entries in the linear equations only. An entry that the
/// Hessian does not determine then stays the same.
const STATIC: f64 = 1e-14;

/// A problem whose entries have sizes near one.
pub(super) struct Cone<'a> {
    pub hessian: &'a DMatrix<f64>,
    pub linear: &'a DVector<f64>,
    pub blocks: usize,
    pub scalars: &'a [usize],
}

/// A point u inside the cones, with its multipliers z.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub u: DVector<f64>,
    pub z: DVector<f64>,
    /// Gap `uᵀ z` of the point u and its multipliers z. The objective exceeds its minimum at most by this
    /// value, up to the residual.
    pub gap: f64,
    /// Largest entry of the optimality condition's residual `H u − g − z`, each divided by one plus the size
    /// of its terms. H and g are the Hessian and the linear term of the objective, and z are the multipliers.
    pub residual: f64,
    pub iterations: usize,
}

impl Point {
    /// The larger of gap and residual, which the iterations decrease.
    fn error(&self) -> f64 {
        self.gap.max(self.residual)
    }

    /// Length of a step Δu, Δz. If the gap would increase at the end of the step, the step is shortened to
    /// the smallest gap. Because of `Δuᵀ Δz = Δuᵀ H Δu > 0`, longer steps would circle the solution (Curtis
    /// and Nocedal 2007).
    fn shortened(&self, length: f64, Direction { u, z, .. }: &Direction) -> f64 {
        let (slope, curvature) = (self.u.dot(z) + self.z.dot(u), u.dot(z));
        let raises = slope < 0.0 && slope + length * curvature > 0.0;
        if raises { -0.5 * slope / curvature } else { length }
    }
}

/// Symmetric matrix from the entries of a block.
pub(super) fn matrix(entries: &[f64]) -> Matrix4<f64> {
    let mut s = Matrix4::zeros();
    for (&(r, c), &x) in PLACES.iter().zip(entries) {
        let x = if r == c { x } else { x * std::f64::consts::FRAC_1_SQRT_2 };
        s[(r, c)] = x;
        s[(c, r)] = x;
    }
    s
}

/// Entries of a block from a symmetric matrix.
pub(super) fn entries(s: &Matrix4<f64>) -> [f64; BLOCK] {
    PLACES.map(
        |(r, c)| {
            if r == c { s[(r, c)] } else { std::f64::consts::FRAC_1_SQRT_2 * (s[(r, c)] + s[(c, r)]) }
        },
    )
}

/// Scaling R of a block S and its multipliers Z, `R⁻¹ S R⁻ᵀ = Rᵀ Z R = Λ` with a diagonal matrix Λ. R is
/// stored as R⁻¹.
struct Scaling {
    inverse: Matrix4<f64>,
    lambda: Vector4<f64>,
}

impl Scaling {
    /// The scaling from Cholesky factors of a block S and its multipliers Z, and one singular value
    /// decomposition; `None` on the boundary.
    fn new(s: &Matrix4<f64>, z: &Matrix4<f64>) -> Option<Self> {
        let (ls, lz) = (s.cholesky()?.unpack(), z.cholesky()?.unpack());
        let svd = spectrum::svd(lz.transpose() * ls);
        let (u, lambda) = (svd.u?, svd.singular_values);
        if !lambda.iter().all(|&x| x > 0.0 && x.is_finite()) {
            return None;
        }
        let root = Matrix4::from_diagonal(&lambda.map(|x| 1.0 / x.sqrt()));
        Some(Self { inverse: root * u.transpose() * lz.transpose(), lambda })
    }

    /// `R⁻ᵀ E R⁻¹`: multipliers of a scaled matrix E, with the scaling R.
    fn to_multipliers(&self, e: &Matrix4<f64>) -> Matrix4<f64> {
        self.inverse.transpose() * e * self.inverse
    }

    /// `R⁻¹ S R⁻ᵀ`: the scaled matrix of a block S, with the scaling R.
    fn of_primal(&self, s: &Matrix4<f64>) -> Matrix4<f64> {
        self.inverse * s * self.inverse.transpose()
    }

    /// Solves `½ (Λ E + E Λ) = target` for E, with the diagonal matrix Λ of the scaled block.
    fn divided(&self, target: &Matrix4<f64>) -> Matrix4<f64> {
        let l = &self.lambda;
        Matrix4::from_fn(|i, j| 2.0 * target[(i, j)] / (l[i] + l[j]))
    }

    /// Matrix of the map `S ↦ W⁻¹ S W⁻¹` of a block S, with `W⁻¹ = R⁻ᵀ R⁻¹` and the scaling R.
    fn curvature(&self) -> [[f64; BLOCK]; BLOCK] {
        let w = self.inverse.transpose() * self.inverse;
        std::array::from_fn(|k| {
            let mut unit = [0.0; BLOCK];
            unit[k] = 1.0;
            entries(&(w * matrix(&unit) * w))
        })
    }

    /// Longest step α of the scaled block Λ in the direction D: `Λ + α D ⪰ 0`.
    fn longest(&self, d: &Matrix4<f64>) -> f64 {
        let l = &self.lambda;
        let scaled = Matrix4::from_fn(|i, j| 0.5 * (d[(i, j)] + d[(j, i)]) / (l[i] * l[j]).sqrt());
        longest(spectrum::symmetric_eigenvalues(&scaled).min())
    }
}

/// Longest step α of a scalar entry in the relative direction d: `1 + α d ≥ 0`.
fn longest(d: f64) -> f64 {
    if d < 0.0 { -1.0 / d } else { f64::INFINITY }
}

/// The factored equations of one iteration: scalings of all cones, and `H + G` with the Hessian H and the
/// curvature G of the cones.
struct Newton<'a> {
    cone: &'a Cone<'a>,
    scalings: Vec<Scaling>,
    /// `√(s z)` and `√(s / z)` of each scalar entry s with its multiplier z.
    scalars: Vec<(f64, f64)>,
    factor: Cholesky<f64, Dyn>,
    /// Residual `H u − g − z` of the optimality condition, with the objective `½ uᵀ H u − gᵀ u` and the
    /// multipliers z.
    residual: DVector<f64>,
}

/// Scaled targets of the complementarity, or scaled steps, of all cones.
#[derive(Clone)]
struct Targets {
    blocks: Vec<Matrix4<f64>>,
    scalars: Vec<f64>,
}

/// A step of the point u and its multipliers z, with the scaled steps of the blocks and scalars.
struct Direction {
    u: DVector<f64>,
    z: DVector<f64>,
    primal: Targets,
    dual: Targets,
}

impl<'a> Newton<'a> {
    /// Returns `None` if the point lies outside of a cone or if the factorization fails, which are effects of rounding.
    fn new(cone: &'a Cone, point: &Point, residual: DVector<f64>) -> Option<Self> {
        let pair = |b: usize| (matrix(block(&point.u, b)), matrix(block(&point.z, b)));
        let scalings: Option<Vec<Scaling>> =
            (0..cone.blocks).map(pair).map(|(s, z)| Scaling::new(&s, &z)).collect();
        let scalings = scalings?;
        let scalar = |&i: &usize| ((point.u[i] * point.z[i]).sqrt(), (point.u[i] / point.z[i]).sqrt());
        let scalars: Vec<(f64, f64)> = cone.scalars.iter().map(scalar).collect();
        let mut matrix = cone.hessian.clone();
        for i in BLOCK * cone.blocks..matrix.nrows() {
            matrix[(i, i)] += STATIC;
        }
        for (b, scaling) in scalings.iter().enumerate() {
            for (k, column) in scaling.curvature().iter().enumerate() {
                for (j, x) in column.iter().enumerate() {
                    matrix[(BLOCK * b + j, BLOCK * b + k)] += x;
                }
            }
        }
        for (&i, (_, w)) in cone.scalars.iter().zip(&scalars) {
            matrix[(i, i)] += 1.0 / (w * w);
        }
        Some(Self { cone, scalings, scalars, factor: Cholesky::new(matrix)?, residual })
    }

    /// Solves `H Δu − Δz = −residual`, `Λ ∘ (ΔŜ + ΔẐ) = target` for the steps Δu and Δz of the point and its
    /// multipliers. ΔŜ and ΔẐ are the scaled steps, and Λ is the scaled point.
    fn direction(&self, target: &Targets) -> Direction {
        let pairs = self.scalings.iter().zip(&target.blocks);
        let divided: Vec<Matrix4<f64>> = pairs.map(|(scaling, t)| scaling.divided(t)).collect();
        let quotients: Vec<f64> = self.scalars.iter().zip(&target.scalars).map(|((l, _), t)| t / l).collect();
        let mut right = -&self.residual;
        self.add_multipliers(&Targets { blocks: divided.clone(), scalars: quotients.clone() }, &mut right);
        let u = self.factor.solve(&right);
        let primal = self.primal(&u);
        let dual = Targets {
            blocks: divided.iter().zip(&primal.blocks).map(|(e, s)| e - s).collect(),
            scalars: quotients.iter().zip(&primal.scalars).map(|(e, s)| e - s).collect(),
        };
        let mut z = DVector::zeros(u.len());
        self.add_multipliers(&dual, &mut z);
        Direction { u, z, primal, dual }
    }

    /// Adds the multipliers of scaled matrices.
    fn add_multipliers(&self, scaled: &Targets, to: &mut DVector<f64>) {
        for (b, (scaling, e)) in self.scalings.iter().zip(&scaled.blocks).enumerate() {
            for (k, x) in entries(&scaling.to_multipliers(e)).into_iter().enumerate() {
                to[BLOCK * b + k] += x;
            }
        }
        for ((&i, (_, w)), e) in self.cone.scalars.iter().zip(&self.scalars).zip(&scaled.scalars) {
            to[i] += e / w;
        }
    }

    /// Scaled steps of the blocks and scalars for a step `u` of the point.
    fn primal(&self, u: &DVector<f64>) -> Targets {
        let blocks = self.scalings.iter().enumerate();
        let scalars = self.cone.scalars.iter().zip(&self.scalars);
        Targets {
            blocks: blocks.map(|(b, scaling)| scaling.of_primal(&matrix(block(u, b)))).collect(),
            scalars: scalars.map(|(&i, (_, w))| u[i] / w).collect(),
        }
    }

    /// Targets of the predictor, `−Λ²` with the scaled point Λ.
    fn predictor(&self) -> Targets {
        Targets {
            blocks: self.scalings.iter().map(|s| Matrix4::from_diagonal(&s.lambda.map(|x| -x * x))).collect(),
            scalars: self.scalars.iter().map(|(l, _)| -l * l).collect(),
        }
    }

    /// Targets of the corrector, `σ μ 1 − Λ² − α ΔŜ ∘ ΔẐ`. Λ is the scaled point, μ the mean gap, σ the
    /// centring factor, α the step of the predictor, and ΔŜ, ΔẐ are the predictor's scaled steps. The whole
    /// correction for a short step would lead away from the central path, and the iteration could cycle
    /// (Colombo and Gondzio 2008).
    fn corrector(&self, affine: &Direction, centre: f64, length: f64) -> Targets {
        let mut target = self.predictor();
        for ((t, s), z) in target.blocks.iter_mut().zip(&affine.primal.blocks).zip(&affine.dual.blocks) {
            *t += Matrix4::from_diagonal_element(centre) - (s * z + z * s) * (0.5 * length);
        }
        for ((t, s), z) in target.scalars.iter_mut().zip(&affine.primal.scalars).zip(&affine.dual.scalars) {
            *t += centre - s * z * length;
        }
        target
    }

    /// Longest step that stays within all cones, at most one.
    fn step(&self, direction: &Direction, share: f64) -> f64 {
        let of = |steps: &Targets| {
            let blocks = self.scalings.iter().zip(&steps.blocks).map(|(s, d)| s.longest(d));
            let scalars = self.scalars.iter().zip(&steps.scalars).map(|((l, _), d)| longest(d / l));
            blocks.chain(scalars).fold(f64::INFINITY, f64::min)
        };
        (share * of(&direction.primal).min(of(&direction.dual))).min(1.0)
    }
}

fn block(u: &DVector<f64>, b: usize) -> &[f64] {
    &u.as_slice()[BLOCK * b..BLOCK * (b + 1)]
}

impl Cone<'_> {
    /// Barrier parameter ν: four for each block, one for each scalar.
    fn degree(&self) -> f64 {
        (4 * self.blocks + self.scalars.len()).max(1) as f64
    }

    fn set_identity(&self, u: &mut DVector<f64>, size: f64) {
        for b in 0..self.blocks {
            for k in 0..BLOCK {
                u[BLOCK * b + k] = if k < 4 { size } else { 0.0 };
            }
        }
        for &i in self.scalars {
            u[i] = size;
        }
    }

    /// Residual `H u − g − z` of the optimality condition at the point u with the multipliers z, and its
    /// largest entry. For the largest entry, each entry is divided by one plus the size of its terms.
    fn residual(&self, u: &DVector<f64>, z: &DVector<f64>) -> (DVector<f64>, f64) {
        let product = self.hessian * u;
        let sizes = self.hessian.abs() * u.abs();
        let residual = &product - self.linear - z;
        let relative = |i: usize| residual[i].abs() / (1.0 + sizes[i] + self.linear[i].abs() + z[i].abs());
        let largest = (0..u.len()).map(relative).fold(0.0, f64::max);
        (residual, largest)
    }

    fn point(&self, u: DVector<f64>, z: DVector<f64>, iterations: usize) -> (Point, DVector<f64>) {
        let (vector, residual) = self.residual(&u, &z);
        let gap = u.dot(&z);
        (Point { u, z, gap, residual, iterations }, vector)
    }

    /// The point with the smallest [`Point::error`] of all iterations.
    pub(super) fn minimize(&self) -> Point {
        let (mut u, mut z) = (DVector::zeros(self.linear.len()), DVector::zeros(self.linear.len()));
        self.set_identity(&mut u, 1.0);
        self.set_identity(&mut z, 1.0);
        let (mut point, mut residual) = self.point(u, z, 0);
        let mut best = point.clone();
        for iteration in 1..=LIMIT {
            let Some(next) = self.advance(&point, residual) else { break };
            (point, residual) = self.point(next.0, next.1, iteration);
            if !point.error().is_finite() {
                break;
            }
            if point.error() < best.error() {
                best = point.clone();
            }
            // Ten iterations without a better point show that only rounding is left.
            if best.error() <= TARGET || iteration >= best.iterations + 10 {
                break;
            }
        }
        best
    }

    /// One iteration of predictor and corrector; `None` if rounding or the cones allow no further step.
    fn advance(&self, point: &Point, residual: DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
        let newton = Newton::new(self, point, residual)?;
        let affine = newton.direction(&newton.predictor());
        let length = newton.step(&affine, 1.0);
        let mu = point.gap / self.degree();
        let centre = mu * (1.0 - length).powi(3);
        let direction = newton.direction(&newton.corrector(&affine, centre, length));
        let length = point.shortened(newton.step(&direction, TO_BOUNDARY), &direction);
        let stuck = length < 1e-12 || !length.is_finite();
        (!stuck).then(|| (&point.u + &direction.u * length, &point.z + &direction.z * length))
    }
}
