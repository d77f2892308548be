//! Logs of a robot in closed loop: whether least squares is biased by the noise of the positions, and whether it says so.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::result::CONFIDENCE;
use super::super::super::run::{DesiredMotion, PreparedRun};
use super::super::{Estimate, EstimationSettings, InstrumentSource, Uncertain, estimate};
use super::coverage::law;
use super::pendulum::{Experiment, FRICTION, Pendulum, STEEPNESS, simulate};
use gelenk_findings::{Severity, texts};

/// A run with the reference as its commanded motion, and the robot that made it.
fn log(of: &Experiment, seed: u64) -> (Pendulum, PreparedRun) {
    let mut random = SplitMix64::new(seed);
    let truth = Pendulum::described().other(0.1, &mut random);
    let (mut run, reference) = simulate(&truth, of, &mut random);
    run.desired = Some(DesiredMotion {
        positions: reference.positions,
        velocities: reference.velocities,
        accelerations: reference.accelerations,
    });
    (truth, run)
}

fn settings() -> EstimationSettings {
    EstimationSettings {
        steepness: Some(vec![STEEPNESS; 2]),
        optional_terms: false,
        folds: 5,
        accept_poor: true,
        ..EstimationSettings::default()
    }
}

fn estimated(runs: &[PreparedRun]) -> Estimate {
    estimate(&Pendulum::described(), runs, &settings(), &mut |_| ()).unwrap()
}

/// Friction, and what gravity and inertia tell of both links: least squares, instruments, truth.
fn triples(found: &Estimate, truth: &Pendulum) -> Vec<(Uncertain, Uncertain, f64)> {
    let other = found.instrumental.as_ref().unwrap();
    let mut all = Vec::new();
    for joint in 0..2 {
        let pairs = found.joints[joint].terms.iter().zip(&other.terms[joint]);
        all.extend(pairs.zip(FRICTION[joint]).map(|((a, b), truth)| (a.coefficient, b.coefficient, truth)));
    }
    all.extend([11, 12, 19].map(|i| (found.parameters[i], other.parameters[i], truth.parameters[i])));
    all
}

/// Many logs of one kind.
#[derive(Default)]
struct Study {
    logs: f64,
    rejected: f64,
    /// Sums of errors and of their squares, of least squares and of instruments, for each value.
    sums: Vec<[[f64; 2]; 2]>,
    /// How often intervals of least squares and of instruments held the truth, over logs and values.
    covered: [f64; 2],
}

impl Study {
    fn new(of: &Experiment, seeds: std::ops::Range<u64>) -> Self {
        let mut study = Self { logs: seeds.end as f64 - seeds.start as f64, ..Self::default() };
        for seed in seeds {
            let (truth, run) = log(of, seed);
            let found = estimated(&[run]);
            let instrumental = found.instrumental.as_ref().unwrap();
            assert_eq!(instrumental.source, InstrumentSource::Commanded);
            study.rejected += f64::from(u8::from(instrumental.p_value < 0.1));
            let triples = triples(&found, &truth);
            study.sums.resize(triples.len(), [[0.0; 2]; 2]);
            for (sums, (least, other, truth)) in study.sums.iter_mut().zip(&triples) {
                for (sums, value) in sums.iter_mut().zip([least.value, other.value]) {
                    *sums = [sums[0] + value - truth, sums[1] + (value - truth).powi(2)];
                }
                for (covered, Uncertain { interval: [low, high], .. }) in
                    study.covered.iter_mut().zip([least, other])
                {
                    let hit = low <= truth && truth <= high;
                    *covered += f64::from(u8::from(hit)) / triples.len() as f64 / study.logs;
                }
            }
        }
        study
    }

    /// Mean errors over their standard errors: of least squares and of instruments, for each value.
    fn biases(&self) -> Vec<[f64; 2]> {
        let bias = |[sum, squares]: [f64; 2]| {
            let mean = sum / self.logs;
            mean / ((squares / self.logs - mean * mean) / self.logs).sqrt()
        };
        self.sums.iter().map(|sums| sums.map(bias)).collect()
    }

    fn print(&self, what: &str) {
        println!(
            "{what}: rejected {:.2}, covered {:.3} by least squares and {:.3} by instruments",
            self.rejected / self.logs,
            self.covered[0],
            self.covered[1]
        );
        self.biases().iter().for_each(|[least, other]| println!("  {least:+6.1} {other:+6.1}"));
    }
}

fn quiet() -> Experiment {
    Experiment { position_noise: 1e-6, force_noise: 1.0, ..Experiment::default() }
}

/// Encoders so coarse for the filter that their noise shakes the robot.
fn noisy() -> Experiment {
    Experiment { position_noise: 3e-4, force_noise: 0.15, ..Experiment::default() }
}

