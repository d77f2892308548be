//! A tree of links with all that a link carries.

use fastrand::Rng;
use gelenk_codegen::formula::{Formula, Function};
use gelenk_codegen::model::{
    Body, Drive, FollowedCoordinate, Frame, FrictionTerm, Input, Joint, JointKind, Limits, Link, Model,
    Motion, MotorTorque, Options, Parameter, Pose, RotorCoupling,
};

use super::numbers::{angle, axis, chance, number, place, point_mass, product, rigid_body, rotation, within};

pub(super) fn tree(rng: &mut Rng, longest: usize) -> Model {
    let count = rng.usize(1..=longest);
    let parameters = parameters(rng);
    let mut links = vec![Link { name: "base".into(), joint: None, bodies: vec![] }];
    let mut moving = Vec::new();
    while moving.len() < count {
        let index = links.len();
        let motion = match rng.f64() {
            x if x < 0.1 => Motion::Fixed,
            x if x < 0.2 => Motion::Held(angle(rng)),
            _ => {
                moving.push(index);
                // Numbered below.
                Motion::Coordinate(0)
            }
        };
        links.push(link(rng, index, motion, !parameters.is_empty()));
    }
    if chance(rng, 0.3) {
        rng.shuffle(&mut moving);
    }
    for (coordinate, &link) in moving.iter().enumerate() {
        if let Some(joint) = &mut links[link].joint {
            joint.motion = Motion::Coordinate(coordinate);
        }
    }
    let drives = drives(rng, &links);
    let frames = 0..rng.usize(1..=2);
    let frames = frames.map(|k| frame(rng, k, links.len())).collect();
    Model {
        name: "random".into(),
        description: vec![],
        gravity: gravity(rng).map(Formula::Number),
        parameters,
        frames,
        coordinates: moving,
        quaternion_joints: Vec::new(),
        followers: vec![],
        links,
        drives,
        point_forces: vec![],
        force_inputs: vec![],
        driven: vec![],
        wrenches: vec![],
        options: Options::default(),
    }
}

pub(super) fn gravity(rng: &mut Rng) -> [f64; 3] {
    match rng.u8(0..4) {
        0 => [0.0; 3],
        1 => [0.0, 0.0, -9.81],
        2 => [0.0, -9.81, 0.0],
        _ => [within(rng, 9.0), within(rng, 9.0), within(rng, 9.0)],
    }
}

/// None, or a scale of masses and a scale of lengths.
pub(super) fn parameters(rng: &mut Rng) -> Vec<Parameter> {
    if chance(rng, 0.7) {
        return vec![];
    }
    let parameter = |name: &str, default: f64| Parameter {
        name: name.into(),
        default,
        unit: String::new(),
        description: String::new(),
    };
    vec![parameter("weight", 1.2), parameter("length", 0.8)]
}

pub(super) fn link(rng: &mut Rng, index: usize, motion: Motion, free: bool) -> Link {
    let kind = match (motion, rng.u8(0..10)) {
        (Motion::Fixed, _) => JointKind::Fixed,
        (_, 0..=6) => JointKind::Revolute,
        (_, 7) => JointKind::Continuous,
        _ => JointKind::Prismatic,
    };
    let parent = if chance(rng, 0.75) { index - 1 } else { rng.usize(0..index) };
    let joint = Joint {
        name: format!("Joint {index}"),
        identifier: format!("j{index}"),
        parent,
        kind,
        origin: pose(rng, free),
        axis: axis(rng),
        motion,
        limits: Limits::default(),
        springs: springs(rng),
        friction: friction(rng, free),
        load_friction: Vec::new(),
    };
    Link { name: format!("link{index}"), joint: Some(joint), bodies: bodies(rng, free) }
}

pub(super) fn pose(rng: &mut Rng, free: bool) -> Pose {
    let mut translation = place(rng, 0.5).map(number);
    if free && chance(rng, 0.3) {
        let [x, y, z] = translation;
        translation = [product(Formula::Parameter(1), x), y, z];
    }
    Pose { translation, rotation: rotation(rng) }
}

pub(super) fn bodies(rng: &mut Rng, free: bool) -> Vec<Body> {
    let mut bodies = match rng.u8(0..10) {
        0 => vec![],
        1..=2 => vec![point_mass(rng, "point")],
        3..=4 => vec![rigid_body(rng, "body"), point_mass(rng, "point")],
        _ => vec![rigid_body(rng, "body")],
    };
    if free && chance(rng, 0.4) {
        for body in &mut bodies {
            body.mass = product(Formula::Parameter(0), body.mass.clone());
        }
    }
    bodies
}

