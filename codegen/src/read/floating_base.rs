//! Floating base: adds a floating joint between the world and the base link.

use super::composite::{self, Composite, Place};
use super::toml::joint_tables::Extended;
use crate::description::{JointDescription, Name, RobotDescription};
use crate::diagnostic::{At, Report, Span};
use crate::model::QuaternionKind;
use std::collections::BTreeSet;

/// Names of the floating joint, with which the names of its velocities begin. The second name is used if the
/// first name is in use.
const JOINT: [&str; 2] = ["base", "floating_base"];

/// Names of the link to which the floating joint connects the base. The second name is used if the first name
/// is in use.
const WORLD: [&str; 2] = ["world", "inertial_frame"];

/// Links with these names, in large or small letters, are the ground. Links that are fixed to the ground do
/// not move.
const GROUND: [&str; 5] = ["world", "world_link", "map", "odom", "ground"];

/// Adds a floating joint under the base link if the description or an option makes the base floating.
pub(super) fn free(robot: &mut RobotDescription, report: &mut Report) {
    let Some(span) = robot.floating_base.filter(|_| !robot.is_freed) else { return };
    // Without a single root the links are no tree, which is reported elsewhere.
    let Some(root) = root(robot) else { return };
    robot.is_freed = true;
    let mut told = std::mem::take(&mut robot.velocities);
    match is_ground(robot, &root) {
        true => stand_on_ground(robot, &root, span, report),
        false => put_joint(robot, &root, span, &mut told),
    }
    let is_clean = !report.has_errors();
    for velocity in told.iter().filter(|_| is_clean) {
        let message = format!("the floating base has no velocity `{}`", velocity.name.value);
        report.error(velocity.name.span, "unknown-joint", message);
        report.help(
            "names of the base's velocities begin with the name of its floating joint. A new joint needs `parent`",
        );
    }
}

/// Puts a floating joint under the base link.
///
/// - `told`: described velocities; the velocities of the joint are removed from this list
fn put_joint(robot: &mut RobotDescription, root: &str, span: Span, told: &mut Vec<JointDescription>) {
    let world = unused(WORLD, |name| links(robot).any(|link| link == name));
    let place = Place {
        parent: Some(At::new(world, span)),
        child: Some(At::new(root.to_owned(), span)),
        origin: None,
        axis: [0.0, 0.0, 1.0],
    };
    let name = At::new(base_joint(robot), span);
    let values = |_: &'static composite::Part, name: Name| {
        let index = told.iter().position(|velocity| velocity.name.value == name.value);
        index.map_or_else(|| JointDescription::named(name), |index| told.remove(index))
    };
    let joints = composite::expand(Composite::FLOATING, &name, place, values);
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

/// Name of the floating joint that makes the base floating.
fn base_joint(robot: &RobotDescription) -> String {
    unused(JOINT, |name| robot.joints.iter().any(|joint| joint.name.value == name))
}

/// Names in a description to which an extending description can refer.
///
/// - `asked`: whether an option makes the base floating
pub(super) fn extended(robot: &RobotDescription, asked: bool) -> Extended {
    let parts = robot.joints.iter().filter_map(|joint| joint.part_of.as_ref());
    let firsts = parts.filter(|part| part.index == 0);
    Extended {
        quaternions: firsts
            .map(|part| (part.joint.value.clone(), Composite::Quaternion(part.kind)))
            .collect(),
        base_joint: base_joint(robot),
        is_to_float: asked || robot.floating_base.is_some(),
    }
}

/// Whether a link is the ground, to which the robot is bolted.
fn is_ground(robot: &RobotDescription, link: &str) -> bool {
    GROUND.iter().any(|ground| ground.eq_ignore_ascii_case(link))
        || (carried(robot, link).any(floats) && !has_body(robot, link))
}

fn has_body(robot: &RobotDescription, link: &str) -> bool {
    robot.bodies.iter().any(|body| body.link.value == link)
}

/// The joints whose parent is this link.
fn carried<'d>(robot: &'d RobotDescription, link: &str) -> impl Iterator<Item = &'d JointDescription> {
    robot.joints.iter().filter(move |joint| joint.parent.as_ref().is_some_and(|parent| parent.value == link))
}

