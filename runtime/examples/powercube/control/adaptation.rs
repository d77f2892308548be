//! Claim 12: friction changes in operation. The estimator of the loop learns the change, and the controller uses the learned
//! friction.

use super::identified::identify;
use super::run::{self, Ltv, Modelled, Run, Setup, drive};
use super::show;
use crate::arm::{self, Arm, Friction, JOINTS, PERIOD, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_identification::methods::differentiation::quantization_noise;
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::adaptation::{AdaptationSettings, Adaptive, LearnedFriction};
use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::trajectory::{Sample, Sampled};

/// Time at which the friction of the plant changes (s).
const CHANGE: f64 = 8.0;
/// Factors of viscous and dry friction after the change, for example because oil warms up and a seal wears.
const FACTORS: [f64; 2] = [0.6, 1.3];
/// Resolution of the encoders [rad].
const ENCODER_STEP: f64 = 1e-4;
/// Speeds below which curves are compared [rad/s].
const FASTEST: f64 = 0.7;
/// Learned and true curve agree if their difference is below this share of the change.
const FOUND: f64 = 0.1;
/// Friction of the plant before the change.
const BEFORE: [Friction; 2] = [Friction::B, Friction::C];

/// Settings for a sudden change: drift within seconds, a short memory and little patience. The defaults expect changes within
/// minutes.
pub fn at_once() -> AdaptationSettings {
    AdaptationSettings {
        drift_times: [4000.0, 400.0, 40.0, 4.0],
        time_constant: PERIOD,
        memory: 4.0,
        patience: 0.1,
        ..AdaptationSettings::new(PERIOD)
    }
}

/// Friction with separate factors of the viscous part and of the dry part.
pub fn with_factors(friction: &Friction, [viscous, dry]: [f64; 2]) -> Friction {
    let mut changed = friction.scaled(dry);
    changed.0[1] = viscous * friction.0[1];
    changed
}

/// The plant at a time.
fn changed(time: f64) -> Arm {
    let factors = if time < CHANGE - 0.5 * PERIOD { [1.0; 2] } else { FACTORS };
    arm(BEFORE.map(|friction| with_factors(&friction, factors)))
}

type Model = LearnedFriction<Arm, 2, 2>;

/// LTV-MPC that learns friction, with its model in each period.
struct Learning<'t> {
    controller: Adaptive<LtvMpc<Model, &'t Sampled<2>, 2, 2, 4>, Arm, 2, 2>,
    models: Vec<Model>,
}

impl<'t> Learning<'t> {
    fn new(initial: [Friction; 2], reference: &'t Sampled<2>, settings: AdaptationSettings) -> Outcome<Self> {
        let robot = arm(initial);
        let controller =
            Adaptive::new(robot, settings, |model| LtvMpc::new(model, reference, options(&robot)))??;
        Ok(Self { controller, models: Vec::new() })
    }

    /// Ratio of learned to described friction at half of [`FASTEST`], for each period and joint.
    fn ratios(&self, initial: &[Friction; 2]) -> Vec<[f64; 2]> {
        let v = 0.5 * FASTEST;
        let ratio = |model: &Model| {
            let learned = model.friction_torques(&[0.0; 2], &[v; 2]);
            [0, 1].map(|i| learned[i] / initial[i].at(v))
        };
        self.models.iter().map(ratio).collect()
    }
}

impl Controller<2, 2> for Learning<'_> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let command = self.controller.step(cycle);
        self.models.push(self.controller.robot());
        command
    }
}

impl Modelled for Learning<'_> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        self.controller.inner().forward(sample)
    }
}

pub fn options(model: &Arm) -> MpcOptions<2, 2> {
    let mut options = run::options(model, PERIOD);
    options.observer.encoder_noise = [quantization_noise(ENCODER_STEP); 2];
    options
}

fn fixed(friction: [Friction; 2], reference: &Sampled<2>) -> Outcome<Ltv<&Sampled<2>>> {
    let model = arm(friction);
    Ok(Ltv::new(model, reference, options(&model))?)
}

/// One run with adaptation and one without, on a plant whose friction changes.
pub struct Adaptation {
    pub adaptive: Run,
    pub fixed: Run,
    /// Ratio of learned to identified friction for each joint.
    ratios: Vec<[f64; 2]>,
    /// True ratio of the plant for each joint.
    truth: [f64; 2],
    /// Time after the change until the learned curve agrees permanently (s), for each joint; infinite if it never agrees.
    pub settled: [f64; 2],
}

pub fn adaptation(
    reference: &Sampled<2>,
    settings: AdaptationSettings,
    duration: f64,
) -> Outcome<Adaptation> {
    let after = BEFORE.map(|friction| with_factors(&friction, FACTORS));
    let initial = identify(arm(BEFORE), arm(BEFORE), duration)?;
    let regime = Regime { encoder_step: ENCODER_STEP, ..Regime::IDEAL };
    let setup = Setup { change: Some(changed), ..Setup::new(arm(BEFORE), regime) };
    let mut learning = Learning::new(initial, reference, settings)?;
    let with = drive(&setup, &mut learning, reference)?;
    let without = drive(&setup, &mut fixed(initial, reference)?, reference)?;
    let settled = core::array::from_fn(|i| {
        let friction = |model: &Model, v: f64| model.friction_torques(&[0.0; 2], &[v; 2])[i];
        let errors = learning.models.iter().map(|model| difference(|v| friction(model, v), &after[i]));
        let errors: Vec<f64> = errors.collect();
        settling_time(&errors, FOUND * difference(|v| BEFORE[i].at(v), &after[i]))
    });
    let truth = [0, 1].map(|i| after[i].at(0.5 * FASTEST) / initial[i].at(0.5 * FASTEST));
    let ratios = learning.ratios(&initial);
    Ok(Adaptation { adaptive: with, fixed: without, ratios, truth, settled })
}

