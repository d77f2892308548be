//! Forward and reverse differentiation of expressions in a graph.

use super::build::Graph;
use super::node::{Edge, Node};
use super::scalar::Scalar;
use gelenk_formula::Function;

/// Derivatives of `results` with respect to `variable`, an input entry or a parameter, on the same graph.
///
/// The derivative of `sign x` is 0, and the derivative of `|x|` is `sign x`.
pub fn differentiate<'g>(graph: &'g Graph, results: &[Scalar<'g>], variable: Scalar<'g>) -> Vec<Scalar<'g>> {
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
        .map(|x| derivatives[x.edge().index()].signed(if x.edge().is_negative() { -1.0 } else { 1.0 }))
        .collect()
}

/// Derivatives of one result with respect to many inputs, by reverse differentiation on the same graph. The
/// derivatives need as many operations as a few evaluations of the result. The derivatives of `sign` and
/// `|x|` are defined as in [`differentiate`].
pub fn gradient<'g>(graph: &'g Graph, result: Scalar<'g>, variables: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    let zero = graph.constant(0.0);
    let mut adjoints = vec![zero; graph.len()];
    let signed = |x: Scalar<'g>, edge: Edge| match edge.is_negative() {
        true => -x,
        false => x,
    };
    adjoints[result.edge().index()] = signed(graph.constant(1.0), result.edge());
    for edge in graph.reachable(&[result.edge()]).into_iter().rev() {
        let adjoint = adjoints[edge.index()];
        let value = |operand: Edge| graph.scalar(operand);
        let mut add = |operand: Edge, share: Scalar<'g>| {
            let sum = &mut adjoints[operand.index()];
            *sum = *sum + signed(share, operand);
        };
        match graph.node(edge) {
            _ if adjoint.is_zero() => {}
            Node::Constant(_) | Node::Input(..) | Node::Parameter(_) => {}
            Node::Sum(a, b) => {
                add(a, adjoint);
                add(b, adjoint);
            }
            Node::Product(a, b) if a == b => add(a, (adjoint * value(a)) * 2.0),
            Node::Product(a, b) => {
                add(a, adjoint * value(b));
                add(b, adjoint * value(a));
            }
            Node::Quotient(a, b) => {
                let share = adjoint.divided_by(value(b));
                add(a, share);
                add(b, -(share * value(edge)));
            }
            Node::Call(function, a) => add(a, adjoint * outer(function, value(a), value(edge))),
        }
    }
    let of = |variable: &Scalar<'g>| adjoints[variable.edge().index()];
    variables.iter().map(of).collect()
}

/// The derivative `f'(x)` of an elementary function, computed from the value `f(x)` if this needs fewer
/// operations.
fn outer<'g>(function: Function, x: Scalar<'g>, value: Scalar<'g>) -> Scalar<'g> {
    match function {
        Function::Sin => x.call(Function::Cos),
        Function::Cos => -x.call(Function::Sin),
        Function::Tanh => value.constant(1.0) - value * value,
        Function::Exp => value,
        Function::Abs => x.call(Function::Sign),
        Function::Sign => value.constant(0.0),
        Function::Sqrt => value.constant(0.5).divided_by(value),
    }
}

/// Returns `results` with the inputs `old` replaced by `new`.
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
        replaced[edge.index()] = Some(graph.rebuilt(graph.node(edge), of));
    }
    edges.iter().map(|&edge| signed_value(graph, &replaced, edge)).collect()
}

fn signed_value<'g>(graph: &'g Graph, replaced: &[Option<Scalar<'g>>], edge: Edge) -> Scalar<'g> {
    let value = replaced[edge.index()].unwrap_or_else(|| graph.scalar(edge.abs()));
    if edge.is_negative() { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reverse_and_forward_differentiation_agree() {
        let graph = Graph::new();
        let x: Vec<_> = (0..4).map(|k| graph.input(0, k)).collect();
        let angle = x[0] * x[1] - x[2];
        let smooth = angle.call(Function::Tanh).divided_by(x[2].squared() + graph.constant(1.5));
        let waves = x[0].call(Function::Sin) * angle.call(Function::Cos) * x[3];
        let edges = x[2].call(Function::Abs) * x[1].call(Function::Sign) - (-x[3]).call(Function::Exp);
        let result = -(smooth * smooth + waves - edges * 0.3);
        let backwards = gradient(&graph, result, &x);
        for point in [[0.3, -1.2, 0.7, 0.1], [-2.0, 0.4, -0.6, 1.1]] {
            for (variable, backwards) in x.iter().zip(&backwards) {
                let forwards = differentiate(&graph, &[result], *variable)[0];
                let (found, expected) = (value(*backwards, &point), value(forwards, &point));
                assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
            }
        }
        // What does not depend on a variable has the derivative 0 exactly.
        assert!(gradient(&graph, x[0] * x[1], &x[2..]).iter().all(|d| d.is_zero()));
    }

    fn value(x: Scalar<'_>, point: &[f64]) -> f64 {
        let graph = x.graph();
        let of = |edge: Edge| value(graph.scalar(edge), point);
        let magnitude = match graph.node(x.edge()) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Input(_, index) => point[index as usize],
            Node::Parameter(_) => f64::NAN,
            Node::Sum(a, b) => of(a) + of(b),
            Node::Product(a, b) => of(a) * of(b),
            Node::Quotient(a, b) => of(a) / of(b),
            Node::Call(function, a) => function.evaluate(of(a)),
        };
        if x.edge().is_negative() { -magnitude } else { magnitude }
    }
}
