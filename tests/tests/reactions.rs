//! The wrenches of joints against Lagrange's equations: a joint with another axis is put behind the joint, at rest, and
//! the force that keeps it there is one component of the wrench. What the base exerts is also the rate of the robot's momentum.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{Joint, JointKind, Limits, Link, Model, Motion, Pose, ReadOptions, read};
use gelenk_tests::oracle::{Oracle, value};
use gelenk_tests::random_model::{random_coupled_model, random_helical_model, random_model, random_sample};
use gelenk_tests::{Robot, workspace};
use num_dual::Dual64;

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

type Vector = [Dual64; 3];

fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn times(a: &[Vector; 3], b: &Vector) -> Vector {
    a.each_ref().map(|row| row[0] * b[0] + row[1] * b[1] + row[2] * b[2])
}

fn plus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// What acts on all moving bodies besides gravity: the rate of their momentum less their weight, then that of their angular
/// momentum about the base's origin less the moment of the weight. Derivatives by time are the dual parts.
fn base_wrench(model: &Model, [y, v, a]: [&[f64]; 3], parameters: &[f64]) -> [f64; 6] {
    let along = |x: &[f64], rate: &[f64]| -> Vec<Dual64> {
        x.iter().zip(rate).map(|(x, rate)| Dual64::new(*x, *rate)).collect()
    };
    let states = Oracle { model, parameters }.links(&along(y, v), &along(v, a));
    let number = |formula: &Formula| Dual64::from(value(formula, parameters, 0.0, 0.0));
    let gravity = model.gravity.each_ref().map(number);
    let mut total = [0.0; 6];
    for (link, state) in model.links.iter().zip(&states).filter(|(_, state)| state.moves) {
        for body in &link.bodies {
            let arm = times(&state.rotation, &body.center_of_mass.each_ref().map(number));
            let (place, mass) = (plus(&state.origin, &arm), number(&body.mass));
            let momentum = plus(&state.velocity, &cross(&state.spin, &arm)).map(|v| v * mass);
            let [xx, xy, xz, yy, yz, zz] = body.inertia.each_ref().map(number);
            let turned = [0, 1, 2].map(|i| [0, 1, 2].map(|j| state.rotation[j][i]));
            let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let spin = times(&state.rotation, &times(&inertia, &times(&turned, &state.spin)));
            let angular = plus(&cross(&place, &momentum), &spin);
            let weight = gravity.map(|g| g * mass);
            let moment = cross(&place, &weight);
            for i in 0..3 {
                total[i] += momentum[i].eps - weight[i].re;
                total[3 + i] += angular[i].eps - moment[i].re;
            }
        }
    }
    total
}

/// The wrenches of the joints that stand on the base, in its axes and about its origin.
fn exerted_by_base(robot: &Robot, found: &[f64], y: &[f64], parameters: &[f64]) -> [f64; 6] {
    let still = vec![Dual64::from(0.0); y.len()];
    let y: Vec<Dual64> = y.iter().map(|y| Dual64::from(*y)).collect();
    let states = Oracle { model: &robot.model, parameters }.links(&y, &still);
    let mut total = [0.0; 6];
    for (moving, wrench) in robot.model.moving_joints().iter().zip(found.chunks(6)) {
        if states[moving.joint.parent].moves {
            continue;
        }
        let state = &states[moving.link];
        let part = |first: usize| times(&state.rotation, &[0, 1, 2].map(|i| Dual64::from(wrench[first + i])));
        let force = part(0);
        let moment = plus(&part(3), &cross(&state.origin, &force));
        for i in 0..3 {
            total[i] += force[i].re;
            total[3 + i] += moment[i].re;
        }
    }
    total
}

/// Rotors stand still here: those that sit on the base have momentum, and no joint carries them.
#[test]
fn the_base_exerts_the_rate_of_the_whole_momentum() {
    let mut models: Vec<Model> = (10..14)
        .flat_map(|seed| {
            [random_model(seed, 5), random_coupled_model(seed, 5), random_helical_model(seed, 5)]
        })
        .collect();
    for name in ["tx40_like", "palletizer", "scara", "gripper"] {
        let path = workspace().join("models").join([name, ".toml"].concat());
        models.push(read(&path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).model);
    }
    for mut model in models {
        model.drives.iter_mut().for_each(|drive| drive.rotor_inertia = Formula::ZERO);
        let robot = Robot::of_model(model, &[WRENCHES]);
        let state = random_sample(&mut Rng::with_seed(7), &robot.model);
        let inputs: [&[f64]; 3] = [&state.y, &state.v, &state.a];
        let found = robot.call_with(WRENCHES, &inputs, &state.parameters).swap_remove(0);
        let exerted = exerted_by_base(&robot, &found, &state.y, &state.parameters);
        let expected = base_wrench(&robot.model, inputs, &state.parameters);
        let largest = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(largest > 1.0, "{}: it moves, and weighs something", robot.model.name);
        for (k, (exerted, expected)) in exerted.into_iter().zip(expected).enumerate() {
            let error = (exerted - expected).abs();
            assert!(error <= TOLERANCE * largest, "{}, {k}: {exerted} is not {expected}", robot.model.name);
        }
    }
}

#[test]
fn wrenches_are_derived_on_request_alone() {
    let all = Robot::of_model(random_model(1, 3), &[]);
    assert!(all.functions().iter().all(|function| function.name != WRENCHES));
}
