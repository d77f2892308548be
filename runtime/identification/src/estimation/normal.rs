//! The weighted normal equations of all joints from sums of products, and their solution.

use super::super::error::{IdentificationError, Result};
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, LOAD, Layout, VISCOUS};
use super::prior::Prior;
use super::result::Offsets;
use super::sums::Sums;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Choice of the unknowns that are estimated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Model {
    /// Coulomb term of each joint, as an index of the candidate widths.
    pub(super) coulomb: Vec<usize>,
    pub(super) asymmetry: Vec<bool>,
    pub(super) armature: Vec<bool>,
    /// Whether each joint has load-dependent friction.
    pub(super) load: Vec<bool>,
    pub(super) offsets: Offsets,
    /// Whether bodies must be physically possible.
    pub(super) consistent: bool,
}

/// Values of all unknowns and gains. An inertial parameter is a difference from the description. A candidate term that is
/// not chosen is zero.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Values {
    /// Values of the unknowns, in the order of [`Layout`].
    pub(super) unknowns: DVector<f64>,
    /// Force per unit of the measured effort, for each joint: one, or the motor constant K_M.
    pub(super) gains: Vec<f64>,
}

/// Sums for one choice of offsets: products of each joint with the offsets projected out, for all data (`all`) and without
/// each fold (`without`).
pub(super) struct Centred<'a> {
    pub(super) layout: &'a Layout,
    pub(super) sums: &'a Sums,
    pub(super) offsets: Offsets,
    /// For each joint, the weight of the prior that its offset is zero, as a number of samples with zero force.
    pub(super) zeros: Vec<f64>,
    pub(super) all: Vec<DMatrix<f64>>,
    pub(super) without: Vec<Vec<DMatrix<f64>>>,
}

impl Model {
    /// Indices of the estimated unknowns, ascending.
    pub(super) fn active(&self, layout: &Layout, prior: &Prior) -> Vec<usize> {
        let mut active: Vec<usize> = (0..layout.parameters).filter(|&i| !prior.held[i]).collect();
        for joint in layout.rubbing() {
            active.push(layout.term(joint, VISCOUS));
            active.push(layout.term(joint, COULOMB.start + self.coulomb[joint]));
            let optional = [(ASYMMETRY, &self.asymmetry), (ARMATURE, &self.armature), (LOAD, &self.load)];
            for (term, chosen) in optional {
                active.extend(chosen[joint].then(|| layout.term(joint, term)));
            }
        }
        active.extend((0..layout.delay_count()).map(|number| layout.delay(number)));
        active
    }
}

impl<'a> Centred<'a> {
    pub(super) fn new(layout: &'a Layout, sums: &'a Sums, offsets: Offsets, zeros: Vec<f64>) -> Self {
        let of = |without| -> Vec<DMatrix<f64>> {
            let joint = |j: usize| centred(sums, j, without, layout.offsets(j, offsets), zeros[j]);
            (0..layout.joints).map(joint).collect()
        };
        let (all, without) = (of(None), (0..sums.folds.len()).map(|k| of(Some(k))).collect());
        Self { layout, sums, offsets, zeros, all, without }
    }

    /// `Σ (z − z̄)²` of the measured forces z of a joint, with the mean z̄ over samples that share an offset; NaN if no
    /// force acts.
    pub(super) fn variation(&self, joint: usize) -> f64 {
        let products = centred(self.sums, joint, None, self.layout.offsets(joint, self.offsets), 0.0);
        let last = products.nrows() - 1;
        let squares = products[(last, last)];
        if !self.layout.exact[joint] {
            return squares;
        }
        let (weight, sum) =
            self.sums.by_run(joint, None).iter().fold((0.0, 0.0), |(n, sum), (m, s)| (n + m, sum + s[last]));
        if squares > 0.0 { squares - sum * sum / weight } else { f64::NAN }
    }

