//! Transmission of motion: motions of joints and rotors as functions of the coordinates.

use crate::graph::Scalar;

/// A joint or a rotor that follows coordinates: `position = Σ ratio · y[coordinate]`, and constant offsets
/// that stand in the frames. It is a row of the matrix G in `y_joint = G y + g₀`.
///
/// The axis of a joint that was turned around has the ratio −1, a joint that follows others has a term for
/// each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission<S> {
    /// The coordinates that are followed, each once.
    pub terms: Vec<Followed<S>>,
}

/// A coordinate that a joint follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed<S> {
    /// The coordinate.
    pub coordinate: usize,
    /// Motion for a unit of the coordinate's motion.
    pub ratio: S,
}

impl<S: Copy> Transmission<S> {
    /// Follows one coordinate.
    pub fn of(coordinate: usize, ratio: S) -> Self {
        Self { terms: vec![Followed { coordinate, ratio }] }
    }

    /// The coordinate, if it follows only one.
    pub fn single(&self) -> Option<Followed<S>> {
        match self.terms[..] {
            [followed] => Some(followed),
            _ => None,
        }
    }

    /// The coordinate of a joint in a mechanism without couplings.
    ///
    /// # Panics
    ///
    /// Where several are followed: callers ask [`Mechanism::is_coupled`](super::Mechanism::is_coupled) first.
    pub fn own(&self) -> Followed<S> {
        match self.single() {
            Some(followed) => followed,
            None => unreachable!("forms for single coordinates are not chosen for coupled joints"),
        }
    }
}

impl<'g> Transmission<Scalar<'g>> {
    /// The motion times `ratio`.
    pub fn scaled(self, ratio: Scalar<'g>) -> Self {
        let term = |term: Followed<Scalar<'g>>| Followed { ratio: term.ratio * ratio, ..term };
        Self { terms: self.terms.into_iter().map(term).collect() }
    }

    /// `Σ` of the motions of several joints. Where some of them follow others the ratios are added before: what
    /// cancels, as in a parallelogram, takes no operation.
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

    /// `Σ ratio · x[coordinate]`: the position, velocity or acceleration for those of all coordinates.
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

    /// Adds the force along the motion for a unit of one coordinate's motion:
    /// `matrix[coordinate][column] += ratio · force`.
    pub fn add_row_entry(&self, column: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        for term in &self.terms {
            let sum = &mut matrix[term.coordinate][column];
            *sum = *sum + force * term.ratio;
        }
    }

    /// Adds the force on one coordinate for a unit of the motion: `matrix[row][coordinate] += force · ratio`.
    pub fn add_column_entry(&self, row: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        self.add_force(force, &mut matrix[row]);
    }

    /// Adds an entry of a symmetric matrix and its mirror image, which both fall on the diagonal where the
    /// motion follows the coordinate.
    pub fn add_coupling(&self, coordinate: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        self.add_row_entry(coordinate, force, matrix);
        self.add_column_entry(coordinate, force, matrix);
    }
}
