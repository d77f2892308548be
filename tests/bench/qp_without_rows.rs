//! QPs without rows, solved by an earlier solver and by that of this checkout. `qp_without_rows.sh` compiles it with both.
//!
//! Problems: joints with random inertia coupling and gravity over 20 stages of 20 ms, thrown off their position, with tight
//! bounds of torque and speed, as in the bench `qp` of the runtime.

use std::hint::black_box;

use rustix::time::{ClockId, clock_gettime};

const HORIZON: usize = 20;
const PROBLEMS: u64 = 20;
const ROUNDS: usize = 400;
const PERIOD: f64 = 0.02;

/// Repeatable numbers from -1 to 1: Knuth's linear congruential generator.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// CPU time of this thread in microseconds.
fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

/// The bits of a solution and the iterations that it took, which tell whether both solvers do the same.
type Answer = (Vec<u64>, usize);

/// One solver with its problems.
trait Contender {
    fn problems(&self) -> usize;
    /// Solves a problem from a cold start.
    fn cold(&mut self, problem: usize);
    /// Takes the solution of a problem one stage on.
    fn prepare(&mut self, problem: usize);
    /// Solves the problem that follows from there.
    fn warm(&mut self, problem: usize);
    fn answer(&self) -> Answer;
}

/// The module of one solver: the same text for both.
macro_rules! contender {
    ($module:ident, $runtime:ident) => {
        mod $module {
            use super::*;
            use $runtime::qp::{QpProblem, QpReport, QpSettings, QpSolver};

            pub struct Solver<const NX: usize, const NU: usize> {
                solver: QpSolver<NX, NU>,
                problems: Vec<QpProblem<NX, NU>>,
                next: Vec<QpProblem<NX, NU>>,
                report: QpReport,
            }

            fn problem<const NX: usize, const NU: usize>(seed: u64) -> QpProblem<NX, NU> {
                let mut numbers = Numbers(seed);
                let mut problem = QpProblem::<NX, NU>::new(HORIZON);
                for i in 0..NU {
                    problem.initial_state[i] = 0.3 * numbers.next();
                    problem.initial_state[NU + i] = 0.3 * numbers.next();
                    (problem.state_weight[i][i], problem.state_weight[NU + i][NU + i]) = (400.0, 4.0);
                    (problem.terminal_weight[i][i], problem.terminal_weight[NU + i][NU + i]) = (2500.0, 10.0);
                    problem.input_weight[i][i] = 0.01;
                }
                let stiffness: [[f64; NU]; NU] = core::array::from_fn(|_| core::array::from_fn(|_| numbers.next()));
                let root: [[f64; NU]; NU] = core::array::from_fn(|_| core::array::from_fn(|_| numbers.next()));
                for stage in &mut problem.stages {
                    for i in 0..NU {
                        for j in 0..NU {
                            let identity = if i == j { 1.0 } else { 0.0 };
                            let inverse_inertia =
                                0.3 * identity + (0..NU).map(|k| root[i][k] * root[j][k]).sum::<f64>() / NU as f64;
                            let pull = PERIOD * (3.0 * stiffness[i][j] + 0.3 * numbers.next());
                            let drag = PERIOD * (0.5 * identity + 0.2 * numbers.next());
                            stage.state_matrix[i][j] = identity + 0.5 * PERIOD * pull;
                            stage.state_matrix[i][NU + j] = PERIOD * identity;
                            stage.state_matrix[NU + i][j] = pull;
                            stage.state_matrix[NU + i][NU + j] = identity - drag;
                            stage.input_matrix[i][j] = 0.5 * PERIOD * PERIOD * inverse_inertia;
                            stage.input_matrix[NU + i][j] = PERIOD * inverse_inertia;
                        }
                        (stage.input_lower[i], stage.input_upper[i]) = (-12.0, 12.0);
                        (stage.state_lower[i], stage.state_upper[i]) = (-3.0, 3.0);
                        (stage.state_lower[NU + i], stage.state_upper[NU + i]) = (-0.6, 0.6);
                    }
                }
                problem
            }

            impl<const NX: usize, const NU: usize> Solver<NX, NU> {
                pub fn new() -> Self {
                    let settings = QpSettings { tolerance: 1e-6, ..QpSettings::default() };
                    let mut solver = QpSolver::new(HORIZON, settings).expect("a size that it takes");
                    let problems: Vec<QpProblem<NX, NU>> = (0..PROBLEMS).map(problem).collect();
                    let report = solver.solve(&problems[0]);
                    let next = problems
                        .iter()
                        .map(|problem| {
                            solver.solve(problem);
                            QpProblem { initial_state: solver.state(1), ..problem.clone() }
                        })
                        .collect();
                    Self { solver, problems, next, report }
                }
            }

            impl<const NX: usize, const NU: usize> Contender for Solver<NX, NU> {
                fn problems(&self) -> usize {
                    self.problems.len()
                }
                fn cold(&mut self, problem: usize) {
                    self.report = self.solver.solve(black_box(&self.problems[problem]));
                }
                fn prepare(&mut self, problem: usize) {
                    self.solver.solve(&self.problems[problem]);
                    self.solver.shift();
                }
                fn warm(&mut self, problem: usize) {
                    self.report = self.solver.solve_warm(black_box(&self.next[problem]));
                }
                fn answer(&self) -> Answer {
                    let inputs = (0..HORIZON).flat_map(|k| self.solver.input(k));
                    (inputs.map(f64::to_bits).collect(), self.report.iterations as usize)
                }
            }
        }
    };
}

