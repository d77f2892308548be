//! A URDF as a [`RobotDescription`].
//!
//! Everything that a vendor's file contains is accepted; what does not enter the dynamics is skipped with a note.

use super::angles::Angles;
use super::description::{
    BodyDescription, DriveChoice, FrameDescription, JointDescription, LimitsDescription, Name,
    RobotDescription,
};
use super::pose::{IDENTITY, norm};
use super::toml_values::join;
use super::{FrictionTerm, JointKind, Pose, ReadOptions};
use crate::diagnostic::{At, Report, Span};
use crate::formula::{Formula, Function, LARGEST_NUMBER, too_large};
use roxmltree::{Attribute, Document, Node};
use std::collections::BTreeMap;

/// Reads a URDF; `None` where it is no XML or has no robot in it.
pub(super) fn description(
    report: &mut Report,
    angles: &mut Angles,
    text: &str,
    source: usize,
    name: &str,
    options: &ReadOptions,
) -> Option<RobotDescription> {
    let document = match Document::parse(text) {
        Ok(document) => document,
        Err(wrong) => {
            let at = byte_offset(text, wrong.pos());
            report.error(
                Span::new(source, at..at + 1),
                "xml-syntax",
                without_position(&wrong.to_string()),
            );
            return None;
        }
    };
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        let message = format!(
            "the file holds a `{}`, not a `robot`",
            robot.tag_name().name()
        );
        report.error(Span::new(source, robot.range()), "not-a-robot", message);
        return None;
    }
    let mut reader = Reader {
        report,
        angles,
        source,
        options: *options,
        skipped: BTreeMap::new(),
        remarks: BTreeMap::new(),
    };
    let description = reader.robot(robot, name);
    reader.finish();
    Some(description)
}

/// roxmltree appends its position, which the diagnostic shows already.
fn without_position(message: &str) -> &str {
    message
        .rsplit_once(" at ")
        .map_or(message, |(message, _)| message)
}

fn byte_offset(text: &str, at: roxmltree::TextPos) -> usize {
    let row = at.row.saturating_sub(1) as usize;
    let start: usize = text.split_inclusive('\n').take(row).map(str::len).sum();
    let line = text.get(start..).unwrap_or("");
    let column = at.col.saturating_sub(1) as usize;
    start
        + line
            .char_indices()
            .nth(column)
            .map_or(line.len(), |(byte, _)| byte)
}

struct Reader<'r> {
    report: &'r mut Report,
    angles: &'r mut Angles,
    source: usize,
    options: ReadOptions,
    /// Skipped elements and attributes: first place and count.
    skipped: BTreeMap<String, (Span, usize)>,
    /// What was changed: code, then first place and the owners.
    remarks: BTreeMap<&'static str, (Span, Vec<String>)>,
}

type XmlNode<'a> = Node<'a, 'a>;

