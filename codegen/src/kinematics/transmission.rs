//! Transmission of motion: what joints and rotors do while the coordinates move.

use crate::graph::Scalar;

/// A joint or a rotor that follows a coordinate: `position = ratio · y[coordinate]`, and constant offsets
/// that stand in the frames.
///
/// The axis of a joint that was turned around has the ratio −1, a rotor the ratio of its gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission<S> {
    /// The coordinate that is followed.
    pub coordinate: usize,
    /// Motion for a unit of the coordinate's motion.
    pub ratio: S,
}

impl<'g> Transmission<Scalar<'g>> {
    /// `ratio · x[coordinate]`: the position, velocity or acceleration for those of all coordinates.
    pub fn motion(&self, x: &[Scalar<'g>]) -> Scalar<'g> {
        x[self.coordinate] * self.ratio
    }

    /// `x / ratio`: what a motion, or a force, is for one of the coordinate.
    pub fn inverse(&self, x: Scalar<'g>) -> Scalar<'g> {
        x.divided_by(self.ratio)
    }

    /// Adds what a force along the motion does to the coordinates: `forces[coordinate] += ratio · force`.
    pub fn add_force(&self, force: Scalar<'g>, forces: &mut [Scalar<'g>]) {
        let sum = &mut forces[self.coordinate];
        *sum = *sum + force * self.ratio;
    }

    /// Adds the force along the motion for a unit of one coordinate's motion:
    /// `matrix[coordinate][column] += ratio · force`.
    pub fn add_row_entry(&self, column: usize, force: Scalar<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        let sum = &mut matrix[self.coordinate][column];
        *sum = *sum + force * self.ratio;
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
