//! Random robots with spherical and floating joints, and their motion in the angles of the chains that stand for these.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{
    Attachment, Body, ForceEffect, Joint, JointKind, JointPosition, Limits, Link, Model, Motion, Pose,
    QuaternionJoint, QuaternionKind,
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::oracle::Number;

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

/// Velocities of a model with quaternions from positions and velocities of its chains: those of the bodies in their own
/// frames. Rotations are `R_x(a) R_y(b) R_z(c)`.
pub fn velocities<T: Number>(model: &Model, y: &[T], v: &[T]) -> Vec<T> {
    let mut result = v.to_vec();
    for joint in &model.quaternion_joints {
        let turning = joint.coordinates().end - 3;
        let (sines, cosines): (Vec<T>, Vec<T>) = (0..3).map(|k| y[turning + k].sin_cos()).unzip();
        let rate = |k: usize| v[turning + k];
        // (R_y R_z)ᵀ e_x ȧ + R_zᵀ e_y ḃ + e_z ċ
        let (x, z) = (cosines[1] * rate(0), sines[1] * rate(0));
        result[turning] = cosines[2] * x + sines[2] * rate(1);
        result[turning + 1] = cosines[2] * rate(1) - sines[2] * x;
        result[turning + 2] = z + rate(2);
        if joint.kind == QuaternionKind::Floating {
            let slides = [v[joint.first], v[joint.first + 1], v[joint.first + 2]];
            let turned = |v: [T; 3], axis: usize| {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let (s, c) = (sines[axis], cosines[axis]);
                let mut turned = v;
                turned[i] = c * v[i] + s * v[j];
                turned[j] = c * v[j] - s * v[i];
                turned
            };
            let own = turned(turned(turned(slides, 0), 1), 2);
            result[joint.first..turning].copy_from_slice(&own);
        }
    }
    result
}

/// Positions with quaternions from those of the chains.
pub fn positions(model: &Model, y: &[f64]) -> Vec<f64> {
    let entries = model.joint_positions().flat_map(|joint| match joint {
        JointPosition::Coordinate(coordinate) => vec![y[coordinate]],
        JointPosition::Quaternion(joint) => {
            let own = &y[joint.coordinates()];
            let (slides, angles) = own.split_at(own.len() - 3);
            let about = |axis: nalgebra::Unit<Vector3<f64>>, k: usize| {
                UnitQuaternion::from_axis_angle(&axis, angles[k])
            };
            let turn =
                about(Vector3::x_axis(), 0) * about(Vector3::y_axis(), 1) * about(Vector3::z_axis(), 2);
            slides.iter().copied().chain([turn.i, turn.j, turn.k, turn.w]).collect()
        }
    });
    entries.collect()
}

/// Brings the quaternions of positions to unit length; the identity takes the place of zero.
pub fn normalize(model: &Model, y: &mut [f64]) {
    for joint in &model.quaternion_joints {
        let first = model.first_position(joint.first) + joint.kind.quaternion();
        let quaternion = &mut y[first..first + 4];
        let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            quaternion[3] = 1.0;
        } else {
            quaternion.iter_mut().for_each(|x| *x /= length);
        }
    }
}

/// Rates of the positions at velocities: ẏ = T(y) v. Quaternions are taken for unit ones.
pub fn rates<T: Number>(model: &Model, y: &[T], v: &[T]) -> Vec<T> {
    let half = T::from(0.5);
    let of_joint = |joint: JointPosition| match joint {
        JointPosition::Coordinate(coordinate) => vec![v[coordinate]],
        JointPosition::Quaternion(joint) => {
            let q = model.first_position(joint.first) + joint.kind.quaternion();
            let ([x, y, z, w], turning) = ([y[q], y[q + 1], y[q + 2], y[q + 3]], joint.coordinates().end - 3);
            let [a, b, c] = [v[turning], v[turning + 1], v[turning + 2]];
            let slides =
                v[joint.first..turning].chunks(3).flat_map(|l| turned([x, y, z], w, [l[0], l[1], l[2]]));
            let turns = [
                w * a + y * c - z * b,
                w * b + z * a - x * c,
                w * c + x * b - y * a,
                -(x * a + y * b + z * c),
            ];
            slides.chain(turns.map(|rate| half * rate)).collect()
        }
    };
    model.joint_positions().flat_map(of_joint).collect()
}

/// A vector turned by a unit quaternion: `r + 2 w (q × r) + 2 q × (q × r)`.
fn turned<T: Number>(q: [T; 3], w: T, r: [T; 3]) -> [T; 3] {
    let cross = |a: [T; 3], b: [T; 3]| -> [T; 3] {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[j] * b[k] - a[k] * b[j]
        })
    };
    let once = cross(q, r).map(|x| x * T::from(2.0));
    let twice = cross(q, once);
    std::array::from_fn(|i| r[i] + w * once[i] + twice[i])
}
