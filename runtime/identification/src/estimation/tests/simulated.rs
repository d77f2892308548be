//! Estimates of a simulated robot whose parameters are known.

use super::super::super::random::SplitMix64;
use super::super::super::run::{Effort, PreparedRun};
use super::super::{Estimate, EstimationSettings, Offsets, Uncertain, estimate};
use super::pendulum::{Experiment, FRICTION, Pendulum, STEEPNESS, simulate};

fn quietly(robot: &Pendulum, runs: &[PreparedRun], settings: &EstimationSettings) -> Estimate {
    estimate(robot, runs, settings, &mut |_| ()).unwrap()
}

/// Values that a log decides, with the truth: friction, offsets aside, and parameters with a column in W.
fn pairs(found: &Estimate, truth: &Pendulum) -> Vec<(String, Uncertain, f64)> {
    let mut pairs = Vec::new();
    for (j, joint) in found.joints.iter().enumerate() {
        for (k, term) in joint.terms.iter().take(2).enumerate() {
            pairs.push((format!("{} {}", joint.name, term.basis), term.coefficient, FRICTION[j][k]));
        }
    }
    for i in [1, 2, 9, 10, 11, 12, 19] {
        pairs.push((format!("p{i}"), found.parameters[i], truth.parameters[i]));
    }
    pairs
}

#[test]
#[ignore = "100 logs: cargo test -p gelenk-identification --release --lib intervals_cover -- --ignored --nocapture"]
fn intervals_cover_the_truth_in_a_hundred_logs() {
    let logs: u64 = std::env::var("LOGS").map_or(100, |x| x.parse().unwrap());
    let (mut hits, mut all) = (std::collections::BTreeMap::<String, (usize, f64, f64)>::new(), 0);
    let settings =
        EstimationSettings { steepness: Some(vec![STEEPNESS; 2]), ..EstimationSettings::default() };
    for seed in 0..logs {
        let mut random = SplitMix64::new(seed);
        let truth = Pendulum::described().other(0.1, &mut random);
        let (run, _) = simulate(&truth, &Experiment::default(), &mut random);
        let found = quietly(&Pendulum::described(), &[run], &settings);
        for (name, value, truth) in pairs(&found, &truth) {
            let name = if name.contains("tanh") {
                name.split(' ').next().unwrap().to_string() + " tanh"
            } else {
                name
            };
            let entry = hits.entry(name).or_default();
            entry.0 += usize::from(value.interval[0] <= truth && truth <= value.interval[1]);
            entry.1 += (value.value - truth) / value.standard_error;
            entry.2 += ((value.value - truth) / value.standard_error).powi(2);
        }
        if seed < 3 {
            for j in &found.joints {
                println!("{} {:.4} {:?}", j.held_out_r_squared, j.sigma, j.terms);
            }
            println!("{:?} {:?}", found.choices, found.warnings);
            for (n, v, t) in pairs(&found, &truth) {
                println!("{n} {:.5} ± {:.5} {:.5}", v.value, v.standard_error, t);
            }
        }
        all += 1;
    }
    let total: usize = hits.values().map(|h| h.0).sum();
    for (name, (hit, mean, squares)) in &hits {
        println!(
            "{name}: {hit} of {all}, mean {:.2}, rms {:.2} standard errors",
            mean / all as f64,
            (squares / all as f64).sqrt()
        );
    }
    let share = total as f64 / (hits.len() * all) as f64;
    println!("pooled {share:.3}");
    assert!((0.85..=0.95).contains(&share), "{share}");
}
