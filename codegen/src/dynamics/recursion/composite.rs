//! Mass matrix by composite rigid bodies.
//!
//! Column j of the mass matrix is the force for a unit acceleration of joint j. It accelerates all bodies
//! beyond joint j together, and is passed on to the joints before j (Walker and Orin 1982; Featherstone 2008,
//! ch. 6). Moments of mass replace spatial inertias.

use crate::dynamics::formulation::{Formulation, RunLink};
use crate::dynamics::recursion::placement::{Placement, ends_at_root, place};
use crate::dynamics::recursion::rotor;
use crate::graph::Scalar;
use crate::kinematics::{JointAxis, Mechanism, Transmission};
use crate::spatial::{Force, MassMoments, Vector3};

/// Mass matrix `M(y)` as a list of rows. Both triangles are filled.
pub fn mass_matrix<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    y: &[Scalar<'g>],
) -> Vec<Vec<Scalar<'g>>> {
    let zero = mechanism.graph.constant(0.0);
    let mut matrix = vec![vec![zero; mechanism.coordinates]; mechanism.coordinates];
    if mechanism.bodies.is_empty() {
        return matrix;
    }
    let placements = place(mechanism, formulation, y);
    let composites = composites(mechanism, formulation, &placements);
    for (index, composite) in composites.iter().enumerate() {
        Column { mechanism, formulation, placements: &placements, index }.fill(composite, &mut matrix);
    }
    rotor::add_inertia(&mechanism.rotors, &mut matrix);
    rotor::add_coupling(mechanism, &placements, &mut matrix);
    mirror(mechanism, &mut matrix);
    matrix
}

/// Copies one triangle of the mass matrix to the other if joints follow other joints. Otherwise the two
/// triangles could differ by rounding errors, because their sums have the same terms in different orders.
pub(super) fn mirror<'g>(mechanism: &Mechanism<Scalar<'g>>, matrix: &mut [Vec<Scalar<'g>>]) {
    if !mechanism.is_coupled() {
        return;
    }
    for row in 0..matrix.len() {
        for column in 0..row {
            matrix[row][column] = matrix[column][row];
        }
    }
}

/// Moments of mass of a body together with all bodies beyond it.
#[derive(Clone, Copy)]
pub(in crate::dynamics) struct Composite<'g> {
    /// Moments of mass in the frame of the body's equations.
    pub moments: MassMoments<Scalar<'g>>,
    /// Sum Σ_xx + Σ_yy of second moments Σ = ∫ r rᵀ dm. A rotation about z does not change it.
    pub polar: Scalar<'g>,
}

/// Composite of each body and all bodies beyond it.
pub(in crate::dynamics) fn composites<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    placements: &[Placement<'g>],
) -> Vec<Composite<'g>> {
    let mut composites: Vec<Composite<'g>> =
        placements.iter().map(|placement| Composite::of(placement.moments)).collect();
    for index in (0..mechanism.bodies.len()).rev() {
        let (body, placement) = (&mechanism.bodies[index], &placements[index]);
        let Some(parent) = body.parent else { continue };
        let Composite { mut moments, polar } = composites[index];
        moments = before_joint(moments.lifted(placement.extension), placement);
        let arrived = moments.to_parent(&body.twist, placement.translation);
        let keeps_polar = body.twist.is_none() && formulation.bodies[index].source == RunLink::RunBase;
        let sum = composites[parent].moments + arrived;
        let arrived_polar = polar_after_shift(polar, &moments, placement.translation);
        composites[parent] = match keeps_polar {
            true => Composite { moments: sum, polar: composites[parent].polar + arrived_polar },
            false => Composite::of(sum),
        };
    }
    composites
}

impl<'g> Composite<'g> {
    fn of(moments: MassMoments<Scalar<'g>>) -> Self {
        Self { moments, polar: moments.second.xx + moments.second.yy }
    }

    /// Product `(tr Σ − Σ) v` of the inertia tensor about the origin and a vector v. The second moments are Σ
    /// = ∫ r rᵀ dm.
    pub fn inertia_times(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let s = self.moments.second;
        Vector3([
            (s.yy + s.zz) * v[0] - s.xy * v[1] - s.xz * v[2],
            (s.xx + s.zz) * v[1] - s.xy * v[0] - s.yz * v[2],
            self.polar * v[2] - s.xz * v[0] - s.yz * v[1],
        ])
    }
}

/// Transforms moments of mass to the frame before the joint's motion, and to the parent's unit of length.
pub(super) fn before_joint<'g>(
    moments: MassMoments<Scalar<'g>>,
    placement: &Placement<'g>,
) -> MassMoments<Scalar<'g>> {
    MassMoments {
        mass: moments.mass * (placement.unit_ratio * placement.unit_ratio),
        first: placement.before_joint_unit(moments.first),
        second: placement.second_before_joint(moments.second),
    }
}

/// Sum `Σ_xx + Σ_yy` of second moments Σ = ∫ r rᵀ dm after a displacement by `p`.
fn polar_after_shift<'g>(
    polar: Scalar<'g>,
    moments: &MassMoments<Scalar<'g>>,
    p: Vector3<Scalar<'g>>,
) -> Scalar<'g> {
    let h = moments.first;
    let quadratic = moments.mass * (p[0].squared() + p[1].squared());
    polar + (h[0] * p[0] + h[1] * p[1]) * 2.0 + quadratic
}

