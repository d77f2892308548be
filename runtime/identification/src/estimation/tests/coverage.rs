//! Whether intervals hold what they promise, over logs as strangers have them: closed loop, encoders, the whole
//! preparation.

use super::super::super::friction::{
    Filtered, FilteredRun, FrictionData, FrictionIdentification, FrictionMethod, FrictionReport,
};
use super::super::super::identify::instrumental;
use super::super::super::library::Library;
use super::super::super::preparation::{Filter, PreparationSettings, prepare_all};
use super::super::super::random::SplitMix64;
use super::super::super::run::PreparedRun;
use super::super::{Estimate, EstimationSettings, Uncertain, estimate};
use super::pendulum::{Experiment, FRICTION, Pendulum, STEEPNESS, log};
use std::f64::consts::PI;

/// A way of recording.
#[derive(Clone, Copy)]
struct Regime {
    name: &'static str,
    rate: f64,
    bits: u32,
    seconds: f64,
}

const REGIMES: [Regime; 6] = [
    Regime { name: "slow and coarse", rate: 100.0, bits: 12, seconds: 30.0 },
    Regime { name: "slow and fine", rate: 125.0, bits: 20, seconds: 20.0 },
    Regime { name: "fast and coarse", rate: 1000.0, bits: 12, seconds: 10.0 },
    Regime { name: "fast and fine", rate: 1000.0, bits: 20, seconds: 10.0 },
    Regime { name: "short", rate: 250.0, bits: 16, seconds: 6.0 },
    Regime { name: "long", rate: 500.0, bits: 16, seconds: 30.0 },
];

impl Regime {
    fn experiment(&self) -> Experiment {
        Experiment {
            rate: self.rate,
            seconds: self.seconds,
            resolution: 2.0 * PI / f64::from(1_u32 << self.bits),
            position_noise: 1e-6,
            slope_time: 0.01,
            ..Experiment::default()
        }
    }

    /// - `filtered`: whether columns of friction pass the preparation's filter, as they do in `identify`
    fn estimated(&self, seed: u64, filtered: bool) -> Found {
        let mut random = SplitMix64::new(seed);
        let truth = Pendulum::described().other(0.1, &mut random);
        let run = log(&truth, &self.experiment(), &mut random);
        let described = Pendulum::described();
        let (runs, preparation) =
            prepare_all(&[run], Some(&described), &PreparationSettings::default()).unwrap();
        let settings = EstimationSettings {
            steepness: Some(vec![STEEPNESS; 2]),
            accept_poor: true,
            filter: filtered.then(|| preparation.filter.clone()),
            ..EstimationSettings::default()
        };
        let estimate = estimate(&described, &runs, &settings, &mut |_| ()).unwrap();
        Found { truth, estimate, runs, filter: preparation.filter }
    }

    /// Share of the intervals that hold the truth, over logs and values.
    fn coverage(&self, logs: u64) -> f64 {
        let mut hits = [[0.0; 3]; VALUES];
        let mut in_laws = 0.0;
        for seed in 0..logs {
            let found = self.estimated(seed, true);
            in_laws += found.share_of_laws();
            let values = pairs(&found.estimate, &found.truth);
            for ((value, truth), [hit, sum, squares]) in values.into_iter().zip(&mut hits) {
                let error = (value.value - truth) / value.standard_error;
                let holds = value.interval[0] <= truth && truth <= value.interval[1];
                (*hit, *sum, *squares) =
                    (*hit + f64::from(u8::from(holds)), *sum + error, *squares + error * error);
            }
        }
        let n = logs as f64;
        let share = hits.iter().map(|h| h[0]).sum::<f64>() / (n * VALUES as f64);
        let in_laws = in_laws / n;
        println!("{}: pooled {share:.3}; 95 % intervals of friction laws {in_laws:.3}", self.name);
        for [hit, sum, squares] in hits {
            let rms = (squares / n).sqrt();
            println!(
                "  {:.2}, errors {:+.2} on average and {rms:.2} rms, in standard errors",
                hit / n,
                sum / n
            );
        }
        share
    }
}

/// What was found in a log.
struct Found {
    truth: Pendulum,
    estimate: Estimate,
    runs: Vec<PreparedRun>,
    filter: Filter,
}

