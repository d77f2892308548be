//! Requirements on `prepare_all` about lengths, gaps, faults and settings.

use super::super::super::run::{Effort, Run};
use super::super::{JointPreparation, PreparationReport, PreparationSettings, prepare_all};
use super::arm::Arm;
use super::simulated::{GOOD, Sampling, log};
use gelenk_findings::Finding;

fn recorded() -> Run {
    log(&Arm::pendulum(), &Sampling { rate: 200.0, ..GOOD }, 8.0, 3).0
}

fn message(run: &Run, settings: &PreparationSettings) -> String {
    prepare_all(std::slice::from_ref(run), None, settings).unwrap_err().to_string()
}

#[test]
fn a_prepared_run_is_even_and_consistent() {
    let (runs, report) = prepare_all(&[recorded()], None, &PreparationSettings::default()).unwrap();
    let (run, step) = (&runs[0], runs[0].step());
    let columns = [&run.positions, &run.velocities, &run.accelerations, &run.efforts];
    assert!(columns.iter().all(|c| c.len() == 2 && c.iter().all(|x| x.len() == run.times.len())));
    assert!(run.times.windows(2).all(|t| (t[1] - t[0] - step).abs() < 1e-9));
    assert!(run.rows.iter().zip(&run.times).all(|(row, t)| (*row as f64 - 2.0 - 200.0 * t).abs() < 1.0));
    for j in 0..2 {
        let (y, v, a) = (&run.positions[j], &run.velocities[j], &run.accelerations[j]);
        for i in 1..y.len() - 1 {
            let slope = (y[i + 1] - y[i - 1]) / (2.0 * step);
            let bend = (y[i + 1] - 2.0 * y[i] + y[i - 1]) / (step * step);
            assert!(
                (slope - v[i]).abs() < 0.02 && (bend - a[i]).abs() < 0.2,
                "{i} {slope} {} {bend} {}",
                v[i],
                a[i]
            );
        }
        assert_eq!((report.joints[j].fault.as_ref(), report.joints[j].moves), (None, true));
        assert!((report.joints[j].resolution - 9.587e-5).abs() < 1e-7);
    }
}

#[test]
fn gaps_split_and_faults_are_named() {
    let mut run = recorded();
    run.positions[0][700..760].fill(f64::NAN);
    run.positions[1][300] += 1.0;
    run.efforts[1].fill(0.25);
    run.efforts[0][1599] = f64::NAN;
    let (runs, report) = prepare_all(&[run], None, &PreparationSettings::default()).unwrap();
    assert_eq!(runs.len(), 2);
    assert!(runs[0].times.last().unwrap() < &3.5 && runs[1].times[0] > 3.8);
    let said: Vec<String> = report.findings.iter().map(Finding::sentence).collect();
    assert_eq!(said[0], "simulated 3: it is split at 1 gap of 0.305 s after row 701");
    assert!(
        said[1].ends_with("joint joint 2: 1 spike of its position is left out. It is in row 302"),
        "{said:?}"
    );
    let fault = report.joints[1].fault.as_ref().unwrap();
    assert_eq!(fault.message, "its effort is 0.25 in every row from row 2 on");
    assert!(runs.iter().all(|r| r.efforts[1].iter().all(|u| u.is_nan())));
    assert!(runs.iter().all(|r| r.efforts[0].iter().chain(&r.accelerations[0]).all(|x| x.is_finite())));
}

#[test]
fn inputs_through_unit_gears_are_joint_efforts() {
    let arm = Arm::pendulum();
    let (run, _) = log(&arm, &Sampling { rate: 60.0, delay: 0.03, ..GOOD }, 8.0, 3);
    let inputs = Run { effort: Effort::Input, ..run.clone() };
    let of = |run: Run| prepare_all(&[run], Some(&arm), &PreparationSettings::default()).unwrap();
    let ((joints, report), (mut same, other)) = (of(run), of(inputs));
    assert_eq!(report.delays, other.delays);
    assert!(report.delays.iter().all(|d| (d.removed - 0.03).abs() < 2e-3), "{:?}", report.delays);
    same[0].effort = Effort::Joint;
    assert_eq!(joints, same);
}

