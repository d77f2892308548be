//! How far frames are apart, at seeded states and at the ends of the joints' ranges.

use super::regularity::{child_from_parent, positions, product_and_sum};
use super::{Attachment, Model};
use crate::random::Random;

/// So many seeded states are tried.
const STATES: usize = 64;
const SEED: u64 = 0x6469_7374_616e_6365;

/// Distances between two frames [m], at the described values of free parameters: with all joints at 0, or at
/// the positions closest to it, with all at their lowest, at their highest position, and at seeded states.
pub(super) fn distances(model: &Model, between: &[Attachment; 2]) -> Vec<f64> {
    let described: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    let mut random = Random::new(SEED);
    let ends: [fn([f64; 2]) -> f64; 3] =
        [|[low, high]| 0.0_f64.clamp(low, high), |[low, _]| low, |[_, high]| high];
    let mut states: Vec<Vec<f64>> =
        ends.map(|end| positions(model, &described, |_, range| end(range))).into();
    for _ in 0..STATES {
        states.push(positions(model, &described, |_, [low, high]| random.between(low, high)));
    }
    states.iter().map(|state| distance(model, &described, state, between)).collect()
}

fn distance(model: &Model, described: &[f64], positions: &[f64], between: &[Attachment; 2]) -> f64 {
    let [a, b] = between.each_ref().map(|at| origin(model, described, positions, at));
    (0..3).map(|k| (b[k] - a[k]) * (b[k] - a[k])).sum::<f64>().sqrt()
}

/// Origin of a frame in the base frame.
fn origin(model: &Model, described: &[f64], positions: &[f64], at: &Attachment) -> [f64; 3] {
    let mut point = at.pose.translation.each_ref().map(|x| x.evaluate(described, 0.0, 0.0));
    let mut link = at.link;
    while let Some(joint) = &model.links[link].joint {
        let transform = child_from_parent(joint, positions[link], described);
        // The transform of motions holds Rᵀ and −Rᵀ [r]ₓ.
        let rotation: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| transform[j][i]));
        let cross = |i: usize, j: usize| -(0..3).map(|k| rotation[i][k] * transform[k + 3][j]).sum::<f64>();
        point = product_and_sum(&rotation, &point, &[cross(2, 1), cross(0, 2), cross(1, 0)]);
        link = joint.parent;
    }
    point
}