impl Found {
    /// Share of the coefficients of friction laws whose intervals hold the truth.
    fn share_of_laws(&self) -> f64 {
        let terms = ["v".to_owned(), format!("tanh({STEEPNESS}*v)")];
        let terms = terms.each_ref().map(String::as_str);
        let hits = (0..2).flat_map(|joint| {
            let result = law(&self.estimate, &self.runs[0], joint, Some(&self.filter), &terms).result;
            let t = result.interval_factor();
            let ends: Vec<[f64; 2]> =
                result.law.coefficients().iter().filter_map(|term| term.ends(t)).collect();
            ends.into_iter().zip(FRICTION[joint])
        });
        hits.map(|([low, high], truth)| f64::from(u8::from(low <= truth && truth <= high)) / 4.0).sum()
    }
}

/// The law of a joint with given terms, as `identify` finds it.
pub(super) fn law(
    found: &Estimate,
    run: &PreparedRun,
    joint: usize,
    filter: Option<&Filter>,
    terms: &[&str],
) -> FrictionReport {
    let velocities = &run.velocities[joint];
    let kept: Vec<usize> = (0..velocities.len()).filter(|i| !run.rests(joint, *i)).collect();
    let of = |column: &[f64]| kept.iter().map(|i| column[*i]).collect::<Vec<f64>>();
    let instrumental = instrumental(found, joint);
    let filtered =
        filter.map(|filter| Filtered { filter, runs: vec![FilteredRun { velocities, kept: kept.clone() }] });
    let data = FrictionData {
        joint: "joint",
        unit: "N·m",
        velocity_unit: "rad/s",
        velocities: &of(velocities),
        torques: &of(&found.friction[0][joint]),
        instrumental: instrumental.as_ref(),
        filtered: filtered.as_ref(),
        ..FrictionData::default()
    };
    let settings = FrictionIdentification {
        library: Library::new(terms, &["v"]).unwrap(),
        method: FrictionMethod::LeastSquares,
        passive: false,
        draws: 0,
        ..FrictionIdentification::new().unwrap()
    };
    settings.identify(&data).unwrap()
}

/// Values whose intervals are looked at.
const VALUES: usize = 11;

/// Values and truths: friction of both joints, and parameters with a column in W.
fn pairs(found: &Estimate, truth: &Pendulum) -> Vec<(Uncertain, f64)> {
    let friction = found.joints.iter().zip(FRICTION);
    let friction = friction.flat_map(|(j, truth)| j.terms.iter().map(|t| t.coefficient).zip(truth));
    let inertial = [1, 2, 9, 10, 11, 12, 19].map(|i| (found.parameters[i], truth.parameters[i]));
    friction.chain(inertial).collect()
}

/// `REGIME=short` takes the regimes whose names begin so, `LOGS=20` fewer logs.
#[test]
#[ignore = "600 logs, 10 minutes: cargo test --release -p gelenk-identification --lib intervals_hold -- --ignored --nocapture"]
fn intervals_hold_what_they_promise_in_every_regime() {
    let logs = std::env::var("LOGS").ok().and_then(|text| text.parse().ok()).unwrap_or(100);
    let only = std::env::var("REGIME").unwrap_or_default();
    for regime in REGIMES.iter().filter(|regime| regime.name.starts_with(&only)) {
        let share = regime.coverage(logs);
        assert!((0.85..=0.95).contains(&share), "{}: {share}", regime.name);
    }
}

#[test]
fn friction_through_the_filter_of_the_efforts_is_not_biased_by_coarse_encoders() {
    let regime = Regime { seconds: 15.0, ..REGIMES[0] };
    let errors = |filtered: bool| {
        let of = |seed: u64| {
            let found = regime.estimated(seed, filtered);
            let (value, truth) = pairs(&found.estimate, &found.truth)[1];
            value.value / truth - 1.0
        };
        0.5 * (of(0) + of(1))
    };
    let [sharp, rounded] = [false, true].map(errors);
    println!("Coulomb friction is off by {sharp:+.3}, and by {rounded:+.3} through the filter");
    assert!(rounded.abs() < 0.75 * sharp.abs(), "{sharp} {rounded}");
}
