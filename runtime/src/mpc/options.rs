//! Options of a predictive controller.

use super::error::{MpcError, require};
use super::observer::ObserverOptions;
use super::row::{MpcRow, RowFault, range};
use crate::dynamics::{DependentJoint, Dynamics, LimitRows, Limits, Named, QuaternionJoint};
use crate::qp::{Penalty, QpSettings};

/// Standard deviation of a disturbance's change in a period by default, as a part of the largest input. At periods of 2, 10 and
/// 20 ms an arm of seven axes stays calm with it although its joints stick and the model is smooth; with three times as much it
/// swings (`tests/mpc_observer.rs`).
const DISTURBANCE_SHARE: f64 = 3e-4;

/// Where the linear predictions are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LinearizationPoint {
    /// Along the desired trajectory and its feed-forward. Good while errors are small. Where friction is
    /// steep at rest, a joint that should rest but does not is taken for one that hardly moves: far from its
    /// goal it is driven back and forth by full inputs (seen: 4 mrad on the PowerCube after a motion that its
    /// torque was too small for). A step predicts its last period alone: the others are kept from the step before, until the
    /// motion or the model changes.
    Reference,
    /// Along the plan of the step before, moved on by the time that has passed.
    #[default]
    Plan,
}

/// How [`LtvMpc`](super::LtvMpc) predicts over a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PredictionRule {
    /// The exact zero-order hold of the linearization in the middle of the period,
    /// [`Discretizable::discretize`](crate::dynamics::Discretizable::discretize).
    #[default]
    ExactHold,
    /// The implicit midpoint rule with its exact sensitivities,
    /// [`Discretizable::midpoint_step`](crate::dynamics::Discretizable::midpoint_step). With m, D and K the Jacobians of the
    /// inverse dynamics in the middle of the period, K less ∂(B u)/∂y, for arms:
    ///
    /// ```text
    ///     (m + T/2 D + T²/4 K) δv⁺ = (m − T/2 D − T²/4 K) δv − T K δy + T B δu − T r,   δy⁺ = δy + T/2 (δv + δv⁺)
    /// ```
    ///
    /// It costs little more than these Jacobians, and has an error of order T³ in a period. The hold has only that of the
    /// linearization. The middle has the acceleration of the plan, (v⁺ − v)/T, or of the reference, and r is the force
    /// that the plan lacks there.
    ///
    /// It is not L-stable: where friction stops a velocity within much less than T, its predicted sign alternates from period
    /// to period. Friction that is so steep at rest needs [`Self::ExactHold`]; the controller notes the joint
    /// ([`MpcNote::Alternating`](super::MpcNote::Alternating)).
    ///
    /// Source: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, 2006, sections I.1 and VI.4.
    ImplicitMidpoint,
}

/// The weight P of the state at the end of the horizon: the cost after it, by an optimal regulator
/// without limits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TerminalWeight {
    /// P solves the discrete Riccati equation. It exists where the inputs can bring all errors to rest.
    #[default]
    Riccati,
    /// Costs at the time t beyond the horizon count e^(−t/τ) of their value: P solves the Riccati equation of
    /// √γ A and √γ B with γ = e^(−T/τ). For robots a part of which no input reaches, as the momentum of a
    /// body that floats freely: its errors stay, and without discount they would cost infinitely much. Give
    /// this part the weights 0, and τ several time constants of the part that is controlled: then P is close to
    /// the cost without discount there. It exists where errors that no input reaches grow slower than e^(t/2τ).
    ///
    /// Source: Postoyan, Buşoniu, Nešić, Daafouz, *Stability analysis of discrete-time infinite-horizon optimal
    /// control with discounted cost*, IEEE Trans. Automatic Control 62 (2017).
    Discounted {
        /// τ (s), positive.
        time_constant: f64,
    },
}

impl TerminalWeight {
    /// √γ for the period (s).
    pub(super) fn discount(self, period: f64) -> f64 {
        match self {
            Self::Riccati => 1.0,
            Self::Discounted { time_constant } => (-0.5 * period / time_constant).exp(),
        }
    }
}

