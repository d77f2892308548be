//! From a description whose parts are checked to the model.

use super::super::description::{
    DriveChoice, DriveDescription, FrameDescription, JointDescription, Name, RobotDescription,
    SharedDriveDescription,
};
use super::super::pose::{rotate_inertia, rotate_numbers};
use super::super::tree::Tree;
use super::super::{
    Body, Drive, FollowedCoordinate, Follower, Frame, FrictionTerm, Input, Joint, JointKind, Limits, Link,
    Model, Motion, MotorTorque, Pose, RotorCoupling,
};
use super::couplings::Couplings;
use super::dependent_limits::Limited;
use super::driven_joints;
use super::force_laws::check_shaft;
use super::frame_forces::{FrameForces, Resolver};
use super::names::{Identifiers, report_duplicates};
use super::quaternion_joints;
use crate::diagnostic::{At, Report, nearest};
use crate::formula::Formula;
use crate::wording::as_written;
use std::collections::BTreeMap;

/// Gravity where none is described (m/s²).
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

pub(super) struct Builder<'d, 'r> {
    pub(super) robot: &'d RobotDescription,
    pub(super) report: &'r mut Report,
    pub(super) identifiers: Identifiers,
    pub(super) defaults: Vec<f64>,
    pub(super) tree: Tree,
    /// For each link its described frame in the frame of the model's link.
    pub(super) offsets: Vec<Pose>,
}

impl Builder<'_, '_> {
    pub(super) fn build(&mut self) -> Option<Model> {
        let coordinates = self.coordinates()?;
        let quaternion_joints = quaternion_joints::find(self.robot, &self.tree, &coordinates, self.report);
        let driven = driven_joints::links(self.robot, &self.tree);
        let all = [&coordinates[..], &driven].concat();
        let couplings = Couplings::resolve(self.robot, &self.tree, &all, &self.defaults, self.report);
        let followers = couplings.followers(&self.tree);
        let limited =
            Limited { robot: self.robot, tree: &self.tree, coordinates: &all, defaults: &self.defaults };
        limited.check(&followers, self.report);
        let mut links = self.links(&all, &followers);
        self.attach_bodies(&mut links);
        let drives = self.drives(&links, &couplings);
        self.add_shaft_friction(&mut links, &couplings);
        let frames = self.frames();
        let at_frames =
            Resolver { robot: self.robot, tree: &self.tree, offsets: &self.offsets, report: self.report };
        let FrameForces { point_forces, inputs: force_inputs, wrenches } = at_frames.resolve();
        let gravity = self.robot.gravity.clone().unwrap_or(GRAVITY.map(Formula::Number));
        Some(Model {
            name: self.identifiers.module.clone(),
            description: self.robot.description.clone(),
            gravity,
            parameters: self.robot.parameters.iter().map(|parameter| parameter.value.clone()).collect(),
            links,
            coordinates,
            driven,
            quaternion_joints,
            followers,
            drives,
            point_forces,
            force_inputs,
            wrenches,
            frames,
            options: self.robot.options.clone().unwrap_or_default(),
        })
    }

