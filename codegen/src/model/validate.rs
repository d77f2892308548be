//! A [`RobotDescription`] becomes a [`Model`], or everything that is wrong with it.

use super::description::{
    BodyDescription, DriveChoice, DriveDescription, FrameDescription, JointDescription,
    LimitsDescription, Name, RobotDescription,
};
use super::inertia::{self, Flaw};
use super::name::{identifier, is_argument};
use super::pose::{rotate_inertia, rotate_numbers};
use super::regularity::singular_joints;
use super::tree::{self, Tree};
use super::{
    Body, Drive, Frame, Input, Joint, JointKind, Limits, Link, Model, Motion, MotorTorque, Pose,
    RotorCoupling,
};
use crate::diagnostic::{At, Report, nearest};
use crate::formula::Formula;
use std::collections::{BTreeMap, BTreeSet};

/// Gravity where none is described (m/s²).
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Checks everything and builds the model; with errors in the report there is none.
pub(super) fn model(robot: &RobotDescription, report: &mut Report) -> Option<Model> {
    let mut names = Names::default();
    let identifiers = JointNames::new(robot, &mut names, report);
    let defaults: Vec<f64> = robot
        .parameters
        .iter()
        .map(|parameter| parameter.value.default)
        .collect();
    for joint in &robot.joints {
        check_joint(joint, report);
    }
    for body in &robot.bodies {
        check_body(body, &defaults, report);
    }
    report_duplicates(robot.bodies.iter().map(|body| &body.name), "bodies", report);
    let name = names.identifier(&robot.name, report);
    let tree = tree::build(robot, report);
    names.note(report);
    let tree = tree?;
    let mut builder = Builder {
        robot,
        report,
        names: identifiers,
        defaults,
        tree,
        offsets: Vec::new(),
    };
    let model = builder.build(name?)?;
    check_regularity(&model, robot, builder.report, &builder.tree);
    (!report.has_errors()).then_some(model)
}

/// Identifiers and what had to be changed to get them.
#[derive(Debug, Default)]
struct Names {
    changed: Vec<(Name, String)>,
}

impl Names {
    fn identifier(&mut self, name: &Name, report: &mut Report) -> Option<String> {
        let Some(result) = identifier(&name.value) else {
            report.error(
                name.span,
                "unusable-name",
                format!("{:?} has no letter or digit", name.value),
            );
            report.help("names become Rust identifiers: use ASCII letters, digits and underscores");
            return None;
        };
        if result != name.value {
            self.changed.push((name.clone(), result.clone()));
        }
        Some(result)
    }

    /// Distinct identifiers of entries of one kind, in their order.
    fn distinct(
        &mut self,
        names: &[&Name],
        what: &str,
        prefix: Option<&str>,
        report: &mut Report,
    ) -> Vec<String> {
        let mut seen: BTreeMap<String, &Name> = BTreeMap::new();
        let mut result = Vec::new();
        for name in names {
            let Some(mut own) = self.identifier(name, report) else {
                // Reported; the entry keeps its place in the list.
                result.push(String::new());
                continue;
            };
            if let Some(prefix) = prefix.filter(|_| is_argument(&own)) {
                own = format!("{prefix}_{own}");
                self.changed.push(((*name).clone(), own.clone()));
            }
            if let Some(first) = seen.get(&own) {
                report_collision(first, name, &own, what, report);
            } else {
                seen.insert(own.clone(), name);
            }
            result.push(own);
        }
        result
    }

    fn note(self, report: &mut Report) {
        let Some((first, _)) = self.changed.first() else {
            return;
        };
        let list = self
            .changed
            .iter()
            .take(6)
            .map(|(from, to)| format!("{:?} → `{to}`", from.value));
        let list = list.collect::<Vec<_>>().join(", ");
        let more = match self.changed.len() {
            0..=6 => String::new(),
            count => format!(" and {} more", count - 6),
        };
        report.note(
            Some(first.span),
            "name-mapped",
            format!("names in generated code: {list}{more}"),
        );
    }
}

