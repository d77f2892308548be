//! Random robots: trees of every kind of joint, placement, body, rotor and force law that a model can hold.

use std::f64::consts::PI;

use fastrand::Rng;
use gelenk_codegen::formula::{Formula, Function};
use gelenk_codegen::model::{
    Attachment, Body, Drive, FollowedCoordinate, Follower, ForceEffect, ForceInput, Frame, FrictionTerm,
    Input, Joint, JointKind, Limits, Link, Model, Motion, MotorTorque, Options, Parameter, PointForce, Pose,
    RotorCoupling, Wrench, WrenchAxes,
};
use nalgebra::DMatrix;

use crate::oracle::Oracle;

/// Condition number of M up to which a random robot is taken: beyond it forward dynamics says little.
pub const WORST_CONDITION: f64 = 1e7;

/// A state to evaluate a robot in, and values of its parameters.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Coordinates.
    pub y: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Inputs.
    pub u: Vec<f64>,
    /// Free parameters.
    pub parameters: Vec<f64>,
}

/// A robot with up to `longest` coordinates; the same for the same seed.
pub fn random_model(seed: u64, longest: usize) -> Model {
    let mut rng = Rng::with_seed(seed);
    let model = tree(&mut rng, longest);
    made_regular(rng, model)
}

/// As [`random_model`], with each rotor on the parent of the joint that it drives: loops over joints know no
/// others.
pub fn random_model_with_near_rotors(seed: u64, longest: usize) -> Model {
    let mut rng = Rng::with_seed(seed);
    let mut model = tree(&mut rng, longest);
    for drive in &mut model.drives {
        let driven = drive.coordinate().map(|index| model.coordinates[index]);
        let joint = driven.and_then(|link| model.links[link].joint.as_ref());
        drive.carrier = joint.map_or(drive.carrier, |joint| joint.parent);
    }
    made_regular(rng, model)
}

/// As [`random_model`], with joints that follow others and drives that act on several coordinates.
pub fn random_coupled_model(seed: u64, longest: usize) -> Model {
    let mut rng = Rng::with_seed(seed);
    let mut model = loop {
        let model = tree(&mut rng, longest);
        if model.coordinates.len() > 1 {
            break model;
        }
    };
    couple(&mut rng, &mut model);
    made_regular(rng, model)
}

/// As [`random_model`] or [`random_coupled_model`], with forces between frames, inputs at frames and wrenches.
pub fn random_model_with_frame_forces(seed: u64, longest: usize) -> Model {
    let mut model = match seed % 3 {
        0 => random_coupled_model(seed, longest),
        _ => random_model(seed, longest),
    };
    let mut rng = Rng::with_seed(seed ^ 0xf0c5);
    for index in 0..rng.usize(1..=3) {
        let between = separated(&mut rng, &model);
        let law = pull(&mut rng, !model.parameters.is_empty());
        model.point_forces.push(PointForce { name: format!("spring {index}"), between, law });
    }
    for index in 0..rng.usize(1..=3) {
        let effect = match rng.bool() {
            true => ForceEffect::Pull(separated(&mut rng, &model)),
            false => {
                let wrench = [0; 6].map(|_| number(if rng.bool() { within(&mut rng, 1.0) } else { 0.0 }));
                ForceEffect::Wrench { at: moving(&mut rng, &model), wrench }
            }
        };
        model.force_inputs.push(ForceInput { name: format!("input {index}"), limits: None, effect });
    }
    for index in 0..rng.usize(1..=2) {
        let axes = if rng.bool() { WrenchAxes::Frame } else { WrenchAxes::Base };
        model.wrenches.push(Wrench { name: format!("wrench {index}"), at: moving(&mut rng, &model), axes });
    }
    model
}

