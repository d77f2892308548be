//! The bounds inside the interior-point method: slacks, multipliers and their Newton steps, four at a time.
//!
//! A bound `ς (z − b) + t ≥ 0` (ς = +1 lower, −1 upper; `t` the softening, absent for a hard bound) is
//! written with the slack `s > 0`, `ς (z − b) + t − s = −r`, and the multiplier `λ > 0`. A soft bound costs
//! `w₁ t + ½ w₂ t²`, `t ≥ 0`, whose own multiplier is `ν = w₁ + w₂ t − λ > 0`. Eliminating `ds`, `dt`, `dν`
//! from the Newton system leaves a diagonal term in z:
//!
//! ```text
//!     s dλ + λ ds = −rc₁ = −(s λ − τ + c₁)       t dν + ν dt = −rc₂ = −(t ν − τ + c₂)       τ = σμ, c: second-order correction
//!     ς dz + dt + r = ds       dν = w₂ dt − dλ       D = ν + w₂ t (1 if hard)       Δ = D s + t λ (t = 0 if hard)
//!     λ + dλ = λ (t (λ + ν) − D r)/Δ + (D (τ − c₁) − λ (τ − c₂))/Δ − W ς dz       W = λ D/Δ
//! ```
//!
//! Source: Wright, *Primal-Dual Interior-Point Methods*, SIAM 1997, chapters 1 and 10; the elimination of
//! soft bounds as in Frison, Diehl, *HPIPM*, IFAC 2020, section 3.

use super::lanes::{Vector, WIDTH, flat_mut, largest};
use super::multipliers::Multipliers;

/// Bounds that are closer to each other are treated as this far apart when the method starts.
const MIN_WIDTH: f64 = 1e-6;

/// Slacks at the start are at least this share of the violation of the bound or its opposite.
const VIOLATION_SHARE: f64 = 0.1;
/// Distances to a bound below this, relative to the bound where that exceeds 1, are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// One side of four bounds.
#[derive(Debug, Clone, Copy)]
struct Side<V> {
    /// Bound, and 1 where it is finite, 0 elsewhere (the bound is then stored as 0, slack and multiplier stay
    /// 1).
    bound: V,
    active: V,
    /// `1/max(1, |bound|)` where it is finite, 0 elsewhere: violations count beside the size of the bound.
    relative: V,
    slack: V,
    multiplier: V,
    /// Primal residual `r`.
    residual: V,
    /// `W`, `1/s`, `1/λ` of the present iterate.
    weight: V,
    inverse_slack: V,
    inverse_multiplier: V,
    /// `1/s̃` and `s̃ − s`: the slack of the Newton system, `s̃ = max(s, λ/W_max)`, see
    /// [`Bounds::cap_weights`].
    inverse_damped: V,
    excess: V,
    /// Steps; after the predictor the affine ones.
    ds: V,
    dl: V,
}

/// What a soft bound has beyond a hard one.
#[derive(Debug, Clone, Copy)]
struct Softening<V> {
    /// 1 where the bound is soft, 0 where it is hard.
    active: V,
    /// 1 where the bound is hard but softened by [`Bounds::soften`].
    relaxed: V,
    w1: V,
    w2: V,
    t: V,
    nu: V,
    /// `D` and `1/Δ`.
    d: V,
    inverse_delta: V,
    inverse_t: V,
    inverse_nu: V,
    dt: V,
    dnu: V,
}

/// Sums and maxima over the bounds, gathered by the passes below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tally<V> {
    sum: V,
    max: V,
    force: V,
}

impl<V: Vector> Tally<V> {
    pub(super) fn new() -> Self {
        Self { sum: V::zero(), max: V::zero(), force: V::zero() }
    }
    #[inline(always)]
    pub(super) fn force(&self) -> f64 {
        largest(self.force)
    }
    #[inline(always)]
    pub(super) fn sum(&self) -> f64 {
        self.sum.reduce_add()
    }
    #[inline(always)]
    pub(super) fn max(&self) -> f64 {
        largest(self.max)
    }
}

impl<V: Vector> Default for Side<V> {
    /// An inert bound: slack and multiplier 1 keep the arithmetic finite.
    fn default() -> Self {
        let (zero, one) = (V::zero(), V::one());
        Self {
            bound: zero,
            active: zero,
            relative: zero,
            slack: one,
            multiplier: one,
            residual: zero,
            weight: zero,
            inverse_slack: one,
            inverse_multiplier: one,
            inverse_damped: one,
            excess: zero,
            ds: zero,
            dl: zero,
        }
    }
}

