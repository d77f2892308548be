//! Learned friction law of a joint, as a difference from the described law.

pub(super) use gelenk_kernels::math::sqrt as root;

/// Number of terms of the learned law, see [`terms`].
pub const TERMS: usize = 5;

/// Names of the terms, in the order of [`terms`]. The nested laws have the first 0, 1, … of them.
pub const TERM_NAMES: [&str; TERMS] = ["shape", "viscous", "offset", "asymmetry", "load"];

/// Returns the values s(v), v, 1, |s(v)| and |τ_l| s₁ of the five terms of the learned law τ at velocity `v` [rad/s or m/s]:
///
/// ```text
///     τ(v) = τ_d(v) + |τ_l| s₁(v) + δ₁ s(v) + δ₂ v + δ₃ + δ₄ |s(v)| + δ₅ |τ_l| s₁(v)
/// ```
///
/// - τ_d: described friction without its load-dependent part
/// - |τ_l| s₁: described load-dependent friction. The load τ_l is the force of the drive without all friction, and s₁ is the
///   friction per unit of load.
/// - s: shape of the friction ([`JointScale::shape`]). It is τ_d, or smooth Coulomb friction if τ_d is zero.
/// - δ₁ … δ₅: learned coefficients
///
/// The first term scales the shape. The fourth term makes friction depend on the direction of motion. The fifth term scales the
/// load-dependent friction.
///
/// - `shape`: value s(v) of [`JointScale::shape`] [N m or N]
/// - `load`: described load-dependent friction |τ_l| s₁ [N m or N]
#[inline]
#[must_use]
pub fn terms(shape: f64, v: f64, load: f64) -> [f64; TERMS] {
    [shape, v, 1.0, shape.abs(), load]
}

/// Magnitudes of the friction of a joint, from which the bounds and the prior of the learned coefficients δ ([`terms`]) follow.
/// [`Magnitudes::scale`](super::Magnitudes::scale) computes them from the description of the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointScale {
    /// Described friction at the largest speed [N m or N]; a tenth of the largest effort for a joint without described
    /// friction.
    pub torque: f64,
    /// Largest speed of the joint [rad/s or m/s].
    pub speed: f64,
    /// Smallest ratio `|s(v)|/|v|` of the shape s of the friction at speeds |v| up to twice the largest speed
    /// [N m s/rad or N s/m].
    pub least_slope: f64,
    /// Width of the range of positions [rad or m]. It is divided into cells to detect torque ripple.
    pub range: f64,
    /// Whether the shape of the learned friction is the described friction. False if the described friction
    /// is zero.
    pub is_described: bool,
    /// Whether the joint has described load-dependent friction, as [`Adaptation::new`](super::Adaptation::new) finds. If it does
    /// not, its coefficient δ₅ is zero.
    pub is_loaded: bool,
    /// Additional bounds of the magnitudes of the coefficients δ ([`Adaptation::set_bounds`](super::Adaptation::set_bounds));
    /// infinite if there are none.
    pub most: [f64; TERMS],
}

impl JointScale {
    /// Returns the shape s(v) of the friction \[N m or N\], which is used in [`terms`]. It is the described friction, or smooth
    /// Coulomb friction `torque · x/√(1 + x²)` with `x = v/rest` if friction is not described.
    ///
    /// - `described`: described friction at velocity `v` [N m or N]
    /// - `rest`: speed below which the joint counts as at rest [rad/s or m/s]
    #[inline]
    #[must_use]
    pub fn shape(&self, described: f64, v: f64, rest: f64) -> f64 {
        if self.is_described { described } else { self.torque * smooth_sign(v / rest) }
    }

    /// Returns the largest magnitude of each coefficient δ ([`terms`]).
    ///
    /// - `change`: largest change of friction, as a share of the friction at the largest speed
    #[must_use]
    pub fn bounds(&self, change: f64) -> [f64; TERMS] {
        let of_load = if self.is_loaded { change } else { 0.0 };
        let usual = [change, change * self.torque / self.speed, change * self.torque, 0.5 * change, of_load];
        core::array::from_fn(|k| usual[k].min(self.most[k]))
    }

    /// Clamps the coefficients δ ([`terms`]) so that they are within ±`bounds`, and the friction dissipates energy at every
    /// velocity.
    ///
    /// Let β be 1 if friction is described, otherwise 0. The power of the friction τ without offset and load-dependent friction
    /// is
    ///
    /// ```text
    ///     v τ(v) = |v| (|s| (β + δ₁ ± δ₄) + δ₂ |v|) ≥ v² (b (β + δ₁ − |δ₄|) + δ₂)       b = min |s|/|v|
    /// ```
    ///
    /// with the shape s, because v s ≥ 0. Therefore `δ₁ ≥ −β`, `|δ₄| ≤ β + δ₁` and `δ₂ ≥ −b (β + δ₁ − |δ₄|)` are sufficient.
    /// The conditions are also necessary if b is attained at a velocity. Load-dependent friction dissipates if δ₅ ≥ −1. The
    /// conditions are applied in this order, and each depends continuously on δ.
    #[must_use]
    pub fn admissible(&self, mut delta: [f64; TERMS], bounds: &[f64; TERMS]) -> [f64; TERMS] {
        for (delta, bound) in delta.iter_mut().zip(bounds) {
            *delta = delta.clamp(-bound, *bound);
        }
        let base = if self.is_described { 1.0 } else { 0.0 };
        delta[0] = delta[0].max(-base);
        let factor = base + delta[0];
        delta[3] = delta[3].clamp(-factor, factor);
        delta[1] = delta[1].max(-self.least_slope * (factor - delta[3].abs()));
        delta[4] = delta[4].max(-1.0);
        delta
    }
}

/// Smooth sign `x/√(1 + x²)`. The result does not depend on the mathematical library of the platform.
#[inline]
pub(super) fn smooth_sign(x: f64) -> f64 {
    x / root(1.0 + x * x)
}

#[inline]
pub(super) fn dot<const K: usize>(a: &[f64; K], b: &[f64; K]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Product `C x` of a matrix C and a vector x.
#[inline]
pub(super) fn product<const K: usize>(c: &[[f64; K]; K], x: &[f64; K]) -> [f64; K] {
    core::array::from_fn(|i| dot(&c[i], x))
}