/// As [`random_model_with_frame_forces`], with about a third of the coordinates driven: at least one, and not all.
pub fn random_driven_model(seed: u64, longest: usize) -> Model {
    let seeds = (0..).map(|k| seed + 100_000 * k);
    let mut models = seeds.map(|seed| random_model_with_frame_forces(seed, longest));
    let mut model = models.find(|model| model.coordinates.len() > 1).expect("seeds do not end");
    let mut rng = Rng::with_seed(seed ^ 0xd217e);
    let n = model.coordinates.len();
    let mut order: Vec<usize> = (0..n).collect();
    rng.shuffle(&mut order);
    let driven = rng.usize(1..=(n / 3).max(1));
    let (driven, free) = order.split_at_mut(driven);
    free.sort_unstable();
    let order = [&free[..], driven].concat();
    let place = |coordinate: usize| order.iter().position(|&other| other == coordinate).expect("every one");
    for joint in model.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
        if let Motion::Coordinate(coordinate) = &mut joint.motion {
            *coordinate = place(*coordinate);
        }
    }
    let of_followers = model.followers.iter_mut().flat_map(|follower| &mut follower.follows);
    for term in of_followers.chain(model.drives.iter_mut().flat_map(|drive| &mut drive.acts_on)) {
        term.coordinate = place(term.coordinate);
    }
    let links: Vec<usize> = order.iter().map(|&coordinate| model.coordinates[coordinate]).collect();
    (model.coordinates, model.driven) = (links[..free.len()].to_vec(), links[free.len()..].to_vec());
    let acts = |drive: &Drive| drive.acts_on.iter().any(|term| term.coordinate < free.len());
    model.drives.retain(|drive| drive.acts_on.is_empty() || acts(drive));
    model
}

fn attachment(rng: &mut Rng, model: &Model) -> Attachment {
    let link = rng.usize(0..model.links.len());
    let translation = direction(rng).map(|x| number(0.3 + x));
    Attachment { name: format!("on {link}"), link, pose: Pose { translation, rotation: rotation(rng) } }
}

/// The first link on the way to the base whose own joint moves; the base for what does not move.
fn carrier(model: &Model, mut link: usize) -> usize {
    while let Some(joint) = &model.links[link].joint {
        if moves(&model.links[link]) {
            break;
        }
        link = joint.parent;
    }
    link
}

fn moving(rng: &mut Rng, model: &Model) -> Attachment {
    loop {
        let at = attachment(rng, model);
        if carrier(model, at.link) != 0 {
            return at;
        }
    }
}

/// Two frames that move relative to each other.
fn separated(rng: &mut Rng, model: &Model) -> [Attachment; 2] {
    loop {
        let between = [attachment(rng, model), attachment(rng, model)];
        if carrier(model, between[0].link) != carrier(model, between[1].link) {
            return between;
        }
    }
}

/// A spring with a damper, or a smooth law.
fn pull(rng: &mut Rng, free: bool) -> Formula {
    let stretch = Formula::Subtract(Box::new(Formula::Position), Box::new(number(rng.f64())));
    let stiffness = number(30.0 * rng.f64());
    let stiffness = if free { product(Formula::Parameter(0), stiffness) } else { stiffness };
    let spring = product(stiffness, if rng.bool() { stretch } else { Formula::Power(Box::new(stretch), 3) });
    let damper = Formula::Call(Function::Tanh, Box::new(product(number(3.0), Formula::Velocity)));
    let damper = if rng.bool() { damper } else { Formula::Velocity };
    Formula::sum(spring, product(number(2.0 * rng.f64()), damper))
}

/// As [`random_model`], with about half of the joints that move or are held helical; every other one is
/// [coupled](random_coupled_model) besides.
pub fn random_helical_model(seed: u64, longest: usize) -> Model {
    let mut rng = Rng::with_seed(seed);
    let mut model = loop {
        let model = tree(&mut rng, longest);
        if model.coordinates.len() > 1 {
            break model;
        }
    };
    let joints = model.links.iter_mut().filter_map(|link| link.joint.as_mut());
    for (k, joint) in joints.filter(|joint| joint.motion != Motion::Fixed).enumerate() {
        if k == 0 || chance(&mut rng, 0.5) {
            joint.kind = JointKind::Helical { pitch: within(&mut rng, 0.4) };
        }
    }
    if seed.is_multiple_of(2) {
        couple(&mut rng, &mut model);
    }
    made_regular(rng, model)
}

/// Makes about a third of the coordinates followers, and lets drives act on several.
fn couple(rng: &mut Rng, model: &mut Model) {
    let moving = std::mem::take(&mut model.coordinates);
    let (own, followers): (Vec<usize>, Vec<usize>) = moving
        .iter()
        .enumerate()
        .map(|(k, link)| (k > 0 && chance(rng, 0.35), *link))
        .fold((vec![], vec![]), |(mut own, mut followers), (follows, link)| {
            if follows {
                followers.push(link)
            } else {
                own.push(link)
            }
            (own, followers)
        });
    let n = own.len();
    let free = !model.parameters.is_empty();
    for (index, &link) in followers.iter().enumerate() {
        let follows = followed(rng, n, free);
        let offset = if chance(rng, 0.5) { 0.0 } else { within(rng, 1.0) };
        model.followers.push(Follower { link, follows, offset });
        set_motion(model, link, Motion::Follower(n + index));
    }
    for (index, &link) in own.iter().enumerate() {
        set_motion(model, link, Motion::Coordinate(index));
    }
    model.coordinates = own;
    let links = model.links.clone();
    model.drives = drives(rng, &links);
    for drive in &mut model.drives {
        if n > 1 && !drive.acts_on.is_empty() && chance(rng, 0.4) {
            drive.acts_on = followed(rng, n, free);
            drive.friction = shaft_friction(rng);
        }
    }
}

