//! Test whether the mass matrix is positive definite.

use super::Model;
use super::regularity::Pivots;

/// Signs of the eigenvalues of a mass matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Definiteness {
    /// All eigenvalues of the mass matrix are positive.
    Positive,
    /// Some eigenvalues of the mass matrix are zero, because some motions of joints move no inertia.
    Semidefinite,
    /// Some eigenvalues of the mass matrix are negative, because some bodies have physically impossible
    /// inertias.
    Indefinite,
}

impl Model {
    /// Determines the signs of the eigenvalues of the mass matrix at pseudo-random states that are the same
    /// in every call. Parameters have the values of the description.
    #[must_use]
    pub fn definiteness(&self) -> Definiteness {
        let pivots = Pivots::of(self);
        match (pivots.negative.is_empty(), pivots.zero.is_empty()) {
            (false, _) => Definiteness::Indefinite,
            (true, false) => Definiteness::Semidefinite,
            (true, true) => Definiteness::Positive,
        }
    }

    /// Joint motions that move no mass and therefore make the mass matrix singular. Each text names one joint
    /// or a sum of joints, for example `a` − 0.5 `b`. Parameters have the values of the description.
    #[must_use]
    pub fn motions_without_inertia(&self) -> Vec<String> {
        Pivots::of(self).free_motions(self)
    }
}
