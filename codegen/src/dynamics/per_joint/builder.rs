//! Builder of functions in array form: straight-line code (the setup) followed by loops over joints (the
//! steps). An array has one column per joint or coordinate, and one or more rows.

use crate::graph::{Edge, Graph, Scalar};
use crate::layout::{Dimension, Extent};
use crate::program::arrays::{
    Array, ArrayId, ArrayOutput, Arrays, Coordinates, Map, Over, Pairs, Step, Tree,
};
use crate::program::{GraphOutput, InputArray, Program, Shape, lower, lower_from_leaves};

/// The values of an array at one joint, one for each row.
pub(super) type Rows<'g> = [Scalar<'g>];

/// A function with loops over joints (array form) under construction: straight-line code, then loops.
pub(super) struct ArrayBuilder {
    form: Arrays,
    /// Arrays that the straight-line code before the loops computes.
    set_up: Vec<GraphOutput>,
}

impl ArrayBuilder {
    /// Starts a function with loops over joints, without arrays and loops.
    ///
    /// - `joints`: tree of the joints
    /// - `coordinates`: coordinates that the joints follow; `None` if each joint is independent
    /// - `chains`: for each joint with a quaternion, the joints of the loops that are its velocities
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

    /// Length and meaning of an array with one entry per coordinate.
    pub(super) fn each_coordinate(&self) -> Extent {
        Extent::new(Dimension::Velocities, self.form.coordinates().len())
    }

    /// Length and meaning of an array with one entry per joint of the loops.
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

    /// Declares an array with `rows` values per joint.
    fn array(&mut self, name: &str, rows: usize) -> ArrayId {
        self.array_over(Over::Joints, name, rows)
    }

    /// Declares an array with `rows` values per coordinate.
    fn of_coordinates(&mut self, name: &str, rows: usize) -> ArrayId {
        let over = if self.form.coordinates.is_some() { Over::Coordinates } else { Over::Joints };
        self.array_over(over, name, rows)
    }

    /// Declares a square matrix over coordinates.
    fn matrix(&mut self, name: &str) -> ArrayId {
        self.of_coordinates(name, self.form.coordinates().len())
    }

    /// Computes an array with values per joint in the straight-line code before the loops.
    pub(super) fn set_up(&mut self, name: &str, rows: Vec<Vec<Scalar<'_>>>) -> ArrayId {
        self.set_up.push(GraphOutput {
            name: name.to_owned(),
            shape: Shape::Matrix(Extent::fixed(rows.len()), self.each_joint()),
            entries: rows.concat().iter().map(|x| x.edge()).collect(),
        });
        self.array(name, rows.len())
    }

    /// Computes a matrix over coordinates in the straight-line code before the loops. Each joint must be
    /// independent.
    pub(super) fn set_up_matrix(&mut self, name: &str, matrix: Vec<Vec<Scalar<'_>>>) -> ArrayId {
        let array = self.set_up(name, matrix);
        let n = self.each_coordinate();
        self.set_up.last_mut().into_iter().for_each(|output| output.shape = Shape::Matrix(n, n));
        array
    }

    /// Adds a loop (step) that computes arrays with the same code at each joint. `build` computes the values
    /// of the arrays `writes` at a joint from the values of the arrays `reads` at this joint.
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