/// `−s (y − r) − d v`, or a cubic one.
pub(super) fn springs(rng: &mut Rng) -> Vec<Formula> {
    let linear = |rng: &mut Rng| {
        let stretch = Formula::Subtract(Box::new(Formula::Position), Box::new(number(rng.f64())));
        let damping = product(number(rng.f64()), Formula::Velocity);
        let pull = product(number(-20.0 * rng.f64()), stretch);
        Formula::Subtract(Box::new(pull), Box::new(damping))
    };
    match rng.u8(0..6) {
        0 => vec![linear(rng)],
        1 => vec![linear(rng), product(number(-3.0), Formula::Power(Box::new(Formula::Position), 3))],
        _ => vec![],
    }
}

/// Viscous, smooth and exact Coulomb terms, and Coulomb friction that depends on the position.
pub(super) fn friction(rng: &mut Rng, free: bool) -> Vec<FrictionTerm> {
    let call =
        |function, slope: f64| Formula::Call(function, Box::new(product(number(slope), Formula::Velocity)));
    let mut terms = Vec::new();
    for basis in [
        Formula::Velocity,
        call(Function::Tanh, 10.0),
        call(Function::Sign, 1.0),
        // Positive at every position: teeth that mesh more or less tightly.
        product(
            Formula::sum(number(1.0), product(number(0.5), Formula::call(Function::Sin, Formula::Position))),
            call(Function::Tanh, 20.0),
        ),
    ] {
        if chance(rng, 0.3) {
            let size = number(0.1 + rng.f64());
            let coefficient = if free { product(Formula::Parameter(0), size) } else { size };
            terms.push(FrictionTerm { coefficient, basis });
        }
    }
    terms
}

/// Friction of a shaft that turns sixty times as fast as its joint: dual numbers know no steeper tanh there.
pub(super) fn shaft_friction(rng: &mut Rng) -> Vec<FrictionTerm> {
    let smooth = Formula::Call(Function::Tanh, Box::new(product(number(0.2), Formula::Velocity)));
    let toothed = product(
        Formula::sum(number(1.0), product(number(0.3), Formula::call(Function::Sin, Formula::Position))),
        smooth.clone(),
    );
    let bases =
        [Formula::Velocity, smooth, toothed].into_iter().filter(|_| chance(rng, 0.5)).collect::<Vec<_>>();
    let term = |basis| FrictionTerm { coefficient: number(0.02 * rng.f64()), basis };
    bases.into_iter().map(term).collect()
}

pub(super) fn drives(rng: &mut Rng, links: &[Link]) -> Vec<Drive> {
    let mut drives = Vec::new();
    for link in &links[1..] {
        let Some(joint) = &link.joint else { continue };
        let acts_on = match joint.motion {
            Motion::Coordinate(index) => vec![FollowedCoordinate::itself(index)],
            Motion::Held(_) => vec![],
            Motion::Fixed | Motion::Follower(_) => continue,
        };
        if chance(rng, 0.8) {
            drives.push(drive(rng, joint, acts_on, links.len()));
        }
    }
    drives
}

pub(super) fn drive(rng: &mut Rng, joint: &Joint, acts_on: Vec<FollowedCoordinate>, links: usize) -> Drive {
    let has_rotor = chance(rng, 0.6);
    let sign = if chance(rng, 0.2) { -1.0 } else { 1.0 };
    Drive {
        stands_apart: acts_on.len() > 1,
        name: format!("{} drive", joint.name),
        identifier: format!("{}_drive", joint.identifier),
        acts_on,
        gear_ratio: number(sign * (1.0 + 60.0 * rng.f64())),
        rotor_inertia: number(if has_rotor { 1e-3 * rng.f64() } else { 0.0 }),
        carrier: match rng.u8(0..4) {
            0 => 0,
            1 => rng.usize(0..links),
            _ => joint.parent,
        },
        axis: axis(rng),
        coupling: if chance(rng, 0.75) { RotorCoupling::Body } else { RotorCoupling::Diagonal },
        input: if chance(rng, 0.7) { Input::Torque } else { Input::Current(number(0.05)) },
        torque: MotorTorque::default(),
        speed: None,
        line: None,
        friction: Vec::new(),
    }
}

pub(super) fn frame(rng: &mut Rng, index: usize, links: usize) -> Frame {
    Frame {
        name: format!("Frame {index}"),
        identifier: format!("f{index}"),
        link: if index == 0 { links - 1 } else { rng.usize(0..links) },
        pose: pose(rng, false),
    }
}
