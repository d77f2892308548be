//! Friction laws: values of the key `friction` of a joint. The generator reads these values, and identification
//! writes them.

use super::formula::Formula;
use super::function::Function;
use std::fmt::Display;

/// One term of a friction law: a coefficient times a basis function.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionTerm<C = Formula> {
    /// Coefficient of the term, for example F_c in `F_c sign(v)`. If it is a formula, it depends only on
    /// parameters.
    pub coefficient: C,
    /// Basis function of the joint's velocity `v`. It may also depend on the joint's position `y`.
    pub basis: Formula,
}

/// Function that makes a friction term from its coefficient: [`FrictionTerm::viscous`] or
/// [`FrictionTerm::coulomb`].
pub type TermOf = fn(Formula) -> FrictionTerm;

/// Friction of a joint: the sum of several laws, plus load-dependent friction.
///
/// The coefficients are formulas in a law that was read, and numbers or texts in a law that is written.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionLaw<C = Formula> {
    /// Friction laws that do not depend on the load. They are added to each other and to the load-dependent friction.
    pub parts: Vec<FrictionPart<C>>,
    /// Terms of the load-dependent friction per unit of load, without unit; empty if the friction does not
    /// depend on the load. The load is the drive's force without friction.
    pub load: Vec<FrictionTerm<C>>,
}

/// A friction law. Each variant is one key in descriptions.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionPart<C = Formula> {
    /// `viscous`: viscous friction `F_v v` with the coefficient F_v and the velocity v.
    Viscous(C),
    /// `coulomb`: Coulomb friction `F_c sign(v)`, or `F_c tanh(s v)` with a slope s, at the velocity v.
    Coulomb {
        /// Coulomb friction F_c (N m or N).
        level: C,
        /// Positive slope s of `tanh(s v)`; `None` for `sign(v)`.
        slope: Option<f64>,
    },
    /// `coulomb`: Coulomb friction with different values for the two directions.
    Asymmetric {
        /// Friction T₊ at positive velocity (N m or N).
        positive: C,
        /// Friction T₋ at negative velocity (N m or N), which is negative or 0.
        negative: C,
        /// Positive slope s of `tanh(s v)`; `None` for `sign(v)`.
        slope: Option<f64>,
    },
    /// `stribeck`: the law [`FrictionPart::STRIBECK`] with coefficients a1 … a5. Coulomb friction is a2,
    /// static friction is a2 + a4, the Stribeck speed is 1/a5, and the coefficient of viscous friction is a1.
    Stribeck([C; 5]),
    /// `terms`: a sum of terms, each a coefficient times a function of the joint's velocity and position.
    Terms(Vec<FrictionTerm<C>>),
}

impl FrictionTerm {
    /// The viscous term `coefficient · v` with the joint's velocity `v`.
    pub fn viscous(coefficient: Formula) -> Self {
        Self { coefficient, basis: Formula::Velocity }
    }

    /// The Coulomb term `coefficient · sign(v)` with the joint's velocity `v`.
    pub fn coulomb(coefficient: Formula) -> Self {
        Self { coefficient, basis: direction(None) }
    }
}

impl<C> FrictionTerm<C> {
    /// Whether the basis function is discontinuous at zero velocity.
    pub fn basis_jumps(&self) -> bool {
        beside_rest(&self.basis, -1.0) != beside_rest(&self.basis, 1.0)
    }
}

/// Limit of a friction law as the velocity goes to zero from one side. `direction` is the sign of the
/// velocity.
fn beside_rest(law: &Formula, direction: f64) -> Formula {
    law.substituted(&|part| match part {
        Formula::Velocity => Some(Formula::ZERO),
        Formula::Call(Function::Sign, x) => Some(match beside_rest(x, direction) {
            x if x.is_zero() => Formula::Number(direction),
            x => Formula::call(Function::Sign, x),
        }),
        _ => None,
    })
}

impl FrictionPart {
    /// Keys of the coefficients a1 … a5 of the Stribeck friction law in descriptions.
    pub const STRIBECK_KEYS: [&str; 5] = ["a1", "a2", "a3", "a4", "a5"];
    /// The Stribeck law: friction τ as a function of the velocity v, with coefficients a1 … a5.
    pub const STRIBECK: &str = "τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)";

    /// Returns the law as a list of terms whose sum is the friction.
    pub fn terms(self) -> Vec<FrictionTerm> {
        match self {
            Self::Viscous(coefficient) => vec![FrictionTerm::viscous(coefficient)],
            Self::Coulomb { level, slope } => {
                vec![FrictionTerm { coefficient: level, basis: direction(slope) }]
            }
            Self::Asymmetric { positive, negative, slope } => asymmetric(positive, negative, slope),
            Self::Stribeck(parameters) => stribeck(parameters).into(),
            Self::Terms(terms) => terms,
        }
    }
}