    /// Adds a loop (step) that sums an array along the path from the base to each joint.
    pub(super) fn sum_ancestors(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::SumAncestors { from, to });
        to
    }

    /// Adds a loop (step) that sums an array over the subtree of each joint.
    pub(super) fn sum_subtrees(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::SumSubtrees { from, to });
        to
    }

    /// Adds a loop (step) that computes a matrix over pairs of joints. [`Pairs`] defines the entries as
    /// products of columns.
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

    /// Adds a loop (step) that sums an array over joints to an array over coordinates. Returns the array
    /// itself if each joint is independent.
    pub(super) fn collect(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if self.form.coordinates.is_none() {
            return from;
        }
        let to = self.of_coordinates(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::Collect { from, to });
        to
    }

    /// Adds a loop (step) that sums a matrix over pairs of joints to a matrix over pairs of coordinates.
    /// Returns the matrix itself if each joint is independent.
    pub(super) fn project(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if self.form.coordinates.is_none() {
            return from;
        }
        let to = self.matrix(name);
        self.form.steps.push(Step::Project { from, to });
        to
    }

    /// Adds a loop (step) that copies an array over coordinates to an array over joints. Returns the array
    /// itself if each joint is independent.
    pub(super) fn spread(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if self.form.coordinates.is_none() {
            return from;
        }
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::Spread { from, to });
        to
    }

    /// Whether the robot has joints with quaternions.
    pub(super) fn has_quaternions(&self) -> bool {
        !self.form.chains.is_empty()
    }

    /// Adds a loop (step) that copies to each joint the values of the joint that carries it. Joints on the
    /// base get zeros.
    pub(super) fn gather_carriers(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::GatherCarriers { from, to });
        to
    }

    /// Adds a loop (step) that copies values from the last velocity of each joint with a quaternion to all
    /// velocities of this joint. Returns the array itself for robots without quaternions.
    pub(super) fn gather_last(&mut self, from: ArrayId, name: &str) -> ArrayId {
        if !self.has_quaternions() {
            return from;
        }
        let to = self.array(name, self.form.arrays[from].rows);
        self.form.steps.push(Step::GatherLast { from, to });
        to
    }

    /// Adds a loop (step) that computes `matrix − other`. `other` must have exactly one row per coordinate.
    pub(super) fn subtract(&mut self, matrix: ArrayId, other: ArrayId, [step, name]: [&str; 2]) -> ArrayId {
        let (rows, n) = (self.form.joints.len(), self.form.coordinates().len());
        let about = format!("Subtracts `{}`.", self.form.arrays[other].name);
        let [difference] = self.map(step, &about, &[matrix, other], [(name, rows)], |[matrix, other]| {
            let difference = matrix[..n].iter().zip(other).map(|(&a, &b)| a - b);
            [difference.chain(matrix[n..].iter().copied()).collect()]
        });
        difference
    }

    /// Adds a loop (step) that inverts a matrix over coordinates. The matrix must have the same zeros as the
    /// mass matrix.
    pub(super) fn invert(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.matrix(name);
        self.form.steps.push(Step::Invert { from, to });
        to
    }

    /// Adds a loop (step) that computes the product `−left · right` of two matrices over coordinates.
    pub(super) fn negative_product(&mut self, left: ArrayId, right: ArrayId, name: &str) -> ArrayId {
        let to = self.matrix(name);
        self.form.steps.push(Step::NegativeProduct { left, right, to });
        to
    }

    /// Adds a loop (step) that multiplies a symmetric matrix and a vector over coordinates.
    pub(super) fn apply(&mut self, matrix: ArrayId, vector: ArrayId, name: &str) -> ArrayId {
        let to = self.of_coordinates(name, 1);
        self.form.steps.push(Step::Apply { matrix, vector, to });
        to
    }

    /// Declares an array as a result of the function.
    pub(super) fn output(&mut self, name: &str, shape: Shape, array: ArrayId) {
        self.form.outputs.push(ArrayOutput { name: name.to_owned(), shape, array });
    }

    /// Finishes the array form. The expressions before the loops become a straight-line program.
    pub(super) fn finish(self, graph: &Graph, inputs: Vec<InputArray>) -> Arrays {
        Arrays { setup: lower(graph, inputs, &self.set_up), ..self.form }
    }

    /// Finishes an array form with long straight-line code before the loops. This code computes all values of
    /// a branch before the next branch.
    pub(super) fn finish_from_leaves(self, graph: &Graph, inputs: Vec<InputArray>) -> Arrays {
        Arrays { setup: lower_from_leaves(graph, inputs, &self.set_up), ..self.form }
    }
}
