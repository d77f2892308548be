//! The rows of the reference bench for identification, on the same synthetic data and one core.
//!
//! `cargo bench -p gelenk-runtime --bench identification [-- stlsq,lasso,fit,tv,whole]`. Data: samples at 1
//! kHz of `v = 1.2 sin 2π 0.31 t + 0.7 sin(2π 0.83 t + 0.4) + 0.15 sin 2π 3.7 t`, Stribeck torque, noise 0.05
//! N·m from SplitMix64 seeded with 20240229. Times are medians.

#[path = "../examples/powercube/methods/mod.rs"]
#[allow(unused_imports, reason = "its tests do not run here")]
mod methods;
#[path = "../tests/support/named_robot.rs"]
mod named_robot;

use gelenk_identification::log::{ColumnOptions, runs_of};
use gelenk_identification::methods::cross_validation::CrossValidation;
use gelenk_identification::methods::differentiation::{Regularization, TotalVariation, quantization_noise};
use gelenk_identification::methods::lasso::Lasso;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::{Moments, Samples};
use gelenk_identification::methods::stribeck::{StribeckRegression, stribeck_torque};
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_identification::run::Run;
use methods::kalman::KalmanSmoother;
use methods::random::SplitMix64;
use named_robot::NamedRobot;
use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

type Outcome = Result<(), Box<dyn Error>>;

const TRUE: [f64; 5] = [2.1, 1.4, 20.0, 0.9, 8.0];

fn main() -> Outcome {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let runs = |part: &str| chosen.is_empty() || chosen.iter().any(|c| c.split(',').any(|c| c == part));
    let data = Data::new(1_000_000);
    for m in [10_000, 100_000, 1_000_000] {
        if runs("stlsq") {
            thresholding(&data, m)?;
        }
    }
    for m in [10_000, 100_000, 1_000_000] {
        if runs("lasso") {
            lasso(&data, m)?;
        }
    }
    for m in [10_000, 100_000, 1_000_000] {
        if runs("fit") {
            stribeck(&data, m)?;
        }
    }
    for m in [1_000, 10_000, 100_000, 1_000_000] {
        if runs("tv") {
            differentiation(m)?;
        }
    }
    if runs("whole") {
        whole(1_000_000)?;
    }
    Ok(())
}

struct Data {
    library: Library,
    v: Vec<f64>,
    torque: Vec<f64>,
}

impl Data {
    fn new(m: usize) -> Self {
        let mut random = SplitMix64::new(20_240_229);
        let v: Vec<f64> = (0..m)
            .map(|i| {
                let t = i as f64 * 1e-3;
                1.2 * (2.0 * PI * 0.31 * t).sin()
                    + 0.7 * (2.0 * PI * 0.83 * t + 0.4).sin()
                    + 0.15 * (2.0 * PI * 3.7 * t).sin()
            })
            .collect();
        let torque = v.iter().map(|v| stribeck_torque(*v, &TRUE) + 0.05 * random.normal()).collect();
        let terms =
            ["1", "v", "v*abs(v)", "v*v*v", "tanh(20*v)", "exp(-8*abs(v))*tanh(3*20*v)", "sin(2*pi*v)"];
        let library = Library::new(&terms, &["v"]).unwrap_or_else(|e| panic!("the bench's own library: {e}"));
        Self { library, v, torque }
    }
}

/// Median and least time in seconds, and the last result. The least is what a busy machine distorts least.
fn timed<T>(mut work: impl FnMut() -> T) -> ([f64; 2], T) {
    let begin = Instant::now();
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let result = black_box(work());
        times.push(start.elapsed().as_secs_f64());
        if begin.elapsed().as_secs_f64() > 1.5 || times.len() >= 25 {
            times.sort_by(f64::total_cmp);
            return ([times[times.len() / 2], times[0]], result);
        }
    }
}

fn row(what: &str, m: usize, who: &str, [median, least]: [f64; 2], note: &str) {
    println!(
        "{what:9} m={m:8} {who:28} {:12.3} ms {:9.2} ns/sample  least {:.3} ms  {note}",
        median * 1e3,
        median / m as f64 * 1e9,
        least * 1e3
    );
}

fn list(x: impl IntoIterator<Item = f64>) -> String {
    let text: Vec<String> = x.into_iter().map(|x| format!("{x:.9}")).collect();
    format!("[{}]", text.join(" "))
}

