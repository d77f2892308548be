//! Lower or upper side of four bounds: slacks, multipliers, softenings, and their steps.

use super::super::lanes::{Vector, largest};

/// Lower or upper side of four bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side<V> {
    /// Bound; 0 if the bound is infinite.
    pub(super) bound: V,
    /// 1 for a finite bound, 0 for an infinite bound. Slack and multiplier of an infinite bound remain 1.
    pub(super) active: V,
    /// `1/max(1, |bound|)` for a finite bound, 0 for an infinite bound. This factor makes violations relative to the size
    /// of the bound.
    pub(super) relative: V,
    pub(super) slack: V,
    pub(super) multiplier: V,
    /// Primal residual of the bound, at the variable and its slack.
    residual: V,
    /// Diagonal term of the Newton system.
    pub(super) weight: V,
    /// Inverse of the slack at the present iterate.
    inverse_slack: V,
    /// Inverse of the multiplier at the present iterate.
    inverse_multiplier: V,
    /// Inverse `1/s̃` of the slack `s̃ = max(s, λ/W_max)` of the Newton system. s is the slack, λ its
    /// multiplier, and W_max the largest diagonal term.
    inverse_damped: V,
    /// Difference between the slack of the Newton system and the slack.
    excess: V,
    /// Step of the slack. After the predictor it is the affine step.
    ds: V,
    /// Step of the multiplier. After the predictor it is the affine step.
    dl: V,
}

/// Additional data of a soft bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Softening<V> {
    /// 1 if the bound is soft, 0 if it is hard.
    pub(super) active: V,
    /// 1 if the bound is hard but was softened by [`super::Bounds::soften`].
    pub(super) relaxed: V,
    pub(super) w1: V,
    pub(super) w2: V,
    pub(super) t: V,
    pub(super) nu: V,
    /// `D = ν + w₂ t` with the softening t, its multiplier ν and the quadratic penalty w₂.
    d: V,
    /// Inverse of `Δ = D s + t λ` with `D = ν + w₂ t`, the softening t, its multiplier ν, the quadratic
    /// penalty w₂, the slack s and its multiplier λ.
    inverse_delta: V,
    inverse_t: V,
    inverse_nu: V,
    dt: V,
    dnu: V,
}

/// Sums and maxima over the bounds, one for each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tally<V> {
    sum: V,
    max: V,
    force: V,
}

/// Sums and maxima of a [`Tally`] over all lanes.
#[derive(Debug, Clone, Copy)]
pub(in crate::qp) struct Totals {
    pub(in crate::qp) sum: f64,
    pub(in crate::qp) max: f64,
    pub(in crate::qp) force: f64,
}

impl<V: Vector> Tally<V> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { sum: V::zero(), max: V::zero(), force: V::zero() }
    }
    #[inline(always)]
    pub(super) fn totals(&self) -> Totals {
        Totals { sum: self.sum.reduce_add(), max: largest(self.max), force: largest(self.force) }
    }
}

impl<V: Vector> Default for Side<V> {
    /// An infinite bound. Slack and multiplier are 1 to keep the arithmetic finite.
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
    /// A hard bound. The softening and its multiplier are 1 to keep the arithmetic finite.
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

/// Arithmetic of one side. `SOFT` is true if `soft` is used, `UPPER` is true for upper bounds.
impl<V: Vector> Side<V> {
    #[inline(always)]
    fn signed<const UPPER: bool>(v: V) -> V {
        if UPPER { -v } else { v }
    }

