//! Setup of the loops: arrays over joints that straight-line code computes before the loops.

use super::builder::ArrayBuilder;
use super::rows::entries_of;
use super::tree::{LoopJoint, LoopJoints, Moved, is_on_diagonal};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::matrix::Matrix;
use crate::dynamics::recursion::frame_motion::{BasePoses, FramePose};
use crate::dynamics::recursion::rotor;
use crate::graph::{Scalar, differentiate};
use crate::kinematics::{JointAxis, Mechanism};
use crate::program::arrays::ArrayId;
use crate::spatial::{MassMoments, Motion, Vector3};

/// Arrays that the straight-line code before the loops computes for each joint.
pub(super) struct Setup {
    pub screws: ArrayId,
    pub axes: ArrayId,
    pub origins: ArrayId,
    pub moments: ArrayId,
    pub rates: ArrayId,
    pub gravity: ArrayId,
    /// Acceleration of the base that replaces gravity, at joints on the base; `None` for robots without
    /// quaternions.
    pub base_acceleration: Option<ArrayId>,
    /// Inertias i² J of rotors on the diagonal of the mass matrix, with the gear ratio i and the axial
    /// inertia J.
    pub rotors: ArrayId,
    /// Accelerations of all joints, or driving forces of the independent joints; see [`Last`].
    pub last: ArrayId,
    /// Springs and friction at a joint in three rows: derivatives of the force with respect to the joint's
    /// position and velocity, then the force.
    pub joint_forces: ArrayId,
    /// Derivatives of springs and friction by other coordinates; `None` if all of them are zero.
    pub coupled_forces: Option<CoupledForces>,
    /// Momenta i J a of rotors on the parent bodies of their joints, with gear ratio i, axial inertia J and
    /// axis a; `None` if there are no such rotors.
    pub momenta: Option<ArrayId>,
}

/// Derivatives of springs and friction by other coordinates, as matrices over coordinates.
pub(super) struct CoupledForces {
    pub by_coordinates: ArrayId,
    pub by_velocities: ArrayId,
}

/// Last argument of a function in array form: accelerations or driving forces.
pub(super) enum Last<'g> {
    /// Accelerations of the coordinates. A joint that follows a coordinate has the coordinate's acceleration
    /// here, because its motion per unit contains the ratio.
    Accelerations(Vec<Scalar<'g>>),
    /// Driving forces of the coordinates. They act only at the joints that are coordinates themselves.
    DrivingForces(Vec<Scalar<'g>>),
}

/// Computes the arrays of the straight-line code before the loops.
pub(super) fn set_up<'g>(
    builder: &mut ArrayBuilder,
    equations: &Equations<'_, 'g>,
    joints: &Joints<'_, 'g>,
    arguments: &Arguments<'g>,
    last: Last<'g>,
) -> Setup {
    let zero = equations.graph.constant(0.0);
    let Joints { mechanism, loops } = joints;
    let poses = BasePoses::new((*mechanism).clone(), &arguments.y);
    let mut rows = Rows { builder, loops, zero };
    let falling = (-mechanism.gravity).0.to_vec();
    let forces = JointForces::new(equations, arguments);
    let diagonal = rotor_inertia(joints);
    let momenta = rotor_momenta(joints, &poses);
    Setup {
        screws: rows.fill("screws", 6, |joint| joints.screw(&poses, joint).entries().to_vec()),
        axes: rows.fill("axes", 9, |joint| joints.pose(&poses, joint).axes.map(|axis| axis.0).concat()),
        origins: rows.fill("origins", 3, |joint| joints.pose(&poses, joint).origin.0.to_vec()),
        moments: rows.fill("moments", 10, |joint| entries_of(&joints.moments(joint))),
        rates: rows.fill("rates", 1, |joint| vec![arguments.v[loops.coordinate(joint)]]),
        gravity: rows.fill("gravity", 3, |joint| match loops.tree.parents[loops.places[joint]] {
            Some(_) => vec![zero; 3],
            None => falling.clone(),
        }),
        base_acceleration: mechanism.has_quaternions().then(|| {
            rows.fill("base_acceleration", 3, |joint| match joints.is_on_base(joint) {
                true => falling.clone(),
                false => vec![zero; 3],
            })
        }),
        rotors: rows.fill_own("rotor_inertia", 1, |coordinate| vec![diagonal[coordinate]]),
        last: match &last {
            Last::Accelerations(last) => {
                rows.fill("accelerations", 1, |joint| vec![last[loops.coordinate(joint)]])
            }
            Last::DrivingForces(last) => {
                rows.fill_own("driving_forces", 1, |coordinate| vec![last[coordinate]])
            }
        },
        joint_forces: rows.fill_own("joint_forces", 3, |coordinate| forces.own(coordinate).to_vec()),
        coupled_forces: rows.coupled_forces(&forces),
        momenta: momenta.map(|momenta| rows.fill("rotor_momenta", 3, |joint| momenta[joint].0.to_vec())),
    }
}

