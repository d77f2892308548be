//! Analytic derivatives of the inverse dynamics, with composite bodies.
//!
//! A body that carries others is disturbed by an angular velocity δω, by β = δω̇ + ω × δω and by an
//! acceleration δa of its origin. With r and ṙ relative to that origin, every point of the subtree then
//! accelerates by
//!
//! ```text
//! δr̈ = δa + β × r + 2 δω × ṙ
//! ```
//!
//! and δω, β stay the same vectors in every body beyond. So the force and moment that follow need only the
//! composite moments m, h = ∫ r dm, Σ = ∫ r rᵀ dm, 2 P = 2 ∫ ṙ dm and 2 K = 2 ∫ ṙ rᵀ dm:
//!
//! ```text
//! δF = m δa + β × h + δω × 2P
//! δn = h × δa + (tr Σ − Σ) β + (tr 2K − 2K) δω
//! ```
//!
//! A revolute coordinate disturbs by δω = ω × z, β = U z, δa = a × z, its velocity by δω = z, β = 2 ω × z; a
//! prismatic one by δa = U z and δa = 2 ω × z. The derivatives are those of Carpentier and Mansard (2018) and
//! of Singh, Russell and Wensing (2022), written with classical accelerations, so that no linear velocity is
//! needed.

use crate::dynamics::matrix::Matrix;
use crate::dynamics::recursion::composite::{Composite, before_joint, composites};
use crate::dynamics::recursion::newton_euler::{BodyMotion, MotionInput, inverse_dynamics_parts};
use crate::dynamics::recursion::placement::Placement;
use crate::dynamics::recursion::rotor::{self, Gyrostat};
use crate::dynamics::search::formulation::Formulation;
use crate::graph::Scalar;
use crate::kinematics::{Body, JointAxis, Mechanism};
use crate::spatial::{Force, MassMoments, Matrix3, Motion, Vector3};

/// Inverse dynamics of bodies and rotors with their derivatives.
#[derive(Debug, Clone)]
pub struct ForceDerivatives<'g> {
    /// `M ÿ + k − q_gravity`
    pub forces: Vec<Scalar<'g>>,
    /// ∂/∂y, row i = force i.
    pub by_coordinates: Matrix<'g>,
    /// ∂/∂ẏ, row i = force i.
    pub by_velocities: Matrix<'g>,
    /// M
    pub mass_matrix: Matrix<'g>,
}

/// Where the columns of the derivatives meet the joints that they couple with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairFrame {
    /// In the working frame of each joint, carried there link by link.
    Links,
    /// In the frame of the tree's first body: nothing is carried, but every product has all its components.
    /// All bodies need the same unit of length.
    Root,
}

/// Derives all of them in the working frames of a formulation.
pub fn inverse_dynamics_derivatives<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    pairs: PairFrame,
    input: MotionInput<'_, 'g>,
) -> ForceDerivatives<'g> {
    // Wrenches are read at every body, so none may be led past it.
    let formulation = &formulation.without_shortcuts();
    let parts = inverse_dynamics_parts(mechanism, formulation, input);
    let zeros = vec![vec![mechanism.graph.constant(0.0); mechanism.len()]; mechanism.len()];
    let mut result = ForceDerivatives {
        forces: parts.generalized,
        by_coordinates: zeros.clone(),
        by_velocities: zeros.clone(),
        mass_matrix: zeros,
    };
    let tree = Tree {
        mechanism,
        placements: &parts.placements,
        motions: &parts.motions,
        levers: levers(mechanism, &parts.placements, &parts.motions, input),
        base: Vec::new(),
    };
    let tree = match pairs {
        PairFrame::Links => tree,
        PairFrame::Root => Tree { base: tree.base_bodies(), ..tree },
    };
    let flows = tree.flows(formulation, input);
    for index in 0..mechanism.len() {
        let column = tree.column(index, &flows[index], &parts.wrenches[index]);
        tree.read_own(index, &column, &mut result);
        tree.walk(index, index, tree.depart(index, column), &mut result);
    }
    rotor::add_inertia(mechanism, &mut result.mass_matrix);
    for rotor in &mechanism.rotors {
        let Some(carrier) = rotor.carrier.filter(|&carrier| !tree.passes(rotor.driven, carrier)) else {
            continue;
        };
        let mut column = Column::zero(mechanism);
        tree.add_rotor_coupling(carrier, rotor.driven, &mut column);
        tree.read_off(carrier, rotor.driven, &column, &mut result);
        tree.walk(carrier, rotor.driven, column, &mut result);
    }
    result
}

