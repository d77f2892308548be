//! Drives of a model, and the friction of their shafts.

use super::build::Builder;
use super::couplings::Couplings;
use super::driven_joints;
use super::force_laws::check_shaft;
use crate::description::{DriveChoice, DriveDescription, SharedDriveDescription};
use crate::model::pose::rotate_numbers;
use crate::model::{
    Drive, FollowedCoordinate, FrictionTerm, Input, Joint, Link, Motion, MotorTorque, RotorCoupling,
};
use crate::wording::as_written;
use gelenk_formula::Formula;

impl Builder<'_, '_> {
    /// Adds the shaft friction of each drive with one coordinate to the friction of the coordinate's joint:
    /// `i τ(i y, i ẏ)` with the gear ratio i and the shaft's friction law τ.
    pub(super) fn add_shaft_friction(&mut self, links: &mut [Link], couplings: &Couplings) {
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

    /// Returns all drives of the model in this order:
    ///
    /// 1. drives of joints, in the order of their coordinates
    /// 2. drives in `[[drives]]`, in the order of the description, but those that act only on held joints
    ///    last
    /// 3. motors of held joints
    pub(super) fn drives(&mut self, links: &[Link], couplings: &Couplings) -> Vec<Drive> {
        let mut drives: Vec<Drive> =
            (0..links.len()).filter_map(|link| self.drive(link, &links[link])).collect();
        drives.sort_by_key(|drive| drive.coordinate().unwrap_or(usize::MAX));
        let held = drives.iter().position(|drive| drive.acts_on.is_empty()).unwrap_or(drives.len());
        let mut shared: Vec<Drive> = (0..self.robot.drives.len())
            .filter_map(|index| self.shared_drive(index, links, couplings))
            .collect();
        shared.sort_by_key(|drive| drive.acts_on.is_empty());
        drives.splice(held..held, shared);
        drives
    }

    /// The model's drive for an entry of `[[drives]]`.
    fn shared_drive(&mut self, index: usize, links: &[Link], couplings: &Couplings) -> Option<Drive> {
        let described = &self.robot.drives[index];
        let row = couplings.drives.get(index)?.as_ref()?;
        if !row.terms.is_empty() {
            driven_joints::check_shared_drive(
                self.robot,
                &self.tree,
                &described.name,
                row,
                links,
                self.report,
            );
        }
        self.check_motor(&described.name.value, &described.motor, None);
        let (acts_on, gear_ratio) = match &row.terms[..] {
            // One number combines the gear ratio and the weight.
            [only] => (
                vec![FollowedCoordinate::itself(only.coordinate)],
                Formula::product(described.motor.gear_ratio.value.clone(), only.ratio.clone()),
            ),
            _ => (row.terms.clone(), described.motor.gear_ratio.value.clone()),
        };
        let (carrier, axis) = self.shared_mounting(described, &acts_on, links)?;
        Some(Drive {
            stands_apart: true,
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
            speed: described.motor.speed.as_ref().map(|speed| speed.value),
            line: described.motor.line.as_ref().map(|line| line.value),
        })
    }

    /// The link that carries the rotor of a drive under `[[drives]]`, and the rotor's axis in the frame of
    /// this link. Both are taken from the description, or from the joint if the drive acts on only one.
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
        let is_placed = motor.carrier.is_some() || motor.axis.is_some();
        let mut joints = links.iter().filter_map(|link| link.joint.as_ref()).filter(|_| !is_placed);
        let only = match (acts_on, &described.on[..]) {
            ([only], _) => joints.find(|joint| joint.motion == Motion::Coordinate(only.coordinate)),
            ([], [held]) => joints.find(|joint| joint.name == held.joint.value),
            _ => None,
        };
        match only {
            Some(joint) => Some((joint.parent, rotate_numbers(&joint.origin.rotation, &joint.axis))),
            None if motor.coupling == RotorCoupling::Diagonal || motor.rotor_inertia.value.is_zero() => {
                Some((0, [0.0, 0.0, 1.0]))
            }
            None => {
                let missing = match (&motor.carrier, motor.axis) {
                    (Some(_), None) => "`axis`",
                    (None, Some(_)) => "`carrier`",
                    _ => "`carrier` and `axis`",
                };
                let message = format!("the rotor of drive `{}` needs {missing}", described.name.value);
                self.report.error(described.name.span, "missing-key", message);
                self.report.help(
                    "`carrier` is the link that carries the rotor, and `axis` is the rotor's axis in the frame of this link. \
                     `coupling = \"diagonal\"` uses only the rotor's inertia along the motion of the drive",
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
            let message = format!("joint `{}` follows other joints, so it cannot have a drive", joint.name);
            self.report.error(drive.span, "driven-follower", message);
            self.report.help(
                "a drive cannot act on a follower. Describe it at the followed joint, or with `[[drives]]` and `on = { … }`",
            );
            return None;
        }
        let robot = self.robot;
        if robot.joints[index].is_driven() {
            // A described drive was already rejected. The ideal drives of a URDF are not inputs of driven joints.
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
                    "a rotor that is not on the joint's parent link needs `axis`",
                );
                self.report.help("`axis` is the rotor's axis in the frame of its carrier link");
                return None;
            }
        };
        Some(Drive {
            stands_apart: false,
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
            speed: motor.speed.as_ref().map(|speed| speed.value),
            line: motor.line.as_ref().map(|line| line.value),
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
                format!("the gear ratio of drive `{name}` is {}", as_written(ratio)),
            );
            self.report
                .help("the gear ratio is motor angle divided by joint angle. It must be finite and non-zero");
        }
        if let Some(friction) = &motor.friction {
            let speed =
                speed.map(|speed| speed * ratio.abs()).filter(|speed| *speed > 0.0 && speed.is_finite());
            check_shaft(name, friction, speed, &self.defaults, self.report);
        }
        let rotor = value(&motor.rotor_inertia.value);
        if !rotor.is_finite() || rotor < 0.0 {
            let message = format!("the rotor inertia of drive `{name}` is {}", as_written(rotor));
            self.report.error(motor.rotor_inertia.span, "rotor-inertia", message);
            self.report.help("the rotor inertia must be finite and at least 0, in kg m²");
        }
        let Input::Current(constant) = &motor.input else { return };
        let constant = value(constant);
        let message = format!("the motor constant of drive `{name}` is {}", as_written(constant));
        if !constant.is_finite() || constant == 0.0 {
            self.report.error(motor.input_span, "motor-constant", message);
            self.report.help(
                "the motor constant is motor torque per current. It must be finite and non-zero, in N m/A",
            );
        } else if constant < 0.0 {
            let message = format!("{message}: a positive current turns the motor backwards");
            self.report.warning(motor.input_span, "motor-constant", message);
            self.report.help(
                "give a positive constant. If the joint turns against its motor, use a negative `gear_ratio`",
            );
        }
    }

    /// Returns a drive without motor, whose input is the torque or force at the joint.
    fn ideal_drive(&self, joint: &Joint, index: usize, acts_on: Vec<FollowedCoordinate>) -> Drive {
        Drive {
            stands_apart: false,
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
            speed: None,
            line: None,
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
