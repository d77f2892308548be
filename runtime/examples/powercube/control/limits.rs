//! Claim 10: limits of torque and speed are constraints that are reached and kept.

use super::identified::identify;
use super::run::{self, Faster, Run, Setup};
use super::show;
use crate::arm::{self, Arm, Friction, GEAR, JOINTS, PEAK, PERIOD, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LinearizationPoint, MpcOptions};
use gelenk_runtime::trajectory::{Sampled, Trajectory};

/// Factor by which the trajectory is faster than published.
pub const FACTOR: f64 = 1.5;
/// Nominal torque of the modules at the joint [N m].
pub const NOMINAL: f64 = 44.8;
/// Speed limit of the experiment [rad/s]. The published trajectory reaches 0.72 rad/s.
pub const SPEED: f64 = 0.4;
/// Linear penalty of a violated speed limit, per rad/s.
pub const PENALTY: f64 = 1e5;
/// Ratio to a limit above which the limit counts as reached.
const REACHED: f64 = 1.0 - 1e-4;

/// Options with linearization around the plan, because limits keep the plan away from the desired trajectory.
pub fn options(model: &Arm) -> MpcOptions<2, 2> {
    MpcOptions { linearization: LinearizationPoint::Plan, ..run::options(model, PERIOD) }
}

/// Run along the trajectory `factor` times as fast, with at most `torque` [N m] at the joint.
pub fn torque_limited(model: Arm, motion: &Sampled<2>, factor: f64, torque: f64) -> Outcome<Run> {
    let mut options = options(&model);
    let limit = torque / GEAR;
    options.input_limits = [[-limit, limit]; 2];
    track(model, options, &Faster { motion, factor })
}

/// Run along the published trajectory with at most `speed` [rad/s].
pub fn speed_limited(model: Arm, motion: &Sampled<2>, speed: f64, penalty: f64) -> Outcome<Run> {
    let mut options = options(&model);
    options.velocity_limits = [speed; 2];
    // With a small weight, a large following error does not justify a violation of the bound.
    options.position_weight = [1e3; 2];
    options.velocity_weight = [1e2; 2];
    options.limit_penalty.linear = penalty;
    track(model, options, motion)
}

fn track(model: Arm, options: MpcOptions<2, 2>, reference: &impl Trajectory<2>) -> Outcome<Run> {
    let setup = Setup::new(arm([Friction::B, Friction::C]), Regime::IDEAL);
    run::linear(&setup, model, options, reference)
}

fn periods(run: &Run, is_at_limit: impl Fn(&run::Row) -> bool) -> f64 {
    run.rows.iter().filter(|row| is_at_limit(row)).count() as f64
}

pub fn claim(fast: &Run, slow: &Run) -> Claim {
    let at_torque = |row: &run::Row| row.inputs.iter().any(|u| u.abs() >= REACHED * PEAK);
    let at_speed = |row: &run::Row| row.velocities.iter().any(|v| v.abs() >= 0.99 * SPEED);
    let last = fast.rows.last().map_or(f64::NAN, |row| row.error(0).abs().max(row.error(1).abs()));
    let mut claim = Claim::new(
        "claim-10",
        "Limits are constraints of the MPC: peak torque and a speed limit are reached and kept.",
    )
    .criterion(Criterion::at_least("periods at the peak torque", periods(fast, at_torque), 10.0, ""))
    .criterion(Criterion::at_most("largest torque at a joint", fast.largest_torque(), GEAR * PEAK, "N m"))
    .criterion(Criterion::at_most("error at the end of the fast motion", 1e3 * last, 1.0, "mrad"))
    .criterion(Criterion::at_least("periods at the speed limit", periods(slow, at_speed), 10.0, ""))
    .criterion(Criterion::at_most(
        "largest speed of a joint",
        slow.largest_speed(),
        1.01 * SPEED,
        "rad/s",
    ));
    for (joint, friction) in JOINTS.into_iter().zip([Friction::B, Friction::C]) {
        let share = friction.at(rated_speed()) / (GEAR * PEAK);
        claim = claim.criterion(Criterion::at_least(
            format!("friction of {joint} at 25 rpm over the peak torque"),
            share,
            1.0,
            "",
        ));
    }
    claim
        .flipped_by("the trajectory as slow as published: it needs 79.7 N m")
        .remark("The speed bound is soft. Where position errors weigh as much as elsewhere on this page, an arm that lags by 0.8 rad breaks it; here they weigh a tenth.")
        .shown_in("limits-torque")
}

/// Highest rated speed of the modules [rad/s].
fn rated_speed() -> f64 {
    arm([Friction::B, Friction::C]).limits().velocity[0]
}

/// Largest torque of the feed-forward at each joint [N m].
fn needed(motion: &Sampled<2>, factor: f64) -> Outcome<[f64; 2]> {
    let fast = Faster { motion, factor };
    let feed_forward = FeedForward::new(arm([Friction::B, Friction::C]))?;
    let mut largest = [0.0_f64; 2];
    let samples = motion.samples().len();
    for k in 0..samples {
        let time = k as f64 * PERIOD / factor;
        let inputs = feed_forward.at(&fast.sample(time)).inputs;
        for i in 0..2 {
            largest[i] = largest[i].max(GEAR * inputs[i].abs());
        }
    }
    Ok(largest)
}

