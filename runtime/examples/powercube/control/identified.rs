//! Identification of friction as in the paper, by sparse regression from a motion of the arm.

use super::run::{self, Setup};
use crate::arm::{Arm, Friction, PERIOD, Regime, arm};
use crate::methods::kalman::KalmanSmoother;
use crate::methods::torque::{Motion, friction_torques};
use crate::study::Outcome;
use gelenk_identification::methods::differentiation::quantization_noise;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::moments::Samples;
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_runtime::trajectory::{IdentificationSine, Sampled};

/// Resolution of the encoders while the motion is recorded [rad].
const ENCODER_STEP: f64 = 1e-4;
/// Number of samples that are omitted at both ends, because the smoother has only neighbours on one side.
const MARGIN: usize = 50;

/// Velocities and friction torques of both joints, computed from a log.
pub struct FrictionSamples {
    pub velocities: [Vec<f64>; 2],
    pub torques: [Vec<f64>; 2],
}

/// Records the identification sine on `plant` with an MPC that uses the old friction, and computes friction torques with the
/// rigid-body model of `model`.
pub fn record(plant: Arm, model: Arm, duration: f64) -> Outcome<FrictionSamples> {
    let sine = IdentificationSine {
        center: [0.0, 0.0],
        amplitude: [0.5, 0.6],
        first_frequency: [0.4, 0.3],
        last_frequency: [0.85, 0.7],
        sine_duration: duration,
        run_in: 2.0,
    };
    let reference = Sampled::of(&sine.motion()?, PERIOD)?;
    let regime = Regime { encoder_step: ENCODER_STEP, ..Regime::IDEAL };
    let mut old = arm([Friction::OLD; 2]);
    old.parameters.g = model.parameters.g;
    let mut options = run::options(&old, PERIOD);
    options.observer.encoder_noise = [quantization_noise(ENCODER_STEP); 2];
    let run = run::linear(&Setup::new(plant, regime), old, options, &reference)?;
    let times: Vec<f64> = run.rows.iter().map(|row| row.time).collect();
    let smoother = KalmanSmoother::from_noise(quantization_noise(ENCODER_STEP));
    let mut measured = Vec::new();
    let mut inputs = Vec::new();
    for i in 0..2 {
        let positions: Vec<f64> = run.rows.iter().map(|row| row.measured[i]).collect();
        measured.push(smoother.differentiate(&times, &positions)?);
        // At a sample the input jumps from the value of one period to that of the next.
        let held = |k: usize| run.rows[k].inputs[i];
        let middle = (0..times.len()).map(|k| 0.5 * (held(k.saturating_sub(1)) + held(k)));
        inputs.push(middle.collect::<Vec<f64>>());
    }
    let motion = Motion {
        positions: [&measured[0].value, &measured[1].value],
        velocities: [&measured[0].first, &measured[1].first],
        accelerations: [&measured[0].second, &measured[1].second],
        inputs: [&inputs[0], &inputs[1]],
    };
    let torques = friction_torques(&model, &motion)?;
    let inner = MARGIN..times.len() - MARGIN;
    Ok(FrictionSamples {
        velocities: [0, 1].map(|i| measured[i].first[inner.clone()].to_vec()),
        torques: torques.map(|torque| torque[inner.clone()].to_vec()),
    })
}

/// Friction of both joints by sequentially thresholded least squares.
pub fn identify(plant: Arm, model: Arm, duration: f64) -> Outcome<[Friction; 2]> {
    let samples = record(plant, model, duration)?;
    Ok([fit(&samples, 0)?, fit(&samples, 1)?])
}

fn fit(samples: &FrictionSamples, joint: usize) -> Outcome<Friction> {
    let library = Friction::library()?;
    let (v, torques) = (&samples.velocities[joint], &samples.torques[joint]);
    let samples = Samples::from_library(&library, vec![v], vec![torques])?;
    let fit = Thresholding::default().fit(&Reduced::new(&samples)?, 0)?;
    Ok(Friction(core::array::from_fn(|i| fit.coefficients[i])))
}
