//! Builds array forms step by step.

use crate::graph::{Edge, Graph, Scalar};
use crate::kinematics::{Mechanism, Numbers};
use crate::layout::{Dimension, Extent};
use crate::program::arrays::{Array, ArrayId, ArrayOutput, Arrays, Map, Pairs, Step};
use crate::program::{GraphOutput, InputArray, Program, Shape, lower};

/// Rows of an array at one joint.
pub(super) type Rows<'g> = [Scalar<'g>];

/// An array form in the making.
pub(super) struct ArrayBuilder {
    form: Arrays,
    /// Rows that the setup computes.
    set_up: Vec<GraphOutput>,
}

impl ArrayBuilder {
    /// Over the joints of a mechanism, by coordinate.
    pub(super) fn new<S: Numbers>(mechanism: &Mechanism<S>) -> Self {
        let bodies = &mechanism.bodies;
        let mut parents = vec![None; bodies.len()];
        for body in bodies {
            let parent = body.parent.map(|parent| bodies[parent].joint);
            parents[body.joint] = parent;
        }
        Self {
            form: Arrays {
                setup: Program { inputs: Vec::new(), instructions: Vec::new(), outputs: Vec::new() },
                arrays: Vec::new(),
                steps: Vec::new(),
                outputs: Vec::new(),
                parents,
                order: bodies.iter().map(|body| body.joint).collect(),
                is_fused: false,
            },
            set_up: Vec::new(),
        }
    }

    /// The number of joints.
    pub(super) fn joints(&self) -> usize {
        self.form.joints()
    }

    /// An entry for each joint.
    pub(super) fn each_joint(&self) -> Extent {
        Extent::new(Dimension::Velocities, self.joints())
    }

    fn array(&mut self, name: &str, rows: usize) -> ArrayId {
        self.form.arrays.push(Array { name: name.to_owned(), rows });
        self.form.arrays.len() - 1
    }

    /// Rows from straight-line code; before all steps.
    pub(super) fn set_up(&mut self, name: &str, rows: Vec<Vec<Scalar<'_>>>) -> ArrayId {
        self.set_up.push(GraphOutput {
            name: name.to_owned(),
            shape: Shape::Matrix(Extent::fixed(rows.len()), self.each_joint()),
            entries: rows.concat().iter().map(|x| x.edge()).collect(),
        });
        self.array(name, rows.len())
    }

    /// The same for each joint by itself.
    pub(super) fn map<const R: usize, const W: usize>(
        &mut self,
        (name, about): (&str, &str),
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
        let to = self.array(name, self.joints());
        self.form.steps.push(Step::Pairs(Pairs { before, beyond, diagonal, to }));
        to
    }

    /// The inverse of a matrix with the zeros of a mass matrix.
    pub(super) fn invert(&mut self, from: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.joints());
        self.form.steps.push(Step::Invert { from, to });
        to
    }

    /// `−left · right`
    pub(super) fn negative_product(&mut self, left: ArrayId, right: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, self.joints());
        self.form.steps.push(Step::NegativeProduct { left, right, to });
        to
    }

    /// A symmetric matrix times a vector.
    pub(super) fn apply(&mut self, matrix: ArrayId, vector: ArrayId, name: &str) -> ArrayId {
        let to = self.array(name, 1);
        self.form.steps.push(Step::Apply { matrix, vector, to });
        to
    }

    /// Makes an array a result.
    pub(super) fn output(&mut self, name: &str, shape: Shape, array: ArrayId) {
        self.form.outputs.push(ArrayOutput { name: name.to_owned(), shape, array });
    }

    /// The array form; the setup is lowered from the graph of its scalars.
    pub(super) fn finish(self, graph: &Graph, inputs: Vec<InputArray>) -> Arrays {
        Arrays { setup: lower(graph, inputs, &self.set_up), ..self.form }
    }
}
