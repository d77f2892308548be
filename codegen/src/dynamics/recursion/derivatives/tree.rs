//! A mechanism in motion: the columns of derivatives at each body, and their transformation to the parent.

use super::base_body::BaseBody;
use super::column::{Column, Disturbance, Disturbed};
use super::flow::{Flow, Lever, shift_flow, twice_across};
use crate::dynamics::formulation::Formulation;
use crate::dynamics::recursion::composite::{before_joint, composites};
use crate::dynamics::recursion::motion::{BodyMotion, MotionInput};
use crate::dynamics::recursion::placement::Placement;
use crate::dynamics::recursion::quaternion::{ChainDisturbance, unit_motion};
use crate::dynamics::recursion::rotor::Gyrostat;
use crate::graph::Scalar;
use crate::kinematics::{ChainPlace, Followed, JointAxis, Mechanism, Rotor};
use crate::spatial::{Force, Matrix3, Motion, Vector3};

/// A mechanism in motion, with the frame, motion and levers of each body.
pub(super) struct Tree<'a, 'g> {
    pub(super) mechanism: &'a Mechanism<Scalar<'g>>,
    pub(super) placements: &'a [Placement<'g>],
    pub(super) motions: &'a [BodyMotion<'g>],
    pub(super) levers: Vec<Lever<'g>>,
    /// All bodies in the frame of the tree's first body for [`PairFrame::Root`](super::PairFrame::Root);
    /// otherwise empty.
    pub(super) base: Vec<BaseBody<'g>>,
}

