//! Couplings: joints that follow other joints, and drives that act on several joints. The positions of these
//! joints and of the drives' shafts are `G y + g₀` with the coordinates y, ratios G and offsets g₀.

use super::tree::Tree;
use crate::description::{FollowsDescription, Name, RobotDescription};
use crate::diagnostic::{At, Report, nearest};
use crate::model::{FollowedCoordinate, Follower, FrictionTerm};
use crate::wording::{as_written, list};
use gelenk_formula::{Formula, Function};
use std::collections::BTreeMap;

/// Position of a joint or drive as a weighted sum of coordinates plus an offset.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) terms: Vec<FollowedCoordinate>,
    pub(super) offset: f64,
}

/// A ratio to a coordinate counts as 0 if it is at most this fraction of the sum of the magnitudes of the
/// added products.
const CANCELLED: f64 = 1e-12;
const ADDED_UP: &str =
    "ratios are multiplied along each path of followed joints, and the products of the paths are added";

/// The weighted sum of a joint or drive over coordinates, and the coordinates whose ratios add up to 0.
struct Combined {
    row: Row,
    cancelled: Vec<usize>,
}

/// Positions of all joints and of the drives in `[[drives]]` as weighted sums of coordinates, in the order of
/// the description.
pub(super) struct Couplings {
    /// Position of each joint as a weighted sum of coordinates. It is `None` if the joint is fixed or its
    /// entry has an error.
    joints: Vec<Option<Row>>,
    /// Angle of each drive in `[[drives]]` as a weighted sum of coordinates. It is `None` if the drive's
    /// entry has an error.
    pub(super) drives: Vec<Option<Row>>,
    followers: Vec<usize>,
}

impl Couplings {
    /// Expresses the positions of joints and drives in coordinates, also if a followed joint follows other
    /// joints itself. Reports cycles and wrong ratios.
    ///
    /// - `coordinates`: links of the coordinates
    pub(super) fn resolve(
        robot: &RobotDescription,
        tree: &Tree,
        coordinates: &[usize],
        defaults: &[f64],
        report: &mut Report,
    ) -> Self {
        let rows = vec![Progress::Open; robot.joints.len()];
        let names = vec![""; coordinates.len()];
        let mut resolver = Resolver { robot, by_name: by_name(robot), defaults, report, rows, names };
        for (coordinate, &link) in coordinates.iter().enumerate() {
            if let Some(joint) = tree.joints[link] {
                resolver.names[coordinate] = &robot.joints[joint].name.value;
                let terms = vec![FollowedCoordinate::itself(coordinate)];
                resolver.rows[joint] = Progress::Done(Some(Row { terms, offset: 0.0 }));
            }
        }
        let followers: Vec<usize> =
            (0..robot.joints.len()).filter(|&joint| robot.joints[joint].is_follower()).collect();
        for &joint in &followers {
            resolver.joint(joint);
        }
        let drives = robot.drives.iter().map(|drive| {
            let combined = resolver.combined(&drive.on)?;
            resolver.moving(&drive.name, ["drive", "acts on", "on"], combined)
        });
        let drives: Vec<Option<Row>> = drives.collect();
        let joints: Vec<Option<Row>> = resolver.rows.into_iter().map(Progress::done).collect();
        for (drive, row) in robot.drives.iter().zip(&drives) {
            let friction = drive.motor.friction.as_ref().zip(row.as_ref());
            if let Some((friction, row)) = friction {
                let terms = At::new(friction.value.as_slice(), friction.span);
                note_dry_friction("drive", "acts on", &drive.name, &terms, row, report);
            }
        }
        for &joint in &followers {
            if let Some(row) = &joints[joint] {
                let described = &robot.joints[joint];
                if let Some(friction) = &described.friction {
                    let terms = At::new(friction.value.terms.as_slice(), friction.span);
                    note_dry_friction("joint", "follows", &described.name, &terms, row, report);
                }
            }
        }
        Self { joints, drives, followers }
    }

    /// The joints of the model that follow coordinates, in the order of the description.
    pub(super) fn followers(&self, tree: &Tree) -> Vec<Follower> {
        let follower = |&joint: &usize| {
            let row = self.joints[joint].clone()?;
            let link = tree.joints.iter().position(|other| *other == Some(joint))?;
            Some(Follower { link, follows: row.terms, offset: row.offset })
        };
        self.followers.iter().filter_map(follower).collect()
    }
}

#[derive(Debug, Clone)]
enum Progress {
    Open,
    /// The joints that this joint follows are being resolved. A second visit means a cycle.
    Begun,
    Done(Option<Row>),
}

