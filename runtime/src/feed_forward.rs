//! Feed-forward inputs, with which the model follows a trajectory exactly.
//!
//! ```text
//!     u_ff = B⁻¹ (M ÿ + k − q)        along y(t), ẏ(t), ÿ(t)
//! ```
//!
//! This is the inverse dynamics of the model `M ÿ + k = q + B u` (Craig, *Introduction to Robotics*, 2005,
//! section 10.4). If B is not square or not regular, the pseudo-inverse B⁺ replaces B⁻¹, and u_ff is the
//! least-squares solution with the smallest inputs. The residual r = (M ÿ + k − q) − B u_ff is the force that no
//! input can produce. If r ≠ 0, the robot cannot follow the trajectory. For robots with quaternions, body
//! velocities v and v̇ replace ẏ and ÿ.

use crate::dynamics::{Dynamics, Named, plain_entries};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::trajectory::{MAX_SAMPLES, Sample, Trajectory, whole_periods};
use gelenk_dynamics::pseudo_inverse::{dot, pseudo_inverse};
use thiserror::Error;

/// Inputs for a state, and the residual force that no input can produce.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedForwardInput<const N: usize, const M: usize> {
    /// Feed-forward inputs u_ff [N m, N or A].
    pub inputs: [f64; M],
    /// Force that the motion requires but no input can produce [N m or N]. It is zero if the input matrix is
    /// regular.
    pub residual: [f64; N],
}

/// Error of the feed-forward.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FeedForwardError {
    /// An entry of the input matrix B is NaN or infinite, or B is zero.
    #[error("the input matrix is zero or not finite, so no input acts on the robot")]
    InputMatrix,
    /// The trajectory requires forces that no input can produce.
    #[error(
        "the trajectory is not feasible. At {time} s, joint {} requires a force of {residual} N m (or N) that no input can \
         produce (tolerance: {tolerance}). Plan a motion that satisfies the joint's equation of motion",
        Named(.name)
    )]
    Infeasible {
        /// Time of the largest residual (s).
        time: f64,
        /// Index of the coordinate with the largest residual.
        coordinate: usize,
        /// Name of the joint.
        name: &'static str,
        /// Largest residual [N m or N].
        residual: f64,
        /// Allowed residual [N m or N].
        tolerance: f64,
    },
    /// Positions, velocities or the equations of motion are not finite.
    #[error("the trajectory or the equations of motion are not finite at {time} s")]
    NotFinite {
        /// Time of the sample that is not finite (s).
        time: f64,
    },
    /// The sampling period is not positive and finite.
    #[error("the period is {0} s, but must be positive and finite")]
    Period(f64),
    /// The trajectory is infinitely long, or has too many periods.
    #[error("a trajectory of {duration} s has more than {MAX_SAMPLES} periods of {period} s")]
    Duration {
        /// Duration of the trajectory (s).
        duration: f64,
        /// Sampling period (s).
        period: f64,
    },
    /// The tolerance is NaN.
    #[error("the tolerance of the residual is {0}, but must be a number")]
    Tolerance(f64),
}

/// Feed-forward of a model, with `N` coordinates and `M` inputs.
///
/// ```
/// use gelenk_runtime::feed_forward::FeedForward;
/// use gelenk_runtime::trajectory::{RestToRest, Trajectory};
///
/// gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// let motion = RestToRest::new([0.0, 0.0], [0.3, 0.4], 2.0)?;
/// let feed_forward = FeedForward::new(PowerCube)?;
/// let input = feed_forward.at(&motion.sample(1.0));
/// assert!(input.inputs[0].abs() < 0.5, "the motor's peak torque");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedForward<D, const N: usize, const M: usize, const NY: usize = N> {
    model: D,
    /// Input matrix B and its pseudo-inverse B⁺ if B is constant because all inputs are drives; `None`
    /// otherwise.
    constant: Option<Inverted<N, M>>,
}

