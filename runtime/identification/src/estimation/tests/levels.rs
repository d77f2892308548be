//! Effect of the thresholds: each is halved and doubled, and the snapshot shows which results change.
//!
//! Logs of a pendulum pass preparation and estimate; laws are found from samples of friction. A variation stays inside the
//! bar if no log that had a result is refused, no finding appears or goes that is a warning or an error, and friction and
//! moments are as near to the truth as [`BAR`] allows.

use super::super::super::friction::{self, FrictionData, FrictionIdentification, FrictionMethod};
use super::super::super::methods::stribeck::StribeckRegression;
use super::super::super::numeric::levels::varied::with;
use super::super::super::numeric::random::SplitMix64;
use super::super::super::preparation::{self, PreparationSettings, prepare_all};
use super::super::super::robot::JointLimits;
use super::super::super::run::{Effort, Run};
use super::super::{EstimationSettings, estimate, levels};
use super::pendulum::{Experiment, FRICTION, Pendulum, log};
use gelenk_findings::{Finding, Severity};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Growth of the rms of the relative errors that a variation may cause, and an error that always passes.
const BAR: [f64; 2] = [1.5, 0.05];

/// A log, and its fault.
struct Case {
    name: &'static str,
    experiment: Experiment,
    runs: u64,
    change: fn(&mut Run),
    effort: Effort,
}

const fn as_it_is(_: &mut Run) {}

fn cases() -> Vec<Case> {
    let usual =
        Experiment { seconds: 5.0, rate: 100.0, slope_time: 0.01, resolution: 1e-4, ..Experiment::default() };
    let plain = || Case {
        name: "plain",
        experiment: usual.clone(),
        runs: 1,
        change: as_it_is,
        effort: Effort::Input,
    };
    let late = Experiment { delay: 0.03, jitter: 0.2, resolution: 1.5e-3, ..usual.clone() };
    vec![
        Case { name: "late and coarse", experiment: late, ..plain() },
        Case {
            name: "another factor",
            change: |run| run.efforts[1].iter_mut().for_each(|u| *u *= 2.5),
            runs: 2,
            ..plain()
        },
        Case { name: "current", effort: Effort::Current, ..plain() },
    ]
}

/// Results of a log.
struct Outcome {
    name: &'static str,
    values: Vec<f64>,
    error: f64,
    codes: BTreeSet<String>,
}

impl Case {
    fn simulated(self) -> (Self, Vec<Run>, Pendulum) {
        let mut random = SplitMix64::new(5);
        let truth = Pendulum { sticks: true, ..Pendulum::described() }.other(0.05, &mut random);
        let mut run = |_| {
            let mut run = log(&truth, &self.experiment, &mut random);
            (self.change)(&mut run);
            Run { effort: self.effort, ..run }
        };
        let runs = (0..self.runs).map(&mut run).collect();
        (self, runs, truth)
    }

    fn outcome(&self, logs: &[Run], truth: &Pendulum) -> Outcome {
        let described = Pendulum { sticks: true, ..Pendulum::described() };
        let found = prepare_all(logs, Some(&described), &PreparationSettings::default()).and_then(
            |(runs, report)| {
                let settings = EstimationSettings {
                    filter: Some(report.filter.clone()),
                    delays: Some(vec![0; 2]),
                    folds: 5,
                    ..EstimationSettings::default()
                };
                estimate(&described, &runs, &settings, &mut |_| ())
            },
        );
        let is_doubt = |finding: &&Finding| finding.severity != Severity::Note;
        let codes = |found: &[Finding]| found.iter().filter(is_doubt).map(|f| f.code.to_string()).collect();
        match found {
            Ok(found) => {
                let friction =
                    found.joints.iter().flat_map(|joint| &joint.terms).map(|term| term.coefficient);
                let parameters = found.parameters.iter().copied();
                let all = friction.chain(parameters).flat_map(|x| [x.value, x.standard_error]);
                let near = |value: f64, truth: f64| (value / truth - 1.0).powi(2);
                let gain = if self.effort == Effort::Current { f64::NAN } else { 1.0 };
                let viscous = found
                    .joints
                    .iter()
                    .zip(FRICTION)
                    .map(|(j, truth)| near(j.terms[0].coefficient.value, truth[0]));
                let moments = [1, 11].map(|i| near(found.parameters[i].value, truth.parameters[i]));
                let errors: Vec<f64> = viscous.chain(moments).collect();
                let error = gain * (errors.iter().sum::<f64>() / errors.len() as f64).sqrt();
                Outcome { name: self.name, values: all.collect(), error, codes: codes(&found.findings) }
            }
            Err(error) => {
                let refused = BTreeSet::from(["refused".to_owned()]);
                Outcome {
                    name: self.name,
                    values: Vec::new(),
                    error: f64::NAN,
                    codes: &codes(error.refusals()) | &refused,
                }
            }
        }
    }
}

