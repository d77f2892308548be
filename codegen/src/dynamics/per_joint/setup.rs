//! What the loops start from: straight-line code, joint by joint.

use super::builder::ArrayBuilder;
use super::rows::entries_of;
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::recursion::frame_motion::BasePoses;
use crate::dynamics::recursion::rotor;
use crate::graph::{Scalar, differentiate};
use crate::kinematics::Mechanism;
use crate::program::arrays::ArrayId;
use crate::spatial::Vector3;

/// Arrays that the setup computes joint by joint.
pub(super) struct Setup {
    pub screws: ArrayId,
    pub axes: ArrayId,
    pub origins: ArrayId,
    pub moments: ArrayId,
    pub rates: ArrayId,
    pub gravity: ArrayId,
    /// i² J of rotors.
    pub rotors: ArrayId,
    /// Accelerations, or what drives them.
    pub last: ArrayId,
    /// Springs and friction: by y, by ẏ, and their force.
    pub joint_forces: ArrayId,
    /// i J a of the rotors on the parent of each joint that they drive; `None` without such rotors.
    pub momenta: Option<ArrayId>,
}

/// Straight-line code: poses, and what depends on single joints.
pub(super) fn set_up<'g>(
    builder: &mut ArrayBuilder,
    equations: &Equations<'_, 'g>,
    mechanism: &Mechanism<Scalar<'g>>,
    arguments: &Arguments<'g>,
    (last_name, last): (&'static str, Vec<Scalar<'g>>),
) -> Setup {
    let graph = equations.graph;
    let (n, zero) = (mechanism.coordinates, graph.constant(0.0));
    let poses = BasePoses::new(mechanism.clone(), &arguments.y);
    let mut rows = |name: &str, count: usize, fill: &dyn Fn(usize) -> Vec<Scalar<'g>>| {
        let mut rows = vec![vec![zero; n]; count];
        for (index, body) in mechanism.bodies.iter().enumerate() {
            for (row, entry) in rows.iter_mut().zip(fill(index)) {
                row[body.joint] = entry;
            }
        }
        builder.set_up(name, rows)
    };
    let joint = equations.joint_forces(&arguments.y, &arguments.v);
    let by = |force: Scalar<'g>, variable: Scalar<'g>| differentiate(graph, &[force], variable)[0];
    let mut rotors = vec![vec![zero; n]; n];
    rotor::add_inertia(mechanism, &mut rotors);
    let momenta = rotor_momenta(mechanism, &poses);
    let coordinate = |index: usize| mechanism.bodies[index].joint;
    Setup {
        screws: rows("screws", 6, &|index| {
            let (body, pose) = (&mechanism.bodies[index], poses.body(index));
            let axis = pose.axes[2].map(|x| x * body.transmission.own().ratio);
            body.axis.along(axis, pose.origin).entries().to_vec()
        }),
        axes: rows("axes", 9, &|index| poses.body(index).axes.map(|axis| axis.0).concat()),
        origins: rows("origins", 3, &|index| poses.body(index).origin.0.to_vec()),
        moments: rows("moments", 10, &|index| entries_of(&mechanism.bodies[index].moments)),
        rates: rows("rates", 1, &|index| vec![arguments.v[coordinate(index)]]),
        gravity: rows("gravity", 3, &|index| match mechanism.bodies[index].parent {
            Some(_) => vec![zero; 3],
            None => (-mechanism.gravity).0.to_vec(),
        }),
        rotors: rows("rotor_inertia", 1, &|index| {
            let coordinate = coordinate(index);
            vec![rotors[coordinate][coordinate]]
        }),
        last: rows(last_name, 1, &|index| vec![last[coordinate(index)]]),
        joint_forces: rows("joint_forces", 3, &|index| {
            let coordinate = coordinate(index);
            let force = joint[coordinate];
            vec![by(force, arguments.y[coordinate]), by(force, arguments.v[coordinate]), force]
        }),
        momenta: momenta.map(|momenta| rows("rotor_momenta", 3, &|index| momenta[index].0.to_vec())),
    }
}

/// `i J a` in the base frame of the rotors that drive each joint from its parent; `None` where there are
/// none.
fn rotor_momenta<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    poses: &BasePoses<'g>,
) -> Option<Vec<Vector3<Scalar<'g>>>> {
    let mut momenta = vec![Vector3::zero(mechanism.graph.constant(0.0)); mechanism.bodies.len()];
    let mut is_carried = false;
    for rotor in &mechanism.rotors {
        let (Some(carrier), Some(driven)) = (rotor.carrier, rotor.driven) else {
            continue;
        };
        let momentum = poses.body(carrier).direction(rotor.axis.scaled(rotor.coupling_inertia()));
        momenta[driven] = momenta[driven] + momentum;
        is_carried = true;
    }
    is_carried.then_some(momenta)
}
