//! Forces of rotors. A rotor is an axisymmetric body that spins relative to its carrier. Its mass and its
//! inertia J a aᵀ belong to the carrier. This module adds the forces of its spin.
//!
//! A rotor with the axial inertia J turns with the speed i ẏ about the axis a relative to its carrier. The
//! carrier has the angular velocity ω. i is the gear ratio, and y is a coordinate or a weighted sum of
//! coordinates. The rotor requires the moment n on the carrier and the force f along y:
//!
//! ```text
//! n = i J (ÿ a + ẏ ω × a)          f = i J (a · ω̇ + i ÿ)
//! ```
//!
//! Featherstone (2008, section 9.6) has the equations of geared drives.

use crate::dynamics::recursion::placement::Placement;
use crate::graph::Scalar;
use crate::kinematics::{Mechanism, Rotor};
use crate::spatial::{Matrix3, Vector3};

/// A rotor in the frame of its carrier's equations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gyrostat<'g> {
    /// Axis a of the rotor, a unit vector in the carrier's frame.
    axis: Vector3<Scalar<'g>>,
    /// Product i J of the rotor's gear ratio i and axial inertia J.
    coupling: Scalar<'g>,
}

impl<'g> Gyrostat<'g> {
    /// Transforms a rotor to the frame of its carrier's equations, which `placement` describes.
    pub(super) fn new(rotor: &Rotor<Scalar<'g>>, placement: &Placement<'g>) -> Self {
        let coupling = rotor.coupling_inertia();
        let axis = placement.to_body.map_or(rotor.axis, |ahead| rotor.axis.turned(ahead));
        Self { axis, coupling }
    }

    /// Moment `i J a` on the carrier for a unit of the coordinate's acceleration ÿ. i is the rotor's gear
    /// ratio, J its axial inertia and a its axis.
    pub(super) fn momentum(&self) -> Vector3<Scalar<'g>> {
        self.axis.scaled(self.coupling)
    }

    /// Moment `i J (ÿ a + ẏ ω × a)` of the rotor on its carrier, with gear ratio i, axial inertia J and axis
    /// a. ω is the carrier's angular velocity.
    pub(super) fn moment(
        &self,
        omega: Vector3<Scalar<'g>>,
        rate: Scalar<'g>,
        acceleration: Scalar<'g>,
    ) -> Vector3<Scalar<'g>> {
        self.axis.scaled(self.coupling * acceleration) + omega.cross(self.axis).scaled(self.coupling * rate)
    }

    /// Force `i J a · ω̇` along the coordinate that the carrier's angular acceleration ω̇ causes. i is the
    /// rotor's gear ratio, J its axial inertia and a its axis.
    pub(super) fn carried(&self, angular: Vector3<Scalar<'g>>) -> Scalar<'g> {
        self.coupling * self.axis.dot(angular)
    }

    /// Matrix `(i J ẏ a)×` with the rotor's gear ratio i, axial inertia J and axis a. Its product with an
    /// angular velocity of the carrier is the moment of the rotor's spin.
    pub(super) fn spin(&self, rate: Scalar<'g>) -> Matrix3<'g> {
        Matrix3::cross(self.axis.scaled(self.coupling * rate))
    }

    /// Adds the entries of the mass matrix that couple the rotor with the joints between the base and the
    /// carrier: gear ratio times axial inertia times the component of the rotor's axis along each joint's
    /// axis.
    fn couple(
        &self,
        mechanism: &Mechanism<Scalar<'g>>,
        placements: &[Placement<'g>],
        rotor: &Rotor<Scalar<'g>>,
        carrier: usize,
        matrix: &mut [Vec<Scalar<'g>>],
    ) {
        let (mut index, mut moment) = (carrier, self.axis);
        loop {
            let body = &mechanism.bodies[index];
            if body.axis.turns() {
                let share = self.coupling * moment[2];
                for term in &rotor.transmission.terms {
                    body.transmission.add_coupling(term.coordinate, share * term.ratio, matrix);
                }
            }
            let Some(parent) = body.parent else { break };
            moment = placements[index].to_parent(&body.twist, moment);
            index = parent;
        }
    }
}

/// Adds the inertias `i² J` of rotors with gear ratio i and axial inertia J to the mass matrix. A rotor with
/// one coordinate adds to the diagonal. A rotor with several coordinates adds to the entries of all their
/// pairs.
pub(in crate::dynamics) fn add_inertia<'a, 'g: 'a>(
    rotors: impl IntoIterator<Item = &'a Rotor<Scalar<'g>>>,
    matrix: &mut [Vec<Scalar<'g>>],
) {
    for rotor in rotors {
        for term in &rotor.transmission.terms {
            let force = rotor.reflected_inertia() * term.ratio;
            rotor.transmission.add_row_entry(term.coordinate, force, matrix);
        }
    }
}

/// Adds the entries of the mass matrix that couple rotors on moving bodies with the joints between the base
/// and these bodies.
pub(super) fn add_coupling<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    matrix: &mut [Vec<Scalar<'g>>],
) {
    for rotor in &mechanism.rotors {
        let Some(carrier) = rotor.carrier else {
            continue;
        };
        Gyrostat::new(rotor, &placements[carrier]).couple(mechanism, placements, rotor, carrier, matrix);
    }
}
