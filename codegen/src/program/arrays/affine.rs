//! The linearization as loops over joints: a call of `forward_dynamics_derivatives`, then the computation of
//! the affine remainder.

use super::Arrays;
use super::unroll::numbered;
use super::writer::Writer;
use crate::layout::{Dimension, Extent};
use crate::program::{Operand, Operation, Output, Program, Shape};

/// The linearization `ÿ = A_y y + A_v ẏ + B_x u + c`: all matrices and c are computed from the results of
/// `forward_dynamics_derivatives`.
#[derive(Debug, Clone, PartialEq)]
pub struct Affine {
    /// Name of the function whose results the linearization uses.
    pub name: &'static str,
    /// The function whose results the linearization uses, as loops over joints. Its results are the
    /// accelerations ÿ, ∂ÿ/∂y, ∂ÿ/∂ẏ and the inverse mass matrix.
    pub called: Arrays,
    /// For each input, the coordinates on which the input acts, each with its gain. A gain is a constant or a
    /// parameter.
    pub inputs: Vec<Vec<(usize, Operand)>>,
    /// Entries of the matrix D in `δ̇ = D δ + v − v̄` for positions with quaternions; otherwise `None`. δ is
    /// the deviation from a motion with the velocities v̄. With this matrix, the affine remainder `c` of the
    /// linearization has no term of y.
    pub drift: Option<Vec<Drift>>,
}

/// An entry of the matrix D in `δ̇ = D δ + v − v̄`. δ is the deviation from a motion with the velocities v̄.
/// The entry is a velocity or the negative of a velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drift {
    /// Row of the entry in the matrix.
    pub row: usize,
    /// Column of the entry in the matrix.
    pub column: usize,
    /// Index of the velocity that is the entry, up to its sign.
    pub velocity: usize,
    /// Whether the entry is the negative of the velocity.
    pub is_negative: bool,
}

impl Affine {
    /// Converts the linearization `ÿ = A_y y + A_v ẏ + B_x u + c` to the equivalent straight-line program.
    ///
    /// Column j of `B_x` is the sum of the columns of M⁻¹ for the coordinates on which input j acts, each
    /// times its gain. The remainder is `c = ÿ − ((A_y y + A_v ẏ) + B_x u)`, or `c = ÿ − (A_v ẏ + B_x u)`
    /// with quaternions. It is computed row by row. Each dot product has four partial sums.
    #[must_use]
    pub fn unrolled(&self) -> Program {
        let Program { inputs, instructions, outputs } = self.called.unrolled();
        let n = self.called.coordinates().len();
        let mut writer = Writer { instructions, is_fused: self.called.is_fused };
        let [accelerations, by_y, by_v, inverse] = [0, 1, 2, 3].map(|k| outputs[k].entries.clone());
        let mut by_inputs = Vec::with_capacity(n * self.inputs.len());
        for row in inverse.chunks(n) {
            by_inputs.extend(self.inputs.iter().map(|gains| writer.gained(row, gains)));
        }
        let m = self.inputs.len();
        let remainder: Vec<Operand> = (0..n)
            .map(|i| {
                let is_counted = self.drift.is_none();
                let by_y = is_counted.then(|| writer.dot(&by_y[i * n..(i + 1) * n], 0));
                let by_v = writer.dot(&by_v[i * n..(i + 1) * n], 1);
                let by_u = writer.dot(&by_inputs[i * m..(i + 1) * m], 2);
                let sum = by_y.map_or(by_v, |by_y| writer.push(Operation::Add(by_y, by_v)));
                let sum = writer.push(Operation::Add(sum, by_u));
                writer.push(Operation::Subtract(accelerations[i], sum))
            })
            .collect();
        let drift = self.drift.as_ref().map(|drift| writer.drift(drift, n));
        let output = |name: &str, shape, entries| Output { name: name.to_owned(), shape, entries };
        let (each, input) = (Extent::new(Dimension::Velocities, n), Extent::new(Dimension::Inputs, m));
        let mut outputs = vec![
            output("A_y", Shape::Matrix(each, each), by_y),
            output("A_v", Shape::Matrix(each, each), by_v),
            output("B_x", Shape::Matrix(each, input), by_inputs),
            output("c", Shape::Vector(each), remainder),
        ];
        outputs.extend(drift.map(|drift| output("D", Shape::Matrix(each, each), drift)));
        numbered(Program { inputs, instructions: writer.instructions, outputs })
    }
}

impl Writer {
    /// All entries of the matrix D in `δ̇ = D δ + v − v̄`, row-major.
    fn drift(&mut self, entries: &[Drift], n: usize) -> Vec<Operand> {
        let mut matrix = vec![Operand::Constant(0.0); n * n];
        for entry in entries {
            let velocity = Operand::Input(1, entry.velocity);
            matrix[entry.row * n + entry.column] = match entry.is_negative {
                true => self.push(Operation::Negate(velocity)),
                false => velocity,
            };
        }
        matrix
    }

    /// Sum of the entries of a row times their gains, without fused operations.
    fn gained(&mut self, row: &[Operand], gains: &[(usize, Operand)]) -> Operand {
        let mut sum = None;
        for &(coordinate, gain) in gains {
            let term = match gain {
                Operand::Constant(1.0) => row[coordinate],
                gain => self.push(Operation::Multiply(row[coordinate], gain)),
            };
            sum = Some(match sum {
                None => term,
                Some(sum) => self.push(Operation::Add(sum, term)),
            });
        }
        sum.unwrap_or(Operand::Constant(0.0))
    }

    /// Dot product of a row and an input array. Its terms are added to four partial sums, which start at 0:
    /// term k to partial sum k mod 4.
    fn dot(&mut self, row: &[Operand], array: usize) -> Operand {
        let mut sums = [Operand::Constant(0.0); 4];
        for (k, &entry) in row.iter().enumerate() {
            sums[k % 4] = self.add_product(sums[k % 4], entry, Operand::Input(array, k));
        }
        let first = self.push(Operation::Add(sums[0], sums[1]));
        let second = self.push(Operation::Add(sums[2], sums[3]));
        self.push(Operation::Add(first, second))
    }
}
