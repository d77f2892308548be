//! Logs of a simulated arm with one joint, reduced and added up.

use super::super::error::Result;
use super::super::estimation::{Columns, Gravity, RunPiece, Weighted};
use super::super::friction::tests::band;
use super::super::identify::{Identification, IdentificationSettings, identify};
use super::super::numeric::levels::varied::page;
use super::super::numeric::random::SplitMix64;
use super::super::result::{FrictionLaw, FrictionTerm};
use super::super::robot::{JointLimits, Robot};
use super::super::run::{Effort, PreparedRun};
use super::{LogMoments, identify_moments, levels, reduce};
use gelenk_findings::{Severity, texts};
use nalgebra::DMatrix;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

const GRAVITY: f64 = 9.81;
/// True values of the arm: m c, J, viscous and Coulomb friction.
const TRUTH: [f64; 4] = [0.7, 0.2, 1.5, 0.8];
const DESCRIPTION: &[&[u8]] = &[b"arm"];

/// A link on a horizontal axis; y = 0 is horizontal.
struct Arm;

impl Robot for Arm {
    fn joint_names(&self) -> Vec<String> {
        vec!["arm".into()]
    }
    fn input_names(&self) -> Vec<String> {
        self.joint_names()
    }
    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"]
    }
    fn limits(&self) -> Vec<JointLimits> {
        vec![JointLimits { position: [-3.0, 3.0], velocity: 9.0, effort: 99.0 }]
    }
    fn parameter_names(&self) -> Vec<String> {
        (0..10).map(|i| format!("p{i}")).collect()
    }
    fn parameters(&self) -> Vec<f64> {
        vec![2.0, 0.5, 0.0, 0.0, 0.02, 0.0, 0.16, 0.0, 0.0, 0.16]
    }
    fn bodies(&self) -> usize {
        1
    }
    fn input_matrix(&self) -> Vec<f64> {
        vec![1.0]
    }
    fn inertial_regressor(&self, y: &[f64], _: &[f64], a: &[f64], regressor: &mut [f64]) {
        regressor.fill(0.0);
        (regressor[1], regressor[2], regressor[9]) = (GRAVITY * y[0].cos(), -GRAVITY * y[0].sin(), a[0]);
    }
    fn rigid_forces(&self, y: &[f64], _: &[f64], a: &[f64], forces: &mut [f64]) {
        forces[0] = 0.5 * GRAVITY * y[0].cos() + 0.16 * a[0];
    }
}

fn log(seed: u64, spikes: bool) -> String {
    log_of(seed, spikes, 20.0)
}

/// Ten seconds at 50 Hz with a separate offset and separate correlated noise, and Coulomb friction tanh(slope · v).
fn log_of(seed: u64, spikes: bool, slope: f64) -> String {
    log_with(seed, spikes, slope, TRUTH)
}

fn log_with(seed: u64, spikes: bool, slope: f64, truth: [f64; 4]) -> String {
    let mut random = SplitMix64::new(seed);
    let phases: Vec<f64> = (0..3).map(|_| 6.0 * random.uniform()).collect();
    let (offset, mut noise) = (0.3 * random.normal(), 0.0);
    let waves = [(0.5, 1.7), (0.35, 3.1), (0.2, 5.3)];
    let mut text = String::from("t [s],q1 [rad],tau1 [N m]\n");
    for i in 0..500 {
        let t = 0.02 * f64::from(i);
        let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            waves.iter().zip(&phases).map(|((size, w), phase)| size * of(*w, w * t + phase)).sum()
        };
        let (y, v, a) = (sum(&|_, x| x.sin()), sum(&|w, x| w * x.cos()), sum(&|w, x| -w * w * x.sin()));
        noise = 0.8 * noise + 0.03 * random.normal();
        let [mc, j, viscous, coulomb] = truth;
        let torque =
            mc * GRAVITY * y.cos() + j * a + viscous * v + coulomb * (slope * v).tanh() + offset + noise;
        let spike = if spikes && i % 83 < 4 { 6.0 } else { 0.0 };
        text.push_str(&format!("{t:.4},{y:.6},{:.5}\n", torque + spike));
    }
    text
}

