//! Simulated experiments for identification. Controlled motions of the joints are recorded, and a rigid-body model converts the
//! measured positions and motor torques to friction torques.

use crate::arm::{Arm, Friction, PEAK, PERIOD, Regime, arm};
use crate::methods::torque::{Motion, friction_torques};
use crate::study::Outcome;
use gelenk_generated::powercube_alpha_parameters::Parameters;
use gelenk_identification::excitation::FourierMotion;
use gelenk_identification::methods::differentiation::{TotalVariation, quantization_noise};
use gelenk_runtime::dynamics::{Differentiable, Dynamics, Linearization};
use gelenk_runtime::lqr::Lqr;
use gelenk_runtime::plant::{Plant, PlantOptions};

gelenk_runtime::dynamics!(
    /// Model of joint A alone, with a vertical axis and the arm stretched out horizontally.
    pub struct Alpha { parameters } = gelenk_generated::powercube_alpha_parameters
);

/// Joint A with this friction.
pub fn alpha(Friction(terms): Friction) -> Alpha {
    Alpha {
        parameters: Parameters {
            alpha_constant: terms[0],
            alpha_viscous: terms[1],
            alpha_sign: terms[2],
            alpha_tanh_5: terms[3],
            alpha_tanh_10: terms[4],
            alpha_tanh_20: terms[5],
            alpha_tanh_100: terms[6],
        },
    }
}

/// Model of the controllers during the experiments. It has the old friction model, because a better model is not known yet.
pub fn controller_arm() -> Arm {
    arm([Friction::OLD; 2])
}

/// The published arm, the plant.
pub fn published_arm() -> Arm {
    arm([Friction::B, Friction::C])
}

/// Conditions with encoders of 0.1 mrad and 0.3 N m of noise at the joint.
pub const MEASURED: Regime = Regime { encoder_step: 1e-4, torque_noise: 2e-3, ..Regime::IDEAL };
/// Number of samples that are omitted at both ends (1 s), because the smoother has only neighbours on one side.
const MARGIN: usize = 50;
/// Fundamental period of the motions (s).
pub const REPEAT: f64 = 30.0;

/// Sines of 0.1, 0.23 and 0.37 Hz around `center`, multiplied by `size`. With size 1 they reach 0.5 rad/s.
fn waves(size: f64, center: f64) -> (f64, Vec<[f64; 2]>) {
    let mut coefficients = vec![[0.0; 2]; 11];
    coefficients[2] = [0.45 * size, 0.0];
    coefficients[6] = [0.08 * size, 0.06 * size];
    coefficients[10] = [0.0, 0.04 * size];
    (center * size, coefficients)
}

/// A periodic motion with a size for each joint. The centre is 0.2 rad times the size.
pub fn periodic<const N: usize>(sizes: [f64; N]) -> FourierMotion {
    let waves = sizes.map(|size| waves(size, 0.2));
    FourierMotion {
        period: REPEAT,
        center: waves.each_ref().map(|(center, _)| *center).to_vec(),
        coefficients: waves.map(|(_, coefficients)| coefficients).to_vec(),
    }
}

/// Motion of β with γ at 0.
pub fn beta_alone() -> FourierMotion {
    periodic([1.0, 0.0])
}

/// Motion of γ with β at 0 (upright).
pub fn gamma_alone() -> FourierMotion {
    periodic([0.0, 1.0])
}

/// Motion with β = −γ. The link after γ remains upright, so gravity causes no torque at γ.
pub fn opposed() -> FourierMotion {
    periodic([1.0, -1.0])
}

/// A recorded motion.
pub struct Record<const N: usize> {
    /// Times of the readings (s).
    pub times: Vec<f64>,
    /// Encoder readings [rad].
    pub positions: [Vec<f64>; N],
    /// Commanded motor torques [N m]. At each reading, the value is the mean of the periods before and after the reading, because
    /// inputs are constant between readings.
    pub inputs: [Vec<f64>; N],
    /// True velocities [rad/s].
    pub velocities: [Vec<f64>; N],
}

/// Drives `plant` along `motion` by feed-forward of `model` and a linear-quadratic regulator for each joint. Returns the record.
pub fn record<const N: usize>(
    plant: impl Dynamics<N, N>,
    model: &impl Differentiable<N, N>,
    motion: &FourierMotion,
    seconds: f64,
    (regime, seed): (&Regime, u64),
) -> Outcome<Record<N>> {
    let samples = (seconds / PERIOD).round() as usize;
    let gains = regulators(model)?;
    let gear = model.drive_matrix();
    let mut plant = Plant::new(plant, options(regime, seed))?;
    let at = |time: f64| motion.instant(time).map(|x| std::array::from_fn(|joint| x[joint]));
    let [start, speed, _] = at(0.0);
    plant.reset(start, speed)?;
    let mut record = Record {
        times: Vec::with_capacity(samples),
        positions: std::array::from_fn(|_| Vec::with_capacity(samples)),
        inputs: std::array::from_fn(|_| Vec::with_capacity(samples)),
        velocities: std::array::from_fn(|_| Vec::with_capacity(samples)),
    };
    let mut before = start.map(|_| None);
    let mut last = None;
    for k in 0..samples {
        let time = k as f64 * PERIOD;
        let [y, v, a] = at(time);
        let measured = plant.measure().positions;
        let forces = model.inverse_dynamics(&y, &v, &a);
        let inputs: [f64; N] = std::array::from_fn(|i| {
            let speed = before[i].map_or(v[i], |before: f64| (measured[i] - before) / PERIOD);
            let feedback = gains[i].input(&[measured[i] - y[i], speed - v[i]])[0];
            (forces[i] / gear[i][i] + feedback).clamp(-PEAK, PEAK)
        });
        let (_, velocities) = plant.state();
        record.times.push(time);
        for i in 0..N {
            record.positions[i].push(measured[i]);
            record.velocities[i].push(velocities[i]);
            let earlier = last.map_or(inputs[i], |last: [f64; N]| last[i]);
            record.inputs[i].push(0.5 * (earlier + inputs[i]));
        }
        plant.apply(&inputs, PERIOD)?;
        before = measured.map(Some);
        last = Some(inputs);
    }
    Ok(record)
}

