//! Claim 4: conditions under which a truly nonlinear MPC improves tracking.

use super::identified::identify;
use super::run::{self, Run, Setup};
use super::show;
use crate::arm::{self, Arm, Friction, JOINTS, PERIOD, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::mpc::{LinearizationPoint, MpcOptions};
use gelenk_runtime::trajectory::{RestToRest, Sampled, Trajectory};

/// Sample time that is coarse for this arm (s).
pub const COARSE: f64 = 0.1;
/// Time from which on the arm should be at rest after the large motion (s).
const LATE: f64 = 8.0;

/// Runs of three controllers with the same model.
pub struct Three {
    /// LTV-MPC that is linearized around the desired trajectory, as in the paper.
    pub linear: Run,
    /// LTV-MPC that is linearized around the previous plan.
    pub plan: Run,
    pub nonlinear: Run,
}

impl Three {
    fn new(model: Arm, options: &MpcOptions<2, 2>, reference: &impl Trajectory<2>) -> Outcome<Self> {
        let regime = Regime { period: options.period, ..Regime::IDEAL };
        let setup = Setup::new(arm([Friction::B, Friction::C]), regime);
        let plan = MpcOptions { linearization: LinearizationPoint::Plan, ..options.clone() };
        Ok(Self {
            linear: run::linear(&setup, model, options.clone(), reference)?,
            plan: run::linear(&setup, model, plan, reference)?,
            nonlinear: run::nonlinear(&setup, model, options.clone(), reference)?,
        })
    }

    /// Ratio of the error with LTV-MPC to the error with NMPC.
    pub fn gain(&self, i: usize) -> f64 {
        self.linear.rms_error(i) / self.nonlinear.rms_error(i)
    }

    fn late(&self) -> Self {
        let part = |run: &Run| run.between(LATE, f64::INFINITY);
        Self { linear: part(&self.linear), plan: part(&self.plan), nonlinear: part(&self.nonlinear) }
    }
}

/// Runs along the published trajectory, with a sample time of `period` (s).
pub fn along(model: Arm, reference: &Sampled<2>, period: f64) -> Outcome<Three> {
    Three::new(model, &run::options(&model, period), reference)
}

/// Runs with a motion of 0.9 rad in `duration` (s) with at most the torque `SCARCE`, and then rest.
pub fn deviation(model: Arm, period: f64, duration: f64) -> Outcome<Three> {
    let motion = RestToRest::new([-0.4, 0.3], [0.5, -0.4], duration)?;
    let samples = (0..600).map(|k| motion.sample(f64::from(k) * PERIOD));
    let reference = Sampled::new(samples.collect(), PERIOD)?;
    let mut options = run::options(&model, period);
    options.input_limits = [[-SCARCE, SCARCE]; 2];
    Three::new(model, &options, &reference)
}

/// Largest torque of the motors in the large motion [N m], which is 56 N m at the joint.
const SCARCE: f64 = 0.35;
/// Duration of the large motion that is too short for this torque (s).
pub const TOO_FAST: f64 = 1.2;

pub fn claim(coarse: &Three, deviation: &Three) -> Claim {
    let late = deviation.late();
    let mut claim = Claim::new("claim-4", "A truly nonlinear MPC with the new models improves tracking.");
    for (i, joint) in JOINTS.into_iter().enumerate() {
        claim = claim
            .criterion(Criterion::at_least(
                format!("sampled at 10 Hz: rms error of {joint}, LTV-MPC over NMPC"),
                coarse.gain(i),
                1.2,
                "",
            ))
            .criterion(Criterion::at_least(
                format!("at rest after a large deviation: rms error of {joint}, LTV-MPC over NMPC"),
                late.gain(i),
                10.0,
                "",
            ));
    }
    claim
        .under("Coarse sampling, or a large deviation from the desired trajectory. At 50 Hz along the trajectory both are alike.")
        .flipped_by("sampling at 50 Hz along the published trajectory, or a large motion slow enough for the torque")
        .remark("After a large deviation it is the point of linearization that counts: LTV-MPC linearized around its own plan comes to rest too. While the torque is at its limit all three do the same.")
        .shown_in("nonlinear-rest")
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let reference = arm::reference()?;
    let plant = arm([Friction::B, Friction::C]);
    let model = arm(identify(plant, plant, study.pick(60.0, 30.0))?);
    let mut rows = Vec::new();
    for period in study.pick(vec![PERIOD, 0.05, COARSE, 0.2], vec![PERIOD, COARSE]) {
        let name = format!("published trajectory, {:.0} Hz", 1.0 / period);
        rows.push((name, along(model, &reference, period)?));
    }
    let coarse = along(model, &reference, COARSE)?;
    let large = deviation(model, PERIOD, TOO_FAST)?;
    rows.push(("large motion, 50 Hz, at rest".to_owned(), large.late()));
    rows.push(("large motion, 10 Hz, at rest".to_owned(), deviation(model, COARSE, TOO_FAST)?.late()));
    rows.push(("large motion, 50 Hz, all of it".to_owned(), deviation(model, PERIOD, TOO_FAST)?));
    let section = Section::new("nonlinear", "4 · Nonlinear MPC")
        .block(text("The plant has the published friction, all controllers what was identified. NMPC predicts by Runge–Kutta steps of the nonlinear arm about its plan, one Gauss–Newton step a period; LTV-MPC by the exact zero-order hold of linearizations. The large deviation: 0.9 rad in 1.2 s with 56 N m at the joint, then rest."))
        .block(Block::Figure(rest(&large)))
        .block(Block::Figure(errors(&coarse)))
        .block(Block::Table(table(&rows)));
    Ok(Part { section, claims: vec![claim(&coarse, &large)] })
}

fn rest(large: &Three) -> Figure {
    let figure = Figure::new(
        "nonlinear-rest",
        "After a motion that the torque was too small for. Where friction is steep at rest, LTV-MPC around the desired trajectory takes a joint that hardly moves for one that rests, and drives it back and forth.",
    );
    let points = |run: &Run, i: usize| run.between(1.0, 5.0).points(|row| 1e3 * row.error(i));
    [0, 1].into_iter().fold(figure, |figure, i| {
        figure.plot(
            Plot::new(
                format!("joint {}", JOINTS[i]),
                show::time(),
                Axis::new("error", "mrad").over(-40.0, 40.0),
            )
            .series("LTV-MPC around the desired trajectory", Marks::Line, points(&large.linear, i))
            .series("LTV-MPC around its plan", Marks::Line, points(&large.plan, i))
            .series("NMPC", Marks::Dashed, points(&large.nonlinear, i)),
        )
    })
}

fn errors(coarse: &Three) -> Figure {
    let figure = Figure::new("nonlinear-errors", "Along the published trajectory, sampled at 10 Hz.");
    let points = |run: &Run, i: usize| run.points(|row| 1e3 * row.error(i));
    [0, 1].into_iter().fold(figure, |figure, i| {
        figure.plot(
            Plot::new(format!("joint {}", JOINTS[i]), show::time(), Axis::new("error", "mrad"))
                .series("LTV-MPC around the desired trajectory", Marks::Line, points(&coarse.linear, i))
                .series("NMPC", Marks::Line, points(&coarse.nonlinear, i)),
        )
    })
}

fn table(rows: &[(String, Three)]) -> Table {
    let mut table = Table::new("nonlinear-table", "Rms errors with the identified friction.")
        .column("motion", "motion", "");
    for joint in JOINTS {
        for (heading, name) in [
            ("LTV, desired", "LTV around the desired trajectory"),
            ("LTV, plan", "LTV around its plan"),
            ("NMPC", "NMPC"),
        ] {
            table = table.column(&format!("{joint}, {heading}"), format!("{joint} {name}"), "mrad");
        }
    }
    for (name, three) in rows {
        let runs = [&three.linear, &three.plan, &three.nonlinear];
        let numbers = (0..2).flat_map(|i| runs.map(|run| 1e3 * run.rms_error(i)));
        let cells = std::iter::once(Cell::text(name.as_str()));
        table = table.row(cells.chain(numbers.map(|x| Cell::Rounded(x, 3))));
    }
    table
}