fn settings() -> IdentificationSettings {
    let mut settings = IdentificationSettings::new().unwrap();
    settings.preparation.bandwidth = Some(8.0);
    settings.preparation.delay = Some(0.0);
    settings
}

fn reduced(folder: &Path, name: &str, text: &str, settings: &IdentificationSettings) -> Result<LogMoments> {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    reduce(&Arm, DESCRIPTION, &path, settings, &mut |_| ())
}

/// Six logs as files, and their moments: made once for all tests.
fn fleet() -> &'static (tempfile::TempDir, Vec<PathBuf>, Vec<LogMoments>) {
    static FLEET: OnceLock<(tempfile::TempDir, Vec<PathBuf>, Vec<LogMoments>)> = OnceLock::new();
    FLEET.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<String> = (1..=6).map(|i| format!("{i}.csv")).collect();
        let one = |(name, seed)| reduced(folder.path(), name, &log(seed, false), &settings()).unwrap();
        let moments = names.iter().map(String::as_str).zip(1..).map(one).collect();
        let paths = names.iter().map(|name| folder.path().join(name)).collect();
        (folder, paths, moments)
    })
}

fn sum(parts: &[&LogMoments]) -> Result<LogMoments> {
    LogMoments::sum(parts.iter().enumerate().map(|(i, part)| Ok(((*part).clone(), format!("{i}.moments")))))
}

fn merged(moments: &LogMoments, settings: &IdentificationSettings) -> Result<Identification> {
    identify_moments(&Arm, DESCRIPTION, moments, settings, &mut |_| ())
}

/// The arm waits for a second before it moves. The samples of this second are not counted.
#[test]
fn moments_of_a_log_with_a_rest_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let moving = log(1, false);
    let (header, rows) = moving.split_once('\n').unwrap();
    let fields = |row: &str| -> Vec<f64> { row.split(',').map(|field| field.parse().unwrap()).collect() };
    let first = fields(rows.lines().next().unwrap());
    let rest = (0..50).map(|i| format!("{:.4},{:.6},{:.5}\n", 0.02 * f64::from(i), first[1], first[2]));
    let later = |row: &str| {
        let row = fields(row);
        format!("{:.4},{:.6},{:.5}\n", row[0] + 1.0, row[1], row[2])
    };
    let text: String =
        std::iter::once(format!("{header}\n")).chain(rest).chain(rows.lines().map(later)).collect();
    let moments = reduced(folder.path(), "waits.csv", &text, &settings()).unwrap();
    let read = LogMoments::from_bytes(&moments.bytes(), "waits.moments").unwrap();
    assert!(read.bytes() == moments.bytes() && read.samples() > 0);
}

#[test]
fn any_order_and_any_tree_give_the_same_bytes() {
    let (_, _, all) = fleet();
    let [a, b, c, d, e, f] = all.each_ref_array();
    let bytes = sum(&[a, b, c, d, e, f]).unwrap().bytes();
    assert_eq!(bytes, sum(&[f, c, a, e, d, b]).unwrap().bytes());
    let (left, right) = (sum(&[e, b]).unwrap(), sum(&[d, f, a, c]).unwrap());
    assert_eq!(bytes, sum(&[&right, &left]).unwrap().bytes());
    let read = LogMoments::from_bytes(&bytes, "all.moments").unwrap();
    assert_eq!(read.bytes(), bytes);
    assert_eq!(read.logs().len(), 6);
    assert!(read.logs().windows(2).all(|pair| pair[0].hash() < pair[1].hash()));
    // Twice as many logs have the same size, except for their names.
    let grown = bytes.len() - sum(&[a, b, c]).unwrap().bytes().len();
    println!("{} bytes for one log, {} for six", a.bytes().len(), bytes.len());
    assert!(bytes.len() < 16 * 1700 + 6 * 200 && grown < 16 * 1700);
}

trait EachRef<T> {
    fn each_ref_array<const N: usize>(&self) -> [&T; N];
}

impl<T> EachRef<T> for Vec<T> {
    fn each_ref_array<const N: usize>(&self) -> [&T; N] {
        self.iter().collect::<Vec<_>>().try_into().unwrap_or_else(|_| panic!("another number of items"))
    }
}

