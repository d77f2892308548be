//! Pose, Jacobian and acceleration of named frames, in the axes of the base.

use nalgebra::Matrix3;

use crate::dynamics::formulation::Formulation;
use crate::dynamics::recursion::motion::MotionInput;
use crate::dynamics::recursion::newton_euler::frame_acceleration;
use crate::dynamics::recursion::placement::{Placement, place};
use crate::graph::Scalar;
use crate::kinematics::{JointAxis, Mechanism};
use crate::spatial::{Force, Pose, Vector3, rotate};

/// Pose of a frame in the base frame, as expressions of the graph.
#[derive(Debug, Clone, Copy)]
pub struct FramePose<'g> {
    /// Origin of the frame in the base frame \[m\].
    pub origin: Vector3<Scalar<'g>>,
    /// Unit vectors of the frame's axes x, y, z in the base frame.
    pub axes: [Vector3<Scalar<'g>>; 3],
}

/// Poses of a mechanism's bodies in the base frame.
pub struct BasePoses<'g> {
    mechanism: Mechanism<Scalar<'g>>,
    bodies: Vec<FramePose<'g>>,
}

impl<'g> BasePoses<'g> {
    /// Computes the bodies' poses at the coordinates `y`. Lengths of the mechanism must be in metres, and each
    /// body must have its own frame.
    pub fn new(mechanism: Mechanism<Scalar<'g>>, y: &[Scalar<'g>]) -> Self {
        let placements = place(&mechanism, &Formulation::plain(mechanism.bodies.len()), y);
        let base = FramePose::base(mechanism.graph.constant(1.0));
        let mut bodies: Vec<FramePose<'g>> = Vec::with_capacity(mechanism.bodies.len());
        let mut before_run = bodies.clone();
        for (index, body) in mechanism.bodies.iter().enumerate() {
            let parent = body.parent.map_or(base, |parent| bodies[parent]);
            let placement = &placements[index];
            let run_start = match placement.run == index {
                true => parent.twisted(&body.twist.matrix()),
                false => before_run[placement.run],
            };
            before_run.push(run_start);
            let mut pose = run_start.turned(placement).with_attitude(placement);
            pose.origin = parent.point(body.translation) + pose.axes[2].scaled(placement.extension);
            bodies.push(pose.named(body.label()));
        }
        Self { mechanism, bodies }
    }

    /// Pose of the body with this index in the base frame.
    pub fn body(&self, index: usize) -> &FramePose<'g> {
        &self.bodies[index]
    }

    /// Pose of a frame that is fixed to a link of the model. `frame` is the frame's pose in the link.
    pub fn pose(&self, link: usize, frame: &Pose<Scalar<'g>>) -> FramePose<'g> {
        let (body, pose) = self.in_body(link, frame);
        let body =
            body.map_or(FramePose::base(self.mechanism.graph.constant(1.0)), |index| self.bodies[index]);
        let origin = body.point(pose.translation);
        FramePose { origin, ..body.twisted(&pose.rotation) }
    }

    /// Jacobian of a frame in the axes of the base, 6 × n for n velocities. The first three rows give the
    /// linear velocity of the frame's origin, the last three the angular velocity.
    pub fn jacobian(&self, link: usize, frame: &Pose<Scalar<'g>>) -> Vec<Vec<Scalar<'g>>> {
        let origin = self.pose(link, frame).origin;
        let zero = self.mechanism.graph.constant(0.0);
        let mut rows = vec![vec![zero; self.mechanism.coordinates]; 6];
        let mut next = self.in_body(link, frame).0;
        while let Some(index) = next {
            let body = &self.mechanism.bodies[index];
            let FramePose { axes, origin: own } = self.bodies[index];
            let axis = axes[2];
            let (linear, angular) = match body.axis {
                JointAxis::Revolute => (axis.cross(origin - own), axis),
                JointAxis::Prismatic => (axis, Vector3::zero(zero)),
            };
            for k in 0..3 {
                body.transmission.add_column_entry(k, linear[k], &mut rows);
                body.transmission.add_column_entry(k + 3, angular[k], &mut rows);
            }
            next = body.parent;
        }
        rows
    }

    /// Adds the generalized forces `Jᵀ w` of a wrench w to `forces`. The wrench acts at the origin of a frame
    /// and is in the axes of the base.
    pub fn add_wrench(
        &self,
        link: usize,
        frame: &Pose<Scalar<'g>>,
        wrench: Force<'g>,
        forces: &mut [Scalar<'g>],
    ) {
        let Force { force, moment } = wrench;
        let about_base = moment + self.pose(link, frame).origin.cross(force);
        let mut next = self.in_body(link, frame).0;
        while let Some(index) = next {
            let body = &self.mechanism.bodies[index];
            let FramePose { axes, origin } = self.bodies[index];
            let along = match body.axis {
                JointAxis::Revolute => axes[2].dot(about_base - origin.cross(force)),
                JointAxis::Prismatic => axes[2].dot(force),
            };
            body.transmission.add_force(along, forces);
            next = body.parent;
        }
    }

    /// Acceleration of a frame without gravity, in the axes of the base: linear, then angular. At ÿ = 0 it
    /// equals `J̇ ẏ` with the frame's Jacobian J.
    pub fn acceleration(
        &self,
        link: usize,
        frame: &Pose<Scalar<'g>>,
        input: MotionInput<'_, 'g>,
    ) -> Vec<Scalar<'g>> {
        let zero = self.mechanism.graph.constant(0.0);
        let (body, pose) = self.in_body(link, frame);
        let Some(index) = body else {
            return vec![zero; 6];
        };
        let (linear, angular) = frame_acceleration(&self.mechanism, input, index, pose.translation);
        let base = &self.bodies[index];
        base.direction(linear).0.into_iter().chain(base.direction(angular).0).collect()
    }

    fn in_body(&self, link: usize, frame: &Pose<Scalar<'g>>) -> (Option<usize>, Pose<Scalar<'g>>) {
        let (body, pose) = self.mechanism.links[link];
        (body, pose.then(*frame))
    }
}

impl<'g> FramePose<'g> {
    /// Pose of the base frame in itself: origin 0 and unit axes.
    pub fn base(one: Scalar<'g>) -> Self {
        let zero = one.constant(0.0);
        let axes = [[one, zero, zero], [zero, one, zero], [zero, zero, one]].map(Vector3);
        Self { origin: Vector3::zero(one), axes }
    }

    /// The pose after a constant rotation.
    fn twisted(&self, rotation: &Matrix3<f64>) -> Self {
        let rows = [0, 1, 2].map(|row| {
            rotate(&rotation.transpose(), Vector3([self.axes[0][row], self.axes[1][row], self.axes[2][row]]))
        });
        let axes = [0, 1, 2].map(|axis| Vector3([rows[0][axis], rows[1][axis], rows[2][axis]]));
        Self { origin: self.origin, axes }
    }

    /// The pose after the rotation about z that leads from the frame before a run of parallel joints to the
    /// body.
    fn turned(&self, placement: &Placement<'g>) -> Self {
        let Some((s, c)) = placement.turn_from_run else {
            return *self;
        };
        let [x, y, z] = self.axes;
        let axes = [x.scaled(c) + y.scaled(s), y.scaled(c) - x.scaled(s), z];
        Self { origin: self.origin, axes }
    }

    /// The pose after the rotation by a quaternion.
    fn with_attitude(&self, placement: &Placement<'g>) -> Self {
        let Some(attitude) = placement.attitude else {
            return *self;
        };
        Self { origin: self.origin, axes: attitude.0.map(|axis| self.direction(axis)) }
    }

    /// Transforms a point from the frame to the base frame.
    fn point(&self, p: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.origin + self.direction(p)
    }

    /// Transforms a direction from the frame to the axes of the base.
    pub fn direction(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.axes[0].scaled(v[0]) + self.axes[1].scaled(v[1]) + self.axes[2].scaled(v[2])
    }

    fn named(self, body: &str) -> Self {
        for (axis, name) in self.axes.iter().zip(["x", "y", "z"]) {
            axis.named(&format!("{name}_axis_{body}"));
        }
        self.origin.named(&format!("origin_{body}"));
        self
    }
}
