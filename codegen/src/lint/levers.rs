//! Columns of B for forces at frames, at seeded states.

use super::distances::origin;
use crate::model::pose::rotate_numbers;
use crate::model::regularity::{child_from_parent, motion_axis, positions};
use crate::model::{Actuator, Attachment, Drive, FollowedCoordinate, ForceEffect, Model};
use crate::random::Random;
use gelenk_formula::Formula;

/// Relative difference below which directions, ratios and places are equal: a description writes them in decimals.
pub(super) const ROUNDING: f64 = 1e-9;

/// Number of seeded states.
const STATES: usize = 16;
const SEED: u64 = 0x6c65_7665_7273;

/// A robot at seeded states. It gives the columns of B for its inputs.
pub(super) struct Levers<'m> {
    model: &'m Model,
    /// Values of the free parameters.
    parameters: Vec<f64>,
    /// For each link, the coordinates that its joint follows.
    follows: Vec<Vec<FollowedCoordinate>>,
    /// Positions of the links' joints.
    states: Vec<Vec<f64>>,
}

impl<'m> Levers<'m> {
    pub(super) fn new(model: &'m Model, parameters: Vec<f64>) -> Self {
        let mut random = Random::new(SEED);
        let mut state = || positions(model, &parameters, |_, [low, high]| random.between(low, high));
        let states = (0..STATES).map(|_| state()).collect();
        let mut follows = vec![Vec::new(); model.links.len()];
        for moving in model.moving_joints() {
            follows[moving.link] = moving.follows;
        }
        Self { model, parameters, follows, states }
    }

    /// Whether a wrench that is fixed in its frame acts at some state on a coordinate that is not driven.
    pub(super) fn are_moved_by(&self, at: &Attachment, wrench: &[Formula; 6]) -> bool {
        self.states.iter().any(|state| {
            let (forces, size) = self.forces(state, at.link, self.in_link(at, wrench));
            forces.iter().any(|force| force.abs() > ROUNDING * size)
        })
    }

    /// Columns of B for an input, one for each state.
    pub(super) fn columns(&self, input: Actuator<'_>) -> Vec<Vec<f64>> {
        let at = |state: &Vec<f64>| match input {
            Actuator::Drive(drive) => self.of_drive(drive),
            Actuator::Force(force) => match &force.effect {
                ForceEffect::Wrench { at, wrench } => self.forces(state, at.link, self.in_link(at, wrench)).0,
                ForceEffect::Pull(between) => self.pull(state, between),
            },
        };
        self.states.iter().map(at).collect()
    }

    fn of_drive(&self, drive: &Drive) -> Vec<f64> {
        let mut forces = vec![0.0; self.model.motion_count()];
        for term in &drive.acts_on {
            forces[term.coordinate] += self.value(&term.ratio);
        }
        forces.truncate(self.model.coordinates.len());
        forces
    }

    /// Generalized forces of a unit force that pulls two frames together, times their distance.
    fn pull(&self, state: &[f64], between: &[Attachment; 2]) -> Vec<f64> {
        let [from, to] = between.each_ref().map(|at| origin(self.model, &self.parameters, state, at));
        let gap: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
        let ends = between.iter().zip([1.0, -1.0]).map(|(at, sign)| {
            let force = self.seen_from(state, at.link, gap.map(|x| sign * x));
            self.forces(
                state,
                at.link,
                about(&at.pose.translation.each_ref().map(|x| self.value(x)), &force, &[0.0; 3]),
            )
            .0
        });
        let sum = ends.reduce(|a, b| a.iter().zip(b).map(|(a, b)| a + b).collect());
        sum.unwrap_or_default()
    }

    /// A direction in the base frame, expressed in the axes of a link.
    fn seen_from(&self, state: &[f64], link: usize, direction: [f64; 3]) -> [f64; 3] {
        let joint = |link: usize| self.model.links[link].joint.as_ref();
        let path = std::iter::successors(Some(link), |&link| joint(link).map(|joint| joint.parent));
        let path: Vec<usize> = path.collect();
        path.into_iter().rev().filter_map(|link| Some((link, joint(link)?))).fold(
            direction,
            |outer, (link, joint)| {
                let transform = child_from_parent(joint, state[link], &self.parameters);
                std::array::from_fn(|i| (0..3).map(|j| transform[i][j] * outer[j]).sum())
            },
        )
    }

    /// Generalized forces of a wrench on a link, and the largest magnitude of the wrench about the origins of
    /// the links on the path to the base.
    ///
    /// - `acting`: moment about the origin of the link, then force
    fn forces(&self, state: &[f64], mut link: usize, mut acting: [f64; 6]) -> (Vec<f64>, f64) {
        let (mut forces, mut size) = (vec![0.0; self.model.motion_count()], 0.0_f64);
        while let Some(joint) = &self.model.links[link].joint {
            size = size.max(dot(&acting, &acting).sqrt());
            let along = dot(&motion_axis(joint), &acting);
            for term in &self.follows[link] {
                forces[term.coordinate] += along * self.value(&term.ratio);
            }
            let transform = child_from_parent(joint, state[link], &self.parameters);
            acting = std::array::from_fn(|j| (0..6).map(|i| transform[i][j] * acting[i]).sum());
            link = joint.parent;
        }
        forces.truncate(self.model.coordinates.len());
        (forces, size)
    }

    /// A wrench in its frame as a moment about the origin of the frame's link, then a force, in the link's axes.
    fn in_link(&self, at: &Attachment, wrench: &[Formula; 6]) -> [f64; 6] {
        let turned = |vector: [f64; 3]| rotate_numbers(&at.pose.rotation, &vector);
        let [force, moment] = [[0, 1, 2], [3, 4, 5]].map(|part| turned(part.map(|k| self.value(&wrench[k]))));
        about(&at.pose.translation.each_ref().map(|x| self.value(x)), &force, &moment)
    }

    fn value(&self, formula: &Formula) -> f64 {
        formula.evaluate(&self.parameters, 0.0, 0.0)
    }
}

/// Moment and force about the origin, of a force and a moment at a point.
fn about([x, y, z]: &[f64; 3], [a, b, c]: &[f64; 3], [l, m, n]: &[f64; 3]) -> [f64; 6] {
    [l + y * c - z * b, m + z * a - x * c, n + x * b - y * a, *a, *b, *c]
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
