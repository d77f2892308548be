//! The wrenches of joints against Lagrange's equations: a joint with another axis is put behind the joint, at rest, and
//! the force that keeps it there is one component of the wrench. What the base exerts is also the rate of the robot's momentum.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{Joint, JointKind, Limits, Link, Model, Motion, Pose};
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_tests::oracle::{Oracle, value};
use gelenk_tests::random_model::{random_coupled_model, random_helical_model, random_model, random_sample};
use gelenk_tests::{Robot, workspace};
use num_dual::Dual64;

const WRENCHES: &str = "joint_wrenches";

/// Rounding error relative to the largest wrench.
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

/// Wrench on all moving bodies except gravity: the rate of their momentum minus their weight, then that of
/// their angular momentum about the base's origin minus the moment of the weight. Derivatives by time are the
/// dual parts.
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

/// Turned by an angle about y, as the pins of an excavator turn.
fn turned_about_y(angle: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [cos * x + sin * z, y, cos * z - sin * x]
}

/// A pin of the excavator, with what is on paper: its number among the coordinates, the ends of its cylinder (the foot about
/// the pin in the axes of the body before, the rod in those of its own body), and the mass beyond it.
struct Pin {
    coordinate: usize,
    foot: [f64; 3],
    rod: [f64; 3],
    mass: f64,
}

const PINS: [Pin; 3] = [
    Pin { coordinate: 1, foot: [0.25, 0.0, -0.3], rod: [0.8, 0.0, 0.1], mass: 95.0 + 45.0 + 38.0 },
    Pin { coordinate: 2, foot: [-1.0, 0.0, 0.4], rod: [-0.3, 0.0, 0.1], mass: 45.0 + 38.0 },
    Pin { coordinate: 3, foot: [-0.85, 0.0, 0.25], rod: [0.05, 0.0, 0.22], mass: 38.0 },
];

/// The statics of what is cut free at a pin: the cylinder pulls the rod to the foot, no drive turns the pin, and pin and cylinder
/// together carry the weight.
#[test]
fn what_a_pin_bears_is_its_row_less_the_force_of_the_cylinder() {
    let path = workspace().join("models/excavator.toml");
    let model = read(&path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).model;
    let robot = Robot::of_model(model, &[WRENCHES, "inverse_dynamics", "input_matrix"]);
    let (y, still) = ([0.4, -0.5, 1.3, 0.6], [0.0; 4]);
    let forces = robot.call_with("inverse_dynamics", &[&y, &still, &still], &[]).swap_remove(0);
    let input_matrix = robot.call_with("input_matrix", &[&y], &[]).swap_remove(0);
    let rows = robot.call_with(WRENCHES, &[&y, &still, &still], &[]).swap_remove(0);
    for Pin { coordinate, foot, rod, mass } in PINS {
        let pull = forces[coordinate] / input_matrix[5 * coordinate];
        let foot = turned_about_y(-y[coordinate], foot);
        let along: [f64; 3] = [0, 1, 2].map(|i| foot[i] - rod[i]);
        let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        let cylinder = along.map(|x| pull * x / length);
        let moment = rod[2] * cylinder[0] - rod[0] * cylinder[2];
        let row = &rows[6 * coordinate..][..6];
        assert!(row[4].abs() > 10.0 && pull.abs() > 100.0, "pin {coordinate}: {row:?}, {pull}");
        assert!(
            (row[4] - moment).abs() < 1e-9 * moment.abs(),
            "pin {coordinate}: {} is not {moment}",
            row[4]
        );
        let tilt: f64 = y[1..=coordinate].iter().sum();
        let carried = turned_about_y(-tilt, [0.0, 0.0, 9.81 * mass]);
        // In addition to the weight, what the pin bears and the cylinder exerts is all.
        let left = [0, 1, 2].map(|i| (row[i] - carried[i]).abs());
        assert!(
            left.iter().all(|left| *left < 1e-9 * carried[2].abs()),
            "pin {coordinate}: {left:?} N are left over"
        );
    }
}
