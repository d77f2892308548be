//! A base that moves freely: a floating joint between the world and the link that was the base.

use super::composite::{self, Composite, Place};
use super::description::{JointDescription, RobotDescription};
use crate::diagnostic::{At, Report, Span};
use std::collections::BTreeSet;

/// Name of the floating joint, which the names of its velocities begin with; the second where the first is taken.
const JOINT: [&str; 2] = ["base", "floating_base"];

/// The link before it.
const WORLD: [&str; 2] = ["world", "inertial_frame"];

/// Links with these names stand for the ground: what is fixed to them is bolted down.
const GROUND: [&str; 4] = ["world", "map", "odom", "ground"];

/// Frees the base where the description asks for it.
pub(super) fn free(robot: &mut RobotDescription, report: &mut Report) {
    let Some(span) = robot.floating_base.filter(|_| !robot.is_freed) else { return };
    // Without a single root the links are no tree, which is reported elsewhere.
    let Some(root) = root(robot) else { return };
    robot.is_freed = true;
    if GROUND.contains(&root.as_str()) {
        return report_bolted(robot, &root, span, report);
    }
    let world = unused(WORLD, |name| links(robot).any(|link| link == name));
    let joint = unused(JOINT, |name| robot.joints.iter().any(|joint| joint.name.value == name));
    let place = Place {
        parent: Some(At::new(world, span)),
        child: Some(At::new(root.clone(), span)),
        origin: None,
        axis: [0.0, 0.0, 1.0],
    };
    let name = At::new(joint, span);
    let joints =
        composite::expand(Composite::FLOATING, &name, place, |_, name| JointDescription::named(name));
    if !robot.links.is_empty() {
        let between = joints.iter().filter_map(|joint| joint.parent.clone());
        robot.links.extend(between);
    }
    if robot.base.as_ref().is_some_and(|base| base.value == root) {
        robot.base = None;
    }
    let described = std::mem::take(&mut robot.joints);
    robot.joints = joints.into_iter().chain(described).collect();
}

/// The first name that is not taken. Where both are, the last one is reported as a duplicate.
fn unused([first, second]: [&str; 2], is_taken: impl Fn(&str) -> bool) -> String {
    if is_taken(first) { second } else { first }.to_owned()
}

/// Names of all links, some of them several times.
fn links(robot: &RobotDescription) -> impl Iterator<Item = &str> {
    let ends = robot.joints.iter().flat_map(|joint| [&joint.parent, &joint.child]).flatten();
    let bodies = robot.bodies.iter().map(|body| &body.link);
    robot.links.iter().chain(&robot.base).chain(ends).chain(bodies).map(|name| name.value.as_str())
}

/// The only link that no joint carries.
fn root(robot: &RobotDescription) -> Option<String> {
    let children = robot.joints.iter().filter_map(|joint| joint.child.as_ref());
    let children: BTreeSet<&str> = children.map(|name| name.value.as_str()).collect();
    let roots: BTreeSet<&str> = links(robot).filter(|name| !children.contains(name)).collect();
    let mut roots = roots.into_iter();
    let (root, None) = (roots.next()?, roots.next()) else { return None };
    Some(root.to_owned())
}

fn report_bolted(robot: &RobotDescription, root: &str, span: Span, report: &mut Report) {
    let held = robot.joints.iter().find(|joint| joint.parent.as_ref().is_some_and(|link| link.value == root));
    let by = held.map_or(String::new(), |joint| format!(" by joint `{}`", joint.name.value));
    let message = format!("the base is to float, and the robot is bolted to `{root}`{by}");
    report.error(span, "bolted-base", message);
    report.help(match held.and_then(|joint| joint.child.as_ref()) {
        Some(child) => format!(
            "remove that joint and the link `{root}`, then `{}` is the link that floats; or leave the base fixed",
            child.value
        ),
        None => format!("give the link another name than `{root}`, or leave the base fixed"),
    });
}

#[cfg(test)]
mod tests {
    use super::super::{Model, QuaternionKind, ReadOptions, from_toml};
    use crate::diagnostic::Diagnostics;

    const URDF: &str = r#"<robot name="drone"><link name="frame"><inertial><mass value="2"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;

    const TOML: &str = "base = { link = \"frame\", type = \"floating\" }\n[[bodies]]\nlink = \"frame\"\nmass = 2\ninertia = 1\n";

    fn read(text: &str, options: &ReadOptions) -> Result<Model, Diagnostics> {
        let text_of = |name: &str| if name.ends_with(".toml") { TOML } else { URDF };
        let mut load = |name: &str| Ok((name.to_owned(), text_of(name).to_owned()));
        from_toml(text, "robot.toml", options, &mut load).map(|(model, _)| model)
    }

    #[test]
    fn a_description_on_top_of_a_urdf_speaks_of_its_freed_base() {
        const DRIVEN: &str = "[[joints]]\nname = \"base_z\"\ndrive = \"ideal\"\n";
        let asked = ReadOptions { floating_base: true, ..ReadOptions::default() };
        for (top, options) in [
            ("urdf = \"drone.urdf\"\nbase = { type = \"floating\" }\n", ReadOptions::default()),
            ("urdf = \"drone.urdf\"\nbase = { link = \"frame\", type = \"floating\" }\n", asked),
            ("urdf = \"drone.urdf\"\n", asked),
            ("extends = \"drone.toml\"\n", ReadOptions::default()),
        ] {
            let model = read(&format!("{top}{DRIVEN}"), &options).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(model.quaternion_joints[0].kind, QuaternionKind::Floating);
            assert_eq!((model.coordinates.len(), model.position_count()), (6, 7));
            let drives: Vec<&str> = model.drives.iter().map(|drive| drive.name.as_str()).collect();
            assert_eq!(drives, ["base_z"]);
        }
    }

    /// The names of the floating joint and of the link before it give way to those of the description.
    #[test]
    fn a_robot_with_a_base_joint_and_a_world_can_float() {
        let text = "base = { link = \"frame\", type = \"floating\" }
            joints = [{ name = \"base\", parent = \"frame\", child = \"world\", drive = \"ideal\" }]
            bodies = [{ link = \"frame\", mass = 2, inertia = 1 }, { link = \"world\", mass = 1, inertia = 1 }]";
        let model = read(text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(model.quaternion_joints[0].name, "floating_base");
        assert_eq!(model.drives[0].name, "base");
    }

    #[test]
    fn a_base_that_is_another_link_than_the_root_is_an_error() {
        let text = "urdf = \"drone.urdf\"\nbase = { link = \"other\", type = \"floating\" }\n";
        let problems = read(text, &ReadOptions::default()).map(|_| ()).unwrap_err().to_string();
        assert!(problems.contains("other"), "{problems}");
    }
}