#[test]
fn the_sum_finds_what_the_arm_is_and_what_the_logs_themselves_give() {
    let (_, paths, all) = fleet();
    let found = merged(&sum(&all.iter().collect::<Vec<_>>()).unwrap(), &settings()).unwrap();
    let from_logs = identify(&Arm, paths, &settings(), &mut |_| ()).unwrap();
    let joint = &found.estimate.joints[0];
    assert!(joint.held_out_r_squared > 0.995, "{joint:?}");
    assert!(found.runs.is_empty() && found.recording.hashes.len() == 6);
    let [mc, j, viscous, coulomb] = TRUTH;
    for (place, truth) in [(1, mc), (2, 0.0), (9, j)] {
        let [value, other] = [&found, &from_logs].map(|found| found.estimate.parameters[place]);
        println!(
            "p{place} {truth}: {:.4} ± {:.4}, {:.4} from the logs",
            value.value, value.standard_error, other.value
        );
        assert!((value.value - truth).abs() < 4.0 * value.standard_error.max(1e-3));
        assert!((value.value - other.value).abs() < 4.0 * other.standard_error.max(1e-3));
    }
    let law = found.friction[0].report.as_ref().unwrap();
    println!("{}", law.result.formula());
    for (speed, truth) in [(1.0, viscous + coulomb), (-2.0, -2.0 * viscous - coulomb)] {
        let torque = law.result.law.torques(&[speed]).unwrap()[0];
        let band = band(law, &[speed], 0.999)[0];
        assert!((torque - truth).abs() < band.max(0.02), "{torque} ± {band}, {truth}");
    }
    assert!(law.result.settings.iter().any(|note| note.message
        == "the Stribeck law was not tried, because a file of moments does not contain the single samples"));
    let FrictionLaw::Terms(terms) = &law.result.law else { panic!("a law of terms") };
    assert!(terms.iter().all(|term| term.standard_error.is_some()));
    // Alike, not equal: offsets belong to runs here.
    let residual = |found: &Identification| found.friction[0].report.as_ref().unwrap().result.residual;
    let [here, there] = [&found, &from_logs].map(residual);
    assert!((here / there - 1.0).abs() < 0.1, "{here} {there}");
}

/// The options for reading belong to the logs. They are not repeated if moments are added.
#[test]
fn the_gravity_of_the_sum_is_that_of_its_logs() {
    let mut moments = sum(&fleet().2.iter().collect::<Vec<_>>()).unwrap();
    for (is_compensated, gravity) in [(false, Gravity::Recorded), (true, Gravity::Compensated)] {
        moments.about.gravity_compensated = is_compensated;
        assert_eq!(merged(&moments, &settings()).unwrap().estimate.gravity, gravity);
    }
}

