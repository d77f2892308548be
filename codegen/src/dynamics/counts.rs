//! Operation counts of the literature's geometries.

use super::formulation::*;
use super::newton_euler::{MotionInput, inverse_dynamics};
use crate::graph::{Cost, Graph};
use crate::model::Model;
use crate::testing::*;

const DOWN: [f64; 3] = [0.0, 0.0, -9.81];

fn cost(model: &Model, formulation: &Formulation, bias: bool) -> (Cost, usize) {
    let graph = Graph::new();
    let n = formulation.bodies.len();
    let array = |k: usize| (0..n).map(|i| graph.input(k, i)).collect::<Vec<_>>();
    let (y, v, mut a) = (array(0), array(1), array(2));
    if bias {
        a = vec![graph.constant(0.0); n];
    }
    let mechanism = formulation.mechanism(&graph, model);
    let tau = inverse_dynamics(
        &mechanism,
        formulation,
        MotionInput {
            y: &y,
            v: &v,
            a: &a,
        },
    );
    let edges: Vec<_> = tau.iter().map(|x| x.edge()).collect();
    (Cost::of(&graph, &edges), graph.len())
}

fn cost_m(model: &Model, formulation: &Formulation) -> (Cost, usize) {
    let graph = Graph::new();
    let n = formulation.bodies.len();
    let y = (0..n).map(|i| graph.input(0, i)).collect::<Vec<_>>();
    let mechanism = formulation.mechanism(&graph, model);
    let m = super::composite::mass_matrix(&mechanism, formulation, &y);
    let edges: Vec<_> = m.iter().flatten().map(|x| x.edge()).collect();
    (Cost::of(&graph, &edges), graph.len())
}

#[test]
fn explore() {
    let planar = [(0.0, 0.0, 0.0), (0.0, 0.5, 0.0)];
    let cases: Vec<(&str, Model)> = vec![
        ("2R", chain(&planar, [0.0, -9.81, 0.0])),
        ("RX90", chain(&RX90, DOWN)),
        ("PUMA", chain(&PUMA, DOWN)),
        ("GENERAL", chain(&GENERAL, DOWN)),
        (
            "30d",
            chain(
                &right_angles(30)
                    .into_iter()
                    .map(|(a, d, _)| (a, d, 0.0))
                    .collect::<Vec<_>>(),
                DOWN,
            ),
        ),
        (
            "30e",
            chain(
                &right_angles(30)
                    .into_iter()
                    .map(|(a, d, _)| {
                        (
                            a,
                            if d > 0.0 { 0.2 } else { 0.0 },
                            if d > 0.0 { 0.2 } else { 0.0 },
                        )
                    })
                    .collect::<Vec<_>>(),
                DOWN,
            ),
        ),
        (
            "30r",
            chain(
                &right_angles(30)
                    .into_iter()
                    .map(|(a, _, r)| (a, 0.0, r))
                    .collect::<Vec<_>>(),
                DOWN,
            ),
        ),
        ("30", chain(&right_angles(30), DOWN)),
    ];
    for (name, model) in &cases {
        let n = model.coordinates.len();
        let plain = Formulation::plain(n);
        let (c0, _) = cost_m(model, &plain);
        let best = cheapest(&SearchSpace::new(model), |f| {
            let (c, l) = cost_m(model, f);
            (c.weight(), l)
        });
        let (c1, _) = cost_m(model, &best);
        println!(
            "{name} M: plain {}/{} [{}] best {}/{} [{}]",
            c0.multiplications,
            c0.additions,
            c0.angles,
            c1.multiplications,
            c1.additions,
            c1.angles
        );
        if n < 8 {
            println!(
                "   unit {} {:?}",
                0,
                best.bodies
                    .iter()
                    .map(|b| format!(
                        "{} {:?} {:?} {:?} {:?} {:?} {:?}",
                        b.length_unit, b.angular, b.frame, b.source, b.sink, b.regroup, b.leaf
                    ))
                    .collect::<Vec<_>>()
            );
        }
        for bias in [false, true] {
            let plain = Formulation::plain(n);
            let (c0, _) = cost(model, &plain, bias);
            let space = SearchSpace::new(model);
            let best = cheapest(&space, |f| {
                let (c, l) = cost(model, f, bias);
                (c.weight(), l)
            });
            let (c1, _) = cost(model, &best, bias);
            println!(
                "{name} bias={bias}: plain {}/{} [{}] best {}/{} [{}]",
                c0.multiplications,
                c0.additions,
                c0.angles,
                c1.multiplications,
                c1.additions,
                c1.angles
            );
            if n < 8 {
                println!(
                    "   unit {} {:?}",
                    0,
                    best.bodies
                        .iter()
                        .map(|b| format!(
                            "{} {:?} {:?} {:?} {:?} {:?} {:?}",
                            b.length_unit, b.angular, b.frame, b.source, b.sink, b.regroup, b.leaf
                        ))
                        .collect::<Vec<_>>()
                );
            }
        }
    }
}
