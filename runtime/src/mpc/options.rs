//! Options of a predictive controller.

use super::error::{MpcError, require};
use super::observer::ObserverOptions;
use super::row::{MpcRow, RowFault, range};
use crate::dynamics::{DependentJoint, Dynamics, LimitRows, Limits, Named, QuaternionJoint};
use crate::qp::{Penalty, QpSettings};

/// Default standard deviation of the change of a disturbance in a period, relative to the largest input.
/// `tests/mpc_observer.rs` simulates a seven-axis arm whose joints stick, with a controller model with smooth
/// friction and periods of 2, 10 and 20 ms. The arm does not oscillate with this value, but oscillates with three
/// times this value.
const DISTURBANCE_SHARE: f64 = 3e-4;

/// States around which [`LtvMpc`](super::LtvMpc) linearizes the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LinearizationPoint {
    /// The desired trajectory with its feed-forward. This choice is fast and suits small errors. A step only predicts
    /// the last period of the horizon. The predictions of the other periods are kept from the previous step until
    /// the trajectory or the model changes.
    ///
    /// This choice is not suitable if friction is steep at rest and errors are large. If the desired trajectory is
    /// at rest, the friction of a moving joint is then predicted like that of a joint at rest. The joint can
    /// oscillate with full inputs. The PowerCube did so with an error of 4 mrad after a motion for which its torque
    /// was too small.
    Reference,
    /// The plan of the previous step, shifted by the time since the previous step.
    #[default]
    Plan,
}

/// Rule by which [`LtvMpc`](super::LtvMpc) predicts the state after a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PredictionRule {
    /// The exact zero-order hold of the linearization in the middle of the period,
    /// [`Discretizable::discretize`](crate::dynamics::Discretizable::discretize).
    #[default]
    ExactHold,
    /// The implicit midpoint rule with its exact sensitivities,
    /// [`Discretizable::midpoint_step`](crate::dynamics::Discretizable::midpoint_step). For arms the prediction is
    ///
    /// ```text
    ///     (m + T/2 D + T²/4 K) δv⁺ = (m − T/2 D − T²/4 K) δv − T K δy + T B δu − T r,   δy⁺ = δy + T/2 (δv + δv⁺)
    /// ```
    ///
    /// with the period T. The matrices m, D and K' are the Jacobians of the inverse dynamics with respect to ÿ, ẏ and y
    /// in the middle of the period, and K = K' − ∂(B u)/∂y. The acceleration in the middle is that of the plan,
    /// (v⁺ − v)/T, or that of the reference. r is the residual force of the equations of motion at this point. The
    /// computing time is little more than that of the Jacobians. The error of a period is of order T³, in addition
    /// to the error of the linearization. The exact hold only has the error of the linearization.
    ///
    /// The rule is not L-stable. If friction stops a velocity within much less than T, the sign of the predicted
    /// velocity alternates from period to period. For such steep friction at rest use [`Self::ExactHold`]. The
    /// controller reports these joints by [`MpcNote::Alternating`](super::MpcNote::Alternating).
    ///
    /// Source: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, 2006, sections I.1 and VI.4.
    ImplicitMidpoint,
}

/// Rule for the weight P of the state deviation δx at the end of the horizon. `½ δxᵀ P δx` is the cost after the
/// horizon if an optimal regulator without limits controls the robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TerminalWeight {
    /// The terminal weight P solves the discrete Riccati equation. A solution exists if the inputs can reduce
    /// all errors to zero.
    #[default]
    Riccati,
    /// The terminal weight P solves the Riccati equation with a discount. The cost at the time t after the
    /// end of the horizon is multiplied by e^(−t/τ). This means that √γ A and √γ B replace the state matrix A
    /// and the input matrix B, with γ = e^(−T/τ) and the period T.
    ///
    /// Use this weight for robots with a part that no input can control, for example the momentum of a free-floating
    /// body. The errors of this part remain, so their cost would be infinite without discount. Set the weights of
    /// this part to 0, and τ to several time constants of the controlled part. For the controlled part, P is then
    /// close to the weight without discount. A solution exists if errors that no input can reduce grow slower than
    /// e^(t/(2τ)).
    ///
    /// Source: Postoyan, Buşoniu, Nešić, Daafouz, *Stability analysis of discrete-time infinite-horizon optimal
    /// control with discounted cost*, IEEE Trans. Automatic Control 62 (2017).
    Discounted {
        /// Time constant τ of the discount (s), positive.
        time_constant: f64,
    },
}

