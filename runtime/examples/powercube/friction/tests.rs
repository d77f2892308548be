//! Tests of the verdicts of claims 5 to 9 in the short form, and of the condition that reverses each verdict.

#![allow(clippy::unwrap_used, reason = "test code")]

use super::angle::{self, GRAVITY_ERROR, NARROW, arm_samples};
use super::cases::{self, Beside, Recorded};
use super::data::{MEASURED, REPEAT, beta_alone, gamma_alone, opposed, periodic};
use super::{joints, library, methods, velocity};
use crate::arm::Friction;
use crate::study::{Part, Study};
use gelenk_report::{Claim, Verdict};

const SHORT: Study = Study { is_short: true };

/// Asserts the verdict of a claim, and its numbers within 5 %.
fn check(part: &Part, id: &str, verdict: Verdict, values: &[f64]) {
    let claim = part.claims.iter().find(|claim| claim.id == id);
    let claim = claim.unwrap_or_else(|| panic!("no {id}"));
    let measured: Vec<f64> = claim.criteria.iter().map(|one| one.value).collect();
    assert_eq!(claim.verdict(), verdict, "{id}: {measured:?}");
    assert_eq!(measured.len(), values.len(), "{id}: {measured:?}");
    for (found, expected) in measured.iter().zip(values) {
        let close = (found - expected).abs() <= 0.05 * expected.abs();
        assert!(close, "{id}: {measured:?}, expected {values:?}");
    }
}

fn is_flipped(claim: Claim) {
    let numbers: Vec<f64> = claim.criteria.iter().map(|one| one.value).collect();
    assert_eq!(claim.verdict(), Verdict::DoesNotHold, "{}: {numbers:?}", claim.id);
}

#[test]
fn velocities_from_encoders() {
    let part = velocity::experiment(&SHORT).unwrap();
    check(&part, "claim-5a", Verdict::Holds, &[2.146, 5.755]);
    check(&part, "claim-5b", Verdict::Holds, &[7.878, 100.8]);
    check(&part, "claim-5c", Verdict::Holds, &[0.9996, 1.653e-4]);
}

#[test]
fn fine_encoders_need_no_smoothing() {
    let step = 0.01 * MEASURED.encoder_step;
    let logs = [step, 10.0 * step].map(|step| velocity::measured_like(step, 20.0).unwrap());
    is_flipped(velocity::encoder_claim(&logs, step));
}

#[test]
fn without_noise_differences_do() {
    is_flipped(velocity::synthetic_claim(&velocity::synthetic(1e-6, 20.0).unwrap()));
}

#[test]
fn the_weight_decides_what_passes() {
    for factor in [1e-6, 1e4] {
        let filter = velocity::LowPass::new(factor, 20.0).unwrap();
        is_flipped(velocity::low_pass_claim(&filter).unwrap());
    }
}

#[test]
fn friction_and_the_angle() {
    let part = angle::experiment(&SHORT).unwrap();
    check(&part, "claim-6a", Verdict::Holds, &[0.9575, 0.4961]);
    check(&part, "claim-6b", Verdict::Holds, &[0.1158, 0.1829]);
    check(&part, "claim-6c", Verdict::Holds, &[0.00186]);
}

#[test]
fn with_the_right_gravity_friction_does_not_depend_on_the_angle() {
    let [beta, _] = arm_samples(&beta_alone(), 0.0, REPEAT).unwrap();
    let [_, gamma] = arm_samples(&gamma_alone(), 0.0, REPEAT).unwrap();
    is_flipped(angle::seeming_claim([&beta, &gamma]).unwrap());
}

#[test]
fn a_wide_selection_keeps_the_dependence() {
    let [beta, _] = arm_samples(&beta_alone(), GRAVITY_ERROR, REPEAT).unwrap();
    is_flipped(angle::selection_claim(&beta, 8.0 * NARROW).unwrap());
}

#[test]
fn other_motions_of_beta_do_not_help_gamma() {
    for motion in [periodic([0.7, 0.7]), gamma_alone()] {
        let [_, gamma] = arm_samples(&motion, GRAVITY_ERROR, REPEAT).unwrap();
        is_flipped(angle::opposed_claim(&gamma).unwrap());
    }
    let [_, gamma] = arm_samples(&opposed(), GRAVITY_ERROR, REPEAT).unwrap();
    assert!(angle::dependence(&gamma).unwrap() < 0.1);
}

#[test]
fn the_library_and_its_terms() {
    let part = library::experiment(&SHORT).unwrap();
    check(&part, "claim-7a", Verdict::Holds, &[283.1, -0.0110]);
    check(&part, "claim-7b", Verdict::Holds, &[4.0, 4.0]);
    check(&part, "claim-7c", Verdict::Holds, &[5.0, 0.0239]);
}

