//! The Hessian of `λᵀ (M ÿ + k − q)` against hyper-dual numbers (Fike and Alonso 2011): exact second
//! derivatives of the program of the inverse dynamics. Positions with quaternions change along ⊕.

use fastrand::Rng;
use gelenk_codegen::model::{Model, QuaternionKind};
use gelenk_tests::Robot;
use gelenk_tests::dual::evaluate;
use gelenk_tests::positions::{moved, positions};
use gelenk_tests::quaternion_model::with_quaternions;
use gelenk_tests::random_model::{
    Sample, random_coupled_model, random_helical_model, random_model, random_model_with_frame_forces,
    random_sample,
};
use num_dual::HyperDual64;

const HESSIAN: &str = "inverse_dynamics_hessian";

/// `∂² λᵀ f / ∂x_i ∂x_j` with x = (δ, ẏ, ÿ) at the positions `y ⊕ δ`.
fn second_derivative(robot: &Robot, state: &Sample, lambda: &[f64], i: usize, j: usize) -> f64 {
    let n = lambda.len();
    let all = [&vec![0.0; n], &state.v, &state.a].map(Vec::as_slice).concat();
    let unit = |k: usize, at: usize| f64::from(u8::from(k == at));
    let dual = |(k, &x): (usize, &f64)| HyperDual64::new(x, unit(k, i), unit(k, j), 0.0);
    let all: Vec<HyperDual64> = all.iter().enumerate().map(dual).collect();
    let y: Vec<HyperDual64> = state.y.iter().map(|&y| HyperDual64::from(y)).collect();
    let y = moved(&robot.model, &y, &all[..n]);
    let inputs = [&y, &all[n..2 * n], &all[2 * n..]];
    let program = &robot.function("inverse_dynamics").program;
    let forces = evaluate(program, &inputs, &state.parameters).swap_remove(0);
    forces.iter().zip(lambda).map(|(f, l)| f.eps1eps2 * l).sum()
}

#[test]
fn hessian_has_the_second_derivatives_of_the_inverse_dynamics() {
    let models = (0..25).map(|seed| (seed, random_model(seed, 5)));
    let helical = (0..4).map(|seed| (seed, random_helical_model(seed, 4)));
    models.chain(helical).for_each(|(seed, model)| check(seed, model));
}

#[test]
fn hessian_of_robots_with_quaternions_is_along_their_small_motions() {
    let kinds: [fn(u64, usize) -> Model; 4] =
        [random_model, random_coupled_model, random_helical_model, random_model_with_frame_forces];
    let (mut floating, mut spherical) = (0, 0);
    for (seed, kind) in (0..16).zip(kinds.into_iter().cycle()) {
        let model = with_quaternions(kind(seed, 3), seed);
        for joint in &model.quaternion_joints {
            *(if joint.kind == QuaternionKind::Floating { &mut floating } else { &mut spherical }) += 1;
        }
        check(seed, model);
    }
    assert!(floating >= 8 && spherical >= 4, "{floating} floating, {spherical} spherical");
}

fn check(seed: u64, model: Model) {
    let robot = Robot::of_model(model, &["inverse_dynamics", HESSIAN]);
    let n = robot.model.coordinates.len();
    let mut rng = Rng::with_seed(seed);
    let sample = random_sample(&mut rng, &robot.model);
    let state = Sample { y: positions(&robot.model, &sample.y), ..sample };
    let lambda: Vec<f64> = (0..n).map(|_| 2.0 * rng.f64() - 1.0).collect();
    let inputs: [&[f64]; 4] = [&state.y, &state.v, &state.a, &lambda];
    let found = robot.call_with(HESSIAN, &inputs, &state.parameters);
    let mut full = vec![0.0; 9 * n * n];
    // Blocks: rows and columns by y, ẏ, ÿ.
    for (block, (row, column)) in [(0, 0), (0, 1), (1, 1), (0, 2)].into_iter().enumerate() {
        for i in 0..n {
            for j in 0..n {
                let entry = found[block][i * n + j];
                full[(row * n + i) * 3 * n + column * n + j] = entry;
                full[(column * n + j) * 3 * n + row * n + i] = entry;
            }
        }
    }
    let expected: Vec<f64> = (0..9 * n * n)
        .map(|at| second_derivative(&robot, &state, &lambda, at / (3 * n), at % (3 * n)))
        .collect();
    let size = expected.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    for (at, (found, expected)) in full.iter().zip(&expected).enumerate() {
        let error = (found - expected).abs();
        assert!(error <= 1e-10 * size, "seed {seed}, entry {at}: {found} is not {expected}");
    }
    for block in [0, 2] {
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let (upper, lower) = (found[block][i * n + j], found[block][j * n + i]);
            assert_eq!(upper.to_bits(), lower.to_bits(), "symmetric");
        }
    }
}

#[test]
fn hessian_is_derived_on_request_alone() {
    let all = Robot::of_model(random_model(1, 3), &[]);
    let names = all.functions().iter().map(|f| f.name.as_str());
    assert!(!names.collect::<Vec<_>>().contains(&HESSIAN));
    let asked = Robot::of_model(random_model(1, 3), &[HESSIAN]);
    assert_eq!(asked.functions().len(), 1);
}