/// Whether a joint is one of the velocities of a floating joint.
fn floats(joint: &JointDescription) -> bool {
    joint.part_of.as_ref().is_some_and(|part| part.kind == QuaternionKind::Floating)
}

/// Handles a base link that is the ground. If the robot already floats on the ground, making the base
/// floating has no effect. Otherwise an error is reported.
fn stand_on_ground(robot: &mut RobotDescription, ground: &str, span: Span, report: &mut Report) {
    let floating = carried(robot, ground).find(|joint| floats(joint));
    let Some(joint) = floating.and_then(|joint| joint.part_of.as_ref()).map(|part| part.joint.clone()) else {
        return report_bolted(robot, ground, span, report);
    };
    let message = format!("the base already floats by joint `{}`, so this option has no effect", joint.value);
    report.note(Some(span), "floats-already", message);
    let floating: Vec<&JointDescription> =
        robot.joints.iter().filter(|part| floats(part) && is_part_of(part, &joint.value)).collect();
    let ends = floating.iter().filter_map(|part| part.child.as_ref());
    // The link that floats is the base that was meant.
    if robot.base.as_ref().is_some_and(|base| ends.into_iter().any(|link| link.value == base.value)) {
        robot.base = None;
    }
}

fn is_part_of(part: &JointDescription, joint: &str) -> bool {
    part.part_of.as_ref().is_some_and(|part| part.joint.value == joint)
}

/// Returns the first name if it is not in use, otherwise the second name. If both are in use, the second name is
/// reported as a duplicate later.
fn unused([first, second]: [&str; 2], is_taken: impl Fn(&str) -> bool) -> String {
    if is_taken(first) { second } else { first }.to_owned()
}

/// Names of all links that joints and bodies mention. Some names occur several times.
fn links(robot: &RobotDescription) -> impl Iterator<Item = &str> {
    let ends = robot.joints.iter().flat_map(|joint| [&joint.parent, &joint.child]).flatten();
    let bodies = robot.bodies.iter().map(|body| &body.link);
    robot.links.iter().chain(&robot.base).chain(ends).chain(bodies).map(|name| name.value.as_str())
}

/// The only link that no joint carries; `None` if there are several such links or none.
fn root(robot: &RobotDescription) -> Option<String> {
    let children = robot.joints.iter().filter_map(|joint| joint.child.as_ref());
    let children: BTreeSet<&str> = children.map(|name| name.value.as_str()).collect();
    let roots: BTreeSet<&str> = links(robot).filter(|name| !children.contains(name)).collect();
    let mut roots = roots.into_iter();
    let (root, None) = (roots.next()?, roots.next()) else { return None };
    Some(root.to_owned())
}