fn report_collision(
    first: &Name,
    second: &Name,
    identifier: &str,
    what: &str,
    report: &mut Report,
) {
    let place = report.place(first.span);
    if first.value == second.value {
        let message = format!(
            "two {what} are named `{}`; the other one stands at {place}",
            second.value
        );
        report.error(second.span, "duplicate-name", message);
        report.help("give each its own name");
        return;
    }
    let message = format!(
        "{:?} and {:?} would both be `{identifier}` in generated code",
        first.value, second.value
    );
    report.error(second.span, "name-collision", message);
    report.help(format!(
        "rename one of them; the other one stands at {place}"
    ));
}

fn report_duplicates<'d>(names: impl Iterator<Item = &'d Name>, what: &str, report: &mut Report) {
    let mut seen: BTreeMap<&str, &Name> = BTreeMap::new();
    for name in names {
        match seen.get(name.value.as_str()) {
            Some(first) => report_collision(first, name, &name.value, what, report),
            None => {
                seen.insert(&name.value, name);
            }
        }
    }
}

/// Identifiers of joints, frames and drives, in the order of their description.
#[derive(Debug)]
struct JointNames {
    joints: Vec<String>,
    frames: Vec<String>,
    drives: Vec<Option<String>>,
}

impl JointNames {
    fn new(robot: &RobotDescription, names: &mut Names, report: &mut Report) -> Self {
        let joints: Vec<&Name> = robot.joints.iter().map(|joint| &joint.name).collect();
        let joints = names.distinct(&joints, "joints", Some("joint"), report);
        // Fixed joints do not appear in generated code.
        let fixed = robot
            .joints
            .iter()
            .filter(|joint| joint.kind == Some(JointKind::Fixed));
        let fixed: BTreeSet<&str> = fixed.map(|joint| joint.name.value.as_str()).collect();
        names
            .changed
            .retain(|(name, _)| !fixed.contains(name.value.as_str()));
        let frames: Vec<&Name> = robot.frames.iter().map(|frame| &frame.name).collect();
        let frames = names.distinct(&frames, "frames", None, report);
        let drive_name =
            |joint: &JointDescription| match joint.drive.as_ref().map(|drive| &drive.value) {
                Some(DriveChoice::Motor(motor)) => motor.name.clone(),
                _ => None,
            };
        let own: Vec<Option<Name>> = robot.joints.iter().map(drive_name).collect();
        let listed: Vec<&Name> = own.iter().flatten().collect();
        let mut mapped = names
            .distinct(&listed, "drives", Some("drive"), report)
            .into_iter();
        let drives = own
            .iter()
            .map(|name| name.as_ref().and_then(|_| mapped.next()))
            .collect();
        Self {
            joints,
            frames,
            drives,
        }
    }
}

fn check_joint(joint: &JointDescription, report: &mut Report) {
    let name = &joint.name;
    if let Some(position) = &joint.limits.position {
        let [low, high] = position.value;
        if joint.kind == Some(JointKind::Continuous) {
            let message = format!(
                "joint `{}` is continuous and has position limits",
                name.value
            );
            report.error(position.span, "conflicting-keys", message);
            report.help("a joint with position limits is \"revolute\"");
        }
        if low > high {
            let message = format!(
                "position limits of joint `{}` are reversed: {low} > {high}",
                name.value
            );
            report.error(position.span, "limits-reversed", message);
            report.help(format!(
                "write {high} as the lower and {low} as the upper limit"
            ));
        }
        if let Some(held) = joint
            .held
            .filter(|held| low <= high && !(low..=high).contains(held))
        {
            let message = format!(
                "joint `{}` is held at {held}, outside of its limits {low} … {high}",
                name.value
            );
            report.note(Some(name.span), "held-outside-limits", message);
        }
    }
    check_amounts(&joint.limits, name, report);
    if joint.kind == Some(JointKind::Fixed) {
        check_fixed(joint, report);
    } else if let Some(other) = joint.mimic.as_ref().filter(|_| joint.held.is_none()) {
        let message = format!(
            "joint `{}` mimics `{}`; coupled joints are not modelled",
            name.value, other.value
        );
        report.error(other.span, "mimic-joint", message);
        report.help("`--ignore-mimic` (or `ignore_mimic = true`) makes it independent; a TOML description can hold it");
    }
}

