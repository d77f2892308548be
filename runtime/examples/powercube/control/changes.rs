//! Claims 13 and 14: gears that warm up, and a load that is picked up.

use super::adaptation::{options, with_factors};
use super::identified::identify;
use super::run::{Ltv, Modelled, Run, Setup, drive};
use super::show;
use crate::arm::{self, Arm, Friction, JOINTS, PERIOD, Regime, arm, carrying};
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::adaptation::{AdaptationSettings, Adaptive, Carrying, LearnedFriction};
use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::LtvMpc;
use gelenk_runtime::trajectory::{Sample, Sampled, Trajectory};

/// Time in which the gears warm up (s).
pub const WARM: f64 = 300.0;
/// Viscous friction of warm gears over that of cold gears.
const WARM_FACTOR: f64 = 0.7;
/// Time at which the arm picks up its load (s).
const PICKED_UP: f64 = 30.0;
/// Mass of the load [kg].
const MASS: f64 = 1.0;
/// Largest mass of a load that the estimator expects [kg].
pub const HEAVIEST: f64 = 2.0;
/// Time in which the estimate of the load must follow (s), as in claim 12.
const SETTLED: f64 = 6.0;
/// Largest error of the feed-forward, relative to that of a controller that knows the plant.
const BOUND: f64 = 1.3;
/// Encoders of 0.1 mrad, and 0.3 N m of noise at the joints.
const REGIME: Regime = Regime { encoder_step: 1e-4, torque_noise: 2e-3, ..Regime::IDEAL };
/// Speed at which friction is shown [rad/s].
const SHOWN: f64 = 0.35;
/// Friction laws of β and γ with cold gears.
const COLD: [Friction; 2] = [Friction::B, Friction::C];

/// The published motion, repeated forwards and backwards.
#[derive(Clone, Copy)]
pub struct Repeated<'t> {
    motion: &'t Sampled<2>,
    duration: f64,
}

impl Trajectory<2> for Repeated<'_> {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn sample(&self, t: f64) -> Sample<2> {
        let length = self.motion.duration();
        let phase = t.rem_euclid(2.0 * length);
        if phase <= length {
            return self.motion.sample(phase);
        }
        let forth = self.motion.sample(2.0 * length - phase);
        Sample { velocities: forth.velocities.map(|v| -v), ..forth }
    }
}

/// Function that returns the plant at a time (s).
pub type Change = fn(f64) -> Arm;

/// The plant while viscous friction falls by 30 % in five minutes.
pub fn warming(time: f64) -> Arm {
    let viscous = 1.0 + (WARM_FACTOR - 1.0) * (time / WARM).min(1.0);
    arm(COLD.map(|friction| with_factors(&friction, [viscous, 1.0])))
}

/// The plant that picks up its load.
pub fn picking_up(time: f64) -> Arm {
    carrying(arm(COLD), if time < PICKED_UP - 0.5 * PERIOD { 0.0 } else { MASS })
}

/// A plant that does not change.
#[cfg(test)]
pub fn unchanged(_: f64) -> Arm {
    arm(COLD)
}

type Model = LearnedFriction<Arm, 2, 2>;
type Learning<T> = Adaptive<LtvMpc<Model, T, 2, 2, 4>, Arm, 2, 2>;

impl<T: Trajectory<2>> Modelled for Learning<T> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        self.inner().forward(sample)
    }
}

impl<T: Trajectory<2>> Modelled for Carrying<LtvMpc<Model, T, 2, 2, 4>, Arm, 2, 2, 1> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        self.adaptive().forward(sample)
    }
}

/// LTV-MPC whose model is the true plant in each period.
struct Knowing<T> {
    controller: Ltv<T>,
    plant: Change,
}

impl<T: Trajectory<2>> Controller<2, 2> for Knowing<T> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        self.controller.set_model((self.plant)(cycle.time)).map_err(|_| ControllerFault::NotFinite)?;
        self.controller.step(cycle)
    }
}

impl<T: Trajectory<2>> Modelled for Knowing<T> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        self.controller.forward(sample)
    }
}

/// A learning controller that records a quantity of its model in each period.
struct Watched<C, const Q: usize> {
    controller: C,
    quantity: fn(&C) -> [f64; Q],
    values: Vec<[f64; Q]>,
}

impl<C: Controller<2, 2>, const Q: usize> Controller<2, 2> for Watched<C, Q> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let command = self.controller.step(cycle);
        self.values.push((self.quantity)(&self.controller));
        command
    }
}

impl<C: Modelled, const Q: usize> Modelled for Watched<C, Q> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        self.controller.forward(sample)
    }
}

/// Runs of three controllers on one plant.
pub struct Compared<const Q: usize> {
    learning: Run,
    fixed: Run,
    knowing: Run,
    /// Learned quantity in each period.
    values: Vec<[f64; Q]>,
    /// Described friction.
    initial: [Friction; 2],
}

