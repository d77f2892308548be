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

/// `results` with `new` in place of the inputs `old`.
pub fn substitute<'g>(
    graph: &'g Graph,
    results: &[Scalar<'g>],
    old: &[Scalar<'g>],
    new: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let edges: Vec<Edge> = results.iter().map(|x| x.edge()).collect();
    let mut replaced: Vec<Option<Scalar<'g>>> = vec![None; graph.len()];
    for (old, new) in old.iter().zip(new) {
        replaced[old.edge().index()] = Some(*new);
    }
    for edge in graph.reachable(&edges) {
        if replaced[edge.index()].is_some() {
            continue;
        }
        let of = |operand: Edge| signed_value(graph, &replaced, operand);
        let value = match graph.node(edge) {
            Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => graph.scalar(edge),
            Node::Sum(a, b) => of(a) + of(b),
            Node::Product(a, b) => of(a) * of(b),
            Node::Quotient(a, b) => of(a).divided_by(of(b)),
            Node::Call(function, a) => of(a).call(function),
        };
        replaced[edge.index()] = Some(value);
    }
    edges
        .iter()
        .map(|&edge| signed_value(graph, &replaced, edge))
        .collect()
}

fn signed_value<'g>(graph: &'g Graph, replaced: &[Option<Scalar<'g>>], edge: Edge) -> Scalar<'g> {
    let value = replaced[edge.index()].unwrap_or_else(|| graph.scalar(edge.abs()));
    if edge.is_negative() { -value } else { value }
}
