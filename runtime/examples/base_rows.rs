//! Identifies the base parameters of a quadruped (Unitree Go2) from the six equations of motion of its floating base. No joint
//! torque is measured.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example base_rows [FOLDER]
//! ```
//!
//! No drive acts on the floating base of a walking robot. Therefore the six rows of the base in the equations of motion contain
//! the forces at the feet, but no joint torques:
//!
//! ```text
//!     W_b(y, v, v̇) β = [0; τ] + Σ J_kᵀ f_k        rows 1 to 6:  W_b,base β = Σ J_k,baseᵀ f_k
//! ```
//!
//! Poses of the trunk, joint angles and forces at the feet therefore determine all base parameters β of the robot (Ayusawa,
//! Venture and Nakamura, *Identifiability and identification of inertial parameters using the underactuated base-link
//! dynamics for legged multibody systems*, International Journal of Robotics Research 33(3), 2014). The other rows then
//! predict the joint torques.
//!
//! The scale of β follows from the forces at the feet. In flight these forces are zero, so `W_b,base β = 0` determines β only
//! up to a factor. This factor is the total mass (the first base parameter), so the robot must be weighed. The program first
//! shows both cases for random motions without noise.
//!
//! In the simulated logs the robot stands on three feet and swings the fourth leg, one leg after the other, while its trunk
//! sways. The same filter is applied to poses and forces. The program prints tables and writes a page of plots to FOLDER. The
//! default is a folder for temporary files.

use gelenk_generated::go2::{self as robot, M, N, NY, WRENCHES};
use gelenk_identification::preparation::{PreparationSettings, prepare_all};
use gelenk_identification::run::{Effort, Run};
use gelenk_report::{Axis, Figure, Marks, Plot};
use lifting::{Lifting, Log, PERIOD};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use outcome::Outcome;
use plots::{Folder, figure, over_time};
use quadruped::FEET;
use random::SplitMix64;
use std::process::ExitCode;

#[path = "support/lifting.rs"]
mod lifting;
#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;
#[path = "support/quadruped.rs"]
mod quadruped;
#[path = "support/random.rs"]
mod random;

/// Number of base parameters.
const P: usize = robot::BASE_PARAMETER_NAMES.len();
/// Number of rows of the base.
const BASE: usize = N - M;
const ROWS: [(&str, &str); BASE] = [
    ("force x", "N"),
    ("force y", "N"),
    ("force z", "N"),
    ("moment x", "N m"),
    ("moment y", "N m"),
    ("moment z", "N m"),
];
/// Half-amplitude frequency of the filter (Hz).
const BANDWIDTH: f64 = 7.0;
/// Number of rows per second of a prepared log.
const RATE: f64 = 100.0;
/// Number of fits. Each fit has weights from the residuals of the previous fit.
const FITS: usize = 3;
/// Part of a log that the plots show (s). It contains the swing of the first leg and the beginning of the next swing.
const SHOWN: f64 = 8.0;
/// Largest allowed error of a predicted torque, relative to the part of the torque that depends on the parameters.
const MOST_ERROR: f64 = 0.15;

type Regressor = [[f64; P]; N];

/// A row of a prepared log.
struct Sample {
    time: f64,
    regressor: Regressor,
    /// Generalized forces of the contact forces at the feet, one for each row.
    feet: [f64; N],
    /// True joint torques of the simulation.
    torques: [f64; M],
}

/// The base parameters of the description.
fn described() -> DVector<f64> {
    let parameters = robot::inertial_parameters();
    let mut beta = DVector::zeros(P);
    for (base, of, factor) in robot::BASE_PARAMETER_TERMS {
        beta[base] += factor * parameters[of];
    }
    beta
}

/// Σ J_kᵀ f_k.
fn of_feet(y: &[f64; NY], forces: &[[f64; 3]; 4]) -> [f64; N] {
    let mut rows = [0.0; N];
    for (foot, force) in FEET.iter().zip(forces) {
        let jacobian = (foot.jacobian)(y);
        for (i, row) in rows.iter_mut().enumerate() {
            *row += (0..3).map(|axis| jacobian[axis][i] * force[axis]).sum::<f64>();
        }
    }
    rows
}

/// Converts the log to one run, with the poses and the forces of the feet.
fn run(log: &Log) -> Run {
    let mut ways = vec![[0.0; N]];
    for (k, rows) in log.rows.windows(2).enumerate() {
        let step = robot::difference(&rows[0].y, &rows[1].y);
        ways.push(std::array::from_fn(|i| ways[k][i] + step[i]));
    }
    let feet: Vec<[f64; N]> = log.rows.iter().map(|row| of_feet(&row.y, &row.feet)).collect();
    let columns = |rows: &[[f64; N]]| (0..N).map(|i| rows.iter().map(|row| row[i]).collect()).collect();
    Run {
        name: "log".into(),
        times: (0..log.rows.len()).map(|k| PERIOD * k as f64).collect(),
        rows: (0..log.rows.len()).collect(),
        positions: columns(&ways),
        poses: vec![],
        velocities: vec![None; N],
        efforts: columns(&feet),
        effort: Effort::Joint,
    }
}

