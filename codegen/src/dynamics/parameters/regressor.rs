//! Regressor of the inertial parameters: `W π = M ÿ + k − q_gravity`.
//!
//! Each link that a joint moves has ten parameters in the link's frame: m, m c_x, m c_y, m c_z, I_xx, I_xy,
//! I_yy, I_xz, I_yz, I_zz about the frame's origin (order of Pinocchio). They include links that are fixed to
//! the link. One unit of a parameter requires the force F and the moment n
//!
//! ```text
//! m: F = a          m c: F = U e, n = e × a          I: n = E ω̇ + ω × E ω
//! ```
//!
//! with the acceleration a of the origin minus gravity, and with U = ω̇× + ω× ω× (Atkeson, An and Hollerbach
//! 1986). E is the unit matrix of an inertia entry, and e is a unit vector. The regressor's entry in the row
//! of a joint is the power of F and n at a unit of the joint's velocity. Therefore the screws of the joints
//! are passed towards the leaves, instead of wrenches towards the base. Each rotor adds one column.

use crate::dynamics::formulation::Formulation;
use crate::dynamics::matrix::Matrix;
use crate::dynamics::recursion::motion::{BodyMotion, MotionInput, spread_of};
use crate::dynamics::recursion::newton_euler::motions;
use crate::dynamics::recursion::placement::{Placement, place};
use crate::graph::{Graph, Scalar};
use crate::kinematics::{Mechanism, described_moments, lower, lower_followed};
use crate::model::{Drive, Input, Model, RotorCoupling};
use crate::spatial::{Matrix3, Motion, Vector3, rotate};
use gelenk_formula::Formula;

/// Number of inertial parameters of a link.
pub const PER_LINK: usize = 10;

/// Symbols of the ten inertial parameters of a link, in their order.
pub const SYMBOLS: [&str; PER_LINK] = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// Drives with a rotor, that is all drives except ideal drives. Drives with an input come first, in the order
/// of the inputs, then drives without an input.
pub fn drives_with_rotor(model: &Model) -> impl Iterator<Item = &Drive> {
    let inputless = model.moving_drives().filter(|drive| drive.input == Input::None);
    model.input_drives().chain(inputless).filter(|drive| !is_ideal(drive))
}

fn is_ideal(drive: &Drive) -> bool {
    drive.gear_ratio == Formula::ONE && drive.rotor_inertia == Formula::ZERO
}

/// Names of all inertial parameters: the parameters of the links that joints move, then the inertias of the
/// rotors.
pub fn parameter_names(model: &Model) -> Vec<String> {
    let joints = model.carrying_joints().into_iter();
    let links = joints.flat_map(|joint| SYMBOLS.map(|symbol| format!("{symbol}_{}", joint.name)));
    let rotors = drives_with_rotor(model).map(|drive| format!("J_{}", drive.name));
    links.chain(rotors).collect()
}

/// Values of all inertial parameters, in the order of [`parameter_names`].
pub fn inertial_parameters<'g>(graph: &'g Graph, model: &Model) -> Vec<Scalar<'g>> {
    let links = described_moments(graph, model).into_iter().flat_map(|link| {
        let (h, s) = (link.first, link.second);
        let (xx, yy, zz) = (s.yy + s.zz, s.xx + s.zz, s.xx + s.yy);
        [link.mass, h[0], h[1], h[2], xx, -s.xy, yy, -s.xz, -s.yz, zz]
    });
    let rotors = drives_with_rotor(model).map(|drive| lower(graph, &drive.rotor_inertia));
    links.chain(rotors).collect()
}

