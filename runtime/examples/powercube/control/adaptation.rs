//! Claim 12: friction changes in operation; recursive identification follows, and the controller uses what it
//! finds.

use super::identified::identify;
use super::run::{self, Ltv, Modelled, Run, Setup, drive};
use super::show;
use crate::arm::{self, Arm, Friction, GEAR, JOINTS, PERIOD, Regime, arm};
use crate::methods::recursive::{RecursiveLeastSquares, RecursiveSettings};
use crate::study::{Outcome, Part, Study};
use gelenk_identification::methods::differentiation::quantization_noise;
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle, Estimate};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::trajectory::Sampled;

/// When the plant's friction changes (s).
const CHANGE: f64 = 8.0;
/// Factors of its viscous and its dry part later on: oil warms up, a seal wears.
const FACTORS: [f64; 2] = [0.6, 1.3];
/// Steps of the encoders [rad].
const ENCODER_STEP: f64 = 1e-4;
/// Speeds below which curves are compared [rad/s].
const FASTEST: f64 = 0.7;
/// Curves agree where their difference is below this share of the change.
const FOUND: f64 = 0.1;
/// Slower than this a joint tells nothing about its friction [rad/s].
const MOVING: f64 = 0.02;

/// Forgetting factor: a memory of two thirds of a second.
pub const FORGETTING: f64 = 0.97;

/// Friction with its viscous part and the rest, each times its own factor.
fn with_factors(friction: &Friction, [viscous, dry]: [f64; 2]) -> Friction {
    let mut changed = friction.scaled(dry);
    changed.0[1] = viscous * friction.0[1];
    changed
}

/// LTV-MPC whose friction follows the arm: two factors a joint, one of the viscous and one of the dry part.
struct Adaptive<'t> {
    mpc: Ltv<&'t Sampled<2>>,
    initial: [Friction; 2],
    estimators: [RecursiveLeastSquares<2>; 2],
    /// Measured positions of the last two periods, and the input between them.
    past: Vec<[f64; 2]>,
    last_inputs: [f64; 2],
    factors: Vec<[[f64; 2]; 2]>,
}

impl<'t> Adaptive<'t> {
    fn new(initial: [Friction; 2], reference: &'t Sampled<2>, forgetting: f64) -> Outcome<Self> {
        let settings = RecursiveSettings {
            forgetting,
            // A factor may be off by half, the torque of a sample by half a newton metre.
            initial_covariance: 1.0,
            largest_trace: 1e3,
            ..RecursiveSettings::default()
        };
        let estimator = RecursiveLeastSquares::new([1.0; 2], settings)?;
        Ok(Self {
            mpc: controller(initial, reference)?,
            initial,
            estimators: [estimator.clone(), estimator],
            past: Vec::new(),
            last_inputs: [0.0; 2],
            factors: Vec::new(),
        })
    }

    /// Takes the friction torque of the two periods that end now. Central differences need no model.
    fn learn(&mut self, now: &[f64; 2], inputs: &[f64; 2]) {
        let [before, middle] = self.past[..] else {
            return;
        };
        let v: [f64; 2] = core::array::from_fn(|i| (now[i] - before[i]) / (2.0 * PERIOD));
        let a = core::array::from_fn(|i| (now[i] - 2.0 * middle[i] + before[i]) / (PERIOD * PERIOD));
        let rigid = arm([Friction([0.0; 7]); 2]).inverse_dynamics(&middle, &v, &a);
        for i in 0..2 {
            if v[i].abs() < MOVING {
                continue;
            }
            let torque = 0.5 * GEAR * (self.last_inputs[i] + inputs[i]) - rigid[i];
            let viscous = self.initial[i].0[1] * v[i];
            let dry = self.initial[i].at(v[i]) - viscous;
            self.estimators[i].update(&[viscous, dry], torque);
        }
    }

    fn friction(&self) -> [Friction; 2] {
        core::array::from_fn(|i| {
            // Friction does not drive.
            let factors = self.estimators[i].coefficients().map(|f| f.max(0.0));
            with_factors(&self.initial[i], factors)
        })
    }
}

impl Controller<2, 2> for Adaptive<'_> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.mpc.reset(positions, inputs);
        self.past.clear();
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let positions = cycle.positions.ok_or(ControllerFault::NoMeasurement)?;
        self.learn(&positions, &cycle.last_inputs);
        if self.past.len() == 2 {
            self.past.remove(0);
        }
        self.past.push(positions);
        self.last_inputs = cycle.last_inputs;
        self.factors.push([0, 1].map(|i| self.estimators[i].coefficients()));
        self.mpc.set_model(arm(self.friction())).map_err(|_| ControllerFault::NotFinite)?;
        self.mpc.step(cycle)
    }

    fn planned(&self, periods: u32) -> Option<[f64; 2]> {
        self.mpc.planned(periods)
    }

    fn estimate(&self) -> Option<Estimate<2>> {
        self.mpc.estimate()
    }
}

impl Modelled for Adaptive<'_> {
    fn model(&self) -> Arm {
        arm(self.friction())
    }
}

