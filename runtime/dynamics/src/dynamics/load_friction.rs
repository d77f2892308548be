//! Load-dependent friction `|τ_l| s₁`, in addition to the friction s₀ that depends on the velocity.
//!
//! The load τ_l is the force of a joint's drive without friction. The drive exerts `s₀ + τ_l + |τ_l| s₁`
//! (Hamon, Gautier and Garrec 2010). This force increases with the load if |s₁| < 1.

/// Load-dependent friction `|τ_l| s₁` [N m or N] for the load τ_l and the friction `share` s₁ per unit of
/// load.
#[must_use]
pub fn under_load(load: f64, share: f64) -> f64 {
    if share == 0.0 { 0.0 } else { load.abs() * share }
}

/// Load τ_l of a joint from w, which is the drive's force minus the friction s₀: `τ_l = w / (1 + s₁ sign w)`.
/// This is the unique solution of `w = τ_l + |τ_l| s₁` if |s₁| < 1. Otherwise the result is NaN.
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