/// Regressor W of the inertial parameters π in `W π = M ÿ + k − q_gravity` (inertial and Coriolis forces
/// minus gravity). Rows have the order of the coordinates, and columns have the order of [`parameter_names`].
/// The mechanism must be in metres, with the masses of the description.
pub fn inertial_regressor<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    model: &Model,
    input: MotionInput<'_, 'g>,
) -> Matrix<'g> {
    let formulation = Formulation::plain(mechanism.bodies.len());
    let placements = place(mechanism, &formulation, input.y);
    let motions = motions(mechanism, &formulation, &placements, input);
    let screws = joint_screws(mechanism, &placements);
    let zero = mechanism.graph.constant(0.0);
    let rotors: Vec<&Drive> = drives_with_rotor(model).collect();
    let carrying = model.carrying_joints();
    let of_links = PER_LINK * carrying.len();
    let columns = of_links + rotors.len();
    let mut matrix = vec![vec![zero; columns]; mechanism.coordinates];
    // Slides of helical joints carry no link. In a joint with a quaternion, only the last velocity carries a
    // link.
    let bodies = mechanism.bodies.iter().enumerate().filter(|(_, body)| !body.is_screw_slide);
    for (index, body) in bodies {
        let Some(block) = carrying.iter().position(|joint| joint.index == body.joint) else { continue };
        let joint = &carrying[block];
        let link = LinkMotion::new(mechanism, joint.moving.link, &motions[index]);
        for screw in &screws[index] {
            let joint = &mechanism.bodies[screw.joint];
            let entries = link.powers(link.motion(screw.motion));
            for (k, entry) in entries.into_iter().enumerate() {
                let column = PER_LINK * block + k;
                joint.transmission.add_row_entry(column, entry, &mut matrix);
            }
        }
    }
    for (k, drive) in rotors.into_iter().enumerate() {
        let column = rotor_column(mechanism, drive, &motions, &screws, input);
        for (row, entry) in matrix.iter_mut().zip(column) {
            row[of_links + k] = entry;
        }
    }
    matrix
}

/// Motion of a body for a unit of a joint's velocity, in the body's frame.
#[derive(Clone, Copy)]
struct Screw<'g> {
    joint: usize,
    motion: Motion<'g>,
}

/// For each body, its motions for a unit velocity of each joint that moves it.
fn joint_screws<'g>(mechanism: &Mechanism<Scalar<'g>>, placements: &[Placement<'g>]) -> Vec<Vec<Screw<'g>>> {
    let zero = mechanism.graph.constant(0.0);
    let mut screws: Vec<Vec<Screw<'g>>> = Vec::with_capacity(mechanism.bodies.len());
    for (index, body) in mechanism.bodies.iter().enumerate() {
        let placement = &placements[index];
        let lift = Vector3([zero, zero, placement.extension]);
        let carried = |screw: &Screw<'g>| {
            let Motion { angular, linear } = screw.motion;
            let at_joint = linear + angular.cross(placement.translation);
            let angular = placement.to_child(&body.twist, angular);
            let linear = placement.to_child(&body.twist, at_joint) + angular.cross(lift);
            Screw { joint: screw.joint, motion: Motion { angular, linear } }
        };
        let parents = body.parent.map_or(&[][..], |parent| screws[parent].as_slice());
        let mut all: Vec<Screw<'g>> = parents.iter().map(carried).collect();
        all.push(Screw { joint: index, motion: body.axis.unit_motion(zero) });
        screws.push(all);
    }
    screws
}

/// Motion of a link in the link's frame.
struct LinkMotion<'g> {
    /// Rotation from the body's axes to the axes of the link's frame.
    rotation: nalgebra::Matrix3<f64>,
    /// Origin of the link's frame in the body's frame.
    origin: Vector3<Scalar<'g>>,
    /// Acceleration of the link frame's origin, minus gravity.
    acceleration: Vector3<Scalar<'g>>,
    omega: Vector3<Scalar<'g>>,
    /// Angular acceleration ω̇ of the link.
    angular: Vector3<Scalar<'g>>,
    /// Matrix U = ω̇× + ω× ω× of the link. A point r accelerates by U r more than the origin.
    spread: Matrix3<'g>,
}