fn thresholding(data: &Data, m: usize) -> Outcome {
    let (v, torque) = (&data.v[..m], &data.torque[..m]);
    let theta = data.library.matrix(&[v])?;
    let columns: Vec<&[f64]> = theta.as_slice().chunks_exact(m).collect();
    let settings = Thresholding { threshold: 0.2, ridge: 0.05, ..Default::default() };
    let stored = || -> Result<_, Box<dyn Error>> {
        let samples = Samples::from_columns(data.library.terms(), columns.clone(), vec![torque])?;
        let reduced = Reduced::new(&samples)?;
        Ok((settings.fit(&reduced, 0)?, reduced.condition()))
    };
    let (time, fit) = timed(stored);
    let (fit, condition) = fit?;
    row(
        "STLSQ",
        m,
        "gelenk, Theta stored",
        time,
        &format!("{} condition {condition:.1}", list(fit.coefficients.iter().copied())),
    );
    let streamed = || -> Result<_, Box<dyn Error>> {
        let samples = Samples::from_library(&data.library, vec![v], vec![torque])?;
        Ok(settings.fit(&Reduced::new(&samples)?, 0)?)
    };
    let (time, fit) = timed(streamed);
    row("STLSQ", m, "gelenk, Theta on the fly", time, &list(fit?.coefficients.iter().copied()));
    Ok(())
}

fn lasso(data: &Data, m: usize) -> Outcome {
    let theta = data.library.matrix(&[&data.v[..m]])?;
    let columns = theta.as_slice().chunks_exact(m).collect();
    let samples = Samples::from_columns(data.library.terms(), columns, vec![&data.torque[..m]])?;
    let lasso = Lasso { tolerance: 1e-8, ..Default::default() };
    let work = || -> Result<_, Box<dyn Error>> {
        let folds = Moments::blocks(&samples, 10)?;
        let grid = lasso.lambda_grid(&Moments::sum(&folds)?, 0, 100, 1e-3)?;
        Ok(CrossValidation::new(&lasso, &folds, 0, &grid)?)
    };
    let (time, validation) = timed(work);
    let validation = validation?;
    let best = validation.minimum;
    let gap = validation.path.gaps.iter().fold(0.0_f64, |a, g| a.max(*g));
    let note = format!(
        "{} alpha {:.4e} largest gap {gap:.1e}",
        list(validation.path.coefficients.column(best).iter().copied()),
        validation.path.lambdas[best]
    );
    row("LassoCV", m, "gelenk, fold moments + CD", time, &note);
    let (time, _) = timed(|| Moments::blocks(&samples, 10).map(|b| b.len()));
    row("LassoCV", m, "  of that the one pass", time, "");
    Ok(())
}

fn stribeck(data: &Data, m: usize) -> Outcome {
    let (time, fit) = timed(|| StribeckRegression::default().fit(&data.v[..m], &data.torque[..m]));
    let fit = fit?;
    row(
        "Stribeck",
        m,
        "gelenk, grid + LM",
        time,
        &format!("{} passes {} {:?}", list(fit.parameters), fit.iterations, fit.warnings),
    );
    Ok(())
}

/// Integral of 1.2 sin 2π 0.31 t with noise 0.01, differentiated; objective as in the reference bench.
fn differentiation(m: usize) -> Outcome {
    let (dt, gamma) = (1e-3, 1e-2);
    let mut random = SplitMix64::new(20_240_229);
    let omega = 2.0 * PI * 0.31;
    let t: Vec<f64> = (0..m).map(|i| i as f64 * dt).collect();
    let x: Vec<f64> = t.iter().map(|t| -(omega * t).cos() * 1.2 / omega + 0.01 * random.normal()).collect();
    let truth: Vec<f64> = t.iter().map(|t| 1.2 * (omega * t).sin()).collect();
    let settings = TotalVariation {
        order: 1,
        regularization: Regularization::Weight(gamma),
        epsilon: Some(1e-6),
        iterations: 20,
        tolerance: 0.0,
    };
    let (time, result) = timed(|| settings.differentiate(&t, &x));
    let u: Vec<f64> = result?.value.windows(2).map(|s| (s[1] - s[0]) / dt).collect();
    let rms =
        |d: &[f64]| (d.iter().zip(&truth).map(|(d, t)| (d - t).powi(2)).sum::<f64>() / d.len() as f64).sqrt();
    let note = format!("objective {:.5}  rms err {:.4}", objective(&u, &x, gamma, dt), rms(&u));
    row("TVDiff", m, "gelenk, banded, 20 it", time, &note);
    if m > 100_000 {
        return Ok(());
    }
    let (time, d) = timed(|| TotalVariation::from_noise(0.01).differentiate(&t, &x));
    row("TVDiff", m, "gelenk, gamma by discrepancy", time, &format!("rms err {:.4}", rms(&d?.first)));
    let (time, d) = timed(|| KalmanSmoother::from_noise(0.01).differentiate(&t, &x));
    row("TVDiff", m, "gelenk, Kalman smoother", time, &format!("rms err {:.4}", rms(&d?.first)));
    Ok(())
}