fn controller(friction: [Friction; 2], reference: &Sampled<2>) -> Outcome<Ltv<&Sampled<2>>> {
    let model = arm(friction);
    let mut options = run::options(&model, PERIOD);
    options.observer.encoder_noise = [quantization_noise(ENCODER_STEP); 2];
    Ok(Ltv::new(model, reference, options)?)
}

/// One run with adaptation and one without, on a plant whose friction changes.
pub struct Adaptation {
    pub adaptive: Run,
    pub fixed: Run,
    /// Estimated factors over time, by joint.
    factors: Vec<[[f64; 2]; 2]>,
    /// Time after the change until the curve stays found (s), by joint; infinite where it never does.
    pub settled: [f64; 2],
}

pub fn adaptation(reference: &Sampled<2>, forgetting: f64, duration: f64) -> Outcome<Adaptation> {
    let before = [Friction::B, Friction::C];
    let after = before.map(|friction| with_factors(&friction, FACTORS));
    let initial = identify(arm(before), arm(before), duration)?;
    let regime = Regime { encoder_step: ENCODER_STEP, ..Regime::IDEAL };
    let setup = Setup { change: Some((CHANGE, arm(after))), ..Setup::new(arm(before), regime) };
    let mut adaptive = Adaptive::new(initial, reference, forgetting)?;
    let with = drive(&setup, &mut adaptive, reference)?;
    let without = drive(&setup, &mut controller(initial, reference)?, reference)?;
    let settled = core::array::from_fn(|i| {
        let curves = adaptive.factors.iter().map(|factors| with_factors(&initial[i], factors[i]));
        let errors: Vec<f64> = curves.map(|curve| difference(&curve, &after[i])).collect();
        settling_time(&errors, FOUND * difference(&before[i], &after[i]))
    });
    Ok(Adaptation { adaptive: with, fixed: without, factors: adaptive.factors, settled })
}

/// Root mean square of the difference of two curves [N m].
fn difference(a: &Friction, b: &Friction) -> f64 {
    const STEPS: i32 = 70;
    let speeds = (-STEPS..=STEPS).map(|k| FASTEST * f64::from(k) / f64::from(STEPS));
    let sum: f64 = speeds.map(|v| (a.at(v) - b.at(v)).powi(2)).sum();
    (sum / f64::from(2 * STEPS + 1)).sqrt()
}

/// Time from the change until no error is above `bound` any more (s).
fn settling_time(errors: &[f64], bound: f64) -> f64 {
    match errors.iter().rposition(|error| *error > bound) {
        Some(last) if last + 1 == errors.len() => f64::INFINITY,
        Some(last) => ((last + 1) as f64 * PERIOD - CHANGE).max(0.0),
        None => 0.0,
    }
}

/// Time that the estimate has to follow (s); errors are compared after it.
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
        .flipped_by("recursive least squares that forgets nothing")
        .remark("Found: the curve differs from the new one by less than a tenth of the change, for good. Two factors a joint are estimated, of the viscous and of the dry part of what was identified before.")
        .shown_in("adaptation-factors")
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let reference = arm::reference()?;
    let adaptation = adaptation(&reference, FORGETTING, study.pick(60.0, 30.0))?;
    let section = Section::new("adaptation", "12 · Friction that changes in operation")
        .block(text("After 8 s the plant's viscous friction falls to 60 % and its dry friction rises to 130 %, in both joints. Encoders have steps of 0.1 mrad. Every period the recursive least squares take the friction torque $i u + q_s - M \\ddot y - k$ of the last two periods by central differences, and the predictive controller goes on with the new model; beside it runs one that keeps what was identified before the change."))
        .block(Block::Figure(factors(&adaptation)))
        .block(Block::Figure(
            Figure::new("adaptation-errors", "Errors without and with adaptation.")
                .plot(show::errors("without adaptation", &adaptation.fixed))
                .plot(show::errors("with adaptation", &adaptation.adaptive)),
        ))
        .block(Block::Table(table(&adaptation)));
    Ok(Part { section, claims: vec![claim(&adaptation)] })
}

fn factors(adaptation: &Adaptation) -> Figure {
    let figure = Figure::new(
        "adaptation-factors",
        "Estimated factors of the viscous and the dry part, relative to what was identified before the change; dashed, the plant's.",
    );
    let times = || adaptation.adaptive.rows.iter().map(|row| row.time);
    let truth = |part: usize| times().map(|t| [t, if t < CHANGE { 1.0 } else { FACTORS[part] }]).collect();
    [0, 1].into_iter().fold(figure, |figure, i| {
        let estimate = |part: usize| {
            let values = adaptation.factors.iter().map(|factors| factors[i][part]);
            times().zip(values).map(|(t, value)| [t, value]).collect()
        };
        figure.plot(
            Plot::new(format!("joint {}", JOINTS[i]), show::time(), Axis::new("factor", ""))
                .series("viscous", Marks::Line, estimate(0))
                .series("dry", Marks::Line, estimate(1))
                .series("viscous, plant", Marks::Dashed, truth(0))
                .series("dry, plant", Marks::Dashed, truth(1)),
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
