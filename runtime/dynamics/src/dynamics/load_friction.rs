//! Load-dependent friction `|τ_l| s₁`, in addition to the velocity-dependent friction s₀.
//!
//! The load τ_l of a joint is the force of its drive minus all friction, and s₁ is the friction per unit of the load. The force
//! of the drive is `s₀ + τ_l + |τ_l| s₁` (Hamon, Gautier and Garrec 2010). If |s₁| < 1, this force increases with the load.

/// Returns the load-dependent friction `|τ_l| s₁` [N m or N].
///
/// - `load`: load τ_l, the force of the drive minus all friction [N m or N]
/// - `share`: friction s₁ per unit of load
#[must_use]
pub fn under_load(load: f64, share: f64) -> f64 {
    if share == 0.0 { 0.0 } else { load.abs() * share }
}

/// Returns the load `τ_l = w / (1 + s₁ sign w)` of a joint [N m or N]. This is the unique solution of `w = τ_l + |τ_l| s₁` if
/// |s₁| < 1. Otherwise the result is NaN.
///
/// - `exerted`: force of the drive minus the friction s₀ that does not depend on the load; this difference is w [N m or N]
/// - `share`: friction s₁ per unit of load
#[must_use]
pub fn load(exerted: f64, share: f64) -> f64 {
    if share == 0.0 {
        return exerted;
    }
    if share.abs() >= 1.0 {
        return f64::NAN;
    }
    let sign = if exerted < 0.0 { -1.0 } else { 1.0 };
    exerted / (1.0 + share * sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_are_solved_for() {
        for share in [-0.9, -0.2, 0.0, 0.3, 0.99] {
            for expected in [-7.0, -0.1, 0.0, 0.2, 40.0] {
                let exerted = expected + under_load(expected, share);
                let found = load(exerted, share);
                assert!(
                    (found - expected).abs() <= 1e-14 * expected.abs(),
                    "{share}: {found} is not {expected}"
                );
            }
        }
        assert!(load(1.0, 1.0).is_nan() && load(1.0, -1.5).is_nan() && load(1.0, f64::NAN).is_nan());
    }
}
