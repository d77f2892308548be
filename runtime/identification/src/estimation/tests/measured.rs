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
    println!("{:#?} {:#?} eff {}", found.choices, found.warnings, found.effective_parameters);
    println!("λ {} {:?}", found.description_weight, found.weights_tried);
}

gelenk_dynamics::dynamics!(struct Arm = gelenk_generated::schunk_lwa4p);

fn schunk() -> impl Robot {
    use gelenk_generated::schunk_lwa4p as module;
    super::super::super::robot::Generated {
        model: Arm,
        units: module::JOINT_UNITS,
        parameter_names: module::INERTIAL_PARAMETER_NAMES,
        parameters: module::inertial_parameters(),
        bodies: 6,
        regressor: module::inertial_regressor,
    }
}

fn schunk_runs() -> Option<Vec<PreparedRun>> {
    let text = std::fs::read_to_string(shared("data/schunk_lwa4p/runs.csv")?).unwrap();
    let mut runs: Vec<(String, Vec<Vec<f64>>)> = Vec::new();
    for line in text.lines().skip(1) {
        let (run, rest) = line.split_once(',').unwrap();
        let row: Vec<f64> = rest.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect();
        match runs.last_mut() {
            Some((name, rows)) if name == run => rows.push(row),
            _ => runs.push((run.to_string(), vec![row])),
        }
    }
    let prepared = runs.into_iter().map(|(name, mut rows)| {
        rows.pop(); // the last row of a run has no torque
        let column = |i: usize| -> Vec<f64> { rows.iter().map(|r| r[i]).collect() };
        let columns = |from: usize| (from..from + 6).map(column).collect::<Vec<_>>();
        let w: usize = std::env::var("WINDOW").map_or(21, |x| x.parse().unwrap());
        prepare(&name, &column(0), &columns(1), &columns(13), w)
    });
    Some(prepared.collect())
}

#[test]
fn schunk_look() {
    let Some(runs) = schunk_runs() else { return };
    println!("{} runs {} samples", runs.len(), runs.iter().map(|r| r.times.len()).sum::<usize>());
    if let Ok(path) = std::env::var("DUMP") {
        use std::io::Write;
        let mut f = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
        let robot = schunk();
        for (r, run) in runs.iter().enumerate() {
            for i in (0..run.times.len()).step_by(4) {
                let at = |c: &[Vec<f64>]| -> Vec<f64> { c.iter().map(|c| c[i]).collect() };
                let (y, v, a, e) =
                    (at(&run.positions), at(&run.velocities), at(&run.accelerations), at(&run.efforts));
                let (mut w, mut g) = (vec![0.0; 396], vec![0.0; 396]);
                robot.inertial_regressor(&y, &v, &a, &mut w);
                robot.inertial_regressor(&y, &[0.0; 6], &[0.0; 6], &mut g);
                w.iter_mut().zip(&g).for_each(|(w, g)| *w -= g);
                let all: Vec<String> = [r as f64]
                    .iter()
                    .chain(&y)
                    .chain(&v)
                    .chain(&a)
                    .chain(&e)
                    .chain(&w)
                    .map(|x| x.to_string())
                    .collect();
                writeln!(f, "{}", all.join(",")).unwrap();
            }
        }
        return;
    }
    let settings = EstimationSettings {
        consistent: std::env::var("FREE").is_err(),
        gravity_compensated: std::env::var("GRAV").is_err(),
        robust_passes: 1,
        ..EstimationSettings::default()
    };
    let start = std::time::Instant::now();
    let found =
        estimate(&schunk(), &runs, &settings, &mut |s| println!("{:?} {s}", start.elapsed())).unwrap();
    println!("{:?}", start.elapsed());
    for joint in &found.joints {
        println!(
            "{} fit {:.4} held out {:.4} {:?} {:?}",
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
    println!(
        "λ {} {:?} {:?}",
        found.description_weight,
        found.offsets,
        found.weights_tried.iter().map(|t| t.error).collect::<Vec<_>>()
    );
    for (name, value) in schunk()
        .parameter_names()
        .iter()
        .zip(&found.parameters)
        .filter(|(n, _)| n.starts_with("m_") || n.starts_with("J"))
    {
        println!("{name} {value:?}");
    }
}
