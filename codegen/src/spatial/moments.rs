//! Moments of mass of a body: mass, first moment and second moment.

use nalgebra::Matrix3;

use super::motion::{Force, Motion};
use super::pose::{Pose, rotate};
use super::twist::Twist;
use super::vector::{Symmetric3, Vector3};
use crate::graph::{Graph, Scalar};

/// Moments of the mass distribution of a body about the origin of its frame: m, h = ∫ r dm and Σ = ∫ r rᵀ dm.
///
/// The second moment Σ replaces the inertia tensor I = tr(Σ) 1 − Σ. A displacement by p changes Σ to
/// `Σ + h pᵀ + p hᵀ + m p pᵀ`. If all mass is on a joint's axis, only the moments m, h_z and Σ_zz are
/// non-zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassMoments<S> {
    /// Mass of the body (kg).
    pub mass: S,
    /// First moment h = m c (kg m) with the mass m and the centre of mass c.
    pub first: Vector3<S>,
    /// Second moment Σ = ∫ r rᵀ dm (kg m²) about the origin.
    pub second: Symmetric3<S>,
}

impl<S> MassMoments<S> {
    /// Applies `f` to each entry of the moments.
    pub fn map<T>(self, mut f: impl FnMut(S) -> T) -> MassMoments<T> {
        MassMoments { mass: f(self.mass), first: self.first.map(&mut f), second: self.second.map(&mut f) }
    }

    /// The ten entries of the moments: mass, first moment, second moment.
    pub fn entries(self) -> impl Iterator<Item = S> {
        std::iter::once(self.mass).chain(self.first.0).chain(self.second.entries())
    }
}

impl<'g> MassMoments<Scalar<'g>> {
    /// Moments of a body without mass.
    pub fn zero(graph: &'g Graph) -> Self {
        let zero = graph.constant(0.0);
        Self { mass: zero, first: Vector3::zero(zero), second: Symmetric3::zero(zero) }
    }

    /// Moments of a body with this mass and centre of mass. The inertia about the centre of mass has the
    /// entries xx, xy, xz, yy, yz, zz.
    pub fn of_inertia(mass: Scalar<'g>, center: Vector3<Scalar<'g>>, inertia: [Scalar<'g>; 6]) -> Self {
        let central =
            Self { mass, first: Vector3::zero(mass), second: second_moments(Symmetric3::new(inertia)) };
        central.shifted(center)
    }

    /// Moments of an axial inertia `j · axis axisᵀ`: a rotor that turns only about its axis.
    pub fn of_axial_inertia(j: Scalar<'g>, axis: Vector3<Scalar<'g>>) -> Self {
        let inertia = Symmetric3::square(axis).map(|x| x * j);
        Self { mass: j.constant(0.0), first: Vector3::zero(j), second: second_moments(inertia) }
    }

    /// Moments after a displacement of the body by `p`.
    pub fn shifted(self, p: Vector3<Scalar<'g>>) -> Self {
        Self {
            mass: self.mass,
            first: self.first + p.scaled(self.mass),
            second: self.second
                + Symmetric3::symmetric_product(self.first, p)
                + Symmetric3::square(p).map(|x| x * self.mass),
        }
    }

    /// Moments in another frame. `pose` is the pose of the current frame in the other frame.
    pub fn moved(self, pose: &Pose<Scalar<'g>>) -> Self {
        let rotated = Self {
            mass: self.mass,
            first: rotate(&pose.rotation, self.first),
            second: rotate_symmetric(&pose.rotation, self.second),
        };
        rotated.shifted(pose.translation)
    }

    /// Moments after a rotation of the body about z. `turn` is the sine and the cosine of the angle.
    pub fn turned(self, turn: (Scalar<'g>, Scalar<'g>)) -> Self {
        Self { mass: self.mass, first: self.first.turned(turn), second: self.second.turned(turn) }
    }

    /// Moments in the frame of the joint's parent. The current frame is the joint's frame before its motion.
    pub fn to_parent(self, twist: &Twist, translation: Vector3<Scalar<'g>>) -> Self {
        let rotation = twist.matrix();
        self.moved(&Pose { rotation, translation })
    }

    /// Moments after a displacement of the body along z.
    pub fn lifted(self, length: Scalar<'g>) -> Self {
        let zero = length.constant(0.0);
        self.shifted(Vector3([zero, zero, length]))
    }

    /// Force and moment `I s` that give the masses the acceleration `s`, about the point of reference. I is
    /// the spatial inertia.
    pub fn times(&self, Motion { angular, linear }: Motion<'g>) -> Force<'g> {
        let s = self.second;
        let tensor = Vector3([
            (s.yy + s.zz) * angular[0] - s.xy * angular[1] - s.xz * angular[2],
            (s.xx + s.zz) * angular[1] - s.xy * angular[0] - s.yz * angular[2],
            (s.xx + s.yy) * angular[2] - s.xz * angular[0] - s.yz * angular[1],
        ]);
        Force {
            moment: tensor + self.first.cross(linear),
            force: linear.scaled(self.mass) + angular.cross(self.first),
        }
    }
}

impl std::ops::Add for MassMoments<Scalar<'_>> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

impl std::ops::Sub for MassMoments<Scalar<'_>> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            mass: self.mass - other.mass,
            first: self.first - other.first,
            second: self.second - other.second,
        }
    }
}

/// Second moments `Σ = ½ tr(I) 1 − I` of a body with the inertia tensor I.
fn second_moments(inertia: Symmetric3<Scalar<'_>>) -> Symmetric3<Scalar<'_>> {
    let Symmetric3 { xx, xy, xz, yy, yz, zz } = inertia;
    Symmetric3 {
        xx: (yy + zz - xx) * 0.5,
        xy: -xy,
        xz: -xz,
        yy: (xx + zz - yy) * 0.5,
        yz: -yz,
        zz: (xx + yy - zz) * 0.5,
    }
}

fn rotate_symmetric<'g>(rotation: &Matrix3<f64>, matrix: Symmetric3<Scalar<'g>>) -> Symmetric3<Scalar<'g>> {
    let columns = [0, 1, 2].map(|k| {
        let unit = Vector3(std::array::from_fn(|row| matrix.xx.constant(rotation[(k, row)])));
        rotate(rotation, matrix.times(unit))
    });
    let entry = |row: usize, column: usize| columns[column][row];
    Symmetric3::new([entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)])
}