impl<V: Vector> Default for Softening<V> {
    /// A hard bound: t and ν of 1 keep the arithmetic finite.
    fn default() -> Self {
        let (zero, one) = (V::zero(), V::one());
        Self {
            active: zero,
            relaxed: zero,
            w1: zero,
            w2: zero,
            t: one,
            nu: one,
            d: one,
            inverse_delta: one,
            inverse_t: one,
            inverse_nu: one,
            dt: zero,
            dnu: zero,
        }
    }
}

/// The arithmetic of one side; `SOFT` tells whether `soft` counts, `UPPER` which side it is.
impl<V: Vector> Side<V> {
    #[inline(always)]
    fn signed<const UPPER: bool>(v: V) -> V {
        if UPPER { -v } else { v }
    }

    /// Inverses, weight and residual at the iterate. Returns `λ + dλ` of the affine step at `dz = 0`.
    #[inline(always)]
    fn linearize<const UPPER: bool, const SOFT: bool>(
        &mut self,
        soft: &mut Softening<V>,
        z: V,
        cap: [V; 2],
        tally: &mut Tally<V>,
    ) -> V {
        let (s, l) = (self.slack, self.multiplier);
        let product = s * l;
        let inverse = V::one() / product;
        self.inverse_slack = l * inverse;
        self.inverse_multiplier = s * inverse;
        self.inverse_damped = self.inverse_slack.fast_min(cap[0] * self.inverse_multiplier);
        self.excess = (l * cap[1] - s).fast_max(V::zero());
        tally.sum = product.mul_add(self.active, tally.sum);
        let gap = Self::signed::<UPPER>(z - self.bound) - s;
        if SOFT {
            soft.linearize(s + self.excess, l, tally);
            self.residual = self.active * soft.t.mul_add(soft.active, gap);
            self.weight = self.active * l * soft.d * soft.inverse_delta;
        } else {
            self.residual = self.active * gap;
            self.weight = self.active * l * self.inverse_damped;
        }
        tally.max = tally.max.fast_max(self.relative * self.residual.abs());
        tally.force = tally.force.fast_max(self.relative * l);
        self.base::<SOFT>(soft)
    }

    /// `λ + dλ` of the affine step at `dz = 0`.
    #[inline(always)]
    fn base<const SOFT: bool>(&self, soft: &Softening<V>) -> V {
        if SOFT {
            let (l, t) = (self.multiplier, soft.active * soft.t);
            return self.active
                * l
                * soft.inverse_delta
                * (t * (l + soft.nu) + soft.d * (self.excess - self.residual));
        }
        self.weight * (self.excess - self.residual)
    }

    /// Steps for a step `dz` of the variable, where `s dλ + λ ds = −rc₁` and `t dν + ν dt = −rc₂`. Each is
    /// written so that small numbers come from products of small numbers, not from differences of large ones:
    /// ν is tiny where a soft bound is violated.
    #[inline(always)]
    fn steps<const UPPER: bool, const SOFT: bool>(&mut self, soft: &mut Softening<V>, dz: V, rc1: V, rc2: V) {
        let (s, l) = (self.slack + self.excess, self.multiplier);
        let rho = self.active * (Self::signed::<UPPER>(dz) + self.residual);
        let pull = l.mul_add(rho, rc1);
        if SOFT {
            let (t, rc2) = (soft.active * soft.t, soft.active * rc2);
            let inverse = self.active * soft.inverse_delta;
            self.dl = (l * rc2 - soft.d * pull) * inverse;
            self.ds = (s * (soft.d * rho - rc2) - t * rc1) * inverse;
            soft.dt = -(rc2 * s + t * pull) * inverse;
            soft.dnu = soft.active * (soft.nu * pull - rc2 * soft.w2.mul_add(s, l)) * inverse;
        } else {
            self.dl = -(self.active * pull * self.inverse_damped);
            self.ds = rho;
        }
    }

    /// Largest `−ds/s`, `−dλ/λ`, `−dt/t`, `−dν/ν`: the inverse of the step to the boundary.
    #[inline(always)]
    fn inverse_step<const SOFT: bool>(&self, soft: &Softening<V>, max: V) -> V {
        let max =
            max.fast_max(-(self.ds * self.inverse_slack)).fast_max(-(self.dl * self.inverse_multiplier));
        if SOFT {
            max.fast_max(-(soft.dt * soft.inverse_t)).fast_max(-(soft.dnu * soft.inverse_nu))
        } else {
            max
        }
    }