fn check_amounts(limits: &LimitsDescription, name: &Name, report: &mut Report) {
    let amounts = [
        ("speed", &limits.velocity),
        ("effort", &limits.effort),
        ("peak effort", &limits.peak_effort),
    ];
    for (what, limit) in amounts {
        if let Some(limit) = limit.as_ref().filter(|limit| limit.value <= 0.0) {
            let message = format!(
                "the {what} limit of joint `{}` is {}, not positive",
                name.value, limit.value
            );
            report.error(limit.span, "not-positive", message);
        }
    }
    if let (Some(nominal), Some(peak)) = (&limits.effort, &limits.peak_effort)
        && nominal.value > peak.value
    {
        let message = format!(
            "nominal effort {} of joint `{}` exceeds its peak {}",
            nominal.value, name.value, peak.value
        );
        report.error(peak.span, "limits-reversed", message);
    }
}

fn check_fixed(joint: &JointDescription, report: &mut Report) {
    let what = if joint.held.is_some() {
        "`held`"
    } else if joint.drive.is_some() {
        "a drive"
    } else if joint.springs.is_some() {
        "a spring"
    } else if joint
        .friction
        .as_ref()
        .is_some_and(|terms| !terms.is_empty())
    {
        "friction"
    } else {
        return;
    };
    let message = format!(
        "joint `{}` is fixed; {what} has no meaning there",
        joint.name.value
    );
    report.error(joint.name.span, "fixed-joint", message);
    report.help("remove it, or give the joint a type that moves");
}

fn check_body(body: &BodyDescription, defaults: &[f64], report: &mut Report) {
    let value = |formula: &Formula| formula.evaluate(defaults, 0.0, 0.0);
    let Some(mass) = &body.mass else {
        let message = format!("body `{}` has no `mass`", body.name.value);
        report.error(body.name.span, "missing-key", message);
        report.help("write `mass = 0` for a body that only has inertia");
        return;
    };
    let kilograms = value(&mass.value);
    if !kilograms.is_finite() || kilograms < 0.0 {
        let message = format!("body `{}` has mass {kilograms}", body.name.value);
        report.error(mass.span, "mass-not-positive", message);
        report.help("a mass is finite and at least 0");
    }
    if body
        .center_in_link()
        .iter()
        .any(|entry| !value(entry).is_finite())
    {
        let message = format!(
            "the centre of mass of body `{}` is not finite",
            body.name.value
        );
        report.error(body.name.span, "number-not-finite", message);
    }
    let Some(inertia) = &body.inertia else { return };
    let entries = std::array::from_fn(|k| value(&inertia.value[k]));
    if entries.iter().any(|entry| !entry.is_finite()) {
        let message = format!("the inertia of body `{}` is not finite", body.name.value);
        report.error(inertia.span, "number-not-finite", message);
        return;
    }
    if let Some(flaw) = inertia::check(entries) {
        report_inertia(body, inertia, &flaw, report);
    }
}

/// Six significant digits.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn report_inertia(
    body: &BodyDescription,
    inertia: &At<[Formula; 6]>,
    flaw: &Flaw,
    report: &mut Report,
) {
    let name = &body.name.value;
    let (code, message) = match flaw.moments().map(short) {
        [low, middle, high] if flaw.is_triangle() => (
            "inertia-triangle-inequality",
            format!(
                "inertia of body `{name}` belongs to no real body: principal moments \
                 {low} + {middle} < {high}"
            ),
        ),
        [low, middle, high] => (
            "inertia-not-positive-definite",
            format!(
                "inertia of body `{name}` is not positive definite: principal moments \
                 {low}, {middle}, {high}"
            ),
        ),
    };
    if body.accept_unphysical {
        report.note(Some(inertia.span), code, message);
        return;
    }
    report.error(inertia.span, code, message);
    report.help(
        "inertia counts about the centre of mass; `accept_unphysical = true` in a TOML body takes \
         it as published",
    );
}

