//! Bounds in the interior-point method: slacks, multipliers and their Newton steps, four bounds at a time.
//!
//! A bound b of a variable z is `ς (z − b) + t ≥ 0` with ς = +1 for a lower bound and −1 for an upper bound.
//! The softening `t` is absent for a hard bound. The slack `s > 0` satisfies `ς (z − b) + t − s = −r` with
//! the residual r, and the multiplier is `λ > 0`. A soft bound costs `w₁ t + ½ w₂ t²` with `t ≥ 0`. The
//! multiplier of `t ≥ 0` is `ν = w₁ + w₂ t − λ > 0`. The elimination of `ds`, `dt` and `dν` from the Newton
//! system leaves a diagonal term W in z:
//! ```text
//!     s dλ + λ ds = −rc₁ = −(s λ − τ + c₁)       t dν + ν dt = −rc₂ = −(t ν − τ + c₂)       τ = σμ, c: second-order correction
//!     ς dz + dt + r = ds       dν = w₂ dt − dλ       D = ν + w₂ t (1 if hard)       Δ = D s + t λ (t = 0 if hard)
//!     λ + dλ = λ (t (λ + ν) − D r)/Δ + (D (τ − c₁) − λ (τ − c₂))/Δ − W ς dz       W = λ D/Δ
//! ```
//!
//! Source: Wright, *Primal-Dual Interior-Point Methods*, SIAM 1997, chapters 1 and 10. The elimination of
//! soft bounds is from Frison, Diehl, *HPIPM*, IFAC 2020, section 3.

mod augmented;
mod measure;
mod side;
mod start;

pub(super) use self::measure::ROUNDING;
pub(super) use self::side::Totals;
use self::side::{Side, Softening, Tally};
use super::lanes::{Vector, vectorized};
use super::multipliers::Multipliers;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// All bounds of one kind of variable (inputs or states), and the passes of an interior-point iteration over
/// them.
#[derive(Debug, Clone)]
pub(super) struct Bounds<V> {
    sides: Vec<[Side<V>; 2]>,
    soft: Vec<[Softening<V>; 2]>,
    /// Largest diagonal term `W_max` of the Newton system, and its inverse.
    cap: [V; 2],
}

impl<V: Vector> Bounds<V> {
    pub(super) fn new(lanes: usize) -> Self {
        Self {
            sides: vec![Default::default(); lanes],
            soft: vec![Default::default(); lanes],
            cap: [V::one(); 2],
        }
    }

    /// Clears bounds, slacks and multipliers.
    pub(super) fn forget(&mut self) {
        self.sides.fill(Default::default());
        self.soft.fill(Default::default());
    }

    /// Sets the largest diagonal term `W_max` of the Newton system. With larger terms, smaller weights would
    /// lose digits, for example the input weights `R` in `R + BᵀWB`. Steps then use `λ/W_max` with the
    /// multiplier λ instead of a smaller slack. Such a step is still a Newton step to second order, because
    /// `dλ` vanishes at the optimum.
    pub(super) fn cap_weights(&mut self, cap: f64) {
        self.cap = [V::splat(cap), V::splat(1.0 / cap)];
    }

    /// Linearizes the bounds by [`Self::linearize_as`], with or without soft bounds.
    pub(super) fn linearize(
        &mut self,
        soft: bool,
        z: &[V],
        gradient: &[V],
        weight: &mut [V],
        rhs: &mut [V],
    ) -> Totals {
        vectorized!(V, {
            if soft {
                self.linearize_as::<true>(z, gradient, weight, rhs)
            } else {
                self.linearize_as::<false>(z, gradient, weight, rhs)
            }
        })
    }

    /// Computes the affine steps by [`Self::predictor_as`], with or without soft bounds.
    pub(super) fn predictor(&mut self, soft: bool, dz: &[V]) -> Totals {
        vectorized!(V, { if soft { self.predictor_as::<true>(dz) } else { self.predictor_as::<false>(dz) } })
    }