impl<const Q: usize> Compared<Q> {
    fn new<C: Modelled>(
        plant: Change,
        initial: [Friction; 2],
        reference: Repeated<'_>,
        (controller, quantity): (C, fn(&C) -> [f64; Q]),
    ) -> Outcome<Self> {
        let setup = Setup { change: Some(plant), ..Setup::new(plant(0.0), REGIME) };
        let mut learning = Watched { controller, quantity, values: Vec::new() };
        let mut fixed = mpc(arm(initial), reference)?;
        let mut knowing = Knowing { controller: mpc(plant(0.0), reference)?, plant };
        Ok(Self {
            learning: drive(&setup, &mut learning, &reference)?,
            fixed: drive(&setup, &mut fixed, &reference)?,
            knowing: drive(&setup, &mut knowing, &reference)?,
            values: learning.values,
            initial,
        })
    }

    /// Errors of the feed-forward of a joint from a time on [N m], for the learning controller, the controller with a fixed model
    /// and the controller that knows the plant.
    fn errors(&self, i: usize, from: f64) -> [f64; 3] {
        [&self.learning, &self.fixed, &self.knowing].map(|run| run.between(from, f64::INFINITY).gap(i))
    }

    /// Adds the criteria of both joints. The learned model must be within the bound, and the static model beyond the bound.
    fn criteria(&self, claim: Claim, from: f64) -> Claim {
        JOINTS.into_iter().enumerate().fold(claim, |claim, (i, joint)| {
            let [learning, fixed, knowing] = self.errors(i, from);
            let name = |model: &str| format!("feed-forward error of {joint}, {model} over known plant");
            claim
                .criterion(Criterion::at_most(name("learned"), learning / knowing, BOUND, ""))
                .criterion(Criterion::at_least(name("static"), fixed / knowing, BOUND, ""))
        })
    }

    fn rows(&self, table: Table, span: &str, from: f64) -> Table {
        let names = ["learned", "static", "known plant"].into_iter().enumerate();
        names.fold(table, |table, (k, name)| {
            let errors = [0, 1].map(|i| Cell::Rounded(self.errors(i, from)[k], 3));
            table.row([Cell::text(name), Cell::text(span)].into_iter().chain(errors))
        })
    }

    fn points(&self, of: impl Fn(&[f64; Q]) -> f64) -> Vec<[f64; 2]> {
        let points = self.learning.rows.iter().zip(&self.values).map(|(row, value)| [row.time, of(value)]);
        points.step_by(10).collect()
    }
}

fn mpc<T: Trajectory<2>>(model: Arm, reference: T) -> Outcome<Ltv<T>> {
    Ok(Ltv::new(model, reference, options(&model))?)
}

fn learning(
    initial: [Friction; 2],
    reference: Repeated<'_>,
    settings: AdaptationSettings,
) -> Outcome<Learning<Repeated<'_>>> {
    let robot = arm(initial);
    Ok(Adaptive::new(robot, settings, |model| LtvMpc::new(model, reference, options(&robot)))??)
}

/// Friction of both joints at the speed [`SHOWN`].
fn friction(robot: &impl Dynamics<2, 2>) -> [f64; 2] {
    robot.friction_torques(&[0.0; 2], &[SHOWN; 2])
}

/// Runs the experiment with gears that warm up. Values are the learned friction of both joints at the speed [`SHOWN`], and half of
/// its 90 % intervals.
///
/// - `seconds`: duration of the run
/// - `duration`: duration of the motion with which friction is identified before (s)
pub fn warm_up(
    motion: &Sampled<2>,
    (plant, settings, seconds): (Change, AdaptationSettings, f64),
    duration: f64,
) -> Outcome<Compared<4>> {
    let initial = identify(arm(COLD), arm(COLD), duration)?;
    let reference = Repeated { motion, duration: seconds };
    let controller = learning(initial, reference, settings)?;
    let quantity: fn(&Learning<Repeated<'_>>) -> [f64; 4] = |controller| {
        let learned = controller.learned(&[0.0; 2], &[SHOWN; 2]);
        let [beta, gamma] = learned.map(|joint| joint.map_or([f64::NAN; 2], |joint| joint.friction));
        [beta[0], gamma[0], beta[1], gamma[1]]
    };
    Compared::new(plant, initial, reference, (controller, quantity))
}

/// Runs the experiment with a load that is picked up.
///
/// - `heaviest`: largest mass that the estimator expects [kg]
pub fn pick_up(motion: &Sampled<2>, (plant, heaviest): (Change, f64), duration: f64) -> Outcome<Compared<2>> {
    let initial = identify(arm(COLD), arm(COLD), duration)?;
    let reference = Repeated { motion, duration: 2.0 * PICKED_UP };
    let adaptive = learning(initial, reference, AdaptationSettings::new(PERIOD))?;
    let controller = Carrying::new(adaptive, [[0.0, heaviest]], |arm, [mass]| carrying(*arm, *mass))?;
    Compared::new(
        plant,
        initial,
        reference,
        (controller, |controller| {
            let state = controller.load().state();
            [state.acting[0], state.half_widths[0]]
        }),
    )
}

