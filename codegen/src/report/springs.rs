//! Springs and dampers of joints on the page of a robot.

use gelenk_report::{Block, Section, text};

use super::equations;
use super::following::{self, Following};
use super::formula;
use super::robot::Robot;
use crate::model::Joint;

/// Section of the page on springs; `None` without springs.
pub(super) fn section(robot: &Robot<'_>) -> Option<Section> {
    let laws = laws(robot);
    let following: Vec<Following<'_>> =
        Following::all(robot).into_iter().filter(|one| !one.springs.is_empty()).collect();
    if laws.is_empty() && following.is_empty() {
        return None;
    }
    let mut section = Section::new("springs", "Springs and dampers");
    if !laws.is_empty() {
        section = section
            .block(text("Force (or torque) $s_i$ on joint $i$, a part of the applied forces $q$."))
            .block(equations::set(&laws));
    }
    if !following.is_empty() {
        section = section.blocks(following_blocks(robot, &following));
    }
    Some(section)
}

/// Laws of the springs of independent joints, in LaTeX.
fn laws(robot: &Robot<'_>) -> Vec<String> {
    let joints = robot.joints().into_iter().enumerate();
    let sprung = joints.filter(|(_, joint)| !joint.springs.is_empty());
    let law = |(coordinate, joint): (usize, &Joint)| {
        let forces = formula::sum(&joint.springs, &robot.parameter_names, robot.motion(coordinate));
        format!("s_{{{}}} = {forces}", coordinate + 1)
    };
    sprung.map(law).collect()
}

/// Blocks with the spring laws of joints and shafts that follow coordinates.
fn following_blocks(robot: &Robot<'_>, following: &[Following<'_>]) -> Vec<Block> {
    let law = |one: &Following<'_>| {
        let forces = formula::sum(one.springs, &robot.parameter_names, one.motion());
        format!("s_{{z,{}}} = {forces}", one.number)
    };
    let laws: Vec<String> = following.iter().map(law).collect();
    vec![
        Block::Table(following::table(robot, following, "springs")),
        text(
            "The force $s_{z,k}$ of a joint or shaft $k$ is a function of its position $z_k$ and velocity. It adds $\\sum_k \
             s_{z,k} \\, \\partial z_k / \\partial y_i$ to the applied force of coordinate $i$.",
        ),
        equations::set(&laws),
    ]
}
