//! Operation counts of the literature's geometries.

use super::derivatives::PairFrame;
use super::formulation::*;
use super::newton_euler::{MotionInput, inverse_dynamics};
use crate::graph::{Cost, Graph, Scalar, differentiate};
use crate::model::Model;
use crate::testing::*;

const DOWN: [f64; 3] = [0.0, 0.0, -9.81];

type Build = for<'g> fn(&'g Graph, &Model, &Formulation, MotionInput<'_, 'g>) -> Vec<Scalar<'g>>;

fn cost(model: &Model, formulation: &Formulation, build: Build) -> (Cost, usize) {
    let graph = Graph::new();
    let n = formulation.bodies.len();
    let array = |k: usize| (0..n).map(|i| graph.input(k, i)).collect::<Vec<_>>();
    let (y, v, a) = (array(0), array(1), array(2));
    let r = build(
        &graph,
        model,
        formulation,
        MotionInput {
            y: &y,
            v: &v,
            a: &a,
        },
    );
    let edges: Vec<_> = r.iter().map(|x| x.edge()).collect();
    (Cost::of(&graph, &edges), graph.len())
}

fn id<'g>(
    graph: &'g Graph,
    model: &Model,
    f: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    inverse_dynamics(&f.mechanism(graph, model), f, input)
}

fn mass<'g>(
    graph: &'g Graph,
    model: &Model,
    f: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    super::composite::mass_matrix(&f.mechanism(graph, model), f, input.y).concat()
}

fn analytic<'g>(
    graph: &'g Graph,
    model: &Model,
    f: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    let d = super::derivatives::inverse_dynamics_derivatives(
        &f.mechanism(graph, model),
        f,
        PairFrame::Links,
        input,
    );
    [
        d.forces,
        d.by_coordinates.concat(),
        d.by_velocities.concat(),
    ]
    .concat()
}

fn analytic_m<'g>(
    graph: &'g Graph,
    model: &Model,
    f: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    let d = super::derivatives::inverse_dynamics_derivatives(
        &f.mechanism(graph, model),
        f,
        PairFrame::Links,
        input,
    );
    [
        d.forces,
        d.by_coordinates.concat(),
        d.by_velocities.concat(),
        d.mass_matrix.concat(),
    ]
    .concat()
}

fn forward<'g>(
    graph: &'g Graph,
    model: &Model,
    f: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    let tau = id(graph, model, f, input);
    let mut out = tau.clone();
    for x in input.y.iter().chain(input.v) {
        out.extend(differentiate(graph, &tau, *x));
    }
    out
}

#[test]
fn derivatives_agree_with_forward_differentiation() {
    let model = chain(&GENERAL, [0.3, 1.0, -9.0]);
    let n = 6;
    let graph = Graph::new();
    let array = |k: usize| (0..n).map(|i| graph.input(k, i)).collect::<Vec<_>>();
    let (y, v, a) = (array(0), array(1), array(2));
    let input = MotionInput {
        y: &y,
        v: &v,
        a: &a,
    };
    let f = Formulation::plain(n);
    for pairs in [PairFrame::Links, PairFrame::Root] {
        let d = super::derivatives::inverse_dynamics_derivatives(
            &f.mechanism(&graph, &model),
            &f,
            pairs,
            input,
        );
        let values: Vec<Vec<f64>> = (0..3)
            .map(|k| {
                (0..n)
                    .map(|i| ((k * 7 + i * 3) as f64 * 0.77).sin())
                    .collect()
            })
            .collect();
        for (wrt, matrix) in [
            (&y, &d.by_coordinates),
            (&v, &d.by_velocities),
            (&a, &d.mass_matrix),
        ] {
            for (j, x) in wrt.iter().enumerate() {
                let column = differentiate(&graph, &d.forces, *x);
                for i in 0..n {
                    let (got, want) = (
                        evaluate(&graph, matrix[i][j], &values),
                        evaluate(&graph, column[i], &values),
                    );
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
            if e.is_negative() {
                -values[e.index()]
            } else {
                values[e.index()]
            }
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

#[test]
fn explore() {
    let planar = [(0.0, 0.0, 0.0), (0.0, 0.5, 0.0)];
    let cases: Vec<(&str, Model)> = vec![
        ("2R", chain(&planar, [0.0, -9.81, 0.0])),
        ("RX90", chain(&RX90, DOWN)),
        ("PUMA", chain(&PUMA, DOWN)),
        ("GENERAL", chain(&GENERAL, DOWN)),
        ("30", chain(&right_angles(30), DOWN)),
    ];
    for (name, model) in &cases {
        let n = model.coordinates.len();
        let space = SearchSpace::new(model);
        for (what, build) in [
            ("id", id as Build),
            ("M", mass),
            ("der", analytic),
            ("der+M", analytic_m),
            ("forward", forward),
        ] {
            if n > 7 && what == "forward" {
                continue;
            }
            let c0 = cost(model, &Formulation::plain(n), build).0;
            let best = cheapest(&space, |f| {
                let (c, l) = cost(model, f, build);
                (c.weight(), l)
            });
            let c1 = cost(model, &best, build).0;
            println!(
                "{name} {what}: plain {}/{} best {}/{} [{}]",
                c0.multiplications, c0.additions, c1.multiplications, c1.additions, c1.angles
            );
        }
    }
}

#[test]
fn fit() {
    for n in [4usize, 8, 12, 16, 20, 30] {
        let model = chain(&right_angles(n), DOWN);
        let space = SearchSpace::new(&model);
        let best = cheapest(&space, |f| {
            let (c, l) = cost(&model, f, id);
            (c.weight(), l)
        });
        let c = cost(&model, &best, analytic).0;
        let mut uniform = best.clone();
        uniform.bodies.iter_mut().for_each(|b| b.length_unit = 1.0);
        let e = cost(&model, &uniform, |graph, model, f, input| {
            let d = super::derivatives::inverse_dynamics_derivatives(
                &f.mechanism(graph, model),
                f,
                PairFrame::Root,
                input,
            );
            [
                d.forces,
                d.by_coordinates.concat(),
                d.by_velocities.concat(),
            ]
            .concat()
        })
        .0;
        uniform
            .bodies
            .iter_mut()
            .for_each(|b| b.regroup = crate::kinematics::RegroupChoice::Massless);
        let g = cost(&model, &uniform, |graph, model, f, input| {
            let d = super::derivatives::inverse_dynamics_derivatives(
                &f.mechanism(graph, model),
                f,
                PairFrame::Root,
                input,
            );
            [
                d.forces,
                d.by_coordinates.concat(),
                d.by_velocities.concat(),
            ]
            .concat()
        })
        .0;
        println!("    base massless: {}/{}", g.multiplications, g.additions);
        println!("    base: {}/{}", e.multiplications, e.additions);
        let own = best.with_own_units(&space, 0);
        let d = cost(&model, &own, analytic).0;
        println!(
            "{n}: id-best {}/{} own units {}/{}",
            c.multiplications, c.additions, d.multiplications, d.additions
        );
    }
}
