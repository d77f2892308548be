//! Friction laws and friction curves on the page of a robot.

use gelenk_report::{Axis, Block, Figure, Marks, Plot, ReportError, Section, text};

use super::equations;
use super::following::{self, Following};
use super::formula::{self, Motion};
use super::robot::Robot;
use crate::model::{FrictionTerm, Joint, JointKind};
use gelenk_formula::Formula;

/// Largest number of joints in a friction plot.
const CURVES: usize = 6;

/// Section of the page on friction; `None` without friction.
pub(super) fn section(robot: &Robot<'_>) -> Result<Option<Section>, ReportError> {
    let laws = friction_laws(robot);
    let following: Vec<Following<'_>> =
        Following::all(robot).into_iter().filter(|one| !one.friction.is_empty()).collect();
    if laws.is_empty() && following.is_empty() && !robot.has_load_friction() {
        return Ok(None);
    }
    let mut section = Section::new("friction", "Friction").block(text(
        "The friction torque (or force) at a joint is positive for positive velocity. It is subtracted from the applied forces.",
    ));
    if !laws.is_empty() {
        section = section.block(equations::set(&laws));
    }
    if !following.is_empty() {
        section = section.blocks(following_blocks(robot, &following));
    }
    if robot.has_load_friction() {
        section = section
            .block(text(
                "Load-dependent friction adds $|\\tau_l| \\, \\sigma(y, \\dot y)$ to these laws. The load $\\tau_l$ is the \
                 drive's force without friction (Hamon, Gautier and Garrec 2010).",
            ))
            .block(equations::set(&load_friction_laws(robot)));
    }
    if let Some(figure) = friction_figure(robot, &following) {
        section = section.block(Block::Figure(figure));
    }
    Ok(Some(section))
}

/// Blocks with the friction laws of joints and shafts that follow coordinates.
fn following_blocks(robot: &Robot<'_>, following: &[Following<'_>]) -> Vec<Block> {
    let laws = following
        .iter()
        .map(|one| law(robot, &format!("\\tau_{{z,{}}}", one.number), one.motion(), one.friction));
    let laws: Vec<String> = laws.collect();
    vec![
        Block::Table(following::table(robot, following, "friction")),
        text(
            "The friction $\\tau_{z,k}$ of a joint or shaft $k$ is a function of its position $z_k$ and velocity. It adds \
             $\\sum_k \\tau_{z,k} \\, \\partial z_k / \\partial y_i$ to the friction of coordinate $i$.",
        ),
        equations::set(&laws),
    ]
}

/// Friction laws of the joints with friction, in LaTeX.
pub(super) fn friction_laws(robot: &Robot<'_>) -> Vec<String> {
    let joints = robot.joints().into_iter().enumerate();
    let rubbing = joints.filter(|(_, joint)| !joint.friction.is_empty());
    rubbing
        .map(|(index, joint)| {
            law(robot, &format!("\\tau_{{{}}}", index + 1), robot.motion(index), &joint.friction)
        })
        .collect()
}

/// Friction per unit of load, in LaTeX, for the joints with load-dependent friction.
fn load_friction_laws(robot: &Robot<'_>) -> Vec<String> {
    let joints = robot.joints().into_iter().enumerate();
    let loaded = joints.filter(|(_, joint)| !joint.load_friction.is_empty());
    loaded
        .map(|(index, joint)| {
            law(robot, &format!("\\sigma_{{{}}}", index + 1), robot.motion(index), &joint.load_friction)
        })
        .collect()
}

fn law(robot: &Robot<'_>, name: &str, motion: Motion, terms: &[FrictionTerm]) -> String {
    let print = |part: &Formula| formula::latex(part, &robot.parameter_names, motion);
    let bracketed = |part: &Formula| formula::factor(part, &robot.parameter_names, motion);
    let term = |term: &FrictionTerm| match (term.coefficient.as_number(), term.basis.as_number()) {
        (Some(1.0), _) => print(&term.basis),
        (_, Some(1.0)) => print(&term.coefficient),
        _ => format!("{} \\, {}", bracketed(&term.coefficient), bracketed(&term.basis)),
    };
    let terms: Vec<String> = terms.iter().map(term).collect();
    format!("{name} = {}", terms.join(" + "))
}

