//! Motions of the bodies, and the arguments of the recursive equations.

use crate::dynamics::formulation::Diagonal;
use crate::graph::Scalar;
use crate::kinematics::Body;
use crate::spatial::{Matrix3, Vector3};

/// Motion of a body, with components in the frame of the body's equations.
#[derive(Debug, Clone, Copy)]
pub(in crate::dynamics) struct BodyMotion<'g> {
    /// Angular velocity ω of the body.
    pub omega: Vector3<Scalar<'g>>,
    /// Components of the body's angular acceleration. A component is `None` if the other results did not need
    /// it.
    pub(super) angular: [Option<Scalar<'g>>; 3],
    /// Matrix U = ω̇× + ω× ω× of the body. A point r has the acceleration a + U r, with the acceleration a of
    /// the body's origin.
    pub spread: Matrix3<'g>,
    /// Differences U_zz − U_yy, U_xx − U_zz and U_yy − U_xx of the matrix U = ω̇× + ω× ω×; `None` if they are
    /// computed from U.
    pub(super) differences: Option<[Scalar<'g>; 3]>,
    /// Acceleration of the body's origin minus gravity.
    pub acceleration: Vector3<Scalar<'g>>,
    /// Motion of the bodies that replace a joint with a quaternion; `None` for other bodies.
    pub chain: Option<ChainMotion<'g>>,
}

/// State and accelerations at which the inverse dynamics are evaluated.
#[derive(Debug, Clone, Copy)]
pub struct MotionInput<'a, 'g> {
    /// Positions y, by coordinate.
    pub y: &'a [Scalar<'g>],
    /// Velocities ẏ, by coordinate.
    pub v: &'a [Scalar<'g>],
    /// Accelerations ÿ, by coordinate.
    pub a: &'a [Scalar<'g>],
}

/// Intermediate values for the motion of the body that a joint with a quaternion moves, in the frame of this
/// body.
#[derive(Debug, Clone, Copy)]
pub(in crate::dynamics) struct ChainMotion<'g> {
    /// Angular velocity of the joint's parent, in the axes of the moved body.
    pub(super) carried_omega: Vector3<Scalar<'g>>,
    /// Angular acceleration of the joint's parent, in the axes of the moved body.
    pub(super) carried_angular: Vector3<Scalar<'g>>,
    /// Matrix `ω̇× + ω× ω×` of the joint's parent, in the axes of the moved body.
    pub(super) carried_spread: Matrix3<'g>,
    /// Acceleration that the parent causes at the moved body's origin, minus gravity.
    pub(super) carried_acceleration: Vector3<Scalar<'g>>,
    /// Linear velocity l of the joint (m/s).
    pub(super) linear: Vector3<Scalar<'g>>,
    /// Angular velocity ν of the joint (rad/s).
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

    /// Motion of the body that a joint with a quaternion moves.
    pub(super) fn of_chain(
        omega: Vector3<Scalar<'g>>,
        angular: Vector3<Scalar<'g>>,
        acceleration: Vector3<Scalar<'g>>,
        chain: ChainMotion<'g>,
    ) -> Self {
        let (spread, angular) = (spread_of(omega, angular), angular.0.map(Some));
        Self { omega, angular, spread, differences: None, acceleration, chain: Some(chain) }
    }

    /// Computes the diagonal of the matrix U = ω̇× + ω× ω× and the differences of its entries by the chosen
    /// method.
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

    /// Angular acceleration of the body. Components that are not stored are computed from the angular
    /// velocity ω and the matrix U = ω̇× + ω× ω×.
    pub(in crate::dynamics) fn angular_acceleration(&self) -> Vector3<Scalar<'g>> {
        let (u, w) = (&self.spread, self.omega);
        let from_spread = [u[2][1] - w[1] * w[2], u[0][2] - w[0] * w[2], u[1][0] - w[0] * w[1]];
        Vector3([0, 1, 2].map(|k| self.angular[k].unwrap_or(from_spread[k])))
    }
}

/// Matrix `U = ω̇× + ω× ω×` of a body with the angular velocity ω and the angular acceleration ω̇.
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
