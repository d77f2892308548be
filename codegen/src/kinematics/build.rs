//! Converts a model to its moving bodies, joints and rotors, and copies them to the graph of each function.

use super::inertia::{RegroupChoice, regroup};
use super::mechanism::{Body, Mechanism, Rotor};
use super::number::{Number, Numbers};
use super::transmission::{Followed, Transmission};
use super::{frames, tree};
use crate::graph::{Graph, Scalar};
use crate::model::Model;
use crate::spatial::Pose;

impl Mechanism<Number> {
    /// Creates the moving bodies, joints and rotors of a model, with the inertial constants of the
    /// description.
    pub fn new(model: &Model) -> Self {
        let graph = Graph::new();
        frames::assign(&graph, model, &tree::moving_bodies(&graph, model)).by_itself()
    }

    /// Copies this mechanism to a graph, so that its numbers become scalars of the graph.
    pub fn on<'g>(&self, graph: &'g Graph) -> Mechanism<Scalar<'g>> {
        let nodes = graph.copied(&self.graph);
        self.with(graph, |number| match number {
            Number::Constant(value) => graph.constant(value),
            Number::Formula(edge) => edge.signed(&nodes),
        })
    }
}

impl Mechanism<Scalar<'_>> {
    /// Shifts inertial constants that act only as sums from each body to its parent. The equations of motion
    /// and the energies do not change.
    pub fn regrouped(mut self, choices: &[RegroupChoice]) -> Self {
        regroup(&mut self.bodies, &mut self.base_moments, choices);
        self
    }

    /// A copy of this mechanism without a graph.
    pub fn by_itself(&self) -> Mechanism<Number> {
        self.with(self.graph.to_nodes(), Number::from)
    }
}

impl<S: Numbers> Mechanism<S> {
    /// The same mechanism with another number type.
    fn with<T: Numbers>(&self, graph: T::Graph, to: impl Fn(S) -> T) -> Mechanism<T> {
        Mechanism {
            graph,
            coordinates: self.coordinates,
            driven: self.driven,
            positions: self.positions.clone(),
            bodies: self.bodies.iter().map(|body| body.with(&to)).collect(),
            gravity: self.gravity.map(&to),
            rotors: self.rotors.iter().map(|rotor| rotor.with(&to)).collect(),
            base_moments: self.base_moments.map(&to),
            links: self.links.iter().map(|(body, pose)| (*body, pose.with(&to))).collect(),
        }
    }
}

impl<S: Copy> Body<S> {
    fn with<T>(&self, to: impl Fn(S) -> T) -> Body<T> {
        Body {
            name: self.name.clone(),
            identifier: self.identifier.clone(),
            joint: self.joint,
            is_screw_slide: self.is_screw_slide,
            transmission: self.transmission.with(&to),
            chain: self.chain,
            attitude: self.attitude.map(|attitude| attitude.map(&to)),
            parent: self.parent,
            axis: self.axis,
            twist: self.twist,
            translation: self.translation.map(&to),
            lift: to(self.lift),
            offset: self.offset,
            moments: self.moments.map(&to),
            length_unit: self.length_unit,
            unit_ratio: self.unit_ratio,
        }
    }
}

impl<S: Copy> Rotor<S> {
    fn with<T>(&self, to: impl Fn(S) -> T) -> Rotor<T> {
        Rotor {
            transmission: self.transmission.with(&to),
            ratio: to(self.ratio),
            driven: self.driven,
            carrier: self.carrier,
            axis: self.axis.map(&to),
            inertia: to(self.inertia),
        }
    }
}

impl<S: Copy> Transmission<S> {
    fn with<T>(&self, to: impl Fn(S) -> T) -> Transmission<T> {
        let term = |term: &Followed<S>| Followed { coordinate: term.coordinate, ratio: to(term.ratio) };
        Transmission { terms: self.terms.iter().map(term).collect() }
    }
}

impl<S> Pose<S> {
    fn with<T>(self, to: impl Fn(S) -> T) -> Pose<T> {
        Pose { rotation: self.rotation, translation: self.translation.map(to) }
    }
}