    /// Computes the gradient of the centred step by [`Self::centre_as`], with or without soft bounds.
    pub(super) fn centre(&mut self, soft: bool, gradient: &[V], target: f64, correction: f64, rhs: &mut [V]) {
        vectorized!(V, {
            if soft {
                self.centre_as::<true>(gradient, target, correction, rhs);
            } else {
                self.centre_as::<false>(gradient, target, correction, rhs);
            }
        })
    }

    /// Computes the centred steps by [`Self::corrector_as`], with or without soft bounds.
    pub(super) fn corrector(&mut self, soft: bool, dz: &[V], target: f64, correction: f64) -> Totals {
        vectorized!(V, {
            if soft {
                self.corrector_as::<true>(dz, target, correction)
            } else {
                self.corrector_as::<false>(dz, target, correction)
            }
        })
    }

    /// Takes a step by [`Self::advance_as`], with or without soft bounds.
    pub(super) fn advance(&mut self, soft: bool, length: f64) {
        vectorized!(V, {
            if soft {
                self.advance_as::<true>(length);
            } else {
                self.advance_as::<false>(length);
            }
        })
    }

    /// Calls [`Self::start_as`] with or without soft bounds.
    pub(super) fn start(
        &mut self,
        soft: bool,
        z: &[V],
        mu: f64,
        share: f64,
        far: bool,
        last: Option<&Multipliers<V>>,
    ) {
        vectorized!(V, {
            if soft {
                self.start_as::<true>(z, mu, share, far, last);
            } else {
                self.start_as::<false>(z, mu, share, far, last);
            }
        })
    }

    /// First pass: sets `weight` to the diagonal barrier term and `rhs` to the gradient of the affine step.
    /// Returns `Σ sλ` of the slacks s and multipliers λ, the largest residual, and the largest multiplier.
    #[inline(always)]
    fn linearize_as<const SOFT: bool>(
        &mut self,
        z: &[V],
        gradient: &[V],
        weight: &mut [V],
        rhs: &mut [V],
    ) -> Totals {
        let mut tally = Tally::new();
        let cap = self.cap;
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            let from_below = lower.linearize::<false, SOFT>(soft_lower, z[i], cap, &mut tally);
            let pull = from_below - upper.linearize::<true, SOFT>(soft_upper, z[i], cap, &mut tally);
            weight[i] = lower.weight + upper.weight;
            rhs[i] = gradient[i] - pull;
        }
        tally.totals()
    }

    /// Second pass: affine steps. Returns `Σ ds dλ` of the steps of slacks and multipliers, and the inverse
    /// step to the boundary.
    #[inline(always)]
    fn predictor_as<const SOFT: bool>(&mut self, dz: &[V]) -> Totals {
        let mut tally = Tally::new();
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            lower.predictor::<false, SOFT>(soft_lower, dz[i], &mut tally);
            upper.predictor::<true, SOFT>(soft_upper, dz[i], &mut tally);
        }
        tally.totals()
    }

    /// Third pass: sets `rhs` to the gradient of the centred and corrected step.
    #[inline(always)]
    fn centre_as<const SOFT: bool>(&mut self, gradient: &[V], target: f64, correction: f64, rhs: &mut [V]) {
        let (target, correction) = (V::splat(target), V::splat(correction));
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            rhs[i] = gradient[i] - lower.centred::<SOFT>(soft_lower, target, correction)
                + upper.centred::<SOFT>(soft_upper, target, correction);
        }
    }

    /// Fourth pass: centred and corrected steps. Returns the inverse step to the boundary.
    #[inline(always)]
    fn corrector_as<const SOFT: bool>(&mut self, dz: &[V], target: f64, correction: f64) -> Totals {
        let mut tally = Tally::new();
        let target = [V::splat(target), V::splat(correction)];
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            lower.corrector::<false, SOFT>(soft_lower, dz[i], target, &mut tally);
            upper.corrector::<true, SOFT>(soft_upper, dz[i], target, &mut tally);
        }
        tally.totals()
    }

    /// Fifth pass: takes the step with this length.
    #[inline(always)]
    fn advance_as<const SOFT: bool>(&mut self, length: f64) {
        let length = V::splat(length);
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            lower.advance::<SOFT>(soft_lower, length);
            upper.advance::<SOFT>(soft_upper, length);
        }
    }
}
