//! Nodes of expression graphs, and the signed references (edges) between nodes.

use gelenk_formula::Function;

/// A signed reference to a node: the value of the node, or its negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Edge(u32);

impl Edge {
    /// The reference to node `index`, without negation.
    pub fn plus(index: usize) -> Self {
        Self((index as u32) << 1)
    }

    /// Index of the node to which the edge refers.
    pub fn index(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether the edge negates the node's value.
    pub fn is_negative(self) -> bool {
        self.0 & 1 == 1
    }

    /// The edge to the same node without negation.
    pub fn abs(self) -> Self {
        Self(self.0 & !1)
    }

    /// The edge with the opposite sign if `negate` is true; otherwise the same edge.
    pub fn negate_if(self, negate: bool) -> Self {
        Self(self.0 ^ u32::from(negate))
    }
}

/// A node of an expression graph. The operands of a node precede it in the graph.
///
/// Nodes are canonical:
///
/// - operands of commutative operations are sorted by index
/// - the first operand of a sum is positive
/// - operands of products, quotients, and odd or even functions are positive
/// - constants are positive
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Node {
    /// Bits of a finite constant ≥ 0.
    Constant(u64),
    /// Entry of an input array: index of the array, then index of the entry.
    Input(u32, u32),
    /// Free parameter: index into `Model::parameters`.
    Parameter(u32),
    /// `a + b`
    Sum(Edge, Edge),
    /// `a · b`
    Product(Edge, Edge),
    /// `a / b`
    Quotient(Edge, Edge),
    /// `f(a)` with an elementary function f, for example `tanh(a)`
    Call(Function, Edge),
}

impl Node {
    /// The operands of the node's operation; empty for constants, inputs and parameters.
    pub fn operands(self) -> impl Iterator<Item = Edge> {
        let (a, b) = match self {
            Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => (None, None),
            Node::Sum(a, b) | Node::Product(a, b) | Node::Quotient(a, b) => (Some(a), Some(b)),
            Node::Call(_, a) => (Some(a), None),
        };
        a.into_iter().chain(b)
    }
}
