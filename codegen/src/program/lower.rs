//! Converts results of a graph to a straight-line program: determines order, signs and names.
//!
//! In the program, every value is defined once, before its first use and with a unique name. Unused values
//! are not computed. A negation remains only if neither a subtraction nor the sign of a product can replace
//! it. Sine and cosine of an angle are computed together.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::angles::angles_first;
use super::doubling::add_instead_of_doubling;
use super::{InputArray, Instruction, Operand, Operation, Output, Program, Shape};
use crate::distinct::Distinct;
use crate::graph::{Edge, Graph, Node, balanced};
use crate::layout::{Dimension, Extent};
use gelenk_formula::Function;

/// A result of a function: name, shape, and entries as nodes of the graph, row-major.
#[derive(Debug, Clone)]
pub struct GraphOutput {
    /// Name of the result for documentation.
    pub name: String,
    /// Shape of the result: number, vector or matrix.
    pub shape: Shape,
    /// Entries of the result as signed references to nodes, row-major.
    pub entries: Vec<Edge>,
}

/// Converts the outputs of a graph to the straight-line program that computes them.
pub fn lower(graph: &Graph, inputs: Vec<InputArray>, outputs: &[GraphOutput]) -> Program {
    lowered(graph, inputs, outputs, |results| results.to_vec())
}

/// Converts results like [`lower`], but for a tree with several branches.
///
/// If there are many values, results are computed from the last velocity to the first. A leaf of the tree
/// depends only on its own branch. In this order, the values of a branch are computed together and used while
/// they are in registers. The times relative to the usual order are 0.8 for the Jacobians of a quadruped's
/// inverse dynamics, and 0.7 to 0.8 for the mass matrix and inverse dynamics of a humanoid.
///
/// Functions with divisions, for example the forward dynamics, keep the usual order. In these functions each
/// value waits for the previous one, so computing branches in parallel is faster.
pub fn lower_branches(graph: &Graph, inputs: Vec<InputArray>, outputs: &[GraphOutput]) -> Program {
    lowered(graph, inputs, outputs, |results| {
        let reachable = graph.reachable(results);
        let divides = |edge: &Edge| matches!(graph.node(*edge), Node::Quotient(..));
        match reachable.len() < MANY_VALUES || reachable.iter().any(divides) {
            true => results.to_vec(),
            false => from_leaves(outputs, results),
        }
    })
}

/// Converts results like [`lower`], but computes them from the last velocity to the first.
pub fn lower_from_leaves(graph: &Graph, inputs: Vec<InputArray>, outputs: &[GraphOutput]) -> Program {
    lowered(graph, inputs, outputs, |results| from_leaves(outputs, results))
}

/// Least number of values in a program for which the order of computation matters. Shorter programs are fast
/// in any order.
const MANY_VALUES: usize = 300;

fn lowered(
    graph: &Graph,
    inputs: Vec<InputArray>,
    outputs: &[GraphOutput],
    order: impl Fn(&[Edge]) -> Vec<Edge>,
) -> Program {
    let results: Vec<Edge> = outputs.iter().flat_map(|output| output.entries.iter().copied()).collect();
    let results = balanced(graph, &results);
    let mut lowering = Lowering::new(graph, &results);
    for edge in order(&results) {
        lowering.visit(edge);
    }
    let mut entries = results.iter();
    let outputs = outputs.iter().map(|output| Output {
        name: output.name.clone(),
        shape: output.shape,
        entries: entries.by_ref().take(output.entries.len()).map(|&edge| lowering.signed(edge)).collect(),
    });
    let outputs = outputs.collect();
    let mut program = angles_first(Program { inputs, instructions: lowering.instructions, outputs });
    add_instead_of_doubling(&mut program);
    give_names(&mut program);
    program
}

/// Orders the results from the last velocity to the first.
fn from_leaves(outputs: &[GraphOutput], results: &[Edge]) -> Vec<Edge> {
    let entries = outputs.iter().flat_map(|output| (0..output.entries.len()).map(|k| (output.shape, k)));
    let mut ordered: Vec<_> =
        entries.map(|(shape, entry)| last_velocity(shape, entry)).zip(results).collect();
    ordered.sort_by_key(|(velocity, _)| Reverse(*velocity));
    ordered.into_iter().map(|(_, &edge)| edge).collect()
}

/// The last velocity that belongs to an entry of a result, by the entry's row or column; 0 if neither
/// dimension is by velocities.
fn last_velocity(shape: Shape, entry: usize) -> usize {
    let of = |extent: Extent, index| if extent.dimension == Dimension::Velocities { index } else { 0 };
    match shape {
        Shape::Scalar => 0,
        Shape::Vector(extent) => of(extent, entry),
        Shape::Matrix(rows, columns) => {
            let width = columns.len.max(1);
            of(rows, entry / width).max(of(columns, entry % width))
        }
    }
}

/// Gives all values of a program unique names. Values without a suggested name get numbers.
pub(super) fn give_names(program: &mut Program) {
    let inputs = program.inputs.iter().map(|input| input.name.clone());
    let mut taken: Distinct = inputs.chain(["p".to_owned()]).collect();
    for (index, instruction) in program.instructions.iter_mut().enumerate() {
        instruction.name = match instruction.name.as_str() {
            "" => taken.take(&format!("t{index}")),
            label => taken.take(label),
        };
    }
}

