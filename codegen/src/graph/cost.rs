//! Number of operations that results of a graph need.

use super::build::Graph;
use super::node::{Edge, Node};
use gelenk_formula::Function;

/// Numbers of operations by kind. A subtraction counts as an addition. A negation does not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cost {
    /// Number of multiplications.
    pub multiplications: u64,
    /// Number of additions and subtractions.
    pub additions: u64,
    /// Number of divisions.
    pub divisions: u64,
    /// Number of angles whose sine or cosine is computed. Sine and cosine of the same angle count once.
    pub angles: u64,
    /// Number of other function calls.
    pub calls: u64,
}

impl Cost {
    /// Counts the operations that the results need. Shared operations count once.
    pub fn of(graph: &Graph, results: &[Edge]) -> Self {
        let mut cost = Self::default();
        let mut angles = std::collections::BTreeSet::new();
        for node in graph.reachable(results) {
            match graph.node(node) {
                Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => {}
                Node::Sum(..) => cost.additions += 1,
                Node::Product(..) => cost.multiplications += 1,
                Node::Quotient(..) => cost.divisions += 1,
                Node::Call(Function::Sin | Function::Cos, angle) => _ = angles.insert(angle),
                Node::Call(..) => cost.calls += 1,
            }
        }
        cost.angles = angles.len() as u64;
        cost
    }

    /// Weighted sum of the operations, which is approximately the number of instructions. It compares ways to
    /// write the same equations.
    pub fn weight(&self) -> u64 {
        self.multiplications + self.additions + 8 * self.divisions + 20 * (self.angles + self.calls)
    }
}
