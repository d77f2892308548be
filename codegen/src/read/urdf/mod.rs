//! Reader of URDF. It makes a [`RobotDescription`].
//!
//! Published files are accepted with all their elements. Elements that do not affect the dynamics are skipped
//! with a note.

mod foreign;
mod limits;
mod notes;
pub(crate) mod text;
mod transmissions;
mod values;
mod words;
mod xacro;

use self::notes::HARMLESS;
use self::text::UrdfText;
use crate::description::angles::Angles;
use crate::description::{
    BodyDescription, DriveChoice, FollowsDescription, FrameDescription, FrictionDescription,
    JointDescription, Name, RobotDescription, SkippedRotor,
};
use crate::diagnostic::{At, Report, Span, nearest};
use crate::model::pose::{IDENTITY, Rotation, Unsaid, norm};
use crate::model::{FrictionTerm, JointKind, Pose, QuaternionKind};
use crate::numeric::length;
use crate::read::composite::{self, Composite, Place};
use crate::read::options::ReadOptions;
use crate::read::skipped::Notes;
use crate::read::toml::values::join;
use crate::wording::{as_written, listed, three_digits};
use gelenk_formula::{Formula, TermOf};
use roxmltree::{Document, Node};
use std::path::Path;

/// Largest rounding error of the length of a published axis, which has about six digits.
const WRITTEN_DIGITS: f64 = 1e-5;

/// Reads a URDF; `None` if the text is not XML or contains no robot.
pub(super) fn description(
    report: &mut Report,
    angles: &mut Angles,
    text: &str,
    source: usize,
    file: &str,
    options: &ReadOptions,
) -> Option<RobotDescription> {
    let stem = stem(file);
    let lax = UrdfText::new(text);
    let document = match Document::parse(lax.as_str()) {
        Ok(document) => document,
        Err(wrong) => {
            report_syntax(&wrong, text, source, report);
            return None;
        }
    };
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        let message =
            format!("the root element is `{}`, but that of a URDF is `robot`", robot.tag_name().name());
        report.error(Span::new(source, robot.range()), "not-a-robot", message);
        return None;
    }
    let mut reader = Reader {
        report,
        angles,
        source,
        options: options.clone(),
        notes: Notes::default(),
        rotors: Vec::new(),
    };
    if let Some(macros) = xacro::first(robot) {
        let span = reader.span(macros);
        xacro::report(macros, span, file, reader.report);
        return None;
    }
    let description = reader.robot(robot, stem);
    reader.notes.report(|what| HARMLESS.contains(&what), reader.report);
    Some(description)
}

/// Reports errors of the XML parser.
pub(super) fn report_syntax(wrong: &roxmltree::Error, text: &str, source: usize, report: &mut Report) {
    let at = byte_offset(text, wrong.pos());
    report.error(Span::new(source, at..at + 1), "xml-syntax", without_position(&wrong.to_string()));
}

fn stem(file: &str) -> &str {
    let stem = Path::new(file).file_stem().and_then(|stem| stem.to_str());
    // The file may still have the name `arm.urdf.xacro` after its expansion.
    stem.map_or("robot", |stem| stem.trim_end_matches(".urdf"))
}

/// The message of roxmltree without its position, which the diagnostic shows already.
fn without_position(message: &str) -> &str {
    message.rsplit_once(" at ").map_or(message, |(message, _)| message)
}

fn byte_offset(text: &str, at: roxmltree::TextPos) -> usize {
    let row = at.row.saturating_sub(1) as usize;
    let start: usize = text.split_inclusive('\n').take(row).map(str::len).sum();
    let line = text.get(start..).unwrap_or("");
    let column = at.col.saturating_sub(1) as usize;
    start + line.char_indices().nth(column).map_or(line.len(), |(byte, _)| byte)
}

struct Reader<'r> {
    pub(super) report: &'r mut Report,
    angles: &'r mut Angles,
    pub(super) source: usize,
    options: ReadOptions,
    pub(super) notes: Notes,
    /// Rotors from transmissions and attributes that are not assigned to joints yet.
    pub(super) rotors: Vec<SkippedRotor>,
}

type XmlNode<'a> = Node<'a, 'a>;

/// Tags of the elements that give the shape of a link.
const SHAPES: [&str; 2] = ["visual", "collision"];

