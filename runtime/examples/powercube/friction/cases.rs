//! Data for the comparison of methods (claim 8): records of the joints, also with other friction than published.

use super::angle::{NARROW, alpha_samples};
use super::data::{
    MEASURED, Record, Samples, beta_alone, controller_arm, friction_samples, opposed, record, rms,
};
use super::law::{Method, curve_error};
use super::plants::MoreFriction;
use crate::arm::{Friction, PERIOD, TERMS, arm, heavier};
use crate::study::Outcome;
use gelenk_identification::methods::stribeck::stribeck_torque;
use gelenk_identification::result::FrictionLaw;

/// Largest speed for the comparison of curves [rad/s].
pub const FASTEST: f64 = 0.5;
/// Largest speed of the data in tests of extrapolation [rad/s].
pub const SLOW: f64 = 0.25;
/// Largest rms error of a useful law [N m], which is 1 % of the torque at full speed.
pub const USEFUL: f64 = 0.5;
/// Constant torque in the tests of nonlinear regression [N m].
pub const OFFSET: f64 = 2.0;
/// Length of the short trajectory (s).
pub const SHORT_SECONDS: f64 = 10.0;

/// Difference between the friction of the plant and the published friction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beside {
    /// Additional constant torque, for example because friction depends on the direction or a torque sensor has an offset [N m].
    pub offset: f64,
    /// Parameters of a Stribeck law that replaces the published law; `None` for the published law.
    pub stribeck: Option<[f64; 5]>,
}

impl Beside {
    pub const NOTHING: Self = Self { offset: 0.0, stribeck: None };
    /// Friction similar to joint C, with a slope at rest that no term of the library has, and 4 N m more at low speed.
    pub const STRIBECK: Self = Self { offset: 0.0, stribeck: Some([56.0, 9.0, 40.0, 4.0, 10.0]) };

    pub fn offset(offset: f64) -> Self {
        Self { offset, ..Self::NOTHING }
    }

    /// Friction of the generated arm for a joint with this published friction. The arm can represent the offset, but not the
    /// Stribeck law.
    fn friction(self, published: Friction) -> Friction {
        let mut friction = match self.stribeck {
            Some(_) => Friction([0.0; TERMS]),
            None => published,
        };
        friction.0[0] += self.offset;
        friction
    }

    fn plant(self) -> MoreFriction {
        MoreFriction {
            robot: arm([Friction::B, Friction::C].map(|published| self.friction(published))),
            load_share: 0.0,
            stribeck: [self.stribeck; 2],
        }
    }
}

/// A joint with data and its true friction.
#[derive(Clone)]
pub struct Case {
    pub name: &'static str,
    pub samples: Samples,
    published: Friction,
    beside: Beside,
}

impl Case {
    /// True friction of the plant [N m].
    pub fn truth(&self, v: f64) -> f64 {
        let rest = self.beside.friction(self.published).at(v);
        self.beside.stribeck.map_or(rest, |law| rest + stribeck_torque(v, &law))
    }

    pub fn law(&self, method: Method) -> Outcome<FrictionLaw> {
        Ok(method.identify(&self.samples)?.result.law)
    }

    /// Rms error of the law over all speeds [N m].
    pub fn error(&self, method: Method) -> Outcome<f64> {
        curve_error(&self.law(method)?, |v| self.truth(v), FASTEST)
    }

    /// Rms error of the law over all speeds [N m]; NaN if the method finds no law.
    pub fn error_or_nan(&self, method: Method) -> f64 {
        self.error(method).unwrap_or(f64::NAN)
    }

    /// The same joint with other samples.
    pub fn with(&self, name: &'static str, samples: Samples) -> Self {
        Self { name, samples, ..self.clone() }
    }

    /// The first `seconds` of the data.
    pub fn first(&self, seconds: f64) -> Self {
        let count = (seconds / PERIOD).round() as usize;
        self.with(self.name, self.samples.first(count))
    }
}

/// Record of joint B moving alone, or of joint C with β = −γ.
pub struct Recorded {
    record: Record<2>,
    joint: usize,
    beside: Beside,
}

impl Recorded {
    /// Records joint B (β) moving alone.
    pub fn b(beside: Beside, seconds: f64, seed: u64) -> Outcome<Self> {
        Self::new(0, beside, seconds, seed)
    }

    /// Records joint C (γ) with β = −γ.
    pub fn c(beside: Beside, seconds: f64, seed: u64) -> Outcome<Self> {
        Self::new(1, beside, seconds, seed)
    }

    fn new(joint: usize, beside: Beside, seconds: f64, seed: u64) -> Outcome<Self> {
        let motion = [beta_alone(), opposed()][joint].clone();
        let noise = (&MEASURED, seed);
        Ok(Self {
            record: record(beside.plant(), &controller_arm(), &motion, seconds, noise)?,
            joint,
            beside,
        })
    }

    /// Friction samples, computed with a relative error of gravity.
    pub fn case(&self, gravity_error: f64) -> Outcome<Case> {
        let model = heavier(controller_arm(), gravity_error);
        let [b, c] = friction_samples(&self.record, &model, MEASURED.encoder_step)?;
        let (name, samples, published) = match self.joint {
            0 => ("B, all angles", b, Friction::B),
            _ => ("C, β = −γ", c, Friction::C),
        };
        Ok(Case { name, samples, published, beside: self.beside })
    }
}

/// Joints A (with LQR), B and C, with a relative error of gravity in the model for the identification.
pub fn joints(gravity_error: f64, seconds: f64) -> Outcome<[Case; 3]> {
    let a = Case {
        name: "A, under LQR",
        samples: alpha_samples(seconds)?,
        published: Friction::A,
        beside: Beside::NOTHING,
    };
    let b = Recorded::b(Beside::NOTHING, seconds, 2)?.case(gravity_error)?;
    let c = Recorded::c(Beside::NOTHING, seconds, 2)?.case(gravity_error)?;
    Ok([a, b, c])
}

/// The samples of B with |β| < 0.1.
pub fn narrow(b: &Case) -> Case {
    let kept = b.samples.select(|angle, _| angle.abs() < NARROW);
    b.with("B, |β| < 0.1", kept)
}

/// Largest rms error of a method [N m]; NaN if the method finds no law.
pub fn worst(cases: &[Case], method: Method) -> f64 {
    let errors = cases.iter().map(|case| case.error_or_nan(method));
    errors.fold(0.0, |worst, error| if error > worst || error.is_nan() { error } else { worst })
}

/// Ratio of the error of nonlinear regression to that of SINDy with LASSO. Both are rms errors over records of the same kind.
pub fn ratio(cases: &[Case]) -> f64 {
    let error = |method| rms(cases.iter().map(|case| case.error_or_nan(method)));
    error(Method::Stribeck) / error(Method::Lasso)
}

/// The samples up to a speed.
pub fn slower(case: &Case, slow: f64) -> Case {
    case.with(case.name, case.samples.select(|_, v| v.abs() <= slow))
}
