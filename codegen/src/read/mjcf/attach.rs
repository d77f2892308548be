//! Reads `<attach>`, which adds a body of another model with its content. The names get a prefix.

use std::collections::BTreeSet;

use super::files::{Element, Text};
use super::{Part, Placed, Reader, WORLD, plain_path, read};
use crate::description::{DriveChoice, DriveDescription, FollowsDescription, Name, RobotDescription};
use crate::diagnostic::nearest;
use crate::model::Pose;
use crate::read::one_tree;
use crate::read::options::ReadOptions;

/// Largest depth of models that attach each other. It detects models that attach themselves.
const DEEPEST: usize = 8;

impl<'a> Reader<'_, 'a> {
    /// Attaches the body named by `<attach>` to a link.
    pub(super) fn attach(&mut self, placed: &Placed<'a>, link: &Name) {
        let element = placed.element;
        let [Some(model), Some(body), Some(prefix)] =
            ["model", "body", "prefix"].map(|key| self.name(element, key))
        else {
            return self.refuse(element);
        };
        let Some(mut part) = self.part(&model) else { return };
        let Some(&first) = part.bodies.get(&body.value) else {
            self.report.error(body.span, "unknown-link", format!("the model has no body `{}`", body.value));
            let help = nearest(&body.value, part.bodies.keys().map(String::as_str));
            return self.report.help(help.unwrap_or_else(|| "the model has no bodies".to_owned()));
        };
        let first = &mut part.robot.joints[first];
        let (name, root) = (first.name.value.clone(), first.child.clone());
        let whole = first.part_of.as_ref().map_or(&first.name, |part| &part.joint);
        match part.joints.get(&whole.value).filter(|joint| joint.is_free) {
            Some(free) => self.require_world(&free.name, link, &placed.pose, true),
            None => {
                first.origin = Some(placed.pose.then(&first.origin.take().unwrap_or_else(Pose::identity)));
            }
        }
        part.robot.frames.retain(|frame| frame.link.value != WORLD);
        one_tree::cut(&mut part.robot, WORLD, root.map(|root| root.value).unwrap_or_default());
        let sites: BTreeSet<&String> = part.robot.frames.iter().map(|frame| &frame.name.value).collect();
        part.sites.retain(|site| sites.contains(site));
        part.robot.links.retain(|link| link.value != WORLD);
        cut_references(&mut part.robot);
        let own: BTreeSet<String> = part.robot.joints.iter().map(|joint| joint.name.value.clone()).collect();
        part.joints.retain(|joint, _| own.contains(joint));
        let place = part.robot.joints.iter().position(|joint| joint.name.value == name);
        let renamed = |name: &str| format!("{}{name}{}", prefix.value, placed.suffix);
        names(&mut part.robot).into_iter().for_each(|name| name.value = renamed(&name.value));
        if let Some(place) = place {
            part.robot.joints[place].parent = Some(link.clone());
        }
        self.join(part, &renamed);
    }

    /// Reads the model of an `<asset>` that has this name.
    fn part(&mut self, model: &Name) -> Option<Part> {
        let mut known = Vec::new();
        for asset in self.models.clone() {
            let named = asset.node.attribute("name");
            if named.is_none_or(|name| name == model.value) {
                let part = self.read_part(asset)?;
                if named.is_some() || part.robot.name.value == model.value {
                    return Some(part);
                }
                known.push(part.robot.name.value);
            } else {
                known.extend(named.map(str::to_owned));
            }
        }
        self.report.error(model.span, "unknown-name", format!("<asset> has no model `{}`", model.value));
        let help = nearest(&model.value, known.iter().map(String::as_str));
        self.report.help(help.unwrap_or_else(|| "add `<model name=… file=…/>` to <asset>".to_owned()));
        None
    }

    fn read_part(&mut self, asset: Element<'a>) -> Option<Part> {
        let file = asset.attribute("file")?;
        let path = self.folder.join(plain_path(file.text));
        if self.chain.contains(&path) || self.chain.len() > DEEPEST {
            let message =
                format!("`{}` attaches itself, or is nested deeper than {DEEPEST} models", file.text);
            self.report
                .error(file.span, "included-twice", message)
                .help("remove the <attach> that leads back to this model, or nest fewer models");
            return None;
        }
        match self.meshes.load.text(&path.to_string_lossy()) {
            Ok((name, text)) => {
                let source = self.report.add_source(&name, &text);
                let options = ReadOptions { body: None, ..self.options.clone() };
                let (report, load) = (&mut *self.report, &mut *self.meshes.load);
                read(report, self.angles, Text::new(&path, source, &text), &options, load, &self.chain)
            }
            Err(wrong) => {
                for entry in wrong.into_entries() {
                    let here = entry.location().is_none().then_some(file.span);
                    self.report.push(here, entry);
                }
                None
            }
        }
    }

    fn join(&mut self, part: Part, renamed: &dyn Fn(&str) -> String) {
        let Part { robot, joints, sites, .. } = part;
        let taken = [
            (&mut self.link_names, robot.links.iter().collect::<Vec<_>>()),
            (&mut self.joint_names, robot.joints.iter().map(|joint| &joint.name).collect()),
            (&mut self.drive_names, robot.drives.iter().map(|drive| &drive.name).collect()),
        ];
        for (distinct, names) in taken {
            for name in names.into_iter().filter(|name| distinct.take(&name.value) != name.value) {
                let message = format!("two attached elements have the name `{}`", name.value);
                self.report.error(name.span, "duplicate-name", message);
                self.report.help("attach them with different prefixes");
            }
        }
        self.robot.links.extend(robot.links);
        self.robot.joints.extend(robot.joints);
        self.robot.bodies.extend(robot.bodies);
        self.robot.weightless_shapes.extend(robot.weightless_shapes);
        self.robot.frames.extend(robot.frames);
        self.robot.wrench_inputs.extend(robot.wrench_inputs);
        self.robot.drives.extend(robot.drives);
        self.sites.extend(sites.into_iter().map(|site| renamed(&site)));
        for (joint, mut known) in joints {
            known.name.value = renamed(&known.name.value);
            self.joints.insert(renamed(&joint), known);
        }
    }
}