contender!(before, runtime_before);
contender!(now, runtime_now);

/// Both solvers of one size.
fn both<const NX: usize, const NU: usize>() -> [Box<dyn Contender>; 2] {
    [Box::new(before::Solver::<NX, NU>::new()), Box::new(now::Solver::<NX, NU>::new())]
}

fn of_size(size: &str) -> [Box<dyn Contender>; 2] {
    match size {
        "2/1" => both::<2, 1>(),
        "4/2" => both::<4, 2>(),
        "12/6" => both::<12, 6>(),
        _ => both::<14, 7>(),
    }
}

/// Microseconds of a solve.
fn time(contender: &mut dyn Contender, warm: bool, problem: usize) -> f64 {
    if warm {
        contender.prepare(problem);
    }
    let start = cpu_time();
    if warm { contender.warm(problem) } else { contender.cold(problem) }
    cpu_time() - start
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The row of one size and start. Both solvers take turns, since other work on the machine comes and goes.
fn row(size: &str, warm: bool) {
    let mut contenders = of_size(size);
    let (mut times, mut ratios, mut alike) = ([vec![], vec![]], vec![], true);
    let mut iterations = [0, 0];
    for round in 0..ROUNDS {
        for problem in 0..contenders[0].problems() {
            // Who comes first finds colder caches.
            let order = if (round + problem) % 2 == 0 { [0, 1] } else { [1, 0] };
            let mut taken = [0.0; 2];
            for k in order {
                taken[k] = time(contenders[k].as_mut(), warm, problem);
                times[k].push(taken[k]);
            }
            ratios.push(taken[1] / taken[0]);
            let answers = [contenders[0].answer(), contenders[1].answer()];
            alike &= answers[0] == answers[1];
            iterations = [0, 1].map(|k| iterations[k] + answers[k].1);
        }
    }
    let [before, now] = times.each_mut().map(|times| median(times));
    let mean = iterations.map(|sum| sum as f64 / ratios.len() as f64);
    println!(
        "{size:>13} {:>7} {before:>12.1} {now:>8.1}   {:.3}   {:.1}, {:.1}, {}",
        if warm { "warm" } else { "cold" },
        median(&mut ratios),
        mean[0],
        mean[1],
        if alike { "the same bits" } else { "other bits" },
    );
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [size, start, solver, calls] = arguments.as_slice() else {
        println!("states/inputs   start  before (us)  now (us)   ratio   iterations before, now, inputs");
        for size in ["2/1", "4/2", "12/6", "14/7"] {
            for warm in [false, true] {
                row(size, warm);
            }
        }
        return;
    };
    let mut contenders = of_size(size);
    let contender = &mut contenders[usize::from(solver == "now")];
    let calls: usize = calls.parse().expect("a number of calls");
    for problem in (0..contender.problems()).cycle().take(calls) {
        if start == "warm" {
            contender.warm(problem);
        } else {
            contender.cold(problem);
        }
    }
}
