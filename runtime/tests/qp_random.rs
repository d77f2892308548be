//! The QP solver on random well-posed problems of every kind (`support::wide_qp`), cold and warm, against
//! Clarabel: statuses are true, none ends at the iteration limit, and no cost exceeds the optimum by more
//! than 1e-6 of its size.
//!
//! Short by default. All ten thousand:
//! `QP_PROBLEMS=10000 cargo test --release -p gelenk-runtime --test all qp_random:: -- --nocapture`; others from
//! the seed `QP_FIRST` on. Of the first 700 seeds Clarabel confirms all 2800 solves, with rows 2793; it did not
//! solve the other 7 itself.
//!
//! The following counts are those of warm starts of the interior-point method, which the active sets have replaced: 39 964 of
//! 40 000 solves were confirmed. Not every problem passed: of 80 000 solves from the seed 1 000 000 on 4 end at the iteration limit and say so
//! (seeds 1 006 867, 1 010 370, 1 015 480), and 5 as relaxed: four of the seed 1 003 274, with costs of 1e14, that
//! Clarabel almost solves, and one of 1 013 124, which it solves.
//!
//! With rows neither. Of the first ten thousand with rows two seeds fail: 9781 (all four solves, costs of −1.6e14; Clarabel
//! calls it unbounded) and 3665 (shifted, cost above the optimum by 8e-4) end at the iteration limit and say so.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::oracle::{self, Solution};
use crate::support::wide_qp::{self, Wide};
use crate::support::worth::value;
use clarabel::solver::SolverStatus;
use gelenk_runtime::qp::{QpProblem, QpReport, QpSettings, QpSolver, QpStatus};

/// Counts and failures of one kind of solve.
#[derive(Debug, Default)]
struct Tally {
    /// Solves that Clarabel confirms, that it cannot judge since it did not solve the problem itself, and
    /// truly infeasible ones.
    confirmed: usize,
    unjudged: usize,
    infeasible: usize,
    iterations: Vec<usize>,
    failures: Vec<String>,
}

impl Tally {
    fn judge<const NX: usize, const NU: usize, const NR: usize>(
        &mut self,
        seed: u64,
        p: &QpProblem<NX, NU, NR>,
        truth: &Solution<NX, NU>,
        solver: &QpSolver<NX, NU, NR>,
        report: &QpReport,
    ) {
        self.iterations.push(report.iterations);
        let inputs: Vec<_> = (0..p.stages.len()).map(|k| solver.input(k)).collect();
        let states: Vec<_> = (1..=p.stages.len()).map(|k| solver.state(k)).collect();
        let ours = value(p, &inputs, &states);
        let theirs = value(p, &truth.inputs, &truth.states);
        let scale = ours.cost.abs() + ours.size;
        let above = (ours.cost - theirs.cost) / (theirs.cost.abs() + theirs.size);
        let reported = (ours.cost - report.cost).abs() <= 1e-9 * scale;
        let sound = reported && ours.defect < 1e-9;
        let kept = ours.violation <= 2e-10;
        let solved = truth.status == SolverStatus::Solved;
        match report.status {
            QpStatus::Solved if sound && kept && !solved => self.unjudged += 1,
            QpStatus::Solved if sound && kept && above < 1e-6 => self.confirmed += 1,
            QpStatus::Relaxed if sound && !kept && !solved => self.infeasible += 1,
            _ => self.failures.push(format!(
                "{NX}/{NU}, N = {}, seed {seed}: Clarabel {:?}, cost above by {above:.1e}, {ours:?}, {report:?}",
                p.stages.len(),
                truth.status
            )),
        }
    }

    /// Prints the counts; fails where a solve failed.
    fn finish(mut self, what: &str) {
        self.iterations.sort_unstable();
        let n = self.iterations.len();
        println!(
            "{what}: {} confirmed, {} not judged by Clarabel, {} infeasible, {} failed; iterations: median {}, 99 % {}, most {}",
            self.confirmed,
            self.unjudged,
            self.infeasible,
            self.failures.len(),
            self.iterations[n / 2],
            self.iterations[n * 99 / 100],
            self.iterations[n - 1]
        );
        for failure in &self.failures {
            println!("    {failure}");
        }
    }
}

/// Solves of one problem: cold; warm after a shift, from the plan and from a disturbed plan; warm after a jump to other
/// data.
#[derive(Debug, Default)]
struct Tallies {
    cold: Tally,
    shifted: Tally,
    disturbed: Tally,
    changed: Tally,
}

impl Tallies {
    fn solve<const NX: usize, const NU: usize, const NR: usize>(&mut self, seed: u64) {
        let wide: Wide<NX, NU, NR> = wide_qp::wide_qp(seed);
        let first = wide.first();
        let mut base = QpSolver::new(wide.horizon, QpSettings::default()).unwrap();
        let report = base.solve(&first);
        let truth = oracle::solve(&first, 1e-10);
        self.cold.judge(seed, &first, &truth, &base, &report);
        let plan = base.state(1);
        let warm = [(0.0, &mut self.shifted), (0.01, &mut self.disturbed), (1.0, &mut self.changed)];
        for (share, tally) in warm {
            let mut solver = base.clone();
            let x = core::array::from_fn(|i| plan[i] + share * (wide.reference[i] - plan[i]));
            let next = wide.next(&base, x);
            solver.shift();
            let report = solver.solve_warm(&next);
            let truth = oracle::solve(&next, 1e-10);
            tally.judge(seed, &next, &truth, &solver, &report);
        }
    }

    fn finish(self) {
        let kinds = [
            ("cold", self.cold),
            ("shifted", self.shifted),
            ("disturbed", self.disturbed),
            ("changed", self.changed),
        ];
        let failures: usize = kinds.iter().map(|(_, tally)| tally.failures.len()).sum();
        for (what, tally) in kinds {
            tally.finish(what);
        }
        assert_eq!(failures, 0);
    }
}

/// Problems at the edge of what is feasible, or whose Newton systems rounding spoils: the interior-point method alone
/// ends at its limit.
const HARD: [u64; 5] = [1493, 1_003_780, 1_011_319, 1_013_040, 1_016_681];

fn seeds() -> core::ops::Range<u64> {
    let count: u64 = std::env::var("QP_PROBLEMS").map_or(24, |n| n.parse().unwrap());
    let first: u64 = std::env::var("QP_FIRST").map_or(0, |n| n.parse().unwrap());
    first..first + count
}

#[test]
fn random_problems_are_solved_cold_and_warm() {
    solve_all(seeds());
}

#[test]
fn hard_problems_are_solved_cold_and_warm() {
    solve_all(HARD);
}

fn solve_all(seeds: impl IntoIterator<Item = u64>) {
    let mut tallies = Tallies::default();
    for seed in seeds {
        match seed % 3 {
            0 => tallies.solve::<2, 1, 0>(seed),
            1 => tallies.solve::<3, 4, 0>(seed),
            _ => tallies.solve::<6, 3, 0>(seed),
        }
    }
    tallies.finish();
}

#[test]
fn random_problems_with_rows_are_solved_cold_and_warm() {
    let mut tallies = Tallies::default();
    for seed in seeds() {
        match seed % 3 {
            0 => tallies.solve::<2, 1, 1>(seed),
            1 => tallies.solve::<3, 4, 3>(seed),
            _ => tallies.solve::<6, 3, 5>(seed),
        }
    }
    tallies.finish();
}