impl Progress {
    fn done(self) -> Option<Row> {
        match self {
            Self::Done(row) => row,
            Self::Open | Self::Begun => None,
        }
    }
}

struct Resolver<'d, 'r> {
    robot: &'d RobotDescription,
    by_name: BTreeMap<&'d str, usize>,
    defaults: &'d [f64],
    report: &'r mut Report,
    rows: Vec<Progress>,
    /// Names of the coordinates, for messages.
    names: Vec<&'d str>,
}

impl Resolver<'_, '_> {
    /// Expresses the position of a joint in coordinates. The chain of joints that follow each other may be as
    /// long as the description, so a stack replaces recursion.
    fn joint(&mut self, start: usize) {
        let mut stack = vec![start];
        while let Some(&joint) = stack.last() {
            if matches!(self.rows[joint], Progress::Done(_)) {
                stack.pop();
                continue;
            }
            let open = self.open_targets(joint);
            self.rows[joint] = Progress::Begun;
            match open {
                Some(next) if matches!(self.rows[next], Progress::Begun) => {
                    self.report_circle(&stack, next);
                    for joint in stack.drain(..) {
                        self.rows[joint] = Progress::Done(None);
                    }
                }
                Some(next) => stack.push(next),
                None => {
                    let row = self.follower(joint);
                    self.rows[joint] = Progress::Done(row);
                }
            }
        }
    }

    /// The first joint that `joint` follows and whose position is not yet expressed in coordinates.
    fn open_targets(&self, joint: usize) -> Option<usize> {
        let follows = self.robot.joints[joint].follows.iter().flat_map(|follows| &follows.value);
        let mut targets = follows.filter_map(|term| self.find(&term.joint));
        targets.find(|&target| {
            self.robot.joints[target].is_follower() && !matches!(self.rows[target], Progress::Done(_))
        })
    }

    fn find(&self, name: &Name) -> Option<usize> {
        self.by_name.get(name.value.as_str()).copied()
    }

    fn follower(&mut self, joint: usize) -> Option<Row> {
        let described = &self.robot.joints[joint];
        let follows = described.follows.as_ref()?;
        if follows.value.is_empty() {
            // The faulty entry was already reported.
            return None;
        }
        let mut combined = self.combined(&follows.value)?;
        combined.row.offset += described.offset.as_ref().map_or(0.0, |offset| offset.value);
        self.moving(&described.name, ["joint", "follows", "follows"], combined)
    }

    fn report_circle(&mut self, stack: &[usize], closing: usize) {
        let from = stack.iter().position(|&joint| joint == closing).unwrap_or(0);
        let names = stack[from..].iter().chain([&closing]);
        let names: Vec<String> = names.map(|&joint| self.robot.joints[joint].name.quoted()).collect();
        let message = format!("the joints {} follow each other in a cycle", names.join(" → "));
        self.report.error(self.robot.joints[closing].name.span, "follows-circle", message);
        self.report.help("remove `follows` or `<mimic>` of one joint, so that it is a coordinate");
    }

    /// Returns the weighted sum of a joint or drive unless all its ratios cancelled. Reports the coordinates
    /// whose ratios add up to 0.
    fn moving(
        &mut self,
        name: &Name,
        words: [&str; 3],
        Combined { row, cancelled }: Combined,
    ) -> Option<Row> {
        let [what, verb, key] = words;
        let names: Vec<&str> = cancelled.iter().map(|&coordinate| self.names[coordinate]).collect();
        let ways =
            format!("the ratios of all paths from `{key}` to {} add up to 0", list(names.iter().copied()));
        if names.is_empty() {
            return Some(row);
        }
        if row.terms.is_empty() {
            let message = format!("{what} `{}` {verb} nothing that moves: {ways}", name.value);
            self.report.error(name.span, "follows-nothing", message);
            self.report.help(match key {
                "on" => format!("{ADDED_UP}: correct a weight, or remove the drive"),
                _ => format!("{ADDED_UP}: correct a ratio, or hold the joint (`held = …`)"),
            });
        } else {
            let message =
                format!("{what} `{}` does not move with {}: {ways}", name.value, list(names.into_iter()));
            self.report.note(Some(name.span), "follows-cancel", message);
            self.report.help(format!("{ADDED_UP}. Correct a sign if this is not intended"));
        }
        (!row.terms.is_empty()).then_some(row)
    }