impl TerminalWeight {
    /// Factor √γ of the state matrix A and the input matrix B for `period` (s); 1 without discount.
    pub(super) fn discount(self, period: f64) -> f64 {
        match self {
            Self::Riccati => 1.0,
            Self::Discounted { time_constant } => (-0.5 * period / time_constant).exp(),
        }
    }
}

/// Weights, bounds and structure of a predictive controller for a robot with `N` coordinates and `M` inputs.
/// `NR` is the number of rows, see [`MpcRow`].
#[derive(Debug, Clone, PartialEq)]
pub struct MpcOptions<const N: usize, const M: usize, const NR: usize = 0> {
    /// Period T of the controller (s).
    pub period: f64,
    /// Number K of periods in the horizon, 1 to 100.
    pub horizon: usize,
    /// Weights of the position errors [1/rad² or 1/m²], ≥ 0. For robots with quaternions the position errors are
    /// `y ⊖ y_ref`.
    pub position_weight: [f64; N],
    /// Weights of velocity errors [s²/rad² or s²/m²], ≥ 0.
    pub velocity_weight: [f64; N],
    /// Weights of the deviations of the inputs from the feed-forward [1/(N m)², 1/N² or 1/A²], ≥ 0. For each input,
    /// the sum of this weight and the rate weight must be positive.
    pub input_weight: [f64; M],
    /// Weights of the rates of change of the inputs [s²/(N m)², s²/N² or s²/A²], ≥ 0.
    pub input_rate_weight: [f64; M],
    /// Rule for the weight of the state at the end of the horizon.
    pub terminal_weight: TerminalWeight,
    /// Hard lower and upper bounds of the inputs [N m, N or A].
    pub input_limits: [[f64; 2]; M],
    /// Soft lower and upper bounds of the positions [rad or m]; infinite for positions without a bound.
    pub position_limits: [[f64; 2]; N],
    /// Soft bounds of the speeds, > 0 [rad/s or m/s]; infinite for speeds without a bound.
    pub velocity_limits: [f64; N],
    /// Probability p, above 1/2 and below 1, that a predicted input, position or speed keeps a limit if the
    /// friction of the model is uncertain ([`Dynamics::friction_uncertainty`]). The plan keeps narrowed
    /// limits. They are narrower by Φ⁻¹(p) standard deviations of the prediction, where Φ⁻¹ is the quantile
    /// of the normal distribution. The prediction assumes the feedback of the regulator of the terminal
    /// weight. The margin is small in the first stages, and each step computes a new plan. Therefore the
    /// robot can come closer to a limit than the end of a plan. [`Self::rows`] are not narrowed. `None`:
    /// limits are not narrowed.
    pub limit_probability: Option<f64>,
    /// Limits of weighted sums of positions, velocities and inputs, see [`Self::with_rows`].
    pub rows: [MpcRow<N, M>; NR],
    /// Penalty of violated soft bounds (per rad, m, rad/s or m/s) and of violated soft rows (per unit of the row).
    pub limit_penalty: Penalty,
    /// States around which [`LtvMpc`](super::LtvMpc) linearizes the robot.
    pub linearization: LinearizationPoint,
    /// Prediction rule of [`LtvMpc`](super::LtvMpc). With both rules, terminal weights are computed from the exact
    /// zero-order hold.
    pub prediction: PredictionRule,
    /// Whether inputs act one period after the measurement from which they were computed. If false, they act
    /// immediately.
    pub delay: bool,
    /// Noise that the disturbance observer assumes.
    pub observer: ObserverOptions<N, M>,
    /// Tolerances of the QP solver.
    pub qp: QpSettings,
}

