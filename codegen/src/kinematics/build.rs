//! From a model to its mechanism.

use super::inertia::{RegroupChoice, regroup};
use super::mechanism::Mechanism;
use super::{frames, tree};
use crate::graph::Graph;
use crate::model::Model;

impl<'g> Mechanism<'g> {
    /// The mechanism of a model, with all inertial constants where the description puts them.
    pub fn new(graph: &'g Graph, model: &Model) -> Self {
        frames::assign(graph, model, &tree::moving_bodies(graph, model))
    }

    /// Moves inertial constants towards the base; M, k, q and energies do not change.
    pub fn regrouped(mut self, choices: &[RegroupChoice]) -> Self {
        regroup(&mut self.bodies, &mut self.base_moments, choices);
        self
    }
}