#[test]
fn sums_are_those_of_the_centred_columns() {
    let mut random = SplitMix64::new(9);
    let mut column = |m: usize| -> Vec<f64> { (0..m).map(|_| random.normal()).collect() };
    let m = 700;
    let run = PreparedRun {
        poses: Vec::new(),
        resting: Vec::new(),
        name: "run".into(),
        times: (0..m).map(|i| i as f64).collect(),
        rows: (0..m).collect(),
        positions: vec![column(m)],
        velocities: vec![column(m)],
        accelerations: vec![column(m)],
        efforts: vec![column(m).iter().map(|x| x + 50.0).collect()],
        effort: Effort::Joint,
    };
    let columns = Columns::new(&Arm, Effort::Joint, &[1.0], vec![true]).unwrap();
    let weights = vec![vec![column(m).iter().map(|x| 0.5 + 0.5 / (1.0 + x * x)).collect::<Vec<f64>>()]];
    let residuals = vec![vec![vec![1.0; m]]];
    let weighted = Weighted { weights: &weights, residuals: &residuals };
    let pieces = [RunPiece { run: 0, rows: 0..300 }, RunPiece { run: 0, rows: 300..m }];
    let sums = columns.sums(&Arm, std::slice::from_ref(&run), Gravity::Recorded, None, &weighted, &pieces);
    let (y, v, a) = (&run.positions[0], &run.velocities[0], &run.accelerations[0]);
    let row = |i: usize| -> Vec<f64> {
        let (y, v, a) = (y[i], v[i], a[i]);
        let tanh = |k: f64| (k * v).tanh();
        let described = 0.5 * GRAVITY * y.cos() + 0.16 * a;
        let inertial = [GRAVITY * y.cos(), -GRAVITY * y.sin(), a];
        let terms = [v, tanh(100.0), tanh(20.0), tanh(10.0), tanh(5.0), v.abs(), a];
        let rest = [described, run.efforts[0][i], v.signum(), tanh(20.0).abs()];
        [&inertial[..], &terms, &rest].concat()
    };
    let q = columns.widths()[0];
    let all = DMatrix::from_fn(m, q, |i, k| row(i)[k]);
    let w = &weights[0][0];
    let total: f64 = w.iter().sum();
    let means: Vec<f64> = (0..q).map(|k| (0..m).map(|i| w[i] * all[(i, k)]).sum::<f64>() / total).collect();
    for (piece, sums) in pieces.iter().zip(&sums) {
        let part = DMatrix::from_fn(piece.rows.len(), q, |i, k| {
            let i = piece.rows.start + i;
            w[i].sqrt() * (all[(i, k)] - means[k])
        });
        assert!((part.transpose() * part - sums.joints[0].matrix(q)).amax() < 1e-9);
        let lost: f64 = piece.rows.clone().map(|i| 1.0 - w[i]).sum();
        assert!((sums.joints[0].lost[0] - lost).abs() < 1e-10);
    }
    let names: Vec<String> = columns.library(0).into_iter().map(|(name, _)| name).collect();
    let library = super::super::methods::library::Library::joint_friction().unwrap();
    assert_eq!(names, library.terms()[1..]);
    let speed = [0.37];
    let expected = library.matrix(&[&speed]).unwrap();
    let values = [speed[0], 1.0, (5.0 * 0.37_f64).tanh(), (10.0 * 0.37_f64).tanh()];
    assert!((0..4).all(|i| (expected[(0, i + 1)] - values[i]).abs() < 1e-14));
}

#[test]
fn outliers_lose_weight_and_count_in_what_is_said() {
    let (folder, _, all) = fleet();
    let spiky: Vec<LogMoments> = (1..=6)
        .map(|seed| reduced(folder.path(), &format!("s{seed}.csv"), &log(seed, true), &settings()).unwrap())
        .collect();
    let [clean, robust] = [all, &spiky]
        .map(|logs| merged(&sum(&logs.iter().collect::<Vec<_>>()).unwrap(), &settings()).unwrap());
    let mut plain = settings();
    plain.estimation.robust_passes = 0;
    let logs: Vec<LogMoments> = (1..=6)
        .map(|seed| reduced(folder.path(), &format!("p{seed}.csv"), &log(seed, true), &plain).unwrap())
        .collect();
    let plain = merged(&sum(&logs.iter().collect::<Vec<_>>()).unwrap(), &plain).unwrap();
    let value = |found: &Identification| found.estimate.parameters[9].value;
    let error = |found: &Identification| (value(found) - value(&clean)).abs();
    println!("J {} clean, {} robust, {} plain", value(&clean), value(&robust), value(&plain));
    assert!(error(&robust) < 0.5 * error(&plain));
    let sigma = |found: &Identification| found.estimate.joints[0].sigma;
    println!("σ {} clean, {} robust, {} plain", sigma(&clean), sigma(&robust), sigma(&plain));
    assert!((sigma(&robust) / sigma(&plain) - 1.0).abs() < 0.1 && sigma(&robust) > 5.0 * sigma(&clean));
    let held_out = |found: &Identification| found.estimate.joints[0].held_out_r_squared;
    assert!(held_out(&robust) < held_out(&clean) - 0.02);
}

#[test]
fn moments_of_different_filters_are_named() {
    let mut moments = sum(&fleet().2.iter().collect::<Vec<_>>()).unwrap();
    let codes = |moments: &LogMoments| -> Vec<&str> {
        merged(moments, &settings()).unwrap().findings(&Arm).iter().map(|finding| finding.code).collect()
    };
    assert!(!codes(&moments).contains(&"different-filters"));
    moments.logs[0].bandwidth *= 2.0;
    assert!(codes(&moments).contains(&"different-filters"));
}