/// Composite moments that depend on velocities: 2P and 2K.
#[derive(Clone, Copy)]
struct Flow<'g> {
    composite: Composite<'g>,
    momentum: Vector3<Scalar<'g>>,
    spin: Matrix3<'g>,
}

/// Levers of a joint and twice their velocities: along z in the body's frame, then across in the parent's.
#[derive(Clone, Copy)]
struct Lever<'g> {
    along: Scalar<'g>,
    along_velocity: Vector3<Scalar<'g>>,
    across_velocity: Vector3<Scalar<'g>>,
}

fn levers<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    motions: &[BodyMotion<'g>],
    input: MotionInput<'_, 'g>,
) -> Vec<Lever<'g>> {
    let zero = mechanism.graph.constant(0.0);
    let lever = |(index, body): (usize, &Body<Scalar<'g>>)| {
        let rate = match body.axis {
            JointAxis::Revolute => zero,
            JointAxis::Prismatic => body.transmission.motion(input.v),
        };
        let twice = twice_across(motions[index].omega);
        let along = placements[index].extension;
        let mut along_velocity = twice.scaled(along);
        along_velocity.0[2] = rate * 2.0;
        let across_velocity = match body.parent {
            Some(parent) => motions[parent].omega.cross(placements[index].translation).map(|x| x * 2.0),
            None => Vector3::zero(zero),
        };
        Lever { along, along_velocity, across_velocity }
    };
    mechanism.bodies.iter().enumerate().map(lever).collect()
}

/// `2 ω × z`
fn twice_across(omega: Vector3<Scalar<'_>>) -> Vector3<Scalar<'_>> {
    Vector3([omega[1] * 2.0, -(omega[0] * 2.0), omega[2].constant(0.0)])
}

/// A column of the derivatives on its way to the base: three wrenches, and what the torque of the column's
/// joint gains by disturbances of the body that it has arrived at.
#[derive(Clone, Copy)]
struct Column<'g> {
    /// By the acceleration; also: torque of the joint by δa and β.
    inertial: Force<'g>,
    /// By the velocity.
    damping: Force<'g>,
    /// By the coordinate.
    stiffness: Force<'g>,
    /// Torque of the joint by δω.
    by_omega: Vector3<Scalar<'g>>,
}

impl<'g> Column<'g> {
    fn zero(mechanism: &Mechanism<Scalar<'g>>) -> Self {
        let zero = mechanism.graph.constant(0.0);
        let nothing = Force::zero(zero);
        Self { inertial: nothing, damping: nothing, stiffness: nothing, by_omega: Vector3::zero(zero) }
    }
}

/// How a coordinate and its velocity disturb the body that it moves.
#[derive(Clone, Copy)]
struct Disturbance<'g> {
    by_coordinate: Disturbed<'g>,
    by_velocity: Disturbed<'g>,
}

#[derive(Clone, Copy)]
struct Disturbed<'g> {
    omega: Vector3<Scalar<'g>>,
    beta: Vector3<Scalar<'g>>,
    acceleration: Vector3<Scalar<'g>>,
}

impl<'g> Flow<'g> {
    /// Force and moment about the origin that a disturbance of the body causes.
    fn response(&self, disturbed: &Disturbed<'g>) -> Force<'g> {
        let Disturbed { omega, beta, acceleration } = *disturbed;
        let moments = self.composite.moments;
        let force =
            acceleration.scaled(moments.mass) + beta.cross(moments.first) + omega.cross(self.momentum);
        let moment = moments.first.cross(acceleration)
            + self.composite.inertia_times(beta)
            + self.spin.complement_times(omega);
        Force { moment, force }
    }
}

/// The mechanism in motion.
struct Tree<'a, 'g> {
    mechanism: &'a Mechanism<Scalar<'g>>,
    placements: &'a [Placement<'g>],
    motions: &'a [BodyMotion<'g>],
    levers: Vec<Lever<'g>>,
    /// Every body as seen from the base, where the pairs meet there.
    base: Vec<BaseBody<'g>>,
}