/// The largest speed factor, to a thousandth, for which both joints stay within `torque` [N m].
fn allowed(motion: &Sampled<2>, torque: f64) -> Outcome<f64> {
    let (mut low, mut high) = (0.01, 4.0);
    while high - low > 1e-3 {
        let middle = 0.5 * (low + high);
        let [beta, gamma] = needed(motion, middle)?;
        if beta.max(gamma) <= torque {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(low)
}

/// Speed [rad/s] at which friction alone needs `torque` [N m], computed by bisection.
fn speed_at(friction: &Friction, torque: f64) -> f64 {
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if friction.at(middle) <= torque {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let reference = arm::reference()?;
    let plant = arm([Friction::B, Friction::C]);
    let model = arm(identify(plant, plant, study.pick(60.0, 30.0))?);
    let fast = torque_limited(model, &reference, FACTOR, GEAR * PEAK)?;
    let nominal = torque_limited(model, &reference, 1.0, NOMINAL)?;
    let slow = speed_limited(model, &reference, SPEED, PENALTY)?;
    let section = Section::new("limits", "10 · Limits as constraints")
        .block(text("The published trajectory run through 1.5 times as fast needs up to 99 N m at β; the motors give 0.5 N m each, 80.5 N m at the joint. The plant has the published friction, the controller what was identified. The nominal torque of the modules, 44.8 N m, allows only a fifth of the published speed; at 25 rpm, their highest speed, friction alone would need 217 and 157 N m."))
        .block(Block::Figure(torques(&fast)))
        .block(Block::Figure(
            Figure::new("limits-errors", "What the peak torque costs 1.5 times as fast, and what the nominal torque of 44.8 N m would cost at the published speed.")
                .plot(show::errors("1.5 times as fast, 80.5 N m", &fast))
                .plot(show::errors("as published, 44.8 N m", &nominal)),
        ))
        .block(Block::Figure(speeds(&slow)))
        .block(Block::Table(torque_table(&reference)?))
        .block(Block::Table(speed_table()))
        .block(Block::Figure(demand(&reference)?));
    Ok(Part { section, claims: vec![claim(&fast, &slow)] })
}

fn torques(fast: &Run) -> Figure {
    let figure = Figure::new(
        "limits-torque",
        "1.5 times as fast as published: torque of the LTV-MPC, which keeps its limit, and the feed-forward, which knows of none.",
    );
    [0, 1].into_iter().fold(figure, |figure, i| {
        figure.plot(show::torques("peak torque as constraint", fast, i).series(
            "limits",
            Marks::Dashed,
            show::limits(fast, GEAR * PEAK),
        ))
    })
}

fn speeds(slow: &Run) -> Figure {
    let figure = Figure::new("limits-speed", "The published trajectory with a speed limit of 0.4 rad/s.");
    [0, 1].into_iter().fold(figure, |figure, i| {
        figure.plot(
            Plot::new(format!("joint {}", JOINTS[i]), show::time(), Axis::new("speed", "rad/s"))
                .series("speed", Marks::Line, slow.points(|row| row.velocities[i]))
                .series("limits", Marks::Dashed, show::limits(slow, SPEED)),
        )
    })
}

fn torque_table(reference: &Sampled<2>) -> Outcome<Table> {
    let mut table = Table::new(
        "limits-allowed",
        "How fast the trajectory can be run through without leaving it, by the feed-forward of the published arm.",
    )
    .column("torque at the joint", "torque", "N m")
    .column("times as fast as published", "factor", "");
    for torque in [NOMINAL, GEAR * PEAK] {
        let factor = Cell::Rounded(allowed(reference, torque)?, 3);
        table = table.row([Cell::Exact(torque), factor]);
    }
    Ok(table)
}

fn speed_table() -> Table {
    const TO_RPM: f64 = 30.0 / std::f64::consts::PI;
    let mut table = Table::new(
        "limits-speeds",
        "Speeds at which friction alone takes the torque, and what 25 rpm would need.",
    )
    .column("joint", "joint", "")
    .column("at 44.8 N m", "at nominal torque", "rpm")
    .column("at 80.5 N m", "at peak torque", "rpm")
    .column("friction at 25 rpm", "friction at 25 rpm", "N m");
    for (joint, friction) in JOINTS.into_iter().zip([Friction::B, Friction::C]) {
        let at = |torque: f64| Cell::Rounded(TO_RPM * speed_at(&friction, torque), 3);
        let full = Cell::Rounded(friction.at(rated_speed()), 4);
        table = table.row([Cell::text(joint), at(NOMINAL), at(GEAR * PEAK), full]);
    }
    table
}

fn demand(reference: &Sampled<2>) -> Outcome<Figure> {
    let factors: Vec<f64> = (1..=40).map(|k| 0.05 * f64::from(k)).collect();
    let mut curves = [Vec::new(), Vec::new()];
    for &factor in &factors {
        let torques = needed(reference, factor)?;
        for (curve, torque) in curves.iter_mut().zip(torques) {
            curve.push([factor, torque]);
        }
    }
    let [beta, gamma] = curves;
    let level = |torque: f64| factors.iter().map(|factor| [*factor, torque]).collect();
    Ok(Figure::new(
        "limits-demand",
        "Largest torque that the feed-forward asks for, over the speed at which the trajectory is run through.",
    )
    .plot(
        Plot::new("", Axis::new("times as fast as published", ""), Axis::new("largest torque", "N m"))
            .series(JOINTS[0], Marks::Line, beta)
            .series(JOINTS[1], Marks::Line, gamma)
            .series("nominal, 44.8 N m", Marks::Dashed, level(NOMINAL))
            .series("peak, 80.5 N m", Marks::Dashed, level(GEAR * PEAK)),
    ))
}
