//! Friction of the published reduced PowerCube, found again from simulated encoder readings.
//!
//! 50 Hz, encoder resolution 1e-4 rad, 60 s per joint, worst of twenty seeds. The law has several tanh terms
//! that nearly coincide at these speeds, so the curve is judged, not the coefficients.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "test code: what cannot be set up ends the test")]

use crate::methods::kalman::KalmanSmoother;
use crate::methods::random::SplitMix64;
use crate::methods::torque::{Motion, friction_torques};
use gelenk_generated::powercube;
use gelenk_identification::Result;
use gelenk_identification::excitation::FourierMotion;
use gelenk_identification::methods::differentiation::quantization_noise;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::Samples;
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_runtime::dynamics::Dynamics;

const I: f64 = 161.0;
/// Base parameters of the arm.
const BASE: usize = powercube::BASE_PARAMETER_NAMES.len();
const STEP: f64 = 0.02;
const SAMPLES: usize = 3000;

gelenk_runtime::dynamics!(struct PowerCube = powercube);

/// The published friction torques.
fn friction(joint: usize, v: f64) -> f64 {
    let sign = if v == 0.0 { 0.0 } else { v.signum() };
    match joint {
        0 => 3.924 * (5.0 * v).tanh() + 10.838 * (10.0 * v).tanh() + 2.236 * (20.0 * v).tanh() + 76.556 * v,
        _ => {
            0.368 * (5.0 * v).tanh()
                + 0.368 * (10.0 * v).tanh()
                + 8.342 * (100.0 * v).tanh()
                + 0.492 * sign
                + 56.231 * v
        }
    }
}

/// Position, velocity, acceleration of a sum of sines whose phases follow from the seed.
fn trajectory(seed: u64) -> [Vec<f64>; 3] {
    let mut random = SplitMix64::new(seed);
    let waves: Vec<(f64, f64, f64)> = [(0.55, 0.9), (0.25, 1.7), (0.1, 2.9)]
        .map(|(amplitude, rate)| (amplitude, rate, random.uniform() * std::f64::consts::TAU))
        .to_vec();
    let sum = |f: &dyn Fn(f64, f64, f64, f64) -> f64| -> Vec<f64> {
        (0..SAMPLES).map(|i| waves.iter().map(|(a, w, p)| f(*a, *w, *p, STEP * i as f64)).sum()).collect()
    };
    [
        sum(&|a, w, p, t| a * (w * t + p).sin()),
        sum(&|a, w, p, t| a * w * (w * t + p).cos()),
        sum(&|a, w, p, t| -a * w * w * (w * t + p).sin()),
    ]
}

/// Result of one identification.
struct Outcome {
    /// Difference of the curves over the speeds in the data [N·m rms].
    error: f64,
    active: Vec<usize>,
    fastest: f64,
}

/// Motor torques that move the arm exactly along two trajectories.
fn inputs(motion: &[[Vec<f64>; 3]; 2]) -> [Vec<f64>; 2] {
    let mut inputs = [Vec::new(), Vec::new()];
    for i in 0..SAMPLES {
        let at = |k: usize| [motion[0][k][i], motion[1][k][i]];
        let rigid = PowerCube.inverse_dynamics(&at(0), &at(1), &at(2));
        let own = PowerCube.friction_torques(&at(0), &at(1));
        for j in 0..2 {
            inputs[j].push((rigid[j] - own[j] + friction(j, at(1)[j])) / I);
        }
    }
    inputs
}

/// Encoder readings of a position, smoothed and differentiated.
fn measure(position: &[f64], resolution: f64) -> Result<[Vec<f64>; 3]> {
    let times: Vec<f64> = (0..SAMPLES).map(|i| STEP * i as f64).collect();
    let encoder: Vec<f64> = position.iter().map(|y| (y / resolution).round() * resolution).collect();
    let d = KalmanSmoother::from_noise(quantization_noise(resolution)).differentiate(&times, &encoder)?;
    Ok([d.value, d.first, d.second])
}