#[test]
fn no_law_is_found_where_there_is_no_friction() {
    let folder = tempfile::tempdir().unwrap();
    for spikes in [false, true] {
        let log = |seed| log_with(seed, spikes, 20.0, [TRUTH[0], TRUTH[1], 0.0, 0.0]);
        let parts: Vec<LogMoments> = (1..=3)
            .map(|i| reduced(folder.path(), &format!("{i}.csv"), &log(i), &settings()).unwrap())
            .collect();
        let total = sum(&parts.iter().collect::<Vec<_>>()).unwrap();
        for accept_poor in [false, true] {
            let found = merged(&total, &IdentificationSettings { accept_poor, ..settings() }).unwrap();
            let reasons = found.friction[0].report.as_ref().unwrap_err();
            assert!(reasons.iter().any(|reason| reason.code == "poor-law"), "{spikes}: {reasons:?}");
        }
    }
}

#[test]
fn what_does_not_belong_together_is_refused_with_what_to_do() {
    let (folder, _, all) = fleet();
    let message = |other: &LogMoments| sum(&[&all[0], other]).unwrap_err().to_string();
    let changed = |change: &dyn Fn(&mut super::logs::About)| {
        let mut other = all[1].clone();
        change(&mut other.about);
        message(&other)
    };
    let cases = [
        (changed(&|about| about.description[3] ^= 1), "another description", "Reduce its logs again"),
        (changed(&|about| about.effort = Effort::Current), "are currents", "with the same --effort"),
        (
            changed(&|about| about.gravity_compensated = true),
            "with --gravity-compensated",
            "or all without it",
        ),
        (changed(&|about| about.bandwidth = None), "without --bandwidth", "with the same --bandwidth"),
        (changed(&|about| about.delay = Some(0.01)), "with --delay 0.01", "with the same --delay"),
        (changed(&|about| about.widths[0] += 1), "other columns", "with the same version of gelenk"),
    ];
    for (message, what, remedy) in cases {
        assert!(
            message.starts_with("error[unusable-input]: 1.moments: ")
                && message.contains(what)
                && message.contains(remedy),
            "{message}"
        );
    }
    let copy = reduced(folder.path(), "copy.csv", &log(1, false), &settings()).unwrap();
    let message = sum(&[&all[0], &all[1], &copy]).unwrap_err().to_string();
    assert_eq!(
        message,
        "error[unusable-input]: 2.moments: its log copy.csv has the same samples as the log 1.csv in 0.moments. Leave out one of \
         the two files"
    );
    // A copy that an editor ended with another line has the same samples.
    let copy = reduced(folder.path(), "copy.csv", &format!("{}\n", log(1, false)), &settings()).unwrap();
    assert!(sum(&[&all[0], &copy]).unwrap_err().to_string().contains("the same samples"));
    let both = sum(&[&all[0], &all[1]]).unwrap();
    assert!(sum(&[&both, &all[1]]).unwrap_err().to_string().contains("2.csv"));
    let other =
        identify_moments(&Arm, &[b"another"], &both, &settings(), &mut |_| ()).unwrap_err().to_string();
    assert!(other.contains("another description"), "{other}");
    let mut few = all[0].clone();
    few.shares.iter_mut().skip(3).for_each(|share| *share = super::logs::Share::default());
    let few = merged(&few, &settings()).unwrap_err().to_string();
    assert!(few.contains("of 16 groups") && few.contains("Add more logs"), "{few}");
    assert_eq!(
        sum(&[]).unwrap_err().to_string(),
        "the list of moments is empty, but it needs at least one entry"
    );
}

#[test]
fn files_that_are_something_else_are_refused_and_kept() {
    let (folder, paths, all) = fleet();
    let message = |bytes: &[u8]| LogMoments::from_bytes(bytes, "x").unwrap_err().to_string();
    assert!(message(b"").contains("it is not a file of moments: make one with"));
    assert!(message(b"t,q1\n").contains("it is not a file of moments"));
    let bytes = all[0].bytes();
    let mut newer = bytes.clone();
    newer[15] = b'6';
    assert!(message(&newer).contains("only version 5"));
    let refused = all[0].write(DESCRIPTION, &paths[0]).unwrap_err().to_string();
    assert!(refused.contains("the existing file is not a file of moments. Name another file"), "{refused}");
    let path = folder.path().join("one.moments");
    all[1].write(DESCRIPTION, &path).unwrap();
    all[0].write(DESCRIPTION, &path).unwrap();
    assert_eq!(LogMoments::read(&path).unwrap(), all[0]);
    assert!(LogMoments::read(&folder.path().join("nothing")).is_err());
}

