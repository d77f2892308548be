//! LQR law of the control loop: feed-forward plus the linear-quadratic regulator of the robot linearized at rest.

use super::controller::ControllerFault;
use super::joint_pd::{require_gains, sum};
use super::law::{JointLaw, of_the_model};
use super::settings::{SettingError, require, require_each};
use super::zero_order_hold::{discretize, flat_input, flat_state};
use crate::dynamics::{AttitudeError, Discretizable, PhaseSpace};
use crate::feed_forward::{FeedForward, FeedForwardError};
use crate::lqr::{Lqr, LqrError};
use crate::trajectory::Sample;
use thiserror::Error;

/// Weights of [`JointLqr`]: the diagonals of the weight matrices Q (positions and velocities) and R (inputs).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LqrWeights<const N: usize, const M: usize> {
    /// Weights of the position errors [1/rad² or 1/m²].
    pub position: [f64; N],
    /// Weights of the velocity errors [s²/rad² or s²/m²].
    pub velocity: [f64; N],
    /// Weights of the inputs [1/(N m)², 1/N² or 1/A²].
    pub input: [f64; M],
}

impl<const N: usize, const M: usize> LqrWeights<N, M> {
    /// Weights `1/x²` for deviations x of positions [rad or m], velocities [rad/s or m/s] and inputs [N m, N
    /// or A]. All given deviations then have the same cost (Bryson, Ho, *Applied Optimal Control*, 1975,
    /// section 5.2).
    #[must_use]
    pub fn from_deviations(position: [f64; N], velocity: [f64; N], input: [f64; M]) -> Self {
        let weight = |x: f64| 1.0 / (x * x);
        Self { position: position.map(weight), velocity: velocity.map(weight), input: input.map(weight) }
    }
}

/// Errors of the LQR of a robot.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum JointLqrError {
    /// A weight or the period is out of range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A quaternion of the given positions is not an attitude.
    #[error("the positions for the linearization are not valid: {0}")]
    Attitude(#[from] AttitudeError),
    /// The feed-forward of the model cannot be computed.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
    /// The linearization at the given positions has no zero-order hold.
    #[error("the robot cannot be linearized at the given positions: {0}")]
    Model(ControllerFault),
    /// The Riccati equation has no stabilizing solution.
    #[error(transparent)]
    Regulator(#[from] LqrError),
}

/// LQR law, a feedback law without internal state:
///
/// ```text
///     u = u_ff(y_d, ẏ_d, ÿ_d) + K x        x = (y − y_d, ẏ − ẏ_d)
/// ```
///
/// Here u_ff is the [`FeedForward`] for the desired motion y_d, ẏ_d, ÿ_d. K is the gain of [`Lqr`] for the
/// discrete-time model (zero-order hold) of the robot at rest. For robots with quaternions the difference is
/// `y ⊖ y_d`, and body velocities v replace ẏ. K is constant. It is optimal only near the positions at which
/// the robot was linearized. Far from these positions, or at limits of inputs, use [`LtvMpc`](crate::mpc).
///
/// The [margins](crate::lqr::Lqr::margins) are valid for the linearized robot with an exact state. A filter
/// of velocities and a delay reduce the margins.
///
/// Example for the axis α of the PowerCube at 50 Hz:
///
/// ```
/// use gelenk_runtime::control_loop::{JointLqr, LqrWeights};
///
/// gelenk_runtime::dynamics!(pub struct Alpha = gelenk_generated::powercube_alpha);
///
/// let weights = LqrWeights::from_deviations([0.02], [0.2], [0.2]); // rad, rad/s, N m at the motor
/// let law = JointLqr::new(Alpha, &[0.0], 0.02, weights)?;
/// let margins = law.regulator().margins();
/// println!("{margins}");
/// assert!(margins.gain[0] < 0.7 && margins.gain[1] > 2.0 && margins.phase > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct JointLqr<D, const N: usize, const M: usize, const NX: usize, const NY: usize = N> {
    feed_forward: FeedForward<D, N, M, NY>,
    regulator: Lqr<NX, M>,
}

impl<D, const N: usize, const M: usize, const NX: usize, const NY: usize> JointLqr<D, N, M, NX, NY>
where
    D: Discretizable<N, M, NY>,
{
    /// The law for a model that is linearized at rest at `positions` [rad or m] and time 0. Inputs are constant
    /// during each `period` (s).
    ///
    /// # Errors
    /// [`JointLqrError`] for weights or a period out of range, quaternions that are not attitudes, a model
    /// without feed-forward, or a linearization without zero-order hold or stabilizing gain.
    pub fn new(
        model: D,
        positions: &[f64; NY],
        period: f64,
        weights: LqrWeights<N, M>,
    ) -> Result<Self, JointLqrError>
    where
        D: PhaseSpace<NX>,
    {
        const { assert!(NX == 2 * N, "a state has positions and velocities") }
        require("period", period, "positive and finite", |x| x.is_finite() && x > 0.0)?;
        let names = model.joint_names();
        require_gains("weights.position", &names, &weights.position)?;
        require_gains("weights.velocity", &names, &weights.velocity)?;
        let is_positive = |x: f64| x.is_finite() && x > 0.0;
        require_each(
            "weights.input",
            &model.input_names(),
            &weights.input,
            "finite and positive",
            is_positive,
        )?;
        if !positions.iter().all(|y| y.is_finite()) {
            return Err(JointLqrError::Model(ControllerFault::NotFinite));
        }
        model.check_attitudes(positions)?;
        let feed_forward = FeedForward::new(model)?;
        let inputs = feed_forward.at_time(0.0, &Sample::at_rest(*positions)).inputs;
        let hold = |model: &D| discretize(model, positions, &[0.0; N], &inputs, period);
        let discrete = feed_forward.model().at_time(0.0, hold).map_err(JointLqrError::Model)?;
        let (mut a, mut b, mut q, mut r) = ([[0.0; NX]; NX], [[0.0; M]; NX], [[0.0; NX]; NX], [[0.0; M]; M]);
        flat_state(&discrete.state, &mut a);
        flat_input(&discrete.input, &mut b);
        for (i, weight) in weights.position.iter().chain(&weights.velocity).enumerate() {
            q[i][i] = *weight;
        }
        for (i, weight) in weights.input.iter().enumerate() {
            r[i][i] = *weight;
        }
        Ok(Self { feed_forward, regulator: Lqr::new(&a, &b, &q, &r)? })
    }

    /// The regulator with the gain K and its stability margins.
    pub fn regulator(&self) -> &Lqr<NX, M> {
        &self.regulator
    }

    /// The feedback `K x` with the gain K and the state error x.
    fn feedback(&self, desired: &Sample<N, NY>, positions: &[f64; NY], velocities: &[f64; N]) -> [f64; M] {
        let error = self.feed_forward.model().difference(&desired.positions, positions);
        self.regulator.input(&core::array::from_fn(|i| match i.checked_sub(N) {
            None => error[i],
            Some(i) => velocities[i] - desired.velocities[i],
        }))
    }
}

impl<D, const N: usize, const M: usize, const NX: usize, const NY: usize> JointLaw<N, M, NY>
    for JointLqr<D, N, M, NX, NY>
where
    D: Discretizable<N, M, NY>,
{
    fn inputs(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        sum(self.feed_forward.at(desired).inputs, self.feedback(desired, positions, velocities))
    }

    fn inputs_at_time(
        &self,
        time: f64,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let feed_forward = self.feed_forward.at_time(time, desired).inputs;
        sum(feed_forward, self.feedback(desired, positions, velocities))
    }

    of_the_model!();
}
