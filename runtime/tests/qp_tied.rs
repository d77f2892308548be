//! The QP solver on random problems with exact zeros, ties, parallel rows and bounds that coincide
//! (`support::tied_qp`), cold and warm, against Clarabel: no `Solved` violates a hard bound or costs more than the
//! optimum, and each iteration limit where Clarabel solves is listed.
//!
//! Short by default. All four thousand: `QP_PROBLEMS=4000 cargo test --release -p gelenk-runtime --test all qp_tied::
//! -- --nocapture`; others from the seed `QP_FIRST` on. Rounding differs from processor to processor, and a problem
//! whose rounding grows beyond the tolerances may be solved on one and not on another.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::oracle::{self, Solution};
use crate::support::tied_qp::tied_qp;
use crate::support::wide_qp::advance;
use crate::support::worth::{Value, value};
use clarabel::solver::SolverStatus;
use gelenk_runtime::qp::{QpProblem, QpReport, QpSettings, QpSolver, QpStatus};
use std::collections::BTreeMap;

/// States that inputs lead to.
fn roll_out<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    inputs: &[[f64; NU]],
) -> Vec<[f64; NX]> {
    let mut x = p.initial_state;
    let next = p.stages.iter().zip(inputs).map(|(stage, u)| {
        x = advance(stage, &x, u);
        x
    });
    next.collect()
}

/// Clarabel's solution, at its own tolerances where it does not reach 1e-10.
fn truth<const NX: usize, const NU: usize, const NR: usize>(p: &QpProblem<NX, NU, NR>) -> Solution<NX, NU> {
    let precise = oracle::solve(p, 1e-10);
    if precise.status == SolverStatus::Solved { precise } else { oracle::solve(p, 1e-8) }
}

/// Cost of a point above that of Clarabel's solution. This compares only if Clarabel's inputs keep the
/// bounds: if the dynamics amplify it, their defect of 1e-11 acts as a further input.
fn excess<const NX: usize, const NU: usize, const NR: usize>(
    p: &QpProblem<NX, NU, NR>,
    ours: &Value,
    truth: &Solution<NX, NU>,
) -> f64 {
    let theirs = value(p, &truth.inputs, &truth.states);
    let witness = value(p, &truth.inputs, &roll_out(p, &truth.inputs));
    let above = ours.cost - theirs.cost.max(witness.cost);
    // Penalties of up to 1e5 per unit, and states that rounding moves by 1e-15.
    let size = 1e-6 * (theirs.cost.abs() + theirs.size) + 1e-9;
    if witness.violation < 1e-9 { above / size } else { 0.0 }
}

/// Counts of statuses, iteration limits where Clarabel solves, and failures.
#[derive(Debug, Default)]
struct Tally {
    counts: BTreeMap<String, usize>,
    iterations: Vec<usize>,
    limits: Vec<String>,
    failures: Vec<String>,
}

impl Tally {
    fn solve<const NX: usize, const NU: usize, const NR: usize>(&mut self, seed: u64) {
        let p = tied_qp::<NX, NU, NR>(seed);
        let mut solver = QpSolver::new(p.stages.len(), QpSettings::default()).unwrap();
        let report = solver.solve(&p);
        self.judge((seed, "cold"), &p, &solver, &report);
        let mut next = p.clone();
        next.initial_state = solver.state(1);
        next.previous_input = solver.input(0);
        next.stages.rotate_left(1);
        if let [.., before, last] = &mut next.stages[..] {
            *last = before.clone();
        }
        solver.shift();
        let report = solver.solve_warm(&next);
        self.judge((seed, "shifted"), &next, &solver, &report);
    }

    fn judge<const NX: usize, const NU: usize, const NR: usize>(
        &mut self,
        (seed, what): (u64, &str),
        p: &QpProblem<NX, NU, NR>,
        solver: &QpSolver<NX, NU, NR>,
        report: &QpReport,
    ) {
        let truth = truth(p);
        let inputs: Vec<_> = (0..p.stages.len()).map(|k| solver.input(k)).collect();
        let states: Vec<_> = (1..=p.stages.len()).map(|k| solver.state(k)).collect();
        let ours = value(p, &inputs, &states);
        let rolled = value(p, &inputs, &roll_out(p, &inputs)).violation;
        let solved = truth.status == SolverStatus::Solved;
        *self
            .counts
            .entry(format!("{what}: Clarabel {:?}, here {:?}", truth.status, report.status))
            .or_default() += 1;
        self.iterations.push(report.iterations);
        let text = || {
            format!(
                "{NX}/{NU}/{NR}, N = {}, seed {seed} {what}: {ours:?}, rolled out {rolled:.1e}, {report:?}",
                p.stages.len()
            )
        };
        if report.status == QpStatus::Solved {
            let reported = (ours.cost - report.cost).abs() <= 1e-9 * (ours.cost.abs() + ours.size + 1.0);
            let kept = ours.violation <= 2e-10 && ours.beside <= 1e-6 && rolled <= 1e-6;
            let cheap = !solved || excess(p, &ours, &truth) <= 1.0;
            if !(reported && kept && cheap && ours.defect < 1e-9) {
                self.failures.push(text());
            }
        } else if solved {
            self.limits.push(text());
        }
    }

    /// Prints counts and lists. Fails where a `Solved` does not hold.
    fn finish(mut self) {
        self.iterations.sort_unstable();
        let n = self.iterations.len();
        println!(
            "{n} solves, iterations: median {}, 99 % {}, most {}, all {}",
            self.iterations[n / 2],
            self.iterations[n * 99 / 100],
            self.iterations[n - 1],
            self.iterations.iter().sum::<usize>()
        );
        self.counts.iter().for_each(|(what, count)| println!("{count:6} {what}"));
        println!("{} not solved that Clarabel solves:", self.limits.len());
        self.limits.iter().for_each(|limit| println!("    {limit}"));
        assert!(self.failures.is_empty(), "solved, but:\n{}", self.failures.join("\n"));
    }
}

fn solve_all(seeds: impl IntoIterator<Item = u64>) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        match seed % 3 {
            0 => tally.solve::<2, 1, 0>(seed),
            1 => tally.solve::<4, 2, 0>(seed),
            _ => tally.solve::<3, 2, 3>(seed),
        }
    }
    tally
}

#[test]
fn tied_problems_that_count_as_solved_are() {
    let count: u64 = std::env::var("QP_PROBLEMS").map_or(60, |n| n.parse().unwrap());
    let first: u64 = std::env::var("QP_FIRST").map_or(0, |n| n.parse().unwrap());
    solve_all(first..first + count).finish();
}

/// Optima that cost 0: the gap never gets small relative to the cost.
const COSTLESS: [u64; 8] = [751, 1166, 1960, 5007, 7106, 8420, 10_572, 10_936];

/// Hard bounds that give way only at the cost of steep soft ones.
const STEEP: [u64; 6] = [4801, 5632, 9217, 11_584, 2474, 6395];

/// Roll-outs whose rounding grows beyond a hard bound.
const GROWING: [u64; 6] = [31, 799, 1408, 3763, 5378, 11_485];

#[test]
fn costless_and_steep_problems_are_solved() {
    let tally = solve_all(COSTLESS.into_iter().chain(STEEP));
    let cold = tally.limits.iter().filter(|limit| limit.contains("cold"));
    assert_eq!(cold.collect::<Vec<_>>(), Vec::<&String>::new());
    tally.finish();
}

#[test]
fn rounding_that_grows_beyond_a_bound_is_no_solution() {
    let tally = solve_all(GROWING);
    assert!(tally.limits.len() >= GROWING.len(), "{tally:?}");
    tally.finish();
}
