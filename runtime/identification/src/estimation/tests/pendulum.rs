//! A double pendulum with its regressor by hand (Lagrange), simulated under a controller that sees noisy
//! positions.

use super::super::super::inertial::{PER_BODY, from_pseudo_inertia, pseudo_inertia};
use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::{JointLimits, Robot};
use super::super::super::run::{Effort, PreparedRun, Run};
use super::data::prepare;
use nalgebra::Matrix4;

const LENGTH: f64 = 0.4;
const GRAVITY: f64 = 9.81;

/// Two links in a vertical plane, axes along z, x along the links; y = 0 is horizontal.
#[derive(Clone)]
pub(super) struct Pendulum {
    pub(super) parameters: Vec<f64>,
    /// Diagonal of B.
    pub(super) gears: [f64; 2],
    /// Whether friction is `v φ₁ + sign(v) φ₂`, which can hold a joint at rest.
    pub(super) sticks: bool,
}

impl Pendulum {
    pub(super) fn described() -> Self {
        let link = |m: f64, c: f64, i: f64| [m, m * c, 0.0, 0.0, 0.1 * i, 0.0, i, 0.0, 0.0, i];
        Self {
            parameters: [link(3.0, 0.2, 0.16), link(2.0, 0.15, 0.08)].concat(),
            gears: [1.0; 2],
            sticks: false,
        }
    }

    /// A robot near the described one: `P = L (1 + s N) (1 + s N)ᵀ Lᵀ` with normal entries of N and P₀ = L Lᵀ.
    pub(super) fn other(&self, size: f64, random: &mut SplitMix64) -> Self {
        let other = |pi: &[f64]| {
            let factor = pseudo_inertia(&std::array::from_fn(|i| pi[i])).cholesky().unwrap().l();
            let n = Matrix4::from_fn(|_, _| random.normal() * size) + Matrix4::identity();
            from_pseudo_inertia(&(factor * n * n.transpose() * factor.transpose()))
        };
        let parameters = self.parameters.chunks_exact(PER_BODY).flat_map(other).collect();
        Self { parameters, ..self.clone() }
    }

    fn regressor(y: &[f64], v: &[f64], a: &[f64]) -> [[f64; 20]; 2] {
        let (l, g) = (LENGTH, GRAVITY);
        let theta = y[0] + y[1];
        let (s, c) = y[1].sin_cos();
        let mut w = [[0.0; 20]; 2];
        w[0][1] = g * y[0].cos();
        w[0][2] = -g * y[0].sin();
        w[0][9] = a[0];
        w[0][10] = l * l * a[0] + g * l * y[0].cos();
        let (both, mixed) = (2.0 * a[0] + a[1], v[1] * (2.0 * v[0] + v[1]));
        w[0][11] = l * (c * both - s * mixed) + g * theta.cos();
        w[1][11] = l * (c * a[0] + s * v[0] * v[0]) + g * theta.cos();
        w[0][12] = -l * (s * both + c * mixed) - g * theta.sin();
        w[1][12] = l * (-s * a[0] + c * v[0] * v[0]) - g * theta.sin();
        w[0][19] = a[0] + a[1];
        w[1][19] = a[0] + a[1];
        w
    }

    fn forces(&self, y: &[f64], v: &[f64], a: &[f64]) -> [f64; 2] {
        Self::regressor(y, v, a).map(|row| row.iter().zip(&self.parameters).map(|(w, p)| w * p).sum())
    }

    /// A step of the midpoint rule with friction and the given forces of the drives.
    fn midpoint(&self, h: f64, y: [f64; 2], v: [f64; 2], drive: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let law = |j: usize, v: f64| FRICTION[j][0] * v + FRICTION[j][1] * (STEEPNESS * v).tanh();
        let slope =
            |y: &[f64; 2], v: &[f64; 2]| self.accelerations(y, v, [0, 1].map(|j| drive[j] - law(j, v[j])));
        let step = |x: [f64; 2], d: [f64; 2], h: f64| [x[0] + h * d[0], x[1] + h * d[1]];
        let (half, middle) = (step(y, v, 0.5 * h), step(v, slope(&y, &v), 0.5 * h));
        (step(y, middle, h), step(v, slope(&half, &middle), h))
    }

