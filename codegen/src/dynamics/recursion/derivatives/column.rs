//! Columns of the derivatives of the inverse dynamics, and the changes of bodies' motions that cause them.
//! The symbols δω, β and δa of these changes are defined in [`super`].

use crate::graph::Scalar;
use crate::kinematics::Mechanism;
use crate::spatial::{Force, Vector3};

/// A column of the derivatives on its path to the base. Contains three wrenches, and the sensitivity of the
/// column's joint force to changes of the current body's motion.
#[derive(Clone, Copy)]
pub(super) struct Column<'g> {
    /// Derivative of the wrench with respect to the joint's acceleration. Its components are also the
    /// sensitivity of the joint's force to changes of the body's motion: δa of the linear acceleration, and β
    /// = δω̇ + ω × δω.
    pub(super) inertial: Force<'g>,
    /// Derivative of the wrench with respect to the joint's velocity.
    pub(super) damping: Force<'g>,
    /// Derivative of the wrench with respect to the joint's coordinate.
    pub(super) stiffness: Force<'g>,
    /// Sensitivity of the joint's force to a change of the body's angular velocity.
    pub(super) by_omega: Vector3<Scalar<'g>>,
}

impl<'g> Column<'g> {
    pub(super) fn zero(mechanism: &Mechanism<Scalar<'g>>) -> Self {
        let zero = mechanism.graph.constant(0.0);
        let nothing = Force::zero(zero);
        Self { inertial: nothing, damping: nothing, stiffness: nothing, by_omega: Vector3::zero(zero) }
    }
}

/// Changes of a body's motion for a unit of its joint's coordinate, and for a unit of its joint's velocity.
#[derive(Clone, Copy)]
pub(super) struct Disturbance<'g> {
    pub(super) by_coordinate: Disturbed<'g>,
    pub(super) by_velocity: Disturbed<'g>,
}

#[derive(Clone, Copy)]
pub(super) struct Disturbed<'g> {
    pub(super) omega: Vector3<Scalar<'g>>,
    pub(super) beta: Vector3<Scalar<'g>>,
    pub(super) acceleration: Vector3<Scalar<'g>>,
}

impl<'g> Disturbed<'g> {
    /// Creates the changes of a body's motion from δω, β = δω̇ + ω × δω and the change of the origin's
    /// acceleration.
    pub(super) fn of([omega, beta, acceleration]: [Vector3<Scalar<'g>>; 3]) -> Self {
        Self { omega, beta, acceleration }
    }
}
