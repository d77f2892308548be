//! Proposes propellers as commented lines of `robot.toml`, for links that turn on a floating body or are
//! fixed to it.

use super::{legs, toml_text};
use gelenk_codegen::model::{Joint, JointKind, Model, Motion, Pose};

/// Proposes an input for each joint that may carry a propeller. The text is empty if there are no propellers
/// to propose.
///
/// - `joints`: joints that may carry a propeller, with their links
pub fn description(model: &Model, joints: &[(&Joint, usize)]) -> String {
    let carries = |link: usize| joints.iter().any(|(joint, _)| joint.parent == link);
    let ends = joints.iter().filter(|(_, link)| !carries(*link));
    let ends: Vec<_> = ends.filter_map(|(joint, link)| Some((joint, *link, upward(model, joint)?))).collect();
    if ends.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n# Where a joint carries a propeller it is held, and the propeller is an input at its link: of a unit of the input, force in N,\n\
         # then moment in N m, whose sign is against the propeller's turn. Here neighbours turn against each other: put in the signs of\n\
         # your robot. A robot whose propellers all turn the same way cannot hover.\n",
    );
    let places: Vec<[f64; 2]> = ends.iter().map(|(_, link, _)| place(model, *link)).collect();
    for ((joint, link, axis), sign) in ends.iter().zip(signs(&places)) {
        text.push_str(&format!(
            "\n# [[joints]]\n# name = {0}\n# held = 0\n# [[inputs]]\n# name = {1}\n# frame = {1}\n# wrench = [{2}]\n\
             # limits = [0, 8]\n",
            toml_text(&joint.name),
            toml_text(&model.links[*link].name),
            wrench(*axis, sign)
        ));
    }
    text
}

/// Proposes an input for each link with mass that is fixed to a floating body and carries nothing, or for the
/// body itself. Robots without moving joints have no other inputs.
pub fn of_fixed_links(model: &Model) -> String {
    let carries =
        |link: usize| model.links.iter().filter_map(|of| of.joint.as_ref()).any(|joint| joint.parent == link);
    let is_end = |link: &usize| !model.links[*link].bodies.is_empty() && !carries(*link);
    let Some(base) = legs::base(model) else { return String::new() };
    let ends: Vec<usize> = (0..model.links.len()).filter(|link| *link != base).filter(is_end).collect();
    let ends = if ends.is_empty() { vec![base] } else { ends };
    let mut text = String::from(
        "\n# No joint of this robot moves, and nothing drives it. A propeller or thruster is an input at its link.\n\
         # `wrench` is force (N), then moment (N m), per unit of the input. The moment is opposite to the propeller's rotation.\n\
         # Uncomment the links with propellers and set the numbers of your robot. Propellers that all turn in one direction\n\
         # cannot hold the robot in hover.\n",
    );
    let places: Vec<[f64; 2]> = ends.iter().map(|link| place(model, *link)).collect();
    for (link, sign) in ends.iter().zip(signs(&places)) {
        text.push_str(&format!(
            "\n# [[inputs]]\n# name = {0}\n# frame = {0}\n# wrench = [{1}]\n# limits = [0, 8]\n",
            toml_text(&model.links[*link].name),
            wrench(up(model, *link), sign)
        ));
    }
    text
}

/// Unit vector along the z axis of the root link in the axes of a link, with all joints at 0.
fn up(model: &Model, link: usize) -> [f64; 3] {
    // Rounding of an angle becomes 0.
    pose(model, link).rotation[2].map(|entry| if entry.abs() < 1e-9 { 0.0 } else { entry })
}

/// Smallest cosine of the angle between a propeller's axis and the vertical. Some propellers are slightly
/// tilted.
const UPRIGHT: f64 = 0.9;

/// Drag moment per thrust of a small propeller [m].
const DRAG: f64 = 0.016;

/// Thrust along the axis, then drag about the axis, for an input of 1, as text.
fn wrench(axis: [f64; 3], sign: f64) -> String {
    // A sum with 0 has no negative zero.
    let entries =
        axis.into_iter().chain(axis.map(|a| sign * DRAG * a)).map(|entry| (entry + 0.0).to_string());
    entries.collect::<Vec<_>>().join(", ")
}