/// Root mean square of the difference of two curves [N m].
fn difference(a: impl Fn(f64) -> f64, b: &Friction) -> f64 {
    const STEPS: i32 = 70;
    let speeds = (-STEPS..=STEPS).map(|k| FASTEST * f64::from(k) / f64::from(STEPS));
    let sum: f64 = speeds.map(|v| (a(v) - b.at(v)).powi(2)).sum();
    (sum / f64::from(2 * STEPS + 1)).sqrt()
}

/// Time after the change until all later errors are below `bound` (s).
fn settling_time(errors: &[f64], bound: f64) -> f64 {
    match errors.iter().rposition(|error| *error > bound) {
        Some(last) if last + 1 == errors.len() => f64::INFINITY,
        Some(last) => ((last + 1) as f64 * PERIOD - CHANGE).max(0.0),
        None => 0.0,
    }
}

/// Time after the change in which the estimate must follow (s). Errors are compared after this time.
const SETTLED: f64 = 6.0;
const AFTERWARDS: f64 = CHANGE + SETTLED;

pub fn claim(adaptation: &Adaptation) -> Claim {
    let part = |run: &Run| run.between(AFTERWARDS, f64::INFINITY);
    let (with, without) = (part(&adaptation.adaptive), part(&adaptation.fixed));
    let mut claim = Claim::new(
        "claim-12",
        "Friction may be identified in operation: after a change the estimate follows, and the controller uses it.",
    );
    for (i, joint) in JOINTS.into_iter().enumerate() {
        claim = claim
            .criterion(Criterion::at_most(
                format!("time until the curve of {joint} is found"),
                adaptation.settled[i],
                SETTLED,
                "s",
            ))
            .criterion(Criterion::at_least(
                format!("rms error of {joint} afterwards, without over with adaptation"),
                without.rms_error(i) / with.rms_error(i),
                10.0,
                "",
            ));
    }
    claim
        .flipped_by("an estimator that expects no drift and has no end of patience")
        .remark("Found: the curve differs from the new one by less than a tenth of the change, for good.")
        .shown_in("adaptation-factors")
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let reference = arm::reference()?;
    let adaptation = adaptation(&reference, at_once(), study.pick(60.0, 30.0))?;
    let section = Section::new("adaptation", "12 · Friction that changes in operation")
        .block(text("After 8 s the plant's viscous friction falls to 60 % and its dry friction rises to 130 %, in both joints. Encoders have steps of 0.1 mrad. The estimator of the control loop learns how friction differs from what was identified before, and the predictive controller goes on with the new model. Next to it runs one that keeps what was identified."))
        .block(Block::Figure(figure(&adaptation)))
        .block(Block::Figure(
            Figure::new("adaptation-errors", "Errors without and with adaptation.")
                .plot(show::errors("without adaptation", &adaptation.fixed))
                .plot(show::errors("with adaptation", &adaptation.adaptive)),
        ))
        .block(Block::Table(table(&adaptation)));
    Ok(Part { section, claims: vec![claim(&adaptation)] })
}

fn figure(adaptation: &Adaptation) -> Figure {
    let figure = Figure::new(
        "adaptation-factors",
        "Friction at 0.35 rad/s, relative to what was identified before the change; dashed, the plant's.",
    );
    let times = || adaptation.adaptive.rows.iter().map(|row| row.time);
    [0, 1].into_iter().fold(figure, |figure, i| {
        let learned = times().zip(&adaptation.ratios).map(|(t, ratios)| [t, ratios[i]]).collect();
        let truth = times().map(|t| [t, if t < CHANGE { 1.0 } else { adaptation.truth[i] }]).collect();
        figure.plot(
            Plot::new(format!("joint {}", JOINTS[i]), show::time(), Axis::new("factor", ""))
                .series("learned", Marks::Line, learned)
                .series("plant", Marks::Dashed, truth),
        )
    })
}

fn table(adaptation: &Adaptation) -> Table {
    let mut table = Table::new("adaptation-table", "Before the change, and from 6 s after it on.")
        .column("controller", "controller", "")
        .column("time", "time", "");
    for joint in JOINTS {
        table = table.column(&format!("rms error {joint}"), format!("rms error {joint}"), "mrad").column(
            &format!("gap {joint}"),
            format!("gap {joint}"),
            "N m",
        );
    }
    let spans = [("before", 0.0, CHANGE), ("afterwards", AFTERWARDS, f64::INFINITY)];
    for (name, run) in [("without adaptation", &adaptation.fixed), ("with", &adaptation.adaptive)] {
        for (span, from, to) in spans {
            let part = run.between(from, to);
            let numbers = (0..2).flat_map(|i| [1e3 * part.rms_error(i), part.gap(i)]);
            let cells = [Cell::text(name), Cell::text(span)].into_iter();
            table = table.row(cells.chain(numbers.map(|x| Cell::Rounded(x, 3))));
        }
    }
    table
}
