//! Simulated arm with its friction, the conditions of inputs and measurements, and the desired trajectory.

use crate::study::Outcome;
use gelenk_generated::powercube_parameters::Parameters;
use gelenk_identification::methods::library::Library;
use gelenk_runtime::plant::PlantOptions;
use gelenk_runtime::trajectory::{Columns, Recording, Sampled, Smoothing};

gelenk_runtime::dynamics!(
    /// The arm with the coordinates y = (β, γ), and with friction and gravity as parameters. Plants and controllers have
    /// separate parameters. `Default` is the published arm.
    pub struct Arm { parameters } = gelenk_generated::powercube_parameters: Discretizable []
);

/// Gear ratio of both joints.
pub const GEAR: f64 = 161.0;
/// Peak torque of the motors [N m], which is 80.5 N m at the joint.
pub const PEAK: f64 = 0.5;
/// Period of the published trajectory, and of control along it (s).
pub const PERIOD: f64 = 0.02;
/// Names of the joints, for figures and tables.
pub const JOINTS: [&str; 2] = ["β", "γ"];

/// Number of terms of a [`Friction`].
pub const TERMS: usize = 7;

/// Coefficients of the friction torque of one joint [N m] for the terms 1, v, sign v, tanh 5v, tanh 10v, tanh 20v and tanh 100v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction(pub [f64; TERMS]);

impl Friction {
    /// Friction of joint A, the α axis. It is not published, so this is an estimate for a module of the same type.
    pub const A: Self = Self([0.0, 60.0, 0.0, 0.0, 0.0, 10.0, 0.0]);
    /// Published friction of joint B, the β axis.
    pub const B: Self = Self([0.0, 76.556, 0.0, 3.924, 10.838, 2.236, 0.0]);
    /// Published friction of joint C, the γ axis.
    pub const C: Self = Self([0.0, 56.231, 0.492, 0.368, 0.368, 0.0, 8.342]);
    /// Substitute for the old friction model, one curve 45 v + 9 tanh 10v for all joints. The model of Oberhuber is not published.
    pub const OLD: Self = Self([0.0, 45.0, 0.0, 0.0, 9.0, 0.0, 0.0]);

    /// Values of the terms at velocity `v` [rad/s], with sign(0) = 0.
    pub fn terms(v: f64) -> [f64; TERMS] {
        let sign = if v == 0.0 { 0.0 } else { v.signum() };
        let tanh = |slope: f64| (slope * v).tanh();
        [1.0, v, sign, tanh(5.0), tanh(10.0), tanh(20.0), tanh(100.0)]
    }

    /// Friction torque τ(v) [N m] at velocity `v` [rad/s].
    pub fn at(&self, v: f64) -> f64 {
        let terms = Self::terms(v);
        self.0.iter().zip(terms).map(|(a, b)| a * b).sum()
    }

    /// The same friction multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|one| factor * one))
    }

    /// The terms as a library for identification.
    pub fn library() -> Outcome<Library> {
        Ok(Library::friction()?)
    }
}

/// The published arm with this friction at the joints (β, γ).
pub fn arm([beta, gamma]: [Friction; 2]) -> Arm {
    let Friction(beta) = beta;
    let Friction(gamma) = gamma;
    Arm {
        parameters: Parameters {
            g: Parameters::DESCRIBED.g,
            load: 0.0,
            beta_constant: beta[0],
            beta_viscous: beta[1],
            beta_sign: beta[2],
            beta_tanh_5: beta[3],
            beta_tanh_10: beta[4],
            beta_tanh_20: beta[5],
            beta_tanh_100: beta[6],
            gamma_constant: gamma[0],
            gamma_viscous: gamma[1],
            gamma_sign: gamma[2],
            gamma_tanh_5: gamma[3],
            gamma_tanh_10: gamma[4],
            gamma_tanh_20: gamma[5],
            gamma_tanh_100: gamma[6],
        },
    }
}

/// The same arm with gravity multiplied by 1 + `share`. The share 0.08 makes a model that is 8 % too heavy.
pub fn heavier(mut arm: Arm, share: f64) -> Arm {
    arm.parameters.g *= 1.0 + share;
    arm
}

/// The same arm with a mass [kg] between its fingers.
pub fn carrying(mut arm: Arm, mass: f64) -> Arm {
    arm.parameters.load = mass;
    arm
}

/// Conditions of an experiment: effects of electronics and bus on inputs and measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regime {
    /// Sample time of control (s).
    pub period: f64,
    /// Number of periods from the computation of an input to its effect.
    pub delay: usize,
    /// Resolution of the encoders at the joints [rad].
    pub encoder_step: f64,
    /// Standard deviation of the noise of measured positions before rounding [rad].
    pub encoder_noise: f64,
    /// Resolution of the motor torques [N m].
    pub torque_step: f64,
    /// Standard deviation of the noise of the motor torques, which is constant during a period [N m].
    pub torque_noise: f64,
}

impl Regime {
    /// Ideal conditions: 50 Hz, exact encoders and torques, no delay.
    pub const IDEAL: Self = Self {
        period: PERIOD,
        delay: 0,
        encoder_step: 0.0,
        encoder_noise: 0.0,
        torque_step: 0.0,
        torque_noise: 0.0,
    };
    /// Realistic conditions: 50 Hz, inputs that act one period late, encoders of 0.1 mrad, and torques in steps of 0.8 N m at the
    /// joint. These numbers are assumptions, because those of the arm are not published.
    pub const REALISTIC: Self = Self {
        period: PERIOD,
        delay: 1,
        encoder_step: 1e-4,
        encoder_noise: 5e-5,
        torque_step: 5e-3,
        torque_noise: 2e-3,
    };

    /// Options of the plant for these conditions, with the peak torque of the motors.
    pub fn plant(&self, seed: u64) -> PlantOptions<2, 2> {
        PlantOptions {
            encoder_resolution: [self.encoder_step; 2],
            encoder_noise: [self.encoder_noise; 2],
            input_resolution: [self.torque_step; 2],
            input_limits: [[-PEAK, PEAK]; 2],
            input_noise: [self.torque_noise; 2],
            delay: self.delay,
            seed,
            ..PlantOptions::default()
        }
    }
}

/// Reads the published trajectory: 1220 samples every 20 ms, from rest to rest with motion reversals and zero crossings.
pub fn recording() -> Outcome<Recording<2>> {
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let data = include_bytes!("../data/powercube_trajectory.csv");
    Ok(Recording::read(&data[..], "powercube_trajectory.csv", &columns)?)
}

/// Returns the published trajectory, smoothed so that positions, velocities and accelerations are consistent.
pub fn reference() -> Outcome<Sampled<2>> {
    Ok(recording()?.smoothed(&Smoothing::of(PERIOD))?.trajectory)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gelenk_runtime::dynamics::Dynamics;

    #[test]
    fn curves_are_the_friction_of_the_generated_arm() {
        let model = arm([Friction::B, Friction::C]);
        assert_eq!(model, Arm::default());
        let swapped = arm([Friction::C, Friction([0.1, 2.0, 0.3, 0.4, 0.5, 0.6, 0.7])]);
        for v in [-0.7, -0.01, 0.0, 0.03, 0.9] {
            let torques = swapped.friction_torques(&[0.0; 2], &[v; 2]);
            let expected = [Friction::C.at(v), Friction([0.1, 2.0, 0.3, 0.4, 0.5, 0.6, 0.7]).at(v)];
            for i in 0..2 {
                assert!((torques[i] - expected[i]).abs() < 1e-12, "{v}: {torques:?}");
            }
        }
    }
}
