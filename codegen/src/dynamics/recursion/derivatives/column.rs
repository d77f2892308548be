//! Columns of the derivatives, and the disturbances that cause them.

use crate::graph::Scalar;
use crate::kinematics::Mechanism;
use crate::spatial::{Force, Vector3};

/// A column of the derivatives on the path to the base: three wrenches, and the change of the joint's torque
/// by disturbances of the current body.
#[derive(Clone, Copy)]
pub(super) struct Column<'g> {
    /// Derivative by the acceleration; also torque of the joint by δa and β.
    pub(super) inertial: Force<'g>,
    /// Derivative by the velocity.
    pub(super) damping: Force<'g>,
    /// Derivative by the coordinate.
    pub(super) stiffness: Force<'g>,
    /// Torque of the joint by δω.
    pub(super) by_omega: Vector3<Scalar<'g>>,
}

impl<'g> Column<'g> {
    pub(super) fn zero(mechanism: &Mechanism<Scalar<'g>>) -> Self {
        let zero = mechanism.graph.constant(0.0);
        let nothing = Force::zero(zero);
        Self { inertial: nothing, damping: nothing, stiffness: nothing, by_omega: Vector3::zero(zero) }
    }
}

/// Disturbances of a body by its coordinate and velocity.
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
    /// Creates the column from δω, β and δa.
    pub(super) fn of([omega, beta, acceleration]: [Vector3<Scalar<'g>>; 3]) -> Self {
        Self { omega, beta, acceleration }
    }
}