pub fn warming_claim(compared: &Compared<4>) -> Claim {
    let claim = Claim::new(
        "claim-13",
        "The model may be adapted in operation: while gears warm up, the feed-forward stays nearly as good as with the true friction.",
    );
    compared
        .criteria(claim, 0.0)
        .flipped_by("a law that may not change, or gears that stay cold")
        .remark("Over the whole five minutes, by the loop's estimator with its default settings. Not in the paper: it names the possibility.")
        .shown_in("warm-gears")
}

pub fn load_claim(compared: &Compared<2>) -> Claim {
    let claim = Claim::new(
        "claim-14",
        "The model may be adapted in operation: after a load is picked up, the feed-forward becomes nearly as good as with the true load.",
    );
    compared
        .criteria(claim, PICKED_UP + SETTLED)
        .flipped_by("an estimator without the parameter of the load, or hands that stay empty")
        .remark("From 6 s after the load is picked up. The estimator knows where a load is held, not its mass. Not in the paper: it names the possibility.")
        .shown_in("load-mass")
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let motion = arm::reference()?;
    let duration = study.pick(60.0, 30.0);
    let warm = warm_up(&motion, (warming, AdaptationSettings::new(PERIOD), WARM), duration)?;
    let load = pick_up(&motion, (picking_up, HEAVIEST), duration)?;
    let table = Table::new(
        "changes-table",
        "Errors of the feed-forward: root mean square of the torque at the joint that the feedback adds.",
    )
    .column("model", "model", "")
    .column("span", "span", "")
    .column("error β", "error β", "N m")
    .column("error γ", "error γ", "N m");
    let table = warm.rows(table, "gears warm up: all 300 s", 0.0);
    let table = load.rows(table, "load: from the picking up on", PICKED_UP);
    let table = load.rows(table, "load: from 6 s later on", PICKED_UP + SETTLED);
    let section = Section::new("changes", "13, 14 · Gears that warm up, and a load")
        .block(text("The arm moves along the published trajectory forth and back. Encoders have steps of 0.1 mrad, motor torques noise of 2 mN m (0.3 N m at the joint). Three predictive controllers run on the same plant: one keeps the friction that was identified before, one learns by the estimator of the control loop with its default settings, and one has the plant's own equations in each period. First the viscous friction of both joints falls by 30 % in five minutes. Then friction stays, after half a minute the fingers hold 1 kg. With it β would need up to 86 N m, so all controllers reach its peak torque of 80.5 N m for about a second of each pass; errors count it."))
        .block(Block::Figure(warming_figure(&warm)))
        .block(Block::Figure(load_figure(&load)))
        .block(Block::Table(table));
    Ok(Part { section, claims: vec![warming_claim(&warm), load_claim(&load)] })
}

fn warming_figure(compared: &Compared<4>) -> Figure {
    let figure = Figure::new("warm-gears", "Friction at 0.35 rad/s while the gears warm up.");
    let times = compared.learning.rows.iter().step_by(10).map(|row| row.time);
    let truth: Vec<(f64, [f64; 2])> = times.map(|time| (time, friction(&warming(time)))).collect();
    JOINTS.into_iter().enumerate().fold(figure, |figure, (i, joint)| {
        let plant = truth.iter().map(|(time, torques)| [*time, torques[i]]).collect();
        let side = |sign: f64| compared.points(|values| values[i] + sign * values[i + 2]);
        let described = compared.initial[i].at(SHOWN);
        figure.plot(
            Plot::new(format!("joint {joint}"), show::time(), Axis::new("friction", "N m"))
                .series("learned", Marks::Line, compared.points(|values| values[i]))
                .series("90 % interval", Marks::Dashed, [side(1.0), vec![[f64::NAN; 2]], side(-1.0)].concat())
                .series("plant", Marks::Line, plant)
                .series("described", Marks::Line, compared.points(|_| described)),
        )
    })
}

fn load_figure(compared: &Compared<2>) -> Figure {
    let side = |sign: f64| compared.points(|[mass, half]| mass + sign * half);
    let truth = [[0.0, 0.0], [PICKED_UP, 0.0], [PICKED_UP, MASS], [2.0 * PICKED_UP, MASS]];
    let errors = Plot::new("joint γ", show::time(), Axis::new("feedback", "N m"))
        .series("static", Marks::Line, compared.fixed.points(|row| row.gap(1)))
        .series("learned", Marks::Line, compared.learning.points(|row| row.gap(1)));
    Figure::new(
        "load-mass",
        "Mass of the load with its 90 % interval, and the torque that the feedback adds at γ.",
    )
    .plot(
        Plot::new("load", show::time(), Axis::new("mass", "kg"))
            .series("learned", Marks::Line, compared.points(|[mass, _]| *mass))
            .series("90 % interval", Marks::Dashed, [side(1.0), vec![[f64::NAN; 2]], side(-1.0)].concat())
            .series("plant", Marks::Dashed, truth.to_vec()),
    )
    .plot(errors)
}
