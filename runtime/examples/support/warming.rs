//! Simulated joints with drifting friction. Each joint is a pendulum with a gear, Coulomb friction and stiction, under PD control.
#![allow(clippy::expect_used, reason = "what cannot be set up ends the study")]

use super::random::SplitMix64;
use gelenk_runtime::adaptation::{Adaptation, AdaptationSettings, DescribedForces, Magnitudes, Measured};

/// Period of control (s).
pub const PERIOD: f64 = 0.01;
/// Number of integration steps in a period.
const SUBSTEPS: u32 = 10;
/// Largest speed of the joints [rad/s].
pub const SPEED: f64 = 1.5;

/// Parameters of the true friction: viscous friction, Coulomb friction, and additional friction at rest (stiction).
#[derive(Clone, Copy)]
pub struct Rubbing {
    pub viscous: f64,
    pub coulomb: f64,
    pub stiction: f64,
    /// Decay of the stiction with the speed [rad/s] (Stribeck).
    pub stribeck: f64,
}

impl Rubbing {
    /// Magnitude of friction at a speed [N m].
    pub fn magnitude(&self, speed: f64) -> f64 {
        let more = self.stiction * (-(speed / self.stribeck).powi(2)).exp();
        self.viscous * speed + self.coulomb + more
    }
}

/// Drift of friction: final factors of the viscous and of the dry part, and the time constant of the drift.
#[derive(Clone, Copy)]
pub struct Drift {
    pub viscous: f64,
    pub dry: f64,
    pub time: f64,
}

impl Drift {
    pub const NONE: Self = Self { viscous: 1.0, dry: 1.0, time: 1.0 };

    pub fn at(&self, friction: &Rubbing, time: f64) -> Rubbing {
        let progress = 1.0 - (-time / self.time).exp();
        let [viscous, dry] = [self.viscous, self.dry].map(|factor| 1.0 + (factor - 1.0) * progress);
        Rubbing {
            viscous: friction.viscous * viscous,
            coulomb: friction.coulomb * dry,
            stiction: friction.stiction * dry,
            ..*friction
        }
    }
}

/// A joint with its controller and its sensors.
#[derive(Clone)]
pub struct Simulated {
    pub inertia: f64,
    pub gravity: f64,
    pub friction: Rubbing,
    pub drift: Drift,
    pub encoder: f64,
    /// Standard deviation of the noise of the torque, which is constant during a period [N m].
    pub noise: f64,
    /// Amplitudes, frequencies [rad/s] and phases of the desired motion.
    pub motion: [[f64; 3]; 3],
    pub random: SplitMix64,
    pub state: [f64; 2],
    pub time: f64,
    /// Last measured position.
    pub measured: f64,
    pub torque: f64,
    /// Largest torque of the drive [N m].
    pub limit: f64,
}

/// Motion and torque of the joint in a period.
pub struct Period {
    pub position: f64,
    /// Commanded torque of the previous period.
    pub torque: f64,
    pub saturated: bool,
}

impl Simulated {
    /// A joint with random parameters.
    pub fn new(seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let between =
            |random: &mut SplitMix64, low: f64, high: f64| low * (high / low).powf(random.uniform());
        let inertia = between(&mut random, 0.3, 5.0);
        let coulomb = between(&mut random, 2.0, 15.0);
        let friction = Rubbing {
            coulomb,
            viscous: between(&mut random, 0.5, 3.0) * coulomb,
            stiction: 0.4 * coulomb * random.uniform(),
            stribeck: 0.005 + 0.01 * random.uniform(),
        };
        let sign = |random: &mut SplitMix64| if random.uniform() < 0.5 { 0.7 } else { 1.3 };
        let drift = Drift {
            viscous: sign(&mut random),
            dry: sign(&mut random),
            time: between(&mut random, 40.0, 160.0),
        };
        let motion = [0.8, 0.5, 0.3].map(|amplitude| {
            let frequency = between(&mut random, 0.3, 1.3);
            [
                amplitude * (0.5 + 0.5 * random.uniform()) * 0.6 / frequency,
                frequency,
                std::f64::consts::TAU * random.uniform(),
            ]
        });
        Self {
            gravity: 5.0 * inertia * random.uniform(),
            noise: (0.02 + 0.08 * random.uniform()) * coulomb,
            inertia,
            friction,
            drift,
            encoder: 1e-4,
            motion,
            random,
            state: [0.0; 2],
            time: 0.0,
            measured: 0.0,
            torque: 0.0,
            limit: f64::INFINITY,
        }
    }

    /// Desired position and velocity.
    fn desired(&self) -> [f64; 2] {
        let ramp = (self.time / 2.0).min(1.0);
        self.motion.iter().fold([0.0; 2], |[y, v], [amplitude, frequency, phase]| {
            let angle = frequency * self.time + phase;
            [y + ramp * amplitude * angle.sin(), v + ramp * amplitude * frequency * angle.cos()]
        })
    }

