//! Signs of the eigenvalues of M.

use super::Model;
use super::regularity::Pivots;

/// Signs of the eigenvalues of a mass matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Definiteness {
    /// All are positive.
    Positive,
    /// Some are zero: some motions of joints move nothing with inertia.
    Semidefinite,
    /// Some are negative: some bodies are not physical.
    Indefinite,
}

impl Model {
    /// Definiteness of M at seeded states, at the described free parameters.
    #[must_use]
    pub fn definiteness(&self) -> Definiteness {
        let pivots = Pivots::of(self);
        match (pivots.negative.is_empty(), pivots.zero.is_empty()) {
            (false, _) => Definiteness::Indefinite,
            (true, false) => Definiteness::Semidefinite,
            (true, true) => Definiteness::Positive,
        }
    }

    /// Motions without inertia, which make M singular: joints or sums of joints, at the described free parameters.
    #[must_use]
    pub fn motions_without_inertia(&self) -> Vec<String> {
        Pivots::of(self).free_motions(self)
    }
}