const CAPTION: &str = "Friction over velocity up to the velocity limit (1 rad/s or m/s without a limit), with the other \
                       joints at rest. Friction that depends on the position is drawn at both position \
                       limits and at their mean.";

/// Plots of friction over velocity, computed by the generated function.
pub(super) fn friction_figure(robot: &Robot<'_>, following: &[Following<'_>]) -> Option<Figure> {
    let joints = robot.joints().into_iter().enumerate();
    let drags = |index: usize| following.iter().any(|one| one.moves_with(index));
    let rubbing = joints.filter(|(index, joint)| !joint.friction.is_empty() || drags(*index));
    let rubbing: Vec<(usize, &Joint)> = rubbing.collect();
    let mut caption = CAPTION.to_owned();
    if !following.is_empty() {
        caption += " Curves include the friction of followers and of motor shafts.";
    }
    if robot.has_load_friction() {
        caption += " Load-dependent friction is not drawn.";
    }
    let mut figure = Figure::new("friction-curves", &caption);
    for prismatic in [false, true] {
        let of_kind: Vec<&(usize, &Joint)> =
            rubbing.iter().filter(|(_, joint)| (joint.kind == JointKind::Prismatic) == prismatic).collect();
        for group in of_kind.chunks(CURVES) {
            figure = figure.plot(friction_plot(robot, group, following, prismatic)?);
        }
    }
    (!figure.plots.is_empty()).then_some(figure)
}

fn friction_plot(
    robot: &Robot<'_>,
    joints: &[&(usize, &Joint)],
    following: &[Following<'_>],
    prismatic: bool,
) -> Option<Plot> {
    let (velocity, force) = if prismatic {
        (Axis::new("velocity", "m/s"), Axis::new("friction force", "N"))
    } else {
        (Axis::new("velocity", "rad/s"), Axis::new("friction torque", "N m"))
    };
    let mut plot = Plot::new("", velocity, force);
    for (index, joint) in joints {
        for (name, position) in friction_positions(joint, *index, following) {
            let points = friction_curve(robot, *index, joint, position)?;
            plot = plot.series(name, Marks::Line, points);
        }
    }
    Some(plot)
}

/// Positions at which the friction of a joint is drawn, with the names of the curves. If the law depends on
/// the position, these are both limits and their mean (−1, 0 and 1 without limits), otherwise only 0.
fn friction_positions(joint: &Joint, index: usize, following: &[Following<'_>]) -> Vec<(String, f64)> {
    let added = following.iter().filter(|one| one.moves_with(index)).flat_map(|one| one.friction);
    if !joint.friction.iter().chain(added).any(|term| term.basis.depends_on_position()) {
        return vec![(joint.name.clone(), 0.0)];
    }
    let [low, high] = joint.limits.position.unwrap_or([-1.0, 1.0]);
    let named = |position: f64| (format!("{} at y = {position:.3}", joint.name), position);
    [low, 0.5 * (low + high), high].map(named).to_vec()
}

/// Points of a friction curve. Velocities are closer together around 0, because friction laws are steep
/// there.
fn friction_curve(robot: &Robot<'_>, index: usize, joint: &Joint, position: f64) -> Option<Vec<[f64; 2]>> {
    const HALF: i32 = 200;
    let most = joint.limits.velocity.unwrap_or(1.0);
    let point = |k: i32| {
        let part = f64::from(k) / f64::from(HALF);
        let mut velocities = vec![0.0; robot.n()];
        *velocities.get_mut(index)? = most * part * part * part;
        let velocity = *velocities.get(index)?;
        let mut positions = vec![0.0; robot.n()];
        *positions.get_mut(index)? = position;
        let torques = robot.friction_torques(&robot.model.positions_by(&positions), &velocities)?;
        Some([velocity, *torques.get(index)?])
    };
    (-HALF..=HALF).map(point).collect()
}
