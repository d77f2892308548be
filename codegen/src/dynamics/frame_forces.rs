//! Forces at frames: forces between two frames, and wrenches.
//!
//! A force F that pulls the origins of two frames together has the power −F l̇ with the distance l of the
//! origins. Its generalized forces are therefore −F ∂l/∂y. The generalized forces of a wrench are Jᵀ w with
//! the force and moment w and the Jacobian J of its frame.

use std::cell::LazyCell;

use super::formulation::Formulation;
use super::recursion::frame_motion::BasePoses;
use super::recursion::placement::{Placement, place};
use super::tangent::gradient_along;
use crate::graph::{Graph, Scalar};
use crate::kinematics::{JointAxis, Mechanism, lower, lower_pose, lower_with};
use crate::model::{Attachment, ForceEffect, ForceInput, Model, PointForce, WrenchAxes, identifier};
use crate::spatial::{Force, Pose, Vector3, rotate};
use gelenk_formula::{Formula, Function};

/// Forces at frames of a robot at given coordinates.
pub struct FrameForces<'a, 'g> {
    model: &'a Model,
    mechanism: Mechanism<Scalar<'g>>,
    placements: Vec<Placement<'g>>,
    y: &'a [Scalar<'g>],
}

/// The distance l of the origins of two frames.
struct Distance<'g> {
    /// Distance l of the origins of two frames.
    length: Scalar<'g>,
    /// Gradient ∂l/∂y of the distance l of two frames.
    gradient: Vec<Scalar<'g>>,
}

/// A point in the frame of a body. The frame is the base frame if the body is `None`.
#[derive(Clone, Copy)]
struct Place<'g> {
    body: Option<usize>,
    point: Vector3<Scalar<'g>>,
}