/// Input matrix B with its pseudo-inverse B⁺.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Inverted<const N: usize, const M: usize> {
    input_matrix: [[f64; M]; N],
    inverse: [[f64; N]; M],
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> FeedForward<D, N, M, NY> {
    /// A feed-forward for `model`. If the input matrix B is constant, its pseudo-inverse is computed once.
    /// Otherwise the pseudo-inverse of B(y) is computed in each call, without allocation.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`] if B is zero or not finite. If B depends on y, B is checked at time 0 and
    /// at the positions within the limits that are closest to 0.
    pub fn new(model: D) -> Result<Self, FeedForwardError> {
        let input_matrix = model.at_time(0.0, |model| model.input_matrix(&closest_to_neutral(model)));
        let inverse = pseudo_inverse(&input_matrix).ok_or(FeedForwardError::InputMatrix)?;
        let constant = (model.drives() == M).then_some(Inverted { input_matrix, inverse });
        Ok(Self { model, constant })
    }

    /// The model.
    pub fn model(&self) -> &D {
        &self.model
    }

    /// Replaces the model, for example by a model with newly identified parameters. Does not allocate if the
    /// input matrix is unchanged.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`] if the input matrix B is zero or not finite. The old model is then
    /// kept.
    pub fn set_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        let is_same =
            |known: Inverted<N, M>| model.drives() == M && model.drive_matrix() == known.input_matrix;
        if self.constant.is_some_and(is_same) {
            self.model = model;
        } else {
            *self = Self::new(model)?;
        }
        Ok(())
    }

    /// Inputs and residual for one sample of a trajectory. Does not allocate. For robots with driven joints, call
    /// [`at_time`](Self::at_time).
    #[must_use]
    pub fn at(&self, sample: &Sample<N, NY>) -> FeedForwardInput<N, M> {
        self.by(&self.model, sample)
    }

    /// Inputs and residual for the sample of a trajectory at `time` (s). Only robots with driven joints depend on
    /// the time ([`Dynamics::at_time`]).
    #[must_use]
    pub fn at_time(&self, time: f64, sample: &Sample<N, NY>) -> FeedForwardInput<N, M> {
        self.model.at_time(time, |model| self.by(model, sample))
    }

    fn by(&self, model: &D, sample: &Sample<N, NY>) -> FeedForwardInput<N, M> {
        let forces = model.inverse_dynamics(&sample.positions, &sample.velocities, &sample.accelerations);
        let inverted = self.inverted(model, &sample.positions);
        let inputs = inverted.inputs(&forces);
        FeedForwardInput { inputs, residual: inverted.missed(&forces, &inputs) }
    }

    /// The inputs B(y)⁺ f that produce the generalized forces f [N m or N] at the positions y, with the
    /// pseudo-inverse B⁺ of the input matrix B. If no inputs can produce f, the result produces the forces
    /// closest to f. The result is NaN if B is zero or not finite.
    #[must_use]
    pub fn inputs_for(&self, positions: &[f64; NY], forces: &[f64; N]) -> [f64; M] {
        self.inverted(&self.model, positions).inputs(forces)
    }

    /// The result of [`inputs_for`](Self::inputs_for) at `time` (s).
    #[must_use]
    pub fn inputs_for_at_time(&self, time: f64, positions: &[f64; NY], forces: &[f64; N]) -> [f64; M] {
        self.model.at_time(time, |model| self.inverted(model, positions).inputs(forces))
    }

    /// The part `f − B B⁺ f` [N m or N] of the generalized forces f that no inputs can produce at the
    /// positions y. B⁺ is the pseudo-inverse of the input matrix B.
    #[must_use]
    pub fn missed(&self, positions: &[f64; NY], forces: &[f64; N]) -> [f64; N] {
        self.missed_by(&self.model, positions, forces)
    }

    /// The result of [`missed`](Self::missed) at `time` (s).
    #[must_use]
    pub fn missed_at_time(&self, time: f64, positions: &[f64; NY], forces: &[f64; N]) -> [f64; N] {
        self.model.at_time(time, |model| self.missed_by(model, positions, forces))
    }

    fn missed_by(&self, model: &D, positions: &[f64; NY], forces: &[f64; N]) -> [f64; N] {
        let inverted = self.inverted(model, positions);
        inverted.missed(forces, &inverted.inputs(forces))
    }

    fn inverted(&self, model: &D, positions: &[f64; NY]) -> Inverted<N, M> {
        self.constant.unwrap_or_else(|| {
            let input_matrix = model.input_matrix(positions);
            Inverted { input_matrix, inverse: pseudo_inverse(&input_matrix).unwrap_or([[f64::NAN; N]; M]) }
        })
    }

    /// Inputs at the times 0, `period`, 2 `period`, … (s) up to the end of `trajectory`. Each input is constant
    /// for one period.
    ///
    /// # Errors
    /// - [`FeedForwardError::Infeasible`] if the largest residual exceeds `tolerance` [N m or N].
    /// - [`FeedForwardError::NotFinite`] for a sample or input that is not finite.
    /// - [`FeedForwardError::Period`] for a period that is not positive and finite.
    /// - [`FeedForwardError::Tolerance`] for a tolerance that is NaN.
    /// - [`FeedForwardError::Duration`] for a trajectory of more than [`MAX_SAMPLES`] periods.
    pub fn along(
        &self,
        trajectory: &impl Trajectory<N, NY>,
        period: f64,
        tolerance: f64,
    ) -> Result<Vec<[f64; M]>, FeedForwardError> {
        if !(period.is_finite() && period > 0.0) {
            return Err(FeedForwardError::Period(period));
        }
        if tolerance.is_nan() {
            return Err(FeedForwardError::Tolerance(tolerance));
        }
        let duration = trajectory.duration();
        let steps = whole_periods(duration, period).ok_or(FeedForwardError::Duration { duration, period })?;
        let mut inputs = Vec::with_capacity(steps);
        let mut worst = (0.0, 0, 0.0_f64);
        for k in 0..steps {
            let time = k as f64 * period;
            let input = self.at_time(time, &trajectory.sample(time));
            if !input.inputs.iter().chain(&input.residual).all(|x| x.is_finite()) {
                return Err(FeedForwardError::NotFinite { time });
            }
            for (i, residual) in input.residual.iter().enumerate() {
                if residual.abs() > worst.2.abs() {
                    worst = (time, i, *residual);
                }
            }
            inputs.push(input.inputs);
        }
        let (time, coordinate, residual) = worst;
        if residual.abs() > tolerance {
            return Err(FeedForwardError::Infeasible {
                time,
                coordinate,
                name: self.model.joint_names()[coordinate],
                residual,
                tolerance,
            });
        }
        Ok(inputs)
    }
}

/// The positions within the limits that are closest to 0. Quaternions are the identity.
pub(crate) fn closest_to_neutral<const N: usize, const M: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
) -> [f64; NY] {
    let (mut positions, closest) = (model.neutral(), closest_to_zero(&model.limits().position));
    for (velocity, position) in plain_entries(model.quaternion_joints(), N) {
        positions[position] = closest[velocity];
    }
    positions
}

/// The positions within the limits that are closest to 0. Outside the limits, the direction of an input at a frame
/// may be undefined.
fn closest_to_zero<const N: usize>(limits: &[[f64; 2]; N]) -> [f64; N] {
    limits.map(|[low, high]| 0.0_f64.max(low).min(high))
}

impl<const N: usize, const M: usize> Inverted<N, M> {
    fn inputs(&self, forces: &[f64; N]) -> [f64; M] {
        self.inverse.map(|row| dot(&row, forces))
    }

    fn missed(&self, forces: &[f64; N], inputs: &[f64; M]) -> [f64; N] {
        core::array::from_fn(|i| forces[i] - dot(&self.input_matrix[i], inputs))
    }
}
