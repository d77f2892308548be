//! Recursive Newton–Euler equations with moments of mass.
//!
//! A point r of a body has the acceleration a + U r, with the acceleration a of the origin and U = ω̇× + ω×
//! ω×. With the mass m and the moments h = ∫ r dm and Σ = ∫ r rᵀ dm, the body requires the force F and the
//! moment n about the origin
//!
//! ```text
//! F = m a + U h            n = h × a + vee(U Σ − Σ Uᵀ)
//! ```
//!
//! The recursion is that of Luh, Walker and Paul (1980), with the second moments of Balafoutis and Patel
//! (1989) and the frames of Khalil and Dombre (2002, ch. 9).

use crate::dynamics::formulation::{AngularRoute, BodyChoices, Formulation, RunLink};
use crate::dynamics::recursion::mirrored::{Branches, carried as carried_to_branch, mirrored};
use crate::dynamics::recursion::motion::{BodyMotion, MotionInput, spread_of};
use crate::dynamics::recursion::placement::{Placement, place};
use crate::dynamics::recursion::quaternion::Passage;
use crate::dynamics::recursion::rotor::Gyrostat;
use crate::dynamics::recursion::shared_ratios::SharedRatios;
use crate::graph::Scalar;
use crate::kinematics::{Body, JointAxis, Mechanism, Transmission};
use crate::spatial::{Force, Matrix3, Symmetric3, Twist, Vector3};

/// Inverse dynamics with the intermediate frames, motions and wrenches of all bodies.
pub(super) struct InverseDynamicsParts<'g> {
    /// Frame of each body's equations.
    pub placements: Vec<Placement<'g>>,
    /// Motion of each body in the frame of its equations.
    pub motions: Vec<BodyMotion<'g>>,
    /// Wrench that accelerates each body and all bodies beyond it.
    pub wrenches: Vec<Force<'g>>,
    /// Generalized forces `M ÿ + k − q_gravity` by coordinate: inertial and Coriolis forces minus gravity.
    pub generalized: Vec<Scalar<'g>>,
}

/// Generalized forces `M ÿ + k − q_gravity` of bodies and rotors, by coordinate: inertial and Coriolis forces
/// minus gravity.
pub fn inverse_dynamics<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    inverse_dynamics_parts(mechanism, formulation, input).generalized
}

/// Wrench that accelerates each body together with all bodies beyond it, including gravity. The moment is
/// about the body's origin, in the axes of the frame in which the body's equations are written.
///
/// The mechanism must be in metres and have the masses of the description, because shifted masses give other
/// wrenches. The formulation must pass all moments to the parent.
pub fn wrenches<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    input: MotionInput<'_, 'g>,
) -> Vec<Force<'g>> {
    inverse_dynamics_parts(mechanism, formulation, input).wrenches
}

/// Inverse dynamics with the intermediate frames, motions and wrenches of all bodies.
pub(super) fn inverse_dynamics_parts<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    input: MotionInput<'_, 'g>,
) -> InverseDynamicsParts<'g> {
    let placements = place(mechanism, formulation, input.y);
    let motions = motions(mechanism, formulation, &placements, input);
    let mut wrenches: Vec<Force<'g>> =
        motions.iter().zip(&placements).map(|(motion, placement)| own_force(motion, placement)).collect();
    let mut generalized = vec![mechanism.graph.constant(0.0); mechanism.coordinates];
    add_rotors(mechanism, &placements, &motions, input, &mut wrenches, &mut generalized);
    gather(mechanism, formulation, &placements, &mut wrenches, &mut generalized);
    InverseDynamicsParts { placements, motions, wrenches, generalized }
}

/// Linear acceleration of a point of a body without gravity, and angular acceleration of the body, in the
/// frame of the body. The mechanism must be in metres.
pub fn frame_acceleration<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    input: MotionInput<'_, 'g>,
    body: usize,
    point: Vector3<Scalar<'g>>,
) -> (Vector3<Scalar<'g>>, Vector3<Scalar<'g>>) {
    let formulation = Formulation::plain(mechanism.bodies.len());
    let weightless = Mechanism { gravity: Vector3::zero(mechanism.graph.constant(0.0)), ..mechanism.clone() };
    let placements = place(&weightless, &formulation, input.y);
    let motion = motions(&weightless, &formulation, &placements, input)[body];
    (motion.acceleration + motion.spread.times(point), motion.angular_acceleration())
}