/// A body as seen from the root of its tree: vectors in the axes of the root's working frame, moments and
/// accelerations at its origin, velocities relative to the base.
#[derive(Clone, Copy)]
struct BaseBody<'g> {
    axes: [Vector3<Scalar<'g>>; 3],
    origin: Vector3<Scalar<'g>>,
    twice_velocity: Vector3<Scalar<'g>>,
    /// What a unit of the joint's velocity does to points at the base's origin.
    screw: Motion<'g>,
    disturbance: Disturbance<'g>,
}

impl<'g> BaseBody<'g> {
    fn direction(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.axes[0].scaled(v[0]) + self.axes[1].scaled(v[1]) + self.axes[2].scaled(v[2])
    }

    /// A disturbance of the body, with the acceleration of the point at the base's origin.
    fn disturbed(&self, local: &Disturbed<'g>) -> Disturbed<'g> {
        let (omega, beta) = (self.direction(local.omega), self.direction(local.beta));
        let at_origin =
            self.direction(local.acceleration) - beta.cross(self.origin) - omega.cross(self.twice_velocity);
        Disturbed { omega, beta, acceleration: at_origin }
    }

    fn force(&self, f: Force<'g>) -> Force<'g> {
        let force = self.direction(f.force);
        let moment = self.direction(f.moment) + self.origin.cross(force);
        Force { moment, force }
    }

    fn column(&self, column: &Column<'g>) -> Column<'g> {
        let inertial = self.force(column.inertial);
        Column {
            inertial,
            damping: self.force(column.damping),
            stiffness: self.force(column.stiffness),
            by_omega: self.direction(column.by_omega) + self.twice_velocity.cross(inertial.force),
        }
    }
}

impl<'g> Tree<'_, 'g> {
    /// Composite moments of every body in its working frame.
    fn flows(&self, formulation: &Formulation, input: MotionInput<'_, 'g>) -> Vec<Flow<'g>> {
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

    /// 2P and 2K of a subtree about the parent's origin.
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
        let spin = placement.turn.map_or(spin, |turn| spin.turned(turn));
        let spin = spin.twisted(&body.twist);
        shift_flow(moments, momentum, &spin, placement.translation, lever.across_velocity)
    }

    /// A rotor's spin turns with its carrier.
    fn add_rotor_spin(&self, flows: &mut [Flow<'g>], input: MotionInput<'_, 'g>) {
        for rotor in &self.mechanism.rotors {
            let Some(carrier) = rotor.carrier else {
                continue;
            };
            let rate = input.v[rotor.transmission.coordinate];
            let spin = Gyrostat::new(rotor, &self.placements[carrier]).spin(rate);
            flows[carrier].spin = flows[carrier].spin + spin;
        }
    }

    /// What body `index` needs for a unit of its joint's acceleration, velocity and position.
    fn column(&self, index: usize, flow: &Flow<'g>, needed: &Force<'g>) -> Column<'g> {
        let zero = needed.force[0].constant(0.0);
        let axis = self.mechanism.bodies[index].axis;
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
            // What it needs does not change with its angle; the sums above would only leave their rounding.
            stiffness = Force::zero(zero);
        }
        let ratio = self.mechanism.bodies[index].transmission.ratio;
        Column {
            inertial: inertial.map(|x| x * ratio),
            damping: flow.response(&disturbance.by_velocity).map(|x| x * ratio),
            stiffness: stiffness.map(|x| x * ratio),
            by_omega: by_omega.map(|x| x * ratio),
        }
    }

    /// Whether a body that carries nothing has its masses around the axis of its revolute joint evenly.
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

    fn disturbance(&self, index: usize) -> Disturbance<'g> {
        let motion = &self.motions[index];
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

    /// Every body as seen from the base.
    fn base_bodies(&self) -> Vec<BaseBody<'g>> {
        let mut bodies: Vec<BaseBody<'g>> = Vec::with_capacity(self.mechanism.len());
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
                    // Column k of R is what the twist makes of the unit vector k, turned afterwards.
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

