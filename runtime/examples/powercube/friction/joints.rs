//! Claim 9: equal modules have different friction, and friction increases with the load.

use super::data::{
    MEASURED, Samples, alpha, beta_alone, controller_arm, friction_samples, opposed, periodic, published_arm,
    record,
};
use super::law::{Method, curve, curve_error, true_curve};
use super::plants::{MoreFriction, law_under_load, load};
use crate::arm::{Friction, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_identification::result::FrictionLaw;
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};

/// Speed at which curves are compared [rad/s].
const SPEED: f64 = 0.3;
/// Largest speed of the curves [rad/s].
const FASTEST: f64 = 0.5;
/// Assumed friction per unit of load.
pub const LOAD_SHARE: f64 = 0.1;
const NAMES: [&str; 3] = ["A (α)", "B (β)", "C (γ)"];

/// Identified laws of three joints with this friction, each from a separate record.
pub fn laws([a, b, c]: [Friction; 3], seconds: f64) -> Outcome<[FrictionLaw; 3]> {
    let stand_in = alpha(Friction::OLD);
    let motion = periodic([1.0]);
    let log = record(alpha(a), &stand_in, &motion, seconds, (&MEASURED, 3))?;
    let [alpha] = friction_samples(&log, &stand_in, MEASURED.encoder_step)?;
    let mut laws = vec![Method::Lasso.identify(&alpha)?.result.law];
    for (joint, motion) in [beta_alone(), opposed()].iter().enumerate() {
        let plant = arm([b, c]);
        let log = record(plant, &controller_arm(), motion, seconds, (&MEASURED, 2))?;
        let samples = friction_samples(&log, &published_arm(), MEASURED.encoder_step)?;
        laws.push(Method::Lasso.identify(&samples[joint])?.result.law);
    }
    laws.try_into().map_err(|_| "three joints".into())
}

/// Smallest difference between two of the curves at the speed [`SPEED`] [N m].
fn least_difference(laws: &[FrictionLaw; 3]) -> Outcome<f64> {
    let mut at = Vec::new();
    for law in laws {
        at.extend(law.torques(&[SPEED])?);
    }
    let pairs = [(0, 1), (1, 2), (0, 2)];
    let differences = pairs.map(|(i, j): (usize, usize)| (at[i] - at[j]).abs());
    Ok(differences.into_iter().fold(f64::INFINITY, f64::min))
}

/// Root mean square of the difference between the substitute for the old model and a law [N m].
fn stand_in_error(law: &FrictionLaw) -> Outcome<f64> {
    curve_error(law, |v| Friction::OLD.at(v), FASTEST)
}

/// Claim 9a for identified laws.
pub fn difference_claim(laws: &[FrictionLaw; 3]) -> Outcome<Claim> {
    Ok(Claim::new(
        "claim-9a",
        "The modules are the same, their friction is not.",
    )
    .criterion(Criterion::at_least(
        "least difference between two of the joints at 0.3 rad/s",
        least_difference(laws)?,
        0.5,
        "N m",
    ))
    .flipped_by("the same friction in all three joints of the plant")
    .remark("B and C are as published, A is an estimate: what is measured here is that identification tells them apart.")
    .shown_in("joints"))
}

/// Claim 9b for identified laws.
pub fn stand_in_claim([_, b, c]: &[FrictionLaw; 3]) -> Outcome<Claim> {
    Ok(Claim::new("claim-9b", "One common curve, as in the old model, fits neither B nor C.")
        .criterion(Criterion::at_least("common curve minus B, rms", stand_in_error(b)?, 2.0, "N m"))
        .criterion(Criterion::at_least("common curve minus C, rms", stand_in_error(c)?, 2.0, "N m"))
        .flipped_by("a plant whose friction is that common curve")
        .remark("The old model is not published; 45 v + 9 tanh 10v stands in for it.")
        .shown_in("joints"))
}

/// Friction samples of β and the loads at these samples. The friction of the plant includes `share` times the load. `gravity`
/// scales gravity and is 0 for the isolated module.
pub fn under_load(share: f64, gravity: f64, seconds: f64) -> Outcome<(Samples, Vec<f64>)> {
    let mut robot = published_arm();
    robot.parameters.g *= gravity;
    let mut controller = controller_arm();
    controller.parameters.g *= gravity;
    let plant = MoreFriction { robot, load_share: share, stribeck: [None; 2] };
    let log = record(plant, &controller, &beta_alone(), seconds, (&MEASURED, 4))?;
    let [beta, gamma] = friction_samples(&log, &robot, MEASURED.encoder_step)?;
    let loads = (beta.angles.iter().zip(&gamma.angles))
        .map(|(beta, gamma)| load(&robot, &[*beta, *gamma])[0])
        .collect();
    Ok((beta, loads))
}