/// Weights, bounds and structure of a predictive controller of a robot with `N` coordinates and `M` inputs,
/// and, if there are any, with `NR` rows.
#[derive(Debug, Clone, PartialEq)]
pub struct MpcOptions<const N: usize, const M: usize, const NR: usize = 0> {
    /// Sample time T (s).
    pub period: f64,
    /// Stages of the horizon, 1..=100.
    pub horizon: usize,
    /// Weights of position errors [1/rad² or 1/m²], ≥ 0: of `y ⊖ y_ref` where y has quaternions.
    pub position_weight: [f64; N],
    /// Weights of velocity errors [s²/rad² or s²/m²], ≥ 0.
    pub velocity_weight: [f64; N],
    /// Weights of the deviation from the feed-forward [1/(N m)², 1/N² or 1/A²], ≥ 0; with the rate weight >
    /// 0.
    pub input_weight: [f64; M],
    /// Weights of the input's rate of change [s²/(N m)² …], ≥ 0.
    pub input_rate_weight: [f64; M],
    /// The weight of the state at the end of the horizon.
    pub terminal_weight: TerminalWeight,
    /// Hard lower and upper bounds of the inputs.
    pub input_limits: [[f64; 2]; M],
    /// Soft lower and upper bounds of the positions; infinite if there is none.
    pub position_limits: [[f64; 2]; N],
    /// Soft bounds of the speeds; infinite if there is none.
    pub velocity_limits: [f64; N],
    /// Probability, above 1/2, that a predicted input, position or speed is within a limit although the model's friction is
    /// uncertain ([`Dynamics::friction_uncertainty`]). The plan keeps limits that are narrower by Φ⁻¹(p) standard deviations of
    /// the prediction, under the feedback of the terminal weight's regulator. Each step makes a new plan, so the loop may stay as
    /// near to a limit as the first stages allow. [`Self::rows`] are not narrowed. `None`: the plan keeps the limits themselves.
    pub limit_probability: Option<f64>,
    /// Limits of sums of positions, velocities and inputs, see [`Self::with_rows`].
    pub rows: [MpcRow<N, M>; NR],
    /// Penalty of a violated soft bound, per rad, m, rad/s or m/s; of a soft row per its unit.
    pub limit_penalty: Penalty,
    /// Where [`LtvMpc`](super::LtvMpc) linearizes.
    pub linearization: LinearizationPoint,
    /// How [`LtvMpc`](super::LtvMpc) predicts. Terminal weights are those of the exact hold with both.
    pub prediction: PredictionRule,
    /// True if an input acts one period after the measurement that it was computed from.
    pub delay: bool,
    /// The observer's noise.
    pub observer: ObserverOptions<N, M>,
    /// The QP solver's tolerances.
    pub qp: QpSettings,
}

impl<const N: usize, const M: usize, const NR: usize> MpcOptions<N, M, NR> {
    /// Options with the model's limits (inputs up to the peak of motor and joint, [`Dynamics::input_limits`];
    /// positions; speeds; both narrowed to what joints that follow one of them allow; rows of joints that follow several and of
    /// motors whose torque falls with their speed, [`MpcRow::of_limits`]) and weights for a robot in SI units: position errors
    /// 1e4, velocity errors 1e2 (errors vanish with a time constant of 0.1 s), deviations of the input 1e-3 per full input.
    /// QP to a millionth of its cost. No delay, linearization around the plan. The observer estimates a disturbance of every input,
    /// which changes by 3e-4 of the largest input in a period, and reckons with encoders of 1e-5 rad (or m), see
    /// [`Self::with_encoders`].
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

    /// The same options for encoders with these steps at their joints [rad or m]; rounding by a step has a standard
    /// deviation of step/√12.
    #[must_use]
    pub fn with_encoders(mut self, steps: [f64; N]) -> Self {
        self.observer.encoder_noise = steps.map(|step| step / 12.0_f64.sqrt());
        self
    }

    /// The same options with these rows in place of theirs: torque–speed lines of motors, limits of dependent joints, any others.
    /// A robot that has limits of sums needs theirs among them, [`MpcRow::of_limits`].
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

    /// # Errors
    /// [`MpcError::Option`] for the first value out of its range, [`MpcError::Row`] for the first row that
    /// cannot be used.
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
        let probability = self.limit_probability.unwrap_or(0.9);
        require("limit_probability", &[probability], "above 1/2 and below 1", |p| p > 0.5 && p < 1.0)?;
        require("limit_penalty.linear", &[self.limit_penalty.linear], "positive and finite", positive)?;
        require("limit_penalty.quadratic", &[self.limit_penalty.quadratic], NOT_NEGATIVE, weight)?;
        for row in &self.rows {
            let checked = row.check(&self.input_limits);
            checked.map_err(|fault| MpcError::Row { row: Named(row.name).to_string(), fault })?;
        }
        self.observer.check()
    }

    /// # Errors
    /// [`MpcError::Dependent`] for the first joint whose limits neither bounds nor a row of its name keep, and
    /// [`MpcError::TorqueSpeed`] for the first motor whose line no row of its name with its input keeps. Limits of joints that
    /// follow driven ones, which change with time, do not become rows.
    pub(super) fn check_sums(&self, limits: &Limits<N, M>) -> Result<(), MpcError> {
        // A motor may be called as a joint is: rows with inputs are those of motors.
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

    /// Whether the bounds of the positions keep those of a joint.
    fn keep_position(&self, joint: &DependentJoint<N>) -> bool {
        let [least, most] = range(&joint.ratios, &self.position_limits).map(|end| joint.offset + end);
        let [low, high] = joint.position;
        let rounding =
            |end: f64| if end.is_finite() { ROUNDING * (end.abs() + joint.offset.abs()) } else { 0.0 };
        least >= low - rounding(low) && most <= high + rounding(high)
    }

    /// Whether the bounds of the speeds keep that of a joint.
    fn keep_velocity(&self, joint: &DependentJoint<N>) -> bool {
        let [_, fastest] = range(&joint.ratios, &self.velocity_limits.map(|limit| [-limit, limit]));
        fastest <= joint.velocity * (1.0 + ROUNDING)
    }

    /// - `joints`: those with a quaternion
    ///
    /// # Errors
    /// [`MpcError::Limit`] and [`MpcError::Row`] for limits of their positions.
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

/// Bounds that were divided by a ratio, and are multiplied by it, are rounded.
const ROUNDING: f64 = 1e-9;
const NOT_NEGATIVE: &str = "finite and not negative";
