//! Columns of the derivatives, and the disturbances of bodies that cause them. The symbols δω, β and δa are
//! defined in [`super`].

use crate::graph::Scalar;
use crate::kinematics::Mechanism;
use crate::spatial::{Force, Vector3};

/// A column of the derivatives on its path to the base. It consists of three wrenches and of the sensitivity
/// of the column's joint force to disturbances of the current body.
#[derive(Clone, Copy)]
pub(super) struct Column<'g> {
    /// Derivative of the wrench with respect to the joint's acceleration. Its components are also the
    /// sensitivity of the joint's force to δa and β.
    pub(super) inertial: Force<'g>,
    /// Derivative of the wrench with respect to the joint's velocity.
    pub(super) damping: Force<'g>,
    /// Derivative of the wrench with respect to the joint's coordinate.
    pub(super) stiffness: Force<'g>,
    /// Sensitivity of the joint's force to δω.
    pub(super) by_omega: Vector3<Scalar<'g>>,
}

impl<'g> Column<'g> {
    pub(super) fn zero(mechanism: &Mechanism<Scalar<'g>>) -> Self {
        let zero = mechanism.graph.constant(0.0);
        let nothing = Force::zero(zero);
        Self { inertial: nothing, damping: nothing, stiffness: nothing, by_omega: Vector3::zero(zero) }
    }
}

/// Disturbances of a body (δω, β and δa) for a unit of its joint's coordinate, and for a unit of its joint's
/// velocity.
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
    /// Creates the disturbance from δω, β and δa.
    pub(super) fn of([omega, beta, acceleration]: [Vector3<Scalar<'g>>; 3]) -> Self {
        Self { omega, beta, acceleration }
    }
}
