//! exploration
#![allow(clippy::unwrap_used, reason = "test code")]

mod support;

use clarabel::solver::SolverStatus;
use gelenk_runtime::qp::{QpProblem, QpReport, QpSettings, QpSolver, QpStatus};
use std::collections::BTreeMap;
use support::{oracle, wide_qp};

fn times<const R: usize, const C: usize>(m: &[[f64; C]; R], v: &[f64; C]) -> [f64; R] {
    m.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[derive(Debug)]
struct Value {
    cost: f64,
    size: f64,
    violation: f64,
    defect: f64,
}

/// Cost etc. from the problem's own data
fn value<const NX: usize, const NU: usize>(p: &QpProblem<NX, NU>, inputs: &[[f64; NU]], states: &[[f64; NX]]) -> Value {
    let mut v = Value { cost: 0.0, size: 0.0, violation: 0.0, defect: 0.0 };
    let n = p.stages.len();
    let mut last = p.previous_input;
    let mut x = p.initial_state;
    for (k, s) in p.stages.iter().enumerate() {
        let (u, next) = (inputs[k], states[k]);
        let ideal = wide_qp::advance(s, &x, &u);
        let w = if k + 1 == n { &p.terminal_weight } else { &p.state_weight };
        let du: [f64; NU] = core::array::from_fn(|i| u[i] - last[i]);
        let quad = 0.5 * (dot(&times(w, &next), &next) + dot(&times(&p.input_weight, &u), &u) + dot(&times(&p.input_rate_weight, &du), &du));
        v.cost += quad + dot(&s.input_gradient, &u) + dot(&s.state_gradient, &next);
        v.size += quad;
        for i in 0..NX {
            v.defect = v.defect.max((ideal[i] - next[i]).abs() / ideal[i].abs().max(1.0));
            for e in [s.state_lower[i] - next[i], next[i] - s.state_upper[i]] {
                let e = e.max(0.0);
                match p.state_penalty[i] {
                    None => v.violation = v.violation.max(e / next[i].abs().max(1.0)),
                    Some(w) => v.cost += w.linear * e + 0.5 * w.quadratic * e * e,
                }
            }
        }
        for i in 0..NU {
            for e in [s.input_lower[i] - u[i], u[i] - s.input_upper[i]] {
                v.violation = v.violation.max(e / u[i].abs().max(1.0));
            }
        }
        (last, x) = (u, next);
    }
    v
}

#[derive(Default)]
struct Stats {
    kinds: BTreeMap<String, (usize, Vec<String>)>,
    iterations: BTreeMap<&'static str, Vec<usize>>,
}
impl Stats {
    fn add(&mut self, kind: String, note: String) {
        let e = self.kinds.entry(kind).or_default();
        e.0 += 1;
        if e.1.len() < 6 { e.1.push(note); }
    }
}

fn judge<const NX: usize, const NU: usize>(stats: &mut Stats, what: &'static str, seed: u64, p: &QpProblem<NX, NU>, solver: &QpSolver<NX, NU>, report: &QpReport, truth: &oracle::Solution<NX, NU>) {
    let n = p.stages.len();
    let u: Vec<_> = (0..n).map(|k| solver.input(k)).collect();
    let x: Vec<_> = (0..n).map(|k| solver.state(k + 1)).collect();
    let ours = value(p, &u, &x);
    let theirs = value(p, &truth.inputs, &truth.states);
    let scale = theirs.cost.abs() + theirs.size;
    let excess = (ours.cost - theirs.cost) / scale;
    let eq_u = p.stages.iter().flat_map(|s| s.input_lower.iter().zip(&s.input_upper)).filter(|(a, b)| a == b).count();
    let eq_x = p.stages.iter().flat_map(|s| s.state_lower.iter().zip(&s.state_upper)).filter(|(a, b)| a == b).count();
    let big: f64 = (0..n).flat_map(|k| solver.state_multipliers(k + 1)).flatten().fold(0.0, f64::max);
    let note = format!("{NX}/{NU} N={n} seed {seed}: excess {excess:.1e} viol {:.1e} cost {:.1e} it {} res {:.1e} {:.1e} {:.1e} eq {eq_u} {eq_x} soft {} R0 {} W {} lam {big:.0e}", ours.violation, theirs.cost, report.iterations, report.residuals.stationarity, report.residuals.primal, report.residuals.gap, u8::from(p.state_penalty.iter().any(Option::is_some)), u8::from(p.input_weight[0][0] == 0.0), u8::from(p.input_rate_weight[0][0] != 0.0));
    let opt = if !(excess < 1e-6) { "SUBOPT" } else if excess < -1e-6 { "BELOW" } else { "ok" };
    let cost_ok = if (ours.cost - report.cost).abs() <= 1e-9 * scale { "" } else { " COSTOFF" };
    let feas = if ours.violation < 1e-8 { "" } else { " VIOL" };
    let def = if ours.defect < 1e-9 { "" } else { " DEFECT" };
    if report.status == QpStatus::Relaxed && format!("{:?}", truth.status) == "PrimalInfeasible" {
        stats.add(format!("{what} Relaxed/infeasible"), String::new());
    } else {
        stats.add(format!("{what} {:?} clarabel {:?} {opt}{feas}{def}{cost_ok}", report.status, truth.status), note);
    }
    stats.iterations.entry(what).or_default().push(report.iterations);
}

fn run<const NX: usize, const NU: usize>(stats: &mut Stats, seed: u64) {
    let wide = wide_qp::wide_qp::<NX, NU>(seed);
    let p = wide.first();
    let mut solver = QpSolver::<NX, NU>::new(wide.horizon, QpSettings::default()).unwrap();
    let truth = oracle::solve(&p, 1e-10);
    let report = solver.solve(&p);
    judge(stats, "cold", seed, &p, &solver, &report, &truth);
    if std::env::var("QP_COLD").is_ok() { return; }
    // shifted, from the plan
    let base = solver.clone();
    for (what, what_cold, share) in [("warm plan", "cold plan", 0.0), ("warm 1%", "cold 1%", 0.01), ("warm ref", "cold ref", 1.0)] {
        let mut solver = base.clone();
        let x1 = base.state(1);
        let x = core::array::from_fn(|i| x1[i] + share * (wide.reference[i] - x1[i]));
        let next = wide.next(x, base.input(0));
        let truth = oracle::solve(&next, 1e-10);
        solver.shift();
        let report = solver.solve_warm(&next);
        judge(stats, what, seed, &next, &solver, &report, &truth);
        let report = solver.solve(&next);
        judge(stats, what_cold, seed, &next, &solver, &report, &truth);
    }
}

#[test]
fn explore() {
    let count: u64 = std::env::var("QP_COUNT").map_or(200, |c| c.parse().unwrap());
    let start: u64 = std::env::var("QP_START").map_or(0, |c| c.parse().unwrap());
    let mut stats = Stats::default();
    for seed in start..start + count {
        match seed % 3 {
            0 => run::<2, 1>(&mut stats, seed),
            1 => run::<3, 4>(&mut stats, seed),
            _ => run::<6, 3>(&mut stats, seed),
        }
    }
    for (kind, (n, notes)) in &stats.kinds {
        println!("{n:6} {kind}");
        if std::env::var("QP_VERBOSE").is_ok() || !kind.ends_with("clarabel Solved ok") {
            for note in notes { println!("          {note}"); }
        }
    }
    for (what, it) in &mut stats.iterations {
        it.sort_unstable();
        let n = it.len();
        println!("{what}: iterations median {} 99% {} max {} mean {:.2}", it[n / 2], it[n * 99 / 100], it[n - 1], it.iter().sum::<usize>() as f64 / n as f64);
    }
}