    /// Computes inverses, weight and residual at the iterate. Returns the multiplier plus its affine step, `λ
    /// + dλ`, if the variable does not change.
    #[inline(always)]
    pub(super) fn linearize<const UPPER: bool, const SOFT: bool>(
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

    /// The multiplier plus its affine step, `λ + dλ`, if the variable does not change.
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

    /// Computes the steps of slack s, multiplier λ, softening t and its multiplier ν for a step `dz` of the
    /// variable, with `s dλ + λ ds = −rc₁` and `t dν + ν dt = −rc₂`. The formulas compute small numbers as
    /// products of small numbers, not as differences of large numbers. This is necessary because ν is tiny if
    /// a soft bound is violated.
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

    /// Inverse of the step to the boundary: the largest `−ds/s`, `−dλ/λ`, `−dt/t`, `−dν/ν` of the slack s,
    /// the multiplier λ, the softening t and its multiplier ν.
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
    pub(super) fn predictor<const UPPER: bool, const SOFT: bool>(
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

    /// The multiplier plus its step with centring and second-order correction, `λ + dλ`, if the variable does
    /// not change.
    #[inline(always)]
    pub(super) fn centred<const SOFT: bool>(&self, soft: &Softening<V>, target: V, correction: V) -> V {
        let lift = target - correction * self.ds * self.dl;
        if SOFT {
            let soft_lift = soft.active * (target - correction * soft.dt * soft.dnu);
            let lift = soft.d * lift - self.multiplier * soft_lift;
            return self.base::<SOFT>(soft) + self.active * soft.inverse_delta * lift;
        }
        self.base::<SOFT>(soft) + self.active * self.inverse_damped * lift
    }

    #[inline(always)]
    pub(super) fn corrector<const UPPER: bool, const SOFT: bool>(
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
    pub(super) fn start<const SOFT: bool>(
        &mut self,
        soft: &mut Softening<V>,
        [gap, least]: [V; 2],
        mu: V,
        far: bool,
    ) {
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
    pub(super) fn advance<const SOFT: bool>(&mut self, soft: &mut Softening<V>, length: V) {
        self.slack = self.ds.mul_add(length, self.slack);
        self.multiplier = self.dl.mul_add(length, self.multiplier);
        if SOFT {
            soft.t = soft.dt.mul_add(length, soft.t);
            soft.nu = soft.dnu.mul_add(length, soft.nu);
        }
    }
}

impl<V: Vector> Softening<V> {
    /// Gap `φ(v) + φ*(λ) + λ d` of a soft bound with the penalty φ, the violation v, the multiplier λ and the
    /// distance d into the bound. `φ*(λ) = max(λ − w₁, 0)²/2w₂` with the linear and quadratic penalty w₁ and
    /// w₂. If w₂ = 0, λ exceeds w₁ only by rounding.
    #[inline(always)]
    pub(super) fn gap(&self, l: V, d: V) -> V {
        let (half, v) = (V::splat(0.5), (-d).fast_max(V::zero()));
        let beyond = (l - self.w1).fast_max(V::zero());
        let inverse = self.w2 / (self.w2 * self.w2).fast_max(V::splat(f64::MIN_POSITIVE));
        let penalty = v * (self.w1 - l + half * self.w2 * v);
        penalty + l * d.fast_max(V::zero()) + half * beyond * beyond * inverse
    }

    /// Sets the softening `t` and its multiplier `ν = w₁ + w₂ t − λ` so that their product is μ, like the
    /// products of all other pairs. w₁ and w₂ are the penalties and λ is the multiplier of the bound. If `t`
    /// were equal to the violation, the start would be far off the central path for bounds that the solution
    /// keeps.
    #[inline(always)]
    pub(super) fn start(&mut self, l: V, mu: V) {
        let (beyond, hard) = (l - self.w1, V::one() - self.active);
        let two = V::splat(2.0);
        let root = (beyond * beyond + V::splat(4.0) * self.w2 * mu).sqrt();
        // The form of the root without cancellation is selected. The first form can only divide by zero if the second
        // form is selected.
        let positive = (beyond + root) / (two * self.w2.fast_max(V::splat(f64::MIN_POSITIVE)));
        let negative = two * mu / (root - beyond).fast_max(V::splat(f64::MIN_POSITIVE));
        let t = V::select_positive(beyond, positive, negative);
        self.t = V::select_positive(self.active, t, hard);
        self.nu = self.active * (self.w2.mul_add(self.t, self.w1) - l) + hard;
    }

    /// Computes inverses at the iterate.
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