fn objective(u: &[f64], x: &[f64], gamma: f64, dt: f64) -> f64 {
    let mut r = vec![-x[0]];
    for (u, x) in u.iter().zip(&x[1..]).scan(0.0, |sum, (u, x)| {
        *sum += u * dt;
        Some((*sum, x))
    }) {
        r.push(u - x);
    }
    let mean = r.iter().sum::<f64>() / r.len() as f64;
    let variation: f64 = u.windows(2).map(|u| (((u[1] - u[0]) / dt).powi(2) + 1e-6).sqrt()).sum();
    gamma * dt * variation + 0.5 * r.iter().map(|r| (r - mean).powi(2)).sum::<f64>()
}

/// A log of six joints (time, positions, torques) to friction models: read, smooth, choose terms,
/// cross-validate, fit.
fn whole(m: usize) -> Outcome {
    let mut text = String::from("t");
    (1..=6).for_each(|j| text += &format!(",q{j}"));
    (1..=6).for_each(|j| text += &format!(",u{j}"));
    let mut random = SplitMix64::new(1);
    for i in 0..m {
        let t = 1e-3 * i as f64;
        let _ = write!(text, "\n{t:.3}");
        let wave = |j: i32| (0.6 + 0.13 * f64::from(j), 0.3 + 0.1 * f64::from(j));
        for (a, w) in (0..6).map(wave) {
            let _ = write!(text, ",{:.4}", a * (w * t).sin() + 0.3 * (2.7 * w * t).sin());
        }
        for (a, w) in (0..6).map(wave) {
            let v = a * w * (w * t).cos() + 0.81 * w * (2.7 * w * t).cos();
            let _ = write!(text, ",{:.4}", stribeck_torque(v, &TRUE) + 0.05 * random.normal());
        }
    }
    let start = Instant::now();
    let names = (1..=6).map(|joint| format!("joint_{joint}")).collect();
    let robot = NamedRobot { names, ..NamedRobot::default() };
    let recording = runs_of(text.as_bytes(), "bench", &robot, &ColumnOptions::default())?;
    let read = start.elapsed().as_secs_f64();
    row(
        "whole log",
        m,
        "gelenk, read and check",
        [read; 2],
        &format!("{} MB, {} findings", text.len() / 1_000_000, recording.findings.len()),
    );
    let next = AtomicUsize::new(0);
    let one = || -> gelenk_identification::Result<Vec<String>> {
        let mut lines = Vec::new();
        loop {
            let joint = next.fetch_add(1, Ordering::Relaxed);
            if joint == 6 {
                return Ok(lines);
            }
            lines.push(joint_model(&recording.runs[0], joint)?);
        }
    };
    let lines = std::thread::scope(|scope| {
        let other = scope.spawn(one);
        let mut lines = one()?;
        lines.extend(other.join().unwrap_or(Ok(Vec::new()))?);
        Ok::<_, Box<dyn Error>>(lines)
    })?;
    row("whole log", m, "gelenk, all, two threads", [start.elapsed().as_secs_f64(); 2], "");
    lines.iter().for_each(|l| println!("  {l}"));
    Ok(())
}

fn joint_model(run: &Run, joint: usize) -> gelenk_identification::Result<String> {
    let (position, torque) = (&run.positions[joint], &run.efforts[joint]);
    let smoother = KalmanSmoother::from_noise(quantization_noise(1e-4));
    let motion = smoother.differentiate(&run.times, position)?;
    let library = Library::friction()?;
    let samples = Samples::from_library(&library, vec![&motion.first], vec![torque])?;
    let reduced = Reduced::new(&samples)?;
    let sparse = Thresholding { threshold: 0.2, ..Default::default() }.fit(&reduced, 0)?;
    let lasso = Lasso::default();
    let folds = Moments::blocks(&samples, 10)?;
    let grid = lasso.lambda_grid(reduced.moments(), 0, 100, 1e-3)?;
    let validation = CrossValidation::new(&lasso, &folds, 0, &grid)?;
    let fit = StribeckRegression::default().fit(&motion.first, torque)?;
    Ok(format!(
        "joint {joint}: STLS terms {:?}, LASSO one-standard-error λ {:.3e}, Stribeck {}",
        sparse.active,
        validation.path.lambdas[validation.one_standard_error],
        list(fit.parameters)
    ))
}