fn check_regularity(model: &Model, robot: &RobotDescription, report: &mut Report, tree: &Tree) {
    if report.has_errors() {
        return;
    }
    for link in singular_joints(model) {
        let Some(joint) = tree.joints[link].and_then(|joint| robot.joints.get(joint)) else {
            continue;
        };
        let leaf = !carries_moving_joint(model, link);
        let code = if leaf {
            "massless-leaf"
        } else {
            "singular-mass-matrix"
        };
        let message = format!(
            "joint `{}` moves nothing that has inertia along its axis: the mass matrix would be singular",
            joint.name.value
        );
        report.error(joint.name.span, code, message);
        report.help(
            "give the links that move with it mass or inertia, give its drive a rotor inertia, or make the joint fixed",
        );
    }
}

/// Whether a moving joint stands on the link or on what is fixed to it.
fn carries_moving_joint(model: &Model, link: usize) -> bool {
    let mut beyond = vec![false; model.links.len()];
    beyond[link] = true;
    for (index, other) in model.links.iter().enumerate().skip(link + 1) {
        let Some(joint) = other.joint.as_ref().filter(|joint| beyond[joint.parent]) else {
            continue;
        };
        if matches!(joint.motion, Motion::Coordinate(_)) {
            return true;
        }
        beyond[index] = true;
    }
    false
}

struct Builder<'d, 'r> {
    robot: &'d RobotDescription,
    report: &'r mut Report,
    names: JointNames,
    defaults: Vec<f64>,
    tree: Tree,
    /// For each link its described frame in the frame of the model's link.
    offsets: Vec<Pose>,
}

impl Builder<'_, '_> {
    fn build(&mut self, name: String) -> Option<Model> {
        let coordinates = self.coordinates()?;
        let mut links = self.links(&coordinates);
        self.attach_bodies(&mut links);
        let drives = self.drives(&links);
        let frames = self.frames();
        let gravity = self
            .robot
            .gravity
            .clone()
            .unwrap_or(GRAVITY.map(Formula::Number));
        Some(Model {
            name,
            description: self.robot.description.clone(),
            gravity,
            parameters: self
                .robot
                .parameters
                .iter()
                .map(|parameter| parameter.value.clone())
                .collect(),
            links,
            coordinates,
            drives,
            frames,
            options: self.robot.options.clone().unwrap_or_default(),
        })
    }

    fn moves(&self, joint: usize) -> bool {
        let joint = &self.robot.joints[joint];
        joint.kind.is_some_and(|kind| kind != JointKind::Fixed) && joint.held.is_none()
    }

    /// Link indices of the moving joints: as listed, else as described, else in the order of the tree.
    fn coordinates(&mut self) -> Option<Vec<usize>> {
        let mut moving: Vec<(usize, usize)> = Vec::new();
        for (link, joint) in self.tree.joints.iter().enumerate() {
            moving.extend(
                joint
                    .filter(|joint| self.moves(*joint))
                    .map(|joint| (joint, link)),
            );
        }
        if moving.is_empty() {
            self.report.error(
                self.robot.name.span,
                "no-moving-joint",
                "no joint of the robot moves",
            );
            self.report.help("a model needs at least one revolute, continuous or prismatic joint that is not held");
            return None;
        }
        if !self.robot.sort_joints {
            moving.sort_unstable();
        }
        match &self.robot.coordinates {
            Some(listed) => self.listed_coordinates(listed, &moving),
            None => Some(moving.into_iter().map(|(_, link)| link).collect()),
        }
    }

    fn listed_coordinates(
        &mut self,
        listed: &[Name],
        moving: &[(usize, usize)],
    ) -> Option<Vec<usize>> {
        let joints = &self.robot.joints;
        let by_name: BTreeMap<&str, usize> = moving
            .iter()
            .map(|(joint, link)| (joints[*joint].name.value.as_str(), *link))
            .collect();
        let before = self.report.error_count();
        report_duplicates(listed.iter(), "coordinates", self.report);
        let mut result = Vec::new();
        for name in listed {
            match by_name.get(name.value.as_str()) {
                Some(link) => result.push(*link),
                None => {
                    let message = format!("`{}` is no moving joint", name.value);
                    self.report.error(name.span, "unknown-joint", message);
                    if let Some(help) = nearest(&name.value, by_name.keys().copied()) {
                        self.report.help(help);
                    }
                }
            }
        }
        for (name, _) in by_name.iter().filter(|(_, link)| !result.contains(link)) {
            let span = listed
                .first()
                .map_or(self.robot.name.span, |first| first.span);
            self.report.error(
                span,
                "missing-coordinate",
                format!("`coordinates` lacks the moving joint `{name}`"),
            );
            self.report.help("list every moving joint, or hold it");
        }
        (self.report.error_count() == before).then_some(result)
    }