    /// Residual sum of squares of each joint, in the data to which the values were fitted.
    pub(super) fn residuals(&self, products: &[DMatrix<f64>], values: &Values) -> Vec<f64> {
        let rss = |j: usize| {
            let r = residual_vector(self.layout, values, j);
            (&products[j] * &r).dot(&r).max(0.0)
        };
        (0..self.layout.joints).map(rss).collect()
    }

    /// Residual sum of squares of each joint over a fold, with the offsets that were fitted to the other
    /// folds.
    pub(super) fn held_out(&self, fold: usize, values: &Values) -> Vec<f64> {
        (0..self.layout.joints).map(|j| self.rss_over(self.sums, fold, values, j)).collect()
    }

    /// Residual sum of squares of a joint over a fold of the given sums, with the offsets from the other folds of `self`.
    pub(super) fn rss_over(&self, sums: &Sums, fold: usize, values: &Values, joint: usize) -> f64 {
        let r = residual_vector(self.layout, values, joint);
        let offsets = self.offsets_without(Some(fold), &r, joint);
        let mut rss = (&sums.folds[fold][joint] * &r).dot(&r);
        for piece in sums.pieces.iter().filter(|p| p.fold == fold) {
            let offset = offsets[piece.run];
            rss += offset * (offset * piece.weight[joint] - 2.0 * piece.columns[joint].dot(&r));
        }
        rss.max(0.0)
    }

    /// Offset of each joint and run. A run without used samples has the common offset of all runs.
    pub(super) fn all_offsets(&self, values: &Values) -> Vec<Vec<f64>> {
        let of_joint = |j: usize| self.offsets_without(None, &residual_vector(self.layout, values, j), j);
        (0..self.layout.joints).map(of_joint).collect()
    }

    /// Sum of the squares of a joint's offsets, fitted without a fold, times the weight of the prior ([`Self::zeros`]).
    pub(super) fn distance_of_offsets(&self, fold: usize, values: &Values, joint: usize) -> f64 {
        let offsets = self.offsets_without(Some(fold), &residual_vector(self.layout, values, joint), joint);
        let own = if self.offsets == Offsets::Common { &offsets[..1] } else { &offsets[..] };
        self.zeros[joint] * own.iter().map(|offset| offset * offset).sum::<f64>()
    }

    fn offsets_without(&self, fold: Option<usize>, r: &DVector<f64>, joint: usize) -> Vec<f64> {
        let runs = self.sums.by_run(joint, fold);
        let sums: Vec<(f64, f64)> = runs.iter().map(|(n, s)| (*n, s.dot(r))).collect();
        let (n, total) = sums.iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        let zeros = self.zeros[joint];
        let common = if n > 0.0 { total / (n + zeros) } else { 0.0 };
        let of_run = |&(n, sum): &(f64, f64)| match self.layout.offsets(joint, self.offsets) {
            Offsets::None => 0.0,
            Offsets::ByRun if n > 0.0 => sum / (n + zeros),
            Offsets::Common | Offsets::ByRun => common,
        };
        sums.iter().map(of_run).collect()
    }

    /// For each group of samples of a joint that share an offset: the weight of the samples plus the weight of the offset's
    /// prior, and the sum of the columns divided by this total weight.
    pub(super) fn means(&self, joint: usize) -> Vec<(f64, DVector<f64>)> {
        let groups = groups(self.sums.by_run(joint, None), self.layout.offsets(joint, self.offsets));
        let zeros = self.zeros[joint];
        let mean =
            |(n, sum): (f64, DVector<f64>)| (n + zeros, if n > 0.0 { sum / (n + zeros) } else { 0.0 * sum });
        groups.into_iter().map(mean).collect()
    }
}

/// Sums of products of a joint's columns without the part that offsets explain.
///
/// - `without`: fold that is left out
/// - `zeros`: weight of the prior of each offset, as in [`Centred::zeros`]
fn centred(sums: &Sums, joint: usize, without: Option<usize>, offsets: Offsets, zeros: f64) -> DMatrix<f64> {
    let mut products = sums.products(joint, without);
    for (weight, columns) in groups(sums.by_run(joint, without), offsets).iter().filter(|g| g.0 > 0.0) {
        products.ger(-1.0 / (weight + zeros), columns, columns, 1.0);
    }
    products
}

