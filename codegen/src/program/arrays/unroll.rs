//! Converts loops over joints to the equivalent straight-line program.

use super::writer::Writer;
use super::{Array, Arrays, Coordinates, Map, Pairs, Relation, Step};
use crate::program::lower::give_names;
use crate::program::{Operand, Operation, Output, Program};

impl Arrays {
    /// Returns a program with each operation of the loops as an instruction, in the same order. The program
    /// omits the padding of rows, entries that loops compute and discard, and products with structural zeros
    /// of the tree. Therefore a sum that is −0 in the program may be 0 in the loops.
    #[must_use]
    pub fn unrolled(&self) -> Program {
        let mut unrolling = Unrolling {
            form: self,
            writer: Writer { instructions: self.setup.instructions.clone(), is_fused: self.is_fused },
            values: self.setup.outputs.iter().map(|o| o.entries.clone()).collect(),
        };
        let zeros = |array: &Array| vec![Operand::Constant(0.0); array.rows * self.over(array.over).len()];
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

/// Gives all instructions unique names.
pub(super) fn numbered(mut program: Program) -> Program {
    give_names(&mut program);
    program
}

struct Unrolling<'a> {
    form: &'a Arrays,
    writer: Writer,
    /// Entries of each array, row-major.
    values: Vec<Vec<Operand>>,
}

impl Unrolling<'_> {
    fn step(&mut self, step: &Step) {
        match step {
            Step::Map(map) => (0..self.form.joints.len()).for_each(|joint| self.map(map, joint)),
            Step::SumAncestors { from, to } => {
                self.values[*to] = self.values[*from].clone();
                for &joint in &self.form.joints.order {
                    self.add_rows(*to, joint, self.form.joints.parents[joint]);
                }
            }
            Step::SumSubtrees { from, to } => {
                self.values[*to] = self.values[*from].clone();
                for &joint in self.form.joints.order.iter().rev() {
                    if let Some(parent) = self.form.joints.parents[joint] {
                        self.add_rows(*to, parent, Some(joint));
                    }
                }
            }
            Step::Pairs(pairs) => self.pairs(pairs),
            Step::Collect { from, to } => self.collect(*from, *to),
            Step::Project { from, to } => self.project(*from, *to),
            Step::Spread { from, to } => self.spread(*from, *to),
            Step::GatherCarriers { from, to } => self.gather(*from, *to, &self.form.carriers()),
            Step::GatherLast { from, to } => {
                let last: Vec<_> = self.form.last().into_iter().map(Some).collect();
                self.gather(*from, *to, &last);
            }
            Step::Invert { from, to } => {
                self.values[*to] = self.values[*from].clone();
                for &coordinate in self.form.coordinates().order.iter().rev() {
                    self.sweep(*to, coordinate);
                }
            }
            Step::NegativeProduct { left, right, to } => self.product(*left, *right, *to),
            Step::Apply { matrix, vector, to } => {
                let n = self.form.coordinates().len();
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
        self.values[array][row * self.form.tree(array).len() + column]
    }

    fn set(&mut self, array: usize, row: usize, column: usize, value: Operand) {
        self.values[array][row * self.form.tree(array).len() + column] = value;
    }

    fn map(&mut self, map: &Map, joint: usize) {
        let start = self.writer.instructions.len();
        let place = |values: &[Vec<Operand>], operand: Operand| match operand {
            Operand::Value(index) => Operand::Value(start + index),
            Operand::Input(array, row) => values[map.reads[array]][row * self.form.joints.len() + joint],
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

    /// Adds the array entries of one joint to those of another joint.
    fn add_rows(&mut self, array: usize, joint: usize, other: Option<usize>) {
        let Some(other) = other else { return };
        for row in 0..self.form.arrays[array].rows {
            let (a, b) = (self.at(array, row, joint), self.at(array, row, other));
            let sum = self.writer.push(Operation::Add(a, b));
            self.set(array, row, joint, sum);
        }
    }

    /// Sums, for each coordinate, the entries of the joints that follow it.
    fn collect(&mut self, from: usize, to: usize) {
        for row in 0..self.form.arrays[from].rows {
            let collected = self.collected(|joint| self.at(from, row, joint));
            for (coordinate, entries) in collected.into_iter().enumerate() {
                let sum = self.sum(&entries);
                self.set(to, row, coordinate, sum);
            }
        }
    }

    /// Lists, for each coordinate, the entries of the joints that follow it.
    fn collected(&self, entry: impl Fn(usize) -> Operand) -> Vec<Vec<Operand>> {
        let mut collected: Vec<Vec<Operand>> =
            (0..self.form.coordinates().len()).map(|own| vec![entry(own)]).collect();
        for (joint, coordinate) in self.form.coordinates.iter().flat_map(Coordinates::followers) {
            collected[coordinate].push(entry(joint));
        }
        collected
    }

    fn sum(&mut self, terms: &[Operand]) -> Operand {
        let sum = terms.iter().copied().reduce(|sum, term| self.writer.push(Operation::Add(sum, term)));
        sum.unwrap_or(Operand::Constant(0.0))
    }

    fn project(&mut self, from: usize, to: usize) {
        let (joints, n) = (self.form.joints.len(), self.form.coordinates().len());
        let mut rows: Vec<Vec<Operand>> = vec![Vec::new(); n];
        for column in 0..joints {
            let collected = self.collected(|joint| self.at(from, joint, column));
            for (row, entries) in rows.iter_mut().zip(collected) {
                row.push(self.sum(&entries));
            }
        }
        for (i, row) in rows.iter().enumerate() {
            for (j, entries) in self.collected(|joint| row[joint]).iter().enumerate() {
                let sum = self.sum(entries);
                self.set(to, i, j, sum);
            }
        }
    }

    fn spread(&mut self, from: usize, to: usize) {
        let of_joints = self.form.coordinates.iter().flat_map(|coordinates| &coordinates.of_joints);
        let of_joints: Vec<_> = of_joints.copied().map(Some).collect();
        self.gather(from, to, &of_joints);
    }

    /// Copies `to[·][k] = from[·][sources[k]]`, or sets 0 if the source is `None`.
    fn gather(&mut self, from: usize, to: usize, sources: &[Option<usize>]) {
        for row in 0..self.form.arrays[from].rows {
            for (place, source) in sources.iter().enumerate() {
                let entry = source.map_or(Operand::Constant(0.0), |source| self.at(from, row, source));
                self.set(to, row, place, entry);
            }
        }
    }

    fn pairs(&mut self, pairs: &Pairs) {
        let n = self.form.joints.len();
        for i in 0..n {
            for j in 0..n {
                let entry = match self.form.relation(i, j) {
                    Relation::Same => self.at(pairs.diagonal, 0, i),
                    Relation::Before => self.pair(pairs.before, i, j),
                    Relation::Beyond => self.pair(pairs.beyond, i, j),
                    Relation::Apart => Operand::Constant(0.0),
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

    /// One step of the Gauss–Jordan elimination, with pivot k.
    fn sweep(&mut self, matrix: usize, k: usize) {
        let (n, tree) = (self.form.coordinates().len(), self.form.coordinates());
        let pivot = self.at(matrix, k, k);
        let reciprocal = self.writer.push(Operation::Divide(Operand::Constant(1.0), pivot));
        self.set(matrix, k, k, reciprocal);
        for j in (0..n).filter(|&j| j != k) {
            let entry = self.at(matrix, k, j);
            let scaled = self.writer.push(Operation::Multiply(entry, reciprocal));
            self.set(matrix, k, j, scaled);
        }
        for i in (0..n).filter(|&i| i != k && tree.meet(i, k)) {
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
        let (n, is_over_paths) = (self.form.coordinates().len(), self.form.is_over_paths(right));
        for i in 0..n {
            let factors: Vec<_> = (0..n)
                .map(|k| {
                    let factor = self.at(left, i, k);
                    self.writer.push(Operation::Negate(factor))
                })
                .collect();
            for j in 0..n {
                let tree = self.form.coordinates();
                let met = (0..n).filter(|&k| !is_over_paths || tree.meet(k, j));
                let terms: Vec<_> = met.map(|k| (factors[k], self.at(right, k, j))).collect();
                let entry = self.writer.sum_of_products(&terms);
                self.set(to, i, j, entry);
            }
        }
    }
}
