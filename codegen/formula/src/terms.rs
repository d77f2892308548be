//! Splits a force law into terms that are linear in their coefficients.

use super::formula::Formula;

impl Formula {
    /// Splits the formula into summands (coefficient, basis): `f(y, v) = Σ cᵢ φᵢ(y, v)` with the position y and
    /// the velocity v. Factors without y and v form the coefficient cᵢ, all other factors form the basis φᵢ.
    ///
    /// Products are not distributed over sums: `a*(v + tanh(v))` is one term.
    pub fn linear_terms(self) -> Vec<(Self, Self)> {
        let mut summands = Vec::new();
        collect_summands(self, false, &mut summands);
        let split = summands.into_iter().map(|(negative, summand)| {
            let (coefficient, basis) = split(summand);
            (if negative { Self::negation(coefficient) } else { coefficient }, basis)
        });
        split.filter(|(coefficient, _)| !coefficient.is_zero()).collect()
    }
}

fn collect_summands(formula: Formula, negative: bool, into: &mut Vec<(bool, Formula)>) {
    match formula {
        Formula::Add(a, b) => {
            collect_summands(*a, negative, into);
            collect_summands(*b, negative, into);
        }
        Formula::Subtract(a, b) => {
            collect_summands(*a, negative, into);
            collect_summands(*b, !negative, into);
        }
        Formula::Negate(a) => collect_summands(*a, !negative, into),
        other => into.push((negative, other)),
    }
}

/// Splits one summand into its coefficient and its basis function.
fn split(formula: Formula) -> (Formula, Formula) {
    match formula {
        constant if !constant.depends_on_motion() => (constant, Formula::ONE),
        Formula::Negate(a) => {
            let (coefficient, basis) = split(*a);
            (Formula::negation(coefficient), basis)
        }
        Formula::Multiply(a, b) => {
            let ((c1, b1), (c2, b2)) = (split(*a), split(*b));
            (Formula::product(c1, c2), Formula::product(b1, b2))
        }
        Formula::Divide(a, b) => {
            let ((c1, b1), (c2, b2)) = (split(*a), split(*b));
            (Formula::quotient(c1, c2), Formula::quotient(b1, b2))
        }
        other => (Formula::ONE, other),
    }
}
