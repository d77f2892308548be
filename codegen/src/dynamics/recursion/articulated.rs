//! Forward dynamics by articulated bodies (Featherstone 2008, section 7.3). Accelerations are in the frames
//! of the bodies.
//!
//! A body has the angular acceleration ω̇, and its origin has the acceleration a, from which gravity is
//! subtracted. The body together with all bodies beyond it requires the moment n and the force F
//!
//! ```text
//! n = J ω̇ + C a + n₀          F = Cᵀ ω̇ + M a + F₀
//! ```
//!
//! From the leaves to the base, the equation of each joint is solved for the joint's acceleration as a
//! function of the parent's acceleration. The result is an articulated body that is added to the parent. The
//! number of operations grows linearly with the number of joints. For the robot's mass matrix it grows
//! quadratically, and for the factorization of the mass matrix cubically.

use crate::dynamics::formulation::Formulation;
use crate::dynamics::recursion::placement::{Placement, Turn, place};
use crate::graph::Scalar;
use crate::kinematics::{Body, Followed, JointAxis, Mechanism};
use crate::spatial::{Matrix3, Twist, Vector3};

/// Accelerations by coordinate for given joint forces. The mechanism must be in metres and must not be
/// [coupled](Mechanism::is_coupled), and its [rotors must be neighbours](Mechanism::rotors_are_neighbours).
pub fn forward_dynamics<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
    forces: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let couplings = RotorCoupling::of_bodies(mechanism);
    let placements = place(mechanism, &Formulation::plain(mechanism.bodies.len()), y);
    let tree = Tree {
        mechanism,
        placements: &placements,
        couplings: &couplings,
        rates: rates(mechanism, &placements, v),
    };
    let joints = tree.eliminate(forces);
    tree.accelerate(&joints)
}

/// Momentum and inertia by which the rotors of one joint couple it with its parent body.
#[derive(Clone, Copy)]
struct RotorCoupling<'g> {
    /// Momentum `i J_R a` of the rotors on the parent per unit of the joint's velocity, in the parent's
    /// frame. i is the gear ratio, J_R the axial inertia and a the axis.
    axial: Vector3<Scalar<'g>>,
    /// Inertia `i² J_R` of all rotors of the joint, with gear ratio i and axial inertia J_R.
    inertia: Scalar<'g>,
}

impl<'g> RotorCoupling<'g> {
    fn of_bodies(mechanism: &Mechanism<Scalar<'g>>) -> Vec<Self> {
        let zero = mechanism.graph.constant(0.0);
        let of_body = |(index, body): (usize, &Body<Scalar<'g>>)| {
            let mut coupling = Self { axial: Vector3::zero(zero), inertia: zero };
            let rotors = mechanism.rotors.iter();
            for rotor in rotors.filter(|rotor| rotor.driven == Some(index)) {
                // The values are per unit of the joint's acceleration. The ratio converts them from the
                // coordinate's acceleration.
                let per_joint = |x: Scalar<'g>| x.divided_by(body.transmission.own().ratio);
                coupling.inertia = coupling.inertia + per_joint(per_joint(rotor.reflected_inertia()));
                if rotor.carrier.is_some() {
                    let axial = rotor.axis.scaled(per_joint(rotor.coupling_inertia()));
                    coupling.axial = coupling.axial + axial;
                }
            }
            coupling
        };
        mechanism.bodies.iter().enumerate().map(of_body).collect()
    }
}

/// Velocities of a body and its joint, in the body's own frame.
#[derive(Clone, Copy)]
struct Rates<'g> {
    /// Angular velocity of the parent, in the body's frame.
    carried: Vector3<Scalar<'g>>,
    /// Angular velocity ω of the body.
    omega: Vector3<Scalar<'g>>,
    /// Velocity of the body's joint.
    joint: Scalar<'g>,
    /// Velocity terms of the angular acceleration for a revolute joint, or of the origin's acceleration for a
    /// prismatic joint.
    coriolis: Vector3<Scalar<'g>>,
}