/// Effect of a variation, over all logs.
fn compared(before: &[Outcome], after: &[Outcome]) -> String {
    let mut said = Vec::new();
    for (before, after) in before.iter().zip(after) {
        let new: Vec<&String> = after.codes.symmetric_difference(&before.codes).collect();
        if !new.is_empty() {
            let of = |code: &String| format!("{}{code}", if after.codes.contains(code) { '+' } else { '-' });
            said.push(format!("{}: {}", before.name, new.into_iter().map(of).collect::<Vec<_>>().join(" ")));
        } else if after.error > BAR[1] && after.error > BAR[0] * before.error {
            said.push(format!("{}: error {:.2}", before.name, after.error));
        }
    }
    let is_same = |(before, after): (&Outcome, &Outcome)| {
        let bits = |of: &Outcome| of.values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        before.codes == after.codes && bits(before) == bits(after)
    };
    match before.iter().zip(after).all(is_same) {
        _ if !said.is_empty() => said.join("; "),
        true => "no change".to_owned(),
        false => "inside".to_owned(),
    }
}

/// A row for each number.
fn page<'n>(names: impl Iterator<Item = &'n &'static str>, outcomes: &dyn Fn() -> Vec<Outcome>) -> String {
    let usual = outcomes();
    let mut page = String::new();
    for Outcome { name, error, codes, .. } in &usual {
        writeln!(page, "{name}: error {error:.2}, {codes:?}").unwrap();
    }
    for name in names {
        let [half, double] = [0.5, 2.0].map(|factor| compared(&usual, &with(name, factor, outcomes)));
        let short = name.split("::").skip(1).collect::<Vec<_>>().join("::");
        writeln!(page, "{short} | {half} | {double}").unwrap();
    }
    page
}

#[test]
fn each_number_of_an_estimate_is_halved_and_doubled() {
    let cases: Vec<(Case, Vec<Run>, Pendulum)> = cases().into_iter().map(Case::simulated).collect();
    let outcomes = || cases.iter().map(|(case, logs, truth)| case.outcome(logs, truth)).collect();
    let names = preparation::levels::NAMES.iter().chain(levels::NAMES);
    insta::assert_snapshot!("numbers_of_an_estimate", page(names, &outcomes));
}

/// Friction along sines: the speeds of the log, and the torques of a law.
fn law(name: &'static str, torque: fn(f64) -> f64, [fastest, offset]: [f64; 2]) -> Outcome {
    let mut random = SplitMix64::new(5);
    let velocities: Vec<f64> = (0..1500).map(|i| fastest * (0.0082 * f64::from(i)).sin() + offset).collect();
    let torques: Vec<f64> = velocities.iter().map(|v| torque(*v) + 0.1 * random.normal()).collect();
    let limits = JointLimits { position: [-1e9, 1e9], velocity: 2.0, effort: 20.0 };
    let data = FrictionData { limits: Some(limits), ..FrictionData::of(name, &velocities, &torques) };
    let method = FrictionMethod::Ladder(StribeckRegression { starts: 4, ..StribeckRegression::default() });
    let settings = FrictionIdentification { method, ..FrictionIdentification::new().unwrap() };
    let found = settings.identify(&data).unwrap().result;
    let speeds: Vec<f64> = (-20..=20).filter(|i| *i != 0).map(|i| 0.05 * f64::from(i) * fastest).collect();
    let laws = found.law.torques(&speeds).unwrap();
    let errors: Vec<[f64; 2]> =
        speeds.iter().zip(laws).map(|(v, law)| [law - torque(*v), torque(*v)]).collect();
    let size = |k: usize| errors.iter().map(|pair| pair[k].powi(2)).sum::<f64>().sqrt();
    let codes = found.findings.iter().filter(|f| f.severity != Severity::Note).map(|f| f.code.to_string());
    Outcome {
        name,
        values: found.law.coefficients().iter().map(|term| term.coefficient).collect(),
        error: size(0) / size(1),
        codes: codes.collect(),
    }
}

#[test]
fn each_number_of_a_law_is_halved_and_doubled() {
    let coulomb: fn(f64) -> f64 = |v| 2.0 * v + 3.0 * (100.0 * v).tanh();
    let stribeck: fn(f64) -> f64 = |v| 2.0 * v + (3.0 + 2.0 * (-10.0 * v.abs()).exp()) * (50.0 * v).tanh();
    let outcomes = || {
        vec![
            law("coulomb", coulomb, [1.0, 0.0]),
            law("stribeck", stribeck, [1.0, 0.0]),
            law(
                "shallow",
                |v| 2.0 * v + (3.0 + 0.2 * (-10.0 * v.abs()).exp()) * (50.0 * v).tanh(),
                [1.0, 0.0],
            ),
            law("asymmetric", |v| 2.0 * v + 0.8 * v.abs() + 3.0 * (100.0 * v).tanh(), [1.0, 0.0]),
            law("one way", coulomb, [0.5, 0.52]),
            law("slow", coulomb, [0.15, 0.0]),
            law("fast", coulomb, [5.0, 0.0]),
            law("noise", |_| 0.0, [1.0, 0.0]),
            law("spring back", |v| 2.0 * v - 1.0 * (20.0 * v).tanh(), [1.0, 0.0]),
        ]
    };
    insta::assert_snapshot!("numbers_of_a_law", page(friction::levels::NAMES.iter(), &outcomes));
}
