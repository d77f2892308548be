//! Transmissions of a URDF: gear reductions, and rotors in the notation of Drake and other tools.

use super::foreign::{ROTORS, plain};
use super::notes;
use super::words::value_of;
use super::{Reader, XmlNode};
use crate::description::{DriveChoice, DriveDescription, RobotDescription, SkippedRotor};
use crate::diagnostic::At;
use crate::wording::three_digits;
use gelenk_formula::Formula;
use roxmltree::Node;

/// Tags of a gear ratio in transmissions of ROS and ROS 2.
const REDUCTIONS: [&str; 1] = ["mechanicalreduction"];

/// Tags of a gear ratio in transmissions of Drake.
const RATIO: [&str; 1] = ["gearratio"];

/// Elements inside an element at any depth that have one of these tags.
fn inner<'a>(node: XmlNode<'a>, words: &'a [&str]) -> impl Iterator<Item = XmlNode<'a>> {
    let is_meant = |node: &XmlNode<'_>| words.contains(&plain(node.tag_name().name()).as_str());
    node.descendants().filter(Node::is_element).filter(is_meant)
}

/// The numbers in these elements. A number that equals the previous one is left out.
fn numbers<'a>(nodes: impl Iterator<Item = XmlNode<'a>>) -> Vec<f64> {
    let mut numbers: Vec<f64> = nodes.filter_map(|node| value_of(node).parse().ok()).collect();
    numbers.dedup();
    numbers
}

/// Name of the joint to which a reduction belongs. The reduction is inside a joint, or inside an actuator
/// with a joint.
fn joint_of<'a>(reduction: XmlNode<'a>) -> Option<&'a str> {
    let mut around = reduction.ancestors().skip(1).take(2);
    around.find_map(|node| match node.has_tag_name("joint") {
        true => node.attribute("name"),
        false => {
            let joint = node.children().find(|inner| inner.has_tag_name("joint"));
            joint.and_then(|joint| joint.attribute("name"))
        }
    })
}

/// Gear ratios that may belong to a rotor. Without a value, Drake's gear ratio is 1.
fn ratios(transmission: XmlNode<'_>, rotor: XmlNode<'_>) -> Vec<f64> {
    let own = rotor.parent_element().map_or(Vec::new(), |actuator| numbers(inner(actuator, &RATIO)));
    let found = if own.is_empty() { numbers(inner(transmission, &REDUCTIONS)) } else { own };
    let is_prefixed = rotor.tag_name().namespace().is_some() || rotor.tag_name().name().contains('.');
    if found.is_empty() && is_prefixed { vec![1.0] } else { found }
}

impl Reader<'_> {
    /// Reads the rotors of a transmission. Without a rotor a reduction does not change the dynamics, because
    /// inputs act at the joints.
    pub(super) fn transmission(&mut self, node: XmlNode<'_>) {
        let mut joints: Vec<String> = Vec::new();
        for name in inner(node, &["joint"]).filter_map(|joint| joint.attribute("name")) {
            if !joints.iter().any(|known| known == name) {
                joints.push(name.to_owned());
            }
        }
        let rotors: Vec<XmlNode<'_>> = inner(node, &ROTORS).collect();
        if rotors.is_empty() {
            self.notes.skip(format!("<{}>", node.tag_name().name()), self.span(node));
        }
        for &rotor in &rotors {
            match value_of(rotor).parse::<f64>() {
                Ok(0.0) => {}
                Ok(inertia) if inertia.is_finite() => self.rotors.push(SkippedRotor {
                    inertia: At::new(inertia, self.span(rotor)),
                    joints: joints.clone(),
                    ratios: ratios(node, rotor),
                }),
                _ => {
                    let what = format!("<{}> {:?}", rotor.tag_name().name(), value_of(rotor));
                    self.notes.remark(notes::UNKNOWN, self.span(rotor), what);
                }
            }
        }
        for reduction in inner(node, &REDUCTIONS).filter(|_| rotors.is_empty()) {
            let text = value_of(reduction);
            if text.parse() != Ok(1.0) {
                let owner =
                    joint_of(reduction).map_or(text.to_owned(), |joint| format!("{text} of `{joint}`"));
                self.notes.remark(notes::REDUCTION_IGNORED, self.span(reduction), owner);
            }
        }
    }

    /// Assigns rotors to their joints. Other rotors are kept for a warning that needs the mass matrix.
    pub(super) fn place_rotors(&mut self, robot: &mut RobotDescription) {
        for rotor in std::mem::take(&mut self.rotors) {
            let Some((name, added)) = rotor.place() else {
                robot.skipped_rotors.push(rotor);
                continue;
            };
            let mut joints = robot.joints.iter_mut();
            let joint = joints
                .find(|joint| joint.name.value == name && joint.part_of.is_none() && joint.is_coordinate());
            let Some(joint) = joint else {
                robot.skipped_rotors.push(rotor);
                continue;
            };
            let before = match &joint.drive {
                Some(At { value: DriveChoice::Motor(motor), .. }) => motor.rotor_inertia.value.clone(),
                _ => Formula::ZERO,
            };
            let span = rotor.inertia.span;
            let inertia = Formula::sum(before, Formula::Number(added));
            let motor = DriveDescription::at_joint(At::new(inertia, span));
            joint.drive = Some(At::new(DriveChoice::Motor(Box::new(motor)), span));
            let owner = format!("{} kg m² at `{name}`", three_digits(added));
            self.notes.remark(notes::ROTOR_READ, span, owner);
        }
    }
}
