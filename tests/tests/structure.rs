//! Structure of the equations: zeros that constants promise, and accelerations by articulated bodies.

use fastrand::Rng;
use gelenk_codegen::dynamics::formulation::Formulation;
use gelenk_codegen::dynamics::recursion::articulated;
use gelenk_codegen::functions::function::{ConstantValue, Function};
use gelenk_codegen::graph::Graph;
use gelenk_codegen::kinematics::Mechanism;
use gelenk_codegen::layout::Extent;
use gelenk_codegen::model::Model;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::program::{GraphOutput, InputArray, Program, Shape, lower};
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_tests::literature::{chain, right_angles};
use gelenk_tests::positions::positions;
use gelenk_tests::random_model::{Sample, condition_of, random_helical_model, random_model, random_sample};
use gelenk_tests::{Robot, descriptions};

fn models() -> Vec<Model> {
    let described = descriptions().into_iter().map(|path| {
        let loaded = read(&path, &ReadOptions::default());
        loaded.unwrap_or_else(|problems| panic!("{problems}")).model
    });
    // Functions of robots with driven joints take one argument more; `driven.rs` is about them.
    let described = described.filter(|model| model.driven.is_empty());
    let random = (200..240).map(|seed| random_model(seed, 10));
    let helical = (2200..2204).map(|seed| random_helical_model(seed, 6));
    described.chain(random).chain(helical).collect()
}

fn patterns(function: &Function) -> Vec<(&'static str, Vec<bool>)> {
    let constants = function.constants.iter();
    let patterns = constants.filter_map(|constant| match &constant.value {
        ConstantValue::Pattern(rows) => Some((constant.name, rows.concat())),
        _ => None,
    });
    patterns.collect()
}

/// `false` is a promise.
#[test]
fn entries_that_patterns_exclude_are_zero_in_every_state() {
    let mut zeros = 0;
    for model in models() {
        let robot = Robot::of_model(model, &["mass_matrix", "linearize"]);
        let mut rng = Rng::with_seed(3);
        for (name, takes) in [("mass_matrix", 1), ("linearize", 3)] {
            let patterns = patterns(robot.function(name));
            assert_eq!(patterns.len(), takes);
            for (_, pattern) in &patterns {
                zeros += pattern.iter().filter(|may| !**may).count();
            }
            for _ in 0..8 {
                let Sample { y, v, u, parameters, .. } = random_sample(&mut rng, &robot.model);
                let y = positions(&robot.model, &y);
                let inputs: [&[f64]; 3] = [&y, &v, &u];
                let found = robot.call_with(name, &inputs[..takes], &parameters);
                for (found, (what, pattern)) in found.iter().zip(&patterns) {
                    let broken = found.iter().zip(pattern).filter(|(x, may)| !**may && **x != 0.0);
                    assert_eq!(broken.count(), 0, "{what} of {}", robot.model.name);
                }
            }
        }
    }
    assert!(zeros > 100, "{zeros} zeros in all");
}

#[test]
fn patterns_show_branches_and_upright_axes() {
    let robot = |name: &str| {
        let path = gelenk_tests::workspace().join("models").join(name);
        let loaded = read(&path, &ReadOptions::default()).expect("the model");
        Robot::of_model(loaded.model, &["mass_matrix", "linearize"])
    };
    let two_arm = robot("two_arm.toml");
    let mass = &patterns(two_arm.function("mass_matrix"))[0].1;
    // A torso with two arms of three joints each.
    for (i, j) in (0..49).map(|at| (at / 7, at % 7)) {
        let is_in_one_branch = i == 0 || j == 0 || (i - 1) / 3 == (j - 1) / 3;
        assert!(is_in_one_branch || !mass[7 * i + j], "M[{i}][{j}]");
    }
    // Gravity does not see a turn about an upright axis.
    let linear = patterns(robot("ur5.toml").function("linearize"));
    let (by_y, by_v) = (&linear[0].1, &linear[1].1);
    for (at, may) in by_y.iter().enumerate() {
        assert_eq!(*may, at % 6 != 0, "A_y[{}][{}]", at / 6, at % 6);
    }
    assert!(by_v.iter().all(|may| *may));
    // Nor does anything see a turn of the Puma's last link, which is round.
    let linear = patterns(robot("puma560.toml").function("linearize"));
    for (at, may) in linear[0].1.iter().enumerate() {
        assert_eq!(*may, at % 6 != 0 && at % 6 != 5, "A_y[{}][{}]", at / 6, at % 6);
    }
}

