//! The signs of the eigenvalues of M.

use super::regularity::Pivots;
use super::{Joint, Model};

/// Signs of the eigenvalues of a mass matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Definiteness {
    /// All are positive.
    Positive,
    /// Some are zero: joints move nothing that has inertia.
    Semidefinite,
    /// Some are negative: bodies are none that there can be.
    Indefinite,
}

impl Model {
    /// The definiteness of M at seeded states, at the described values of free parameters.
    #[must_use]
    pub fn definiteness(&self) -> Definiteness {
        let pivots = Pivots::of(self);
        match (pivots.negative.is_empty(), pivots.zero.is_empty()) {
            (false, _) => Definiteness::Indefinite,
            (true, false) => Definiteness::Semidefinite,
            (true, true) => Definiteness::Positive,
        }
    }

    /// The joints that move nothing with inertia along their axis, so that M is singular; at the described
    /// values of free parameters.
    #[must_use]
    pub fn joints_without_inertia(&self) -> Vec<&Joint> {
        self.joints_of(&Pivots::of(self).zero)
    }

    /// For each coordinate the smallest pivot of M at seeded states.
    pub(crate) fn least_pivots(&self) -> Vec<f64> {
        let least = Pivots::of_velocities(self).least;
        let pivots = self.coordinates.iter();
        pivots.filter_map(|&link| least.get(link).copied()).collect()
    }
}
