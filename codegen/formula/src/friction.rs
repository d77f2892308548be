//! Friction laws of the key `friction` of a joint, which the generator reads and identification writes.

use super::formula::Formula;
use super::function::Function;
use std::fmt::Display;

/// One term of a friction law, linear in its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionTerm<C = Formula> {
    /// Factor; as a formula, it depends on parameters only.
    pub coefficient: C,
    /// Function of the joint's velocity `v` (and position `y` where described so).
    pub basis: Formula,
}

/// Constructor of a term from its coefficient: [`FrictionTerm::viscous`] or [`FrictionTerm::coulomb`].
pub type TermOf = fn(Formula) -> FrictionTerm;

/// Friction of a joint: laws that add up, and the part of the load that becomes friction.
///
/// Coefficients are formulas where a description is read, and numbers or texts where it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionLaw<C = Formula> {
    /// Laws that add up.
    pub parts: Vec<FrictionPart<C>>,
    /// Friction for each unit of the load; empty if it does not grow with the load.
    pub load: Vec<FrictionTerm<C>>,
}

/// A law with a key of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionPart<C = Formula> {
    /// `viscous`: viscous friction `F_v v`.
    Viscous(C),
    /// `coulomb`: Coulomb friction `F_c sign(v)`, or `F_c tanh(s v)` with a slope s.
    Coulomb {
        /// Friction F_c.
        level: C,
        /// The slope, positive.
        slope: Option<f64>,
    },
    /// `coulomb`: Coulomb friction that depends on the direction.
    Asymmetric {
        /// Friction T₊ at positive velocity.
        positive: C,
        /// Friction T₋ at negative velocity, which is negative or 0.
        negative: C,
        /// The slope, positive.
        slope: Option<f64>,
    },
    /// `stribeck`: the law [`FrictionPart::STRIBECK`] of a1 … a5. Coulomb friction is a2, static friction a2 + a4, the
    /// Stribeck speed 1/a5 and viscous friction a1.
    Stribeck([C; 5]),
    /// `terms`: a sum of terms.
    Terms(Vec<FrictionTerm<C>>),
}

impl FrictionTerm {
    /// `coefficient · v`
    pub fn viscous(coefficient: Formula) -> Self {
        Self { coefficient, basis: Formula::Velocity }
    }

    /// `coefficient · sign(v)`
    pub fn coulomb(coefficient: Formula) -> Self {
        Self { coefficient, basis: direction(None) }
    }
}

impl<C> FrictionTerm<C> {
    /// Whether the basis jumps where the velocity changes its sign, by its limits on both sides.
    pub fn basis_jumps(&self) -> bool {
        beside_rest(&self.basis, -1.0) != beside_rest(&self.basis, 1.0)
    }
}

/// The limit of a law where the velocity goes to zero from one side.
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
    /// The parameters of the Stribeck law.
    pub const STRIBECK_KEYS: [&str; 5] = ["a1", "a2", "a3", "a4", "a5"];
    /// The equation of the Stribeck law.
    pub const STRIBECK: &str = "τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)";

    /// The law as a sum of terms.
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
    /// The value of a joint's key `friction` in TOML; bases are written over `v` and `y`.
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

/// `[["v", 76.556], ["tanh(5*v)", 3.924]]`
fn weighted<C: Display>(terms: &[FrictionTerm<C>]) -> String {
    let pair = |term: &FrictionTerm<C>| format!("[\"{}\", {}]", term.basis.text(&[]), term.coefficient);
    format!("[{}]", terms.iter().map(pair).collect::<Vec<_>>().join(", "))
}

/// The sign of the velocity, or tanh(s v) in its place, which is differentiable at rest.
fn direction(slope: Option<f64>) -> Formula {
    match slope {
        None => Formula::call(Function::Sign, Formula::Velocity),
        Some(slope) => {
            Formula::call(Function::Tanh, Formula::product(Formula::Number(slope), Formula::Velocity))
        }
    }
}

/// `(T₊ − T₋)/2 · sign(v) + (T₊ + T₋)/2 · |sign(v)|`; with a slope tanh(s v) and its square, which is smooth too.
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