struct Lowering<'g> {
    graph: &'g Graph,
    instructions: Vec<Instruction>,
    /// Value of each node of the graph; `None` before its computation.
    values: Vec<Option<Operand>>,
    /// Negated value of each node; `None` if no operation needed it.
    negatives: Vec<Option<Operand>>,
    /// For each angle, its sine and cosine if they are needed.
    angles: BTreeMap<Edge, [Option<Edge>; 2]>,
    /// Length of the longest chain of operations that leads to each node of the graph.
    height: Vec<u32>,
}

impl<'g> Lowering<'g> {
    fn new(graph: &'g Graph, results: &[Edge]) -> Self {
        let reachable = graph.reachable(results);
        let mut height = vec![0; graph.len()];
        let mut angles: BTreeMap<Edge, [Option<Edge>; 2]> = BTreeMap::new();
        for &edge in &reachable {
            let node = graph.node(edge);
            height[edge.index()] =
                node.operands().map(|operand| height[operand.index()] + 1).max().unwrap_or(0);
            match node {
                Node::Call(Function::Sin, angle) => angles.entry(angle).or_default()[0] = Some(edge),
                Node::Call(Function::Cos, angle) => angles.entry(angle).or_default()[1] = Some(edge),
                _ => {}
            }
        }
        Self {
            graph,
            instructions: Vec::with_capacity(reachable.len()),
            values: vec![None; graph.len()],
            negatives: vec![None; graph.len()],
            angles,
            height,
        }
    }

    /// Computes a node and its operands. The operand with the longest chain of operations is first, so that
    /// values are used soon.
    fn visit(&mut self, root: Edge) {
        let mut pending = vec![(root.abs(), false)];
        while let Some((edge, ready)) = pending.pop() {
            if self.values[edge.index()].is_some() {
                continue;
            }
            let node = self.graph.node(edge);
            if ready {
                self.compute(edge, node);
                continue;
            }
            pending.push((edge, true));
            let mut operands: Vec<_> = node.operands().map(Edge::abs).collect();
            operands.sort_by_key(|operand| self.height[operand.index()]);
            pending.extend(operands.into_iter().map(|operand| (operand, false)));
        }
    }

    fn compute(&mut self, edge: Edge, node: Node) {
        let value = match node {
            Node::Constant(bits) => Operand::Constant(f64::from_bits(bits)),
            Node::Input(array, index) => Operand::Input(array as usize, index as usize),
            Node::Parameter(index) => Operand::Parameter(index as usize),
            Node::Call(Function::Sin | Function::Cos, angle) => {
                return self.sine_and_cosine(angle);
            }
            Node::Sum(a, b) if b.is_negative() => {
                let operation = Operation::Subtract(self.signed(a), self.signed(b.abs()));
                self.define(edge, operation)
            }
            Node::Sum(a, b) => {
                let operation = Operation::Add(self.signed(a), self.signed(b));
                self.define(edge, operation)
            }
            Node::Product(a, b) => {
                let operation = Operation::Multiply(self.signed(a), self.signed(b));
                self.define(edge, operation)
            }
            Node::Quotient(a, b) => {
                let operation = Operation::Divide(self.signed(a), self.signed(b));
                self.define(edge, operation)
            }
            Node::Call(function, a) => {
                let operation = Operation::Call(function, self.signed(a));
                self.define(edge, operation)
            }
        };
        self.values[edge.index()] = Some(value);
    }

    /// Computes sine and cosine together, because one call costs as much as one of them.
    fn sine_and_cosine(&mut self, angle: Edge) {
        let operand = self.signed(angle);
        let pair = self.instructions.len();
        let [sine, cosine] = self.angles.get(&angle).copied().unwrap_or_default();
        let label = sine.and_then(|sine| self.graph.label_of(sine));
        let value = self.push(label, Operation::SinCos(operand));
        if let Some(sine) = sine {
            self.values[sine.index()] = Some(value);
        }
        if let Some(cosine) = cosine {
            let value = self.define(cosine, Operation::CosineOf(pair));
            self.values[cosine.index()] = Some(value);
        }
    }

    /// The operand for a signed reference to a node. A negation is inserted if no operation can include the
    /// sign.
    fn signed(&mut self, edge: Edge) -> Operand {
        #[expect(clippy::expect_used, reason = "operands are visited before their users")]
        let value = self.values[edge.index()].expect("operands stand before their users");
        if !edge.is_negative() {
            return value;
        }
        if let Operand::Constant(constant) = value {
            return Operand::Constant(-constant);
        }
        if let Some(negative) = self.negatives[edge.index()] {
            return negative;
        }
        let name = self.graph.label_of(edge).map(|label| format!("minus_{label}"));
        let negative = self.push(name, Operation::Negate(value));
        self.negatives[edge.index()] = Some(negative);
        negative
    }

    fn define(&mut self, edge: Edge, operation: Operation) -> Operand {
        self.push(self.graph.label_of(edge), operation)
    }

    /// Appends an instruction to the program. Its suggested name is kept until names are made unique.
    fn push(&mut self, label: Option<String>, operation: Operation) -> Operand {
        let index = self.instructions.len();
        self.instructions.push(Instruction { name: label.unwrap_or_default(), operation });
        Operand::Value(index)
    }
}