impl<'a, 'g> FrameForces<'a, 'g> {
    /// Places the bodies at the coordinates `y`.
    ///
    /// - `mechanism`: a mechanism in metres, with equations in the bodies' own frames
    pub fn new(model: &'a Model, mechanism: Mechanism<Scalar<'g>>, y: &'a [Scalar<'g>]) -> Self {
        let placements = place(&mechanism, &Formulation::plain(mechanism.bodies.len()), y);
        Self { model, mechanism, placements, y }
    }

    fn graph(&self) -> &'g Graph {
        self.mechanism.graph
    }

    /// Generalized forces of the force laws between frames (`[[forces]]`), a part of the applied forces.
    pub fn law_forces(&self, v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let mut forces = vec![self.graph().constant(0.0); self.y.len()];
        for force in &self.model.point_forces {
            let name = identifier(&force.name);
            let distance = self.distance(&force.between, &name);
            let rate = named(distance.rate(v), || format!("rate_{name}"));
            let pull = lower_with(self.graph(), &force.law, distance.length, rate);
            distance.add_pull(named(pull, || format!("pull_{name}")), &mut forces);
        }
        forces
    }

    /// Potential energies ∫ F dl of the force laws that have a potential \[J\]. F is positive if it pulls the
    /// origins together, and l is their distance.
    pub fn law_energies(&self) -> Vec<Scalar<'g>> {
        let energy = |force: &PointForce| {
            let law = force.law.energy()?;
            let length = self.length(&force.between, &identifier(&force.name)).1;
            Some(lower_with(self.graph(), &law, length, length.constant(0.0)))
        };
        self.model.point_forces.iter().filter_map(energy).collect()
    }

    /// Columns of the input matrix B for the inputs at frames. Each column has one entry per coordinate.
    pub fn input_columns(&self) -> Vec<Vec<Scalar<'g>>> {
        let zero = self.graph().constant(0.0);
        let column = |input: &ForceInput| {
            let mut column = vec![zero; self.y.len()];
            match &input.effect {
                ForceEffect::Pull(between) => {
                    self.distance(between, &identifier(&input.name))
                        .add_pull(zero.constant(1.0), &mut column);
                }
                ForceEffect::Wrench { at, wrench } => self.add_wrench(at, self.lowered(wrench), &mut column),
            }
            column
        };
        self.model.force_inputs.iter().map(column).collect()
    }

    /// Generalized forces `Σ Jᵀ w` of wrenches w that are arguments of functions. J is the Jacobian of the
    /// wrench's frame.
    pub fn wrench_forces(&self, wrenches: &[Force<'g>]) -> Vec<Scalar<'g>> {
        let mut forces = vec![self.graph().constant(0.0); self.y.len()];
        let described = self.model.wrenches.iter().zip(wrenches);
        let poses = LazyCell::new(|| BasePoses::new(self.mechanism.clone(), self.y));
        for (described, wrench) in described {
            match described.axes {
                WrenchAxes::Base => {
                    let frame = lower_pose(self.graph(), &described.at.pose);
                    poses.add_wrench(described.at.link, &frame, *wrench, &mut forces);
                }
                WrenchAxes::Frame => self.add_wrench(&described.at, *wrench, &mut forces),
            }
        }
        forces
    }

    fn lowered(&self, wrench: &[Formula; 6]) -> Force<'g> {
        Force::of_wrench(&wrench.each_ref().map(|entry| lower(self.graph(), entry)))
    }

    /// Adds the generalized forces of a wrench at the origin of a frame, in the frame's axes. The wrench is
    /// passed from body to body towards the base.
    fn add_wrench(&self, at: &Attachment, wrench: Force<'g>, forces: &mut [Scalar<'g>]) {
        let (mut next, frame) = self.in_body(at);
        let mut force = rotate(&frame.rotation, wrench.force);
        let mut moment = rotate(&frame.rotation, wrench.moment) + frame.translation.cross(force);
        while let Some(index) = next {
            let (body, placement) = (&self.mechanism.bodies[index], &self.placements[index]);
            let along = match body.axis {
                JointAxis::Revolute => moment[2],
                JointAxis::Prismatic => force[2],
            };
            body.transmission.add_force(along, forces);
            let lift = self.lift(index);
            moment = placement.to_parent(&body.twist, moment + lift.cross(force));
            force = placement.to_parent(&body.twist, force);
            moment = moment + placement.translation.cross(force);
            next = body.parent;
        }
    }

    /// Vector along a joint's axis to the body's origin, in the body's frame. It begins at the end of the
    /// translation from the parent.
    fn lift(&self, body: usize) -> Vector3<Scalar<'g>> {
        let zero = self.graph().constant(0.0);
        Vector3([zero, zero, self.placements[body].extension])
    }

    fn in_body(&self, at: &Attachment) -> (Option<usize>, Pose<Scalar<'g>>) {
        let (body, pose) = self.mechanism.links[at.link];
        (body, pose.then(lower_pose(self.graph(), &at.pose)))
    }

    fn place(&self, at: &Attachment) -> Place<'g> {
        let (body, pose) = self.in_body(at);
        Place { body, point: pose.translation }
    }

    /// The body and all its ancestors, in the order towards the base.
    fn chain(&self, body: Option<usize>) -> Vec<usize> {
        std::iter::successors(body, |&body| self.mechanism.bodies[body].parent).collect()
    }

    /// Transforms a point from the frame of a body to the frame of the body's parent.
    fn in_parent(&self, body: usize, point: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let placement = &self.placements[body];
        placement.translation
            + placement.to_parent(&self.mechanism.bodies[body].twist, point + self.lift(body))
    }

    /// Transforms a point to the frame of the body `end`. The result is in the base frame if `end` is `None`
    /// or not on the path to the base.
    fn ahead_of(&self, end: Option<usize>, from: Place<'g>) -> Vector3<Scalar<'g>> {
        let (mut body, mut point) = (from.body, from.point);
        while let Some(index) = body.filter(|_| body != end) {
            point = self.in_parent(index, point);
            body = self.mechanism.bodies[index].parent;
        }
        point
    }

    /// The squared distance l² and the distance l of the origins of two frames.
    fn length(&self, between: &[Attachment; 2], name: &str) -> (Scalar<'g>, Scalar<'g>) {
        let squared = self.squared_distance(between.each_ref().map(|at| self.place(at)));
        (squared, squared.call(Function::Sqrt).named(|| format!("length_{name}")))
    }

    fn distance(&self, between: &[Attachment; 2], name: &str) -> Distance<'g> {
        let (squared, length) = self.length(between, name);
        let half_inverse = self.graph().constant(0.5).divided_by(length);
        let half_inverse = half_inverse.named(|| format!("half_inverse_{name}"));
        let (by_square, _) = gradient_along(self.graph(), self.model, squared, self.y, &[]);
        let links = self.model.coordinates.iter().chain(&self.model.driven);
        let gradient = by_square.into_iter().zip(links).map(|(by_square, &link)| {
            let joint = self.model.links[link].joint.as_ref().map_or("", |joint| &joint.identifier);
            named(by_square * half_inverse, || format!("lever_{name}_{joint}"))
        });
        Distance { length, gradient: gradient.collect() }
    }

    /// The squared distance l² of two points. It is computed across the first joint after the last body that
    /// both paths from the base have in common.
    ///
    /// If this joint is revolute with the rotation R, then `l² = |α|² + |β|² − 2 α · R β`. α and β are the
    /// points before and after the rotation, relative to the joint's axis.
    fn squared_distance(&self, [a, b]: [Place<'g>; 2]) -> Scalar<'g> {
        let (of_a, of_b) = (self.chain(a.body), self.chain(b.body));
        let top = |chain: &[usize], other: &[usize]| {
            chain.iter().copied().take_while(|body| !other.contains(body)).last()
        };
        let (joint, moved, fixed) = match (top(&of_b, &of_a), top(&of_a, &of_b)) {
            (Some(joint), _) => (joint, b, a),
            (None, Some(joint)) => (joint, a, b),
            (None, None) => unreachable!("validation requires a joint between two frames"),
        };
        let (body, placement) = (&self.mechanism.bodies[joint], &self.placements[joint]);
        let moved = self.ahead_of(Some(joint), moved) + self.lift(joint);
        let fixed = body.twist.to_child(self.ahead_of(body.parent, fixed) - placement.translation);
        match placement.turn {
            Some((s, c)) if body.axis == JointAxis::Revolute && body.chain.is_none() => {
                let along = fixed[2] - moved[2];
                let lateral = |p: Vector3<Scalar<'g>>| p[0].squared() + p[1].squared();
                let together = fixed[0] * moved[0] + fixed[1] * moved[1];
                let across = fixed[1] * moved[0] - fixed[0] * moved[1];
                let apart = match (together.value(), across.value()) {
                    // The factor 2 is merged into constants.
                    (Some(_), Some(_)) => c * (together * 2.0) + s * (across * 2.0),
                    _ => (c * together + s * across) * 2.0,
                };
                lateral(fixed) + lateral(moved) + along.squared() - apart
            }
            _ => {
                let difference = fixed - placement.before_joint(moved);
                difference.dot(difference)
            }
        }
    }
}

impl<'g> Distance<'g> {
    /// Rate `∂l/∂y ẏ` of the distance l of two frames.
    fn rate(&self, v: &[Scalar<'g>]) -> Scalar<'g> {
        let zero = self.length.constant(0.0);
        self.gradient.iter().zip(v).fold(zero, |sum, (&by, &v)| sum + by * v)
    }

    /// Adds the generalized forces `−F ∂l/∂y` of a force F that pulls two frames at the distance l together.
    fn add_pull(&self, pull: Scalar<'g>, forces: &mut [Scalar<'g>]) {
        for (force, &by) in forces.iter_mut().zip(&self.gradient) {
            *force = *force - pull * by;
        }
    }
}

/// Suggests a name for a value, unless the graph already contains the negative of the value.
fn named(x: Scalar<'_>, name: impl FnOnce() -> String) -> Scalar<'_> {
    if x.edge().is_negative() { x } else { x.named(name) }
}