/// Every length, a change of every byte, and changes under a checksum that was made to fit.
#[test]
fn no_bytes_make_it_panic() {
    let (_, _, all) = fleet();
    let bytes = all[0].bytes();
    let altered = "it was cut off or changed";
    for length in (20..bytes.len()).step_by(7) {
        let message = LogMoments::from_bytes(&bytes[..length], "x").unwrap_err().to_string();
        assert!(message.contains(altered), "{length}: {message}");
    }
    let mut random = SplitMix64::new(5);
    let (mut read, mut found) = (0, 0);
    for place in (17..bytes.len()).step_by(11) {
        let mut changed = bytes.clone();
        changed[place] ^= 1 << random.below(8);
        let message = LogMoments::from_bytes(&changed, "x").unwrap_err().to_string();
        assert!(message.contains(altered), "{place}: {message}");
        let content = changed.len() - 32;
        if place >= content {
            continue;
        }
        let hash = Sha256::digest(&changed[..content]);
        changed[content..].copy_from_slice(&hash);
        let Ok(moments) = LogMoments::from_bytes(&changed, "x") else { continue };
        read += 1;
        let _ = sum(&[&moments, &all[1]]);
        if read % 40 == 0 {
            found += usize::from(merged(&moments, &settings()).is_ok());
        }
    }
    println!("{read} changed files have the form of moments, {found} of every fortieth give a result");
    assert!(read > 10);
}

#[test]
fn a_wrong_sign_is_refused_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let turned = |seed: u64| {
        let text = log(seed, false);
        let turn = |line: &str| match line.rsplit_once(',') {
            Some((rest, torque)) if !torque.contains('[') => {
                format!("{rest},{}\n", -torque.parse::<f64>().unwrap())
            }
            _ => format!("{line}\n"),
        };
        text.lines().map(turn).collect::<String>()
    };
    let logs = (1..=3)
        .map(|seed| reduced(folder.path(), &format!("{seed}.csv"), &turned(seed), &settings()).unwrap());
    let logs: Vec<LogMoments> = logs.collect();
    let all = sum(&logs.iter().collect::<Vec<_>>()).unwrap();
    let refused = merged(&all, &settings()).unwrap_err().to_string();
    assert!(
        refused.contains("joint arm: its fit is refused") && refused.contains("other sign of its effort"),
        "{refused}"
    );
    let mut accepting = settings();
    accepting.estimation.accept_poor = true;
    accepting.accept_poor = true;
    let found = merged(&all, &accepting).unwrap();
    assert!(
        texts(&found.estimate.findings, Severity::Warning)
            .iter()
            .any(|w| w.contains("joint arm: ") && w.contains("other sign"))
    );
    assert!(
        texts(&found.estimate.findings, Severity::Warning)
            .iter()
            .any(|w| w.contains("[doubts-of-logs]: in ") && w.contains(" of 3 logs, for example in ")),
        "{:?}",
        found.estimate.findings
    );
    let is_exact = |term: &FrictionTerm| term.standard_error == Some(0.0);
    // Passivity leaves no friction here; the logs themselves say the same.
    assert!(
        found.friction[0].report.is_err()
            || found.friction[0].report.as_ref().unwrap().result.law.coefficients().iter().all(is_exact)
    );
    let paths: Vec<PathBuf> = (1..=3).map(|seed| folder.path().join(format!("{seed}.csv"))).collect();
    assert!(identify(&Arm, &paths, &accepting, &mut |_| ()).is_ok());
}