    #[inline(always)]
    fn predictor<const UPPER: bool, const SOFT: bool>(
        &mut self,
        soft: &mut Softening<V>,
        dz: V,
        tally: &mut Tally<V>,
    ) {
        self.steps::<UPPER, SOFT>(soft, dz, self.slack * self.multiplier, soft.t * soft.nu);
        tally.max = self.inverse_step::<SOFT>(soft, tally.max);
        tally.sum = self.ds.mul_add(self.dl, tally.sum);
        if SOFT {
            tally.sum = soft.dt.mul_add(soft.dnu, tally.sum);
        }
    }

    /// `λ + dλ` at `dz = 0` with centring and second-order correction.
    #[inline(always)]
    fn centred<const SOFT: bool>(&self, soft: &Softening<V>, target: V, correction: V) -> V {
        let lift = target - correction * self.ds * self.dl;
        if SOFT {
            let soft_lift = soft.active * (target - correction * soft.dt * soft.dnu);
            let lift = soft.d * lift - self.multiplier * soft_lift;
            return self.base::<SOFT>(soft) + self.active * soft.inverse_delta * lift;
        }
        self.base::<SOFT>(soft) + self.active * self.inverse_damped * lift
    }

    #[inline(always)]
    fn corrector<const UPPER: bool, const SOFT: bool>(
        &mut self,
        soft: &mut Softening<V>,
        dz: V,
        target: [V; 2],
        tally: &mut Tally<V>,
    ) {
        let [target, correction] = target;
        let rc1 = self.slack * self.multiplier - target + correction * self.ds * self.dl;
        let rc2 = soft.t * soft.nu - target + correction * soft.dt * soft.dnu;
        self.steps::<UPPER, SOFT>(soft, dz, rc1, rc2);
        tally.max = self.inverse_step::<SOFT>(soft, tally.max);
    }

    #[inline(always)]
    fn start<const SOFT: bool>(&mut self, soft: &mut Softening<V>, [gap, least]: [V; 2], mu: V, far: bool) {
        let inert = V::one() - self.active;
        let mut slack = gap.fast_max(least);
        let mut multiplier = mu / slack;
        if SOFT && far {
            let hard = V::one() - soft.active;
            soft.t = soft.active * (least - gap).fast_max(least) + hard;
            slack = soft.active * (gap + soft.t) + hard * slack;
            multiplier = mu / slack;
            multiplier = soft.active * multiplier.fast_min(V::splat(0.5) * soft.w1) + hard * multiplier;
            soft.nu = soft.active * (soft.w1 + soft.w2 * soft.t - multiplier) + hard;
        } else if SOFT {
            let violation = (-gap).fast_max(V::zero());
            let limit = V::splat(0.5) * soft.w2.mul_add(violation, soft.w1);
            multiplier = soft.active * multiplier.fast_min(limit) + (V::one() - soft.active) * multiplier;
            soft.start(multiplier, mu);
        }
        self.slack = self.active * slack + inert;
        self.multiplier = self.active * multiplier + inert;
    }

    #[inline(always)]
    fn advance<const SOFT: bool>(&mut self, soft: &mut Softening<V>, length: V) {
        self.slack = self.ds.mul_add(length, self.slack);
        self.multiplier = self.dl.mul_add(length, self.multiplier);
        if SOFT {
            soft.t = soft.dt.mul_add(length, soft.t);
            soft.nu = soft.dnu.mul_add(length, soft.nu);
        }
    }
}

impl<V: Vector> Softening<V> {
    /// `φ(v) + φ*(λ) + λ d` with `φ*(λ) = max(λ − w₁, 0)²/2w₂`; where w₂ = 0, λ exceeds w₁ by rounding alone.
    #[inline(always)]
    fn gap(&self, l: V, d: V) -> V {
        let (half, v) = (V::splat(0.5), (-d).fast_max(V::zero()));
        let beyond = (l - self.w1).fast_max(V::zero());
        let inverse = self.w2 / (self.w2 * self.w2).fast_max(V::splat(f64::MIN_POSITIVE));
        let penalty = v * (self.w1 - l + half * self.w2 * v);
        penalty + l * d.fast_max(V::zero()) + half * beyond * beyond * inverse
    }

