//! The data that methods are compared on (claim 8): records of the joints, with friction other than the published one.

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

/// Speeds over which all curves are judged [rad/s].
pub const FASTEST: f64 = 0.5;
/// Data below this speed are kept where extrapolation is tried [rad/s].
pub const SLOW: f64 = 0.25;
/// Error that a useful law stays below, rms [N m]: 1 % of the torque at full speed.
pub const USEFUL: f64 = 0.5;
/// Constant torque under which nonlinear regression is tried [N m].
pub const OFFSET: f64 = 2.0;
/// Length of the short trajectory (s).
pub const SHORT_SECONDS: f64 = 10.0;

/// How the plant's friction differs from the published one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beside {
    /// A constant besides: friction that differs by direction, or a torque sensor's offset [N m].
    pub offset: f64,
    /// Stribeck's law in place of the published one.
    pub stribeck: Option<[f64; 5]>,
}

impl Beside {
    pub const NOTHING: Self = Self { offset: 0.0, stribeck: None };
    /// Like joint C, with a step that no term of the library has, and 4 N m more towards standstill.
    pub const STRIBECK: Self = Self { offset: 0.0, stribeck: Some([56.0, 9.0, 40.0, 4.0, 10.0]) };

    pub fn offset(offset: f64) -> Self {
        Self { offset, ..Self::NOTHING }
    }

    /// Friction of the generated arm for a joint with this published friction, as far as the arm can
    /// represent it.
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
    /// The plant's own friction [N m].
    pub fn truth(&self, v: f64) -> f64 {
        let rest = self.beside.friction(self.published).at(v);
        self.beside.stribeck.map_or(rest, |law| rest + stribeck_torque(v, &law))
    }

    pub fn law(&self, method: Method) -> Outcome<FrictionLaw> {
        Ok(method.identify(&self.samples)?.result.law)
    }

    /// Error of the law over all speeds [N m rms].
    pub fn error(&self, method: Method) -> Outcome<f64> {
        curve_error(&self.law(method)?, |v| self.truth(v), FASTEST)
    }

    /// The same, not-a-number if the method gives no law.
    pub fn error_or_nan(&self, method: Method) -> f64 {
        self.error(method).unwrap_or(f64::NAN)
    }

    /// The same joint with other samples of it.
    pub fn with(&self, name: &'static str, samples: Samples) -> Self {
        Self { name, samples, ..self.clone() }
    }

    /// The first `seconds` of the data.
    pub fn first(&self, seconds: f64) -> Self {
        let count = (seconds / PERIOD).round() as usize;
        self.with(self.name, self.samples.first(count))
    }
}

/// B alone or C with β = −γ, recorded.
pub struct Recorded {
    record: Record<2>,
    joint: usize,
    beside: Beside,
}

impl Recorded {
    /// β alone.
    pub fn b(beside: Beside, seconds: f64, seed: u64) -> Outcome<Self> {
        Self::new(0, beside, seconds, seed)
    }

    /// γ with β = −γ.
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

    /// Its friction, the identifying model's gravity wrong by a share.
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

/// A under LQR, B, C; `gravity_error` in the identifying model.
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

/// The samples of B that |β| < 0.1 keeps.
pub fn narrow(b: &Case) -> Case {
    let kept = b.samples.select(|angle, _| angle.abs() < NARROW);
    b.with("B, |β| < 0.1", kept)
}

/// Largest error of a method [N m rms]; not-a-number if it gives no law.
pub fn worst(cases: &[Case], method: Method) -> f64 {
    let errors = cases.iter().map(|case| case.error_or_nan(method));
    errors.fold(0.0, |worst, error| if error > worst || error.is_nan() { error } else { worst })
}

/// Error of nonlinear regression over that of SINDy with LASSO, both rms over records of the same kind.
pub fn ratio(cases: &[Case]) -> f64 {
    let error = |method| rms(cases.iter().map(|case| case.error_or_nan(method)));
    error(Method::Stribeck) / error(Method::Lasso)
}

/// The samples up to a speed.
pub fn slower(case: &Case, slow: f64) -> Case {
    case.with(case.name, case.samples.select(|_, v| v.abs() <= slow))
}
