//! Logs of robots with quaternions as moments: what the logs themselves tell, and nothing else.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_identification::IdentificationError;
use gelenk_identification::estimation::JointEstimate;
use gelenk_identification::fleet::{LogMoments, identify_moments, reduce};
use gelenk_identification::identify::{Identification, IdentificationSettings, identify};
use gelenk_identification::robot::Robot;
use nalgebra::{UnitQuaternion, Vector3};

use super::logs::{HEADERS, errors, log};
use super::quadrotor::flight;
use super::{Noise, models, robot};

const DESCRIPTION: &[&[u8]] = &[b"robot"];

/// A pendulum on a ball joint with a drive for each of its velocities, as described and as it is.
pub const BALL: &str = "name = \"ball\"\n[[joints]]\nname = \"hip\"\ntype = \"spherical\"\ndrive = \"ideal\"\n[[bodies]]\nlink = \"hip\"\n";
const DESCRIBED: &str = "mass = 1\ncenter_of_mass = [0, 0, -0.2]\ninertia = [0.05, 0.05, 0.02]\n";
const TRUE: &str = "mass = 1.4\ncenter_of_mass = [0.02, -0.01, -0.25]\ninertia = [0.09, 0.06, 0.03]\n";

/// The pendulum along a motion of its own, measured with noise of 0.2 mrad and 2 mN m.
fn pendulum(truth: &InterpretedRobot, seconds: f64, seed: u64) -> String {
    const STEP: f64 = 1e-3;
    let mut noise = Noise::new(seed);
    let mut attitude = UnitQuaternion::identity();
    let mut text = String::from("t,hip_qx,hip_qy,hip_qz,hip_qw");
    truth.input_names().iter().for_each(|name| write!(text, ",u_{name}").unwrap());
    text.push('\n');
    let wave = |t: f64, i: usize, k: usize| {
        TAU * (0.23 + 0.31 * k as f64 + 0.07 * i as f64) * t + seed as f64 + (i * k) as f64
    };
    let rate = |i: usize, k: usize| TAU * (0.23 + 0.31 * k as f64 + 0.07 * i as f64);
    let velocity = |t: f64| Vector3::from_fn(|i, _| (0..3).map(|k| 0.9 * wave(t, i, k).cos()).sum());
    let acceleration = |t: f64| -> Vector3<f64> {
        Vector3::from_fn(|i, _| (0..3).map(|k| -0.9 * rate(i, k) * wave(t, i, k).sin()).sum())
    };
    for i in 0..(seconds / STEP) as usize {
        let t = STEP * i as f64;
        if i % 5 == 0 {
            let measured = attitude * UnitQuaternion::from_scaled_axis(Vector3::from(noise.vector(2e-4)));
            let mut forces = vec![0.0; 3];
            let y: Vec<f64> = attitude.coords.iter().copied().collect();
            truth.rigid_forces(&y, velocity(t).as_slice(), acceleration(t).as_slice(), &mut forces);
            write!(text, "{t:.3},{:.7},{:.7},{:.7},{:.7}", measured.i, measured.j, measured.k, measured.w)
                .unwrap();
            forces.iter().for_each(|force| write!(text, ",{:.6}", force + 2e-3 * noise.normal()).unwrap());
            text.push('\n');
        }
        let middle: Vector3<f64> = velocity(t + 0.5 * STEP);
        attitude *= UnitQuaternion::from_scaled_axis(STEP * middle);
    }
    text
}

pub fn ball(folder: &Path) -> [InterpretedRobot; 2] {
    [("described.toml", DESCRIBED), ("true.toml", TRUE)].map(|(name, body)| {
        fs::write(folder.join(name), format!("{BALL}{body}")).unwrap();
        robot(&folder.join(name))
    })
}

/// Every sample counts, and the folds are those of the shares: nothing but the way to the sums differs.
fn settings() -> IdentificationSettings {
    let mut settings = IdentificationSettings::new().unwrap();
    settings.preparation.bandwidth = Some(8.0);
    settings.preparation.delay = Some(0.0);
    settings.estimation.robust_passes = 0;
    settings.estimation.folds = 16;
    settings
}

fn from_moments(
    robot: &InterpretedRobot,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
) -> Identification {
    let copied = logs.iter().map(|log| {
        let moments = reduce(robot, DESCRIPTION, log, settings, &mut |_| ())?;
        let file = log.with_extension("moments");
        moments.write(DESCRIPTION, &file)?;
        Ok::<_, IdentificationError>((LogMoments::read(&file)?, log.display().to_string()))
    });
    identify_moments(robot, DESCRIPTION, &LogMoments::sum(copied).unwrap(), settings, &mut |_| ()).unwrap()
}