/// Fills arrays with values for each joint of the loops.
struct Rows<'a, 'g> {
    builder: &'a mut ArrayBuilder,
    loops: &'a LoopJoints<Scalar<'g>>,
    zero: Scalar<'g>,
}

impl<'g> Rows<'_, 'g> {
    /// Fills an array with the entries of each joint. Rows without an entry are 0.
    fn fill(&mut self, name: &str, count: usize, entries: impl Fn(usize) -> Vec<Scalar<'g>>) -> ArrayId {
        let mut rows = vec![vec![self.zero; self.loops.list.len()]; count];
        for (joint, &place) in self.loops.places.iter().enumerate() {
            for (row, entry) in rows.iter_mut().zip(entries(joint)) {
                row[place] = entry;
            }
        }
        self.builder.set_up(name, rows)
    }

    /// Fills an array with the entries of each coordinate at its independent joint. All other joints get 0.
    fn fill_own(&mut self, name: &str, count: usize, entries: impl Fn(usize) -> Vec<Scalar<'g>>) -> ArrayId {
        let loops = self.loops;
        self.fill(name, count, |joint| match loops.is_own(joint) {
            true => entries(loops.coordinate(joint)),
            false => vec![],
        })
    }

    fn coupled_forces(&mut self, forces: &JointForces<'_, 'g>) -> Option<CoupledForces> {
        let mut matrix = |name: &str, matrix: &Matrix<'g>| {
            self.fill_own(name, matrix.len(), |column| matrix.iter().map(|row| row[column]).collect())
        };
        forces.coupled().map(|[by_coordinates, by_velocities]| CoupledForces {
            by_coordinates: matrix("coupled_stiffness", &by_coordinates),
            by_velocities: matrix("coupled_damping", &by_velocities),
        })
    }
}

/// A mechanism together with its joints as the loops over joints use them.
pub(super) struct Joints<'a, 'g> {
    pub mechanism: &'a Mechanism<Scalar<'g>>,
    pub loops: &'a LoopJoints<Scalar<'g>>,
}

impl<'g> Joints<'_, 'g> {
    /// Whether a joint of the loops is on the base. For one velocity of a joint with a quaternion, the answer
    /// is that of the whole joint.
    fn is_on_base(&self, joint: usize) -> bool {
        let first = match self.loops.list[joint].moved {
            // Each body of a chain follows one coordinate, so the joints of the chain are adjacent in the
            // list.
            Moved::Body(index) => {
                self.mechanism.bodies[index].chain.map_or(joint, |chain| joint - (index - chain.first))
            }
            Moved::Rotor(_) => joint,
        };
        self.loops.tree.parents[self.loops.places[first]].is_none()
    }

    /// Pose of the body that a joint moves. For a rotor, it is the pose of the rotor's carrier.
    fn pose(&self, poses: &BasePoses<'g>, joint: usize) -> FramePose<'g> {
        match self.loops.list[joint].moved {
            Moved::Body(index) => *poses.body(index),
            Moved::Rotor(index) => match self.mechanism.rotors[index].carrier {
                Some(carrier) => *poses.body(carrier),
                None => FramePose::base(self.mechanism.graph.constant(1.0)),
            },
        }
    }

    /// Motion of the joint's body in the base frame for a unit of the coordinate's velocity.
    fn screw(&self, poses: &BasePoses<'g>, joint: usize) -> Motion<'g> {
        let LoopJoint { moved, follows, .. } = self.loops.list[joint];
        let pose = self.pose(poses, joint);
        match moved {
            Moved::Body(index) => {
                let axis = pose.axes[2].map(|x| x * follows.ratio);
                self.mechanism.bodies[index].axis.along(axis, pose.origin)
            }
            Moved::Rotor(index) => {
                let rotor = &self.mechanism.rotors[index];
                let axis = pose.direction(rotor.axis.scaled(rotor.ratio * follows.ratio));
                JointAxis::Revolute.along(axis, pose.origin)
            }
        }
    }

    /// Moments of mass of the body that a joint moves, without bodies beyond this body. If a rotor is a joint
    /// of the loops, its inertia is subtracted from its carrier.
    fn moments(&self, joint: usize) -> MassMoments<Scalar<'g>> {
        let LoopJoint { moved, is_last, .. } = self.loops.list[joint];
        let of_rotor = |index: usize| {
            let rotor = &self.mechanism.rotors[index];
            MassMoments::of_axial_inertia(rotor.inertia, rotor.axis)
        };
        let rotors = self.loops.list.iter().filter(|joint| joint.is_last);
        let rotors = rotors.filter_map(|joint| match joint.moved {
            Moved::Rotor(index) => Some(index),
            Moved::Body(_) => None,
        });
        match moved {
            _ if !is_last => MassMoments::zero(self.mechanism.graph),
            Moved::Rotor(index) => of_rotor(index),
            Moved::Body(body) => rotors
                .filter(|&index| self.mechanism.rotors[index].carrier == Some(body))
                .fold(self.mechanism.bodies[body].moments, |sum, index| sum - of_rotor(index)),
        }
    }
}