    fn links(&mut self, coordinates: &[usize]) -> Vec<Link> {
        let mut order = vec![None; self.tree.links.len()];
        for (coordinate, link) in coordinates.iter().enumerate() {
            order[*link] = Some(coordinate);
        }
        let mut links = Vec::new();
        for link in 0..self.tree.links.len() {
            let joint = self.tree.joints[link]
                .map(|joint| self.joint(joint, self.tree.parents[link], order[link]));
            let described = self.tree.joints[link]
                .and_then(|joint| self.robot.joints[joint].link_frame.clone());
            self.offsets.push(described.unwrap_or_else(Pose::identity));
            links.push(Link {
                name: self.tree.links[link].value.clone(),
                joint,
                bodies: Vec::new(),
            });
        }
        links
    }

    fn joint(&self, index: usize, parent: usize, coordinate: Option<usize>) -> Joint {
        let described = &self.robot.joints[index];
        let origin = described.origin.clone().unwrap_or_else(Pose::identity);
        let motion = match (coordinate, described.held) {
            (Some(coordinate), _) => Motion::Coordinate(coordinate),
            (None, Some(position)) => Motion::Held(position),
            (None, None) => Motion::Fixed,
        };
        let limits = &described.limits;
        let value = |limit: &Option<At<f64>>| limit.as_ref().map(|limit| limit.value);
        Joint {
            name: self.names.joints[index].clone(),
            parent,
            kind: described.kind.unwrap_or(JointKind::Fixed),
            origin: self.offsets[parent].then(&origin),
            axis: described.axis.unwrap_or([0.0, 0.0, 1.0]),
            motion,
            limits: Limits {
                position: limits.position.as_ref().map(|limit| limit.value),
                velocity: value(&limits.velocity),
                effort: value(&limits.effort),
                peak_effort: value(&limits.peak_effort),
            },
            springs: described.springs.clone().unwrap_or_default(),
            friction: described.friction.clone().unwrap_or_default(),
        }
    }

    fn find_link(&mut self, name: &Name) -> Option<usize> {
        let found = self.tree.index.get(&name.value).copied();
        if found.is_none() {
            self.report.error(
                name.span,
                "unknown-link",
                format!("unknown link `{}`", name.value),
            );
            if let Some(help) = nearest(
                &name.value,
                self.tree.links.iter().map(|link| link.value.as_str()),
            ) {
                self.report.help(help);
            }
        }
        found
    }

    fn attach_bodies(&mut self, links: &mut [Link]) {
        for body in &self.robot.bodies {
            let Some(link) = self.find_link(&body.link) else {
                continue;
            };
            let offset = &self.offsets[link];
            links[link].bodies.push(Body {
                name: body.name.value.clone(),
                mass: body
                    .mass
                    .as_ref()
                    .map_or(Formula::ZERO, |mass| mass.value.clone()),
                center_of_mass: offset.point(&body.center_in_link()),
                inertia: rotate_inertia(&offset.rotation, &body.inertia_in_link()),
            });
        }
    }

    fn frames(&mut self) -> Vec<Frame> {
        let names = self.names.frames.clone();
        let described: Vec<(&FrameDescription, String)> =
            self.robot.frames.iter().zip(names).collect();
        let frame = |(frame, name): (&FrameDescription, String)| {
            let link = self.find_link(&frame.link)?;
            Some(Frame {
                name,
                link,
                pose: self.offsets[link].then(&frame.pose),
            })
        };
        described.into_iter().filter_map(frame).collect()
    }