#[test]
fn settings_hold_or_are_refused_by_name() {
    let run = recorded();
    let settings = PreparationSettings {
        bandwidth: Some(5.0),
        rate: Some(40.0),
        delay: Some(0.02),
        ..Default::default()
    };
    let (_, report) = prepare_all(std::slice::from_ref(&run), None, &settings).unwrap();
    assert_eq!((report.filter.bandwidth(), report.joints[0].delay), (5.0, 0.02));
    assert!((report.sample_rate - 40.0).abs() < 1e-6);
    let with = |change: &dyn Fn(&mut PreparationSettings)| {
        let mut settings = PreparationSettings::default();
        change(&mut settings);
        message(&run, &settings)
    };
    assert!(with(&|s| s.bandwidth = Some(60.0)).contains("bandwidth = 60 is not possible"));
    assert!(with(&|s| s.bandwidth = Some(f64::NAN)).contains("bandwidth = NaN is not possible"));
    assert!(with(&|s| s.delay = Some(5.0)).contains("delay = 5 is not possible"));
    assert!(with(&|s| s.cut = Some(5.0)).contains("`PreparationSettings::cut`"));
    assert!(with(&|s| s.largest_gap = Some(0.0)).contains("largest_gap = 0 is not possible"));
}

#[test]
fn runs_that_cannot_be_prepared_say_why() {
    let none = PreparationSettings::default();
    assert!(prepare_all(&[], None, &none).unwrap_err().to_string().contains("empty"));
    let mut run = recorded();
    run.positions[1].fill(f64::NAN);
    assert!(message(&run, &none).contains("the measured position of joint 2 in run simulated 3 is empty"));
    let mut run = recorded();
    run.times[5] = run.times[4];
    assert!(
        message(&run, &none).contains("simulated 3, row 7: the time does not increase"),
        "{}",
        message(&run, &none)
    );
    let mut run = recorded();
    run.positions.iter_mut().for_each(|y| y.fill(0.5));
    assert!(message(&run, &none).contains("is constant (0.5)"), "{}", message(&run, &none));
    let mut run = recorded();
    run.efforts.pop();
    let message = prepare_all(&[recorded(), run], None, &none).unwrap_err().to_string();
    assert!(message.contains("efforts of run simulated 3: 2 are expected, but 1 are given"), "{message}");
}

#[test]
fn what_the_estimate_finds_left_of_delays_is_added_and_said() {
    let (_, mut report) = prepare_all(&[recorded()], None, &PreparationSettings::default()).unwrap();
    let said = |report: &PreparationReport| -> Vec<String> {
        report
            .findings
            .iter()
            .map(Finding::sentence)
            .filter(|note| note.contains("its effort comes"))
            .collect()
    };
    assert!(said(&report).is_empty());
    report.refine(&[[3e-3, 1e-4], [2e-4, 3e-4]]);
    assert_eq!([report.delays[0].removed, report.joints[1].delay], [3e-3, 2e-4]);
    // The second delay does not differ significantly from zero.
    let notes = said(&report);
    assert!(
        notes.len() == 1 && notes[0].starts_with("joint joint 1: its effort comes 3.0 ms after"),
        "{notes:?}"
    );
    report.refine(&[[-4e-3, 1e-4], [0.0, 3e-4]]);
    let notes = said(&report);
    assert!(
        notes.len() == 1 && notes[0].starts_with("joint joint 1: its effort comes 1.0 ms before"),
        "{notes:?}"
    );
    report.refine(&[]);
    assert_eq!(said(&report), notes);
}

/// Six joints with one delay used to have six identical notes.
#[test]
fn a_delay_that_joints_share_is_said_once() {
    let (_, mut report) = prepare_all(&[recorded()], None, &PreparationSettings::default()).unwrap();
    let [first, second] = [report.joints[0].clone(), report.joints[1].clone()];
    let third = JointPreparation { name: "joint 3".into(), ..first.clone() };
    report.delays.push(report.delays[0]);
    report.joints = vec![first, second, third];
    let late = |report: &PreparationReport| -> Vec<String> {
        report
            .findings
            .iter()
            .map(Finding::sentence)
            .filter(|note| note.contains("This delay is removed"))
            .collect()
    };
    report.refine(&[[18.3e-3, 1e-3]; 3]);
    assert_eq!(
        late(&report),
        ["the efforts of all joints come 18.3 ms after the positions. This delay is removed"]
    );
    report.refine(&[[-20.3e-3, 1e-4], [1e-3, 1e-4], [-20.3e-3, 1e-4]]);
    let notes = late(&report);
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes[0].starts_with("the efforts of joint 1, joint 3 come 2.0 ms before the positions."));
    assert!(notes[1].starts_with("joint joint 2: its effort comes 19.3 ms after its position."), "{notes:?}");
}