fn set_motion(model: &mut Model, link: usize, motion: Motion) {
    if let Some(joint) = &mut model.links[link].joint {
        joint.motion = motion;
    }
}

/// One to three coordinates with ratios.
fn followed(rng: &mut Rng, coordinates: usize, free: bool) -> Vec<FollowedCoordinate> {
    let mut all: Vec<usize> = (0..coordinates).collect();
    rng.shuffle(&mut all);
    all.truncate(rng.usize(1..=3));
    let ratio = |rng: &mut Rng| {
        let ratio = match rng.u8(0..4) {
            0 => 1.0,
            1 => -1.0,
            _ => within(rng, 2.0) + 0.1,
        };
        if free && chance(rng, 0.3) { product(Formula::Parameter(1), number(ratio)) } else { number(ratio) }
    };
    all.into_iter().map(|coordinate| FollowedCoordinate { coordinate, ratio: ratio(rng) }).collect()
}

fn made_regular(mut rng: Rng, mut model: Model) -> Model {
    if condition(&mut rng, &model) > WORST_CONDITION {
        // Massless or point-like links left M singular.
        for link in model.links.iter_mut().filter(|link| moves(link)) {
            link.bodies.push(rigid_body(&mut rng, "core"));
        }
    }
    model
}

/// The worst condition number of M in a few states; infinite where it is not positive definite.
fn condition(rng: &mut Rng, model: &Model) -> f64 {
    let worst = |worst: f64, x: f64| worst.max(x);
    (0..3)
        .map(|_| {
            let sample = random_sample(rng, model);
            let oracle = Oracle { model, parameters: &sample.parameters };
            condition_of(&oracle.mass_matrix(&sample.y))
        })
        .fold(0.0, worst)
}

/// Condition number of a symmetric matrix, rows first; infinite where it is not positive definite.
pub fn condition_of(matrix: &[f64]) -> f64 {
    let n = matrix.len().isqrt();
    let values = DMatrix::from_row_slice(n, n, matrix).symmetric_eigenvalues();
    let (low, high) = (values.min(), values.max());
    if low > 0.0 { high / low } else { f64::INFINITY }
}

/// A state within a turn, velocities of a few rad/s, parameters near their defaults.
pub fn random_sample(rng: &mut Rng, model: &Model) -> Sample {
    let n = model.coordinates.len();
    let m = model.inputs().count();
    let mut array = |len: usize, size: f64| (0..len).map(|_| within(rng, size)).collect();
    let (y, v, a, u) = (array(n, PI), array(n, 2.0), array(n, 3.0), array(m, 5.0));
    let parameters = model.parameters.iter();
    let parameters = parameters.map(|parameter| parameter.default * (1.0 + within(rng, 0.3))).collect();
    Sample { y, v, a, u, parameters }
}

fn moves(link: &Link) -> bool {
    let motion = link.joint.as_ref().map(|joint| joint.motion);
    matches!(motion, Some(Motion::Coordinate(_) | Motion::Follower(_)))
}

fn chance(rng: &mut Rng, probability: f64) -> bool {
    rng.f64() < probability
}

/// Between −size and size.
fn within(rng: &mut Rng, size: f64) -> f64 {
    size * (2.0 * rng.f64() - 1.0)
}

fn number(x: f64) -> Formula {
    Formula::Number(x)
}

fn product(a: Formula, b: Formula) -> Formula {
    Formula::Multiply(Box::new(a), Box::new(b))
}