/// Forces of springs and friction by coordinate.
struct JointForces<'a, 'g> {
    equations: &'a Equations<'a, 'g>,
    arguments: &'a Arguments<'g>,
    forces: Vec<Scalar<'g>>,
}

impl<'a, 'g> JointForces<'a, 'g> {
    fn new(equations: &'a Equations<'a, 'g>, arguments: &'a Arguments<'g>) -> Self {
        let forces = equations.joint_forces(&arguments.y, &arguments.v);
        Self { equations, arguments, forces }
    }

    /// Derivatives of the force on coordinate `row` with respect to the position and velocity of coordinate `column`.
    fn by(&self, row: usize, column: usize) -> [Scalar<'g>; 2] {
        let force = self.forces[row];
        [
            self.equations.along(&[force], &self.arguments.y, column)[0],
            differentiate(self.equations.graph, &[force], self.arguments.v[column])[0],
        ]
    }

    /// Derivatives of the force on a coordinate with respect to the position and velocity of this coordinate,
    /// then the force.
    fn own(&self, coordinate: usize) -> [Scalar<'g>; 3] {
        let [by_position, by_velocity] = self.by(coordinate, coordinate);
        [by_position, by_velocity, self.forces[coordinate]]
    }

    /// Derivatives of spring and friction forces with respect to the positions and velocities of other
    /// coordinates; `None` if all of them are zero.
    fn coupled(&self) -> Option<[Matrix<'g>; 2]> {
        if self.equations.forces_are_local() {
            return None;
        }
        let (n, zero) = (self.forces.len(), self.equations.graph.constant(0.0));
        let mut matrices = [vec![vec![zero; n]; n], vec![vec![zero; n]; n]];
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            if row != column {
                let [by_position, by_velocity] = self.by(row, column);
                matrices[0][row][column] = by_position;
                matrices[1][row][column] = by_velocity;
            }
        }
        let mut entries = matrices.iter().flatten().flatten();
        entries.any(|entry| !entry.is_zero()).then_some(matrices)
    }
}

/// Inertias i² J of the rotors on the diagonal of the mass matrix, by coordinate. i is the gear ratio, J the
/// axial inertia.
fn rotor_inertia<'g>(joints: &Joints<'_, 'g>) -> Vec<Scalar<'g>> {
    let Joints { mechanism, loops } = joints;
    let n = mechanism.coordinates;
    let mut matrix = vec![vec![mechanism.graph.constant(0.0); n]; n];
    let rotors = mechanism.rotors.iter().zip(&loops.beside);
    let rotors = rotors.filter(|(rotor, beside)| beside.is_some() || is_on_diagonal(*rotor));
    rotor::add_inertia(rotors.map(|(rotor, _)| rotor), &mut matrix);
    (0..n).map(|coordinate| matrix[coordinate][coordinate]).collect()
}

/// Momenta `i J a` of rotors on the parent bodies of their joints, in the base frame and by joint. i is the
/// gear ratio, J the axial inertia and a the axis. `None` if there are no such rotors.
fn rotor_momenta<'g>(joints: &Joints<'_, 'g>, poses: &BasePoses<'g>) -> Option<Vec<Vector3<Scalar<'g>>>> {
    let Joints { mechanism, loops } = joints;
    let mut momenta = vec![Vector3::zero(mechanism.graph.constant(0.0)); loops.list.len()];
    let mut is_carried = false;
    for (rotor, beside) in mechanism.rotors.iter().zip(&loops.beside) {
        let (Some(carrier), Some(joint), Some(turned)) =
            (rotor.carrier, *beside, rotor.transmission.single())
        else {
            continue;
        };
        let momentum = rotor.coupling_inertia() * turned.ratio;
        let momentum = poses.body(carrier).direction(rotor.axis.scaled(momentum));
        momenta[joint] = momenta[joint] + momentum;
        is_carried = true;
    }
    is_carried.then_some(momenta)
}