impl<'g> LinkMotion<'g> {
    fn new(mechanism: &Mechanism<Scalar<'g>>, link: usize, motion: &BodyMotion<'g>) -> Self {
        let pose = mechanism.links[link].1;
        let rotation = pose.rotation.transpose();
        let origin = pose.translation;
        let omega = rotate(&rotation, motion.omega);
        let angular = rotate(&rotation, motion.angular_acceleration());
        let acceleration = motion.acceleration + motion.spread.times(origin);
        Self {
            acceleration: rotate(&rotation, acceleration),
            spread: spread_of(omega, angular),
            rotation,
            origin,
            omega,
            angular,
        }
    }

    /// Transforms a motion of the body to the link's frame.
    fn motion(&self, motion: Motion<'g>) -> Motion<'g> {
        let at_origin = motion.linear + motion.angular.cross(self.origin);
        Motion { angular: rotate(&self.rotation, motion.angular), linear: rotate(&self.rotation, at_origin) }
    }

    /// Power that a unit of each inertial parameter requires while the link moves with the velocity `screw`.
    fn powers(&self, screw: Motion<'g>) -> [Scalar<'g>; PER_LINK] {
        let (a, u, turn) = (self.acceleration, &self.spread, screw.angular);
        let by_force = Vector3([0, 1, 2].map(|k| u.column(k).dot(screw.linear)));
        let first = by_force + a.cross(turn);
        let [xx, xy, yy, xz, yz, zz] = self.inertia_moments().map(|moment| moment.dot(turn));
        let mass = a.dot(screw.linear);
        [mass, first[0], first[1], first[2], xx, xy, yy, xz, yz, zz]
    }

    /// Moments that one unit of I_xx, I_xy, I_yy, I_xz, I_yz or I_zz of a link requires. Most components are
    /// entries of the matrix U = ω̇× + ω× ω×.
    fn inertia_moments(&self) -> [Vector3<Scalar<'g>>; 6] {
        let (u, w, e) = (&self.spread, self.omega, self.angular);
        let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
        [
            Vector3([e[0], xz, -xy]),
            Vector3([-u[2][0], u[2][1], u[0][0] - u[1][1]]),
            Vector3([-yz, e[1], xy]),
            Vector3([u[1][0], u[2][2] - u[0][0], -u[1][2]]),
            Vector3([u[1][1] - u[2][2], -u[0][1], u[0][2]]),
            Vector3([yz, -xz, e[2]]),
        ]
    }
}

/// Forces by coordinate that one unit of a rotor's axial inertia requires.
///
/// The rotor has the speed `a · ω + i ẏ` about its axis a, with the angular velocity ω of its carrier and the
/// gear ratio i. It requires the moment `a (a · ω̇ + i ÿ) + ω × a (a · ω + i ẏ)` on the carrier and the force
/// `i (a · ω̇ + i ÿ)` at its joint.
fn rotor_column<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    drive: &Drive,
    motions: &[BodyMotion<'g>],
    screws: &[Vec<Screw<'g>>],
    input: MotionInput<'_, 'g>,
) -> Vec<Scalar<'g>> {
    let mut column = vec![mechanism.graph.constant(0.0); mechanism.coordinates];
    let moved = lower_followed(mechanism.graph, &drive.acts_on);
    let ratio = lower(mechanism.graph, &drive.gear_ratio);
    let (mut spin, mut spin_rate) = (ratio * moved.motion(input.v), ratio * moved.motion(input.a));
    let (body, pose) = mechanism.links[drive.carrier];
    if let Some(carrier) = body.filter(|_| drive.coupling == RotorCoupling::Body) {
        let axis = Vector3(drive.axis.map(|x| mechanism.graph.constant(x)));
        let axis = rotate(&pose.rotation, axis);
        let omega = motions[carrier].omega;
        spin = spin + axis.dot(omega);
        spin_rate = spin_rate + axis.dot(motions[carrier].angular_acceleration());
        let moment = axis.scaled(spin_rate) + omega.cross(axis).scaled(spin);
        for screw in &screws[carrier] {
            let joint = &mechanism.bodies[screw.joint];
            let share = screw.motion.angular.dot(moment);
            joint.transmission.add_force(share, &mut column);
        }
    }
    moved.add_force(ratio * spin_rate, &mut column);
    column
}