/// Drops equalities and drives that refer to joints outside of the attached body, as MuJoCo does.
fn cut_references(robot: &mut RobotDescription) {
    let joints: BTreeSet<String> = robot.joints.iter().map(|joint| joint.name.value.clone()).collect();
    let is_whole = |on: &[FollowsDescription]| on.iter().all(|term| joints.contains(&term.joint.value));
    for joint in &mut robot.joints {
        if joint.follows.as_ref().is_some_and(|follows| !is_whole(&follows.value)) {
            (joint.follows, joint.offset) = (None, None);
        }
    }
    robot.drives.retain(|drive| is_whole(&drive.on));
}

/// All names of bodies, joints and other parts of a robot.
fn names(robot: &mut RobotDescription) -> Vec<&mut Name> {
    let mut names: Vec<&mut Name> = Vec::new();
    names.extend(robot.links.iter_mut().chain(&mut robot.weightless_shapes));
    for body in &mut robot.bodies {
        names.extend([&mut body.name, &mut body.link]);
    }
    for joint in &mut robot.joints {
        names.push(&mut joint.name);
        names.extend(joint.parent.iter_mut().chain(&mut joint.child));
        names.extend(
            joint.follows.iter_mut().flat_map(|follows| &mut follows.value).map(|term| &mut term.joint),
        );
        names.extend(joint.part_of.iter_mut().map(|part| &mut part.joint));
        if let Some(DriveChoice::Motor(motor)) = joint.drive.as_mut().map(|drive| &mut drive.value) {
            names.extend(of_motor(motor));
        }
    }
    for frame in &mut robot.frames {
        names.extend([&mut frame.name, &mut frame.link]);
    }
    for input in &mut robot.wrench_inputs {
        names.extend([&mut input.name, &mut input.frame]);
    }
    for drive in &mut robot.drives {
        names.push(&mut drive.name);
        names.extend(drive.on.iter_mut().map(|term| &mut term.joint));
        names.extend(of_motor(&mut drive.motor));
    }
    names
}

fn of_motor(motor: &mut DriveDescription) -> impl Iterator<Item = &mut Name> {
    motor.name.iter_mut().chain(&mut motor.carrier)
}