/// Smoothed poses, their rates, and forces that passed the same filter.
fn prepared(log: &Log) -> Outcome<Vec<Sample>> {
    let run = run(log);
    let settings = PreparationSettings {
        bandwidth: Some(BANDWIDTH),
        rate: Some(RATE),
        delay: Some(0.0),
        ..PreparationSettings::default()
    };
    let smooth = &prepare_all(std::slice::from_ref(&run), None, &settings)?.0[0];
    let at = |columns: &[Vec<f64>], k: usize| -> [f64; N] { std::array::from_fn(|i| columns[i][k]) };
    let sample = |k: usize| {
        let row = smooth.rows[k];
        let (way, measured) = (at(&smooth.positions, k), at(&run.positions, row));
        // A smoothed pose is the measured pose, moved by the difference of smoothed and measured unwrapped coordinates.
        let y = robot::integrate(&log.rows[row].y, &std::array::from_fn(|i| way[i] - measured[i]));
        let (v, a) = (at(&smooth.velocities, k), at(&smooth.accelerations, k));
        Sample {
            time: smooth.times[k],
            regressor: robot::base_regressor(&y, &v, &a),
            feet: at(&smooth.efforts, k),
            torques: log.torques[row],
        }
    };
    Ok((0..smooth.times.len()).map(sample).collect())
}

/// A row of W_b β.
fn predicted(sample: &Sample, row: usize, beta: &DVector<f64>) -> f64 {
    sample.regressor[row].iter().zip(beta.iter()).map(|(w, beta)| w * beta).sum()
}

/// Root mean square of the residual of a row of the base with β.
fn residual(samples: &[Sample], row: usize, beta: &DVector<f64>) -> f64 {
    rms(samples.iter().map(|sample| sample.feet[row] - predicted(sample, row, beta)))
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    f64::sqrt(sum / count)
}

/// Weighted least squares on the rows of the base.
fn fit(samples: &[Sample]) -> Outcome<DVector<f64>> {
    let products = |row: usize| {
        let matrix = DMatrix::from_fn(P, samples.len(), |i, k| samples[k].regressor[row][i]);
        let forces = DVector::from_fn(samples.len(), |k, _| samples[k].feet[row]);
        (&matrix * matrix.transpose(), matrix * forces)
    };
    let products: Vec<_> = (0..BASE).map(products).collect();
    let (mut weights, mut beta) = ([1.0; BASE], DVector::zeros(P));
    for _ in 0..FITS {
        let (mut gram, mut right) = (DMatrix::zeros(P, P), DVector::zeros(P));
        for ((of_row, forces), weight) in products.iter().zip(weights) {
            gram += of_row * weight;
            right += forces * weight;
        }
        let sizes = gram.diagonal().map(f64::sqrt);
        let scaled = DMatrix::from_fn(P, P, |a, b| gram[(a, b)] / (sizes[a] * sizes[b]));
        let factor = scaled.cholesky().ok_or("the motion does not show all base parameters")?;
        beta = factor.solve(&right.component_div(&sizes)).component_div(&sizes);
        weights = std::array::from_fn(|row| residual(samples, row, &beta).powi(-2));
    }
    Ok(beta)
}

/// Singular values of the rows of the base for random motions without noise, and the singular vector of the smallest singular
/// value, which is β up to a factor.
///
/// - `in_flight`: whether the base accelerates as it would without forces at the feet
fn shown(in_flight: bool) -> Outcome<(Vec<f64>, DVector<f64>)> {
    let mut random = SplitMix64::new(3);
    let mut rows = vec![];
    for _ in 0..30 {
        let mut draw =
            |size: f64| -> [f64; N] { std::array::from_fn(|_| size * (2.0 * random.uniform() - 1.0)) };
        let y = robot::integrate(&quadruped::standing(), &draw(0.8));
        let (v, mut a) = (draw(4.0), draw(30.0));
        if in_flight {
            fall(&y, &v, &mut a)?;
        }
        rows.extend(robot::base_regressor(&y, &v, &a).into_iter().take(BASE).flatten());
    }
    let mut matrix = DMatrix::from_row_slice(rows.len() / P, P, &rows);
    let sizes: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
    matrix.column_iter_mut().zip(&sizes).for_each(|(mut column, size)| column /= *size);
    let decomposed = matrix.svd(false, true);
    let vectors = decomposed.v_t.ok_or("the factor was asked for")?;
    let last = vectors.row(P - 1).transpose();
    let factor = DVector::from_fn(P, |i, _| last[i] / sizes[i]);
    Ok((decomposed.singular_values.iter().copied().collect(), factor))
}