impl Reader<'_> {
    fn robot(&mut self, robot: XmlNode<'_>, fallback: &str) -> RobotDescription {
        let name = self.name(robot, "name");
        let mut result = RobotDescription {
            name: name.unwrap_or_else(|| At::new(fallback.to_owned(), self.span(robot))),
            default_drive: DriveChoice::Ideal,
            sort_joints: true,
            ..RobotDescription::default()
        };
        for node in robot.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "link" => self.link(node, &mut result),
                "joint" => match composite_of(node) {
                    Some(composite) => self.composite(node, composite, &mut result),
                    None => result.joints.extend(self.joint(node)),
                },
                "transmission" | "ros2_control" => self.transmission(node),
                _ => self.skip(node, &["link", "joint"]),
            }
        }
        self.place_rotors(&mut result);
        result.frames = massless_frames(&result);
        result
    }

    fn link(&mut self, node: XmlNode<'_>, result: &mut RobotDescription) {
        let Some(name) = self.required_name(node, "name") else {
            return;
        };
        let inertial = self.single(node, "inertial", &name.quoted());
        for skipped in
            node.children().filter(Node::is_element).filter(|inner| inner.tag_name().name() != "inertial")
        {
            self.skip(skipped, &["inertial"]);
        }
        result.links.push(name.clone());
        let is_shape = |inner: XmlNode<'_>| SHAPES.contains(&inner.tag_name().name());
        match inertial {
            Some(inertial) => result.bodies.extend(self.inertial(inertial, name)),
            None if node.children().any(is_shape) => result.weightless_shapes.push(name),
            None => {}
        }
    }

    /// Mass and inertia of a link; `None` if both are zero.
    fn inertial(&mut self, node: XmlNode<'_>, name: Name) -> Option<BodyDescription> {
        self.known_children(node, &["origin", "mass", "inertia"]);
        let mass = self.single(node, "mass", &name.quoted());
        let inertia = self.single(node, "inertia", &name.quoted());
        let Some(mass) = mass else {
            let span = self.span(node);
            let owner = format!("`{}`", name.value);
            match inertia {
                None => self.notes.remark(notes::EMPTY_INERTIAL, span, owner),
                Some(_) => {
                    let message = format!("link {owner} has an inertia but no <mass>: add its mass");
                    self.report.error(span, "missing-element", message);
                }
            }
            return None;
        };
        let mass = self.required_number(mass, "value")?;
        let inertia = inertia.map(|node| At::new(self.inertia(node), self.span(node)));
        let nothing = mass.value == 0.0 && inertia.as_ref().is_none_or(|inertia| inertia.value == [0.0; 6]);
        if nothing {
            return None;
        }
        let owner = format!("inertia of `{}`", name.value);
        Some(BodyDescription {
            link: name.clone(),
            origin: Some(self.origin(node, &owner)),
            unsaid: Unsaid::default(),
            mass: Some(At::new(Formula::Number(mass.value), mass.span)),
            center_of_mass: None,
            inertia: inertia.map(|entries| At::new(entries.value.map(Formula::Number), entries.span)),
            accept_unphysical: false,
            is_published: true,
            name,
        })
    }

    fn inertia(&mut self, node: XmlNode<'_>) -> [f64; 6] {
        let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
        keys.map(|key| self.required_number(node, key).map_or(0.0, |number| number.value))
    }

    fn origin(&mut self, parent: XmlNode<'_>, owner: &str) -> Pose {
        let Some(node) = self.single(parent, "origin", owner) else {
            return Pose::identity();
        };
        let xyz = self.vector(node, "xyz").map_or([0.0; 3], |xyz| xyz.value);
        let rpy = self.vector(node, "rpy").map(|rpy| self.angles.rpy(&rpy, owner));
        let quaternion = self.numbers::<4>(node, "quat_xyzw");
        if let Some(quaternion) = quaternion.as_ref().filter(|_| rpy.is_some()) {
            let message = format!("the <origin> of {owner} has both `rpy` and `quat_xyzw`");
            self.report.error(quaternion.span, "several-orientations", message).help("remove one of them");
        }
        let rotation = quaternion.and_then(|quaternion| self.attitude(&quaternion, owner)).or(rpy);
        let rotation = rotation.unwrap_or(IDENTITY);
        Pose { translation: xyz.map(Formula::Number), rotation }
    }

    /// The rotation of a quaternion of any length except 0.
    fn attitude(&mut self, quaternion: &At<[f64; 4]>, owner: &str) -> Option<Rotation> {
        let size = length(quaternion.value);
        if size == 0.0 {
            let message = format!("`quat_xyzw` of {owner} has length 0 and is not a rotation");
            self.report.error(quaternion.span, "quaternion-not-unit", message);
            self.report.help("the identity is \"0 0 0 1\"");
            return None;
        }
        if (size - 1.0).abs() > WRITTEN_DIGITS {
            let owner = format!("{owner} (length {} of the quaternion)", three_digits(size));
            self.notes.remark(notes::AXIS_NORMALIZED, quaternion.span, owner);
        }
        let [x, y, z, w] = quaternion.value.map(|part| part / size);
        Some(self.angles.quaternion([w, x, y, z]))
    }

    fn joint(&mut self, node: XmlNode<'_>) -> Option<JointDescription> {
        let name = self.required_name(node, "name")?;
        self.known_attributes(node);
        let known = ["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"];
        self.known_children(node, &known);
        let kind = self.kind(node, &name);
        let moves = kind != Some(JointKind::Fixed);
        let origin = self.origin(node, &format!("joint `{}`", name.value));
        let friction = self
            .single(node, "dynamics", &name.quoted())
            .filter(|_| moves)
            .map(|node| {
                (FrictionDescription { terms: self.friction(node, &name), load: None }, self.span(node))
            })
            .map(|(friction, span)| At::new(friction, span));
        let mimic =
            self.single(node, "mimic", &name.quoted()).filter(|_| moves && !self.options.ignore_mimic);
        Some(JointDescription {
            parent: self.end(node, "parent", &name),
            child: self.end(node, "child", &name),
            axis: if moves { self.axis(node, &name) } else { None },
            limits: self.limits(node, kind, &name),
            origin: Some(origin),
            unsaid: Unsaid::default(),
            friction,
            offset: mimic.and_then(|node| self.number(node, "offset")),
            follows: mimic.and_then(|node| self.mimicked(node)),
            kind,
            part_of: None,
            leads_on: false,
            link_frame: None,
            driven: None,
            held: None,
            springs: None,
            drive: None,
            name,
        })
    }

    /// Reads a planar, spherical or floating joint as a chain of joints with links between them.
    fn composite(&mut self, node: XmlNode<'_>, composite: Composite, result: &mut RobotDescription) {
        let Some(name) = self.required_name(node, "name") else {
            return;
        };
        self.known_children(node, &["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"]);
        self.refuse_in_composite(node, &name, composite);
        if composite.quaternion() == Some(QuaternionKind::Spherical) {
            self.notes.remark(notes::SPHERICAL_WITHOUT_DRIVE, self.span(node), name.quoted());
        }
        let has_axis = composite == Composite::Planar;
        let place = Place {
            parent: self.end(node, "parent", &name),
            child: self.end(node, "child", &name),
            origin: Some(self.origin(node, &format!("joint `{}`", name.value))),
            axis: has_axis.then(|| self.axis(node, &name)).flatten().unwrap_or([0.0, 0.0, 1.0]),
        };
        let joints = composite::expand(composite, &name, place, |_, name| JointDescription::named(name));
        let between = joints.iter().rev().skip(1).filter_map(|joint| joint.child.clone());
        result.links.extend(between);
        result.joints.extend(joints);
    }

    /// Reports elements that are ambiguous for a joint with several degrees of freedom.
    fn refuse_in_composite(&mut self, node: XmlNode<'_>, name: &Name, composite: Composite) {
        let (owner, kind) = (name.quoted(), composite.name());
        if composite == Composite::Planar && !node.children().any(|inner| inner.has_tag_name("axis")) {
            let message = format!("planar joint {owner} has no <axis>, the normal of its plane");
            self.report.error(self.span(node), "missing-element", message);
            self.report.help(
                "the default axis of URDF is x, but many tools use z. `<axis xyz=\"0 0 1\"/>` moves the joint in the x-y plane",
            );
        }
        if let Some(limit) = self.single(node, "limit", &owner) {
            self.notes.remark(notes::PLANAR_LIMITS, self.span(limit), owner.clone());
        }
        let dynamics = self
            .single(node, "dynamics", &owner)
            .filter(|dynamics| !self.friction(*dynamics, name).is_empty());
        let mimic = self.single(node, "mimic", &owner).filter(|_| !self.options.ignore_mimic);
        let unclear = [dynamics, mimic];
        for inner in unclear.into_iter().flatten() {
            let message = format!(
                "{kind} joint {owner} has <{}>, which is ambiguous for several degrees of freedom",
                inner.tag_name().name()
            );
            let code = if composite == Composite::Planar { "planar-joint" } else { "quaternion-joint" };
            self.report.error(self.span(inner), code, message);
            let parts = composite.parts().iter().map(|part| format!("`{}_{}`", name.value, part.name));
            self.report.help(format!(
                "describe it in a TOML file for the joints {}, which replace the {kind} joint",
                listed(parts)
            ));
        }
    }

    /// The joint that `<mimic>` names, with the multiplier as its ratio.
    fn mimicked(&mut self, node: XmlNode<'_>) -> Option<At<Vec<FollowsDescription>>> {
        let joint = self.required_name(node, "joint")?;
        let multiplier = self.number(node, "multiplier");
        let ratio = multiplier.unwrap_or_else(|| At::new(1.0, joint.span));
        let span = joint.span;
        let ratio = At::new(Formula::Number(ratio.value), ratio.span);
        Some(At::new(vec![FollowsDescription { joint, ratio }], span))
    }

    fn kind(&mut self, node: XmlNode<'_>, name: &Name) -> Option<JointKind> {
        let kind = node.attribute_node("type");
        match kind.map(|attribute| attribute.value()) {
            Some("fixed") => Some(JointKind::Fixed),
            Some("revolute") => Some(JointKind::Revolute),
            Some("continuous") => Some(JointKind::Continuous),
            Some("prismatic") => Some(JointKind::Prismatic),
            other => {
                let span = kind.map_or_else(|| self.span(node), |attribute| self.attribute_span(attribute));
                let other = other.map_or("none".to_owned(), |other| format!("{other:?}"));
                let message = format!("joint `{}` has type {other}, which is not supported", name.value);
                self.report.error(span, "joint-type", message);
                let wanted = kind.map_or("", |attribute| attribute.value());
                self.report.help(nearest(wanted, TYPES).unwrap_or_default());
                // The type was reported. The joint counts as moving, so that it causes no further error.
                Some(JointKind::Revolute)
            }
        }
    }

    fn end(&mut self, joint: XmlNode<'_>, tag: &str, name: &Name) -> Option<Name> {
        let node = self.single(joint, tag, &name.quoted());
        if node.is_none() {
            let message = format!("joint `{}` has no <{tag}>", name.value);
            self.report.error(self.span(joint), "missing-element", message);
        }
        self.required_name(node?, "link")
    }

    /// The axis as a unit vector. Without an axis it is x.
    fn axis(&mut self, joint: XmlNode<'_>, name: &Name) -> Option<[f64; 3]> {
        let node = self.single(joint, "axis", &name.quoted());
        if let Some(node) = node.filter(|node| !node.has_attribute("xyz")) {
            self.notes.remark(notes::AXIS_MISSING, self.span(node), name.quoted());
        }
        let Some(axis) = node.and_then(|node| self.vector(node, "xyz")) else {
            return Some([1.0, 0.0, 0.0]);
        };
        let length = norm(&axis.value);
        if length == 0.0 || !length.is_finite() {
            let message = format!(
                "the axis of joint `{}` has no direction: its length is {}",
                name.value,
                three_digits(length)
            );
            self.report.error(axis.span, "axis-not-unit", message);
            return None;
        }
        if (length - 1.0).abs() > WRITTEN_DIGITS {
            let owner =
                format!("`{}` [{}] of length {}", name.value, join(&axis.value), three_digits(length));
            self.notes.remark(notes::AXIS_NORMALIZED, axis.span, owner);
        }
        Some(axis.value.map(|x| x / length))
    }

    /// Friction `τ = damping · v + friction · sign(v)` of a joint with the velocity v.
    fn friction(&mut self, node: XmlNode<'_>, name: &Name) -> Vec<FrictionTerm> {
        if self.options.no_friction {
            return Vec::new();
        }
        let laws: [(&str, TermOf); 2] =
            [("damping", FrictionTerm::viscous), ("friction", FrictionTerm::coulomb)];
        laws.into_iter()
            .filter_map(|(key, law)| Some(law(self.friction_coefficient(node, key, name)?)))
            .collect()
    }

    /// The coefficient that an attribute of a friction law gives; `None` if it is 0.
    fn friction_coefficient(&mut self, node: XmlNode<'_>, key: &str, name: &Name) -> Option<Formula> {
        let number = self.number(node, key)?;
        if number.value < 0.0 {
            let value = as_written(number.value);
            let message = format!("joint `{}` has negative {key} {value}", name.value);
            self.report.error(number.span, "negative-friction", message);
        }
        (number.value > 0.0).then_some(Formula::Number(number.value))
    }
}

