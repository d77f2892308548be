//! The wrenches of joints against Lagrange's equations: a joint with another axis is put behind the joint, at rest, and
//! the force that keeps it there is one component of the wrench.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{Joint, JointKind, Limits, Link, Model, Motion, Pose};
use gelenk_tests::Robot;
use gelenk_tests::oracle::Oracle;
use gelenk_tests::random_model::{random_coupled_model, random_helical_model, random_model, random_sample};

const WRENCHES: &str = "joint_wrenches";

/// Of rounding, relative to the largest wrench.
const TOLERANCE: f64 = 1e-11;

/// The model with one more coordinate, the last one: a joint behind that of a link, which carries all that the link
/// carried.
fn with_joint_behind(model: &Model, link: usize, kind: JointKind, axis: [f64; 3]) -> Model {
    let mut model = model.clone();
    let (new, coordinate) = (link + 1, model.coordinates.len());
    let renumbered = |k: usize| if k >= link { k + 1 } else { k };
    for joint in model.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
        joint.parent = renumbered(joint.parent);
        if let Motion::Follower(index) = &mut joint.motion {
            *index += 1;
        }
    }
    let place = |k: &mut usize| *k += usize::from(*k > link);
    model.coordinates.iter_mut().for_each(place);
    model.followers.iter_mut().for_each(|follower| place(&mut follower.link));
    model.drives.iter_mut().for_each(|drive| drive.carrier = renumbered(drive.carrier));
    model.frames.clear();
    let joint = Joint {
        name: "behind".into(),
        identifier: "behind".into(),
        parent: link,
        kind,
        origin: Pose {
            translation: [0.0; 3].map(Formula::Number),
            rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        },
        axis,
        motion: Motion::Coordinate(coordinate),
        limits: Limits::default(),
        springs: vec![],
        friction: vec![],
        load_friction: vec![],
    };
    let bodies = std::mem::take(&mut model.links[link].bodies);
    model.links.insert(new, Link { name: "behind".into(), joint: Some(joint), bodies });
    model.coordinates.push(new);
    model
}

fn with_zero(x: &[f64]) -> Vec<f64> {
    x.iter().copied().chain([0.0]).collect()
}

/// Force, then moment, about the origin of a moving link and in its frame.
fn wrench(model: &Model, link: usize, [y, v, a]: [&[f64]; 3], parameters: &[f64]) -> [f64; 6] {
    std::array::from_fn(|k| {
        let kind = if k < 3 { JointKind::Prismatic } else { JointKind::Revolute };
        let axis = std::array::from_fn(|i| f64::from(u8::from(i == k % 3)));
        let model = with_joint_behind(model, link, kind, axis);
        let oracle = Oracle { model: &model, parameters };
        let [y, v, a] = [y, v, a].map(with_zero);
        oracle.inertial_forces(&y, &v, &a)[y.len() - 1] - oracle.gravity_forces(&y)[y.len() - 1]
    })
}

fn check(seed: u64, model: Model) {
    let robot = Robot::of_model(model, &[WRENCHES]);
    let moving = robot.model.moving_joints();
    let state = random_sample(&mut Rng::with_seed(seed), &robot.model);
    let inputs: [&[f64]; 3] = [&state.y, &state.v, &state.a];
    let found = robot.call_with(WRENCHES, &inputs, &state.parameters).swap_remove(0);
    assert_eq!(found.len(), 6 * moving.len());
    let largest = found.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    for (moving, found) in moving.iter().zip(found.chunks(6)) {
        let expected = wrench(&robot.model, moving.link, inputs, &state.parameters);
        for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
            let error = (found - expected).abs();
            let joint = &moving.joint.name;
            assert!(
                error <= TOLERANCE * largest,
                "seed {seed}, joint {joint}, {k}: {found} is not {expected}"
            );
        }
    }
}

#[test]
fn wrenches_hold_joints_that_are_put_behind() {
    for seed in 0..4 {
        check(seed, random_model(seed, 5));
        check(seed, random_coupled_model(seed, 5));
        check(seed, random_helical_model(seed, 5));
    }
}

#[test]
fn wrenches_are_derived_on_request_alone() {
    let all = Robot::of_model(random_model(1, 3), &[]);
    assert!(all.functions().iter().all(|function| function.name != WRENCHES));
}