/// Sets the accelerations of the base to those of free flight.
fn fall(y: &[f64; NY], v: &[f64; N], a: &mut [f64; N]) -> Outcome<()> {
    let rows = |a: &[f64; N]| {
        let rows = robot::inverse_dynamics_with_wrenches(y, v, a, &[[0.0; 6]; WRENCHES]);
        SVector::<f64, BASE>::from_fn(|i, _| rows[i])
    };
    a[..BASE].fill(0.0);
    let bias = rows(a);
    let mut mass = SMatrix::<f64, BASE, BASE>::zeros();
    for i in 0..BASE {
        let mut moved = *a;
        moved[i] = 1.0;
        mass.set_column(i, &(rows(&moved) - bias));
    }
    let base = mass.cholesky().ok_or("the base has no mass")?.solve(&-bias);
    a[..BASE].copy_from_slice(base.as_slice());
    Ok(())
}

/// Reports the identifiable parameters from the rows of the base, with and without forces at the feet.
///
/// # Errors
/// An error if the rows do not determine all base parameters, or if the factor in flight is not the total mass.
fn identifiable(truth: &DVector<f64>) -> Outcome<()> {
    let rank = |values: &[f64]| values.iter().filter(|value| **value > 1e-9 * values[0]).count();
    let (standing, _) = shown(false)?;
    let (flying, factor) = shown(true)?;
    let scaled = &factor * (truth[0] / factor[0]);
    let error = (&scaled - truth).amax() / truth.amax();
    println!("{P} base parameters; the base's rows show {} with forces at the feet,", rank(&standing));
    println!(
        "{} in flight, where the total mass of {:.2} kg gives the others to {error:.0e}\n",
        rank(&flying),
        truth[0]
    );
    if rank(&standing) != P || rank(&flying) != P - 1 || error > 1e-9 {
        return Err("the rows of the base show another number of parameters than they should".into());
    }
    Ok(())
}

fn main() -> ExitCode {
    outcome::end(program())
}

fn program() -> Outcome<()> {
    let folder = Folder::from_arguments("base_rows")?;
    let truth = described();
    identifiable(&truth)?;
    let [log, other] = [Lifting::new(1).record()?, Lifting::new(2).record()?];
    for log in [&log, &other] {
        println!(
            "log of {} rows: standing feet press with {:.1} N or more and use {:.2} of their friction or less,\n    \
             swinging feet rise by {:.0} mm or more, torques use {:.2} of their limits or less",
            log.rows.len(),
            log.pressing,
            log.friction,
            1e3 * log.clearance,
            log.used_torque
        );
    }
    let beta = fit(&prepared(&log)?)?;
    let held_out = prepared(&other)?;
    report_rows(&held_out, &beta)?;
    report_torques(&held_out, &beta)?;
    report_parameters(&beta, &truth)?;
    plot(&folder, &held_out, &beta, &truth)
}

/// Reports the rows of the base in a motion that was not used for the fit.
///
/// # Errors
/// An error if the parameters explain a row badly.
fn report_rows(samples: &[Sample], beta: &DVector<f64>) -> Outcome<()> {
    println!("\n{:<12} {:>14} {:>12} {:>18}", "row", "R² held out", "residual", "deviation");
    for (row, (name, unit)) in ROWS.iter().enumerate() {
        let mean = samples.iter().map(|sample| sample.feet[row]).sum::<f64>() / samples.len() as f64;
        let deviation = rms(samples.iter().map(|sample| sample.feet[row] - mean));
        let residual = residual(samples, row, beta);
        let explained = 1.0 - (residual / deviation).powi(2);
        println!("{name:<12} {explained:>14.5} {residual:>12.4} {deviation:>14.3} {unit}");
        if explained < 0.95 {
            return Err(format!("{name} of the base is not explained").into());
        }
    }
    Ok(())
}

/// Predicted torque of a joint.
fn torque(sample: &Sample, joint: usize, beta: &DVector<f64>) -> f64 {
    predicted(sample, BASE + joint, beta) - sample.feet[BASE + joint]
}