    /// Integrates the motion over a period with a constant torque.
    fn integrate(&mut self, torque: f64) {
        let friction = self.drift.at(&self.friction, self.time);
        let dt = PERIOD / f64::from(SUBSTEPS);
        for _ in 0..SUBSTEPS {
            let [y, v] = self.state;
            let free = v + dt / self.inertia * (torque - self.gravity * y.sin());
            let most = dt / self.inertia * friction.magnitude(v.abs());
            // Friction can stop the joint, but cannot reverse its motion.
            let v = if free.abs() <= most { 0.0 } else { free - most * free.signum() };
            self.state = [y + dt * v, v];
        }
        self.time += PERIOD;
    }

    /// Simulates one period of PD control with gravity compensation.
    pub fn period(&mut self) -> Period {
        let [y, v] = self.desired();
        let measured = (self.state[0] / self.encoder).round() * self.encoder;
        let velocity = (measured - self.measured) / PERIOD;
        let stiffness = 400.0 * self.inertia;
        let wanted = stiffness * (y - measured)
            + 0.1 * stiffness * (v - velocity)
            + self.gravity * measured.sin()
            + self.friction.viscous * v;
        let command = wanted.clamp(-self.limit, self.limit);
        let period =
            Period { position: measured, torque: self.torque, saturated: self.torque.abs() >= self.limit };
        self.measured = measured;
        self.torque = command;
        let actual = command + self.noise * self.random.normal();
        self.integrate(actual);
        period
    }

    /// Described friction, which is the friction before the drift with a smooth sign.
    pub fn described(&self, v: f64) -> f64 {
        self.friction.viscous * v + self.friction.coulomb * (v / 0.005).tanh()
    }

    /// Present true friction.
    pub fn true_friction(&self, v: f64) -> f64 {
        self.drift.at(&self.friction, self.time).magnitude(v.abs()) * v.signum()
    }

    /// Torques of the described joint.
    pub fn forces(&self, y: f64, v: f64, a: f64) -> DescribedForces<1> {
        let friction = self.described(v);
        let forces = [self.inertia * a + self.gravity * y.sin() + friction];
        DescribedForces::new(forces, [friction], &[0.0])
    }

    /// The estimator of this joint.
    pub fn estimator(&self, settings: AdaptationSettings) -> Adaptation<1> {
        let magnitudes = Magnitudes { speed: SPEED, effort: 100.0, range: f64::INFINITY };
        let scale = magnitudes.scale(0, |v: &[f64; 1]| self.described(v[0]));
        Adaptation::new([scale], settings, |y, v, a| self.forces(y[0], v[0], a[0]))
            .expect("settings are in range")
    }

    /// Simulates one period and passes its measurements to the estimator.
    pub fn step(&mut self, adaptation: &mut Adaptation<1>) {
        let period = self.period();
        let measured = Measured {
            positions: Some([period.position]),
            torques: [period.torque],
            saturated: [period.saturated],
            periods: 1,
        };
        adaptation.step(&measured, |y, v, a| self.forces(y[0], v[0], a[0]));
    }
}

/// Shares of 90 % intervals that contain the true value, at ten instants of a run of five minutes, and mean widths relative to true
/// friction.
pub struct Coverage {
    pub held: [f64; 10],
    pub width: f64,
    /// Root-mean-square errors of the learned and of the described law, relative to friction.
    pub errors: [f64; 2],
    /// Share of instants at which the learned law acts.
    pub learned: f64,
}

/// Simulates `count` robots with one joint each.
///
/// - `first`: seed of the first robot
pub fn coverage(first: u64, count: u64, settings: AdaptationSettings) -> Coverage {
    let mut result = Coverage { held: [0.0; 10], width: 0.0, errors: [0.0; 2], learned: 0.0 };
    let share = 1.0 / count as f64;
    for seed in first..first + count {
        let mut joint = Simulated::new(seed);
        let mut adaptation = joint.estimator(settings);
        for k in 1..=30_000 {
            joint.step(&mut adaptation);
            if k % 3000 == 0 {
                let instant = k / 3000 - 1;
                let v = [0.3, -0.6, 0.9, -0.3, 0.6, -0.9, 0.3, -0.6, 0.9, -0.3][instant];
                let described = joint.described(v);
                let [law, half] = adaptation.friction(0, described, v).expect("the joint is learned");
                let truth = joint.true_friction(v);
                result.held[instant] += share * f64::from(u8::from((law - truth).abs() <= half));
                result.width += 0.1 * share * half / truth.abs();
                result.errors[0] += 0.1 * share * ((law - truth) / truth).powi(2);
                result.errors[1] += 0.1 * share * ((described - truth) / truth).powi(2);
                let state = adaptation.states()[0].expect("the joint is learned");
                let acts = state.trust == gelenk_runtime::adaptation::Trust::Learned;
                result.learned += 0.1 * share * f64::from(u8::from(acts));
            }
        }
    }
    result.errors = result.errors.map(f64::sqrt);
    result
}
