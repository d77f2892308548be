//! How links that turn on a body that floats become propellers: lines of `robot.toml` as comments.

use super::new_feet;
use crate::model::{Joint, JointKind, Model, Motion, Pose};
use crate::numeric::atan2;
use crate::wording::toml_text;

/// One block for each joint that may carry a propeller; empty where none does.
///
/// - `joints`: those that may carry a propeller, with their links
pub(super) fn description(model: &Model, joints: &[(&Joint, usize)]) -> String {
    let carries = |link: usize| joints.iter().any(|(joint, _)| joint.parent == link);
    let ends: Vec<_> =
        joints.iter().filter(|(joint, link)| !carries(*link) && is_on_top(model, joint)).collect();
    if ends.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n# Where a joint carries a propeller it is held, and the propeller is an input at its link: of a unit of the input, force in N,\n\
         # then moment in N m, whose sign is against the propeller's turn. Here neighbours turn against each other: put in the signs of\n\
         # your robot. A robot whose propellers all turn the same way cannot hover.\n",
    );
    let places: Vec<[f64; 2]> = ends.iter().map(|(_, link)| place(model, *link)).collect();
    for ((joint, link), sign) in ends.iter().zip(signs(&places)) {
        text.push_str(&format!(
            "\n# [[joints]]\n# name = {0}\n# held = 0\n# [[inputs]]\n# name = {1}\n# frame = {1}\n# wrench = [0, 0, 1, 0, 0, {sign}0.016]\n\
             # limits = [0, 8]\n",
            toml_text(&joint.name),
            toml_text(&model.links[*link].name)
        ));
    }
    text
}

/// The least cosine of a propeller's tilt: some are tilted a little.
const UPRIGHT: f64 = 0.9;

/// Whether a joint turns on the floating body about the axis z of this. Elbows, wheels and fingers do not.
fn is_on_top(model: &Model, joint: &Joint) -> bool {
    let turns = matches!(joint.kind, JointKind::Revolute | JointKind::Continuous);
    let base = new_feet::base(model);
    let (mut pose, mut at) = (joint.origin.clone(), joint.parent);
    while Some(at) != base {
        match &model.links[at].joint {
            Some(fixed) if fixed.motion == Motion::Fixed => {
                pose = fixed.origin.then(&pose);
                at = fixed.parent;
            }
            _ => return false,
        }
    }
    let along: f64 = pose.rotation[2].iter().zip(joint.axis).map(|(r, axis)| r * axis).sum();
    turns && along.abs() >= UPRIGHT
}

/// Where a link is beside the axis z of the root, with all joints at 0; what is no number counts as 0.
fn place(model: &Model, link: usize) -> [f64; 2] {
    let (mut pose, mut at) = (Pose::identity(), link);
    while let Some(joint) = &model.links[at].joint {
        pose = joint.origin.then(&pose);
        at = joint.parent;
    }
    [0, 1].map(|axis| pose.translation[axis].as_number().unwrap_or(0.0))
}

/// Signs that alternate around the middle of all places.
fn signs(places: &[[f64; 2]]) -> Vec<&'static str> {
    let middle = [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64);
    let angle = |place: &[f64; 2]| atan2(place[1] - middle[1], place[0] - middle[0]);
    let mut around: Vec<usize> = (0..places.len()).collect();
    around.sort_by(|&a, &b| angle(&places[a]).total_cmp(&angle(&places[b])));
    let mut signs = vec![""; places.len()];
    around.iter().skip(1).step_by(2).for_each(|&place| signs[place] = "-");
    signs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_turn_against_each_other() {
        // PX4's quadrotor x: 1 and 2 on one diagonal turn one way, 3 and 4 the other.
        let quadrotor = signs(&[[1.13, -0.22], [0.87, 0.2], [1.13, 0.22], [0.87, -0.2]]);
        assert!(quadrotor[0] == quadrotor[1] && quadrotor[2] == quadrotor[3], "{quadrotor:?}");
        assert_ne!(quadrotor[0], quadrotor[2]);
        let coaxial = signs(&[[1.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [-1.0, 0.0]]);
        assert!(coaxial[0] != coaxial[1] && coaxial[2] != coaxial[3], "{coaxial:?}");
        assert!(signs(&[]).is_empty());
    }
}