/// Types of joints that a URDF may have.
const TYPES: [&str; 7] = ["fixed", "revolute", "continuous", "prismatic", "planar", "floating", "spherical"];

/// The type of a joint with several degrees of freedom; `None` for other joints.
fn composite_of(joint: XmlNode<'_>) -> Option<Composite> {
    match joint.attribute("type") {
        Some("planar") => Some(Composite::Planar),
        Some("spherical") => Some(Composite::Quaternion(QuaternionKind::Spherical)),
        Some("floating") => Some(Composite::FLOATING),
        _ => None,
    }
}

/// Frames that links without mass on fixed joints define, for example tool0.
fn massless_frames(robot: &RobotDescription) -> Vec<FrameDescription> {
    let with_mass: Vec<&str> = robot.bodies.iter().map(|body| body.link.value.as_str()).collect();
    let with_mass: std::collections::BTreeSet<&str> = with_mass.into_iter().collect();
    let fixed = robot.joints.iter().filter(|joint| joint.kind == Some(JointKind::Fixed));
    let links = fixed.filter_map(|joint| joint.child.clone());
    let massless = links.filter(|link| !with_mass.contains(link.value.as_str()));
    let frame =
        |link: Name| FrameDescription { name: link.clone(), link, pose: Pose::identity(), is_site: false };
    massless.map(frame).collect()
}