pub(in crate::dynamics) fn motions<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    placements: &[Placement<'g>],
    input: MotionInput<'_, 'g>,
) -> Vec<BodyMotion<'g>> {
    let mut motions: Vec<BodyMotion<'g>> = Vec::with_capacity(placements.len());
    for (index, body) in mechanism.bodies.iter().enumerate() {
        let base = BodyMotion::at_rest(-mechanism.gravity_for(index));
        let placement = &placements[index];
        let parent = body.parent.map_or(base, |parent| motions[parent]);
        if let Some(place) = body.chain {
            let whole = match place.first == index {
                true => {
                    let mut whole = Passage { mechanism, placements, place }.motion(&parent, input);
                    whole.find_diagonal(formulation.bodies[index].diagonal);
                    whole.named(body)
                }
                false => parent,
            };
            motions.push(whole);
            continue;
        }
        let (rate, acceleration) = (body.transmission.motion(input.v), body.transmission.motion(input.a));
        let mirrored = mirrored(mechanism, placements, index);
        let carried = match mirrored {
            Some(origin) => carried_to_branch(mechanism, placements, index, origin, &parent),
            None => parent.acceleration + parent.spread.times(placement.translation),
        };
        let carried = placement.to_child_unit(&body.twist, carried);
        let mut motion = match body.axis {
            JointAxis::Prismatic => extend(&parent, body, placement, carried, rate, acceleration),
            JointAxis::Revolute => {
                let run_parent = mechanism.bodies[placement.run].parent.map_or(base, |p| motions[p]);
                let joint = RevoluteStep {
                    mechanism,
                    placements,
                    index,
                    choices: formulation.bodies[index],
                    parent: &parent,
                    run_parent: &run_parent,
                };
                joint.turn(input, carried)
            }
        };
        if mirrored.is_none() {
            let lift = motion.spread.column(2).scaled(placement.extension);
            motion.acceleration = motion.acceleration + lift;
        }
        motions.push(motion.named(body));
    }
    motions
}

/// Computes the motion of a body from the motion of its parent, across one revolute joint.
struct RevoluteStep<'a, 'g> {
    mechanism: &'a Mechanism<Scalar<'g>>,
    placements: &'a [Placement<'g>],
    index: usize,
    choices: BodyChoices,
    parent: &'a BodyMotion<'g>,
    run_parent: &'a BodyMotion<'g>,
}