/// Identifies one joint's law from a motion.
fn identify(joint: usize, seed: u64, resolution: Option<f64>) -> Result<Outcome> {
    let truth = [trajectory(2 * seed), trajectory(2 * seed + 1)];
    let inputs = inputs(&truth);
    let measured = match resolution {
        None => truth.clone(),
        Some(r) => [measure(&truth[0][0], r)?, measure(&truth[1][0], r)?],
    };
    let columns = |k: usize| [measured[0][k].as_slice(), measured[1][k].as_slice()];
    let motion = Motion {
        positions: columns(0),
        velocities: columns(1),
        accelerations: columns(2),
        inputs: [&inputs[0], &inputs[1]],
    };
    let torques = friction_torques(&PowerCube, &motion)?;
    let inner = 50..SAMPLES - 50;
    let v = &measured[joint][1][inner.clone()];
    let library = Library::friction()?;
    let samples = Samples::from_library(&library, vec![v], vec![&torques[joint][inner]])?;
    let settings = Thresholding { threshold: 0.1, ..Default::default() };
    let fit = settings.fit(&Reduced::new(&samples)?, 0)?;
    let fastest = truth[joint][1].iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    let grid: Vec<f64> = (-200..=200).map(|i| fastest * f64::from(i) / 200.0).collect();
    let curve = library.matrix(&[&grid])? * &fit.coefficients;
    let squares = grid.iter().zip(curve.iter()).map(|(v, c)| (friction(joint, *v) - c).powi(2));
    let error = (squares.sum::<f64>() / grid.len() as f64).sqrt();
    Ok(Outcome { error, active: fit.active, fastest })
}

#[test]
fn curves_are_recovered_from_quantized_positions() {
    for joint in 0..2 {
        let mut worst = 0.0_f64;
        for seed in 1..=20 {
            let found = identify(joint, seed, Some(1e-4)).unwrap();
            assert!(found.fastest >= 0.7);
            worst = worst.max(found.error);
        }
        println!("joint {joint}: worst {worst:.4} N m rms");
        assert!(worst < 0.5, "joint {joint}: {worst}");
    }
}

/// Without quantization the library [1, v, sign v, tanh 5v, tanh 10v, tanh 20v, tanh 100v] gives exactly the
/// terms of the published law.
#[test]
fn terms_are_exact_without_noise() {
    for seed in 1..=20 {
        assert_eq!(identify(0, seed, None).unwrap().active, [1, 3, 4, 5]);
        assert_eq!(identify(1, seed, None).unwrap().active, [1, 2, 3, 4, 6]);
    }
}

/// Excitation, log, regression: the published base parameters come back from encoders and noisy torques.
#[test]
fn base_parameters_are_recovered_along_an_excitation() {
    let first = [[0.5, 0.1], [-0.2, 0.15], [0.1, -0.08], [0.05, 0.06], [-0.04, 0.03]];
    let second = [[-0.3, 0.25], [0.25, -0.1], [0.12, 0.1], [-0.08, 0.05], [0.05, -0.06]];
    let coefficients = vec![first.to_vec(), second.to_vec()];
    let motion = FourierMotion { period: 10.0, center: vec![0.1, -0.2], coefficients };
    let instants: Vec<[[f64; 2]; 3]> =
        (0..SAMPLES).map(|i| motion.instant(STEP * i as f64).map(|x| [x[0], x[1]])).collect();
    let column = |k: usize, j: usize| -> Vec<f64> { instants.iter().map(|x| x[k][j]).collect() };
    let measured = [0, 1].map(|j| measure(&column(0, j), 1e-4).unwrap());
    let mut random = SplitMix64::new(5);
    let torques: [Vec<f64>; 2] = [0, 1].map(|j| {
        let rigid = |x: &[[f64; 2]; 3]| {
            PowerCube.inverse_dynamics(&x[0], &x[1], &x[2])[j] - PowerCube.friction_torques(&x[0], &x[1])[j]
        };
        instants.iter().map(|x| rigid(x) + 0.1 * random.normal()).collect()
    });
    // The rows of both joints, one joint behind the other.
    let inner = 50..SAMPLES - 50;
    let mut columns = vec![Vec::new(); BASE];
    for joint in 0..2 {
        for i in inner.clone() {
            let [y, v, a] = [0, 1, 2].map(|k| [measured[0][k][i], measured[1][k][i]]);
            let row = powercube::base_regressor(&y, &v, &a)[joint];
            columns.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
        }
    }
    let torques = torques.map(|t| t[inner.clone()].to_vec()).concat();
    let names = powercube::BASE_PARAMETER_NAMES.map(String::from);
    let samples =
        Samples::from_columns(&names, columns.iter().map(Vec::as_slice).collect(), vec![&torques]).unwrap();
    let fit = Reduced::new(&samples).unwrap().fit(0, &std::array::from_fn::<usize, BASE, _>(|i| i)).unwrap();
    let (described, mut published) = (powercube::inertial_parameters(), [0.0; BASE]);
    for (i, j, factor) in powercube::BASE_PARAMETER_TERMS {
        published[i] += factor * described[j];
    }
    for (i, truth) in published.iter().enumerate() {
        let (value, error) = (fit.coefficients[i], fit.standard_errors[i]);
        println!("{}: {value:.6} ± {error:.6}, published {truth:.6}", names[i]);
        assert!((value - truth).abs() < 4.0 * error + 1e-3 * truth.abs());
    }
}
