//! Bodies in the frame of the root, the first body of their tree.

use super::column::{Column, Disturbance, Disturbed};
use crate::graph::Scalar;
use crate::spatial::{Force, Motion, Vector3};

/// A body in the frame of its tree's first body. Moments and accelerations refer to the origin of that frame.
/// Velocities are relative to the base.
#[derive(Clone, Copy)]
pub(super) struct BaseBody<'g> {
    pub(super) axes: [Vector3<Scalar<'g>>; 3],
    pub(super) origin: Vector3<Scalar<'g>>,
    pub(super) twice_velocity: Vector3<Scalar<'g>>,
    /// Motion of the point at the origin of the tree's frame for a unit of the joint's velocity.
    pub(super) screw: Motion<'g>,
    pub(super) disturbance: Disturbance<'g>,
}

impl<'g> BaseBody<'g> {
    pub(super) fn direction(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.axes[0].scaled(v[0]) + self.axes[1].scaled(v[1]) + self.axes[2].scaled(v[2])
    }

    /// Transforms changes δω, β = δω̇ + ω × δω and δa of the body's motion to the frame of the tree's first
    /// body. δa is then the change of the acceleration of the point at this frame's origin.
    pub(super) fn disturbed(&self, local: &Disturbed<'g>) -> Disturbed<'g> {
        let (omega, beta) = (self.direction(local.omega), self.direction(local.beta));
        let at_origin =
            self.direction(local.acceleration) - beta.cross(self.origin) - omega.cross(self.twice_velocity);
        Disturbed { omega, beta, acceleration: at_origin }
    }

    fn force(&self, f: Force<'g>) -> Force<'g> {
        let force = self.direction(f.force);
        let moment = self.direction(f.moment) + self.origin.cross(force);
        Force { moment, force }
    }

    pub(super) fn column(&self, column: &Column<'g>) -> Column<'g> {
        let inertial = self.force(column.inertial);
        Column {
            inertial,
            damping: self.force(column.damping),
            stiffness: self.force(column.stiffness),
            by_omega: self.direction(column.by_omega) + self.twice_velocity.cross(inertial.force),
        }
    }
}
