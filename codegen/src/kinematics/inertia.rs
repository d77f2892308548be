//! Zeroth, first and second moments of mass, and what of them may move towards the base.

use nalgebra::Matrix3;

use super::mechanism::{Body, JointAxis, Twist};
use super::pose::{ScalarPose, lower, rotate};
use crate::graph::{Graph, Scalar, Symmetric3, Vector3};
use crate::model;

/// Moments of the mass distribution of a body about its frame's origin: m, ∫ r dm, ∫ r rᵀ dm.
///
/// Second moments Σ stand in for the inertia tensor I = tr(Σ) 1 − Σ: they move by `Σ + h pᵀ + p hᵀ + m p pᵀ`, and
/// the three moments of mass on a joint's axis are simply m, h_z and Σ_zz.
#[derive(Debug, Clone, Copy)]
pub struct MassMoments<'g> {
    /// Mass m (kg).
    pub mass: Scalar<'g>,
    /// First moment h = m c [kg m].
    pub first: Vector3<'g>,
    /// Second moment Σ [kg m²].
    pub second: Symmetric3<'g>,
}

/// What a joint's freedom to shift mass along its axis is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegroupChoice {
    /// The body itself becomes massless.
    Massless,
    /// The parent's first moment loses its component along x.
    BalanceParent,
}

impl<'g> MassMoments<'g> {
    /// Of nothing.
    pub fn zero(graph: &'g Graph) -> Self {
        let zero = graph.constant(0.0);
        Self {
            mass: zero,
            first: Vector3::zero(zero),
            second: Symmetric3::zero(zero),
        }
    }

    /// Of a described body, about its link frame's origin.
    pub fn of_body(graph: &'g Graph, body: &model::Body) -> Self {
        let mass = lower(graph, &body.mass);
        let center = Vector3(body.center_of_mass.each_ref().map(|f| lower(graph, f)));
        let inertia = body.inertia.each_ref().map(|f| lower(graph, f));
        let central = Self {
            mass,
            first: Vector3::zero(mass),
            second: second_moments(Symmetric3::new(inertia)),
        };
        central.shifted(center)
    }

    /// Of a pure inertia `j · axis axisᵀ`: a rotor that only turns about its axis.
    pub fn of_axial_inertia(j: Scalar<'g>, axis: Vector3<'g>) -> Self {
        let inertia = Symmetric3::square(axis).map(|x| x * j);
        Self {
            mass: j.constant(0.0),
            first: Vector3::zero(j),
            second: second_moments(inertia),
        }
    }

    /// The same masses after a displacement by `p`.
    pub fn shifted(self, p: Vector3<'g>) -> Self {
        Self {
            mass: self.mass,
            first: self.first + p.scaled(self.mass),
            second: self.second
                + Symmetric3::symmetric_product(self.first, p)
                + Symmetric3::square(p).map(|x| x * self.mass),
        }
    }

    /// The same masses in another frame: `pose` is this frame's pose there.
    pub fn moved(self, pose: &ScalarPose<'g>) -> Self {
        let rotated = Self {
            mass: self.mass,
            first: rotate(&pose.rotation, self.first),
            second: rotate_symmetric(&pose.rotation, self.second),
        };
        rotated.shifted(pose.translation)
    }

    /// Turned by an angle about z.
    pub fn turned(self, turn: (Scalar<'g>, Scalar<'g>)) -> Self {
        Self {
            mass: self.mass,
            first: self.first.turned(turn),
            second: self.second.turned(turn),
        }
    }

    /// From the joint's frame before its motion to the parent's frame.
    pub fn to_parent(self, twist: &Twist, translation: Vector3<'g>) -> Self {
        let rotation = twist.matrix();
        self.moved(&ScalarPose {
            rotation,
            translation,
        })
    }

    /// The same masses after a displacement along z.
    pub fn lifted(self, length: Scalar<'g>) -> Self {
        let zero = length.constant(0.0);
        self.shifted(Vector3([zero, zero, length]))
    }

    /// Applies `f` to each moment.
    pub fn map(self, mut f: impl FnMut(Scalar<'g>) -> Scalar<'g>) -> Self {
        Self {
            mass: f(self.mass),
            first: self.first.map(&mut f),
            second: self.second.map(&mut f),
        }
    }

    /// The ten moments.
    pub fn entries(self) -> impl Iterator<Item = Scalar<'g>> {
        std::iter::once(self.mass)
            .chain(self.first.0)
            .chain(self.second.entries())
    }
}

impl std::ops::Add for MassMoments<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

impl std::ops::Sub for MassMoments<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            mass: self.mass - other.mass,
            first: self.first - other.first,
            second: self.second - other.second,
        }
    }
}