    /// A semi-implicit step with the forces of dry friction that stop the joints, by projected Gauss–Seidel iterations.
    fn sticking(&self, h: f64, y: [f64; 2], v: [f64; 2], drive: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let with = |dry: [f64; 2]| {
            let a = self.accelerations(&y, &v, [0, 1].map(|j| drive[j] - FRICTION[j][0] * v[j] - dry[j]));
            [0, 1].map(|j| v[j] + h * a[j])
        };
        let free = with([0.0; 2]);
        let slopes = [with([1.0, 0.0]), with([0.0, 1.0])].map(|other| [0, 1].map(|j| other[j] - free[j]));
        let after = |dry: [f64; 2], j: usize| free[j] + slopes[0][j] * dry[0] + slopes[1][j] * dry[1];
        let mut dry = [0.0; 2];
        for j in [0, 1].repeat(SWEEPS) {
            let most = FRICTION[j][1];
            dry[j] = (dry[j] - after(dry, j) / slopes[j][j]).clamp(-most, most);
        }
        let v = [0, 1].map(|j| after(dry, j));
        ([0, 1].map(|j| y[j] + h * v[j]), v)
    }

    /// ÿ for joint forces τ that include friction.
    fn accelerations(&self, y: &[f64; 2], v: &[f64; 2], tau: [f64; 2]) -> [f64; 2] {
        let bias = self.forces(y, v, &[0.0; 2]);
        let column = |a: [f64; 2]| {
            let all = self.forces(y, &[0.0; 2], &a);
            let rest = self.forces(y, &[0.0; 2], &[0.0; 2]);
            [all[0] - rest[0], all[1] - rest[1]]
        };
        let (m0, m1) = (column([1.0, 0.0]), column([0.0, 1.0]));
        let r = [tau[0] - bias[0], tau[1] - bias[1]];
        let det = m0[0] * m1[1] - m1[0] * m0[1];
        [(m1[1] * r[0] - m1[0] * r[1]) / det, (m0[0] * r[1] - m0[1] * r[0]) / det]
    }
}

impl Robot for Pendulum {
    fn joint_names(&self) -> Vec<String> {
        vec!["shoulder".into(), "elbow".into()]
    }
    fn input_names(&self) -> Vec<String> {
        self.joint_names()
    }
    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; 2]
    }
    fn limits(&self) -> Vec<JointLimits> {
        let limits = JointLimits { position: [-9.0, 9.0], velocity: 9.0, effort: 99.0 };
        vec![limits; 2]
    }
    fn parameter_names(&self) -> Vec<String> {
        (0..20).map(|i| format!("p{i}")).collect()
    }
    fn parameters(&self) -> Vec<f64> {
        self.parameters.clone()
    }
    fn bodies(&self) -> usize {
        2
    }
    fn input_matrix(&self) -> Vec<f64> {
        vec![self.gears[0], 0.0, 0.0, self.gears[1]]
    }
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        regressor.copy_from_slice(&Self::regressor(y, v, a).concat());
    }
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        forces.copy_from_slice(&self.forces(y, v, a));
    }
}

/// Iterations that find the forces of dry friction to all digits.
const SWEEPS: usize = 40;

/// Friction `v φ₁ + tanh(10 v) φ₂` of both joints.
pub(super) const STEEPNESS: f64 = 10.0;
pub(super) const FRICTION: [[f64; 2]; 2] = [[1.2, 2.0], [0.5, 0.8]];

