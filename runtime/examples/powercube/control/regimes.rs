//! Claim 3: a better friction model does not improve tracking if delay, quantization and coarse sampling dominate.

use super::identified::identify;
use super::run::{self, Run, Setup};
use super::show;
use crate::arm::{self, Friction, JOINTS, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::trajectory::Sampled;

/// Compensation of model errors by the controller.
#[derive(Clone, Copy)]
pub struct Control {
    /// Standard deviation of the change of the input disturbance in a period [N m]; 0 if no disturbance is estimated.
    pub disturbance_noise: f64,
    /// Whether the controller compensates inputs that act one period late.
    pub compensates_delay: bool,
    /// Weight of the rate of the torques [s²/(N m)²]. A larger weight makes the feedback slower.
    pub rate_weight: f64,
}

/// Weight of the torque rate with which the loop does not oscillate in spite of the delay.
pub const SLOWER: f64 = 0.1;

/// Offset-free tracking without compensation of the delay.
pub const OFFSET_FREE: Control =
    Control { disturbance_noise: 1e-2, compensates_delay: false, rate_weight: 0.0 };

/// Rms errors of each joint [rad] with the old and with the identified friction under one set of conditions, over all seeds.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    old: [f64; 2],
    identified: [f64; 2],
}

impl Comparison {
    pub fn new(case: &Case, regime: Regime, control: Control) -> Outcome<Self> {
        let over_seeds = |friction: [Friction; 2]| -> Outcome<[f64; 2]> {
            let mut squares = [0.0; 2];
            for seed in 1..=case.seeds {
                let run = track(case, friction, regime, control, seed)?;
                for (i, sum) in squares.iter_mut().enumerate() {
                    *sum += run.rms_error(i).powi(2);
                }
            }
            Ok(squares.map(|sum| (sum / case.seeds as f64).sqrt()))
        };
        Ok(Self { old: over_seeds([Friction::OLD; 2])?, identified: over_seeds(case.identified)? })
    }

    /// Ratio of the error with the old friction to the error with the identified friction.
    pub fn gain(&self, i: usize) -> f64 {
        self.old[i] / self.identified[i]
    }
}

/// Common data of all comparisons.
pub struct Case {
    reference: Sampled<2>,
    identified: [Friction; 2],
    seeds: u64,
}

impl Case {
    pub fn new(study: &Study) -> Outcome<Self> {
        let plant = arm([Friction::B, Friction::C]);
        Ok(Self {
            reference: arm::reference()?,
            identified: identify(plant, plant, study.pick(60.0, 30.0))?,
            seeds: study.pick(5, 2),
        })
    }
}

fn track(case: &Case, friction: [Friction; 2], regime: Regime, control: Control, seed: u64) -> Outcome<Run> {
    let model = arm(friction);
    let mut options = run::options(&model, regime.period);
    options.delay = control.compensates_delay;
    options.input_rate_weight = [control.rate_weight; 2];
    options.observer.disturbance_noise = [control.disturbance_noise; 2];
    let noise = (regime.encoder_step.powi(2) / 12.0 + regime.encoder_noise.powi(2)).sqrt();
    options.observer.encoder_noise = [noise.max(1e-5); 2];
    let setup = Setup { seed, ..Setup::new(arm([Friction::B, Friction::C]), regime) };
    run::linear(&setup, model, options, &case.reference)
}

