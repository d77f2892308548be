//! Physical parameters of a Stribeck law: Coulomb friction, static friction, Stribeck speed, viscous friction.

use super::law::StribeckFit;
use gelenk_findings::digits::with_error;

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Estimate {
    /// Value of the parameter.
    pub(crate) value: f64,
    /// Standard error of the value; `None` if the data do not determine it.
    pub(crate) standard_error: Option<f64>,
}

/// Physical parameters of a Stribeck law, which follow from its parameters a1 … a5. At speeds v above the
/// width 1/a3 of the step at zero, the law is `F_v v + F_c + (F_s − F_c) exp(−v/v_s)` with viscous friction
/// F_v, Coulomb friction F_c, static friction F_s and the Stribeck speed v_s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StribeckWords {
    /// Coulomb friction F_c, in N·m or N: the parameter a2 of the law.
    pub coulomb: Estimate,
    /// Static friction F_s = a2 + a4, in N·m or N: the torque at which the joint begins to move. a2 and a4
    /// are parameters of the law.
    pub static_friction: Estimate,
    /// Stribeck speed v_s = 1/a5, in rad/s or m/s. At this speed, the difference of
    /// friction from Coulomb friction has fallen to 1/e of its value at rest.
    pub stribeck_speed: Estimate,
    /// Viscous friction F_v, in N·m s/rad or N s/m: the parameter a1 of the law.
    pub viscous: Estimate,
}

impl StribeckFit {
    /// Returns the physical parameters, with standard errors to first order.
    pub(crate) fn words(&self) -> StribeckWords {
        let [a1, a2, _, a4, a5] = self.parameters;
        let own = |i: usize, value: f64| Estimate { value, standard_error: self.standard_errors[i] };
        let c = &self.covariance;
        let both = self.standard_errors[1].and(self.standard_errors[3]);
        let static_variance = c[(1, 1)] + c[(3, 3)] + 2.0 * c[(1, 3)];
        StribeckWords {
            coulomb: own(1, a2),
            static_friction: Estimate {
                value: a2 + a4,
                standard_error: both.map(|_| static_variance.max(0.0).sqrt()),
            },
            stribeck_speed: Estimate {
                value: 1.0 / a5,
                standard_error: self.standard_errors[4].map(|e| e / (a5 * a5)),
            },
            viscous: own(0, a1),
        }
    }
}

impl StribeckWords {
    /// Returns one line of text with the given units of torque and velocity.
    pub(crate) fn line(&self, unit: &str, velocity_unit: &str) -> String {
        let text = |estimate: Estimate| with_error(estimate.value, estimate.standard_error);
        format!(
            "Coulomb F_c = {} {unit}, static F_s = {} {unit}, Stribeck speed v_s = {} {velocity_unit}, viscous F_v = {} \
             {unit}/({velocity_unit})",
            text(self.coulomb),
            text(self.static_friction),
            text(self.stribeck_speed),
            text(self.viscous)
        )
    }
}
