//! Forward differentiation of a graph.

use super::build::Graph;
use super::node::{Edge, Node};
use super::scalar::Scalar;
use crate::formula::Function;

/// Derivatives of `results` by one input entry or parameter, on the same graph.
///
/// `sign` is exact in the value and has the derivative zero; `|x|` has the derivative `sign x`.
pub fn differentiate<'g>(
    graph: &'g Graph,
    results: &[Scalar<'g>],
    variable: Scalar<'g>,
) -> Vec<Scalar<'g>> {
    let edges: Vec<Edge> = results.iter().map(|x| x.edge()).collect();
    let zero = graph.constant(0.0);
    let mut derivatives = vec![zero; graph.len()];
    for edge in graph.reachable(&edges) {
        let of = |operand: Edge| {
            derivatives[operand.index()].signed(if operand.is_negative() { -1.0 } else { 1.0 })
        };
        let value = |operand: Edge| graph.scalar(operand);
        let derivative = match graph.node(edge) {
            _ if edge == variable.edge() => graph.constant(1.0),
            Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => zero,
            Node::Sum(a, b) => of(a) + of(b),
            Node::Product(a, b) if a == b => (value(a) * of(a)) * 2.0,
            Node::Product(a, b) => of(a) * value(b) + value(a) * of(b),
            Node::Quotient(a, b) => (of(a) - value(edge) * of(b)).divided_by(value(b)),
            Node::Call(function, a) => outer(function, value(a), value(edge)) * of(a),
        };
        derivatives[edge.index()] = derivative;
    }
    results
        .iter()
        .map(|x| {
            derivatives[x.edge().index()].signed(if x.edge().is_negative() { -1.0 } else { 1.0 })
        })
        .collect()
}

/// `f'(x)`, with `f(x)` at hand.
fn outer<'g>(function: Function, x: Scalar<'g>, value: Scalar<'g>) -> Scalar<'g> {
    match function {
        Function::Sin => x.call(Function::Cos),
        Function::Cos => -x.call(Function::Sin),
        Function::Tanh => value.constant(1.0) - value * value,
        Function::Exp => value,
        Function::Abs => x.call(Function::Sign),
        Function::Sign => value.constant(0.0),
    }
}