/// Rows of the table: ideal conditions, realistic conditions, and possible remedies.
fn rows() -> [(&'static str, Regime, Control); 9] {
    let (ideal, all) = (Regime::IDEAL, Regime::REALISTIC);
    let late = Regime { delay: 1, ..ideal };
    let coarse = Regime { delay: 0, ..all };
    let slow = |regime| Regime { period: 0.1, ..regime };
    let compensated = Control { compensates_delay: true, ..OFFSET_FREE };
    let slower = Control { rate_weight: SLOWER, ..OFFSET_FREE };
    let without = Control { disturbance_noise: 0.0, ..OFFSET_FREE };
    [
        ("ideal", ideal, OFFSET_FREE),
        ("delay of one period", late, OFFSET_FREE),
        ("coarse encoders and torques", coarse, OFFSET_FREE),
        ("sampled at 10 Hz", slow(ideal), OFFSET_FREE),
        ("realistic: delay, coarse", all, OFFSET_FREE),
        ("realistic, sampled at 10 Hz", slow(all), OFFSET_FREE),
        ("realistic, delay compensated", all, compensated),
        ("realistic, slower feedback", all, slower),
        ("realistic, no disturbance observer", all, without),
    ]
}

/// The claim, judged by ideal and realistic conditions.
pub fn claim(ideal: &Comparison, realistic: &Comparison) -> Claim {
    let mut claim = Claim::new(
        "claim-3",
        "Better friction does not improve tracking when delay, quantization and coarse sampling dominate.",
    );
    for (i, joint) in JOINTS.into_iter().enumerate() {
        claim = claim
            .criterion(Criterion::at_least(
                format!("ideal: error of {joint}, old friction over identified"),
                ideal.gain(i),
                10.0,
                "",
            ))
            .criterion(Criterion::at_most(
                format!("realistic: error of {joint}, old friction over identified"),
                realistic.gain(i),
                1.1,
                "",
            ));
    }
    claim
        .under("The MPC estimates the friction's error as an input disturbance, and its tight loop oscillates, because it does not reckon with the delay.")
        .flipped_by("the delay removed, or compensated, feedback slow enough to bear it, or no disturbance observer")
        .remark("Found only where the delay makes the loop oscillate, by ten and more mrad. Where the loop is calm better friction gains in the realistic regime too: little where an observer replaces it, a factor of twenty and more where none does. Coarse encoders and torques alone do not hide it.")
        .shown_in("regimes-table")
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let case = Case::new(study)?;
    let rows = rows();
    let mut compared = Vec::new();
    for (_, regime, control) in &rows {
        compared.push(Comparison::new(&case, *regime, *control)?);
    }
    let mut figure = Figure::new(
        "regimes-errors",
        "Error of joint β under the same offset-free LTV-MPC, which does not know of the delay; three seconds with a reversal of both joints.",
    );
    for (title, regime) in [("ideal", Regime::IDEAL), ("realistic", Regime::REALISTIC)] {
        let old = track(&case, [Friction::OLD; 2], regime, OFFSET_FREE, 1)?;
        let new = track(&case, case.identified, regime, OFFSET_FREE, 1)?;
        figure = figure.plot(comparison(title, &old, &new));
    }
    let section = Section::new("regimes", "3 · Where better friction helps")
        .block(text("Ideal: 50 Hz, exact encoders and torques, no delay. Realistic: an input acts one period late, encoders have steps of 0.1 mrad and noise of 0.05 mrad, motor torques steps of 5 mN m (0.8 N m at the joint) and noise of 2 mN m. Feedback is tight: errors shall return within about a period; slower means that changes of the torque cost as well. These are assumptions: the arm's own numbers are not published. The plant has the published friction, the models the old one or what was identified."))
        .block(Block::Table(table(&rows, &compared)))
        .block(Block::Figure(figure));
    Ok(Part { section, claims: vec![claim(&compared[0], &compared[4])] })
}

fn comparison(title: &str, old: &Run, identified: &Run) -> Plot {
    let (old, identified) = (old.between(10.0, 13.0), identified.between(10.0, 13.0));
    Plot::new(title, show::time(), Axis::new("error of β", "mrad"))
        .series("old friction", Marks::Line, old.points(|row| 1e3 * row.error(0)))
        .series("identified friction", Marks::Line, identified.points(|row| 1e3 * row.error(0)))
}

fn table(rows: &[(&str, Regime, Control)], compared: &[Comparison]) -> Table {
    let mut table = Table::new(
        "regimes-table",
        "Rms errors over all seeds under offset-free LTV-MPC that does not know of the delay, where nothing else is said.",
    )
    .column("regime", "regime", "");
    for joint in JOINTS {
        table = table
            .column(&format!("{joint}, old"), format!("{joint} old"), "mrad")
            .column(&format!("{joint}, identified"), format!("{joint} identified"), "mrad")
            .column(&format!("{joint}, ratio"), format!("{joint} ratio"), "");
    }
    for ((name, ..), one) in rows.iter().zip(compared) {
        let numbers = (0..2).flat_map(|i| [1e3 * one.old[i], 1e3 * one.identified[i], one.gain(i)]);
        let cells = std::iter::once(Cell::text(*name));
        table = table.row(cells.chain(numbers.map(|x| Cell::Rounded(x, 3))));
    }
    table
}
