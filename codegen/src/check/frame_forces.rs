//! Checks forces between frames, wrenches in frames, and inputs of both kinds, and converts them to the
//! model.

use super::frame_names;
use super::tree::Tree;
use crate::description::{Name, PointForceDescription, RobotDescription};
use crate::diagnostic::{At, Report, nearest};
use crate::model::{Attachment, ForceEffect, ForceInput, PointForce, Pose, Wrench};
use crate::wording::as_written;
use gelenk_formula::Formula;

/// Forces, inputs and wrenches at frames, as parts of the model.
#[derive(Debug, Default)]
pub(super) struct FrameForces {
    pub(super) point_forces: Vec<PointForce>,
    pub(super) inputs: Vec<ForceInput>,
    pub(super) wrenches: Vec<Wrench>,
}

/// Finds frames and links by name, and reports names that do not exist.
pub(super) struct Resolver<'a> {
    pub(super) robot: &'a RobotDescription,
    pub(super) tree: &'a Tree,
    /// Described frame of each link in the frame of the model's link.
    pub(super) offsets: &'a [Pose],
    pub(super) report: &'a mut Report,
}

impl Resolver<'_> {
    /// Converts all forces at frames. Forces with errors are reported and left out.
    pub(super) fn resolve(mut self) -> FrameForces {
        let robot = self.robot;
        let mut found = FrameForces::default();
        for force in &robot.point_forces {
            let Some(between) = self.between(force) else { continue };
            if let Some(law) = &force.law {
                let name = force.name.value.clone();
                found.point_forces.push(PointForce {
                    name,
                    between: between.clone(),
                    law: law.value.clone(),
                });
            }
            if let Some(input) = &force.input {
                let limits = self.limits(&input.name, input.limits.as_ref());
                let name = input.name.value.clone();
                found.inputs.push(ForceInput { name, limits, effect: ForceEffect::Pull(between) });
            }
        }
        for input in &robot.wrench_inputs {
            let limits = self.limits(&input.name, input.limits.as_ref());
            if input.wrench.value.iter().all(Formula::is_zero) {
                let message = format!("the wrench of input `{}` is zero", input.name.value);
                self.report.error(input.wrench.span, "wrench-zero", message);
                self.report
                    .help("give force (N), then moment (N m), per unit of the input: [0, 0, 1, 0, 0, 0.016]");
            }
            let Some(at) = self.moving(&input.frame) else { continue };
            let effect = ForceEffect::Wrench { at, wrench: input.wrench.value.clone() };
            found.inputs.push(ForceInput { name: input.name.value.clone(), limits, effect });
        }
        for wrench in &robot.wrenches {
            let Some(at) = self.moving(&wrench.frame) else { continue };
            found.wrenches.push(Wrench { name: wrench.name.value.clone(), at, axes: wrench.axes });
        }
        found
    }

    /// The frame with this name, or the link if there is no such frame.
    fn attachment(&mut self, name: &Name) -> Option<Attachment> {
        let frame = self.robot.frames.iter().find(|frame| frame.name.value == name.value);
        let (link, pose) = match frame {
            // A frame on an unknown link has its own message.
            Some(frame) => (self.tree.index.get(&frame.link.value).copied()?, frame.pose.clone()),
            None => (self.link(name)?, Pose::identity()),
        };
        Some(Attachment { name: name.value.clone(), link, pose: self.offsets[link].then(&pose) })
    }

    fn link(&mut self, name: &Name) -> Option<usize> {
        let found = self.tree.index.get(&name.value).copied();
        if found.is_none() {
            let message = format!("there is no frame or link `{}`", name.value);
            self.report.error(name.span, "unknown-frame", message);
            let frames = self.robot.frames.iter().map(|frame| frame.name.value.as_str());
            let links = self.robot.described_links(&self.tree.links);
            if let Some(help) = nearest(&name.value, frames.chain(links)) {
                self.report.help(help);
            }
        }
        found
    }

    /// The frame or link with this name. Reports an error if it does not move.
    fn moving(&mut self, name: &Name) -> Option<Attachment> {
        let at = self.attachment(name)?;
        if self.tree.carriers(self.robot)[at.link] == 0 {
            let message = format!("`{}` is fixed to the base, so a force there has no effect", name.value);
            self.report.error(name.span, "force-on-base", message);
            self.report.help("name a frame or link that a joint moves");
            return None;
        }
        Some(at)
    }

    /// Reports an error if a site and a body at different places both have this name. Inputs and wrenches do
    /// not need this check, because their `frame` means the site.
    fn is_clear(&mut self, name: &Name) -> bool {
        let mut sites =
            self.robot.frames.iter().filter(|frame| frame.is_site && frame.name.value == name.value);
        let Some(site) = sites.find(|site| frame_names::is_ambiguous(site, self.tree)) else { return true };
        let message = format!(
            "`{}` is the name of a site on body `{}` and of a body at another place",
            name.value, site.link.value
        );
        self.report.error(name.span, "ambiguous-name", message);
        self.report.help("a force acts between frames or links. Rename the site in the MJCF, or describe a frame at its place");
        false
    }

    fn between(&mut self, force: &PointForceDescription) -> Option<[Attachment; 2]> {
        let [a, b] = &force.between;
        let are_clear = [a, b].map(|name| self.is_clear(name));
        let (first, second) = (self.attachment(a), self.attachment(b));
        if are_clear.contains(&false) {
            return None;
        }
        let (first, second) = (first?, second?);
        let carriers = self.tree.carriers(self.robot);
        if carriers[first.link] == carriers[second.link] {
            let message = format!("`{}` and `{}` do not move relative to each other", a.value, b.value);
            self.report.error(b.span, "force-within-body", message);
            self.report
                .help("a force acts between two bodies: name frames or links with a joint between them");
            return None;
        }
        Some([first, second])
    }

    /// Limits of an input. Reports an error if the range is empty or does not contain 0.
    fn limits(&mut self, name: &Name, limits: Option<&At<[f64; 2]>>) -> Option<[f64; 2]> {
        let At { value: [low, high], span } = limits?;
        if low >= high {
            let message = format!(
                "the limits of input `{}` are [{}, {}], an empty range",
                name.value,
                as_written(*low),
                as_written(*high)
            );
            self.report.error(*span, "limits-reversed", message);
            self.report.help("give the lowest, then the highest value: limits = [0, 8]");
        } else if *low > 0.0 || *high < 0.0 {
            let message = format!("the limits of input `{}` exclude 0", name.value);
            self.report.error(*span, "limits-exclude", message);
            self.report.help("give limits that contain 0, because the runtime commands 0 to stop the robot");
        }
        Some([*low, *high])
    }
}