    /// `t` and `ν = w₁ + w₂ t − λ` with the product μ, as all other pairs have it: a `t` as large as the
    /// violation would be far off the central path where the bound will be kept in the end.
    #[inline(always)]
    fn start(&mut self, l: V, mu: V) {
        let (beyond, hard) = (l - self.w1, V::one() - self.active);
        let two = V::splat(2.0);
        let root = (beyond * beyond + V::splat(4.0) * self.w2 * mu).sqrt();
        // Of the two forms of the root the one without cancellation; the first one divides by zero only where
        // it is not taken.
        let positive = (beyond + root) / (two * self.w2.fast_max(V::splat(f64::MIN_POSITIVE)));
        let negative = two * mu / (root - beyond).fast_max(V::splat(f64::MIN_POSITIVE));
        let t = V::select_positive(beyond, positive, negative);
        self.t = V::select_positive(self.active, t, hard);
        self.nu = self.active * (self.w2.mul_add(self.t, self.w1) - l) + hard;
    }

    /// Inverses at the iterate.
    #[inline(always)]
    fn linearize(&mut self, s: V, l: V, tally: &mut Tally<V>) {
        let product = self.t * self.nu;
        let inverse = V::one() / product;
        self.inverse_t = self.nu * inverse;
        self.inverse_nu = self.t * inverse;
        tally.sum = product.mul_add(self.active, tally.sum);
        self.d = self.active * self.w2.mul_add(self.t, self.nu) + (V::one() - self.active);
        self.inverse_delta = V::one() / (self.d * s + self.active * self.t * l);
    }
}

/// All bounds of one kind of variable (inputs, or states), and the passes of an interior-point iteration over
/// them.
#[derive(Debug, Clone)]
pub(super) struct Bounds<V> {
    sides: Vec<[Side<V>; 2]>,
    soft: Vec<[Softening<V>; 2]>,
    /// `W_max` and its inverse.
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

    /// Forgets bounds, slacks and multipliers.
    pub(super) fn forget(&mut self) {
        self.sides.fill(Default::default());
        self.soft.fill(Default::default());
    }

    /// Largest diagonal term of the Newton system. Beyond it, digits of the weights would be lost beside it
    /// (`R` beside `BᵀWB`); a step that takes the slack for `λ/W_max` instead is still a Newton step to
    /// second order, since `dλ` vanishes at the optimum.
    #[inline(always)]
    pub(super) fn cap_weights(&mut self, cap: f64) {
        self.cap = [V::splat(cap), V::splat(1.0 / cap)];
    }

    /// [`Self::linearize_as`], with soft bounds or without.
    #[inline(always)]
    pub(super) fn linearize(
        &mut self,
        soft: bool,
        z: &[V],
        gradient: &[V],
        weight: &mut [V],
        rhs: &mut [V],
    ) -> Tally<V> {
        if soft {
            self.linearize_as::<true>(z, gradient, weight, rhs)
        } else {
            self.linearize_as::<false>(z, gradient, weight, rhs)
        }
    }

    /// [`Self::predictor_as`], likewise.
    #[inline(always)]
    pub(super) fn predictor(&mut self, soft: bool, dz: &[V]) -> Tally<V> {
        if soft { self.predictor_as::<true>(dz) } else { self.predictor_as::<false>(dz) }
    }

    /// [`Self::centre_as`], likewise.
    #[inline(always)]
    pub(super) fn centre(&mut self, soft: bool, gradient: &[V], target: f64, correction: f64, rhs: &mut [V]) {
        if soft {
            self.centre_as::<true>(gradient, target, correction, rhs);
        } else {
            self.centre_as::<false>(gradient, target, correction, rhs);
        }
    }

    /// [`Self::corrector_as`], likewise.
    #[inline(always)]
    pub(super) fn corrector(&mut self, soft: bool, dz: &[V], target: f64, correction: f64) -> Tally<V> {
        if soft {
            self.corrector_as::<true>(dz, target, correction)
        } else {
            self.corrector_as::<false>(dz, target, correction)
        }
    }

    /// [`Self::advance_as`], likewise.
    #[inline(always)]
    pub(super) fn advance(&mut self, soft: bool, length: f64) {
        if soft {
            self.advance_as::<true>(length);
        } else {
            self.advance_as::<false>(length);
        }
    }