/// `Σ = ½ tr(I) 1 − I`
fn second_moments(inertia: Symmetric3<'_>) -> Symmetric3<'_> {
    let Symmetric3 {
        xx,
        xy,
        xz,
        yy,
        yz,
        zz,
    } = inertia;
    Symmetric3 {
        xx: (yy + zz - xx) * 0.5,
        xy: -xy,
        xz: -xz,
        yy: (xx + zz - yy) * 0.5,
        yz: -yz,
        zz: (xx + yy - zz) * 0.5,
    }
}

fn rotate_symmetric<'g>(rotation: &Matrix3<f64>, matrix: Symmetric3<'g>) -> Symmetric3<'g> {
    let columns = [0, 1, 2].map(|k| {
        let unit = Vector3(std::array::from_fn(|row| {
            matrix.xx.constant(rotation[(k, row)])
        }));
        rotate(rotation, matrix.times(unit))
    });
    let entry = |row: usize, column: usize| columns[column][row];
    Symmetric3::new([
        entry(0, 0),
        entry(0, 1),
        entry(0, 2),
        entry(1, 1),
        entry(1, 2),
        entry(2, 2),
    ])
}

/// Moves what acts only through its sum from body to parent (base parameters; Gautier and Khalil 1990): masses on a
/// revolute joint's axis, and the whole second moment of a prismatic joint's body. Leaves M, k and q unchanged.
///
/// `base` receives what arrives there, in the base frame; its second moment then means nothing.
pub fn regroup<'g>(bodies: &mut [Body<'g>], base: &mut MassMoments<'g>, choices: &[RegroupChoice]) {
    for index in (0..bodies.len()).rev() {
        let given = match bodies[index].axis {
            JointAxis::Revolute => on_axis(bodies[index].moments),
            JointAxis::Prismatic => second_only(bodies[index].moments),
        };
        bodies[index].moments =
            (bodies[index].moments - given).map(|x| x.cleaned(f64::MIN_POSITIVE));
        let Body {
            twist,
            translation,
            lift,
            parent,
            axis,
            offset,
            ..
        } = bodies[index];
        // Masses on a revolute joint's axis look the same from all sides.
        let ahead = match axis {
            JointAxis::Revolute => None,
            JointAxis::Prismatic => offset.constant_turn(given.mass.graph()),
        };
        let given = ahead.map_or(given, |ahead| given.turned(ahead));
        let arrived = given.lifted(lift).to_parent(&twist, translation);
        let Some(parent) = parent else {
            *base = *base + arrived;
            continue;
        };
        bodies[parent].moments = bodies[parent].moments + arrived;
        if choices[index] == RegroupChoice::BalanceParent {
            balance_parent(bodies, index, parent);
        }
    }
}

/// The moments of the masses on the z axis.
fn on_axis(moments: MassMoments<'_>) -> MassMoments<'_> {
    let zero = moments.mass.constant(0.0);
    let mut second = Symmetric3::zero(zero);
    second.zz = moments.second.zz;
    MassMoments {
        mass: moments.mass,
        first: Vector3([zero, zero, moments.first[2]]),
        second,
    }
}

/// The second moment alone: it depends on the orientation only, which a prismatic joint does not change.
fn second_only(moments: MassMoments<'_>) -> MassMoments<'_> {
    let zero = moments.mass.constant(0.0);
    MassMoments {
        mass: zero,
        first: Vector3::zero(zero),
        second: moments.second,
    }
}

/// Balancing over a shorter lever (m) takes masses so large that digits are lost.
pub const SHORTEST_LEVER: f64 = 1e-3;

/// Shifts mass between a revolute joint's origin and its parent until the parent's h_x vanishes.
fn balance_parent(bodies: &mut [Body<'_>], index: usize, parent: usize) {
    let origin = bodies[index].origin_in_parent();
    let (Some(hx), Some(px)) = (bodies[parent].moments.first[0].value(), origin[0].value()) else {
        return;
    };
    if px.abs() < SHORTEST_LEVER || bodies[index].axis != JointAxis::Revolute {
        return;
    }
    let mass = origin[0].constant(-hx / px);
    let mut point = MassMoments::zero(mass.graph());
    point.mass = mass;
    bodies[index].moments.mass = bodies[index].moments.mass - mass;
    let Body {
        twist,
        translation,
        lift,
        ..
    } = bodies[index];
    bodies[parent].moments =
        bodies[parent].moments + point.lifted(lift).to_parent(&twist, translation);
    bodies[parent].moments.first.0[0] = mass.constant(0.0);
}
