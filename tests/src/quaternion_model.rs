//! Random robots with spherical and floating joints.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{
    Attachment, Body, ForceEffect, Joint, JointKind, Limits, Link, Model, Motion, Pose, QuaternionJoint,
    QuaternionKind,
};

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The model with one of its turning joints made spherical, where one stands by itself, and mostly with a floating base; where
/// the base stays fixed, that joint floats.
pub fn with_quaternions(mut model: Model, seed: u64) -> Model {
    let mut rng = Rng::with_seed(seed ^ 0x5bd1);
    let free: Vec<usize> = (0..model.coordinates.len()).filter(|&k| stands_alone(&model, k)).collect();
    let chosen = free.get(rng.usize(0..free.len().max(1))).copied();
    let is_base_free = chosen.is_none() || rng.u8(0..4) > 0;
    if let Some(coordinate) = chosen {
        let kind = if is_base_free { QuaternionKind::Spherical } else { QuaternionKind::Floating };
        make_free(&mut model, coordinate, kind);
    }
    if is_base_free {
        free_base(&mut model);
    }
    model
}

/// A revolute joint that nothing follows and no shared drive moves.
fn stands_alone(model: &Model, coordinate: usize) -> bool {
    let joint = model.links[model.coordinates[coordinate]].joint.as_ref();
    let turns = joint.is_some_and(|joint| matches!(joint.kind, JointKind::Revolute | JointKind::Continuous));
    let followed = model.followers.iter().flat_map(|follower| &follower.follows);
    let shared = model.drives.iter().filter(|drive| drive.acts_on.len() > 1);
    let mut others = followed.chain(shared.flat_map(|drive| &drive.acts_on));
    turns && others.all(|term| term.coordinate != coordinate)
}

fn attachments(model: &mut Model) -> Vec<&mut Attachment> {
    let inputs = model.force_inputs.iter_mut().flat_map(|input| match &mut input.effect {
        ForceEffect::Wrench { at, .. } => vec![at],
        ForceEffect::Pull(between) => between.iter_mut().collect(),
    });
    let forces = model.point_forces.iter_mut().flat_map(|force| force.between.iter_mut());
    let wrenches = model.wrenches.iter_mut().map(|wrench| &mut wrench.at);
    inputs.chain(forces).chain(wrenches).collect()
}

/// Gives links and coordinates from `link` and behind `coordinate` on higher numbers.
fn renumber(model: &mut Model, [link, links]: [usize; 2], [coordinate, coordinates]: [usize; 2]) {
    let place = |k: &mut usize| *k += if *k >= link { links } else { 0 };
    let behind = |k: &mut usize| *k += if *k > coordinate { coordinates } else { 0 };
    let count = model.coordinates.len();
    for joint in model.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
        place(&mut joint.parent);
        match &mut joint.motion {
            Motion::Coordinate(k) => behind(k),
            Motion::Follower(k) => *k += coordinates,
            Motion::Fixed | Motion::Held(_) => {}
        }
    }
    debug_assert!(count > coordinate || coordinate == usize::MAX || count == 0);
    model.coordinates.iter_mut().for_each(place);
    model.followers.iter_mut().for_each(|follower| {
        place(&mut follower.link);
        follower.follows.iter_mut().for_each(|term| behind(&mut term.coordinate));
    });
    model.drives.iter_mut().for_each(|drive| {
        place(&mut drive.carrier);
        drive.acts_on.iter_mut().for_each(|term| behind(&mut term.coordinate));
    });
    model.frames.iter_mut().for_each(|frame| place(&mut frame.link));
    model.quaternion_joints.iter_mut().for_each(|joint| behind(&mut joint.first));
    attachments(model).into_iter().for_each(|at| place(&mut at.link));
}