impl<'g> RevoluteStep<'_, 'g> {
    /// Motion of the body after the revolute joint. `origin` is the acceleration of the body's origin.
    fn turn(&self, input: MotionInput<'_, 'g>, origin: Vector3<Scalar<'g>>) -> BodyMotion<'g> {
        let (rate, acceleration) = self.rates(input);
        let source = match self.choices.source {
            RunLink::Parent => self.parent,
            RunLink::RunBase => self.run_parent,
        };
        let carried = self.carry(source.omega);
        let omega = carried + Vector3([rate.constant(0.0), rate.constant(0.0), rate]);
        let (angular, spread) = match self.choices.angular {
            AngularRoute::Acceleration => {
                let mut angular = self.carry(source.angular_acceleration());
                angular.0[0] = angular[0] + carried[1] * rate;
                angular.0[1] = angular[1] - carried[0] * rate;
                angular.0[2] = angular[2] + acceleration;
                (angular.0.map(Some), spread_of(omega, angular))
            }
            AngularRoute::AxisPoints => {
                let axis = self.source_twist().to_parent(unit_z(rate));
                let points = self.carry(source.spread.times(axis));
                let axial = self.axial(source.angular_acceleration()) + acceleration;
                let mut spread = spread_from_axis(omega, points, axial);
                let across = self.choices.by_acceleration.then(|| {
                    let product = omega[0] * omega[2];
                    let across = points[0] - product;
                    spread.0[2][0] = product - across;
                    across
                });
                ([None, across, Some(axial)], spread)
            }
        };
        let mut motion =
            BodyMotion { omega, angular, spread, differences: None, acceleration: origin, chain: None };
        motion.find_diagonal(self.choices.diagonal);
        motion
    }

    /// Velocity and acceleration of the angle between the source and the body. The source is the body from
    /// which the angular velocity is taken.
    fn rates(&self, input: MotionInput<'_, 'g>) -> (Scalar<'g>, Scalar<'g>) {
        let mut chain = vec![self.index];
        if self.choices.source == RunLink::RunBase {
            let mut k = self.index;
            while k != self.placements[self.index].run {
                let Some(parent) = self.mechanism.bodies[k].parent else {
                    break;
                };
                chain.push(parent);
                k = parent;
            }
        }
        let zero = self.mechanism.graph.constant(0.0);
        let joints = chain.iter().rev().map(|&k| &self.mechanism.bodies[k].transmission);
        let sum = |values: &[Scalar<'g>]| Transmission::sum_of_motions(joints.clone(), zero, values);
        (sum(input.v), sum(input.a))
    }

    fn source_twist(&self) -> Twist {
        let first = match self.choices.source {
            RunLink::Parent => self.index,
            RunLink::RunBase => self.placements[self.index].run,
        };
        self.mechanism.bodies[first].twist
    }

    /// Transforms a vector from the frame of the source's equations to the frame of this body's equations.
    /// The source is the body from which the angular velocity is taken.
    fn carry(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let placement = &self.placements[self.index];
        let turn = match self.choices.source {
            RunLink::Parent => placement.turn,
            RunLink::RunBase => placement.turn_from_run,
        };
        let v = self.source_twist().to_child(v);
        turn.map_or(v, |turn| v.turned_back(turn))
    }

    /// Component along this joint's axis of a vector in the frame of the source. The source is the body from
    /// which the angular velocity is taken.
    fn axial(&self, v: Vector3<Scalar<'g>>) -> Scalar<'g> {
        self.source_twist().to_child(v)[2]
    }
}

/// Motion of the body after a prismatic joint with the position d and the axis z. The acceleration of its
/// origin is `a + 2 ω × z ḋ + z d̈`. ω is the parent's angular velocity, and a the acceleration that the
/// parent causes.
fn extend<'g>(
    parent: &BodyMotion<'g>,
    body: &Body<Scalar<'g>>,
    placement: &Placement<'g>,
    carried: Vector3<Scalar<'g>>,
    rate: Scalar<'g>,
    acceleration: Scalar<'g>,
) -> BodyMotion<'g> {
    let omega = placement.to_child(&body.twist, parent.omega);
    let angular = placement.to_child(&body.twist, parent.angular_acceleration());
    let spread = spread_of(omega, angular);
    let twice = rate * 2.0;
    let coriolis = Vector3([omega[1] * twice, -(omega[0] * twice), acceleration]);
    BodyMotion {
        omega,
        angular: angular.0.map(Some),
        spread,
        differences: None,
        acceleration: carried + coriolis,
        chain: None,
    }
}

fn unit_z(any: Scalar<'_>) -> Vector3<Scalar<'_>> {
    Vector3([any.constant(0.0), any.constant(0.0), any.constant(1.0)])
}

/// Matrix U = ω̇× + ω× ω× from the angular velocity ω, the vector `points` = U z, and the component `axial`
/// of the angular acceleration along z.
fn spread_from_axis<'g>(
    omega: Vector3<Scalar<'g>>,
    points: Vector3<Scalar<'g>>,
    axial: Scalar<'g>,
) -> Matrix3<'g> {
    let w = omega;
    let (xx, yy, zz) = (w[0].squared(), w[1].squared(), w[2].squared());
    let xy = w[0] * w[1];
    let twice = w[2] * 2.0;
    Matrix3([
        [-(yy + zz), xy - axial, points[0]],
        [xy + axial, -(xx + zz), points[1]],
        [w[0] * twice - points[0], w[1] * twice - points[1], points[2]],
    ])
}

/// Force, and moment about the origin, that accelerate the mass of one body alone.
fn own_force<'g>(motion: &BodyMotion<'g>, placement: &Placement<'g>) -> Force<'g> {
    let (moments, a) = (placement.moments, motion.acceleration);
    let force = a.scaled(moments.mass) + motion.spread.times(moments.first);
    let moment = moments.first.cross(a) + moment_of_second(motion, moments.second);
    Force { moment, force }
}

