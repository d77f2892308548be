//! Construction of nodes: equal nodes are shared, constants are folded, and identities remove operations.

use std::cell::RefCell;
use std::collections::BTreeMap;

use indexmap::IndexSet;
use rustc_hash::FxBuildHasher;

use super::node::{Edge, Node};
use gelenk_formula::Function;

/// An expression graph: a growing list of nodes. Equal nodes are stored once. Operands precede the nodes that
/// use them.
#[derive(Debug, Default)]
pub struct Graph {
    nodes: RefCell<IndexSet<Node, FxBuildHasher>>,
    labels: RefCell<BTreeMap<usize, String>>,
}

impl Graph {
    /// Creates a graph without nodes.
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of nodes in the graph.
    pub fn len(&self) -> usize {
        self.nodes.borrow().len()
    }

    /// Whether the graph has no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The node to which an edge (a signed reference) refers.
    pub fn node(&self, edge: Edge) -> Node {
        self.nodes.borrow()[edge.index()]
    }

    /// Value of a constant with the sign of the edge (a signed reference to a node); `None` if the node is
    /// not a constant.
    pub fn value(&self, edge: Edge) -> Option<f64> {
        match self.node(edge) {
            Node::Constant(bits) => {
                let value = f64::from_bits(bits);
                Some(if edge.is_negative() { -value } else { value })
            }
            _ => None,
        }
    }

    /// Suggests a name for a node in generated text. The first suggestion is kept. Constants, inputs and
    /// parameters keep their own names.
    pub fn label(&self, edge: Edge, name: impl FnOnce() -> String) {
        if self.node(edge).operands().next().is_some() {
            self.labels.borrow_mut().entry(edge.index()).or_insert_with(name);
        }
    }

    /// The suggested name of a node; `None` without a suggestion.
    pub fn label_of(&self, edge: Edge) -> Option<String> {
        self.labels.borrow().get(&edge.index()).cloned()
    }

    /// Nodes on which the results depend. Operands precede the nodes that use them.
    pub fn reachable(&self, results: &[Edge]) -> Vec<Edge> {
        let nodes = self.nodes.borrow();
        let mut needed = vec![false; nodes.len()];
        for result in results {
            needed[result.index()] = true;
        }
        for index in (0..nodes.len()).rev() {
            if needed[index] {
                for operand in nodes[index].operands() {
                    needed[operand.index()] = true;
                }
            }
        }
        (0..nodes.len()).filter(|&index| needed[index]).map(Edge::plus).collect()
    }

    pub(super) fn intern(&self, node: Node) -> Edge {
        Edge::plus(self.nodes.borrow_mut().insert_full(node).0)
    }

    /// The constant node for a computed value; `None` if the value overflowed.
    fn folded(&self, value: f64) -> Option<Edge> {
        value.is_finite().then(|| self.constant(value).edge())
    }

    pub(super) fn add(&self, a: Edge, b: Edge) -> Edge {
        self.fold_sum(a, b).unwrap_or_else(|| {
            let (first, second) = if a.index() <= b.index() { (a, b) } else { (b, a) };
            let negative = first.is_negative();
            self.intern(Node::Sum(first.negate_if(negative), second.negate_if(negative))).negate_if(negative)
        })
    }

    fn fold_sum(&self, a: Edge, b: Edge) -> Option<Edge> {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.folded(x + y),
            (Some(0.0), None) => return Some(b),
            (None, Some(0.0)) => return Some(a),
            (Some(x), None) => return self.fold_offset(b, x),
            (None, Some(y)) => return self.fold_offset(a, y),
            (None, None) => {}
        }
        let ((c, x), (d, y)) = (self.scaled(a), self.scaled(b));
        (x == y).then(|| self.mul(self.constant(c + d).edge(), x))
    }

    /// Adds the constant y to a sum that already has a constant c: `(x + c) + y = x + (c + y)`.
    fn fold_offset(&self, sum: Edge, y: f64) -> Option<Edge> {
        let Node::Sum(p, q) = self.node(sum) else {
            return None;
        };
        let (p, q) = (p.negate_if(sum.is_negative()), q.negate_if(sum.is_negative()));
        let (x, c) = match (self.value(p), self.value(q)) {
            (Some(c), _) => (q, c),
            (_, Some(c)) => (p, c),
            _ => return None,
        };
        Some(self.add(x, self.folded(c + y)?))
    }

    /// Splits a product `c · x` into the constant c and the remaining factor x. The sign of the edge is in
    /// the constant.
    pub(super) fn scaled(&self, edge: Edge) -> (f64, Edge) {
        let sign = if edge.is_negative() { -1.0 } else { 1.0 };
        if let Node::Product(a, b) = self.node(edge) {
            if let Some(c) = self.value(a) {
                return (sign * c, b);
            }
            if let Some(c) = self.value(b) {
                return (sign * c, a);
            }
        }
        (sign, edge.abs())
    }

    pub(super) fn mul(&self, a: Edge, b: Edge) -> Edge {
        let negative = a.is_negative() != b.is_negative();
        let (a, b) = (a.abs(), b.abs());
        self.fold_product(a, b)
            .unwrap_or_else(|| {
                let (first, second) = if a.index() <= b.index() { (a, b) } else { (b, a) };
                self.intern(Node::Product(first, second))
            })
            .negate_if(negative)
    }

    fn fold_product(&self, a: Edge, b: Edge) -> Option<Edge> {
        let (c, x) = match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.folded(x * y),
            (Some(c), None) => (c, b),
            (None, Some(c)) => (c, a),
            (None, None) => return None,
        };
        if c == 0.0 {
            return Some(self.constant(0.0).edge());
        }
        if c == 1.0 {
            return Some(x);
        }
        let (d, y) = self.scaled(x);
        (d != 1.0).then(|| Some(self.mul(self.folded(c * d)?, y))).flatten()
    }

    pub(super) fn div(&self, a: Edge, b: Edge) -> Edge {
        if let Some(reciprocal) = self.value(b).and_then(|y| self.folded(1.0 / y)) {
            return self.mul(a, reciprocal);
        }
        let negative = a.is_negative() != b.is_negative();
        let (a, b) = (a.abs(), b.abs());
        let quotient = match self.value(a) {
            Some(0.0) => return a,
            _ if a == b => self.constant(1.0).edge(),
            _ => self.intern(Node::Quotient(a, b)),
        };
        quotient.negate_if(negative)
    }

    pub(super) fn call(&self, function: Function, a: Edge) -> Edge {
        if let Some(value) = self.value(a).and_then(|x| self.folded(function.evaluate(x))) {
            return value;
        }
        match function {
            Function::Sin | Function::Tanh | Function::Sign => {
                self.intern(Node::Call(function, a.abs())).negate_if(a.is_negative())
            }
            Function::Cos | Function::Abs => self.intern(Node::Call(function, a.abs())),
            Function::Exp | Function::Sqrt => self.intern(Node::Call(function, a)),
        }
    }
}