    /// A column where it starts its way to the base.
    fn depart(&self, index: usize, column: Column<'g>) -> Column<'g> {
        self.base.get(index).map_or(column, |body| body.column(&column))
    }

    /// Carries the column of a joint from a body to the base and reads off the entries at every joint that it
    /// passes.
    fn walk(&self, start: usize, joint: usize, mut column: Column<'g>, result: &mut ForceDerivatives<'g>) {
        let mut index = start;
        while let Some(parent) = self.mechanism.bodies[index].parent {
            if self.base.is_empty() {
                column = self.pass_on(index, &column);
            }
            index = parent;
            self.add_rotor_coupling(index, joint, &mut column);
            self.read_off(index, joint, &column, result);
        }
    }

    /// The entries of the column's own joint.
    fn read_own(&self, index: usize, values: &Column<'g>, result: &mut ForceDerivatives<'g>) {
        let Body { axis, transmission, .. } = &self.mechanism.bodies[index];
        let add = |f, matrix| transmission.add_row_entry(transmission.coordinate, axis.force(f), matrix);
        add(values.inertial, &mut result.mass_matrix);
        add(values.damping, &mut result.by_velocities);
        add(values.stiffness, &mut result.by_coordinates);
    }

    /// What a force on its way exerts along the joint of a body.
    fn met_by(&self, index: usize, f: Force<'g>) -> Scalar<'g> {
        match self.base.get(index) {
            None => self.mechanism.bodies[index].axis.force(f),
            Some(body) => body.screw.dot(f),
        }
    }

    /// The entries that couple the column's joint with another one.
    fn read_off(&self, index: usize, joint: usize, values: &Column<'g>, result: &mut ForceDerivatives<'g>) {
        let row = &self.mechanism.bodies[index].transmission;
        let column = self.mechanism.bodies[joint].transmission.coordinate;
        row.add_coupling(column, self.met_by(index, values.inertial), &mut result.mass_matrix);
        row.add_row_entry(column, self.met_by(index, values.damping), &mut result.by_velocities);
        row.add_row_entry(column, self.met_by(index, values.stiffness), &mut result.by_coordinates);
        let disturbance =
            self.base.get(index).map_or_else(|| self.disturbance(index), |body| body.disturbance);
        let gain = |disturbed: Disturbed<'g>| {
            let Force { force, moment } = values.inertial;
            let by_motion = moment.dot(disturbed.beta) + force.dot(disturbed.acceleration);
            values.by_omega.dot(disturbed.omega) + by_motion
        };
        row.add_column_entry(column, gain(disturbance.by_coordinate), &mut result.by_coordinates);
        row.add_column_entry(column, gain(disturbance.by_velocity), &mut result.by_velocities);
    }

    /// Whether the path from a joint to the base passes a body, after the joint itself.
    fn passes(&self, joint: usize, body: usize) -> bool {
        let mut next = self.mechanism.bodies[joint].parent;
        while let Some(index) = next {
            if index == body {
                return true;
            }
            next = self.mechanism.bodies[index].parent;
        }
        false
    }

    /// Adds the rotors on a body whose drives move the column's joint.
    fn add_rotor_coupling(&self, index: usize, joint: usize, column: &mut Column<'g>) {
        let rotors = self.mechanism.rotors.iter();
        for rotor in rotors.filter(|r| r.carrier == Some(index) && r.driven == joint) {
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

    fn pass_on(&self, index: usize, column: &Column<'g>) -> Column<'g> {
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
}

/// 2P and 2K about another point: with the lever r and twice its velocity v.
fn shift_flow<'g>(
    moments: MassMoments<Scalar<'g>>,
    momentum: Vector3<Scalar<'g>>,
    spin: &Matrix3<'g>,
    lever: Vector3<Scalar<'g>>,
    velocity: Vector3<Scalar<'g>>,
) -> (Vector3<Scalar<'g>>, Matrix3<'g>) {
    let moved = momentum + velocity.scaled(moments.mass);
    let entry = |i: usize, j: usize| spin[i][j] + (moved[i] * lever[j] + velocity[i] * moments.first[j]);
    (moved, Matrix3::from_fn(entry))
}
