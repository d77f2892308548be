//! Random robots: trees of every kind of joint, placement, body, rotor and force law that a model can hold.

mod couplings;
mod frame_forces;
pub(crate) mod numbers;
mod tree;

use std::f64::consts::PI;

use fastrand::Rng;
use gelenk_codegen::model::{
    Drive, ForceEffect, ForceInput, JointKind, Link, Model, Motion, PointForce, Wrench, WrenchAxes,
};
use nalgebra::DMatrix;

use crate::oracle::Oracle;
use couplings::couple;
use frame_forces::{moving, pull, separated};
use numbers::{chance, number, rigid_body, within};
use tree::tree;

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
