//! Reorders sums so that operands that are available early are added first.

use super::build::Graph;
use super::node::{Edge, Node};

/// Rebuilds the results so that every sum adds its earliest operands first.
///
/// A recursion over links is a long chain of dependent operations, during which a superscalar processor
/// waits. If the operand of a sum that is available last is also added last, only one addition follows it.
/// The longest chain then has fewer operations (Huffman's construction on the depths of the terms). The
/// number of operations does not increase. Values change by rounding errors.
pub fn balanced(graph: &Graph, results: &[Edge]) -> Vec<Edge> {
    let reachable = graph.reachable(results);
    let mut balance = Balance {
        graph,
        is_part: parts(graph, &reachable, results),
        rebuilt: vec![None; graph.len()],
        depths: Vec::new(),
    };
    for &edge in &reachable {
        balance.rebuild(edge);
    }
    results.iter().map(|&edge| balance.successor(edge)).collect()
}

/// Marks sums that are only used as operands of another sum. Sums with a suggested name are not marked,
/// because readers of the text see the name.
fn parts(graph: &Graph, reachable: &[Edge], results: &[Edge]) -> Vec<bool> {
    let mut uses = vec![0_u32; graph.len()];
    let operands = reachable.iter().flat_map(|&edge| graph.node(edge).operands());
    for edge in operands.chain(results.iter().copied()) {
        uses[edge.index()] += 1;
    }
    let mut is_part = vec![false; graph.len()];
    for &edge in reachable {
        let Node::Sum(a, b) = graph.node(edge) else {
            continue;
        };
        for operand in [a, b] {
            is_part[operand.index()] = uses[operand.index()] == 1
                && matches!(graph.node(operand), Node::Sum(..))
                && graph.label_of(operand).is_none();
        }
    }
    is_part
}

struct Balance<'g> {
    graph: &'g Graph,
    is_part: Vec<bool>,
    rebuilt: Vec<Option<Edge>>,
    /// Length of the longest chain of operations up to each node of the graph, in clock cycles of a typical
    /// processor.
    depths: Vec<u32>,
}

impl Balance<'_> {
    fn successor(&self, old: Edge) -> Edge {
        let edge = self.rebuilt[old.index()].unwrap_or(old.abs());
        edge.negate_if(old.is_negative())
    }

    fn rebuild(&mut self, edge: Edge) {
        let graph = self.graph;
        let new = match graph.node(edge) {
            Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => edge,
            Node::Sum(..) if self.is_part[edge.index()] => return,
            Node::Sum(..) => self.sum(edge),
            Node::Product(a, b) => graph.mul(self.successor(a), self.successor(b)),
            Node::Quotient(a, b) => graph.div(self.successor(a), self.successor(b)),
            Node::Call(function, a) => graph.call(function, self.successor(a)),
        };
        if let Some(label) = graph.label_of(edge) {
            graph.label(new, || label);
        }
        self.rebuilt[edge.index()] = Some(new);
    }

    fn sum(&mut self, edge: Edge) -> Edge {
        let mut terms = Vec::new();
        self.collect(edge, &mut terms);
        let mut terms: Vec<(u32, Edge)> = terms.into_iter().map(|term| (self.depth(term), term)).collect();
        while terms.len() > 1 {
            // The sort is stable: terms of equal depth keep their order.
            terms.sort_by_key(|&(depth, _)| std::cmp::Reverse(depth));
            let pair = (terms.pop(), terms.pop());
            if let (Some((_, a)), Some((_, b))) = pair {
                let sum = self.graph.add(a, b);
                terms.push((self.depth(sum), sum));
            }
        }
        terms.pop().map_or_else(|| self.graph.constant(0.0).edge(), |(_, sum)| sum)
    }

    /// Collects the new terms of a sum, including the terms of inner sums that only this sum uses.
    fn collect(&self, sum: Edge, terms: &mut Vec<Edge>) {
        let mut pending = vec![sum];
        while let Some(edge) = pending.pop() {
            match self.graph.node(edge) {
                Node::Sum(a, b) if edge.abs() == sum.abs() || self.is_part[edge.index()] => {
                    pending.extend([b, a].map(|x| x.negate_if(edge.is_negative())));
                }
                _ => terms.push(self.successor(edge)),
            }
        }
    }

    fn depth(&mut self, edge: Edge) -> u32 {
        for index in self.depths.len()..self.graph.len() {
            let node = self.graph.node(Edge::plus(index));
            let below = node.operands().map(|x| self.depths[x.index()]).max();
            self.depths.push(below.unwrap_or(0) + latency(node));
        }
        self.depths[edge.index()]
    }
}

/// Clock cycles of an operation on a typical processor (Fog, instruction tables).
fn latency(node: Node) -> u32 {
    match node {
        Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => 0,
        Node::Sum(..) | Node::Product(..) => 4,
        Node::Quotient(..) => 14,
        Node::Call(..) => 40,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Cost, Scalar};

    /// A Horner-like chain: each link adds three ready terms to one that comes late.
    fn chain(graph: &Graph) -> Scalar<'_> {
        let x = |k: usize| graph.input(0, k);
        (1..6).fold(x(0), |late, k| ((late * x(k) + x(k + 6)) + x(k + 12)) - x(k + 18))
    }

    fn value(graph: &Graph, edge: Edge) -> f64 {
        let below = |x: Edge| value(graph, x);
        let value = match graph.node(edge) {
            Node::Input(_, k) => 1.0 + f64::from(k * k % 7),
            Node::Sum(a, b) => below(a) + below(b),
            Node::Product(a, b) => below(a) * below(b),
            other => panic!("{other:?} is not in the test"),
        };
        if edge.is_negative() { -value } else { value }
    }

    fn depth(graph: &Graph, result: Edge) -> u32 {
        let below = graph.node(result).operands().map(|x| depth(graph, x)).max();
        below.map_or(0, |below| below + 1)
    }

    #[test]
    fn late_terms_come_last() {
        let graph = Graph::new();
        let before = chain(&graph).edge();
        let after = balanced(&graph, &[before])[0];
        assert_eq!(value(&graph, after), value(&graph, before));
        assert_eq!(Cost::of(&graph, &[after]), Cost::of(&graph, &[before]));
        // One product and one sum per link; the first link's terms are all early.
        assert_eq!((depth(&graph, before), depth(&graph, after)), (20, 11));
    }

    #[test]
    fn shared_and_named_sums_stay() {
        let graph = Graph::new();
        let x = |k: usize| graph.input(0, k);
        let shared = x(0) * x(1) + x(2);
        let named = (x(3) * x(4) + x(5)).named(|| "named".to_owned());
        let results = [(shared + x(6)) + named, shared * x(7)].map(|x| x.edge());
        let after = balanced(&graph, &results);
        let reached = graph.reachable(&after);
        assert!(reached.contains(&shared.edge()) && reached.contains(&named.edge()));
    }
}