/// Reports the predicted joint torques in the same motion. While a foot stands, the forces at the feet are their largest part.
/// The rest is `W_b β`.
///
/// # Errors
/// An error if a predicted torque is far from the true torque of the simulation.
fn report_torques(samples: &[Sample], beta: &DVector<f64>) -> Outcome<()> {
    println!("\n{:<18} {:>12} {:>14} {:>16}", "joint [N m]", "error", "torque", "of which W_b β");
    for (joint, name) in robot::JOINT_NAMES[1..].iter().enumerate() {
        let error = rms(samples.iter().map(|sample| torque(sample, joint, beta) - sample.torques[joint]));
        let size = rms(samples.iter().map(|sample| sample.torques[joint]));
        let moving = rms(samples.iter().map(|sample| sample.torques[joint] + sample.feet[BASE + joint]));
        println!("{name:<18} {error:>12.4} {size:>14.3} {moving:>16.3}");
        if error > MOST_ERROR * moving {
            return Err(format!("the torque of {name} is not predicted").into());
        }
    }
    Ok(())
}

/// Kinds of parameters: prefix of the names, quantity and unit.
const KINDS: [(&str, &str, &str); 3] =
    [("m_", "mass", "kg"), ("mc", "first moments", "kg m"), ("I", "moments of inertia", "kg m²")];

fn of_kind(start: &str) -> impl Iterator<Item = usize> {
    (0..P).filter(move |i| robot::BASE_PARAMETER_NAMES[*i].starts_with(start))
}

/// Reports the estimated parameters next to the true parameters of the simulated robot, which are those of the description.
///
/// # Errors
/// An error if the total mass is wrong.
fn report_parameters(beta: &DVector<f64>, truth: &DVector<f64>) -> Outcome<()> {
    println!("\n{:<20} {:>6} {:>16} {:>16}", "base parameters", "number", "largest error", "largest value");
    for (start, name, unit) in KINDS {
        let most = |value: &dyn Fn(usize) -> f64| of_kind(start).map(|i| value(i).abs()).fold(0.0, f64::max);
        let error = most(&|i| beta[i] - truth[i]);
        println!(
            "{name:<20} {:>6} {error:>16.5} {:>16.4} {unit}",
            of_kind(start).count(),
            most(&|i| truth[i])
        );
    }
    if (beta[0] / truth[0] - 1.0).abs() > 2e-3 {
        return Err("the total mass is not found".into());
    }
    Ok(())
}

fn plot(folder: &Folder, samples: &[Sample], beta: &DVector<f64>, truth: &DVector<f64>) -> Outcome<()> {
    let over = |value: &dyn Fn(&Sample) -> f64| -> Vec<[f64; 2]> {
        let shown = samples.iter().take_while(|sample| sample.time < SHOWN);
        shown.map(|sample| [sample.time, value(sample)]).collect()
    };
    let rows = ROWS.iter().enumerate().map(|(row, (name, unit))| {
        over_time(name, unit, [("measured", over(&|sample| sample.feet[row]))]).series(
            "predicted",
            Marks::Dashed,
            over(&|sample| predicted(sample, row, beta)),
        )
    });
    let torques = (0..3).map(|joint| {
        let lines = [
            ("by the forces at the feet alone", over(&|sample| -sample.feet[BASE + joint])),
            ("true", over(&|sample| sample.torques[joint])),
        ];
        over_time(&format!("torque of {}", robot::JOINT_NAMES[1 + joint]), "N m", lines).series(
            "predicted",
            Marks::Dashed,
            over(&|sample| torque(sample, joint, beta)),
        )
    });
    let figures = vec![
        parameters(beta, truth),
        figure("rows", "The rows of the base in a motion that the fit has not seen.", rows),
        figure("torques", "Torques in the same motion: no torque was ever measured.", torques),
    ];
    folder.write("Base parameters from the rows of the base", figures)
}

/// Figure of estimated over true values. The moments of the trunk include bodies that are attached to it, and are larger than
/// all other moments.
fn parameters(beta: &DVector<f64>, truth: &DVector<f64>) -> Figure {
    let plot = |title: &str, kind: usize, is_shown: &dyn Fn(&str) -> bool| {
        let (start, name, unit) = KINDS[kind];
        let shown = of_kind(start).filter(|i| is_shown(robot::BASE_PARAMETER_NAMES[*i]));
        let points: Vec<[f64; 2]> = shown.map(|i| [truth[i], beta[i]]).collect();
        let low = points.iter().map(|[x, _]| *x).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|[x, _]| *x).fold(f64::NEG_INFINITY, f64::max);
        let axis = |which: &str| Axis::new(format!("{name}, {which}"), unit);
        Plot::new(title, axis("true"), axis("estimated"))
            .series("exact", Marks::Dashed, vec![[low; 2], [high; 2]])
            .series("base parameters", Marks::Points, points)
    };
    let plots = [
        plot("first moments", 1, &|_| true),
        plot("moments of inertia of the trunk", 2, &|name| name.ends_with("_base")),
        plot("moments of inertia of the legs", 2, &|name| !name.ends_with("_base")),
    ];
    figure("parameters", "Base parameters as estimated, over those of the simulated robot.", plots)
}
