//! Feed-forward with joint PD: the simplest controller, and what the loop falls back on.

use super::controller::{Command, Controller, ControllerFault, Cycle, Estimate};
use super::monitor::VelocityFilter;
use super::settings::{SettingError, require};
use crate::dynamics::Dynamics;
use crate::trajectory::{Sample, Trajectory};
use nalgebra::SMatrix;

/// Gains of the joint PD, by coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointGains<const N: usize> {
    /// K_p [N m/rad or N/m].
    pub position: [f64; N],
    /// K_d [N m s/rad or N s/m].
    pub velocity: [f64; N],
}

impl<const N: usize> JointGains<N> {
    /// Gains that make each joint, with the others at rest, an oscillator of natural frequency `omega` [rad/s] and damping
    /// ratio `damping`: `K_p = M_ii ω²`, `K_d = 2 ζ M_ii ω` with the mass matrix at `positions` (Siciliano, Sciavicco,
    /// Villani, Oriolo, *Robotics*, 2009, section 8.3). Friction of the joint damps in addition.
    #[must_use]
    pub fn from_bandwidth<const M: usize>(
        model: &impl Dynamics<N, M>,
        positions: &[f64; N],
        omega: f64,
        damping: f64,
    ) -> Self {
        let mass = model.mass_matrix(positions);
        Self {
            position: core::array::from_fn(|i| mass[i][i] * omega * omega),
            velocity: core::array::from_fn(|i| 2.0 * damping * mass[i][i] * omega),
        }
    }
}

/// The control law, without memory:
///
/// ```text
///     u = B⁺ (M ÿ_d + k − q + K_p (y_d − y) + K_d (ẏ_d − ẏ))        M, k, q at (y_d, ẏ_d)
/// ```
///
/// B⁺ is the inverse where B is square, and the least-squares inverse where there are fewer inputs than coordinates.
#[derive(Debug, Clone)]
pub struct JointPd<D, const N: usize, const M: usize> {
    model: D,
    gains: JointGains<N>,
    /// B⁺.
    allocation: [[f64; N]; M],
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize> JointPd<D, N, M> {
    /// The law for a model.
    ///
    /// # Errors
    /// [`SettingError`] for gains that are negative or not finite, and for an input that moves nothing.
    pub fn new(model: D, gains: JointGains<N>) -> Result<Self, SettingError> {
        let finite = |x: f64| x.is_finite() && x >= 0.0;
        require(
            "gains.position",
            &gains.position,
            "finite and not negative",
            finite,
        )?;
        require(
            "gains.velocity",
            &gains.velocity,
            "finite and not negative",
            finite,
        )?;
        let rows = model.input_matrix();
        let b = SMatrix::<f64, N, M>::from_fn(|i, j| rows[i][j]);
        let normal = b.transpose() * b;
        let inverse = normal.try_inverse().ok_or(SettingError {
            name: "model: det(BᵀB)",
            index: 0,
            value: 0.0,
            range: "not 0: every input must move the robot in a way of its own",
        })?;
        let inverse = inverse * b.transpose();
        Ok(Self {
            allocation: core::array::from_fn(|j| core::array::from_fn(|i| inverse[(j, i)])),
            model,
            gains,
        })
    }

    /// Inputs for a desired state, given the measured one.
    ///
    /// # Errors
    /// [`ControllerFault::NotFinite`].
    pub fn inputs(
        &self,
        desired: &Sample<N>,
        positions: &[f64; N],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let (y, v) = (&desired.positions, &desired.velocities);
        let mut forces = self.model.inverse_dynamics(y, v, &desired.accelerations);
        for i in 0..N {
            forces[i] += self.gains.position[i] * (y[i] - positions[i])
                + self.gains.velocity[i] * (v[i] - velocities[i]);
        }
        let inputs = self
            .allocation
            .map(|row| row.iter().zip(&forces).map(|(b, f)| b * f).sum());
        if inputs.iter().all(|u: &f64| u.is_finite()) {
            Ok(inputs)
        } else {
            Err(ControllerFault::NotFinite)
        }
    }
}

/// [`JointPd`] along a trajectory, with velocities from differences of positions.
#[derive(Debug, Clone)]
pub struct FeedForwardPd<D, R, const N: usize, const M: usize> {
    law: JointPd<D, N, M>,
    trajectory: R,
    period: f64,
    time_constant: f64,
    filter: VelocityFilter<N>,
    /// Periods since the last measurement.
    age: u32,
}

impl<D: Dynamics<N, M>, R: Trajectory<N>, const N: usize, const M: usize>
    FeedForwardPd<D, R, N, M>
{
    /// The controller for periods of `period` seconds; velocities are smoothed with `time_constant` [s].
    #[must_use]
    pub fn new(law: JointPd<D, N, M>, trajectory: R, period: f64, time_constant: f64) -> Self {
        let start = trajectory.sample(0.0).positions;
        Self {
            law,
            trajectory,
            period,
            time_constant,
            filter: VelocityFilter::new(time_constant, start),
            age: 0,
        }
    }
}

impl<D: Dynamics<N, M>, R: Trajectory<N>, const N: usize, const M: usize> Controller<N, M>
    for FeedForwardPd<D, R, N, M>
{
    fn reset(&mut self, positions: &[f64; N], _: &[f64; M]) {
        self.filter = VelocityFilter::new(self.time_constant, *positions);
        self.age = 0;
    }

    fn step(&mut self, cycle: &Cycle<N, M>) -> Result<Command<M>, ControllerFault> {
        self.age = self.age.saturating_add(cycle.periods);
        let positions = cycle.positions.ok_or(ControllerFault::NoMeasurement)?;
        let span = f64::from(self.age.max(1)) * self.period;
        self.age = 0;
        self.filter.update(&positions, span);
        let desired = self.trajectory.sample(cycle.time);
        let inputs = self
            .law
            .inputs(&desired, &positions, self.filter.velocities())?;
        Ok(Command {
            inputs,
            iterations: 0,
        })
    }

    fn estimate(&self) -> Option<Estimate<N>> {
        Some(Estimate {
            positions: *self.filter.positions(),
            velocities: *self.filter.velocities(),
        })
    }
}
