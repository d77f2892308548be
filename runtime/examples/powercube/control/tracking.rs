//! Claim 1: LTV-MPC follows motion reversals and zero crossings, but feed-forward alone does not.

use super::run::{self, FeedForwardAlone, Run, Setup, drive};
use super::show;
use crate::arm::{self, Friction, JOINTS, PERIOD, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::trajectory::Sampled;

/// Distance of the arm from the start of the trajectory [rad].
pub const BESIDE: f64 = 1e-3;

/// Runs of feed-forward alone and of LTV-MPC, both with the exact model of the plant.
pub struct Pair {
    pub forward: Run,
    pub mpc: Run,
}

pub fn pair(reference: &Sampled<2>, beside: f64) -> Outcome<Pair> {
    let model = arm([Friction::B, Friction::C]);
    let setup = Setup { offset: [beside; 2], ..Setup::new(model, Regime::IDEAL) };
    let mut forward = FeedForwardAlone::new(model, reference, PERIOD)?;
    Ok(Pair {
        forward: drive(&setup, &mut forward, reference)?,
        mpc: run::linear(&setup, model, run::options(&model, PERIOD), reference)?,
    })
}

/// The claim for an arm that starts at the distance [`BESIDE`] from the smoothed trajectory.
pub fn claim(pair: &Pair) -> Claim {
    let worst = |run: &Run, value: fn(&Run, usize) -> f64| value(run, 0).max(value(run, 1));
    Claim::new(
        "claim-1",
        "LTV-MPC follows a trajectory with motion reversals and zero crossings; feed-forward alone does not.",
    )
    .criterion(Criterion::at_most(
        "LTV-MPC, rms error of the worse joint",
        1e3 * worst(&pair.mpc, Run::rms_error),
        0.15,
        "mrad",
    ))
    .criterion(Criterion::at_least(
        "feed-forward alone, largest error of the worse joint",
        1e3 * worst(&pair.forward, Run::largest_error),
        100.0,
        "mrad",
    ))
    .under("Something disturbs the arm: here it starts 1 mrad beside the trajectory.")
    .flipped_by("a start exactly on the smoothed trajectory, with the plant's own model: feed-forward then stays within a few mrad")
    .remark("Upright the arm falls: what is wrong once grows, however good the model.")
    .shown_in("tracking-errors")
}

pub fn experiment(_: &Study) -> Outcome<Part> {
    let smoothed = arm::reference()?;
    let file = arm::recording()?.raw()?;
    let exact = pair(&smoothed, 0.0)?;
    let beside = pair(&smoothed, BESIDE)?;
    let raw = pair(&file, 0.0)?;
    let claim = claim(&beside);
    let rows = [
        ("smoothed, from its start", &exact),
        ("smoothed, from 1 mrad beside", &beside),
        ("as published, from its start", &raw),
    ];
    let section = Section::new("tracking", "1 · Along the published trajectory")
        .block(text("The desired motion: 24.4 s at 50 Hz, from rest to rest. The published samples contradict their own velocities by up to 7 mrad at segment borders; smoothed, positions, velocities and accelerations agree. Plant and controllers here share one model, the published friction with its exact $\\operatorname{sign}$: nothing but the start, or the file's own jumps, is in the way."))
        .block(Block::Figure(desired(&smoothed, &beside)))
        .block(Block::Figure(errors(&beside)))
        .block(Block::Table(table(&rows)));
    Ok(Part { section, claims: vec![claim] })
}

fn desired(reference: &Sampled<2>, beside: &Pair) -> Figure {
    let figure = Figure::new(
        "tracking-positions",
        "Desired positions, and what feed-forward alone and LTV-MPC make of them from 1 mrad beside the start.",
    );
    [0, 1].into_iter().fold(figure, |figure, i| {
        let samples = reference.samples().iter().enumerate();
        let desired = samples.map(|(k, sample)| [k as f64 * PERIOD, sample.positions[i]]);
        figure.plot(
            Plot::new(format!("joint {}", JOINTS[i]), show::time(), Axis::new("position", "rad"))
                .series("desired", Marks::Line, desired.collect())
                .series("feed-forward alone", Marks::Line, beside.forward.points(|row| row.positions[i]))
                .series("LTV-MPC", Marks::Dashed, beside.mpc.points(|row| row.positions[i])),
        )
    })
}

fn errors(beside: &Pair) -> Figure {
    let figure = Figure::new(
        "tracking-errors",
        "Magnitude of the error $y - y_{\\mathrm{ref}}$ from 1 mrad beside the start: without feedback it grows a hundredfold, with it it is gone within a few periods.",
    );
    let size = |run: &Run, i: usize| run.points(|row| (1e3 * row.error(i).abs()).max(1e-6));
    [0, 1].into_iter().fold(figure, |figure, i| {
        figure.plot(
            Plot::new(
                format!("joint {}", JOINTS[i]),
                show::time(),
                Axis::new("|error|", "mrad").logarithmic(),
            )
            .series("feed-forward alone", Marks::Line, size(&beside.forward, i))
            .series("LTV-MPC", Marks::Line, size(&beside.mpc, i)),
        )
    })
}

fn table(rows: &[(&str, &Pair)]) -> Table {
    let mut table =
        Table::new("tracking-table", "Errors over the whole motion; the model is the plant's own.")
            .column("trajectory", "trajectory", "")
            .column("controller", "controller", "");
    for joint in JOINTS {
        table = table.column(&format!("rms {joint}"), format!("rms {joint}"), "mrad").column(
            &format!("largest {joint}"),
            format!("largest {joint}"),
            "mrad",
        );
    }
    for (name, pair) in rows {
        for (controller, run) in [("feed-forward", &pair.forward), ("LTV-MPC", &pair.mpc)] {
            let numbers = (0..2).flat_map(|i| [run.rms_error(i), run.largest_error(i)]);
            let numbers = numbers.map(|error| Cell::Rounded(1e3 * error, 3));
            let names = [Cell::text(*name), Cell::text(controller)];
            table = table.row(names.into_iter().chain(numbers));
        }
    }
    table
}