/// Inertia and friction in fleets of four logs: 90 % intervals contain the true value as often as intervals from the logs
/// themselves.
#[test]
#[ignore = "a hundred fleets, two minutes: cargo test -p gelenk-identification --lib fleets_hold -- --ignored --nocapture"]
fn intervals_of_a_hundred_fleets_hold_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<String> = (1..=4).map(|k| format!("{k}.csv")).collect();
    let paths: Vec<PathBuf> = names.iter().map(|name| folder.path().join(name)).collect();
    let fleets = 100;
    let (mut inside, mut from_logs) = ([0.0; 3], [0.0; 3]);
    for fleet in 0..fleets {
        let texts = (0..4).map(|k| log_of(1000 + 4 * fleet + k, false, 5.0));
        let one = |(name, text): (&String, String)| reduced(folder.path(), name, &text, &settings()).unwrap();
        let logs: Vec<LogMoments> = names.iter().zip(texts).map(one).collect();
        let found = merged(&sum(&logs.iter().collect::<Vec<_>>()).unwrap(), &settings()).unwrap();
        let other = identify(&Arm, &paths, &settings(), &mut |_| ()).unwrap();
        for (inside, found) in [(&mut inside, found), (&mut from_logs, other)] {
            inside
                .iter_mut()
                .zip(hold_the_truth(&found))
                .for_each(|(sum, holds)| *sum += f64::from(u8::from(holds)));
        }
    }
    let shares = |inside: [f64; 3]| inside.map(|n| n / fleets as f64);
    let (inside, from_logs) = (shares(inside), shares(from_logs));
    println!("coverage of m c, J and the friction at 1.5 rad/s: {inside:.2?}, from the logs {from_logs:.2?}");
    // The weight of the description, which is the same for both, reduces the coverage of m c.
    let pooled = |inside: [f64; 3]| inside.iter().sum::<f64>() / 3.0;
    assert!((pooled(inside) - pooled(from_logs)).abs() < 0.05 && pooled(inside) > 0.8);
}

/// Whether the intervals of m c, J and of the friction at 1.5 rad/s contain the arm's true values.
fn hold_the_truth(found: &Identification) -> [bool; 3] {
    let [mc, j, viscous, coulomb] = TRUTH;
    let holds = |place: usize, truth: f64| {
        let [low, high] = found.estimate.parameters[place].interval;
        (low..=high).contains(&truth)
    };
    let law = found.friction[0].report.as_ref().unwrap();
    let torque = law.result.law.torques(&[1.5]).unwrap()[0];
    let truth = 1.5 * viscous + coulomb * (5.0 * 1.5_f64).tanh();
    [holds(1, mc), holds(9, j), (torque - truth).abs() <= band(law, &[1.5], 0.9)[0]]
}

/// Logs of one machine, one of two bandwidths and delays, a short one, and many of which one has a doubt.
#[test]
fn each_number_of_moments_is_halved_and_doubled() {
    let folder = tempfile::tempdir().unwrap();
    let other = |bandwidth: f64, delay: f64| {
        let mut settings = settings();
        (settings.preparation.bandwidth, settings.preparation.delay) = (Some(bandwidth), Some(delay));
        settings
    };
    let outcome = |parts: &Vec<(u64, [f64; 2])>| -> String {
        let one = |(seed, [bandwidth, delay]): &(u64, [f64; 2])| {
            let text = log(*seed, *seed == 1);
            let mut moments = reduced(folder.path(), "log.csv", &text, &other(*bandwidth, *delay))?;
            (moments.about.bandwidth, moments.about.delay) = (None, None);
            Ok(moments)
        };
        let found = parts.iter().map(one).collect::<Result<Vec<_>>>().and_then(|parts| {
            let sum = sum(&parts.iter().collect::<Vec<_>>())?;
            Ok((sum.shares(), merged(&sum, &settings())?))
        });
        let codes = |found: &Identification| {
            let codes = found.estimate.findings.iter().map(|finding| finding.code.to_string());
            codes.collect::<Vec<_>>().join(" ")
        };
        found.map_or_else(
            |error| error.to_string(),
            |(shares, found)| format!("{shares} shares, {}", codes(&found)),
        )
    };
    let outcomes = || {
        let cases = [
            ("alone", vec![(2, [8.0, 0.0])]),
            ("other filter", vec![(2, [8.0, 0.0]), (3, [5.0, 0.0])]),
            ("other delay", vec![(2, [8.0, 0.0]), (3, [8.0, 3e-3])]),
            ("a doubt of one in six", (1..7).map(|seed| (seed, [8.0, 0.0])).collect()),
        ];
        cases.iter().map(|(name, parts)| ((*name).to_owned(), outcome(parts))).collect()
    };
    insta::assert_snapshot!("numbers_of_moments", page(levels::NAMES.iter(), &outcomes));
}
