//! Compares the recursive derivatives with forward differentiation of the recursive equations.

use super::{PairFrame, inverse_dynamics_derivatives};
use crate::dynamics::formulation::Formulation;
use crate::dynamics::recursion::motion::MotionInput;
use crate::graph::{Graph, Scalar, differentiate};
use crate::kinematics::Mechanism;
use crate::testing::{GENERAL, chain};

#[test]
fn derivatives_agree_with_forward_differentiation() {
    let model = chain(&GENERAL, [0.3, 1.0, -9.0]);
    let n = 6;
    let graph = Graph::new();
    let array = |k: usize| (0..n).map(|i| graph.input(k, i)).collect::<Vec<_>>();
    let (y, v, a) = (array(0), array(1), array(2));
    let input = MotionInput { y: &y, v: &v, a: &a };
    let f = Formulation::plain(n);
    for pairs in [PairFrame::Links, PairFrame::Root] {
        let d = inverse_dynamics_derivatives(&f.mechanism(&graph, &Mechanism::new(&model)), &f, pairs, input);
        let values: Vec<Vec<f64>> =
            (0..3).map(|k| (0..n).map(|i| ((k * 7 + i * 3) as f64 * 0.77).sin()).collect()).collect();
        for (wrt, matrix) in [(&y, &d.by_coordinates), (&v, &d.by_velocities), (&a, &d.mass_matrix)] {
            for (j, x) in wrt.iter().enumerate() {
                let column = differentiate(&graph, &d.forces, *x);
                for i in 0..n {
                    let (got, want) =
                        (evaluate(&graph, matrix[i][j], &values), evaluate(&graph, column[i], &values));
                    assert!((got - want).abs() < 1e-10 * 30.0, "{i} {j}: {got} {want}");
                }
            }
        }
    }
}

fn evaluate(graph: &Graph, x: Scalar<'_>, inputs: &[Vec<f64>]) -> f64 {
    use crate::graph::Node;
    let mut values = vec![0.0; graph.len()];
    for edge in graph.reachable(&[x.edge()]) {
        let of = |e: crate::graph::Edge| {
            if e.is_negative() { -values[e.index()] } else { values[e.index()] }
        };
        values[edge.index()] = match graph.node(edge) {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Input(k, i) => inputs[k as usize][i as usize],
            Node::Parameter(_) => 0.0,
            Node::Sum(a, b) => of(a) + of(b),
            Node::Product(a, b) => of(a) * of(b),
            Node::Quotient(a, b) => of(a) / of(b),
            Node::Call(f, a) => f.evaluate(of(a)),
        };
    }
    let v = values[x.edge().index()];
    if x.edge().is_negative() { -v } else { v }
}
