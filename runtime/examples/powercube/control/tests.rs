//! Tests of the verdicts of the short form, and of the condition that reverses each verdict.

use super::identified::FrictionSamples;
use super::*;
use crate::arm::{self, Arm, Friction, GEAR, PEAK, PERIOD, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Claim, Verdict};
use gelenk_runtime::adaptation::AdaptationSettings;
use gelenk_runtime::trajectory::Sampled;

const SHORT: Study = Study { is_short: true };
/// Length of the identification motion in the short form (s).
const DURATION: f64 = 30.0;

fn reference() -> Sampled<2> {
    arm::reference().unwrap()
}

fn identified() -> Arm {
    let plant = arm([Friction::B, Friction::C]);
    arm(identified::identify(plant, plant, DURATION).unwrap())
}

/// Asserts the verdict of the only claim of an experiment, and its numbers within a relative tolerance.
fn holds(experiment: fn(&Study) -> Outcome<Part>, verdict: Verdict, expected: &[(f64, f64)]) {
    let part = experiment(&SHORT).unwrap();
    let [claim] = &part.claims[..] else {
        panic!("one claim");
    };
    let found: Vec<f64> = claim.criteria.iter().map(|one| one.value).collect();
    println!("{}: {}, {found:?}", claim.id, claim.verdict());
    assert_eq!(claim.verdict(), verdict, "{found:?}");
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, (value, share)) in found.iter().zip(expected) {
        assert!((found - value).abs() <= share * value.abs(), "{found}, not {value}");
    }
}

/// Asserts that the claim does not hold, and that exactly the criteria `missed` are violated.
fn flipped(claim: &Claim, missed: &[usize]) {
    let found: Vec<usize> = (0..claim.criteria.len()).filter(|&i| !claim.criteria[i].is_met()).collect();
    println!("{}: {:?}", claim.id, claim.criteria);
    assert_eq!(claim.verdict(), Verdict::DoesNotHold);
    assert_eq!(found, missed, "{:?}", claim.criteria);
}

#[test]
fn mpc_follows_what_feed_forward_leaves() {
    let expected = [(0.0393, 0.05), (189.6, 0.1)];
    holds(tracking::experiment, Verdict::HoldsConditionally, &expected);
    // Nothing disturbs the arm.
    flipped(&tracking::claim(&tracking::pair(&reference(), 0.0).unwrap()), &[1]);
}

#[test]
fn identified_friction_closes_the_gap() {
    let expected = [(15.29, 0.02), (25.8, 0.1), (0.14, 0.2), (4.75, 0.02), (11.2, 0.1), (0.336, 0.2)];
    holds(gap::experiment, Verdict::Holds, &expected);
    // The right friction given to the old model.
    let right = gap::models(&reference(), [Friction::B, Friction::C], gap::TOO_HEAVY, DURATION);
    flipped(&gap::claim(&right.unwrap()), &[0, 1, 3, 4]);
    // Without an error of the rigid body nothing is left for it to explain.
    let rigid = gap::models(&reference(), [Friction::OLD; 2], 0.0, DURATION);
    flipped(&gap::claim(&rigid.unwrap()), &[2, 5]);
}

#[test]
fn delay_hides_better_friction() {
    let expected = [(44.1, 0.2), (0.81, 0.2), (31.1, 0.2), (0.93, 0.15)];
    holds(regimes::experiment, Verdict::HoldsConditionally, &expected);
    let case = regimes::Case::new(&SHORT).unwrap();
    let compare = |regime, control| regimes::Comparison::new(&case, regime, control).unwrap();
    let ideal = compare(Regime::IDEAL, regimes::OFFSET_FREE);
    let punctual = Regime { delay: 0, ..Regime::REALISTIC };
    let compensated = regimes::Control { compensates_delay: true, ..regimes::OFFSET_FREE };
    let slower = regimes::Control { rate_weight: regimes::SLOWER, ..regimes::OFFSET_FREE };
    let without_observer = regimes::Control { disturbance_noise: 0.0, ..regimes::OFFSET_FREE };
    for (regime, control) in [
        (punctual, regimes::OFFSET_FREE),
        (Regime::REALISTIC, compensated),
        (Regime::REALISTIC, slower),
        (Regime::REALISTIC, without_observer),
    ] {
        flipped(&regimes::claim(&ideal, &compare(regime, control)), &[1, 3]);
    }
}

#[test]
fn nonlinear_prediction_pays_where_sampling_is_coarse_or_deviations_large() {
    let expected = [(1.68, 0.1), (512.0, 0.5), (1.43, 0.1), (242.0, 0.5)];
    holds(nonlinear::experiment, Verdict::HoldsConditionally, &expected);
    let (model, reference) = (identified(), reference());
    let along = |period| nonlinear::along(model, &reference, period).unwrap();
    let motion = |duration| nonlinear::deviation(model, PERIOD, duration).unwrap();
    let (coarse, large) = (along(nonlinear::COARSE), motion(nonlinear::TOO_FAST));
    flipped(&nonlinear::claim(&along(PERIOD), &large), &[0, 2]);
    flipped(&nonlinear::claim(&coarse, &motion(4.0)), &[1, 3]);
}

