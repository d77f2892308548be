//! Names and units of the positions y.

use crate::model::{JointPosition, Model};

/// Names of the position entries: the joint names, with suffixes such as `base_qx` for joints with several
/// entries.
#[must_use]
pub fn names(model: &Model) -> Vec<String> {
    let joints: Vec<&str> = model.joints().map(|joint| joint.name.as_str()).collect();
    let names = model.joint_positions().flat_map(|joint| match joint {
        JointPosition::Coordinate(coordinate) => vec![joints[coordinate].to_owned()],
        JointPosition::Quaternion(joint) => {
            joint.kind.position_names().iter().map(|entry| format!("{}_{entry}", joint.name)).collect()
        }
    });
    names.collect()
}

/// Units of the position entries: `rad`, `m`, and `1` for quaternions.
#[must_use]
pub fn units(model: &Model) -> Vec<&'static str> {
    let joints: Vec<&str> = model.joints().map(|joint| joint.kind.unit()).collect();
    let units = model.joint_positions().flat_map(|joint| match joint {
        JointPosition::Coordinate(coordinate) => vec![joints[coordinate]],
        JointPosition::Quaternion(joint) => {
            let lengths = std::iter::repeat_n("m", joint.kind.quaternion());
            lengths.chain(std::iter::repeat_n("1", 4)).collect()
        }
    });
    units.collect()
}