/// Weights and sums of samples that share an offset; empty if forces have no offset.
fn groups(runs: Vec<(f64, DVector<f64>)>, offsets: Offsets) -> Vec<(f64, DVector<f64>)> {
    match offsets {
        Offsets::None => Vec::new(),
        Offsets::ByRun => runs,
        Offsets::Common => runs.into_iter().reduce(|a, b| (a.0 + b.0, a.1 + b.1)).into_iter().collect(),
    }
}

/// Factors of a joint's columns in its residual, which is the measured force minus three forces: the
/// described force, the force of the changed inertial parameters, and friction.
pub(super) fn residual_vector(layout: &Layout, values: &Values, joint: usize) -> DVector<f64> {
    let local = &layout.local[joint];
    let mut r = DVector::zeros(local.len() + 2);
    for (place, &global) in r.iter_mut().zip(local) {
        *place = -values.unknowns[global] * layout.scale(global, values.gains[joint]);
    }
    r[local.len()] = -1.0;
    r[local.len() + 1] = values.gains[joint];
    r
}

/// The normal equations `H x = g` over the active unknowns x, with the Hessian H and the right side g.
pub(super) struct Normal {
    pub(super) hessian: DMatrix<f64>,
    pub(super) linear: DVector<f64>,
}

/// Adds up the equations of the joints.
///
/// - `products`: sums of products of each joint
/// - `weights`: weights 1/σ² of each joint's equations in units of the force
pub(super) fn assemble(
    layout: &Layout,
    products: &[DMatrix<f64>],
    active: &[usize],
    weights: &[f64],
    gains: &[f64],
) -> Normal {
    let mut place = vec![None; layout.len()];
    active.iter().enumerate().for_each(|(i, &global)| place[global] = Some(i));
    let mut normal =
        Normal { hessian: DMatrix::zeros(active.len(), active.len()), linear: DVector::zeros(active.len()) };
    for joint in 0..layout.joints {
        normal.add(layout, joint, &products[joint], &place, [weights[joint], gains[joint]]);
    }
    normal
}

impl Normal {
    fn add(
        &mut self,
        layout: &Layout,
        joint: usize,
        products: &DMatrix<f64>,
        place: &[Option<usize>],
        [weight, gain]: [f64; 2],
    ) {
        let local = &layout.local[joint];
        let column =
            |(k, &global): (usize, &usize)| place[global].map(|i| (k, i, layout.scale(global, gain)));
        let chosen: Vec<(usize, usize, f64)> = local.iter().enumerate().filter_map(column).collect();
        let target = products.column(local.len() + 1) * gain - products.column(local.len());
        for &(k, i, scale) in &chosen {
            self.linear[i] += weight * scale * target[k];
            for &(l, m, other) in &chosen {
                self.hessian[(i, m)] += weight * scale * other * products[(k, l)];
            }
        }
    }
}

/// Matrix that maps a joint's columns to the columns of the active unknowns.
pub(super) fn selection(layout: &Layout, joint: usize, gain: f64, active: &[usize]) -> DMatrix<f64> {
    let mut selection = DMatrix::zeros(layout.width(joint), active.len());
    for (i, &global) in active.iter().enumerate() {
        if let Some(k) = layout.local[joint].iter().position(|local| *local == global) {
            selection[(k, i)] = layout.scale(global, gain);
        }
    }
    selection
}

/// The rigid-body force for given values, as factors of the joint's columns.
pub(super) fn force_vector(layout: &Layout, at: &Values, joint: usize) -> DVector<f64> {
    let local = &layout.local[joint];
    let mut c = DVector::zeros(local.len() + 2);
    for (k, &global) in local.iter().enumerate().filter(|(_, global)| **global < layout.parameters) {
        c[k] = at.unknowns[global];
    }
    c[local.len()] = 1.0;
    c
}