/// The accelerations by articulated bodies as a program of y, v and the joint forces; `None` where rotors
/// or couplings forbid it.
fn by_articulated_bodies(model: &Model) -> Option<Program> {
    let graph = Graph::new();
    let n = model.coordinates.len();
    let [y, v, f] = [0, 1, 2].map(|array| (0..n).map(|k| graph.input(array, k)).collect::<Vec<_>>());
    let mechanism = Mechanism::new(model);
    if mechanism.is_coupled() || mechanism.has_quaternions() || !mechanism.rotors_are_neighbours() {
        return None;
    }
    let mechanism = Formulation::plain(n).mechanism(&graph, &mechanism);
    let accelerations = articulated::forward_dynamics(&mechanism, &y, &v, &f);
    let output = GraphOutput {
        name: "a".to_owned(),
        shape: Shape::Vector(Extent::fixed(n)),
        entries: accelerations.iter().map(|x| x.edge()).collect(),
    };
    let inputs = ["y", "v", "f"].map(|name| InputArray { name: name.to_owned(), extent: Extent::fixed(n) });
    Some(lower(&graph, inputs.into(), &[output]))
}

#[test]
fn articulated_bodies_give_the_accelerations_that_need_these_forces() {
    let mut tried = 0;
    for model in models() {
        let Some(program) = by_articulated_bodies(&model) else {
            continue;
        };
        tried += 1;
        let robot = Robot::of_model(model, &["mass_matrix", "bias_forces"]);
        let n = robot.model.coordinates.len();
        let mut rng = Rng::with_seed(4);
        for _ in 0..3 {
            let Sample { y, v, a, parameters, .. } = random_sample(&mut rng, &robot.model);
            let mass = robot.call_with("mass_matrix", &[&y], &parameters).swap_remove(0);
            let bias = robot.call_with("bias_forces", &[&y, &v], &parameters).swap_remove(0);
            let inertial = |i: usize| (0..n).map(|j| mass[i * n + j] * a[j]).sum::<f64>();
            let forces: Vec<f64> = (0..n).map(|i| inertial(i) + bias[i]).collect();
            let found = interpret(&program, &[&y, &v, &forces], &parameters);
            let found = found.expect("inputs fit").swap_remove(0);
            let largest = |x: &[f64]| x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            // Rounding of the forces, through M⁻¹.
            let growth = condition_of(&mass) * (largest(&forces) + largest(&bias)) / largest(&mass);
            for (found, expected) in found.iter().zip(&a) {
                let error = (found - expected).abs();
                let tolerance = 1e-12 * (growth + largest(&a));
                assert!(error <= tolerance, "{}: {found} is not {expected}", robot.model.name);
            }
        }
    }
    assert!(tried >= 20, "{tried} robots");
}

/// Factors for short arms, articulated bodies for long ones; the documentation says which.
#[test]
fn the_cheaper_forward_dynamics_is_kept() {
    let note = |joints: usize| {
        let model = chain(&right_angles(joints), [0.0, 0.0, -9.81]);
        let robot = Robot::of_model(model, &["forward_dynamics"]);
        robot.function("forward_dynamics").notes[0].clone()
    };
    assert!(note(6).starts_with("The factorization M = Lᵀ D L"), "{}", note(6));
    assert!(note(30).starts_with("Articulated bodies"), "{}", note(30));
}
