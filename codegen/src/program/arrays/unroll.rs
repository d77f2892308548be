//! The array form written out: the straight-line program that it stands for.

use super::writer::Writer;
use super::{Array, Arrays, Map, Pairs, Step};
use crate::program::lower::give_names;
use crate::program::{Operand, Operation, Output, Program};

impl Arrays {
    /// Each operation of the array form as an instruction, in the same order. Padding at the end of rows, and
    /// entries that loops compute and drop, are not part of it.
    #[must_use]
    pub fn unrolled(&self) -> Program {
        let mut unrolling = Unrolling {
            form: self,
            writer: Writer { instructions: self.setup.instructions.clone(), is_fused: self.is_fused },
            values: self.setup.outputs.iter().map(|o| o.entries.clone()).collect(),
        };
        let zeros = |array: &Array| vec![Operand::Constant(0.0); array.rows * self.joints()];
        let made = self.arrays.iter().skip(unrolling.values.len()).map(zeros);
        unrolling.values.extend(made.collect::<Vec<_>>());
        for step in &self.steps {
            unrolling.step(step);
        }
        let outputs = self.outputs.iter().map(|output| Output {
            name: output.name.clone(),
            shape: output.shape,
            entries: unrolling.values[output.array].clone(),
        });
        numbered(Program {
            inputs: self.setup.inputs.clone(),
            outputs: outputs.collect(),
            instructions: unrolling.writer.instructions,
        })
    }
}

/// With unique names.
pub(super) fn numbered(mut program: Program) -> Program {
    give_names(&mut program);
    program
}

struct Unrolling<'a> {
    form: &'a Arrays,
    writer: Writer,
    /// Entries of each array, rows first.
    values: Vec<Vec<Operand>>,
}

impl Unrolling<'_> {
    fn step(&mut self, step: &Step) {
        match step {
            Step::Map(map) => (0..self.form.joints()).for_each(|joint| self.map(map, joint)),
            Step::SumAncestors { from, to } => {
                self.values[*to] = self.values[*from].clone();
                for &joint in &self.form.order {
                    self.add_rows(*to, joint, self.form.parents[joint]);
                }
            }
            Step::SumSubtrees { from, to } => {
                self.values[*to] = self.values[*from].clone();
                for &joint in self.form.order.iter().rev() {
                    if let Some(parent) = self.form.parents[joint] {
                        self.add_rows(*to, parent, Some(joint));
                    }
                }
            }
            Step::Pairs(pairs) => self.pairs(pairs),
            Step::Invert { from, to } => {
                self.values[*to] = self.values[*from].clone();
                for &joint in self.form.order.iter().rev() {
                    self.sweep(*to, joint);
                }
            }
            Step::NegativeProduct { left, right, to } => self.product(*left, *right, *to),
            Step::Apply { matrix, vector, to } => {
                let n = self.form.joints();
                self.values[*to] = (0..n)
                    .map(|j| {
                        let terms: Vec<_> =
                            (0..n).map(|k| (self.at(*vector, 0, k), self.at(*matrix, k, j))).collect();
                        self.writer.sum_of_products(&terms)
                    })
                    .collect();
            }
        }
    }

    fn at(&self, array: usize, row: usize, column: usize) -> Operand {
        self.values[array][row * self.form.joints() + column]
    }

    fn set(&mut self, array: usize, row: usize, column: usize, value: Operand) {
        self.values[array][row * self.form.joints() + column] = value;
    }

    fn map(&mut self, map: &Map, joint: usize) {
        let start = self.writer.instructions.len();
        let place = |values: &[Vec<Operand>], operand: Operand| match operand {
            Operand::Value(index) => Operand::Value(start + index),
            Operand::Input(array, row) => values[map.reads[array]][row * self.form.joints() + joint],
            other => other,
        };
        for instruction in &map.body.instructions {
            let operation = match instruction.operation {
                Operation::CosineOf(pair) => Operation::CosineOf(start + pair),
                operation => operation.map(|operand| place(&self.values, operand)),
            };
            self.writer.push(operation);
        }
        for (output, &array) in map.body.outputs.iter().zip(&map.writes) {
            for (row, &entry) in output.entries.iter().enumerate() {
                let entry = place(&self.values, entry);
                self.set(array, row, joint, entry);
            }
        }
    }

    /// Adds the entries of another joint to those of a joint.
    fn add_rows(&mut self, array: usize, joint: usize, other: Option<usize>) {
        let Some(other) = other else { return };
        for row in 0..self.form.arrays[array].rows {
            let (a, b) = (self.at(array, row, joint), self.at(array, row, other));
            let sum = self.writer.push(Operation::Add(a, b));
            self.set(array, row, joint, sum);
        }
    }

    fn pairs(&mut self, pairs: &Pairs) {
        let n = self.form.joints();
        for i in 0..n {
            for j in 0..n {
                let entry = match () {
                    () if i == j => self.at(pairs.diagonal, 0, i),
                    () if self.form.is_before(j, i) => self.pair(pairs.before, i, j),
                    () if self.form.is_before(i, j) => self.pair(pairs.beyond, i, j),
                    () => Operand::Constant(0.0),
                };
                self.set(pairs.to, i, j, entry);
            }
        }
    }

    fn pair(&mut self, (by_i, by_j): (usize, usize), i: usize, j: usize) -> Operand {
        let terms: Vec<_> = (0..self.form.arrays[by_j].rows)
            .map(|row| (self.at(by_i, row, i), self.at(by_j, row, j)))
            .collect();
        self.writer.sum_of_products(&terms)
    }

    /// One step of Gauss and Jordan.
    fn sweep(&mut self, matrix: usize, k: usize) {
        let n = self.form.joints();
        let pivot = self.at(matrix, k, k);
        let reciprocal = self.writer.push(Operation::Divide(Operand::Constant(1.0), pivot));
        self.set(matrix, k, k, reciprocal);
        for j in (0..n).filter(|&j| j != k) {
            let entry = self.at(matrix, k, j);
            let scaled = self.writer.push(Operation::Multiply(entry, reciprocal));
            self.set(matrix, k, j, scaled);
        }
        for i in (0..n).filter(|&i| self.form.is_before(i, k) || self.form.is_before(k, i)) {
            let entry = self.at(matrix, i, k);
            let factor = self.writer.push(Operation::Negate(entry));
            let moved = self.writer.push(Operation::Multiply(factor, reciprocal));
            self.set(matrix, i, k, moved);
            for j in (0..n).filter(|&j| j != k) {
                let (old, own) = (self.at(matrix, i, j), self.at(matrix, k, j));
                let new = self.writer.add_product(old, factor, own);
                self.set(matrix, i, j, new);
            }
        }
    }

    fn product(&mut self, left: usize, right: usize, to: usize) {
        let n = self.form.joints();
        for i in 0..n {
            let factors: Vec<_> = (0..n)
                .map(|k| {
                    let factor = self.at(left, i, k);
                    self.writer.push(Operation::Negate(factor))
                })
                .collect();
            for j in 0..n {
                let terms: Vec<_> = (0..n).map(|k| (factors[k], self.at(right, k, j))).collect();
                let entry = self.writer.sum_of_products(&terms);
                self.set(to, i, j, entry);
            }
        }
    }
}