fn part(name: &str, parent: usize, origin: Pose, kind: JointKind, axis: usize, coordinate: usize) -> Joint {
    Joint {
        name: name.into(),
        identifier: name.into(),
        parent,
        kind,
        origin,
        axis: std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 }),
        motion: Motion::Coordinate(coordinate),
        limits: Limits::default(),
        springs: vec![],
        friction: vec![],
        load_friction: vec![],
    }
}

fn identity() -> Pose {
    Pose { translation: [0.0; 3].map(Formula::Number), rotation: IDENTITY }
}

/// A body, so that every velocity of its joint moves something.
fn ballast(name: &str) -> Body {
    Body {
        name: name.into(),
        mass: Formula::Number(1.5),
        center_of_mass: [0.1, -0.2, 0.05].map(Formula::Number),
        inertia: [0.11, 0.01, -0.02, 0.13, 0.015, 0.09].map(Formula::Number),
    }
}

fn make_free(model: &mut Model, coordinate: usize, joint: QuaternionKind) {
    const NAMES: [&str; 6] = ["ball_x", "ball_y", "ball_z", "ball_rx", "ball_ry", "ball_rz"];
    let link = model.coordinates[coordinate];
    model.drives.retain(|drive| drive.acts_on.iter().all(|term| term.coordinate != coordinate));
    let old = model.links[link].joint.clone().expect("its joint moves");
    let count = joint.velocities();
    renumber(model, [link, count - 1], [coordinate, count - 1]);
    let chain = |k: usize| {
        let (parent, origin) = match k {
            0 => (old.parent, old.origin.clone()),
            _ => (link + k - 1, identity()),
        };
        let place = 6 - count + k;
        let kind = if place < 3 { JointKind::Prismatic } else { JointKind::Continuous };
        part(NAMES[place], parent, origin, kind, place % 3, coordinate + k)
    };
    let last = &mut model.links[link];
    last.joint = Some(chain(count - 1));
    last.bodies.push(ballast("ball"));
    let before = (0..count - 1).map(|k| {
        let joint = chain(k);
        Link { name: joint.name.clone(), joint: Some(joint), bodies: vec![] }
    });
    let before: Vec<Link> = before.collect();
    model.links.splice(link..link, before);
    model.coordinates.splice(coordinate..coordinate, link..link + count - 1);
    let joint = QuaternionJoint { name: "ball".into(), kind: joint, first: coordinate };
    model.quaternion_joints.push(joint);
}

fn free_base(model: &mut Model) {
    for joint in &mut model.quaternion_joints {
        joint.first += 6;
    }
    let quaternion_joints = std::mem::take(&mut model.quaternion_joints);
    renumber(model, [0, 6], [0, 0]);
    for joint in model.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
        if let Motion::Coordinate(k) | Motion::Follower(k) = &mut joint.motion {
            *k += 6;
        }
    }
    let terms = model.followers.iter_mut().flat_map(|follower| &mut follower.follows);
    terms
        .chain(model.drives.iter_mut().flat_map(|drive| &mut drive.acts_on))
        .for_each(|term| term.coordinate += 6);
    const NAMES: [&str; 6] = ["base_x", "base_y", "base_z", "base_rx", "base_ry", "base_rz"];
    let kind = |k: usize| if k < 3 { JointKind::Prismatic } else { JointKind::Continuous };
    let chain = |k: usize| part(NAMES[k], k, identity(), kind(k), k % 3, k);
    model.links[0].joint = Some(chain(5));
    model.links[0].bodies.push(ballast("trunk"));
    let mut links = vec![Link { name: "world".into(), joint: None, bodies: vec![] }];
    links.extend((0..5).map(|k| Link { name: NAMES[k].into(), joint: Some(chain(k)), bodies: vec![] }));
    model.links.splice(0..0, links);
    model.coordinates.splice(0..0, 1..=6);
    let base = QuaternionJoint { name: "base".into(), kind: QuaternionKind::Floating, first: 0 };
    model.quaternion_joints = std::iter::once(base).chain(quaternion_joints).collect();
}