    /// [`Self::start_as`], likewise.
    #[inline(always)]
    pub(super) fn start(&mut self, soft: bool, z: &[V], mu: f64, share: f64, far: bool) {
        if soft {
            self.start_as::<true>(z, mu, share, far);
        } else {
            self.start_as::<false>(z, mu, share, far);
        }
    }

    /// [`Self::remember_as`], likewise.
    #[inline(always)]
    pub(super) fn remember(&mut self, soft: bool, last: &Multipliers<V>, mu: f64) {
        if soft {
            self.remember_as::<true>(last, mu);
        } else {
            self.remember_as::<false>(last, mu);
        }
    }

    /// First pass: `weight` becomes the diagonal barrier term, `rhs` the gradient of the affine step. Returns
    /// `Σ sλ` and `max |r|`.
    #[inline(always)]
    fn linearize_as<const SOFT: bool>(
        &mut self,
        z: &[V],
        gradient: &[V],
        weight: &mut [V],
        rhs: &mut [V],
    ) -> Tally<V> {
        let mut tally = Tally::new();
        let cap = self.cap;
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            let from_below = lower.linearize::<false, SOFT>(soft_lower, z[i], cap, &mut tally);
            let pull = from_below - upper.linearize::<true, SOFT>(soft_upper, z[i], cap, &mut tally);
            weight[i] = lower.weight + upper.weight;
            rhs[i] = gradient[i] - pull;
        }
        tally
    }

    /// Second pass: affine steps. Returns `Σ ds dλ` and the inverse step to the boundary.
    #[inline(always)]
    fn predictor_as<const SOFT: bool>(&mut self, dz: &[V]) -> Tally<V> {
        let mut tally = Tally::new();
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            lower.predictor::<false, SOFT>(soft_lower, dz[i], &mut tally);
            upper.predictor::<true, SOFT>(soft_upper, dz[i], &mut tally);
        }
        tally
    }

    /// Third pass: `rhs` becomes the gradient of the centred and corrected step.
    #[inline(always)]
    fn centre_as<const SOFT: bool>(&mut self, gradient: &[V], target: f64, correction: f64, rhs: &mut [V]) {
        let (target, correction) = (V::splat(target), V::splat(correction));
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            rhs[i] = gradient[i] - lower.centred::<SOFT>(soft_lower, target, correction)
                + upper.centred::<SOFT>(soft_upper, target, correction);
        }
    }

    /// Fourth pass: the steps proper. Returns the inverse step to the boundary.
    #[inline(always)]
    fn corrector_as<const SOFT: bool>(&mut self, dz: &[V], target: f64, correction: f64) -> Tally<V> {
        let mut tally = Tally::new();
        let target = [V::splat(target), V::splat(correction)];
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            lower.corrector::<false, SOFT>(soft_lower, dz[i], target, &mut tally);
            upper.corrector::<true, SOFT>(soft_upper, dz[i], target, &mut tally);
        }
        tally
    }

    /// Fifth pass: the step is taken.
    #[inline(always)]
    fn advance_as<const SOFT: bool>(&mut self, length: f64) {
        let length = V::splat(length);
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            lower.advance::<SOFT>(soft_lower, length);
            upper.advance::<SOFT>(soft_upper, length);
        }
    }

    /// Bounds of number `i` of the padded variables, made inert where infinite, and the penalty weights
    /// `(w₁, w₂)` if it is soft.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, lower: f64, upper: f64, penalty: Option<(f64, f64)>) {
        let (lane, i) = (i / WIDTH, i % WIDTH);
        for (side, bound) in [(0, lower), (1, upper)] {
            let finite = bound.is_finite();
            let active = f64::from(u8::from(finite));
            let bound = if finite { bound } else { 0.0 };
            let s = &mut self.sides[lane][side];
            set_number(&mut s.bound, i, bound);
            set_number(&mut s.active, i, active);
            set_number(&mut s.relative, i, active / bound.abs().max(1.0));
            if let Some((w1, w2)) = penalty {
                let soft = &mut self.soft[lane][side];
                set_number(&mut soft.active, i, active);
                set_number(&mut soft.w1, i, w1);
                set_number(&mut soft.w2, i, w2);
            }
        }
    }

    /// Forgets all softening, before the bounds of a new problem are set.
    #[inline(always)]
    pub(super) fn harden(&mut self) {
        self.soft.fill([Softening::default(); 2]);
    }

    /// Gives every bound that is still hard the penalty `linear · v`.
    #[inline(always)]
    pub(super) fn soften(&mut self, linear: f64) {
        for (sides, soft) in self.sides.iter().zip(&mut self.soft) {
            for (side, soft) in sides.iter().zip(soft) {
                let hard = side.active * (V::one() - soft.active);
                soft.w1 = (V::one() - hard) * soft.w1 + hard * V::splat(linear);
                soft.active = side.active;
                soft.relaxed = hard;
            }
        }
    }

    /// Number of complementarity pairs.
    #[inline(always)]
    pub(super) fn count(&self) -> f64 {
        let mut sum = V::zero();
        for (sides, soft) in self.sides.iter().zip(&self.soft) {
            for side in 0..2 {
                sum += sides[side].active + soft[side].active;
            }
        }
        sum.reduce_add()
    }

    /// Adds a quadratic cost of `size` per distance between the bounds, from their middle; from 1 + |b|
    /// inside a bound that has no other side.
    #[inline(always)]
    pub(super) fn attract(&self, size: f64, weight: &mut [V], linear: &mut [V]) {
        let (half, one) = (V::splat(0.5), V::one());
        for (i, [lower, upper]) in self.sides.iter().enumerate() {
            let both = lower.active * upper.active;
            let (of_lower, of_upper) = (lower.active - both, upper.active - both);
            let (l, u) = (lower.bound, upper.bound);
            let width = both * (u - l) + of_lower * (one + l.abs()) + of_upper * (one + u.abs());
            let middle = both * half * (l + u) + of_lower * (l + width) + of_upper * (u - width);
            let any = both + of_lower + of_upper;
            let width = width.fast_max(V::splat(MIN_WIDTH));
            let w = any * V::splat(size) / (width * width);
            weight[i] += w;
            linear[i] = w.mul_neg_add(middle, linear[i]);
        }
    }

    /// Raises slacks (and softenings) whose product with their multiplier is below `least`: they would block
    /// every step. The residual takes it up.
    #[inline(always)]
    pub(super) fn recentre(&mut self, least: f64) {
        let least = V::splat(least);
        for (sides, softs) in self.sides.iter_mut().zip(&mut self.soft) {
            for (side, soft) in sides.iter_mut().zip(softs) {
                let slack = side.slack.fast_max(least / side.multiplier);
                side.slack = V::select_positive(side.active, slack, side.slack);
                let t = soft.t.fast_max(least / soft.nu);
                let t = V::select_positive(soft.active, t, soft.t);
                soft.nu = soft.w2.mul_add(t - soft.t, soft.nu);
                soft.t = t;
            }
        }
    }

    /// Raises slacks to several times the residual that moving the variables to `z` leaves: smaller ones
    /// would block every step.
    #[inline(always)]
    pub(super) fn loosen(&mut self, z: &[V]) {
        let several = V::splat(10.0);
        for ((sides, softs), z) in self.sides.iter_mut().zip(&self.soft).zip(z) {
            let distances = [*z - sides[0].bound, sides[1].bound - *z];
            for ((side, soft), d) in sides.iter_mut().zip(softs).zip(distances) {
                let residual = soft.active.mul_add(soft.t, d) - side.slack;
                let least = side.active * several * residual.abs();
                side.slack = side.slack.fast_max(least);
            }
        }
    }

    /// Largest violation of a bound by `z`, beside the size of the bound where that exceeds 1; of the hard
    /// bounds alone if `hard`; 0 if all are kept.
    #[inline(always)]
    pub(super) fn violation(&self, z: &[V], hard: bool) -> f64 {
        let mut max = V::zero();
        for (i, ([lower, upper], z)) in self.sides.iter().zip(z).enumerate() {
            let mut excess = [lower.relative * (lower.bound - *z), upper.relative * (*z - upper.bound)];
            if hard {
                for (excess, soft) in excess.iter_mut().zip(&self.soft[i]) {
                    *excess = (V::one() - soft.active + soft.relaxed) * *excess;
                }
            }
            max = max.fast_max(excess[0]).fast_max(excess[1]);
        }
        largest(max)
    }

    /// Projects `z` onto the bounds. Exact: what is returned equals a bound or the number given.
    #[inline(always)]
    pub(super) fn clip(&self, z: &mut [V]) {
        for ([lower, upper], z) in self.sides.iter().zip(z) {
            *z = lower.active * z.fast_max(lower.bound) + (V::one() - lower.active) * *z;
            *z = upper.active * z.fast_min(upper.bound) + (V::one() - upper.active) * *z;
        }
    }

    /// Cost of the violation of soft bounds by `z`; of those that were hard too if `relaxed`.
    #[inline(always)]
    pub(super) fn penalty(&self, z: &[V], relaxed: bool) -> f64 {
        let less = V::splat(f64::from(u8::from(!relaxed)));
        let mut sum = V::zero();
        for (([lower, upper], soft), z) in self.sides.iter().zip(&self.soft).zip(z) {
            for (soft, excess) in soft.iter().zip([lower.bound - *z, *z - upper.bound]) {
                let v = (soft.active - less * soft.relaxed) * excess.fast_max(V::zero());
                sum += v * (soft.w1 + soft.w2 * v * V::splat(0.5));
            }
        }
        sum.reduce_add()
    }

    /// Duality gap of the bounds at `z` with given multipliers, term by term what Fenchel's inequality
    /// leaves: `φ(v) + φ*(λ) + λ d ≥ 0` for the distance `d` into the bound, its violation `v = max(−d, 0)`
    /// and the penalty φ; `|λ d|` where the bound is hard, so that a violation counts too.
    #[inline(always)]
    pub(super) fn gap(&self, z: &[V], multipliers: &Multipliers<V>) -> f64 {
        let mut sum = V::zero();
        for (i, z) in z.iter().enumerate() {
            let [lower, upper] = &self.sides[i];
            let distances = [*z - lower.bound, upper.bound - *z];
            for (side, d) in distances.into_iter().enumerate() {
                let soft = &self.soft[i][side];
                let (active, l) = (self.sides[i][side].active, multipliers.0[i][side]);
                let rounding = V::splat(ROUNDING) * self.sides[i][side].bound.abs().fast_max(V::one());
                let hard = l.abs() * (d.abs() - rounding).fast_max(V::zero());
                sum += active * (soft.active * soft.gap(l, d) + (V::one() - soft.active) * hard);
            }
        }
        sum.reduce_add()
    }

    /// The point to start from: slacks as the variables `z` have them but at least `share` of the distance
    /// between the bounds (of 1 + |z| for a one-sided bound), multipliers `μ/s`.
    #[inline(always)]
    fn start_as<const SOFT: bool>(&mut self, z: &[V], mu: f64, share: f64, far: bool) {
        let mu = V::splat(mu);
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            let both = lower.active * upper.active;
            let width = both * (upper.bound - lower.bound) + (V::one() - both) * (V::one() + z[i].abs());
            let least = width.fast_max(V::splat(MIN_WIDTH)) * V::splat(share);
            let (below, above) = (z[i] - lower.bound, upper.bound - z[i]);
            // Between bounds that are close to each other beside their violation, slacks by their distance
            // alone would be far too small.
            let least = least.fast_max(V::splat(VIOLATION_SHARE) * (-below.fast_min(above)));
            lower.start::<SOFT>(soft_lower, [below, least], mu, far);
            upper.start::<SOFT>(soft_upper, [above, least], mu, far);
        }
    }

    /// Raises the multipliers of a start to what they were at the last solution.
    #[inline(always)]
    fn remember_as<const SOFT: bool>(&mut self, last: &Multipliers<V>, mu: f64) {
        let mu = V::splat(mu);
        for i in 0..self.sides.len() {
            let (sides, softs) = (&mut self.sides[i], &mut self.soft[i]);
            for ((bound, soft), kept) in sides.iter_mut().zip(softs).zip(last.0[i]) {
                let mut multiplier = bound.multiplier.fast_max(kept);
                if SOFT {
                    let hard = V::one() - soft.active;
                    multiplier =
                        soft.active * multiplier.fast_min(V::splat(0.9) * soft.w1) + hard * multiplier;
                    soft.start(multiplier, mu);
                }
                bound.multiplier = bound.active * multiplier + (V::one() - bound.active);
            }
        }
    }

    /// Multipliers of all bounds, zero for inert ones.
    #[inline(always)]
    pub(super) fn multipliers(&self, out: &mut Multipliers<V>) {
        for (out, sides) in out.0.iter_mut().zip(&self.sides) {
            for side in 0..2 {
                out[side] = sides[side].active * sides[side].multiplier;
            }
        }
    }
}

/// Writes one number of a lane.
#[inline(always)]
fn set_number<V: Vector>(lane: &mut V, i: usize, value: f64) {
    flat_mut(core::slice::from_mut(lane))[i] = value;
}