#[test]
fn another_step_without_noise_wants_finer_slopes() {
    let record = Recorded::b(Beside::STRIBECK, REPEAT, 2).unwrap();
    let case = record.case(0.0).unwrap();
    let mut samples = case.samples.clone();
    samples.torques = samples.velocities.iter().map(|v| case.truth(*v)).collect();
    let paper = library::fineness(&Friction::library().unwrap(), &samples).unwrap();
    let finer = library::fineness(&library::finer_library().unwrap(), &samples).unwrap();
    is_flipped(library::fineness_claim(&paper, &finer));
}

#[test]
fn without_noise_every_term_counts() {
    let truths = [Friction::A, Friction::B, Friction::C];
    let mut samples = library::joints(0.0, REPEAT).unwrap();
    for (samples, truth) in samples.iter_mut().zip(truths) {
        samples.torques = samples.velocities.iter().map(|v| truth.at(*v)).collect();
    }
    is_flipped(library::front_claim(&library::joint_fronts(&samples).unwrap()));
}

#[test]
fn folds_do_not_see_a_wrong_gravity() {
    let samples = library::joints(0.16, REPEAT).unwrap();
    is_flipped(library::choice_claim(&library::choices(&samples).unwrap()));
}

#[test]
fn methods_side_by_side() {
    let part = methods::experiment(&SHORT).unwrap();
    check(&part, "claim-8a", Verdict::Holds, &[0.1132, 0.0976]);
    check(&part, "claim-8b", Verdict::HoldsConditionally, &[4.040]);
    check(&part, "claim-8c", Verdict::HoldsConditionally, &[2.280]);
    check(&part, "claim-8d", Verdict::Holds, &[0.02945, 0.05898]);
    check(&part, "claim-8e", Verdict::HoldsConditionally, &[0.8350, 0.8812]);
    check(&part, "claim-8f", Verdict::Holds, &[1000.0, 2.057]);
}

#[test]
fn without_selection_a_wrong_gravity_spoils_the_law() {
    let cases = cases::joints(0.16, REPEAT).unwrap();
    is_flipped(methods::both_claim(&cases));
}

#[test]
fn without_an_offset_regression_does_not_fail_on_b() {
    let record = Recorded::b(Beside::NOTHING, REPEAT, 2).unwrap();
    let case = [record.case(GRAVITY_ERROR).unwrap()];
    is_flipped(methods::unfiltered_claim(&case, &case));
}

#[test]
fn with_stribeck_friction_regression_is_better_on_c() {
    let case = [Recorded::c(Beside::STRIBECK, REPEAT, 2).unwrap().case(GRAVITY_ERROR).unwrap()];
    is_flipped(methods::joint_c_claim(&case, &case));
}

#[test]
fn three_seconds_are_too_short() {
    is_flipped(methods::short_claim(&cases::joints(0.0, REPEAT).unwrap(), 3.0));
}

#[test]
fn slow_data_or_a_wrong_gravity_do_not_carry_on() {
    let right = cases::joints(0.0, REPEAT).unwrap();
    is_flipped(methods::outside_claim(&right, 0.05));
    let wrong = cases::joints(GRAVITY_ERROR, REPEAT).unwrap();
    is_flipped(methods::outside_claim(&wrong, cases::SLOW));
}

#[test]
fn slow_speeds_save_thresholding() {
    let [_, all, _] = cases::joints(GRAVITY_ERROR, REPEAT).unwrap();
    is_flipped(methods::breaks_claim(&all, std::slice::from_ref(&all)));
}

#[test]
fn joints_and_load() {
    let part = joints::experiment(&SHORT).unwrap();
    check(&part, "claim-9a", Verdict::Holds, &[1.598]);
    check(&part, "claim-9b", Verdict::Holds, &[15.709, 4.497]);
    check(&part, "claim-9c", Verdict::Holds, &[0.9680, 0.0987]);
}

#[test]
fn equal_friction_is_not_told_apart() {
    let laws = joints::laws([Friction::B; 3], REPEAT).unwrap();
    is_flipped(joints::difference_claim(&laws).unwrap());
}

#[test]
fn the_common_curve_fits_a_plant_that_has_it() {
    let laws = joints::laws([Friction::OLD; 3], REPEAT).unwrap();
    is_flipped(joints::stand_in_claim(&laws).unwrap());
}

#[test]
fn without_the_load_term_load_changes_nothing() {
    let (isolated, _) = joints::under_load(0.0, 0.0, REPEAT).unwrap();
    let assembled = joints::under_load(0.0, 1.0, REPEAT).unwrap();
    is_flipped(joints::load_claim(&isolated, &assembled).unwrap());
}