#[test]
#[ignore = "200 logs, 10 s: cargo test --release -p gelenk-identification --lib closed_loop -- --ignored --nocapture"]
fn instruments_are_unbiased_and_the_test_rejects_as_often_as_it_says() {
    let quiet = Study::new(&quiet(), 0..100);
    quiet.print("without noise of the positions");
    // Two standard deviations of the share are 0.06.
    assert!((0.04..=0.16).contains(&(quiet.rejected / quiet.logs)));
    assert!(quiet.biases().iter().flatten().all(|bias| bias.abs() < 3.0));
    assert!(quiet.covered.iter().all(|share| (0.85..=0.95).contains(share)));
    let noisy = Study::new(&noisy(), 0..100);
    noisy.print("with noise of the positions");
    assert!(noisy.rejected > 0.9 * noisy.logs);
    assert!(noisy.biases().iter().any(|[least, _]| least.abs() > 10.0));
    assert!(noisy.biases().iter().all(|[_, other]| other.abs() < 3.0));
    // The intervals of least squares count its bias. Noise of derivatives has less power in slow cosines than in fast ones, so that
    // both are too wide rather than too narrow.
    assert!(noisy.covered.iter().all(|share| *share >= 0.85));
}

#[test]
fn noise_of_the_positions_biases_least_squares_and_not_instruments() {
    let short = |of: Experiment| Experiment { seconds: 6.0, ..of };
    let noisy = Study::new(&short(noisy()), 0..3);
    noisy.print("with noise of the positions");
    assert_eq!(noisy.rejected, noisy.logs);
    // The inertia of the second link suffers most.
    let [least, other] = noisy.sums[6].map(|sums| sums[0] / noisy.logs);
    assert!(other.abs() < 0.5 * least.abs(), "{least} {other}");
    // The bias is in the intervals: without it they hold a third.
    assert!(noisy.covered[0] > 0.8, "{}", noisy.covered[0]);
    let quiet = Study::new(&short(quiet()), 0..3);
    quiet.print("without noise of the positions");
    assert!(quiet.rejected <= 1.0);
}

/// A law with the terms of the estimate has its intervals; one with another term reaches as far.
#[test]
fn friction_laws_count_the_bias() {
    let (_, run) = log(&Experiment { seconds: 6.0, ..noisy() }, 0);
    let settings = EstimationSettings { confidence: CONFIDENCE, ..settings() };
    let runs = [run];
    let found = estimate(&Pendulum::described(), &runs, &settings, &mut |_| ()).unwrap();
    assert!(found.instrumental.as_ref().unwrap().rejects);
    let half = |[low, high]: [f64; 2]| 0.5 * (high - low);
    for joint in 0..2 {
        let same = format!("tanh({STEEPNESS}*v)");
        let report = law(&found, &runs[0], joint, None, &["v", &same]);
        let t = report.result.interval_factor();
        for (term, own) in report.result.law.coefficients().iter().zip(&found.joints[joint].terms) {
            let [of_law, of_estimate] = [half(term.ends(t).unwrap()), half(own.coefficient.interval)];
            println!("{joint} {}: {of_law:.5} and {of_estimate:.5}", term.basis);
            assert!(term.reach.is_some() && (of_law / of_estimate - 1.0).abs() < 0.02);
        }
        let other = law(&found, &runs[0], joint, None, &["v", "tanh(9*v)"]);
        let reach = other.result.law.coefficients()[1].reach.unwrap();
        let own = half(found.joints[joint].terms[1].coefficient.interval);
        assert!((0.5..2.0).contains(&(reach / own)), "{reach} {own}");
    }
}

#[test]
fn repeats_are_instruments_and_single_motions_have_none() {
    let of = Experiment { seconds: 6.0, phases: Some([0.3, 1.0, 2.2, 4.0, 0.7, 5.1]), ..noisy() };
    let truth = Pendulum::described();
    let mut random = SplitMix64::new(4);
    let mut runs: Vec<PreparedRun> = (0..3).map(|_| simulate(&truth, &of, &mut random).0).collect();
    let found = estimated(&runs);
    let instrumental = found.instrumental.as_ref().unwrap();
    assert_eq!(instrumental.source, InstrumentSource::Repeats);
    assert!(instrumental.p_value < 0.01, "{instrumental:?}");
    let said = texts(&found.findings, Severity::Note).join(" ");
    assert!(
        said.contains("least squares differs from instrumental variables") && said.contains("repeats"),
        "{said}"
    );
    runs.truncate(1);
    let alone = estimated(&runs);
    assert!(
        alone.instrumental.is_none()
            && texts(&alone.findings, Severity::Note).join(" ").contains("hold no instruments")
    );
    // Columns that only copy what was measured are no instruments, nor are those that the robot does not follow.
    let run = &runs[0];
    let desired = |factor: f64| {
        let times =
            |columns: &[Vec<f64>]| columns.iter().map(|c| c.iter().map(|x| factor * x).collect()).collect();
        DesiredMotion {
            positions: times(&run.positions),
            velocities: times(&run.velocities),
            accelerations: times(&run.accelerations),
        }
    };
    for factor in [0.0, 1.0] {
        let run = PreparedRun { desired: Some(desired(factor)), ..run.clone() };
        assert!(estimated(&[run]).instrumental.is_none(), "{factor}");
    }
}
