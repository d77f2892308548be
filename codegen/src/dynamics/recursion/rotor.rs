//! Rotors: forces of an axisymmetric body that spins in its carrier, beyond the inertia that it adds to the
//! carrier.
//!
//! A rotor of axial inertia J turns by i ẏ about the axis a of its carrier, which has the angular velocity ω;
//! y is a coordinate or a sum of coordinates. It requires the moment n on the carrier and the force f on the
//! coordinate:
//!
//! ```text
//! n = i J (ÿ a + ẏ ω × a)          f = i J (a · ω̇ + i ÿ)
//! ```
//!
//! (Featherstone 2008, section 9.6, on gears.) The rotor's mass and its inertia J a aᵀ belong to the carrier.

use crate::dynamics::recursion::placement::Placement;
use crate::graph::Scalar;
use crate::kinematics::{Mechanism, Rotor};
use crate::spatial::{Matrix3, Vector3};

/// Rotor in the working frame of its carrier.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gyrostat<'g> {
    /// Axis a of the rotor.
    axis: Vector3<Scalar<'g>>,
    /// i J
    coupling: Scalar<'g>,
}

impl<'g> Gyrostat<'g> {
    /// - `placement`: placement of the carrier
    pub(super) fn new(rotor: &Rotor<Scalar<'g>>, placement: &Placement<'g>) -> Self {
        let coupling = rotor.coupling_inertia();
        let axis = placement.to_body.map_or(rotor.axis, |ahead| rotor.axis.turned(ahead));
        Self { axis, coupling }
    }

    /// `i J a`: moment on the carrier per unit of the coordinate's acceleration.
    pub(super) fn momentum(&self) -> Vector3<Scalar<'g>> {
        self.axis.scaled(self.coupling)
    }

    /// `i J (ÿ a + ẏ ω × a)`: moment on the carrier.
    pub(super) fn moment(
        &self,
        omega: Vector3<Scalar<'g>>,
        rate: Scalar<'g>,
        acceleration: Scalar<'g>,
    ) -> Vector3<Scalar<'g>> {
        self.axis.scaled(self.coupling * acceleration) + omega.cross(self.axis).scaled(self.coupling * rate)
    }

    /// `i J a · ω̇`: force on the coordinate from the carrier's angular acceleration.
    pub(super) fn carried(&self, angular: Vector3<Scalar<'g>>) -> Scalar<'g> {
        self.coupling * self.axis.dot(angular)
    }

    /// `(i J ẏ a)×`: moment of the rotor's spin per angular velocity of the carrier.
    pub(super) fn spin(&self, rate: Scalar<'g>) -> Matrix3<'g> {
        Matrix3::cross(self.axis.scaled(self.coupling * rate))
    }

    /// The entries of M: i J times the share of each joint between the base and the carrier in the rotor's
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

/// Adds `i² J` to the diagonal of M for rotors that follow one coordinate.
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

/// Adds the entries of M that couple rotors on moving bodies with the joints before these bodies.
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