/// A force that is passed from body to body towards the base.
#[derive(Clone, Copy)]
struct Carried<'g> {
    force: Force<'g>,
    /// Moment perpendicular to the joint's axis, which is passed directly to the frame before the run of
    /// parallel joints.
    transverse: Vector3<Scalar<'g>>,
}

/// One column of the mass matrix.
struct Column<'a, 'g> {
    mechanism: &'a Mechanism<Scalar<'g>>,
    formulation: &'a Formulation,
    placements: &'a [Placement<'g>],
    index: usize,
}

impl<'g> Column<'_, 'g> {
    fn fill(&self, composite: &Composite<'g>, matrix: &mut [Vec<Scalar<'g>>]) {
        let column = &self.mechanism.bodies[self.index].transmission;
        let mut carried = self.unit_acceleration(composite);
        let own = self.mechanism.bodies[self.index].axis.force(carried.force);
        for term in &column.terms {
            column.add_row_entry(term.coordinate, own * term.ratio, matrix);
        }
        let mut index = self.index;
        while let Some(parent) = self.mechanism.bodies[index].parent {
            let row = &self.mechanism.bodies[parent];
            if ends_at_root(self.mechanism, index) {
                let twist = &self.mechanism.bodies[index].twist;
                let screw = self.placements[index].parent_screw(twist);
                let share = screw.dot(carried.force) + twist.to_parent(carried.transverse)[2];
                couple(&row.transmission, column, share, matrix);
                break;
            }
            carried = self.pass_on(index, carried);
            let entry = row.axis.force(carried.force);
            couple(&row.transmission, column, entry, matrix);
            index = parent;
        }
    }

    /// Wrench that accelerates a body and all bodies beyond it by 1 along or about the body's joint axis.
    fn unit_acceleration(&self, composite: &Composite<'g>) -> Carried<'g> {
        let MassMoments { mass, first: h, second: s } = composite.moments;
        let zero = mass.constant(0.0);
        let force = match self.mechanism.bodies[self.index].axis {
            JointAxis::Revolute => Force {
                force: Vector3([-h[1], h[0], zero]),
                moment: Vector3([-s.xz, -s.yz, composite.polar]),
            },
            JointAxis::Prismatic => {
                Force { force: Vector3([zero, zero, mass]), moment: Vector3([h[1], -h[0], zero]) }
            }
        };
        Carried { force, transverse: Vector3::zero(zero) }
    }

    fn pass_on(&self, index: usize, carried: Carried<'g>) -> Carried<'g> {
        let (body, placement) = (&self.mechanism.bodies[index], &self.placements[index]);
        let Carried { force: Force { force, mut moment }, mut transverse } = carried;
        let zero = moment[0].constant(0.0);
        let length = placement.extension;
        moment = moment + Vector3([-(length * force[1]), length * force[0], zero]);
        if self.formulation.bodies[index].sink == RunLink::RunBase && placement.run != index {
            let across = Vector3([moment[0], moment[1], zero]);
            transverse = transverse + placement.turn_from_run.map_or(across, |turn| across.turned(turn));
            moment = Vector3([zero, zero, moment[2]]);
        }
        let mut turned = placement.before_joint(moment);
        if placement.run == index {
            turned = turned + transverse;
            transverse = Vector3::zero(zero);
        }
        let force = body.twist.to_parent(placement.before_joint_unit(force));
        let moment = body.twist.to_parent(turned) + placement.translation.cross(force);
        Carried { force: Force { force, moment }, transverse }
    }
}

/// Adds the force along one joint for a unit acceleration of another joint to both symmetric entries of the
/// mass matrix.
fn couple<'g>(
    row: &Transmission<Scalar<'g>>,
    column: &Transmission<Scalar<'g>>,
    force: Scalar<'g>,
    matrix: &mut [Vec<Scalar<'g>>],
) {
    for term in &column.terms {
        row.add_coupling(term.coordinate, force * term.ratio, matrix);
    }
}

/// First moment of all moving masses in the base frame (kg m). The mechanism must be in metres.
pub fn first_moment<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    y: &[Scalar<'g>],
) -> Vector3<Scalar<'g>> {
    let placements = place(mechanism, formulation, y);
    let mut moments: Vec<_> = placements.iter().map(|p| (p.moments.mass, p.moments.first)).collect();
    let mut total = mechanism.base_moments.first;
    for index in (0..mechanism.bodies.len()).rev() {
        let (body, placement) = (&mechanism.bodies[index], &placements[index]);
        let (mass, mut first) = moments[index];
        first.0[2] = first[2] + mass * placement.extension;
        let arrived = placement.to_parent(&body.twist, first) + placement.translation.scaled(mass);
        match body.parent {
            Some(parent) => moments[parent] = (moments[parent].0 + mass, moments[parent].1 + arrived),
            None => total = total + arrived,
        }
    }
    total
}