/// Parameters of a simulated log.
#[derive(Clone)]
pub(super) struct Experiment {
    pub(super) seconds: f64,
    pub(super) rate: f64,
    /// Noise of the encoders [rad] and of the force measurement [N m].
    pub(super) position_noise: f64,
    /// Resolution of the encoders [rad]; 0 if they do not round.
    pub(super) resolution: f64,
    pub(super) force_noise: f64,
    pub(super) offsets: [f64; 2],
    /// Gains of a controller that acts on the measured positions.
    pub(super) stiffness: f64,
    /// Time constant of the controller's filter over velocities [s].
    pub(super) slope_time: f64,
    /// Phases of the sines of the reference; random phases if there are none.
    pub(super) phases: Option<[f64; 6]>,
    /// Window of the filter, samples.
    pub(super) window: usize,
    /// Deviation of the sample times, which are known, as a share of the time step.
    pub(super) jitter: f64,
    /// Delay of the efforts [s].
    pub(super) delay: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Self {
            seconds: 12.0,
            rate: 500.0,
            position_noise: 2e-5,
            resolution: 0.0,
            slope_time: 0.0,
            force_noise: 0.15,
            offsets: [0.4, -0.2],
            stiffness: 60.0,
            phases: None,
            window: 21,
            jitter: 0.0,
            delay: 0.0,
        }
    }
}

/// Reference: three sines for each joint with phases of the run.
fn reference(t: f64, phases: &[f64; 6]) -> [[f64; 3]; 2] {
    std::array::from_fn(|j| {
        let mut sum = [0.0; 3];
        for k in 0..3 {
            let w = 1.3 * (k + 1) as f64 + 0.4 * j as f64;
            let (s, c) = (w * t + phases[3 * j + k]).sin_cos();
            let size = 0.8 / (k + 1) as f64;
            sum = [sum[0] + size * s, sum[1] + size * w * c, sum[2] - size * w * w * s];
        }
        sum
    })
}

/// A prepared run of the robot under control, and the same run with the reference instead of the motion.
pub(super) fn simulate(
    robot: &Pendulum,
    of: &Experiment,
    random: &mut SplitMix64,
) -> (PreparedRun, PreparedRun) {
    let (times, columns) = recorded(robot, of, random);
    let run = |from: usize| PreparedRun {
        poses: Vec::new(),
        effort: Effort::Input,
        ..prepare("simulated", &times, &columns[from..from + 2], &columns[2..4], of.window)
    };
    (run(0), run(4))
}

/// The same run as a log, with the reference as the commanded motion.
pub(super) fn log(robot: &Pendulum, of: &Experiment, random: &mut SplitMix64) -> Run {
    let (times, columns) = recorded(robot, of, random);
    Run {
        poses: Vec::new(),
        name: "simulated".into(),
        rows: (2..times.len() + 2).collect(),
        times,
        positions: columns[..2].to_vec(),
        velocities: vec![None; 2],
        efforts: columns[2..4].to_vec(),
        effort: Effort::Input,
    }
}

/// Times, and columns of positions, inputs and references.
fn recorded(robot: &Pendulum, of: &Experiment, random: &mut SplitMix64) -> (Vec<f64>, Vec<Vec<f64>>) {
    let history = History::new(robot, of, random);
    let h = 1.0 / of.rate;
    let (mut times, mut columns) = (Vec::new(), vec![Vec::new(); 6]);
    for (i, (seen, noise)) in history.seen.iter().zip(&history.noise).enumerate() {
        let mut t = i as f64 * h;
        let mut seen = *seen;
        if of.jitter > 0.0 {
            t += (of.jitter * random.normal()).clamp(-0.45, 0.45) * h;
            let y = history.positions(t);
            seen =
                std::array::from_fn(|j| rounded(y[j] + of.position_noise * random.normal(), of.resolution));
        }
        let (applied, wanted) = (history.applied(t - of.delay), reference(t, &history.phases));
        for j in 0..2 {
            columns[j].push(seen[j]);
            columns[2 + j].push((applied[j] + of.offsets[j] + noise[j]) / robot.gears[j]);
            columns[4 + j].push(wanted[j][0]);
        }
        times.push(t);
    }
    (times, columns)
}

