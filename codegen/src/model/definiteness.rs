//! Signs of the eigenvalues of M.

use super::Model;
use super::regularity::Pivots;

/// Signs of the eigenvalues of a mass matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Definiteness {
    /// All eigenvalues are positive.
    Positive,
    /// Some eigenvalues are zero, because some motions of joints move no inertia.
    Semidefinite,
    /// Some eigenvalues are negative, because some bodies are not physical.
    Indefinite,
}

impl Model {
    /// Definiteness of M at seeded states, with the parameter values of the description.
    #[must_use]
    pub fn definiteness(&self) -> Definiteness {
        let pivots = Pivots::of(self);
        match (pivots.negative.is_empty(), pivots.zero.is_empty()) {
            (false, _) => Definiteness::Indefinite,
            (true, false) => Definiteness::Semidefinite,
            (true, true) => Definiteness::Positive,
        }
    }

    /// Motions that move no inertia and make M singular, with the parameter values of the description. A
    /// motion is a joint or a sum of joints, as text.
    #[must_use]
    pub fn motions_without_inertia(&self) -> Vec<String> {
        Pivots::of(self).free_motions(self)
    }
}