/// Largest differences of the values, by the largest of its body's, of the joints' residuals and R², and of their held-out R².
fn apart(one: &Identification, other: &Identification) -> [f64; 3] {
    let [a, b] =
        [one, other].map(|found| found.estimate.parameters.iter().map(|p| p.value).collect::<Vec<_>>());
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let of_body = |(a, b): (&[f64], &[f64])| {
        a.iter().zip(b).map(|(a, other)| (a - other).abs() / size(b)).fold(0.0, f64::max)
    };
    let values = a.chunks(10).zip(b.chunks(10)).map(of_body).fold(0.0, f64::max);
    let joints = || one.estimate.joints.iter().zip(&other.estimate.joints);
    let largest = |of: &dyn Fn(&JointEstimate) -> f64| {
        let apart = joints().map(|(a, b)| {
            assert_eq!(of(a).is_nan(), of(b).is_nan(), "{}", a.name);
            (of(a) - of(b)).abs() / of(b).abs()
        });
        apart.fold(0.0, f64::max)
    };
    let fit = largest(&|joint| joint.sigma).max(largest(&|joint| joint.r_squared));
    [values, fit, largest(&|joint| joint.held_out_r_squared)]
}

#[test]
fn moments_of_a_log_are_the_fit_to_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let (ball_log, flown) = (folder.path().join("ball.csv"), folder.path().join("flight.csv"));
    let [described, truth] = ball(folder.path());
    fs::write(&ball_log, pendulum(&truth, 30.0, 1)).unwrap();
    fs::write(&flown, log(HEADERS[0], &flight(40.0, 1))).unwrap();
    for (name, robot, log) in
        [("ball", &described, ball_log), ("quadrotor", &robot(&models("quadrotor.toml")), flown)]
    {
        let logs = [log];
        let own = identify(robot, &logs, &settings(), &mut |_| ()).unwrap();
        let found = from_moments(robot, &logs, &settings());
        let [values, fit, held_out] = apart(&found, &own);
        println!("{name}: values {values:.1e}, sigma and R² {fit:.1e}, held out {held_out:.1e}");
        // The error on held-out data is that of joints weighted once more: weights settle to a thousandth.
        assert!(values < 1e-10 && fit < 1e-10 && held_out < 1e-5, "{name}: {values} {fit} {held_out}");
        assert_eq!(found.estimate.description_weight, own.estimate.description_weight);
        assert!(found.friction.is_empty() && found.estimate.joints.iter().all(|joint| joint.exact));
        assert_eq!(found.estimate.findings[..1], own.estimate.findings[..1]);
    }
}

/// Shares and weights of outliers are other ones with several logs: the values agree far within their errors.
#[test]
fn moments_of_several_logs_say_what_these_say() {
    let folder = tempfile::tempdir().unwrap();
    let [described, truth] = ball(folder.path());
    let logs: Vec<PathBuf> = (1..5).map(|seed| folder.path().join(format!("{seed}.csv"))).collect();
    logs.iter().zip(1..).for_each(|(log, seed)| fs::write(log, pendulum(&truth, 10.0, seed)).unwrap());
    let settings = IdentificationSettings {
        preparation: settings().preparation,
        ..IdentificationSettings::new().unwrap()
    };
    let own = identify(&described, &logs, &settings, &mut |_| ()).unwrap();
    let found = from_moments(&described, &logs, &settings);
    let pairs = found.estimate.parameters.iter().zip(&own.estimate.parameters).zip(truth.parameters());
    // A mass at the joint moves nothing.
    for ((a, b), real) in pairs.skip(1) {
        println!("{real:.4} {:.5} ± {:.5}, {:.5} from the logs", a.value, a.standard_error, b.value);
        assert!((a.value - b.value).abs() < b.standard_error.max(1e-9), "{a:?} {b:?}");
        assert!((a.value - real).abs() < 0.02 * real.abs() + 2e-3, "{} {real}", a.value);
    }
}

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    command
        .current_dir(folder)
        .arg("identify")
        .arg(models("quadrotor.toml"))
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn flights_are_reduced_and_merged_by_the_command() {
    let folder = tempfile::tempdir().unwrap();
    for seed in 1..3 {
        let name = format!("{seed}.csv");
        fs::write(folder.path().join(&name), log(HEADERS[0], &flight(40.0, seed))).unwrap();
        let output = gelenk(folder.path(), &["--reduce", &name, "--output", &format!("{seed}.moments")]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let merge = ["--merge", "1.moments", "2.moments", "--output", "found.toml", "--report", "page"];
    let output = gelenk(folder.path(), &merge);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let [mass, centre, inertia] = errors(&folder.path().join("found.toml"));
    println!("{said}\nmass {mass:.1e}, centre {centre:.1e} m, inertia {inertia:.1e}");
    assert!(mass < 1e-3 && centre < 1e-3 && inertia < 1e-2, "{mass} {centre} {inertia}");
    assert!(!said.contains("NaN"), "{said}");
}