fn tree(rng: &mut Rng, longest: usize) -> Model {
    let count = rng.usize(1..=longest);
    let parameters = parameters(rng);
    let mut links = vec![Link { name: "base".into(), joint: None, bodies: vec![] }];
    let mut moving = Vec::new();
    while moving.len() < count {
        let index = links.len();
        let motion = match rng.f64() {
            x if x < 0.1 => Motion::Fixed,
            x if x < 0.2 => Motion::Held(within(rng, PI)),
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

fn gravity(rng: &mut Rng) -> [f64; 3] {
    match rng.u8(0..4) {
        0 => [0.0; 3],
        1 => [0.0, 0.0, -9.81],
        2 => [0.0, -9.81, 0.0],
        _ => [within(rng, 9.0), within(rng, 9.0), within(rng, 9.0)],
    }
}

/// None, or a scale of masses and a scale of lengths.
fn parameters(rng: &mut Rng) -> Vec<Parameter> {
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

fn link(rng: &mut Rng, index: usize, motion: Motion, free: bool) -> Link {
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

fn pose(rng: &mut Rng, free: bool) -> Pose {
    let translation = match rng.u8(0..4) {
        0 => [0.0; 3],
        1 => scaled(principal(rng), within(rng, 0.5)),
        _ => [within(rng, 0.5), within(rng, 0.5), within(rng, 0.5)],
    };
    let mut translation = translation.map(number);
    if free && chance(rng, 0.3) {
        let [x, y, z] = translation;
        translation = [product(Formula::Parameter(1), x), y, z];
    }
    Pose { translation, rotation: rotation(rng) }
}

fn principal(rng: &mut Rng) -> [f64; 3] {
    let mut axis = [0.0; 3];
    axis[rng.usize(0..3)] = if rng.bool() { 1.0 } else { -1.0 };
    axis
}

fn axis(rng: &mut Rng) -> [f64; 3] {
    if chance(rng, 0.6) { principal(rng) } else { direction(rng) }
}

fn direction(rng: &mut Rng) -> [f64; 3] {
    loop {
        let a = [within(rng, 1.0), within(rng, 1.0), within(rng, 1.0)];
        let length = a[0].hypot(a[1]).hypot(a[2]);
        if (0.1..1.0).contains(&length) {
            return scaled(a, 1.0 / length);
        }
    }
}

fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}

/// None, quarter turns, or any.
fn rotation(rng: &mut Rng) -> [[f64; 3]; 3] {
    let x = principal(rng);
    match rng.u8(0..3) {
        0 => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        1 => loop {
            let y = principal(rng);
            let z = cross(x, y);
            if z != [0.0; 3] {
                return [x, y, z];
            }
        },
        _ => {
            let x = direction(rng);
            let other = cross(x, direction(rng));
            let length = other[0].hypot(other[1]).hypot(other[2]);
            let y = scaled(other, 1.0 / length);
            [x, y, cross(x, y)]
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn bodies(rng: &mut Rng, free: bool) -> Vec<Body> {
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

fn point_mass(rng: &mut Rng, name: &str) -> Body {
    Body {
        name: name.into(),
        mass: number(0.2 + 2.0 * rng.f64()),
        center_of_mass: [within(rng, 0.3), within(rng, 0.3), within(rng, 0.3)].map(number),
        inertia: [0.0; 6].map(number),
    }
}

/// Inertia from principal second moments in random axes, so that it is that of a real body.
fn rigid_body(rng: &mut Rng, name: &str) -> Body {
    let axes = rotation(rng);
    let second = [0, 1, 2].map(|_| 0.002 + 0.05 * rng.f64());
    let trace: f64 = second.iter().sum();
    let entry = |i: usize, j: usize| {
        let moment: f64 = (0..3).map(|k| axes[k][i] * second[k] * axes[k][j]).sum();
        number(if i == j { trace - moment } else { -moment })
    };
    Body {
        inertia: [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)],
        ..point_mass(rng, name)
    }
}

/// `−s (y − r) − d v`, or a cubic one.
fn springs(rng: &mut Rng) -> Vec<Formula> {
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
fn friction(rng: &mut Rng, free: bool) -> Vec<FrictionTerm> {
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
fn shaft_friction(rng: &mut Rng) -> Vec<FrictionTerm> {
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

fn drives(rng: &mut Rng, links: &[Link]) -> Vec<Drive> {
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

fn drive(rng: &mut Rng, joint: &Joint, acts_on: Vec<FollowedCoordinate>, links: usize) -> Drive {
    let has_rotor = chance(rng, 0.6);
    let sign = if chance(rng, 0.2) { -1.0 } else { 1.0 };
    Drive {
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
        friction: Vec::new(),
    }
}

fn frame(rng: &mut Rng, index: usize, links: usize) -> Frame {
    Frame {
        name: format!("Frame {index}"),
        identifier: format!("f{index}"),
        link: if index == 0 { links - 1 } else { rng.usize(0..links) },
        pose: pose(rng, false),
    }
}