fn options<const N: usize>(regime: &Regime, seed: u64) -> PlantOptions<N, N> {
    PlantOptions {
        encoder_resolution: [regime.encoder_step; N],
        encoder_noise: [regime.encoder_noise; N],
        input_resolution: [regime.torque_step; N],
        input_noise: [regime.torque_noise; N],
        input_limits: [[-PEAK, PEAK]; N],
        relative_tolerance: 1e-8,
        absolute_tolerance: 1e-8,
        seed,
        ..PlantOptions::default()
    }
}

/// One linear-quadratic regulator for each joint, from the diagonal of the linearization at rest. Deviations of 20 mrad, 0.2 rad/s
/// and 0.2 N m have the same cost.
fn regulators<const N: usize>(model: &impl Differentiable<N, N>) -> Outcome<[Lqr<2, 1>; N]> {
    let linear = model.linearize(&[0.0; N], &[0.0; N], &[0.0; N]);
    let mut gains = Vec::with_capacity(N);
    for i in 0..N {
        let joint = Linearization {
            by_coordinates: [[linear.by_coordinates[i][i]]],
            by_velocities: [[linear.by_velocities[i][i]]],
            by_inputs: [[linear.by_inputs[i][i]]],
            affine: [0.0],
        };
        let step = joint.discretize(PERIOD);
        let state = step.state.map(|row| row.map(|block| block[0][0]));
        let input = step.input.map(|block| [block[0][0]]);
        let weights = [[2500.0, 0.0], [0.0, 25.0]];
        gains.push(Lqr::new(&state, &input, &weights, &[[25.0]])?);
    }
    gains.try_into().map_err(|_| "one regulator for each joint".into())
}

/// Friction samples of a joint.
#[derive(Clone, Default)]
pub struct Samples {
    /// Angles y [rad].
    pub angles: Vec<f64>,
    /// Velocities ẏ [rad/s].
    pub velocities: Vec<f64>,
    /// Friction torques that the model leaves [N m].
    pub torques: Vec<f64>,
}

impl Samples {
    pub fn len(&self) -> usize {
        self.angles.len()
    }

    /// Largest speed [rad/s].
    pub fn fastest(&self) -> f64 {
        self.velocities.iter().fold(0.0, |most, v| most.max(v.abs()))
    }

    /// Smallest speed [rad/s].
    pub fn slowest(&self) -> f64 {
        let speeds = self.velocities.iter().map(|v| v.abs());
        speeds.fold(f64::INFINITY, f64::min)
    }

    /// The samples that satisfy a condition on angle and velocity.
    pub fn select(&self, keep: impl Fn(f64, f64) -> bool) -> Self {
        self.rows((0..self.len()).filter(|&i| keep(self.angles[i], self.velocities[i])))
    }

    /// The first `count` samples.
    pub fn first(&self, count: usize) -> Self {
        self.rows(0..count.min(self.len()))
    }

    /// At most `count` samples, evenly spread.
    pub fn thinned(&self, count: usize) -> Self {
        self.rows((0..self.len()).step_by(self.len().div_ceil(count.max(1)).max(1)))
    }

    fn rows(&self, rows: impl Iterator<Item = usize>) -> Self {
        let mut out = Self::default();
        for i in rows {
            out.angles.push(self.angles[i]);
            out.velocities.push(self.velocities[i]);
            out.torques.push(self.torques[i]);
        }
        out
    }

    /// At most `count` points (velocity, torque) for a plot.
    pub fn points(&self, count: usize) -> Vec<[f64; 2]> {
        let shown = self.thinned(count);
        let pairs = shown.velocities.iter().zip(&shown.torques);
        pairs.map(|(v, torque)| [*v, *torque]).collect()
    }
}

/// Friction torques `q_s + B u − M ÿ − k` of a record, where q_s are the applied forces without friction. Velocities and
/// accelerations are computed by total-variation regularized differentiation.
pub fn friction_samples<const N: usize>(
    record: &Record<N>,
    model: &impl Dynamics<N, N>,
    encoder_step: f64,
) -> Outcome<[Samples; N]> {
    let smoothing = TotalVariation::from_noise(quantization_noise(encoder_step));
    let mut smooth = Vec::with_capacity(N);
    for positions in &record.positions {
        smooth.push(smoothing.differentiate(&record.times, positions)?);
    }
    let motion = Motion {
        positions: std::array::from_fn(|i| smooth[i].value.as_slice()),
        velocities: std::array::from_fn(|i| smooth[i].first.as_slice()),
        accelerations: std::array::from_fn(|i| smooth[i].second.as_slice()),
        inputs: std::array::from_fn(|i| record.inputs[i].as_slice()),
    };
    let torques = friction_torques(model, &motion)?;
    let inner = MARGIN..record.times.len().saturating_sub(MARGIN).max(MARGIN);
    Ok(std::array::from_fn(|i| Samples {
        angles: smooth[i].value[inner.clone()].to_vec(),
        velocities: smooth[i].first[inner.clone()].to_vec(),
        torques: torques[i][inner.clone()].to_vec(),
    }))
}

/// Root mean square.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0_usize), |(sum, count), x| (sum + x * x, count + 1));
    (sum / count.max(1) as f64).sqrt()
}