/// The Hessian plus the description's metric Λ. A ridge of the size of rounding errors is added for all unknowns.
pub(super) fn regularized(normal: &Normal, metric: &DMatrix<f64>) -> DMatrix<f64> {
    let mut a = &normal.hessian + metric;
    for i in 0..a.nrows() {
        let own = a[(i, i)];
        a[(i, i)] = if own > 0.0 { own * (1.0 + 1e-12) } else { 1.0 };
    }
    a
}

/// Share of the diagonal that is added if columns may be equal.
pub(super) const RIDGE: f64 = 1e-9;

/// Normal equations with a ridge, for columns that may be equal or zero.
pub(crate) fn with_ridge(mut normal: DMatrix<f64>) -> DMatrix<f64> {
    for i in 0..normal.nrows() {
        normal[(i, i)] = normal[(i, i)] * (1.0 + RIDGE) + f64::MIN_POSITIVE;
    }
    normal
}

/// Largest sum of products that data in sensible units can have.
const LARGEST_SUM: f64 = 1e150;

/// The factorization `A = D L Lᵀ D` of a symmetric positive definite matrix, with a unit diagonal of `L Lᵀ`.
pub(super) struct Factor {
    /// Diagonal of D⁻¹, the inverse of the scaling D.
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Factor {
    /// # Errors
    /// [`IdentificationError::NoSolution`] if the matrix is not positive definite, and [`IdentificationError::Overflow`] if
    /// its entries are not finite or too large.
    pub(super) fn new(a: &DMatrix<f64>) -> Result<Self> {
        let scale = DVector::from_fn(a.nrows(), |i, _| 1.0 / a[(i, i)].sqrt());
        let scaled = DMatrix::from_fn(a.nrows(), a.ncols(), |i, k| a[(i, k)] * scale[i] * scale[k]);
        // If rounding made the matrix indefinite, the directions concerned are below the resolution of the sums.
        for ridge in [0.0, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8] {
            let mut shifted = scaled.clone();
            shifted.fill_diagonal(1.0 + ridge);
            if let Some(factor) = shifted.cholesky() {
                return Ok(Self { scale, factor });
            }
        }
        let largest = a.amax();
        if largest < LARGEST_SUM {
            let reason = "the equations are singular, because the log is too short or the robot moves too little. Record 10 s or \
                          more in which all joints move";
            return Err(IdentificationError::NoSolution { reason: reason.into() });
        }
        Err(IdentificationError::Overflow { what: "the sum of products".into(), largest })
    }

    pub(super) fn solve(&self, b: &DMatrix<f64>) -> DMatrix<f64> {
        self.scaled(self.factor.solve(&self.scaled(b.clone())))
    }

    /// The product `D⁻¹ B` of a matrix B with the inverse of the scaling D.
    pub(super) fn scaled(&self, mut b: DMatrix<f64>) -> DMatrix<f64> {
        b.row_iter_mut().zip(self.scale.iter()).for_each(|(mut row, scale)| row *= *scale);
        b
    }

    /// The product `L⁻¹ D⁻¹ B` of a matrix B with the inverse factors of A: coordinates in which A is the
    /// identity.
    pub(super) fn whitened(&self, b: DMatrix<f64>) -> DMatrix<f64> {
        let mut whitened = self.scaled(b);
        self.factor.l().solve_lower_triangular_mut(&mut whitened);
        whitened
    }
}

/// The inverse of a symmetric positive definite matrix, with the errors of [`Factor::new`].
pub(crate) fn inverse(a: &DMatrix<f64>) -> Result<DMatrix<f64>> {
    Ok(Factor::new(a)?.solve(&DMatrix::identity(a.nrows(), a.nrows())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn singular_sums_are_told_from_sums_that_overflow() {
        let of = |size: f64| {
            Factor::new(&(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]) * size)).map(|_| ())
        };
        for size in [1e-10, 1.0, 1e17] {
            assert!(matches!(of(size), Err(IdentificationError::NoSolution { .. })), "{size}");
        }
        for size in [1e200, f64::INFINITY] {
            assert!(matches!(of(size), Err(IdentificationError::Overflow { .. })), "{size}");
        }
    }
}
