//! Measured robots: a UR10 and a Schunk LWA 4P.

use super::super::super::robot::Robot;
use super::super::super::run::PreparedRun;
use super::super::{Estimate, EstimationSettings, estimate};
use super::chain::ur10;
use super::data::{part, prepare, shared};

/// Centred R² of each joint when the estimate predicts a run that it has not seen.
pub(super) fn predicted(robot: &dyn Robot, found: &Estimate, run: &PreparedRun) -> Vec<f64> {
    let n = robot.joint_names().len();
    let p = found.parameters.len();
    let pi: Vec<f64> = found.parameters.iter().map(|p| p.value).collect();
    let described = robot.parameters();
    let mut errors = vec![Vec::new(); n];
    let at = |columns: &[Vec<f64>], i: usize| -> Vec<f64> { columns.iter().map(|c| c[i]).collect() };
    for i in 0..run.times.len() {
        let [y, v, a] = [&run.positions, &run.velocities, &run.accelerations].map(|c| at(c, i));
        let mut regressor = vec![0.0; n * p];
        robot.inertial_regressor(&y, &v, &a, &mut regressor);
        let mut rigid = vec![0.0; n];
        robot.rigid_forces(&y, &v, &a, &mut rigid);
        for j in 0..n {
            let row = &regressor[j * p..(j + 1) * p];
            let change: f64 = (0..p).map(|k| row[k] * (pi[k] - described[k])).sum();
            let joint = &found.joints[j];
            let friction: f64 = joint.terms.iter().map(|t| t.coefficient.value * value(&t.basis, v[j])).sum();
            let armature = joint.armature.map_or(0.0, |c| c.value * a[j]);
            errors[j].push(run.efforts[j][i] - rigid[j] - change - friction - armature - joint.offsets[0]);
        }
    }
    (0..n).map(|j| r_squared(&errors[j], &run.efforts[j])).collect()
}

fn value(basis: &str, v: f64) -> f64 {
    let inner = basis.strip_prefix("tanh(").and_then(|b| b.strip_suffix("*v)"));
    match (basis, inner) {
        ("v", _) => v,
        ("abs(v)", _) => v.abs(),
        (_, Some(k)) => (k.parse::<f64>().unwrap() * v).tanh(),
        _ => panic!("{basis}"),
    }
}

fn r_squared(errors: &[f64], measured: &[f64]) -> f64 {
    let mean = measured.iter().sum::<f64>() / measured.len() as f64;
    1.0 - errors.iter().map(|e| e * e).sum::<f64>() / measured.iter().map(|m| (m - mean).powi(2)).sum::<f64>()
}

fn ur10_run() -> Option<PreparedRun> {
    let text = std::fs::read_to_string(shared("data/ur10/exciting.csv")?).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let column = |i: usize| -> Vec<f64> { rows.iter().map(|r| r[i]).collect() };
    let columns = |from: usize| (from..from + 6).map(column).collect::<Vec<_>>();
    let d: usize = std::env::var("DELAY").map_or(0, |x| x.parse().unwrap());
    let m = rows.len() - d;
    let w: usize = std::env::var("WINDOW").map_or(21, |x| x.parse().unwrap());
    let p: Vec<Vec<f64>> = columns(1).iter().map(|c| c[..m].to_vec()).collect();
    let e: Vec<Vec<f64>> = columns(13).iter().map(|c| c[d..].to_vec()).collect();
    Some(prepare("exciting", &column(0)[..m], &p, &e, w))
}

#[test]
fn the_first_half_of_a_ur10_log_predicts_the_second() {
    let Some(run) = ur10_run() else { return };
    if let Ok(path) = std::env::var("DUMP") {
        use std::io::Write;
        let mut f = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
        for i in 0..run.times.len() {
            let at = |c: &[Vec<f64>]| -> Vec<f64> { c.iter().map(|c| c[i]).collect() };
            let (y, v, a, e) =
                (at(&run.positions), at(&run.velocities), at(&run.accelerations), at(&run.efforts));
            let mut w = vec![0.0; 360];
            ur10().inertial_regressor(&y, &v, &a, &mut w);
            let all: Vec<String> =
                y.iter().chain(&v).chain(&a).chain(&e).chain(&w).map(|x| x.to_string()).collect();
            writeln!(f, "{}", all.join(",")).unwrap();
        }
        return;
    }
    let half = run.times.len() / 2;
    let mut settings = EstimationSettings::default();
    if let Ok(x) = std::env::var("ROBUST") {
        settings.robust_passes = x.parse().unwrap();
    }
    if std::env::var("TERMS").is_ok() {
        settings.optional_terms = false;
    }
    let start = std::time::Instant::now();
    let found =
        estimate(&ur10(), &[part(&run, 0..half)], &settings, &mut |s| println!("{:?} {s}", start.elapsed()))
            .unwrap();
    let unseen = predicted(&ur10(), &found, &part(&run, half..run.times.len()));
    println!("{:?}", start.elapsed());
    for (joint, unseen) in found.joints.iter().zip(&unseen) {
        println!(
            "{} fit {:.4} held out {:.4} unseen {unseen:.4} {:?} {:?}",
            joint.name,
            joint.r_squared,
            joint.held_out_r_squared,
            joint.armature.map(|a| a.value),
            joint
                .terms
                .iter()
                .map(|t| format!(
                    "{} {:.3} ± {:.3}",
                    t.basis, t.coefficient.value, t.coefficient.standard_error
                ))
                .collect::<Vec<_>>()
        );
    }
    println!("λ {} {:?}", found.description_weight, found.weights_tried);
}
