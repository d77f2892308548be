//! A list of a graph's nodes without the graph, for types that store scalars.

use std::fmt;

use super::build::Graph;
use super::node::{Edge, Node};
use super::scalar::Scalar;

/// The nodes of a graph in the order of their creation.
///
/// Intermediate nodes are included, so a graph with copies of all nodes equals the original graph. This
/// matters because the order of nodes determines the order of operands in generated text.
#[derive(Clone, PartialEq, Eq)]
pub struct Nodes(Vec<Node>);

impl Graph {
    /// All nodes that the graph has so far.
    pub fn to_nodes(&self) -> Nodes {
        Nodes((0..self.len()).map(|index| self.node(Edge::plus(index))).collect())
    }

    /// Copies the nodes of another graph. Returns the scalar of each node, in the same order.
    pub fn copied(&self, nodes: &Nodes) -> Vec<Scalar<'_>> {
        let mut copies: Vec<Scalar<'_>> = Vec::with_capacity(nodes.0.len());
        for &node in &nodes.0 {
            copies.push(self.rebuilt(node, |operand| operand.signed(&copies)));
        }
        copies
    }

    /// Adds a node with other operands. Constants are folded again.
    pub(super) fn rebuilt<'g>(&'g self, node: Node, operand: impl Fn(Edge) -> Scalar<'g>) -> Scalar<'g> {
        match node {
            Node::Constant(bits) => self.constant(f64::from_bits(bits)),
            Node::Input(array, index) => self.input(array as usize, index as usize),
            Node::Parameter(index) => self.parameter(index as usize),
            Node::Sum(a, b) => operand(a) + operand(b),
            Node::Product(a, b) => operand(a) * operand(b),
            Node::Quotient(a, b) => operand(a).divided_by(operand(b)),
            Node::Call(function, a) => operand(a).call(function),
        }
    }
}

impl Edge {
    /// The scalar to which the edge refers, with its sign. `nodes` contains the scalars of all nodes.
    pub fn signed<'g>(self, nodes: &[Scalar<'g>]) -> Scalar<'g> {
        let node = nodes[self.index()];
        if self.is_negative() { -node } else { node }
    }
}

/// Shows parameters and formulas by their node numbers. Constants are shown inside the formulas.
impl fmt::Debug for Nodes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let operand = |edge: Edge| {
            let sign = if edge.is_negative() { "-" } else { "" };
            match self.0[edge.index()] {
                Node::Constant(bits) => format!("{sign}{}", f64::from_bits(bits)),
                Node::Parameter(index) => format!("{sign}p{index}"),
                _ => format!("{sign}#{}", edge.index()),
            }
        };
        let text = |node: &Node| match *node {
            Node::Constant(_) | Node::Input(..) => None,
            Node::Parameter(index) => Some(format!("p{index}")),
            Node::Sum(a, b) => Some(format!("{} + {}", operand(a), operand(b))),
            Node::Product(a, b) => Some(format!("{} * {}", operand(a), operand(b))),
            Node::Quotient(a, b) => Some(format!("{} / {}", operand(a), operand(b))),
            Node::Call(function, a) => Some(format!("{function:?}({})", operand(a))),
        };
        let formulas = self.0.iter().enumerate().filter_map(|(k, node)| Some((k, text(node)?)));
        f.debug_map().entries(formulas).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gelenk_formula::Function;

    /// Operands of both orders, a folded sum, a difference and a node that nothing needs.
    fn built(graph: &Graph) -> [Scalar<'_>; 4] {
        let (p, q) = (graph.parameter(0), graph.parameter(1));
        let unused = p * 7.0 + q;
        let product = (q - p) * (unused.call(Function::Sin) - p * 2.5);
        [product, -product.divided_by(q), p + graph.constant(0.5), (p + q) * 0.0 + graph.constant(1.25)]
    }

    /// A graph that has some of the nodes already, in another order.
    fn used() -> Graph {
        let graph = Graph::new();
        _ = graph.constant(2.5) + graph.input(0, 3) * graph.parameter(1);
        _ = graph.parameter(1) - graph.parameter(0);
        graph
    }

    #[test]
    fn copied_nodes_are_those_that_would_have_been_made_there() {
        let own = Graph::new();
        let results = built(&own);
        for new in [Graph::new, used] {
            let (copy, direct) = (new(), new());
            let nodes = copy.copied(&own.to_nodes());
            let copied = results.map(|result| result.edge().signed(&nodes).edge());
            assert_eq!(copied, built(&direct).map(Scalar::edge));
            assert_eq!(copy.to_nodes(), direct.to_nodes());
        }
    }
}