impl Reader<'_> {
    fn span(&self, node: XmlNode<'_>) -> Span {
        let range = node.range();
        // The opening tag is enough: an element may be the whole file.
        let text = node
            .document()
            .input_text()
            .get(range.clone())
            .unwrap_or("");
        let length = text.find(['>', '\n']).map_or(text.len(), |at| at + 1);
        Span::new(self.source, range.start..range.start + length)
    }

    fn attribute_span(&self, attribute: Attribute<'_, '_>) -> Span {
        Span::new(self.source, attribute.range_value())
    }

    fn skip(&mut self, what: String, span: Span) {
        self.skipped.entry(what).or_insert((span, 0)).1 += 1;
    }

    fn remark(&mut self, code: &'static str, span: Span, owner: &str) {
        self.remarks
            .entry(code)
            .or_insert_with(|| (span, Vec::new()))
            .1
            .push(owner.to_owned());
    }

    fn robot(&mut self, robot: XmlNode<'_>, fallback: &str) -> RobotDescription {
        let name = self.name(robot, "name");
        let mut result = RobotDescription {
            name: name.unwrap_or_else(|| At::new(fallback.to_owned(), self.span(robot))),
            default_drive: DriveChoice::Ideal,
            sort_joints: true,
            ..RobotDescription::default()
        };
        for node in robot.children().filter(Node::is_element) {
            let namespace = node.tag_name().namespace().unwrap_or("");
            match node.tag_name().name() {
                _ if namespace.contains("xacro") => self.not_expanded(node),
                "link" => self.link(node, &mut result),
                "joint" => result.joints.extend(self.joint(node)),
                "transmission" => self.transmission(node),
                other => self.skip(format!("<{other}>"), self.span(node)),
            }
        }
        result.frames = massless_frames(&result);
        result
    }

    fn not_expanded(&mut self, node: XmlNode<'_>) {
        let message = format!(
            "<xacro:{}> is a macro, not a part of a robot",
            node.tag_name().name()
        );
        self.report
            .error(self.span(node), "xacro-not-expanded", message);
        self.report
            .help("expand the file first: `xacro robot.urdf.xacro > robot.urdf`");
    }

    /// A reduction or rotor in a transmission would change the dynamics; the drive is ideal all the same.
    fn transmission(&mut self, node: XmlNode<'_>) {
        self.skip("<transmission>".to_owned(), self.span(node));
        let reductions = node
            .descendants()
            .filter(|inner| inner.tag_name().name() == "mechanicalReduction");
        for reduction in reductions {
            let text = reduction.text().unwrap_or("").trim();
            if text.parse::<f64>().ok() != Some(1.0) {
                let span = self.span(reduction);
                self.remark("transmission-ignored", span, text);
            }
        }
    }

    fn link(&mut self, node: XmlNode<'_>, result: &mut RobotDescription) {
        let Some(name) = self.required_name(node, "name") else {
            return;
        };
        let inertial = self.single(node, "inertial");
        for skipped in node
            .children()
            .filter(Node::is_element)
            .filter(|inner| inner.tag_name().name() != "inertial")
        {
            self.skip(
                format!("<{}>", skipped.tag_name().name()),
                self.span(skipped),
            );
        }
        result.links.push(name.clone());
        if let Some(inertial) = inertial {
            result.bodies.extend(self.inertial(inertial, name));
        }
    }

    /// The body of a link; nothing where mass and inertia are zero.
    fn inertial(&mut self, node: XmlNode<'_>, name: Name) -> Option<BodyDescription> {
        self.known_children(node, &["origin", "mass", "inertia"]);
        let mass = self.single(node, "mass");
        let Some(mass) = mass else {
            self.report.error(
                self.span(node),
                "missing-element",
                format!("link `{}` has no <mass>", name.value),
            );
            return None;
        };
        let mass = self.required_number(mass, "value")?;
        let inertia = self
            .single(node, "inertia")
            .map(|node| At::new(self.inertia(node), self.span(node)));
        let nothing = mass.value == 0.0
            && inertia
                .as_ref()
                .is_none_or(|inertia| inertia.value == [0.0; 6]);
        if nothing {
            return None;
        }
        let owner = format!("inertia of `{}`", name.value);
        Some(BodyDescription {
            link: name.clone(),
            origin: Some(self.origin(node, &owner)),
            mass: Some(At::new(Formula::Number(mass.value), mass.span)),
            center_of_mass: None,
            inertia: inertia
                .map(|entries| At::new(entries.value.map(Formula::Number), entries.span)),
            accept_unphysical: false,
            is_published: true,
            name,
        })
    }

    fn inertia(&mut self, node: XmlNode<'_>) -> [f64; 6] {
        let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
        keys.map(|key| {
            self.required_number(node, key)
                .map_or(0.0, |number| number.value)
        })
    }

    fn origin(&mut self, parent: XmlNode<'_>, owner: &str) -> Pose {
        let Some(node) = self.single(parent, "origin") else {
            return Pose::identity();
        };
        let xyz = self.vector(node, "xyz").map_or([0.0; 3], |xyz| xyz.value);
        let rpy = self.vector(node, "rpy");
        let rotation = rpy.map_or(IDENTITY, |rpy| self.angles.rpy(&rpy, owner));
        Pose {
            translation: xyz.map(Formula::Number),
            rotation,
        }
    }

    fn joint(&mut self, node: XmlNode<'_>) -> Option<JointDescription> {
        let name = self.required_name(node, "name")?;
        let known = [
            "origin", "parent", "child", "axis", "limit", "dynamics", "mimic",
        ];
        self.known_children(node, &known);
        let kind = self.kind(node, &name);
        let moves = kind != Some(JointKind::Fixed);
        let origin = self.origin(node, &format!("joint `{}`", name.value));
        let friction = self
            .single(node, "dynamics")
            .filter(|_| moves)
            .map(|node| At::new(self.friction(node, &name), self.span(node)));
        let mimic = self
            .single(node, "mimic")
            .filter(|_| moves && !self.options.ignore_mimic);
        Some(JointDescription {
            parent: self.end(node, "parent", &name),
            child: self.end(node, "child", &name),
            axis: if moves { self.axis(node, &name) } else { None },
            limits: self.limits(node, kind, &name),
            origin: Some(origin),
            friction,
            mimic: mimic.and_then(|node| self.required_name(node, "joint")),
            kind,
            link_frame: None,
            held: None,
            springs: None,
            drive: None,
            name,
        })
    }

    fn kind(&mut self, node: XmlNode<'_>, name: &Name) -> Option<JointKind> {
        let kind = node.attribute_node("type");
        match kind.map(|attribute| attribute.value()) {
            Some("fixed") => Some(JointKind::Fixed),
            Some("revolute") => Some(JointKind::Revolute),
            Some("continuous") => Some(JointKind::Continuous),
            Some("prismatic") => Some(JointKind::Prismatic),
            other => {
                let span = kind.map_or_else(
                    || self.span(node),
                    |attribute| self.attribute_span(attribute),
                );
                let other = other.map_or("none".to_owned(), |other| format!("{other:?}"));
                let message = format!(
                    "joint `{}` has type {other}, which is not supported",
                    name.value
                );
                self.report.error(span, "joint-type", message);
                self.report.help(
                    "supported are fixed, revolute, continuous and prismatic; write a floating or planar joint as a \
                     chain of prismatic and revolute joints, or fix it",
                );
                // Reported; taken as moving, so that it causes no second complaint.
                Some(JointKind::Revolute)
            }
        }
    }

    fn end(&mut self, joint: XmlNode<'_>, tag: &str, name: &Name) -> Option<Name> {
        let node = self.single(joint, tag);
        if node.is_none() {
            let message = format!("joint `{}` has no <{tag}>", name.value);
            self.report
                .error(self.span(joint), "missing-element", message);
        }
        self.required_name(node?, "link")
    }

    /// The axis at unit length; x where none is described.
    fn axis(&mut self, joint: XmlNode<'_>, name: &Name) -> Option<[f64; 3]> {
        let node = self.single(joint, "axis");
        let Some(axis) = node.and_then(|node| self.vector(node, "xyz")) else {
            return Some([1.0, 0.0, 0.0]);
        };
        let length = norm(&axis.value);
        if length == 0.0 || !length.is_finite() {
            let message = format!("the axis of joint `{}` has length {length}", name.value);
            self.report.error(axis.span, "axis-not-unit", message);
            return None;
        }
        if (length - 1.0).abs() > 1e-9 {
            let owner = format!(
                "`{}` [{}] of length {length}",
                name.value,
                join(&axis.value)
            );
            self.remark("axis-normalized", axis.span, &owner);
        }
        Some(axis.value.map(|x| x / length))
    }

    fn limits(
        &mut self,
        joint: XmlNode<'_>,
        kind: Option<JointKind>,
        name: &Name,
    ) -> LimitsDescription {
        let bounded = matches!(kind, Some(JointKind::Revolute | JointKind::Prismatic));
        let moves = kind != Some(JointKind::Fixed);
        let Some(node) = self.single(joint, "limit").filter(|_| moves) else {
            return LimitsDescription::default();
        };
        let (lower, upper) = (self.number(node, "lower"), self.number(node, "upper"));
        let value = |bound: &Option<At<f64>>| bound.as_ref().map_or(0.0, |bound| bound.value);
        let (low, high) = (value(&lower), value(&upper));
        let span = upper.or(lower).map(|bound| bound.span);
        let position = span
            .filter(|_| bounded && low != high)
            .map(|span| At::new([low, high], span));
        let (velocity, effort) = (self.number(node, "velocity"), self.number(node, "effort"));
        // What is no number has its error already.
        let is_unset = |key, limit: &Option<At<f64>>| match limit {
            Some(limit) => limit.value == 0.0,
            None => node.attribute(key).is_none(),
        };
        if is_unset("velocity", &velocity)
            || is_unset("effort", &effort)
            || (bounded && position.is_none())
        {
            let span = self.span(node);
            self.remark("limit-unset", span, &format!("`{}`", name.value));
        }
        let useful = |limit: Option<At<f64>>| limit.filter(|limit| limit.value != 0.0);
        LimitsDescription {
            position,
            velocity: useful(velocity),
            effort: useful(effort),
            peak_effort: None,
        }
    }

    /// `τ = damping · v + friction · sign(v)`
    fn friction(&mut self, node: XmlNode<'_>, name: &Name) -> Vec<FrictionTerm> {
        for unknown in node
            .attributes()
            .filter(|attribute| !["damping", "friction"].contains(&attribute.name()))
        {
            self.skip(
                format!("<dynamics {}>", unknown.name()),
                Span::new(self.source, unknown.range()),
            );
        }
        if self.options.no_friction {
            return Vec::new();
        }
        let sign = Formula::call(Function::Sign, Formula::Velocity);
        let laws = [("damping", Formula::Velocity), ("friction", sign)];
        laws.into_iter()
            .filter_map(|(key, basis)| self.friction_term(node, key, basis, name))
            .collect()
    }

    fn friction_term(
        &mut self,
        node: XmlNode<'_>,
        key: &str,
        basis: Formula,
        name: &Name,
    ) -> Option<FrictionTerm> {
        let number = self.number(node, key)?;
        if number.value < 0.0 {
            let message = format!("joint `{}` has negative {key} {}", name.value, number.value);
            self.report.error(number.span, "negative-friction", message);
        }
        let coefficient = Formula::Number(number.value);
        (number.value > 0.0).then_some(FrictionTerm { coefficient, basis })
    }

    /// The only child element of this kind.
    fn single<'a>(&mut self, node: XmlNode<'a>, tag: &str) -> Option<XmlNode<'a>> {
        let mut found = node
            .children()
            .filter(|inner| inner.is_element() && inner.tag_name().name() == tag);
        let first = found.next()?;
        if let Some(second) = found.next() {
            let message = format!("a second <{tag}> in the same <{}>", node.tag_name().name());
            self.report
                .error(self.span(second), "duplicate-element", message);
        }
        Some(first)
    }

    fn known_children(&mut self, node: XmlNode<'_>, known: &[&str]) {
        for inner in node.children().filter(Node::is_element) {
            if !known.contains(&inner.tag_name().name()) {
                self.skip(format!("<{}>", inner.tag_name().name()), self.span(inner));
            }
        }
    }

    fn name(&mut self, node: XmlNode<'_>, key: &str) -> Option<Name> {
        let attribute = node.attribute_node(key)?;
        let (text, span) = (attribute.value(), self.attribute_span(attribute));
        if text.is_empty() || text.chars().any(char::is_control) {
            self.report.error(
                span,
                "unusable-name",
                format!("`{key}` must be one line of text, not {text:?}"),
            );
            return None;
        }
        Some(At::new(text.to_owned(), span))
    }

    fn required_name(&mut self, node: XmlNode<'_>, key: &str) -> Option<Name> {
        if !node.has_attribute(key) {
            self.missing(node, key);
        }
        self.name(node, key)
    }

    fn missing(&mut self, node: XmlNode<'_>, key: &str) {
        let message = format!("<{}> has no `{key}`", node.tag_name().name());
        self.report
            .error(self.span(node), "missing-attribute", message);
    }

    fn required_number(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<f64>> {
        if !node.has_attribute(key) {
            self.missing(node, key);
        }
        self.number(node, key)
    }

    fn number(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<f64>> {
        self.numbers::<1>(node, key)
            .map(|found| At::new(found.value[0], found.span))
    }

    fn vector(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<[f64; 3]>> {
        self.numbers::<3>(node, key)
    }

    fn numbers<const N: usize>(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<[f64; N]>> {
        let attribute = node.attribute_node(key)?;
        let span = self.attribute_span(attribute);
        let numbers: Vec<Option<f64>> = attribute
            .value()
            .split_whitespace()
            .map(|word| word.parse().ok())
            .collect();
        let mut result = [0.0; N];
        let readable = numbers.len() == N && numbers.iter().all(Option::is_some);
        for (into, number) in result.iter_mut().zip(numbers.into_iter().flatten()) {
            *into = number + 0.0; // −0 becomes 0
        }
        if !readable {
            let wanted = if N == 1 {
                "a number".to_owned()
            } else {
                format!("{N} numbers")
            };
            let found: String = attribute.value().chars().take(60).collect();
            self.report.error(
                span,
                "not-a-number",
                format!("`{key}` must be {wanted}, not {found:?}"),
            );
            return None;
        }
        if result.iter().any(|number| !number.is_finite()) {
            let message = format!("`{key}` must be finite, not {}", attribute.value());
            self.report.error(span, "number-not-finite", message);
            return None;
        }
        if result.iter().any(|number| number.abs() > LARGEST_NUMBER) {
            let message = too_large(&format!("`{key}`"));
            self.report.error(span, "number-too-large", message);
            return None;
        }
        Some(At::new(result, span))
    }

    fn finish(self) {
        note_skipped(self.report, self.skipped);
        for (code, (span, owners)) in self.remarks {
            let text = match code {
                "axis-normalized" => "axes were brought to length 1",
                "transmission-ignored" => "mechanical reductions were ignored, drives are ideal",
                _ => "limits that are 0 or equal were taken as not given",
            };
            let list = owners
                .iter()
                .take(6)
                .cloned()
                .collect::<Vec<_>>()
                .join(", ");
            let more = match owners.len() {
                0..=6 => String::new(),
                count => format!(" and {} more", count - 6),
            };
            self.report
                .note(Some(span), code, format!("{text}: {list}{more}"));
        }
    }
}

/// Elements that never enter the dynamics; they share one note.
const HARMLESS: [&str; 7] = [
    "<visual>",
    "<collision>",
    "<material>",
    "<transmission>",
    "<gazebo>",
    "<safety_controller>",
    "<calibration>",
];

fn note_skipped(report: &mut Report, skipped: BTreeMap<String, (Span, usize)>) {
    let (harmless, unknown): (Vec<_>, Vec<_>) = skipped
        .into_iter()
        .partition(|(what, _)| HARMLESS.contains(&what.as_str()));
    let first = harmless
        .iter()
        .map(|(_, (span, _))| *span)
        .min_by_key(|span| span.start);
    if let Some(span) = first {
        let counts = harmless
            .iter()
            .map(|(what, (_, count))| format!("{count} {what}"));
        let counts = counts.collect::<Vec<_>>().join(", ");
        report.note(
            Some(span),
            "skipped",
            format!("skipped: {counts}; they do not enter the dynamics"),
        );
    }
    for (what, (span, count)) in unknown {
        let times = if count == 1 {
            "once".to_owned()
        } else {
            format!("{count} times")
        };
        report.note(
            Some(span),
            "unknown-tag",
            format!("{what} is not known and was skipped ({times})"),
        );
    }
}

/// Links without mass on fixed joints are frames: tool0 and the like.
fn massless_frames(robot: &RobotDescription) -> Vec<FrameDescription> {
    let with_mass: Vec<&str> = robot
        .bodies
        .iter()
        .map(|body| body.link.value.as_str())
        .collect();
    let with_mass: std::collections::BTreeSet<&str> = with_mass.into_iter().collect();
    let fixed = robot
        .joints
        .iter()
        .filter(|joint| joint.kind == Some(JointKind::Fixed));
    let links = fixed.filter_map(|joint| joint.child.clone());
    let massless = links.filter(|link| !with_mass.contains(link.value.as_str()));
    massless
        .map(|link| FrameDescription {
            name: link.clone(),
            link,
            pose: Pose::identity(),
        })
        .collect()
}
