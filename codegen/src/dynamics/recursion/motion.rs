//! Motions of the bodies, and the states at which equations are evaluated.

use crate::dynamics::formulation::Diagonal;
use crate::graph::Scalar;
use crate::kinematics::Body;
use crate::spatial::{Matrix3, Vector3};

/// The motion of a body in its working frame.
#[derive(Debug, Clone, Copy)]
pub(in crate::dynamics) struct BodyMotion<'g> {
    /// Angular velocity ω.
    pub omega: Vector3<Scalar<'g>>,
    /// Components of the angular acceleration ω̇ that U required.
    pub(super) angular: [Option<Scalar<'g>>; 3],
    /// U = ω̇× + ω× ω×.
    pub spread: Matrix3<'g>,
    /// U_zz − U_yy, U_xx − U_zz and U_yy − U_xx, if they are computed separately from U.
    pub(super) differences: Option<[Scalar<'g>; 3]>,
    /// Acceleration of the origin minus gravity.
    pub acceleration: Vector3<Scalar<'g>>,
    /// Motion of the chain, for a body of a joint with a quaternion.
    pub chain: Option<ChainMotion<'g>>,
}

/// State and accelerations at which the inverse dynamics are evaluated.
#[derive(Debug, Clone, Copy)]
pub struct MotionInput<'a, 'g> {
    /// Coordinates.
    pub y: &'a [Scalar<'g>],
    /// Velocities.
    pub v: &'a [Scalar<'g>],
    /// Accelerations.
    pub a: &'a [Scalar<'g>],
}

/// Motion of the last body of a chain, with intermediate values.
#[derive(Debug, Clone, Copy)]
pub(in crate::dynamics) struct ChainMotion<'g> {
    /// Angular velocity ω_c from the joint's parent.
    pub(super) carried_omega: Vector3<Scalar<'g>>,
    /// Angular acceleration ω̇_c from the parent.
    pub(super) carried_angular: Vector3<Scalar<'g>>,
    /// U_c of the parent.
    pub(super) carried_spread: Matrix3<'g>,
    /// Acceleration a_c from the parent, minus gravity.
    pub(super) carried_acceleration: Vector3<Scalar<'g>>,
    /// Linear velocity l of the joint.
    pub(super) linear: Vector3<Scalar<'g>>,
    /// Angular velocity ν of the joint.
    pub(super) turning: Vector3<Scalar<'g>>,
}

impl<'g> BodyMotion<'g> {
    pub(super) fn at_rest(acceleration: Vector3<Scalar<'g>>) -> Self {
        let zero = acceleration[0].constant(0.0);
        Self {
            omega: Vector3::zero(zero),
            angular: [Some(zero); 3],
            spread: Matrix3::zero(zero),
            differences: None,
            acceleration,
            chain: None,
        }
    }

    /// Motion of the body of a joint with a quaternion.
    pub(super) fn of_chain(
        omega: Vector3<Scalar<'g>>,
        angular: Vector3<Scalar<'g>>,
        acceleration: Vector3<Scalar<'g>>,
        chain: ChainMotion<'g>,
    ) -> Self {
        let (spread, angular) = (spread_of(omega, angular), angular.0.map(Some));
        Self { omega, angular, spread, differences: None, acceleration, chain: Some(chain) }
    }

    /// Computes the diagonal of U and its differences by the chosen method.
    pub(super) fn find_diagonal(&mut self, diagonal: Diagonal) {
        let (u, squares) = (&mut self.spread.0, |w: Vector3<Scalar<'g>>| w.0.map(Scalar::squared));
        let across = |[first, second]: [Scalar<'g>; 2]| Some([first, second, -(first + second)]);
        match diagonal {
            Diagonal::Sums => {}
            Diagonal::Squares => {
                let [xx, yy, zz] = squares(self.omega);
                self.differences = Some([zz - yy, xx - zz, yy - xx]);
            }
            Diagonal::Axis => {
                let [_, yy, zz] = squares(self.omega);
                self.differences = across([zz - yy, u[0][0] - u[2][2]]);
                u[1][1] = u[2][2] - (zz - yy);
            }
            Diagonal::AxisAcross => {
                let [xx, _, zz] = squares(self.omega);
                self.differences = across([u[2][2] - u[1][1], xx - zz]);
                u[0][0] = u[2][2] + (xx - zz);
            }
        }
    }

    pub(super) fn named(self, body: &Body<Scalar<'g>>) -> Self {
        self.omega.named(&format!("omega_{}", body.label()));
        self.acceleration.named(&format!("acceleration_{}", body.label()));
        self
    }

    /// Angular acceleration ω̇; taken from the antisymmetric part of U if not known.
    pub(in crate::dynamics) fn angular_acceleration(&self) -> Vector3<Scalar<'g>> {
        let (u, w) = (&self.spread, self.omega);
        let from_spread = [u[2][1] - w[1] * w[2], u[0][2] - w[0] * w[2], u[1][0] - w[0] * w[1]];
        Vector3([0, 1, 2].map(|k| self.angular[k].unwrap_or(from_spread[k])))
    }
}

/// `U = ω̇× + ω× ω×`
pub(in crate::dynamics) fn spread_of<'g>(
    omega: Vector3<Scalar<'g>>,
    angular: Vector3<Scalar<'g>>,
) -> Matrix3<'g> {
    let (w, e) = (omega, angular);
    let (xx, yy, zz) = (w[0].squared(), w[1].squared(), w[2].squared());
    let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
    Matrix3([
        [-(yy + zz), xy - e[2], xz + e[1]],
        [xy + e[2], -(xx + zz), yz - e[0]],
        [xz - e[1], yz + e[0], -(xx + yy)],
    ])
}