fn rates<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    v: &[Scalar<'g>],
) -> Vec<Rates<'g>> {
    let zero = mechanism.graph.constant(0.0);
    let mut rates: Vec<Rates<'g>> = Vec::with_capacity(mechanism.bodies.len());
    for (index, body) in mechanism.bodies.iter().enumerate() {
        let parent = body.parent.map_or(Vector3::zero(zero), |parent| rates[parent].omega);
        let carried = placements[index].to_child(&body.twist, parent);
        let joint = body.transmission.motion(v);
        let across = |rate: Scalar<'g>| Vector3([carried[1] * rate, -(carried[0] * rate), zero]);
        let (omega, coriolis) = match body.axis {
            JointAxis::Revolute => (carried + Vector3([zero, zero, joint]), across(joint)),
            JointAxis::Prismatic => (carried, across(joint * 2.0)),
        };
        omega.named(&format!("omega_{}", body.identifier));
        rates.push(Rates { carried, omega, joint, coriolis });
    }
    rates
}

/// Inertia and bias in the equations of motion of a body with all bodies beyond it, whose joints move freely.
#[derive(Clone, Copy)]
struct Articulated<'g> {
    /// Symmetric matrix J in the moment `n = J ω̇ + C a + n₀` that the accelerations ω̇ and a require.
    inertia: Matrix3<'g>,
    /// Matrix C in the moment `n = J ω̇ + C a + n₀` and the force `F = Cᵀ ω̇ + M a + F₀`, which the
    /// accelerations ω̇ and a require.
    coupling: Matrix3<'g>,
    /// Symmetric matrix M in the force `F = Cᵀ ω̇ + M a + F₀` that the accelerations ω̇ and a require.
    mass: Matrix3<'g>,
    /// Moment n₀ that is required without accelerations.
    moment: Vector3<Scalar<'g>>,
    /// Force F₀ that is required without accelerations.
    force: Vector3<Scalar<'g>>,
}

/// A joint's equation `ÿ = known − per_angular · ω̇ − per_linear · a`. ω̇ and a are the angular and linear
/// acceleration that the parent causes.
#[derive(Clone, Copy)]
struct JointEquation<'g> {
    known: Scalar<'g>,
    per_angular: Vector3<Scalar<'g>>,
    per_linear: Vector3<Scalar<'g>>,
}

struct Tree<'a, 'g> {
    mechanism: &'a Mechanism<Scalar<'g>>,
    placements: &'a [Placement<'g>],
    couplings: &'a [RotorCoupling<'g>],
    rates: Vec<Rates<'g>>,
}

