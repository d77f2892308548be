//! Potential energy of force laws: antiderivatives of polynomials of the position.

use super::formula::Formula;

/// Highest degree of polynomials that are expanded.
const HIGHEST_DEGREE: usize = 32;

impl Formula {
    /// Antiderivative of the force law `f` at velocity 0 with respect to the position, `∫ f(y, 0) dy`. `None`
    /// if the law at velocity 0 is not a polynomial of the position.
    ///
    /// A summand `c (s y + d)ⁿ` with a number s has the energy `c (s y + d)ⁿ⁺¹ / (s (n + 1))`. This energy is 0
    /// at the position at which the summand's force is 0. All other summands are expanded, for example if s is
    /// a parameter. Their energy is 0 at y = 0.
    pub fn energy(&self) -> Option<Self> {
        let terms = self.at_standstill().linear_terms();
        terms.into_iter().try_fold(Self::ZERO, |sum, (coefficient, basis)| {
            Some(Self::sum(sum, Self::product(coefficient, antiderivative(&basis)?)))
        })
    }

    /// The formula with the velocity replaced by 0.
    fn at_standstill(&self) -> Self {
        self.substituted(&|part| (*part == Self::Velocity).then_some(Self::ZERO))
    }

    /// Coefficients of the polynomial in the position, in ascending order of the powers. `None` if the formula
    /// is not a polynomial.
    fn coefficients(&self) -> Option<Vec<Self>> {
        if !self.depends_on_motion() {
            return Some(vec![self.clone()]);
        }
        match self {
            Self::Position => Some(vec![Self::ZERO, Self::ONE]),
            Self::Negate(a) => Some(a.coefficients()?.into_iter().map(Self::negation).collect()),
            Self::Add(a, b) => Some(by_power(&a.coefficients()?, &b.coefficients()?, Self::sum)),
            Self::Subtract(a, b) => Some(by_power(&a.coefficients()?, &b.coefficients()?, Self::difference)),
            Self::Multiply(a, b) => multiplied(&a.coefficients()?, &b.coefficients()?),
            Self::Divide(a, b) if !b.depends_on_motion() => {
                let quotient = |c| Self::quotient(c, (**b).clone());
                Some(a.coefficients()?.into_iter().map(quotient).collect())
            }
            Self::Power(a, exponent) => {
                let factor = a.coefficients()?;
                (0..*exponent).try_fold(vec![Self::ONE], |power, _| multiplied(&power, &factor))
            }
            _ => None,
        }
    }
}

fn antiderivative(basis: &Formula) -> Option<Formula> {
    let (inner, exponent) = match basis {
        Formula::Power(inner, exponent) => (&**inner, *exponent),
        other => (other, 1),
    };
    if let [_, Formula::Number(slope)] = inner.coefficients()?[..]
        && slope != 0.0
    {
        let factor = Formula::Number(1.0 / (slope * f64::from(exponent + 1)));
        return Some(Formula::product(factor, Formula::power(inner.clone(), exponent + 1)));
    }
    let terms = basis.coefficients()?.into_iter().zip(1..);
    let term = |(c, power): (Formula, u32)| {
        let factor = Formula::product(Formula::Number(1.0 / f64::from(power)), c);
        Formula::product(factor, Formula::power(Formula::Position, power))
    };
    Some(terms.map(term).fold(Formula::ZERO, Formula::sum))
}

fn by_power(a: &[Formula], b: &[Formula], combined: fn(Formula, Formula) -> Formula) -> Vec<Formula> {
    let at = |of: &[Formula], power: usize| of.get(power).cloned().unwrap_or(Formula::ZERO);
    (0..a.len().max(b.len())).map(|power| combined(at(a, power), at(b, power))).collect()
}

fn multiplied(a: &[Formula], b: &[Formula]) -> Option<Vec<Formula>> {
    let mut product = vec![Formula::ZERO; a.len() + b.len() - 1];
    if product.len() > HIGHEST_DEGREE + 1 {
        return None;
    }
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            let more = Formula::product(a.clone(), b.clone());
            product[i + j] = Formula::sum(product[i + j].clone(), more);
        }
    }
    Some(product)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Function;

    fn y() -> Box<Formula> {
        Box::new(Formula::Position)
    }

    fn stretch() -> Box<Formula> {
        Box::new(Formula::Subtract(y(), Box::new(Formula::Number(0.3))))
    }

    /// A spring's energy vanishes at its rest length, whatever its free stiffness is; a damper has none.
    #[test]
    fn springs_have_the_energy_of_their_stretch() {
        let spring = Formula::Multiply(Box::new(Formula::Parameter(0)), stretch());
        let damper = Formula::Multiply(Box::new(Formula::Number(40.0)), Box::new(Formula::Velocity));
        let energy = Formula::sum(spring, damper).energy().expect("a polynomial");

        assert_eq!(energy.evaluate(&[800.0], 0.3, 2.0), 0.0);
        assert!((energy.evaluate(&[800.0], 0.5, 2.0) - 0.5 * 800.0 * 0.2 * 0.2).abs() < 1e-12);
    }

    /// Central differences of the energy are the law at standstill.
    #[test]
    fn energies_have_the_slope_of_their_laws() {
        let product = Formula::Multiply(Box::new(Formula::Power(stretch(), 3)), y());
        let free_slope = Formula::Add(
            Box::new(Formula::Number(2.0)),
            Box::new(Formula::Multiply(Box::new(Formula::Parameter(0)), y())),
        );
        let laws = [
            Formula::Negate(stretch()),
            Formula::Power(stretch(), 5),
            Formula::Divide(Box::new(product), Box::new(Formula::Parameter(0))),
            Formula::Power(Box::new(free_slope), 2),
            Formula::Subtract(y(), Box::new(Formula::call(Function::Exp, Formula::Parameter(0)))),
        ];
        for law in laws {
            let energy = law.energy().expect("a polynomial");
            let at = |l: f64| energy.evaluate(&[1.7], l, 0.4);
            let slope = (at(0.8 + 1e-4) - at(0.8 - 1e-4)) / 2e-4;
            let force = law.evaluate(&[1.7], 0.8, 0.0);
            assert!((slope - force).abs() < 1e-6 * force.abs().max(1.0), "{law:?}: {slope} for {force}");
        }
    }

    #[test]
    fn laws_that_are_no_polynomials_have_none() {
        let inverse = Formula::Divide(Box::new(Formula::ONE), y());
        let steep = Formula::Power(Box::new(Formula::Power(stretch(), 20)), 20);
        for law in [inverse, Formula::Call(Function::Tanh, y()), steep] {
            assert_eq!(law.energy(), None);
        }
    }
}
