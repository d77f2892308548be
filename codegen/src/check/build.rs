//! Builds the model from a checked description.

use super::couplings::Couplings;
use super::dependent_limits::Limited;
use super::frame_forces::{FrameForces, Resolver};
use super::names::{Identifiers, report_duplicates};
use super::tree::Tree;
use super::{driven_joints, quaternion_joints};
use crate::description::{DriveChoice, FrameDescription, JointDescription, Name, RobotDescription};
use crate::diagnostic::{At, Report, nearest};
use crate::model::pose::rotate_inertia;
use crate::model::{
    Body, Follower, Frame, FrictionTerm, Joint, JointKind, Limits, Link, Model, Motion, Pose,
};
use gelenk_formula::Formula;
use std::collections::BTreeMap;

/// Default gravity in m/s², for descriptions without `gravity`.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

pub(super) struct Builder<'d, 'r> {
    pub(super) robot: &'d RobotDescription,
    pub(super) report: &'r mut Report,
    pub(super) identifiers: Identifiers,
    pub(super) defaults: Vec<f64>,
    pub(super) tree: Tree,
    /// Pose of each link's described frame in the link frame of the model. The two frames differ for standard
    /// Denavit–Hartenberg rows.
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
        let limited = Limited {
            robot: self.robot,
            tree: &self.tree,
            coordinates: &all,
            driven: driven.len(),
            defaults: &self.defaults,
        };
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

    /// Returns the links of the independent joints, in the order of the coordinates. The order is, in this
    /// priority:
    ///
    /// - the order of the key `coordinates`
    /// - the order of the tree, if `sort_joints` is set
    /// - the order of the description
    fn coordinates(&mut self) -> Option<Vec<usize>> {
        let mut moving: Vec<(usize, usize)> = Vec::new();
        for (link, joint) in self.tree.joints.iter().enumerate() {
            moving.extend(
                joint.filter(|joint| self.robot.joints[*joint].is_coordinate()).map(|joint| (joint, link)),
            );
        }
        if moving.is_empty() && self.robot.floating_base.is_some() && self.report.has_errors() {
            // The reason why the base cannot float was already reported.
            return None;
        }
        if moving.is_empty() {
            self.report.error(self.robot.name.span, "no-moving-joint", "no joint of the robot moves");
            self.report.help(
                "describe a joint that moves: it must not be fixed, held or driven, and must not follow another joint. Or make \
                 the base floating by `base = { link = \"…\", type = \"floating\" }`, or by `--base floating` for a URDF",
            );
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
                        (true, _) => {
                            format!("`{}` follows other joints, so it is not a coordinate", name.value)
                        }
                        (_, true) => {
                            format!("the motion of `{}` is prescribed, so it is not a coordinate", name.value)
                        }
                        (false, false) => format!("`{}` is not a moving joint", name.value),
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
            self.report.help("add the joint to `coordinates`, or hold it at a position with `held`");
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
                acceleration: value(&limits.acceleration),
                jerk: value(&limits.jerk),
            },
            springs: laws(&described.springs),
            friction: friction.map_or(Vec::new(), |friction| friction.terms.clone()),
            load_friction: self.load_friction(described, motion),
        }
    }

    /// Returns the terms of a joint's load-dependent friction. Reports an error if joints or drives are
    /// coupled, or if the joint has no drive.
    fn load_friction(&mut self, joint: &JointDescription, motion: Motion) -> Vec<FrictionTerm> {
        let Some(load) = joint.friction.as_ref().and_then(|friction| friction.value.load.as_ref()) else {
            return Vec::new();
        };
        let is_coupled =
            self.robot.joints.iter().any(JointDescription::is_follower) || !self.robot.drives.is_empty();
        if is_coupled {
            let message = format!(
                "joint `{}` has load-dependent friction, but joints or drives of the robot are coupled",
                joint.name.value
            );
            self.report.error(load.span, "load-in-couplings", message);
            self.report.help("load-dependent friction requires one input per joint: remove `load`");
        } else if matches!(motion, Motion::Coordinate(_))
            && matches!(self.robot.drive_of(joint), DriveChoice::Passive)
        {
            let message = format!("joint `{}` has load-dependent friction but no drive", joint.name.value);
            self.report.error(load.span, "load-without-input", message);
            self.report.help("describe a drive of the joint, or remove `load`");
        }
        load.value.clone()
    }

    pub(super) fn find_link(&mut self, name: &Name) -> Option<usize> {
        let found = self.tree.index.get(&name.value).copied();
        if found.is_none() {
            self.report.error(name.span, "unknown-link", format!("unknown link `{}`", name.value));
            if let Some(help) = nearest(&name.value, self.robot.described_links(&self.tree.links)) {
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
}

fn laws<T: Clone>(described: &Option<At<Vec<T>>>) -> Vec<T> {
    described.as_ref().map_or(Vec::new(), |laws| laws.value.clone())
}