fn report_bolted(robot: &RobotDescription, ground: &str, span: Span, report: &mut Report) {
    let Some(joint) = carried(robot, ground).next() else {
        let message = format!("the base cannot float: the robot is fixed to `{ground}`");
        report.error(span, "bolted-base", message);
        report.help(format!("rename the link `{ground}`, or leave the base fixed"));
        return;
    };
    let name = joint.part_of.as_ref().map_or(&joint.name, |part| &part.joint).quoted();
    let link = joint.child.as_ref().map_or_else(String::new, Name::quoted);
    if joint.moves() {
        let message = format!("the base cannot float: joint {name} connects the robot to `{ground}`");
        report.error(span, "bolted-base", message);
        report.help(match robot.is_mjcf {
            true => format!("leave the base fixed, or replace joint {name} of the body by <freejoint/>"),
            false => format!("leave the base fixed, or give joint {name} the type `floating`"),
        });
        return;
    }
    let by = if robot.is_mjcf { String::new() } else { format!(" by joint {name}") };
    report.error(span, "bolted-base", format!("the base cannot float: the robot is fixed to `{ground}`{by}"));
    report.help(match robot.is_mjcf {
        true => format!("add <freejoint/> to body {link}, or leave the base fixed"),
        false => format!(
            "remove this joint and the link `{ground}`, so that {link} is the base. Or leave the base fixed"
        ),
    });
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::Diagnostics;
    use crate::model::{Model, QuaternionKind};
    use crate::read::options::ReadOptions;
    use crate::read::{from_mjcf, from_toml, from_urdf};

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
            ("urdf = \"drone.urdf\"\nbase = { link = \"frame\", type = \"floating\" }\n", asked.clone()),
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

    /// Reads a robot whose base is to float by the switch: its model, or its problems, and its notes.
    fn freed(text: &str) -> (Option<Model>, String) {
        let asked = ReadOptions { floating_base: true, ..ReadOptions::default() };
        let mut load = |_: &str| unreachable!();
        let read = match text.starts_with("<mujoco") {
            true => from_mjcf(text, "robot.xml", &asked, &mut load),
            false => from_urdf(text, "robot.urdf", &asked),
        };
        match read {
            Ok((model, notes)) => (Some(model), notes.to_string()),
            Err(problems) => (None, problems.to_string()),
        }
    }

    /// A URDF with a joint between two links of which the second has a body.
    fn on_ground(ground: &str, kind: &str) -> String {
        let joint =
            format!("<joint name=\"J\" type=\"{kind}\"><parent link=\"{ground}\"/><child link=\"frame\"/>");
        let end = "<limit effort=\"1\" velocity=\"1\" lower=\"-1\" upper=\"1\"/></joint></robot>";
        URDF.replace("</robot>", &format!("<link name=\"{ground}\"/>{joint}{end}"))
    }

    fn mjcf(joint: &str) -> String {
        format!(
            "<mujoco><worldbody><body name=\"trunk\">{joint}<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>
            </body></worldbody></mujoco>"
        )
    }

    #[test]
    fn a_robot_that_floats_already_is_taken_as_it_is() {
        let both = "base = { link = \"frame\", type = \"floating\" }
            joints = [{ name = \"J\", parent = \"world\", child = \"frame\", type = \"floating\" }]
            bodies = [{ link = \"frame\", mass = 2, inertia = 1 }]";
        let (model, notes) = from_toml(both, "robot.toml", &ReadOptions::default(), &mut |_| unreachable!())
            .unwrap_or_else(|e| panic!("{e}"));
        for (model, notes) in [
            (Some(model), notes.to_string()),
            freed(&on_ground("world", "floating")),
            freed(&on_ground("start", "floating")),
            freed(&mjcf("<freejoint name=\"J\"/>")),
        ] {
            let model = model.unwrap_or_else(|| panic!("{notes}"));
            assert_eq!(model.quaternion_joints.len(), 1);
            assert_eq!((&*model.quaternion_joints[0].name, model.position_count()), ("J", 7));
            assert!(notes.contains("already floats by joint `J`"), "{notes}");
        }
    }

    #[test]
    fn what_stands_on_the_ground_is_told_with_what_frees_it() {
        for (text, told) in [
            (on_ground("world", "fixed"), ["fixed to `world` by joint `J`", "so that `frame` is the base"]),
            (
                on_ground("world", "prismatic"),
                ["joint `J` connects the robot to `world`", "give joint `J` the type `floating`"],
            ),
            (on_ground("World", "fixed"), ["fixed to `World` by joint `J`", "so that `frame` is the base"]),
            (
                on_ground("world_link", "fixed"),
                ["fixed to `world_link` by joint `J`", "so that `frame` is the base"],
            ),
            (
                on_ground("world", "spherical"),
                ["joint `J` connects the robot to `world`", "leave the base fixed"],
            ),
            (mjcf(""), ["fixed to `world`\n", "add <freejoint/> to body `trunk`"]),
            (
                mjcf("<joint name=\"J\"/>"),
                ["joint `J` connects the robot to `world`", "replace joint `J` of the body by <freejoint/>"],
            ),
        ] {
            let (model, problems) = freed(&text);
            assert!(model.is_none(), "{text}");
            for words in told {
                assert!(problems.contains(words), "{words}: {problems}");
            }
            assert_eq!(problems.matches("error[").count(), 1, "{problems}");
        }
    }

    /// Each way to describe drives and forces of a base that its own file frees.
    #[test]
    fn a_file_speaks_of_the_velocities_of_the_base_that_it_frees() {
        for (joints, drives) in [
            (
                "[[joints]]\nname = \"base_z\"\ndrive = \"ideal\"\nlimits = { effort = 7 }\nfriction = \"2*v\"\n",
                1,
            ),
            (
                "[[joints]]\nname = \"base\"\ndrive = { z = \"ideal\" }\nlimits = { z = { effort = 7 } }\nfriction = { z = \"2*v\" }\n",
                1,
            ),
            (
                "[[joints]]\nname = \"base\"\ndrive = \"ideal\"\nlimits = { z = { effort = 7 } }\nfriction = { z = \"2*v\" }\n",
                6,
            ),
        ] {
            for top in [
                "extends = \"drone.toml\"\n",
                "urdf = \"drone.urdf\"\nbase = { type = \"floating\" }\n",
                TOML,
            ] {
                let text = if top == TOML { format!("{TOML}{joints}") } else { format!("{top}{joints}") };
                let model = read(&text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{text}: {e}"));
                assert_eq!((model.coordinates.len(), model.quaternion_joints.len()), (6, 1), "{text}");
                assert_eq!(model.quaternion_joints[0].name, "base");
                assert_eq!(model.drives.len(), drives, "{text}");
                assert!(model.drives.iter().any(|drive| drive.name == "base_z"));
                let moving: Vec<_> = model.links.iter().filter_map(|link| link.joint.as_ref()).collect();
                let z =
                    moving.iter().find(|joint| joint.name == "base_z").unwrap_or_else(|| panic!("{text}"));
                assert_eq!((z.friction.len(), z.limits.effort), (1, Some(7.0)), "{text}");
                assert!(
                    moving
                        .iter()
                        .filter(|joint| joint.name != "base_z")
                        .all(|joint| joint.friction.is_empty())
                );
            }
        }
    }

    /// A placed joint keeps its name; tables of the base use the name that the base gets then.
    #[test]
    fn a_base_beside_a_joint_of_its_name_is_spoken_of_by_its_other_name() {
        let text = "base = { link = \"frame\", type = \"floating\" }
            joints = [{ name = \"base\", parent = \"frame\" }, { name = \"floating_base\", drive = { x = \"ideal\" } }]
            bodies = [{ link = \"frame\", mass = 2, inertia = 1 }, { link = \"base\", mass = 1, inertia = 1 }]";
        let model = read(text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(model.coordinates.len(), 7);
        assert_eq!(model.drives[0].name, "floating_base_x");
    }

    /// A ball of the extended description is spoken of whole, too.
    #[test]
    fn parts_of_an_extended_ball_are_told_at_its_name() {
        let ball = "<link name=\"tip\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>
            </inertial></link><joint name=\"ball\" type=\"spherical\"><parent link=\"frame\"/><child link=\"tip\"/></joint></robot>";
        let urdf = URDF.replace("</robot>", ball);
        let text = "urdf = \"arm.urdf\"\njoints = [{ name = \"ball\", friction = { rx = \"2*v\" } }]";
        let mut load = |name: &str| Ok((name.to_owned(), urdf.clone()));
        let (model, _) = from_toml(text, "robot.toml", &ReadOptions::default(), &mut load)
            .unwrap_or_else(|e| panic!("{e}"));
        let joints = model.links.iter().filter_map(|link| link.joint.as_ref());
        let with: Vec<&str> =
            joints.filter(|joint| !joint.friction.is_empty()).map(|joint| joint.name.as_str()).collect();
        assert_eq!((with, model.position_count()), (vec!["ball_rx"], 4));
    }

    #[test]
    fn a_base_that_is_another_link_than_the_root_is_an_error() {
        let text = "urdf = \"drone.urdf\"\nbase = { link = \"other\", type = \"floating\" }\n";
        let problems = read(text, &ReadOptions::default()).map(|_| ()).unwrap_err().to_string();
        assert!(problems.contains("other"), "{problems}");
    }
}