impl<'g> Tree<'_, 'g> {
    /// Solves the equations of all joints, from the leaves to the base.
    fn eliminate(&self, forces: &[Scalar<'g>]) -> Vec<JointEquation<'g>> {
        let mut bodies: Vec<Articulated<'g>> =
            (0..self.mechanism.bodies.len()).map(|k| self.rigid(k)).collect();
        let mut joints = Vec::with_capacity(bodies.len());
        for (index, body) in self.mechanism.bodies.iter().enumerate().rev() {
            let Followed { coordinate, ratio } = body.transmission.own();
            let force = forces[coordinate].divided_by(ratio);
            let (joint, rest) = self.eliminate_joint(index, &bodies[index], force);
            joints.push(joint);
            if let Some(parent) = body.parent {
                let arrived = self.pass_on(index, rest);
                let coupling = self.couplings[index].axial;
                let gyroscopic = self.rates[parent].omega.cross(coupling);
                bodies[parent] = bodies[parent].plus(&arrived);
                bodies[parent].moment = bodies[parent].moment + gyroscopic.scaled(self.rates[index].joint);
            }
        }
        joints.reverse();
        joints
    }

    /// Inertia and bias of a body without the bodies beyond it.
    fn rigid(&self, index: usize) -> Articulated<'g> {
        let (moments, omega) = (self.placements[index].moments, self.rates[index].omega);
        let s = moments.second;
        let inertia =
            Matrix3([[s.yy + s.zz, -s.xy, -s.xz], [-s.xy, s.xx + s.zz, -s.yz], [-s.xz, -s.yz, s.xx + s.yy]]);
        let angular_momentum = inertia.times(omega);
        Articulated {
            inertia,
            coupling: Matrix3::cross(moments.first),
            mass: Matrix3::diagonal(moments.mass),
            moment: omega.cross(angular_momentum),
            force: omega.cross(omega.cross(moments.first)),
        }
    }

    /// Solves a joint's equation for the joint's acceleration. The second result is the inertia and bias of
    /// all bodies beyond the joint, which are added to the parent.
    fn eliminate_joint(
        &self,
        index: usize,
        body: &Articulated<'g>,
        force: Scalar<'g>,
    ) -> (JointEquation<'g>, Articulated<'g>) {
        let revolute = self.mechanism.bodies[index].axis == JointAxis::Revolute;
        let (rates, coupling) = (&self.rates[index], &self.couplings[index]);
        let described = &self.mechanism.bodies[index];
        let axial = self.placements[index].to_child(&described.twist, coupling.axial);
        let (by_angular, by_linear, own) = match revolute {
            true => (body.inertia.column(2), Vector3(body.coupling[2]), body.inertia[2][2]),
            false => (body.coupling.column(2), Vector3(body.mass[2]), body.mass[2][2]),
        };
        let by_angular = by_angular + axial;
        let (moment, bias) = match revolute {
            true => (
                body.moment + body.inertia.times(rates.coriolis),
                body.force + body.coupling.transposed_times(rates.coriolis),
            ),
            false => (
                body.moment + body.coupling.times(rates.coriolis),
                body.force + body.mass.times(rates.coriolis),
            ),
        };
        let own = own + coupling.inertia;
        let reciprocal =
            own.constant(1.0).divided_by(own).named(|| format!("inverse_d_{}", described.identifier));
        // The quotient is exactly 1 for equal values, so that eliminated entries are exactly zero.
        let per = |x: Scalar<'g>| match x == own {
            true => own.constant(1.0),
            false => x * reciprocal,
        };
        let (per_angular, per_linear) = (by_angular.map(per), by_linear.map(per));
        let known = (force - if revolute { moment[2] } else { bias[2] }) * reciprocal;
        let joint = JointEquation { known, per_angular, per_linear };
        let mut rest = Articulated {
            inertia: minus_symmetric(&body.inertia, by_angular, per_angular),
            coupling: minus_product(&body.coupling, by_angular, per_angular, by_linear, per_linear),
            mass: minus_symmetric(&body.mass, by_linear, per_linear),
            moment: moment + by_angular.scaled(known),
            force: bias + by_linear.scaled(known),
        };
        if coupling.inertia.is_zero() {
            // The component along the joint's axis is set to the joint's force exactly.
            match revolute {
                true => rest.moment.0[2] = force,
                false => rest.force.0[2] = force,
            }
        }
        (joint, rest)
    }

    /// Transforms inertia and bias of all bodies beyond a joint to the parent's frame and origin.
    fn pass_on(&self, index: usize, rest: Articulated<'g>) -> Articulated<'g> {
        let (body, placement) = (&self.mechanism.bodies[index], &self.placements[index]);
        let zero = placement.extension.constant(0.0);
        let lift = Vector3([zero, zero, placement.extension]);
        let turned = rest.shifted(lift, self.rates[index].carried).turned(placement.turn, &body.twist);
        let omega = body.parent.map_or(Vector3::zero(zero), |parent| self.rates[parent].omega);
        turned.shifted(placement.translation, omega)
    }

    /// Computes the accelerations, from the base to the leaves.
    fn accelerate(&self, joints: &[JointEquation<'g>]) -> Vec<Scalar<'g>> {
        let zero = self.mechanism.graph.constant(0.0);
        let mut result = vec![zero; joints.len()];
        let mut motions: Vec<(Vector3<Scalar<'g>>, Vector3<Scalar<'g>>)> = Vec::with_capacity(joints.len());
        for (index, body) in self.mechanism.bodies.iter().enumerate() {
            let (angular, linear) = self.carried(index, body, &motions);
            let joint = &joints[index];
            let acceleration = joint.known - joint.per_angular.dot(angular) - joint.per_linear.dot(linear);
            let Followed { coordinate, ratio } = body.transmission.own();
            result[coordinate] =
                acceleration.divided_by(ratio).named(|| format!("acceleration_{}", body.identifier));
            let own = self.rates[index].coriolis + Vector3([zero, zero, acceleration]);
            motions.push(match body.axis {
                JointAxis::Revolute => (angular + own, linear),
                JointAxis::Prismatic => (angular, linear + own),
            });
        }
        result
    }

    /// Angular acceleration, and acceleration of the origin, that the parent causes at a body.
    fn carried(
        &self,
        index: usize,
        body: &Body<Scalar<'g>>,
        motions: &[(Vector3<Scalar<'g>>, Vector3<Scalar<'g>>)],
    ) -> (Vector3<Scalar<'g>>, Vector3<Scalar<'g>>) {
        let placement = &self.placements[index];
        let zero = placement.extension.constant(0.0);
        let (angular, linear, omega) = match body.parent {
            Some(parent) => (motions[parent].0, motions[parent].1, self.rates[parent].omega),
            None => (Vector3::zero(zero), -self.mechanism.gravity, Vector3::zero(zero)),
        };
        let at_joint =
            linear + angular.cross(placement.translation) + omega.cross(omega.cross(placement.translation));
        let turned = placement.to_child(&body.twist, angular);
        let (lift, carried) = (Vector3([zero, zero, placement.extension]), self.rates[index].carried);
        let origin = placement.to_child(&body.twist, at_joint)
            + turned.cross(lift)
            + carried.cross(carried.cross(lift));
        (turned, origin)
    }
}

impl<'g> Articulated<'g> {
    fn plus(&self, other: &Self) -> Self {
        Self {
            inertia: self.inertia + other.inertia,
            coupling: self.coupling + other.coupling,
            mass: self.mass + other.mass,
            moment: self.moment + other.moment,
            force: self.force + other.force,
        }
    }

    /// Transforms to another point of reference, from which the old point has the position `d`. The new
    /// accelerations a' and moments n' follow from `a = a' + ω̇ × d + ω × (ω × d)` and `n' = n + d × F`.
    fn shifted(self, d: Vector3<Scalar<'g>>, omega: Vector3<Scalar<'g>>) -> Self {
        if d.is_zero() {
            return self;
        }
        let lever = Matrix3::cross(d);
        let centripetal = omega.cross(omega.cross(d));
        let force = self.force + self.mass.times(centripetal);
        let moment = self.moment + self.coupling.times(centripetal) + d.cross(force);
        let coupling = self.coupling + lever.product(&self.mass);
        // The inertia is J − C d× + d× C'ᵀ. The last term is the transpose of −C' d×.
        let (before, after) = (self.coupling.product(&lever), coupling.product(&lever));
        let mut inertia = self.inertia;
        for i in 0..3 {
            for j in 0..=i {
                inertia[i][j] = inertia[i][j] - before[i][j] - after[j][i];
                inertia[j][i] = inertia[i][j];
            }
        }
        Self { inertia, coupling, mass: self.mass, moment, force }
    }

    /// Transforms to the axes of the parent, before the joint's rotation and the constant rotation between
    /// the links.
    fn turned(self, turn: Option<Turn<'g>>, twist: &Twist) -> Self {
        let vector = |v: Vector3<Scalar<'g>>| twist.to_parent(turn.map_or(v, |turn| v.turned(turn)));
        let matrix = |a: &Matrix3<'g>| {
            let turned = turn.map_or(*a, |turn| a.turned(turn));
            let rows = |a: Matrix3<'g>| Matrix3(a.0.map(|row| twist.to_parent(Vector3(row)).0));
            rows(rows(turned).transposed()).transposed()
        };
        let symmetric = |a: &Matrix3<'g>| {
            let mut turned = matrix(a);
            for i in 0..3 {
                for j in 0..i {
                    turned[j][i] = turned[i][j];
                }
            }
            turned
        };
        Self {
            inertia: symmetric(&self.inertia),
            coupling: matrix(&self.coupling),
            mass: symmetric(&self.mass),
            moment: vector(self.moment),
            force: vector(self.force),
        }
    }
}

/// Symmetric matrix `A − u uᵀ/d` with `per = u/d`. The lower triangle is computed and copied.
fn minus_symmetric<'g>(a: &Matrix3<'g>, u: Vector3<Scalar<'g>>, per: Vector3<Scalar<'g>>) -> Matrix3<'g> {
    let mut result = *a;
    for i in 0..3 {
        for j in 0..=i {
            result[i][j] = a[i][j] - per[i] * u[j];
            result[j][i] = result[i][j];
        }
    }
    result
}

/// Matrix `A − u wᵀ/d` with `per_u = u/d` and `per_w = w/d`. If an entry of `u/d` is 1, the row of this entry
/// is exact.
fn minus_product<'g>(
    a: &Matrix3<'g>,
    u: Vector3<Scalar<'g>>,
    per_u: Vector3<Scalar<'g>>,
    w: Vector3<Scalar<'g>>,
    per_w: Vector3<Scalar<'g>>,
) -> Matrix3<'g> {
    Matrix3::from_fn(|i, j| match per_u[i].value() == Some(1.0) {
        true => a[i][j] - w[j],
        false => a[i][j] - u[i] * per_w[j],
    })
}
