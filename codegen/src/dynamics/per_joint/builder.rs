//! Builder of array forms.

use crate::graph::{Edge, Graph, Scalar};
use crate::layout::{Dimension, Extent};
use crate::program::arrays::{
    Array, ArrayId, ArrayOutput, Arrays, Coordinates, Map, Over, Pairs, Step, Tree,
};
use crate::program::{GraphOutput, InputArray, Program, Shape, lower, lower_from_leaves};

/// Rows of an array at one joint.
pub(super) type Rows<'g> = [Scalar<'g>];

/// An array form under construction.
pub(super) struct ArrayBuilder {
    form: Arrays,
    /// Rows that the setup computes.
    set_up: Vec<GraphOutput>,
}

impl ArrayBuilder {
    /// - `coordinates`: how the joints follow coordinates; `None` if each joint is a coordinate
    /// - `chains`: velocities of each joint with a quaternion
    pub(super) fn new(joints: Tree, coordinates: Option<Coordinates>, chains: Vec<Vec<usize>>) -> Self {
        Self {
            form: Arrays {
                setup: Program { inputs: Vec::new(), instructions: Vec::new(), outputs: Vec::new() },
                arrays: Vec::new(),
                steps: Vec::new(),
                outputs: Vec::new(),
                joints,
                coordinates,
                chains,
                is_fused: false,
            },
            set_up: Vec::new(),
        }
    }

    /// Extent with an entry per coordinate.
    pub(super) fn each_coordinate(&self) -> Extent {
        Extent::new(Dimension::Velocities, self.form.coordinates().len())
    }

    /// An entry for each joint.
    fn each_joint(&self) -> Extent {
        match self.form.coordinates {
            None => self.each_coordinate(),
            Some(_) => Extent::fixed(self.form.joints.len()),
        }
    }

    fn array_over(&mut self, over: Over, name: &str, rows: usize) -> ArrayId {
        self.form.arrays.push(Array { name: name.to_owned(), rows, over });
        self.form.arrays.len() - 1
    }

    /// An array over joints.
    fn array(&mut self, name: &str, rows: usize) -> ArrayId {
        self.array_over(Over::Joints, name, rows)
    }

    /// An array over coordinates.
    fn of_coordinates(&mut self, name: &str, rows: usize) -> ArrayId {
        let over = if self.form.coordinates.is_some() { Over::Coordinates } else { Over::Joints };
        self.array_over(over, name, rows)
    }

    /// A square matrix over coordinates.
    fn matrix(&mut self, name: &str) -> ArrayId {
        self.of_coordinates(name, self.form.coordinates().len())
    }

    /// Computes rows over joints by straight-line code before all steps.
    pub(super) fn set_up(&mut self, name: &str, rows: Vec<Vec<Scalar<'_>>>) -> ArrayId {
        self.set_up.push(GraphOutput {
            name: name.to_owned(),
            shape: Shape::Matrix(Extent::fixed(rows.len()), self.each_joint()),
            entries: rows.concat().iter().map(|x| x.edge()).collect(),
        });
        self.array(name, rows.len())
    }

    /// Computes a matrix over coordinates by straight-line code, if each joint is a coordinate.
    pub(super) fn set_up_matrix(&mut self, name: &str, matrix: Vec<Vec<Scalar<'_>>>) -> ArrayId {
        let array = self.set_up(name, matrix);
        let n = self.each_coordinate();
        self.set_up.last_mut().into_iter().for_each(|output| output.shape = Shape::Matrix(n, n));
        array
    }