impl<C: Display> FrictionLaw<C> {
    /// Writes the friction in TOML, as the value of the key `friction` of a joint. Basis functions depend on
    /// `v` and `y`.
    pub fn toml(&self) -> String {
        let mut keys: Vec<String> = self.parts.iter().map(FrictionPart::toml).collect();
        if !self.load.is_empty() {
            keys.push(format!("load = {}", weighted(&self.load)));
        }
        format!("{{ {} }}", keys.join(", "))
    }
}

impl<C: Display> FrictionPart<C> {
    fn toml(&self) -> String {
        let sloped =
            |slope: &Option<f64>| slope.map_or(String::new(), |slope| format!(", slope = {slope:?}"));
        match self {
            Self::Viscous(coefficient) => format!("viscous = {coefficient}"),
            Self::Coulomb { level, slope } => format!("coulomb = {{ value = {level}{} }}", sloped(slope)),
            Self::Asymmetric { positive, negative, slope } => {
                let slope = sloped(slope);
                format!("coulomb = {{ positive = {positive}, negative = {negative}{slope} }}")
            }
            Self::Stribeck(parameters) => {
                let pairs = FrictionPart::STRIBECK_KEYS.iter().zip(parameters);
                let pairs: Vec<String> = pairs.map(|(key, value)| format!("{key} = {value}")).collect();
                format!("stribeck = {{ {} }}", pairs.join(", "))
            }
            Self::Terms(terms) => format!("terms = {}", weighted(terms)),
        }
    }
}

/// Returns a text as a basic string of TOML, with quotes and escapes.
pub fn toml_text(text: &str) -> String {
    let mut out = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => out.extend(['\\', letter]),
            control if control.is_control() => {
                out.push_str(&format!("\\u{:04X}", u32::from(control)));
            }
            other => out.push(other),
        }
    }
    out.push('"');
    out
}

/// Writes the terms as a list in TOML, for example `[["v", 76.556], ["tanh(5*v)", 3.924]]`.
fn weighted<C: Display>(terms: &[FrictionTerm<C>]) -> String {
    let pair = |term: &FrictionTerm<C>| format!("[\"{}\", {}]", term.basis.text(&[]), term.coefficient);
    format!("[{}]", terms.iter().map(pair).collect::<Vec<_>>().join(", "))
}

/// The sign of the velocity v, or tanh(s v) with the slope s, which is differentiable at v = 0.
fn direction(slope: Option<f64>) -> Formula {
    match slope {
        None => Formula::call(Function::Sign, Formula::Velocity),
        Some(slope) => {
            Formula::call(Function::Tanh, Formula::product(Formula::Number(slope), Formula::Velocity))
        }
    }
}

/// The terms `(T₊ − T₋)/2 · sign(v)` and `(T₊ + T₋)/2 · |sign(v)|`. With a slope s, tanh(s v) and its square
/// replace both factors, so that the law is smooth.
fn asymmetric(positive: Formula, negative: Formula, slope: Option<f64>) -> Vec<FrictionTerm> {
    let half = |sum: Formula| Formula::quotient(sum, Formula::Number(2.0));
    let difference = half(Formula::difference(positive.clone(), negative.clone()));
    let mean = half(Formula::sum(positive, negative));
    let odd = direction(slope);
    let even = match slope {
        None => Formula::call(Function::Abs, odd.clone()),
        Some(_) => Formula::power(odd.clone(), 2),
    };
    let terms =
        [(difference, odd), (mean, even)].map(|(coefficient, basis)| FrictionTerm { coefficient, basis });
    terms.into_iter().filter(|term| !term.coefficient.is_zero()).collect()
}

fn stribeck([a1, a2, a3, a4, a5]: [Formula; 5]) -> [FrictionTerm; 3] {
    let v = || Formula::Velocity;
    let decay = Formula::negation(Formula::product(a5, Formula::call(Function::Abs, v())));
    let steep = Formula::product(Formula::product(Formula::Number(3.0), a3.clone()), v());
    let edge = Formula::product(Formula::call(Function::Exp, decay), Formula::call(Function::Tanh, steep));
    let flat = Formula::call(Function::Tanh, Formula::product(a3, v()));
    [(a1, v()), (a2, flat), (a4, edge)].map(|(coefficient, basis)| FrictionTerm { coefficient, basis })
}