    /// Link indices of the moving joints: as listed, else as described, else in the order of the tree.
    fn coordinates(&mut self) -> Option<Vec<usize>> {
        let mut moving: Vec<(usize, usize)> = Vec::new();
        for (link, joint) in self.tree.joints.iter().enumerate() {
            moving.extend(
                joint.filter(|joint| self.robot.joints[*joint].is_coordinate()).map(|joint| (joint, link)),
            );
        }
        if moving.is_empty() {
            self.report.error(self.robot.name.span, "no-moving-joint", "no joint of the robot moves");
            self.report
                .help("a model needs at least one revolute, continuous or prismatic joint that is not held, not driven and follows no other");
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

    fn listed_coordinates(&mut self, listed: &[Name], moving: &[(usize, usize)]) -> Option<Vec<usize>> {
        let joints = &self.robot.joints;
        let by_name: BTreeMap<&str, usize> =
            moving.iter().map(|(joint, link)| (joints[*joint].name.value.as_str(), *link)).collect();
        let before = self.report.error_count();
        report_duplicates(listed.iter(), "coordinates", self.report);
        let mut result = Vec::new();
        for name in listed {
            match by_name.get(name.value.as_str()) {
                Some(link) => result.push(*link),
                None => {
                    let follows =
                        joints.iter().any(|joint| joint.name.value == name.value && joint.is_follower());
                    let is_driven =
                        joints.iter().any(|joint| joint.name.value == name.value && joint.is_driven());
                    let message = match (follows, is_driven) {
                        (true, _) => format!("`{}` follows other joints, it is no coordinate", name.value),
                        (_, true) => {
                            format!("`{}` is driven: its motion is an argument of its own", name.value)
                        }
                        (false, false) => format!("`{}` is no moving joint", name.value),
                    };
                    self.report.error(name.span, "unknown-joint", message);
                    if let Some(help) = nearest(&name.value, by_name.keys().copied()) {
                        self.report.help(help);
                    }
                }
            }
        }
        for (name, _) in by_name.iter().filter(|(_, link)| !result.contains(link)) {
            let span = listed.first().map_or(self.robot.name.span, |first| first.span);
            self.report.error(
                span,
                "missing-coordinate",
                format!("`coordinates` lacks the moving joint `{name}`"),
            );
            self.report.help("list every moving joint, or hold it");
        }
        (self.report.error_count() == before).then_some(result)
    }

    fn links(&mut self, coordinates: &[usize], followers: &[Follower]) -> Vec<Link> {
        let mut order = vec![None; self.tree.links.len()];
        for (coordinate, link) in coordinates.iter().enumerate() {
            order[*link] = Some(Motion::Coordinate(coordinate));
        }
        for (index, follower) in followers.iter().enumerate() {
            order[follower.link] = Some(Motion::Follower(coordinates.len() + index));
        }
        let mut links = Vec::new();
        for link in 0..self.tree.links.len() {
            let joint =
                self.tree.joints[link].map(|joint| self.joint(joint, self.tree.parents[link], order[link]));
            let described =
                self.tree.joints[link].and_then(|joint| self.robot.joints[joint].link_frame.clone());
            self.offsets.push(described.unwrap_or_else(Pose::identity));
            links.push(Link { name: self.tree.links[link].value.clone(), joint, bodies: Vec::new() });
        }
        links
    }

    fn joint(&mut self, index: usize, parent: usize, motion: Option<Motion>) -> Joint {
        let robot = self.robot;
        let described = &robot.joints[index];
        let origin = described.origin.clone().unwrap_or_else(Pose::identity);
        let motion = match (motion, described.held) {
            (Some(motion), _) => motion,
            (None, Some(position)) => Motion::Held(position),
            (None, None) => Motion::Fixed,
        };
        let limits = &described.limits;
        let friction = described.friction.as_ref().map(|friction| &friction.value);
        let value = |limit: &Option<At<f64>>| limit.as_ref().map(|limit| limit.value);
        Joint {
            name: described.name.value.clone(),
            identifier: self.identifiers.joints[index].clone(),
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
            springs: laws(&described.springs),
            friction: friction.map_or(Vec::new(), |friction| friction.terms.clone()),
            load_friction: self.load_friction(described, motion),
        }
    }

    /// Terms of friction that grow with the load. A joint without an input of its own is refused.
    fn load_friction(&mut self, joint: &JointDescription, motion: Motion) -> Vec<FrictionTerm> {
        let Some(load) = joint.friction.as_ref().and_then(|friction| friction.value.load.as_ref()) else {
            return Vec::new();
        };
        let is_coupled =
            self.robot.joints.iter().any(JointDescription::is_follower) || !self.robot.drives.is_empty();
        if is_coupled {
            let message = format!(
                "joint `{}` has friction that grows with its load, in a robot whose joints or drives are coupled",
                joint.name.value
            );
            self.report.error(load.span, "load-in-couplings", message);
            self.report
                .help("a joint's load is known where every joint has an input of its own: leave `load` out");
        } else if matches!(motion, Motion::Coordinate(_))
            && matches!(self.robot.drive_of(joint), DriveChoice::Passive)
        {
            let message =
                format!("joint `{}` has friction that grows with its load, and no drive", joint.name.value);
            self.report.error(load.span, "load-without-input", message);
            self.report.help(
                "`load` is for joints with an input of their own: describe a drive, or leave `load` out",
            );
        }
        load.value.clone()
    }

    fn find_link(&mut self, name: &Name) -> Option<usize> {
        let found = self.tree.index.get(&name.value).copied();
        if found.is_none() {
            self.report.error(name.span, "unknown-link", format!("unknown link `{}`", name.value));
            if let Some(help) = nearest(&name.value, self.tree.links.iter().map(|link| link.value.as_str())) {
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
                mass: body.mass.as_ref().map_or(Formula::ZERO, |mass| mass.value.clone()),
                center_of_mass: offset.point(&body.center_in_link()),
                inertia: rotate_inertia(&offset.rotation, &body.inertia_in_link()),
            });
        }
    }

    fn frames(&mut self) -> Vec<Frame> {
        let identifiers = self.identifiers.frames.clone();
        let described: Vec<(&FrameDescription, String)> = self.robot.frames.iter().zip(identifiers).collect();
        let frame = |(frame, identifier): (&FrameDescription, String)| {
            let link = self.find_link(&frame.link)?;
            Some(Frame {
                name: frame.name.value.clone(),
                identifier,
                link,
                pose: self.offsets[link].then(&frame.pose),
            })
        };
        described.into_iter().filter_map(frame).collect()
    }

    /// Friction of the shaft of a drive on one coordinate is friction of its joint: with the gear ratio i,
    /// `i τ(i y, i ẏ)`.
    fn add_shaft_friction(&mut self, links: &mut [Link], couplings: &Couplings) {
        let robot = self.robot;
        for (index, drive) in robot.drives.iter().enumerate() {
            let row = couplings.drives.get(index).and_then(Option::as_ref);
            if let Some(row) = row.filter(|row| row.terms.len() == 1) {
                let ratio =
                    Formula::product(drive.motor.gear_ratio.value.clone(), row.terms[0].ratio.clone());
                let moves = |joint: &Joint| joint.motion == Motion::Coordinate(row.terms[0].coordinate);
                let joint =
                    links.iter_mut().filter_map(|link| link.joint.as_mut()).find(|joint| moves(joint));
                add_shaft(joint, &drive.motor, &ratio);
            }
        }
        for (link, index) in self.tree.joints.iter().enumerate() {
            let Some(DriveChoice::Motor(motor)) = index.map(|index| robot.drive_of(&robot.joints[index]))
            else {
                continue;
            };
            add_shaft(links[link].joint.as_mut(), motor, &motor.gear_ratio.value);
        }
    }

    /// The drives of joints in the order of their coordinates, then those that stand apart as they are
    /// described, then the motors of held joints.
    fn drives(&mut self, links: &[Link], couplings: &Couplings) -> Vec<Drive> {
        let mut drives: Vec<Drive> =
            (0..links.len()).filter_map(|link| self.drive(link, &links[link])).collect();
        drives.sort_by_key(|drive| drive.coordinate().unwrap_or(usize::MAX));
        let held = drives.iter().position(|drive| drive.acts_on.is_empty()).unwrap_or(drives.len());
        let shared: Vec<Drive> = (0..self.robot.drives.len())
            .filter_map(|index| self.shared_drive(index, links, couplings))
            .collect();
        drives.splice(held..held, shared);
        drives
    }

    /// A drive that stands apart from joints.
    fn shared_drive(&mut self, index: usize, links: &[Link], couplings: &Couplings) -> Option<Drive> {
        let described = &self.robot.drives[index];
        let row = couplings.drives.get(index)?.as_ref()?;
        driven_joints::check_shared_drive(self.robot, &self.tree, &described.name, row, links, self.report);
        self.check_motor(&described.name.value, &described.motor, None);
        let (acts_on, gear_ratio) = match &row.terms[..] {
            // One number says what gear and weight do together.
            [only] => (
                vec![FollowedCoordinate::itself(only.coordinate)],
                Formula::product(described.motor.gear_ratio.value.clone(), only.ratio.clone()),
            ),
            _ => (row.terms.clone(), described.motor.gear_ratio.value.clone()),
        };
        let (carrier, axis) = self.shared_mounting(described, &acts_on, links)?;
        Some(Drive {
            name: described.name.value.clone(),
            identifier: self.identifiers.shared_drives[index].clone(),
            gear_ratio,
            rotor_inertia: described.motor.rotor_inertia.value.clone(),
            carrier,
            axis,
            friction: match acts_on.len() {
                1 => Vec::new(), // part of the joint's
                _ => described.motor.friction.as_ref().map_or(Vec::new(), |friction| friction.value.clone()),
            },
            acts_on,
            coupling: described.motor.coupling,
            input: described.motor.input.clone(),
            torque: described.motor.torque,
        })
    }

    /// The link that carries the rotor of a drive apart from joints, and its axis there: as described, else as
    /// if it stood at the only joint that it acts on.
    fn shared_mounting(
        &mut self,
        described: &SharedDriveDescription,
        acts_on: &[FollowedCoordinate],
        links: &[Link],
    ) -> Option<(usize, [f64; 3])> {
        let motor = &described.motor;
        if let (Some(name), Some(axis)) = (&motor.carrier, motor.axis) {
            let carrier = self.find_link(name)?;
            return Some((carrier, rotate_numbers(&self.offsets[carrier].rotation, &axis)));
        }
        let only = match acts_on {
            [only] if motor.carrier.is_none() && motor.axis.is_none() => {
                let at = |joint: &&Joint| joint.motion == Motion::Coordinate(only.coordinate);
                links.iter().filter_map(|link| link.joint.as_ref()).find(at)
            }
            _ => None,
        };
        match only {
            Some(joint) => Some((joint.parent, rotate_numbers(&joint.origin.rotation, &joint.axis))),
            None if motor.coupling == RotorCoupling::Diagonal || motor.rotor_inertia.value.is_zero() => {
                Some((0, [0.0, 0.0, 1.0]))
            }
            None => {
                let message =
                    format!("the rotor of drive `{}` needs `carrier` and `axis`", described.name.value);
                self.report.error(described.name.span, "missing-key", message);
                self.report.help(
                    "`carrier` is the link that carries the rotor, `axis` its axis there; `coupling = \"diagonal\"` \
                     takes only what the rotor adds to the motion that the drive acts on",
                );
                None
            }
        }
    }

    fn drive(&mut self, link: usize, moved: &Link) -> Option<Drive> {
        let index = self.tree.joints[link]?;
        let joint = moved.joint.as_ref()?;
        if joint.motion == Motion::Fixed {
            return None;
        }
        if let (Motion::Follower(_), Some(drive)) = (joint.motion, &self.robot.joints[index].drive)
            && !matches!(drive.value, DriveChoice::Passive)
        {
            let message = format!("joint `{}` follows other joints and has a drive", joint.name);
            self.report.error(drive.span, "driven-follower", message);
            self.report.help(
                "a drive acts on coordinates: describe it at the joint that is followed, or by itself with \
                 `[[drives]]` and `on = { … }`",
            );
            return None;
        }
        let robot = self.robot;
        if robot.joints[index].is_driven() {
            // A described drive was refused; the ideal ones of a URDF are no inputs there.
            return None;
        }
        let choice = robot.drive_of(&robot.joints[index]);
        let acts_on = match joint.motion {
            Motion::Coordinate(coordinate) => vec![FollowedCoordinate::itself(coordinate)],
            _ => Vec::new(),
        };
        match choice {
            DriveChoice::Passive => None,
            DriveChoice::Ideal => (!acts_on.is_empty()).then(|| self.ideal_drive(joint, index, acts_on)),
            DriveChoice::Motor(motor) => self.motor(motor, index, joint, acts_on),
        }
    }

    fn motor(
        &mut self,
        motor: &DriveDescription,
        index: usize,
        joint: &Joint,
        acts_on: Vec<FollowedCoordinate>,
    ) -> Option<Drive> {
        self.check_motor(&joint.name, motor, joint.limits.velocity);
        let carrier = match &motor.carrier {
            Some(name) => self.find_link(name)?,
            None => joint.parent,
        };
        let axis = match motor.axis {
            Some(axis) => rotate_numbers(&self.offsets[carrier].rotation, &axis),
            None if carrier == joint.parent => rotate_numbers(&joint.origin.rotation, &joint.axis),
            None => {
                let span = motor.carrier.as_ref().map_or(motor.gear_ratio.span, |name| name.span);
                self.report.error(
                    span,
                    "missing-key",
                    "a rotor on another link than the joint's parent needs `axis`",
                );
                self.report.help("`axis` is the rotor's axis in the frame of the link that carries it");
                return None;
            }
        };
        Some(Drive {
            name: motor.name.as_ref().map_or_else(|| joint.name.clone(), |name| name.value.clone()),
            identifier: self.drive_identifier(index),
            acts_on,
            gear_ratio: motor.gear_ratio.value.clone(),
            rotor_inertia: motor.rotor_inertia.value.clone(),
            carrier,
            axis,
            coupling: motor.coupling,
            input: motor.input.clone(),
            torque: motor.torque,
            friction: Vec::new(), // part of the joint's
        })
    }

    fn check_motor(&mut self, name: &str, motor: &DriveDescription, speed: Option<f64>) {
        let value = |formula: &Formula| formula.evaluate(&self.defaults, 0.0, 0.0);
        let ratio = value(&motor.gear_ratio.value);
        if ratio == 0.0 || !ratio.is_finite() {
            self.report.error(
                motor.gear_ratio.span,
                "gear-ratio",
                format!("the gear ratio is {}", as_written(ratio)),
            );
            self.report.help("motor angle over joint angle: finite and not 0");
        }
        if let Some(friction) = &motor.friction {
            let speed =
                speed.map(|speed| speed * ratio.abs()).filter(|speed| *speed > 0.0 && speed.is_finite());
            check_shaft(name, friction, speed, &self.defaults, self.report);
        }
        let rotor = value(&motor.rotor_inertia.value);
        if !rotor.is_finite() || rotor < 0.0 {
            let message = format!("the rotor inertia is {}", as_written(rotor));
            self.report.error(motor.rotor_inertia.span, "rotor-inertia", message);
            self.report.help("kg m², finite and at least 0");
        }
        if let Input::Current(constant) = &motor.input
            && !(value(constant).is_finite() && value(constant) != 0.0)
        {
            let message = format!("the motor constant is {}", as_written(value(constant)));
            self.report.error(motor.gear_ratio.span, "motor-constant", message);
        }
    }

    /// A torque or force at the joint itself.
    fn ideal_drive(&self, joint: &Joint, index: usize, acts_on: Vec<FollowedCoordinate>) -> Drive {
        Drive {
            name: joint.name.clone(),
            identifier: self.drive_identifier(index),
            acts_on,
            gear_ratio: Formula::ONE,
            rotor_inertia: Formula::ZERO,
            carrier: joint.parent,
            axis: rotate_numbers(&joint.origin.rotation, &joint.axis),
            coupling: RotorCoupling::Diagonal,
            input: Input::Torque,
            torque: MotorTorque::default(),
            friction: Vec::new(),
        }
    }

    fn drive_identifier(&self, joint: usize) -> String {
        self.identifiers.drives[joint].clone().unwrap_or_default()
    }
}

fn add_shaft(joint: Option<&mut Joint>, motor: &DriveDescription, ratio: &Formula) {
    let (Some(joint), Some(friction)) = (joint, &motor.friction) else { return };
    let term = |term: &FrictionTerm| FrictionTerm {
        coefficient: Formula::product(ratio.clone(), term.coefficient.clone()),
        basis: term.basis.geared(ratio),
    };
    joint.friction.extend(friction.value.iter().map(term));
}

fn laws<T: Clone>(described: &Option<At<Vec<T>>>) -> Vec<T> {
    described.as_ref().map_or(Vec::new(), |laws| laws.value.clone())
}