impl<'g> Tree<'_, 'g> {
    /// Moments of mass and velocity moments (2 ∫ ṙ dm, 2 ∫ ṙ rᵀ dm) of each body with all bodies beyond it,
    /// in the frame of the body's equations.
    pub(super) fn flows(&self, formulation: &Formulation, input: MotionInput<'_, 'g>) -> Vec<Flow<'g>> {
        let composites = composites(self.mechanism, formulation, self.placements);
        let mut flows: Vec<Flow<'g>> = composites
            .into_iter()
            .enumerate()
            .map(|(index, composite)| {
                let moments = self.placements[index].moments;
                let twice = self.motions[index].omega.map(|x| x * 2.0);
                let momentum = twice.cross(moments.first);
                Flow { composite, momentum, spin: Matrix3::cross_of(twice, moments.second) }
            })
            .collect();
        self.add_rotor_spin(&mut flows, input);
        for index in (0..flows.len()).rev() {
            if let Some(parent) = self.mechanism.bodies[index].parent {
                let (momentum, spin) = self.pass_flow(index, &flows[index]);
                flows[parent].momentum = flows[parent].momentum + momentum;
                flows[parent].spin = flows[parent].spin + spin;
            }
        }
        flows
    }

    /// Transforms the velocity moments (2 ∫ ṙ dm, 2 ∫ ṙ rᵀ dm) of a body with all bodies beyond it to the
    /// parent's frame and origin.
    fn pass_flow(&self, index: usize, flow: &Flow<'g>) -> (Vector3<Scalar<'g>>, Matrix3<'g>) {
        let (body, placement, lever) =
            (&self.mechanism.bodies[index], &self.placements[index], &self.levers[index]);
        let zero = lever.along.constant(0.0);
        let moments = flow.composite.moments;
        let along = Vector3([zero, zero, lever.along]);
        let (momentum, spin) = shift_flow(moments, flow.momentum, &flow.spin, along, lever.along_velocity);
        let moments = before_joint(moments.lifted(lever.along), placement);
        let moments = moments.to_parent(&body.twist, Vector3::zero(zero));
        let momentum = body.twist.to_parent(placement.before_joint_unit(momentum));
        let spin = placement.matrix_before_joint(&spin);
        let spin = spin.twisted(&body.twist);
        shift_flow(moments, momentum, &spin, placement.translation, lever.across_velocity)
    }

    /// Adds the spin of the rotors to the moment 2 ∫ ṙ rᵀ dm of their carriers.
    fn add_rotor_spin(&self, flows: &mut [Flow<'g>], input: MotionInput<'_, 'g>) {
        for rotor in &self.mechanism.rotors {
            let Some(carrier) = rotor.carrier else {
                continue;
            };
            let rate = rotor.transmission.motion(input.v);
            let spin = Gyrostat::new(rotor, &self.placements[carrier]).spin(rate);
            flows[carrier].spin = flows[carrier].spin + spin;
        }
    }

    /// Column of derivatives of body `index` for a unit of acceleration, velocity and position of its
    /// coordinate. If the joint follows several coordinates, the unit is a unit of the joint's motion.
    ///
    /// - `needed`: wrench that the body and all bodies beyond it require
    pub(super) fn column(&self, index: usize, flow: &Flow<'g>, needed: &Force<'g>) -> Column<'g> {
        let zero = needed.force[0].constant(0.0);
        let axis = self.mechanism.bodies[index].axis;
        if let Some(place) = self.mechanism.bodies[index].chain {
            return self.chain_column(index, unit_motion(axis.turns(), place, zero), place, flow);
        }
        let screw = axis.unit_motion(zero);
        let disturbance = self.disturbance(index);
        let mut inertial = flow.response(&Disturbed {
            omega: Vector3::zero(zero),
            beta: screw.angular,
            acceleration: screw.linear,
        });
        let (own, turned) = (flow.response(&disturbance.by_coordinate), screw.cross_force(*needed));
        let mut stiffness = Force { force: own.force + turned.force, moment: own.moment + turned.moment };
        let by_omega = match axis {
            JointAxis::Revolute => {
                inertial.moment.0[2] = flow.composite.polar;
                let spin = &flow.spin;
                Vector3([-spin[2][0], -spin[2][1], spin[0][0] + spin[1][1]])
            }
            JointAxis::Prismatic => flow.momentum.cross(screw.linear),
        };
        if self.looks_the_same_turned(index) {
            // The wrench does not depend on the angle. The sums above would leave rounding errors.
            stiffness = Force::zero(zero);
        }
        let single = self.mechanism.bodies[index].transmission.single();
        let ratio = single.map_or(zero.constant(1.0), |followed| followed.ratio);
        Column {
            inertial: inertial.map(|x| x * ratio),
            damping: flow.response(&disturbance.by_velocity).map(|x| x * ratio),
            stiffness: stiffness.map(|x| x * ratio),
            by_omega: by_omega.map(|x| x * ratio),
        }
    }

    /// Column of derivatives for a unit of acceleration, velocity and position along one velocity of a joint
    /// with a quaternion. The column is in the moving frame of the joint's last body.
    fn chain_column(
        &self,
        index: usize,
        screw: Motion<'g>,
        place: ChainPlace,
        flow: &Flow<'g>,
    ) -> Column<'g> {
        let nothing = Vector3::zero(screw.linear[0]);
        let accelerated = Disturbed { omega: nothing, beta: screw.angular, acceleration: screw.linear };
        let disturbance = self.disturbance(index);
        let spin = &flow.spin;
        let trace = spin[0][0] + spin[1][1] + spin[2][2];
        // Row `axis` of tr 2K − 2K for a rotation, 2P × e for a translation.
        let by_omega = match self.mechanism.bodies[index].axis {
            JointAxis::Revolute => screw.angular.scaled(trace) - Vector3(spin[place.axis]),
            JointAxis::Prismatic => flow.momentum.cross(screw.linear),
        };
        Column {
            inertial: flow.response(&accelerated),
            damping: flow.response(&disturbance.by_velocity),
            stiffness: flow.response(&disturbance.by_coordinate),
            by_omega,
        }
    }

    /// Whether a body is a leaf with a revolute joint and has a mass that is rotationally symmetric about the
    /// joint's axis.
    fn looks_the_same_turned(&self, index: usize) -> bool {
        let moments = self.placements[index].moments;
        let (first, second) = (moments.first, moments.second);
        let across = [first[0], first[1], second.xy, second.xz, second.yz];
        let bodies = &self.mechanism.bodies;
        bodies[index].axis == JointAxis::Revolute
            && bodies.iter().all(|body| body.parent != Some(index))
            && self.mechanism.rotors.iter().all(|r| r.carrier != Some(index))
            && across.iter().all(|x| x.is_zero())
            && second.xx == second.yy
    }

    pub(super) fn disturbance(&self, index: usize) -> Disturbance<'g> {
        let motion = &self.motions[index];
        let body = &self.mechanism.bodies[index];
        if let (Some(place), Some(chain)) = (body.chain, &motion.chain) {
            let turns = body.axis.turns();
            let screw = unit_motion(turns, place, motion.omega[0]);
            let e = if turns { screw.angular } else { screw.linear };
            let ChainDisturbance { by_position, by_velocity } = chain.disturbance(motion.omega, turns, e);
            return Disturbance {
                by_coordinate: Disturbed::of(by_position),
                by_velocity: Disturbed::of(by_velocity),
            };
        }
        let (w, u, a) = (motion.omega, &motion.spread, motion.acceleration);
        let zero = w[0].constant(0.0);
        let nothing = Vector3::zero(zero);
        let axis_points = u.column(2);
        match self.mechanism.bodies[index].axis {
            JointAxis::Revolute => Disturbance {
                by_coordinate: Disturbed {
                    omega: Vector3([w[1], -w[0], zero]),
                    beta: axis_points,
                    acceleration: Vector3([a[1], -a[0], zero]),
                },
                by_velocity: Disturbed {
                    omega: Vector3([zero, zero, zero.constant(1.0)]),
                    beta: twice_across(w),
                    acceleration: nothing,
                },
            },
            JointAxis::Prismatic => Disturbance {
                by_coordinate: Disturbed { omega: nothing, beta: nothing, acceleration: axis_points },
                by_velocity: Disturbed { omega: nothing, beta: nothing, acceleration: twice_across(w) },
            },
        }
    }

    pub(super) fn pass_on(&self, index: usize, column: &Column<'g>) -> Column<'g> {
        let (body, placement, lever) =
            (&self.mechanism.bodies[index], &self.placements[index], &self.levers[index]);
        let zero = lever.along.constant(0.0);
        let along = Vector3([zero, zero, lever.along]);
        let force_to_parent =
            |force: Vector3<Scalar<'g>>| body.twist.to_parent(placement.before_joint_unit(force));
        let pass = |f: Force<'g>| {
            let lifted = f.moment + along.cross(f.force);
            let force = force_to_parent(f.force);
            let moment = placement.to_parent(&body.twist, lifted) + placement.translation.cross(force);
            Force { moment, force }
        };
        let lifted = column.by_omega + lever.along_velocity.cross(column.inertial.force);
        let inertial = pass(column.inertial);
        let by_omega = placement.to_parent(&body.twist, lifted) + lever.across_velocity.cross(inertial.force);
        Column { inertial, damping: pass(column.damping), stiffness: pass(column.stiffness), by_omega }
    }

    /// All bodies in the frame of the tree's first body.
    pub(super) fn base_bodies(&self) -> Vec<BaseBody<'g>> {
        let mut bodies: Vec<BaseBody<'g>> = Vec::with_capacity(self.mechanism.bodies.len());
        for (index, body) in self.mechanism.bodies.iter().enumerate() {
            let (placement, lever) = (&self.placements[index], &self.levers[index]);
            let zero = lever.along.constant(0.0);
            let one = zero.constant(1.0);
            let unit = [[one, zero, zero], [zero, one, zero], [zero, zero, one]].map(Vector3);
            let (axes, origin, velocity) = match body.parent {
                Some(parent) => {
                    let parent = &bodies[parent];
                    let origin = parent.origin + parent.direction(placement.translation);
                    let velocity = parent.twice_velocity + parent.direction(lever.across_velocity);
                    // Column k of R is the k-th unit vector after the twist and the rotation of the joint.
                    let [x, y, z] = unit.map(|axis| parent.direction(body.twist.to_parent(axis)));
                    match placement.turn {
                        Some((s, c)) => {
                            ([x.scaled(c) + y.scaled(s), y.scaled(c) - x.scaled(s), z], origin, velocity)
                        }
                        None => ([x, y, z], origin, velocity),
                    }
                }
                None => (unit, -Vector3([zero, zero, lever.along]), Vector3::zero(zero)),
            };
            let mut seen = BaseBody {
                axes,
                origin: origin + axes[2].scaled(lever.along),
                twice_velocity: velocity,
                screw: body.axis.along(axes[2], Vector3::zero(zero)),
                disturbance: self.disturbance(index),
            };
            seen.twice_velocity = seen.twice_velocity + seen.direction(lever.along_velocity);
            seen.screw = body.axis.along(axes[2], seen.origin);
            let Disturbance { by_coordinate, by_velocity } = seen.disturbance;
            seen.disturbance = Disturbance {
                by_coordinate: seen.disturbed(&by_coordinate),
                by_velocity: seen.disturbed(&by_velocity),
            };
            bodies.push(seen);
        }
        bodies
    }

    /// Transforms a column of derivatives to the frame in which it is passed to the base.
    pub(super) fn depart(&self, index: usize, column: Column<'g>) -> Column<'g> {
        self.base.get(index).map_or(column, |body| body.column(&column))
    }

    /// Whether a body is on the path from the parent of a joint to the base.
    pub(super) fn passes(&self, joint: usize, body: usize) -> bool {
        let mut next = self.mechanism.bodies[joint].parent;
        while let Some(index) = next {
            if index == body {
                return true;
            }
            next = self.mechanism.bodies[index].parent;
        }
        false
    }

    /// Coordinates of a body's column of derivatives, each with its factor.
    pub(super) fn coordinates_of(&self, index: usize) -> Vec<Followed<Scalar<'g>>> {
        let transmission = &self.mechanism.bodies[index].transmission;
        match transmission.single() {
            // The column already contains the ratio.
            Some(Followed { coordinate, ratio }) => {
                vec![Followed { coordinate, ratio: ratio.constant(1.0) }]
            }
            None => transmission.terms.clone(),
        }
    }

    /// Adds to a column of derivatives the rotors on body `index` that the column's joint turns.
    pub(super) fn add_rotor_couplings(&self, index: usize, joint: usize, column: &mut Column<'g>) {
        let rotors = self.mechanism.rotors.iter();
        for rotor in rotors.filter(|r| r.carrier == Some(index) && r.driven == Some(joint)) {
            self.add_rotor_coupling(index, rotor, column);
        }
    }

    /// Adds a rotor on body `index` to the column of derivatives for the coordinates that the rotor follows.
    pub(super) fn add_rotor_coupling(
        &self,
        index: usize,
        rotor: &Rotor<Scalar<'g>>,
        column: &mut Column<'g>,
    ) {
        let momentum = Gyrostat::new(rotor, &self.placements[index]).momentum();
        let swept = self.motions[index].omega.cross(momentum);
        let (momentum, swept) = match self.base.get(index) {
            Some(body) => (body.direction(momentum), body.direction(swept)),
            None => (momentum, swept),
        };
        column.inertial.moment = column.inertial.moment + momentum;
        column.damping.moment = column.damping.moment + swept;
        column.by_omega = column.by_omega + swept;
    }
}