/// A motion under control, without measurement errors.
struct History {
    phases: [f64; 6],
    /// Period of the controller, and step of the integration [s].
    period: f64,
    step: f64,
    /// y and ẏ after each step of the integration.
    states: Vec<[[f64; 2]; 2]>,
    /// State that the controller saw and force that it applied in each period, and the noise of the force measurement.
    seen: Vec<[f64; 2]>,
    feeds: Vec<[f64; 2]>,
    noise: Vec<[f64; 2]>,
}

impl History {
    fn new(robot: &Pendulum, of: &Experiment, random: &mut SplitMix64) -> Self {
        let h = 1.0 / of.rate;
        let inner = (h / 5e-4).round().max(4.0) as usize;
        let drawn = std::array::from_fn(|_| std::f64::consts::TAU * random.uniform());
        let phases = of.phases.unwrap_or(drawn);
        let start = reference(0.0, &phases);
        let (mut y, mut v) = ([start[0][0], start[1][0]], [start[0][1], start[1][1]]);
        let model = Pendulum::described();
        let mut history = Self {
            phases,
            period: h,
            step: h / inner as f64,
            states: vec![[y, v]],
            seen: Vec::new(),
            feeds: Vec::new(),
            noise: Vec::new(),
        };
        let (mut slopes, share) = ([0.0; 2], h / (h + of.slope_time));
        for i in 0..(of.seconds * of.rate) as usize {
            let wanted = reference(i as f64 * h, &phases);
            let seen: [f64; 2] =
                std::array::from_fn(|j| rounded(y[j] + of.position_noise * random.normal(), of.resolution));
            let last = history.seen.last();
            let a: [f64; 2] = std::array::from_fn(|j| {
                let new = last.map_or(wanted[j][1], |last| (seen[j] - last[j]) / h);
                slopes[j] = if i == 0 { new } else { slopes[j] + share * (new - slopes[j]) };
                let slope = slopes[j];
                wanted[j][2]
                    + of.stiffness * (wanted[j][0] - seen[j])
                    + 2.0 * of.stiffness.sqrt() * (wanted[j][1] - slope)
            });
            let feed = model.forces(&[wanted[0][0], wanted[1][0]], &[wanted[0][1], wanted[1][1]], &a);
            history.seen.push(seen);
            history.feeds.push(feed);
            history.noise.push(std::array::from_fn(|_| of.force_noise * random.normal()));
            for _ in 0..inner {
                let step = if robot.sticks { Pendulum::sticking } else { Pendulum::midpoint };
                (y, v) = step(robot, history.step, y, v, feed);
                history.states.push([y, v]);
            }
        }
        history
    }

    /// Positions at a time, by the cubic through two states.
    fn positions(&self, t: f64) -> [f64; 2] {
        let last = self.states.len() - 2;
        let i = ((t / self.step).max(0.0) as usize).min(last);
        let x = t / self.step - i as f64;
        let [[y0, v0], [y1, v1]] = [self.states[i], self.states[i + 1]];
        std::array::from_fn(|j| {
            let (d, a, b) = (y1[j] - y0[j], self.step * v0[j], self.step * v1[j]);
            y0[j] + x * (a + x * (3.0 * d - 2.0 * a - b + x * (a + b - 2.0 * d)))
        })
    }

    /// Mean input within half a period of a time. The input is constant over each period.
    fn applied(&self, t: f64) -> [f64; 2] {
        // Feed i is held about the place i + 1/2.
        let place = t / self.period - 0.5;
        let before = place.floor();
        let at = |i: f64, j: usize| self.feeds[(i.max(0.0) as usize).min(self.feeds.len() - 1)][j];
        std::array::from_fn(|j| {
            let x = place - before;
            (1.0 - x) * at(before, j) + x * at(before + 1.0, j)
        })
    }
}

fn rounded(y: f64, resolution: f64) -> f64 {
    if resolution > 0.0 { (y / resolution).round() * resolution } else { y }
}
