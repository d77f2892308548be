//! Joints and shafts that follow coordinates and have their own friction or springs, on the page of a robot.

use gelenk_report::{Cell, Table};

use super::formula::Motion;
use super::robot::Robot;
use crate::model::{FollowedCoordinate, FrictionTerm};
use gelenk_formula::Formula;

/// A joint that follows coordinates, or the shaft of a motor that moves several coordinates. The symbol of its
/// position is z.
pub(super) struct Following<'a> {
    name: &'a str,
    what: &'static str,
    /// Followed coordinates with ratios: motion of the joint or shaft per unit of each coordinate's motion.
    follows: Vec<FollowedCoordinate>,
    offset: f64,
    pub(super) friction: &'a [FrictionTerm],
    pub(super) springs: &'a [Formula],
    /// Index of the joint's symbol z on the page, from 1.
    pub(super) number: usize,
}

impl Following<'_> {
    /// Joints that follow coordinates, and shafts of a robot, if they have friction or springs.
    pub(super) fn all<'a>(robot: &Robot<'a>) -> Vec<Following<'a>> {
        let model = robot.model;
        let joints = model.moving_joints().into_iter().skip(model.motion_count()).map(|moving| Following {
            name: &moving.joint.name,
            what: "a joint that follows",
            follows: moving.follows,
            offset: moving.offset,
            friction: &moving.joint.friction,
            springs: &moving.joint.springs,
            number: 0,
        });
        let shafts = model.rubbing_drives().map(|drive| {
            let gear_ratio = robot.value(&drive.gear_ratio);
            let turned = |term: &FollowedCoordinate| FollowedCoordinate {
                coordinate: term.coordinate,
                ratio: Formula::Number(gear_ratio * robot.value(&term.ratio)),
            };
            Following {
                name: &drive.name,
                what: "a motor's shaft",
                follows: drive.acts_on.iter().map(turned).collect(),
                offset: 0.0,
                friction: &drive.friction,
                springs: &[],
                number: 0,
            }
        });
        let all = joints.chain(shafts).filter(|one| !one.friction.is_empty() || !one.springs.is_empty());
        all.zip(1..).map(|(one, number)| Following { number, ..one }).collect()
    }

    pub(super) fn moves_with(&self, coordinate: usize) -> bool {
        self.follows.iter().any(|term| term.coordinate == coordinate)
    }

    /// Symbols of the position and the velocity, for example z₁ and ż₁.
    pub(super) fn motion(&self) -> Motion {
        Motion::numbered('z', self.number)
    }
}

/// Table of the names and positions of joints and shafts that follow coordinates.
///
/// - `what`: `friction` or `springs`
pub(super) fn table(robot: &Robot<'_>, following: &[Following<'_>], what: &str) -> Table {
    let rows = following.iter().map(|one| {
        let motion = robot.followed(&one.follows, one.offset);
        let symbol = [format!("z_{{{}}}", one.number), format!("z{}", one.number)];
        vec![Cell::formula(symbol), Cell::text(one.name), Cell::text(one.what), Cell::formula(motion)]
    });
    let caption = format!("Joints and shafts that follow coordinates and have their own {what}.");
    Table::new(format!("{what}-following"), &caption)
        .column("", "index", "")
        .column("name", "name", "")
        .column("is", "kind", "")
        .column("its position $z$", "position", "")
        .rows(rows)
}