#[test]
fn limits_are_reached_and_kept() {
    let expected = [
        (121.0, 0.05),
        (GEAR * PEAK, 1e-9),
        (0.0149, 0.2),
        (594.0, 0.05),
        (0.4014, 0.002),
        (2.701, 1e-3),
        (1.948, 1e-3),
    ];
    holds(limits::experiment, Verdict::Holds, &expected);
    let (model, reference) = (identified(), reference());
    let fast = |factor| limits::torque_limited(model, &reference, factor, GEAR * PEAK).unwrap();
    let slow = |speed| limits::speed_limited(model, &reference, speed, limits::PENALTY).unwrap();
    // As slow as published, the trajectory stays below the peak torque.
    flipped(&limits::claim(&fast(1.0), &slow(limits::SPEED)), &[0]);
    // A limit above all desired speeds is none.
    flipped(&limits::claim(&fast(limits::FACTOR), &slow(1.0)), &[4]);
    // With the nominal torque the arm does not come back in time.
    let nominal = limits::torque_limited(model, &reference, limits::FACTOR, limits::NOMINAL);
    flipped(&limits::claim(&nominal.unwrap(), &slow(limits::SPEED)), &[0, 2]);
}

#[test]
fn the_worst_period_takes_few_iterations() {
    holds(timing::experiment, Verdict::Holds, &[(11.0, 0.15), (100.0, 0.01), (9.0, 0.3)]);
    let plant = arm([Friction::B, Friction::C]);
    let samples = identified::record(plant, plant, DURATION).unwrap();
    let passes = [0, 1].map(|joint| timing::passes(&samples, joint).unwrap());
    let faster = timing::worst_iterations(identified(), &reference(), 6.0 * limits::FACTOR).unwrap();
    assert_eq!(timing::claim(faster, passes).verdict(), Verdict::Holds);
    flipped(&timing::claim(16, passes), &[0]);
    let free =
        FrictionSamples { torques: samples.velocities.each_ref().map(|v| vec![0.0; v.len()]), ..samples };
    let passes = [0, 1].map(|joint| timing::passes(&free, joint).unwrap());
    flipped(&timing::claim(0, passes), &[1, 2]);
}

#[test]
fn friction_is_followed_in_operation() {
    let expected = [(2.68, 0.1), (154.5, 0.2), (4.06, 0.1), (59.7, 0.2)];
    holds(adaptation::experiment, Verdict::Holds, &expected);
    // A law that may not change.
    let settings = AdaptationSettings { drift_times: [1e12; 4], patience: 1e12, ..adaptation::at_once() };
    let kept = adaptation::adaptation(&reference(), settings, DURATION).unwrap();
    flipped(&adaptation::claim(&kept), &[0, 1, 2, 3]);
}

#[test]
fn gears_that_warm_up_are_followed() {
    let settings = AdaptationSettings::new(PERIOD);
    let claim = |plant: changes::Change, settings, seconds| {
        changes::warming_claim(&changes::warm_up(&reference(), (plant, settings, seconds), DURATION).unwrap())
    };
    let found = claim(changes::warming, settings, changes::WARM);
    println!("{:?}", found.criteria);
    assert_eq!(found.verdict(), Verdict::Holds, "{:?}", found.criteria);
    let kept = AdaptationSettings { drift_times: [1e12; 4], patience: 1e12, ..settings };
    flipped(&claim(changes::warming, kept, changes::WARM), &[0, 2]);
    flipped(&claim(changes::unchanged, settings, 60.0), &[1, 3]);
}

#[test]
fn a_load_that_is_picked_up_is_found() {
    let claim = |plant: changes::Change, heaviest| {
        changes::load_claim(&changes::pick_up(&reference(), (plant, heaviest), DURATION).unwrap())
    };
    let found = claim(changes::picking_up, changes::HEAVIEST);
    println!("{:?}", found.criteria);
    assert_eq!(found.verdict(), Verdict::Holds, "{:?}", found.criteria);
    flipped(&claim(changes::picking_up, 0.0), &[0, 2]);
    flipped(&claim(changes::unchanged, changes::HEAVIEST), &[1, 3]);
}

/// Two runs give bitwise equal data, except for measured times.
#[test]
fn experiments_repeat_themselves() {
    for experiment in [tracking::experiment as fn(&Study) -> _, adaptation::experiment] {
        let run = || {
            let part = experiment(&SHORT).unwrap();
            crate::page::report(&SHORT, vec![part]).unwrap().json()
        };
        assert_eq!(run(), run());
    }
}