    /// The sum of the followed joints' weighted sums, each multiplied by its ratio, with the coordinates
    /// whose ratios cancel.
    fn combined(&mut self, follows: &[FollowsDescription]) -> Option<Combined> {
        let mut row = Row::default();
        let mut sizes = vec![0.0_f64; self.names.len()];
        let mut is_known = true;
        for term in follows {
            match self.scaled(term) {
                Some(part) => {
                    for term in &part.terms {
                        sizes[term.coordinate] += term.ratio.evaluate(self.defaults, 0.0, 0.0).abs();
                    }
                    add(&mut row, part);
                }
                None => is_known = false,
            }
        }
        let is_cancelled = |term: &FollowedCoordinate| {
            let rest = |ratio: f64| ratio.abs() <= CANCELLED * sizes[term.coordinate];
            term.ratio.as_number().is_some_and(rest)
        };
        let cancelled =
            row.terms.iter().filter(|term| is_cancelled(term)).map(|term| term.coordinate).collect();
        row.terms.retain(|term| !is_cancelled(term));
        row.terms.sort_by_key(|term| term.coordinate);
        is_known.then_some(Combined { row, cancelled })
    }

    /// The weighted sum of one followed joint, multiplied by the ratio.
    fn scaled(&mut self, term: &FollowsDescription) -> Option<Row> {
        let row = self.target(&term.joint)?;
        let (ratio, value) = (&term.ratio.value, term.ratio.value.evaluate(self.defaults, 0.0, 0.0));
        if value == 0.0 || !value.is_finite() {
            let message =
                format!("the ratio to joint `{}` must not be {}", term.joint.value, as_written(value));
            self.report.error(term.ratio.span, "follows-ratio", message);
            self.report.help("the ratio is joint motion per unit motion of the followed joint. It must be finite and non-zero");
            return None;
        }
        if row.offset != 0.0 && ratio.as_number().is_none() {
            let message = format!(
                "the ratio to joint `{}`, which has an offset or is held, is a free parameter",
                term.joint.value
            );
            self.report.error(term.ratio.span, "free-offset", message);
            self.report.help("offsets are constants of the generated code: give the ratio as a number");
            return None;
        }
        let terms = row.terms.iter().map(|other| FollowedCoordinate {
            coordinate: other.coordinate,
            ratio: Formula::product(ratio.clone(), other.ratio.clone()),
        });
        Some(Row { terms: terms.collect(), offset: value * row.offset })
    }

    /// The weighted sum of coordinates for the joint with this name.
    fn target(&mut self, name: &Name) -> Option<Row> {
        let Some(index) = self.find(name) else {
            self.report.error(name.span, "unknown-joint", format!("unknown joint `{}`", name.value));
            let joints = self.robot.joints.iter().filter(|joint| joint.moves());
            if let Some(help) = nearest(&name.value, joints.map(|joint| joint.name.value.as_str())) {
                self.report.help(help);
            }
            return None;
        };
        let joint = &self.robot.joints[index];
        match (&self.rows[index], joint.held) {
            (Progress::Done(row), _) => row.clone(),
            (_, Some(position)) => Some(Row { terms: Vec::new(), offset: position }),
            _ => {
                let message = format!("joint `{}` is fixed, so no joint can follow it", name.value);
                self.report.error(name.span, "follows-fixed", message);
                self.report.help("follow a joint that moves, or replace `follows` by `held`");
                None
            }
        }
    }
}

/// Indices of the joints by name. Duplicate names are reported elsewhere.
fn by_name(robot: &RobotDescription) -> BTreeMap<&str, usize> {
    robot.joints.iter().enumerate().map(|(index, joint)| (joint.name.value.as_str(), index)).collect()
}

fn add(sum: &mut Row, row: Row) {
    sum.offset += row.offset;
    for term in row.terms {
        match sum.terms.iter_mut().find(|known| known.coordinate == term.coordinate) {
            Some(known) => known.ratio = Formula::sum(known.ratio.clone(), term.ratio),
            None => sum.terms.push(term),
        }
    }
}

/// Adds a note about dry friction of a joint or drive that follows several coordinates. The runtime's plant
/// lets only single joints stick, so it rejects the robot.
fn note_dry_friction(
    what: &str,
    verb: &str,
    name: &Name,
    friction: &At<&[FrictionTerm]>,
    row: &Row,
    report: &mut Report,
) {
    if row.terms.len() > 1 && friction.value.iter().any(|term| term.basis.calls(Function::Sign)) {
        let message = format!("{what} `{}` {verb} several coordinates and has dry friction", name.value);
        report.note(Some(friction.span), "dry-follower", message);
        report.help(
            "the runtime's plant rejects this robot, because the plant cannot simulate sticking of a sum of coordinates. Give the \
             friction a `slope`, or use `--smooth-sign`",
        );
    }
}
