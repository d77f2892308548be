//! Plants with friction that the generated arm cannot represent: load-dependent friction and the Stribeck law. Also a library with
//! a term for the load.

use super::data::Samples;
use crate::arm::Arm;
use crate::study::Outcome;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::Samples as Columns;
use gelenk_identification::methods::stribeck::stribeck_torque;
use gelenk_runtime::dynamics::{Dynamics, Limits};

/// Slope of load-dependent friction at rest [s/rad].
const SLOPE: f64 = 20.0;
/// Terms of the published law of joint β, and a term for the load.
const TERMS: [&str; 5] = ["v", "tanh(5*v)", "tanh(10*v)", "tanh(20*v)", "abs(load)*tanh(20*v)"];

/// The arm with additional friction: `load_share · |q_g(y)| tanh 20v`, and Stribeck's law in some joints.
pub struct MoreFriction {
    /// The arm without this friction.
    pub robot: Arm,
    /// Friction per unit of load, the same for both joints.
    pub load_share: f64,
    /// Parameters of the Stribeck law `a_1 v + a_2 tanh a_3 v + a_4 exp(−a_5 |v|) tanh 3 a_3 v` of each joint; `None` for joints
    /// without this law.
    pub stribeck: [Option<[f64; 5]>; 2],
}

impl MoreFriction {
    fn stribeck(&self, joint: usize, v: f64) -> f64 {
        self.stribeck[joint].map_or(0.0, |law| stribeck_torque(v, &law))
    }
}

/// Torques of gravity that the joints carry [N m].
pub fn load(robot: &Arm, y: &[f64; 2]) -> [f64; 2] {
    robot.gravity_forces(y)
}

impl Dynamics<2, 2> for MoreFriction {
    fn limits(&self) -> Limits<2, 2> {
        self.robot.limits()
    }

    fn mass_matrix(&self, y: &[f64; 2]) -> [[f64; 2]; 2] {
        self.robot.mass_matrix(y)
    }

    fn coriolis_forces(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        self.robot.coriolis_forces(y, v)
    }

    fn gravity_forces(&self, y: &[f64; 2]) -> [f64; 2] {
        self.robot.gravity_forces(y)
    }

    fn spring_forces(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        self.robot.spring_forces(y, v)
    }

    /// Velocity-dependent friction. The plant checks this friction for discontinuities at rest.
    fn friction_torques(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        let friction = self.robot.friction_torques(y, v);
        std::array::from_fn(|i| friction[i] + self.stribeck(i, v[i]))
    }

    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[[0, 0], [1, 1]]
    }
    fn input_matrix(&self, y: &[f64; 2]) -> [[f64; 2]; 2] {
        self.robot.input_matrix(y)
    }

    fn applied_forces(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        let (applied, load) = (self.robot.applied_forces(y, v), load(&self.robot, y));
        std::array::from_fn(|i| {
            let by_load = self.load_share * load[i].abs() * (SLOPE * v[i]).tanh();
            applied[i] - by_load - self.stribeck(i, v[i])
        })
    }
}

/// Identified friction law with a term for the load.
pub struct LawUnderLoad {
    terms: [f64; 4],
    /// Identified friction per unit of load.
    pub share: f64,
    /// Standard error of `share` for independent errors.
    pub standard_error: f64,
}

/// Identifies a law by least squares on the terms of joint β and the load.
pub fn law_under_load(samples: &Samples, loads: &[f64]) -> Outcome<LawUnderLoad> {
    let library = Library::new(&TERMS, &["v", "load"])?;
    let channels: Vec<&[f64]> = vec![&samples.velocities, loads];
    let columns = Columns::from_library(&library, channels, vec![&samples.torques])?;
    let fit = Reduced::new(&columns)?.fit(0, &[0, 1, 2, 3, 4])?;
    Ok(LawUnderLoad {
        terms: std::array::from_fn(|i| fit.coefficients[i]),
        share: fit.coefficients[4],
        standard_error: fit.standard_errors[4],
    })
}

impl LawUnderLoad {
    /// Points (load, friction due to load in the direction of motion), for at most `count` samples that are faster than 0.05 rad/s.
    pub fn against_load(&self, samples: &Samples, loads: &[f64], count: usize) -> Vec<[f64; 2]> {
        let [viscous, five, ten, twenty] = self.terms;
        let rest = |i: usize| {
            let v = samples.velocities[i];
            let own =
                viscous * v + five * (5.0 * v).tanh() + ten * (10.0 * v).tanh() + twenty * (20.0 * v).tanh();
            [loads[i].abs(), (samples.torques[i] - own) * v.signum()]
        };
        let fast = |i: &usize| samples.velocities[*i].abs() > 0.05;
        let stride = samples.len().div_ceil(count.max(1)).max(1);
        (0..samples.len()).step_by(stride).filter(fast).map(rest).collect()
    }
}