    /// Computes rows for each joint by the same code.
    pub(super) fn map<const R: usize, const W: usize>(
        &mut self,
        name: &str,
        about: &str,
        reads: &[ArrayId; R],
        writes: [(&str, usize); W],
        build: impl for<'g> FnOnce([&Rows<'g>; R]) -> [Vec<Scalar<'g>>; W],
    ) -> [ArrayId; W] {
        let graph = Graph::new();
        let inputs = reads.map(|array| InputArray {
            name: self.form.arrays[array].name.clone(),
            extent: Extent::fixed(self.form.arrays[array].rows),
        });
        let rows: [Vec<Scalar<'_>>; R] = core::array::from_fn(|array| {
            let rows = 0..inputs[array].extent.len;
            rows.map(|row| graph.input(array, row)).collect()
        });
        let outputs: Vec<GraphOutput> = build(rows.each_ref().map(Vec::as_slice))
            .iter()
            .zip(writes)
            .map(|(entries, (name, _))| GraphOutput {
                name: name.to_owned(),
                shape: Shape::Vector(Extent::fixed(entries.len())),
                entries: entries.iter().map(|x| x.edge()).collect::<Vec<Edge>>(),
            })
            .collect();
        let body = lower(&graph, inputs.into(), &outputs);
        let written = writes.map(|(name, rows)| self.array(name, rows));
        self.form.steps.push(Step::Map(Map {
            name: name.to_owned(),
            about: about.to_owned(),
            reads: reads.to_vec(),
            writes: written.to_vec(),
            body,
        }));
        written
    }

    /// Sums along the paths to the base.
    pub(super) fn sum_ancestors(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::SumAncestors { from, to });
        to
    }

    /// Sums over subtrees.
    pub(super) fn sum_subtrees(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::SumSubtrees { from, to });
        to
    }

    /// A matrix over pairs of joints.
    pub(super) fn pairs(
        &mut self,
        before: (ArrayId, ArrayId),
        beyond: (ArrayId, ArrayId),
        diagonal: ArrayId,
        name: &str,
    ) -> ArrayId {
        let to = self.array(name, self.form.joints.len());
        self.form.steps.push(Step::Pairs(Pairs { before, beyond, diagonal, to }));
        to
    }

    /// Sums an array over joints to an array over coordinates; returns the array itself if each joint is a
    /// coordinate.
    pub(super) fn collect(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if self.form.coordinates.is_none() {
            return from;
        }
        let to = self.of_coordinates(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::Collect { from, to });
        to
    }

    /// Sums a matrix over pairs of joints to a matrix over pairs of coordinates.
    pub(super) fn project(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if self.form.coordinates.is_none() {
            return from;
        }
        let to = self.matrix(name);
        self.form.steps.push(Step::Project { from, to });
        to
    }

    /// Expands an array over coordinates to an array over joints.
    pub(super) fn spread(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if self.form.coordinates.is_none() {
            return from;
        }
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::Spread { from, to });
        to
    }

    /// Whether joints have quaternions.
    pub(super) fn has_quaternions(&self) -> bool {
        !self.form.chains.is_empty()
    }

    /// Copies to each joint the entry of its carrier joint; zero at the base.
    pub(super) fn gather_carriers(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::GatherCarriers { from, to });
        to
    }

    /// Copies the value of each joint's last velocity to all velocities of the joint. Returns the array itself for
    /// robots without quaternions.
    pub(super) fn gather_last(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if !self.has_quaternions() {
            return from;
        }
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::GatherLast { from, to });
        to
    }

    /// `matrix − other`; `other` must have exactly one row per coordinate.
    pub(super) fn subtract(&mut self, matrix: ArrayId, other: ArrayId, [step, name]: [&str; 2]) -> ArrayId {
        let (rows, n) = (self.form.joints.len(), self.form.coordinates().len());
        let about = format!("Subtracts `{}`.", self.form.arrays[other].name);
        let [difference] = self.map(step, &about, &[matrix, other], [(name, rows)], |[matrix, other]| {
            let difference = matrix[..n].iter().zip(other).map(|(&a, &b)| a - b);
            [difference.chain(matrix[n..].iter().copied()).collect()]
        });
        difference
    }

    /// Inverse of a matrix with the zeros of a mass matrix.
    pub(super) fn invert(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.matrix(name);
        self.form.steps.push(Step::Invert { from, to });
        to
    }

    /// `−left · right`
    pub(super) fn negative_product(&mut self, left: ArrayId, right: ArrayId, name: &str) -> ArrayId {
        let to = self.matrix(name);
        self.form.steps.push(Step::NegativeProduct { left, right, to });
        to
    }

    /// Product of a symmetric matrix and a vector.
    pub(super) fn apply(&mut self, matrix: ArrayId, vector: ArrayId, name: &str) -> ArrayId {
        let to = self.of_coordinates(name, 1);
        self.form.steps.push(Step::Apply { matrix, vector, to });
        to
    }

    /// Declares an array as a result.
    pub(super) fn output(&mut self, name: &str, shape: Shape, array: ArrayId) {
        self.form.outputs.push(ArrayOutput { name: name.to_owned(), shape, array });
    }

    /// Finishes the array form; lowers the setup from the graph of its scalars.
    pub(super) fn finish(self, graph: &Graph, inputs: Vec<InputArray>) -> Arrays {
        Arrays { setup: lower(graph, inputs, &self.set_up), ..self.form }
    }

    /// Finishes an array form with a long setup; values of a branch are computed together.
    pub(super) fn finish_from_leaves(self, graph: &Graph, inputs: Vec<InputArray>) -> Arrays {
        Arrays { setup: lower_from_leaves(graph, inputs, &self.set_up), ..self.form }
    }
}