impl<const N: usize, const M: usize, const NR: usize> MpcOptions<N, M, NR> {
    /// Default options for a model, with the given period (s) and number of periods in the horizon.
    ///
    /// - Input limits: the peak values of motor and joint ([`Dynamics::input_limits`]).
    /// - Position and velocity limits: those of the model, narrowed so that joints that follow one coordinate also
    ///   keep their limits.
    /// - Rows: the limits of joints that follow several coordinates, and the torque–speed lines of motors
    ///   ([`MpcRow::of_limits`]).
    /// - Weights: 1e4 for position errors and 1e2 for velocity errors, so that errors decay with a time
    ///   constant of 0.1 s. The weight of an input is 1e-3 per square of its limit.
    /// - Tolerance of the QP: a relative cost error of 1e-6.
    /// - Prediction: exact zero-order hold, linearization around the plan, no delay.
    /// - Observer: it estimates a disturbance of each input. The assumed change of the disturbance per period has a
    ///   standard deviation of 3e-4 of the largest input. The encoder noise is 1e-5 rad (or m), see
    ///   [`Self::with_encoders`].
    pub fn new<D, const NY: usize>(model: &D, period: f64, horizon: usize) -> Self
    where
        D: Dynamics<N, M, NY> + LimitRows<NR>,
    {
        let limits = model.limits().narrowed();
        let inputs = model.input_limits().peak;
        let scale = inputs.map(|[low, high]| {
            let largest = high.max(-low);
            if largest.is_finite() && largest > 0.0 { largest } else { 1.0 }
        });
        Self {
            period,
            horizon,
            position_weight: [1e4; N],
            velocity_weight: [1e2; N],
            input_weight: scale.map(|u| 1e-3 / (u * u)),
            input_rate_weight: [0.0; M],
            terminal_weight: TerminalWeight::Riccati,
            input_limits: inputs,
            position_limits: limits.position,
            velocity_limits: limits.velocity,
            limit_probability: None,
            rows: MpcRow::of_limits(model),
            limit_penalty: Penalty { linear: 1e4, quadratic: 1e5 },
            linearization: LinearizationPoint::Plan,
            prediction: PredictionRule::ExactHold,
            delay: false,
            observer: ObserverOptions {
                disturbance_noise: scale.map(|u| DISTURBANCE_SHARE * u),
                ..ObserverOptions::default()
            },
            qp: QpSettings { tolerance: 1e-6, ..QpSettings::default() },
        }
    }

    /// Sets the encoder noise for encoders with the resolutions `steps` at the joints [rad or m]. The standard
    /// deviation of the rounding error is resolution/√12.
    #[must_use]
    pub fn with_encoders(mut self, steps: [f64; N]) -> Self {
        self.observer.encoder_noise = steps.map(|step| step / 12.0_f64.sqrt());
        self
    }

    /// Replaces the present rows by `rows`. Rows can be torque–speed lines of motors, limits of joints that follow
    /// other joints, or any other limits of weighted sums. If [`MpcRow::of_limits`] returns rows for the robot,
    /// `rows` must contain them.
    #[must_use]
    pub fn with_rows<const ROWS: usize>(self, rows: [MpcRow<N, M>; ROWS]) -> MpcOptions<N, M, ROWS> {
        MpcOptions {
            rows,
            period: self.period,
            horizon: self.horizon,
            position_weight: self.position_weight,
            velocity_weight: self.velocity_weight,
            input_weight: self.input_weight,
            input_rate_weight: self.input_rate_weight,
            terminal_weight: self.terminal_weight,
            input_limits: self.input_limits,
            position_limits: self.position_limits,
            velocity_limits: self.velocity_limits,
            limit_probability: self.limit_probability,
            limit_penalty: self.limit_penalty,
            linearization: self.linearization,
            prediction: self.prediction,
            delay: self.delay,
            observer: self.observer,
            qp: self.qp,
        }
    }