/// Claim 9c for samples of the isolated and of the assembled joint.
pub fn load_claim(isolated: &Samples, assembled: &(Samples, Vec<f64>)) -> Outcome<Claim> {
    let (samples, loads) = assembled;
    let torque = |samples| -> Outcome<f64> {
        let law = Method::Lasso.identify(samples)?.result.law;
        let [forward, backward] = [law.torques(&[SPEED])?[0], law.torques(&[-SPEED])?[0]];
        Ok(0.5 * (forward - backward))
    };
    let found = law_under_load(samples, loads)?;
    Ok(Claim::new("claim-9c", "Load raises friction.")
        .criterion(Criterion::at_least(
            "assembled minus isolated at 0.3 rad/s, mean of both directions",
            torque(samples)? - torque(isolated)?,
            0.5,
            "N m",
        ))
        .criterion(Criterion::at_least(
            "share of the load found as friction",
            found.share,
            0.5 * LOAD_SHARE,
            "",
        ))
        .flipped_by("a plant without the load term")
        .remark(format!(
            "The plant's friction holds {LOAD_SHARE} of the torque of gravity, which is assumed; found is {:.3} ± {:.3}.",
            found.share, found.standard_error
        ))
        .shown_in("load"))
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let seconds = study.pick(60.0, 30.0);
    let laws = laws([Friction::A, Friction::B, Friction::C], seconds)?;
    let (isolated, _) = under_load(LOAD_SHARE, 0.0, seconds)?;
    let assembled = under_load(LOAD_SHARE, 1.0, seconds)?;
    let claims = vec![difference_claim(&laws)?, stand_in_claim(&laws)?, load_claim(&isolated, &assembled)?];
    let section = Section::new("friction-of-joints", "Equal modules, different friction, and load")
        .block(text(
            "Each law is identified from a record of its joint (SINDy with LASSO). The old model's curve is a stand-in, \
             $45 \\, v + 9 \\tanh 10 v$ for all joints. For the influence of load the plant's friction gets an additional \
             $0.1 \\, |q_g(y)| \\tanh 20 v$; gravity is taken away for the isolated module, as if its axis stood upright on a bench.",
        ))
        .block(Block::Figure(joints_figure(&laws)?))
        .block(Block::Table(joints_table(&laws)?))
        .block(Block::Figure(load_figure(&isolated, &assembled)?));
    Ok(Part { section, claims })
}

fn joints_figure(laws: &[FrictionLaw; 3]) -> Outcome<Figure> {
    let mut plot = Plot::new("", Axis::new("velocity", "rad/s"), Axis::new("friction torque", "N m"));
    for (name, law) in NAMES.iter().zip(laws) {
        plot = plot.series(*name, Marks::Line, curve(law, FASTEST)?);
    }
    let common = true_curve(|v| Friction::OLD.at(v), FASTEST);
    Ok(Figure::new(
        "joints",
        "Identified friction of the three joints beside the one curve that stands in for the old model.",
    )
    .plot(plot.series("stand-in for the old model", Marks::Dashed, common)))
}

fn joints_table(laws: &[FrictionLaw; 3]) -> Outcome<Table> {
    let mut table =
        Table::new("joints-laws", "The identified laws in numbers; `v` in rad/s, torques in N m.")
            .column("joint", "joint", "")
            .column("at 0.05 rad/s", "slow", "N m")
            .column("at 0.3 rad/s", "medium", "N m")
            .column("at 0.5 rad/s", "fast", "N m")
            .column("common curve minus law, rms", "stand_in", "N m");
    for (name, law) in NAMES.iter().zip(laws) {
        let torques = law.torques(&[0.05, SPEED, FASTEST])?;
        let numbers = torques.into_iter().map(Cell::number);
        table = table.row(
            std::iter::once(Cell::text(*name)).chain(numbers).chain([Cell::number(stand_in_error(law)?)]),
        );
    }
    Ok(table)
}

fn load_figure(isolated: &Samples, (assembled, loads): &(Samples, Vec<f64>)) -> Outcome<Figure> {
    let found = law_under_load(assembled, loads)?;
    let points = found.against_load(assembled, loads, 500);
    let line = vec![[0.0, 0.0], [25.0, 25.0 * found.share]];
    Ok(Figure::new(
        "load",
        "Joint β isolated and assembled. Left: friction samples. Right: what is left of the assembled joint's friction, in the direction of \
         motion, when the law without load is taken off, over the load; faster than 0.05 rad/s.",
    )
    .plot(
        Plot::new("", Axis::new("velocity", "rad/s"), Axis::new("friction torque", "N m"))
            .series("assembled", Marks::Points, assembled.points(500))
            .series("isolated", Marks::Points, isolated.points(500)),
    )
    .plot(
        Plot::new("", Axis::new("load", "N m"), Axis::new("friction due to load", "N m"))
            .series("samples", Marks::Points, points)
            .series("identified", Marks::Line, line),
    ))
}