    /// The inputs in the order of their coordinates, then the motors of held joints.
    fn drives(&mut self, links: &[Link]) -> Vec<Drive> {
        let mut drives: Vec<Drive> = (0..links.len())
            .filter_map(|link| self.drive(link, &links[link]))
            .collect();
        drives.sort_by_key(|drive| drive.coordinate.unwrap_or(usize::MAX));
        drives
    }

    fn drive(&mut self, link: usize, moved: &Link) -> Option<Drive> {
        let index = self.tree.joints[link]?;
        let joint = moved.joint.as_ref()?;
        if joint.motion == Motion::Fixed {
            return None;
        }
        let robot = self.robot;
        let choice = robot.joints[index]
            .drive
            .as_ref()
            .map_or(&robot.default_drive, |drive| &drive.value);
        let coordinate = match joint.motion {
            Motion::Coordinate(coordinate) => Some(coordinate),
            _ => None,
        };
        match choice {
            DriveChoice::Passive => None,
            DriveChoice::Ideal => coordinate.map(|_| ideal_drive(joint, coordinate)),
            DriveChoice::Motor(motor) => self.motor(motor, index, joint, coordinate),
        }
    }

    fn motor(
        &mut self,
        motor: &DriveDescription,
        index: usize,
        joint: &Joint,
        coordinate: Option<usize>,
    ) -> Option<Drive> {
        self.check_motor(motor);
        let carrier = match &motor.carrier {
            Some(name) => self.find_link(name)?,
            None => joint.parent,
        };
        let axis = match motor.axis {
            Some(axis) => rotate_numbers(&self.offsets[carrier].rotation, &axis),
            None if carrier == joint.parent => rotate_numbers(&joint.origin.rotation, &joint.axis),
            None => {
                let span = motor
                    .carrier
                    .as_ref()
                    .map_or(motor.gear_ratio.span, |name| name.span);
                self.report.error(
                    span,
                    "missing-key",
                    "a rotor on another link than the joint's parent needs `axis`",
                );
                self.report
                    .help("`axis` is the rotor's axis in the frame of the link that carries it");
                return None;
            }
        };
        Some(Drive {
            name: self.names.drives[index]
                .clone()
                .unwrap_or_else(|| joint.name.clone()),
            coordinate,
            gear_ratio: motor.gear_ratio.value.clone(),
            rotor_inertia: motor.rotor_inertia.value.clone(),
            carrier,
            axis,
            coupling: motor.coupling,
            input: motor.input.clone(),
            torque: motor.torque,
        })
    }

    fn check_motor(&mut self, motor: &DriveDescription) {
        let value = |formula: &Formula| formula.evaluate(&self.defaults, 0.0, 0.0);
        let ratio = value(&motor.gear_ratio.value);
        if ratio == 0.0 || !ratio.is_finite() {
            self.report.error(
                motor.gear_ratio.span,
                "gear-ratio",
                format!("the gear ratio is {ratio}"),
            );
            self.report
                .help("motor angle over joint angle: finite and not 0");
        }
        let rotor = value(&motor.rotor_inertia.value);
        if !rotor.is_finite() || rotor < 0.0 {
            let message = format!("the rotor inertia is {rotor}");
            self.report
                .error(motor.rotor_inertia.span, "rotor-inertia", message);
            self.report.help("kg m², finite and at least 0");
        }
        if let Input::Current(constant) = &motor.input
            && !(value(constant).is_finite() && value(constant) != 0.0)
        {
            let message = format!("the motor constant is {}", value(constant));
            self.report
                .error(motor.gear_ratio.span, "motor-constant", message);
        }
    }
}

/// A torque or force at the joint itself.
fn ideal_drive(joint: &Joint, coordinate: Option<usize>) -> Drive {
    Drive {
        name: joint.name.clone(),
        coordinate,
        gear_ratio: Formula::ONE,
        rotor_inertia: Formula::ZERO,
        carrier: joint.parent,
        axis: rotate_numbers(&joint.origin.rotation, &joint.axis),
        coupling: RotorCoupling::Diagonal,
        input: Input::Torque,
        torque: MotorTorque::default(),
    }
}