    /// Checks the range of all options.
    ///
    /// # Errors
    /// [`MpcError::Option`] for the first value out of its range. [`MpcError::Row`] for the first row that is not
    /// valid.
    pub(super) fn check(&self) -> Result<(), MpcError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let weight = |x: f64| x.is_finite() && x >= 0.0;
        require("period", &[self.period], "positive and finite (s)", positive)?;
        require("position_weight", &self.position_weight, NOT_NEGATIVE, weight)?;
        require("velocity_weight", &self.velocity_weight, NOT_NEGATIVE, weight)?;
        require("input_weight", &self.input_weight, NOT_NEGATIVE, weight)?;
        require("input_rate_weight", &self.input_rate_weight, NOT_NEGATIVE, weight)?;
        let both: [f64; M] = core::array::from_fn(|i| self.input_weight[i] + self.input_rate_weight[i]);
        require("input_weight plus input_rate_weight", &both, "positive", positive)?;
        if let TerminalWeight::Discounted { time_constant } = self.terminal_weight {
            require("terminal_weight.time_constant", &[time_constant], "positive and finite (s)", positive)?;
        }
        let [inputs, positions] = [&self.input_limits[..], &self.position_limits]
            .map(|limits| limits.iter().map(|[low, high]| high - low).collect::<Vec<f64>>());
        require("input_limits (upper minus lower)", &inputs, "not negative", |x| x >= 0.0)?;
        require("position_limits (upper minus lower)", &positions, "not negative (rad or m)", |x| x >= 0.0)?;
        require("velocity_limits", &self.velocity_limits, "positive (rad/s or m/s)", |x| x > 0.0)?;
        let probability = self.limit_probability.as_slice();
        require("limit_probability", probability, "above 1/2 and below 1", |p| p > 0.5 && p < 1.0)?;
        require("limit_penalty.linear", &[self.limit_penalty.linear], "positive and finite", positive)?;
        require("limit_penalty.quadratic", &[self.limit_penalty.quadratic], NOT_NEGATIVE, weight)?;
        for row in &self.rows {
            let checked = row.check(&self.input_limits);
            checked.map_err(|fault| MpcError::Row { row: Named(row.name).to_string(), fault })?;
        }
        self.observer.check()
    }

    /// Checks that bounds and rows ensure the limits of joints that follow other joints, and the torque–speed lines of
    /// motors. Joints that follow driven joints are not checked, because their limits change with time.
    ///
    /// # Errors
    /// - [`MpcError::Dependent`] for the first joint whose limits are not ensured by the bounds or by a row with its
    ///   name.
    /// - [`MpcError::TorqueSpeed`] for the first motor without a row with its name and its input.
    pub(super) fn check_sums(&self, limits: &Limits<N, M>) -> Result<(), MpcError> {
        // A motor and a joint may have the same name. Rows with inputs belong to motors.
        let has_row = |name: &str, of: fn(&MpcRow<N, M>) -> &[f64; N]| {
            let keeps = |row: &MpcRow<N, M>| !row.has_inputs() && of(row).iter().any(|c| *c != 0.0);
            self.rows.iter().any(|row| row.name == name && keeps(row))
        };
        for line in limits.torque_speed {
            let keeps = |row: &MpcRow<N, M>| row.name == line.name && row.inputs[line.input] != 0.0;
            if !self.rows.iter().any(keeps) {
                return Err(MpcError::TorqueSpeed { motor: line.name });
            }
        }
        for joint in limits.dependent.iter().filter(|joint| !joint.follows_driven_joints()) {
            let name = joint.name;
            let is_kept = (self.keep_position(joint) || has_row(name, |row| &row.positions))
                && (self.keep_velocity(joint) || has_row(name, |row| &row.velocities));
            if !is_kept {
                return Err(MpcError::Dependent { joint: name });
            }
        }
        Ok(())
    }

    /// Whether the bounds of the positions ensure the position limits of a dependent joint.
    fn keep_position(&self, joint: &DependentJoint<N>) -> bool {
        let [least, most] = range(&joint.ratios, &self.position_limits).map(|end| joint.offset + end);
        let [low, high] = joint.position;
        let rounding =
            |end: f64| if end.is_finite() { ROUNDING * (end.abs() + joint.offset.abs()) } else { 0.0 };
        least >= low - rounding(low) && most <= high + rounding(high)
    }

    /// Whether the bounds of the speeds ensure the velocity limit of a dependent joint.
    fn keep_velocity(&self, joint: &DependentJoint<N>) -> bool {
        let [_, fastest] = range(&joint.ratios, &self.velocity_limits.map(|limit| [-limit, limit]));
        fastest <= joint.velocity * (1.0 + ROUNDING)
    }

    /// Checks that positions of joints with a quaternion have no limits.
    ///
    /// - `joints`: the joints with a quaternion
    ///
    /// # Errors
    /// [`MpcError::Limit`] for a bound of such a position. [`MpcError::Row`] for a row with such a position.
    pub(super) fn check_quaternions(&self, joints: &[QuaternionJoint]) -> Result<(), MpcError> {
        for joint in joints {
            let entries = joint.velocity..joint.angular_velocity() + 3;
            let limits = self.position_limits.iter().take(entries.end).skip(entries.start);
            if limits.flatten().any(|limit| limit.is_finite()) {
                return Err(MpcError::Limit { joint: joint.name });
            }
            for row in &self.rows {
                if row.positions.iter().take(entries.end).skip(entries.start).any(|c| *c != 0.0) {
                    let fault = RowFault::Attitude { joint: joint.name };
                    return Err(MpcError::Row { row: Named(row.name).to_string(), fault });
                }
            }
        }
        Ok(())
    }
}

/// Relative tolerance for rounding, because bounds that were divided by a ratio are multiplied by the ratio again.
const ROUNDING: f64 = 1e-9;
const NOT_NEGATIVE: &str = "finite and not negative";
