//! Spatial motions and forces, with six entries each. The angular part is first.

use std::ops::Add;

use super::vector::Vector3;
use crate::graph::Scalar;

/// A spatial motion: velocity or acceleration of a body and of the point of reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<'g> {
    /// Angular part: angular velocity or angular acceleration.
    pub angular: Vector3<Scalar<'g>>,
    /// Linear part: velocity or acceleration of the point of reference.
    pub linear: Vector3<Scalar<'g>>,
}

/// A force, and its moment about the point of reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force<'g> {
    /// Moment about the point of reference.
    pub moment: Vector3<Scalar<'g>>,
    /// Force on the body.
    pub force: Vector3<Scalar<'g>>,
}

impl<'g> Motion<'g> {
    /// The product `factor · self` of a number and this motion.
    pub fn scaled(self, factor: Scalar<'g>) -> Self {
        let (angular, linear) = (self.angular.scaled(factor), self.linear.scaled(factor));
        Self { angular, linear }
    }

    /// Applies `f` to each of the six entries.
    pub fn map(self, f: impl Fn(Scalar<'g>) -> Scalar<'g>) -> Self {
        let (angular, linear) = (self.angular.map(&f), self.linear.map(&f));
        Self { angular, linear }
    }

    /// Power of a force at this velocity: the sum of angular times moment and linear times force.
    pub fn dot(self, f: Force<'g>) -> Scalar<'g> {
        self.angular.dot(f.moment) + self.linear.dot(f.force)
    }

    /// Spatial cross product `self × other` of two motions.
    pub fn cross(self, other: Self) -> Self {
        Self {
            angular: self.angular.cross(other.angular),
            linear: self.angular.cross(other.linear) + self.linear.cross(other.angular),
        }
    }

    /// Spatial cross product `self ×* f` of a motion and a force.
    pub fn cross_force(self, f: Force<'g>) -> Force<'g> {
        Force {
            moment: self.angular.cross(f.moment) + self.linear.cross(f.force),
            force: self.angular.cross(f.force),
        }
    }

    /// The six entries of the motion, angular part first.
    pub fn entries(self) -> [Scalar<'g>; 6] {
        let ([a, b, c], [d, e, f]) = (self.angular.0, self.linear.0);
        [a, b, c, d, e, f]
    }
}

impl<'g> Force<'g> {
    /// A force from six entries: first the force, then the moment.
    pub fn of_wrench(entries: &[Scalar<'g>]) -> Self {
        let part = |start: usize| Vector3(std::array::from_fn(|k| entries[start + k]));
        Self { force: part(0), moment: part(3) }
    }

    /// The zero force on the graph of the scalar `any`.
    pub fn zero(any: Scalar<'g>) -> Self {
        Self { moment: Vector3::zero(any), force: Vector3::zero(any) }
    }

    /// Applies `f` to each of the six entries.
    pub fn map(self, f: impl Fn(Scalar<'g>) -> Scalar<'g>) -> Self {
        // The force is mapped first, because the order of the graph's nodes determines the order of operands.
        let force = self.force.map(&f);
        Self { moment: self.moment.map(&f), force }
    }

    /// The six entries of the force, moment first.
    pub fn entries(self) -> [Scalar<'g>; 6] {
        let ([a, b, c], [d, e, f]) = (self.moment.0, self.force.0);
        [a, b, c, d, e, f]
    }
}

impl Add for Motion<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (angular, linear) = (self.angular + other.angular, self.linear + other.linear);
        Self { angular, linear }
    }
}

impl Add for Force<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (moment, force) = (self.moment + other.moment, self.force + other.force);
        Self { moment, force }
    }
}
