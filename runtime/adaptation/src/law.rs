//! Learned law of a joint: its difference from the described law.

pub(super) use gelenk_kernels::math::sqrt as root;

/// Number of terms.
pub const TERMS: usize = 5;

/// Names of the terms in the order of the nested laws.
pub const TERM_NAMES: [&str; TERMS] = ["shape", "viscous", "offset", "asymmetry", "load"];

/// Values of the five terms at velocity `v`.
///
/// ```text
///     τ(v) = τ_d(v) + |τ_l| s₁(v) + δ₁ s(v) + δ₂ v + δ₃ + δ₄ |s(v)| + δ₅ |τ_l| s₁(v)
/// ```
///
/// The first term scales the shape s, and the fourth makes it depend on the direction. s is the described friction τ_d, or smooth
/// Coulomb friction if τ_d is zero ([`JointScale::shape`]). The fifth scales the described load-dependent friction.
///
/// - `shape`: s at this velocity
/// - `load`: described load-dependent friction |τ_l| s₁ [N m or N]
#[inline]
#[must_use]
pub fn terms(shape: f64, v: f64, load: f64) -> [f64; TERMS] {
    [shape, v, 1.0, shape.abs(), load]
}

/// Magnitudes of a joint from the description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointScale {
    /// Friction at the largest speed [N m or N].
    pub torque: f64,
    /// Largest speed [rad/s or m/s].
    pub speed: f64,
    /// Smallest ratio `|s(v)|/|v|` up to twice the largest speed [N m s/rad or N s/m].
    pub least_slope: f64,
    /// Width of the range of positions that is divided into cells [rad or m].
    pub range: f64,
    /// Whether the shape s is the described friction τ_d. It is not if τ_d is zero.
    pub is_described: bool,
    /// Whether the joint has described load-dependent friction. Without it, δ₅ is zero.
    pub is_loaded: bool,
    /// Further bounds of the magnitudes of δ, see [`Adaptation::set_bounds`](super::Adaptation::set_bounds).
    pub most: [f64; TERMS],
}

impl JointScale {
    /// s(v) of [`terms`]: the described friction, or Coulomb friction `torque · x/√(1 + x²)` with `x = v/rest`.
    #[inline]
    #[must_use]
    pub fn shape(&self, described: f64, v: f64, rest: f64) -> f64 {
        if self.is_described { described } else { self.torque * smooth_sign(v / rest) }
    }

    /// Largest magnitude of each δ if friction may change by the share `change` of the described friction.
    #[must_use]
    pub fn bounds(&self, change: f64) -> [f64; TERMS] {
        let of_load = if self.is_loaded { change } else { 0.0 };
        let usual = [change, change * self.torque / self.speed, change * self.torque, 0.5 * change, of_load];
        core::array::from_fn(|k| usual[k].min(self.most[k]))
    }

    /// The nearest δ, term by term, that is within ±`bounds` and whose friction dissipates at every velocity.
    ///
    /// With β = 1 if friction is described and 0 otherwise, friction without offset and load has the power
    ///
    /// ```text
    ///     v τ(v) = |v| (|s| (β + δ₁ ± δ₄) + δ₂ |v|) ≥ v² (b (β + δ₁ − |δ₄|) + δ₂)       b = min |s|/|v|
    /// ```
    ///
    /// since v s ≥ 0. Therefore `δ₁ ≥ −β`, `|δ₄| ≤ β + δ₁` and `δ₂ ≥ −b (β + δ₁ − |δ₄|)` are sufficient, and
    /// also necessary if b is attained. Load-dependent friction dissipates if δ₅ ≥ −1. The bounds are applied in sequence; each is a
    /// continuous function of δ.
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

/// `x/√(1 + x²)`: odd and increasing with limits ±1; uses no functions of a platform's library.
#[inline]
pub(super) fn smooth_sign(x: f64) -> f64 {
    x / root(1.0 + x * x)
}

#[inline]
pub(super) fn dot<const K: usize>(a: &[f64; K], b: &[f64; K]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `C x`.
#[inline]
pub(super) fn product<const K: usize>(c: &[[f64; K]; K], x: &[f64; K]) -> [f64; K] {
    core::array::from_fn(|i| dot(&c[i], x))
}