/// Moment `vee(U Σ − Σ Uᵀ)` that the second moments Σ = ∫ r rᵀ dm require, with the matrix U = ω̇× + ω× ω×.
fn moment_of_second<'g>(motion: &BodyMotion<'g>, s: Symmetric3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
    let u = &motion.spread;
    // The difference is computed here if no earlier choice computed it, because the order of nodes matters.
    let difference = |k: usize| {
        let [from, to] = [[2, 1], [0, 2], [1, 0]][k];
        motion.differences.map_or_else(|| u[from][from] - u[to][to], |all| all[k])
    };
    Vector3([
        u[2][0] * s.xy - u[1][0] * s.xz + difference(0) * s.yz + u[2][1] * s.yy - u[1][2] * s.zz,
        u[0][1] * s.yz - u[2][1] * s.xy + difference(1) * s.xz + u[0][2] * s.zz - u[2][0] * s.xx,
        u[1][2] * s.xz - u[0][2] * s.yz + difference(2) * s.xy + u[1][0] * s.xx - u[0][1] * s.yy,
    ])
}

/// Adds the forces of the rotors to the coordinates that the rotors follow, and their moments to the bodies
/// that carry them.
fn add_rotors<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    motions: &[BodyMotion<'g>],
    input: MotionInput<'_, 'g>,
    forces: &mut [Force<'g>],
    generalized: &mut [Scalar<'g>],
) {
    for rotor in &mechanism.rotors {
        let moved = &rotor.transmission;
        let (rate, acceleration) = (moved.motion(input.v), moved.motion(input.a));
        moved.add_force(rotor.reflected_inertia() * acceleration, generalized);
        let Some(carrier) = rotor.carrier else {
            continue;
        };
        let (gyrostat, motion) = (Gyrostat::new(rotor, &placements[carrier]), &motions[carrier]);
        let moment = gyrostat.moment(motion.omega, rate, acceleration);
        forces[carrier].moment = forces[carrier].moment + moment;
        let carried = gyrostat.carried(motion.angular_acceleration());
        moved.add_force(carried, generalized);
    }
}

/// Adds the wrench of each body to the wrench of its parent, from the leaves to the base.
fn gather<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    placements: &[Placement<'g>],
    forces: &mut [Force<'g>],
    generalized: &mut [Scalar<'g>],
) {
    let zero = mechanism.graph.constant(0.0);
    // Moments perpendicular to the axes that are passed directly to the frame before a run.
    let mut transverse = vec![Vector3::zero(zero); mechanism.bodies.len()];
    let mut branches = vec![Branches::default(); mechanism.bodies.len()];
    let mut shared = SharedRatios::of(mechanism);
    for index in (0..mechanism.bodies.len()).rev() {
        let (body, placement) = (&mechanism.bodies[index], &placements[index]);
        forces[index] = branches[index].added_to(forces[index]);
        let Force { force, mut moment } = forces[index];
        force.named(&format!("force_{}", body.label()));
        moment.named(&format!("moment_{}", body.label()));
        shared.add_force(&body.transmission, body.axis.force(forces[index]), generalized);
        let mirrored = mirrored(mechanism, placements, index);
        let length = if mirrored.is_some() { zero } else { placement.extension };
        moment = moment + Vector3([-(length * force[1]), length * force[0], zero]);
        if formulation.bodies[index].sink == RunLink::RunBase && placement.run != index {
            let across = Vector3([moment[0], moment[1], zero]);
            let across = placement.turn_from_run.map_or(across, |turn| across.turned(turn));
            transverse[placement.run] = transverse[placement.run] + across;
            moment = Vector3([zero, zero, moment[2]]);
        }
        let Some(parent) = body.parent else { continue };
        let force = body.twist.to_parent(placement.before_joint_unit(force));
        let turned = placement.before_joint(moment) + transverse[index];
        let moment = body.twist.to_parent(turned);
        if let Some(origin) = mirrored {
            forces[parent].moment = forces[parent].moment + moment;
            branches[parent].push(origin, force);
            continue;
        }
        let moment = moment + placement.translation.cross(force);
        forces[parent] =
            Force { force: forces[parent].force + force, moment: forces[parent].moment + moment };
    }
    shared.finish(generalized);
}
