//! Transmission of motion from the coordinates to joints and rotors.

use crate::graph::Scalar;

/// A joint or rotor that follows coordinates. Its position is `Σ ratio · y[coordinate]` plus a constant
/// offset, which is a part of the frames.
///
/// A joint whose axis was reversed has the ratio −1. A joint that follows several coordinates has a term for
/// each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission<S> {
    /// Followed coordinates, each once.
    pub terms: Vec<Followed<S>>,
}

/// A coordinate that a joint or rotor follows, with the ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed<S> {
    /// Index of the followed coordinate.
    pub coordinate: usize,
    /// Motion of the joint or rotor per unit of the coordinate's motion.
    pub ratio: S,
}

impl<S: Copy> Transmission<S> {
    /// A transmission that follows one coordinate.
    pub fn of(coordinate: usize, ratio: S) -> Self {
        Self { terms: vec![Followed { coordinate, ratio }] }
    }

    /// The followed coordinate if there is exactly one; otherwise `None`.
    pub fn single(&self) -> Option<Followed<S>> {
        match self.terms[..] {
            [followed] => Some(followed),
            _ => None,
        }
    }

    /// The only coordinate of a joint in a mechanism without couplings.
    ///
    /// # Panics
    ///
    /// If several coordinates are followed. Callers must check
    /// [`Mechanism::is_coupled`](super::Mechanism::is_coupled) first.
    pub fn own(&self) -> Followed<S> {
        match self.single() {
            Some(followed) => followed,
            None => unreachable!("forms for single coordinates are not chosen for coupled joints"),
        }
    }
}

impl<'g> Transmission<Scalar<'g>> {
    /// The transmission with its ratios multiplied by `ratio`.
    pub fn scaled(self, ratio: Scalar<'g>) -> Self {
        let term = |term: Followed<Scalar<'g>>| Followed { ratio: term.ratio * ratio, ..term };
        Self { terms: self.terms.into_iter().map(term).collect() }
    }

    /// Sum of the motions of several joints. Ratios of equal coordinates are added first. Therefore ratios
    /// that cancel, for example in a parallelogram, need no operation.
    pub fn sum_of_motions<'a>(
        chain: impl Iterator<Item = &'a Self> + Clone,
        zero: Scalar<'g>,
        x: &[Scalar<'g>],
    ) -> Scalar<'g>
    where
        'g: 'a,
    {
        if chain.clone().all(|joint| joint.single().is_some()) {
            return chain.fold(zero, |sum, joint| sum + joint.motion(x));
        }
        let mut ratios = vec![zero; x.len()];
        for term in chain.flat_map(|joint| &joint.terms) {
            ratios[term.coordinate] = ratios[term.coordinate] + term.ratio;
        }
        let moving = ratios.iter().zip(x).filter(|(ratio, _)| !ratio.is_zero());
        moving.fold(zero, |sum, (&ratio, &x)| sum + x * ratio)
    }

    /// Motion `Σ ratio · x[coordinate]`. `x` contains the positions, velocities or accelerations of all
    /// coordinates.
    pub fn motion(&self, x: &[Scalar<'g>]) -> Scalar<'g> {
        let terms = self.terms.iter().map(|term| x[term.coordinate] * term.ratio);
        let sum = terms.reduce(|sum, term| sum + term);
        sum.unwrap_or_else(|| unreachable!("validation gives every follower a coordinate"))
    }

    /// Adds the generalized forces of a force along the motion: `forces[coordinate] += ratio · force`.
    pub fn add_force(&self, force: Scalar<'g>, forces: &mut [Scalar<'g>]) {
        for term in &self.terms {
            let sum = &mut forces[term.coordinate];
            *sum = *sum + force * term.ratio;
        }
    }

    /// Adds a force along this motion that a unit of one coordinate's motion causes:
    /// `matrix[coordinate][column] += ratio · force`.
    pub fn add_row_entry(&self, column: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        for term in &self.terms {
            let sum = &mut matrix[term.coordinate][column];
            *sum = *sum + force * term.ratio;
        }
    }

    /// Adds a force on one coordinate that a unit of this motion causes:
    /// `matrix[row][coordinate] += force · ratio`.
    pub fn add_column_entry(&self, row: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        self.add_force(force, &mut matrix[row]);
    }

    /// Adds a force along this motion to a symmetric matrix. A unit of motion of `coordinate` causes this
    /// force. `ratio · force` is added in the row and in the column of `coordinate`. If this motion also
    /// follows `coordinate`, the diagonal entry gets both.
    pub fn add_coupling(&self, coordinate: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        self.add_row_entry(coordinate, force, matrix);
        self.add_column_entry(coordinate, force, matrix);
    }
}