/// Unit vector of the upward direction along the axis of a joint, in the joint's frame. `None` unless the
/// joint turns on the floating body about an axis nearly parallel to the body's z axis.
fn upward(model: &Model, joint: &Joint) -> Option<[f64; 3]> {
    if !matches!(joint.kind, JointKind::Revolute | JointKind::Continuous) {
        return None;
    }
    let base = legs::base(model);
    let (mut pose, mut at) = (joint.origin.clone(), joint.parent);
    while Some(at) != base {
        match &model.links[at].joint {
            Some(fixed) if fixed.motion == Motion::Fixed => {
                pose = fixed.origin.then(&pose);
                at = fixed.parent;
            }
            _ => return None,
        }
    }
    let along: f64 = pose.rotation[2].iter().zip(joint.axis).map(|(r, axis)| r * axis).sum();
    (along.abs() >= UPRIGHT).then(|| joint.axis.map(|entry| entry * along.signum()))
}

/// Coordinates x and y of a link in the frame of the root link [m], with all joints at 0. A coordinate that
/// depends on free parameters counts as 0.
fn place(model: &Model, link: usize) -> [f64; 2] {
    let pose = pose(model, link);
    [0, 1].map(|axis| pose.translation[axis].as_number().unwrap_or(0.0))
}

/// Pose of a link in the frame of the root link, with all joints at 0.
fn pose(model: &Model, link: usize) -> Pose {
    let (mut pose, mut at) = (Pose::identity(), link);
    while let Some(joint) = &model.links[at].joint {
        pose = joint.origin.then(&pose);
        at = joint.parent;
    }
    pose
}

/// Signs that alternate from place to place around the mean of all places.
fn signs(places: &[[f64; 2]]) -> Vec<f64> {
    let middle = [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64);
    let angle = |place: &[f64; 2]| (place[1] - middle[1]).atan2(place[0] - middle[0]);
    let mut around: Vec<usize> = (0..places.len()).collect();
    around.sort_by(|&a, &b| angle(&places[a]).total_cmp(&angle(&places[b])));
    let mut signs = vec![1.0; places.len()];
    around.iter().skip(1).step_by(2).for_each(|&place| signs[place] = -1.0);
    signs
}

#[cfg(test)]
mod tests {
    use super::*;
    use gelenk_codegen::diagnostic::Diagnostic;
    use gelenk_codegen::read::{ReadOptions, from_toml};

    /// Thrust is up whatever the frame of a propeller is, and whichever way its axis is counted.
    #[test]
    fn thrust_is_up_in_the_frames_of_propellers() {
        let propeller = |name: &str, rpy: &str, axis: &str| {
            format!(
                "[[joints]]\nname = \"{name}\"\nparent = \"body\"\norigin = {{ xyz = [0.1, 0.1, 0], rpy = {rpy} }}\naxis = {axis}\n\
                 [[bodies]]\nlink = \"{name}\"\nmass = 0.01\ninertia = 1e-5\n"
            )
        };
        let text = [
            "base = { link = \"body\", type = \"floating\" }\n[[bodies]]\nlink = \"body\"\nmass = 1\ninertia = 0.01\n".to_owned(),
            propeller("plain", "[0, 0, 0]", "[0, 0, 1]"),
            propeller("reversed", "[0, 0, 0]", "[0, 0, -1]"),
            // y is up: R_x(90°) e_y = e_z; and the same upside down.
            propeller("turned", "[\"pi/2\", 0, 0]", "[0, 1, 0]"),
            propeller("inverted", "[\"pi\", 0, 0]", "[0, 0, 1]"),
            // An arm's elbow.
            propeller("elbow", "[0, 0, 0]", "[0, 1, 0]"),
        ];
        let load = &mut |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
        let read = from_toml(&text.concat(), "drone.toml", &ReadOptions::default(), load);
        let (model, _) = read.unwrap_or_else(|wrong| panic!("{wrong}"));
        let joints = model.links.iter().enumerate().filter_map(|(at, link)| Some((link.joint.as_ref()?, at)));
        let joints: Vec<_> = joints.filter(|(joint, _)| joint.axis != [0.0; 3]).collect();
        let found = |name: &str| {
            let own: Vec<_> = joints.iter().filter(|(joint, _)| joint.name == name).copied().collect();
            let text = description(&model, &own);
            text.lines().find(|line| line.contains("wrench = ")).map(str::to_owned)
        };
        let wrench = |entries: &str| Some(format!("# wrench = [{entries}]"));
        assert_eq!(found("plain"), wrench("0, 0, 1, 0, 0, 0.016"));
        assert_eq!(found("reversed"), wrench("0, 0, 1, 0, 0, 0.016"));
        assert_eq!(found("turned"), wrench("0, 1, 0, 0, 0.016, 0"));
        assert_eq!(found("inverted"), wrench("0, 0, -1, 0, 0, -0.016"));
        assert_eq!(found("elbow"), None);
    }

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
