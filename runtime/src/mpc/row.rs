//! Rows: limits of weighted sums of positions, velocities and inputs in a predictive controller.

use crate::dynamics::{DependentJoint, Dynamics, LimitRows, Named, TorqueSpeedLine};
use crate::qp::{Penalty, QpProblem};
use crate::trajectory::Sample;
use std::fmt;

/// A limit of a weighted sum of positions y, velocities ẏ and inputs u,
///
/// ```text
///     lower ≤ G_y y + G_v ẏ + G_u u ≤ upper
/// ```
///
/// at the sample times of the horizon. A row with inputs applies from the present time on, with the positions and
/// velocities at the beginning of each period. A row without inputs applies from the next sample time on, because
/// the present state cannot be changed. The limit is kept only at the beginning of a period, but the velocity
/// changes during the period. If the drive cannot exceed the limit even for a short time, choose a lower limit with
/// a margin for this change.
///
/// ```
/// use gelenk_runtime::control_loop::{Controller, Cycle};
/// use gelenk_runtime::mpc::{LtvMpc, MpcOptions, MpcRow};
/// use gelenk_runtime::trajectory::RestToRest;
///
/// gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// // Each motor produces 0.5 N m at rest and 0 N m at 300 rad/s. The gear ratio is 161.
/// let slope = 161.0 * 0.5 / 300.0;
/// let rows = [
///     MpcRow::torque_speed_line("motor of joint 1", [1.0, 0.0], [slope, 0.0], 0.5),
///     MpcRow::torque_speed_line("motor of joint 2", [0.0, 1.0], [0.0, slope], 0.5),
///     // The third joint of a parallelogram follows the other two joints and has limits of ±1.2 rad.
///     MpcRow::dependent_joint("elbow rod", [1.0, 1.0], 0.1, [-1.2, 1.2]),
/// ];
/// let motion = RestToRest::new([0.0, 0.0], [0.3, 0.4], 2.0)?;
/// let options = MpcOptions::new(&PowerCube, 0.02, 20).with_rows(rows);
/// let mut mpc = LtvMpc::new(PowerCube, motion, options)?;
/// mpc.reset(&[0.0; 2], &[0.0; 2]);
/// let inputs = mpc.step(&Cycle { positions: Some([0.0; 2]), ..Cycle::default() })?.inputs;
/// let estimate = mpc.estimate().ok_or("it has an observer")?;
/// let value = rows[0].value(&estimate.positions, &estimate.velocities, &inputs);
/// assert!(value.abs() <= 0.5 + 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MpcRow<const N: usize, const M: usize> {
    /// Name of the row in errors and notes.
    pub name: &'static str,
    /// Coefficients G_y of the positions, per rad or m.
    pub positions: [f64; N],
    /// Coefficients G_v of the velocities, per rad/s or m/s.
    pub velocities: [f64; N],
    /// Coefficients G_u of the inputs, per N m, N or A.
    pub inputs: [f64; M],
    /// Lower limit, in the unit of the sum; −∞ for a row without a lower limit.
    pub lower: f64,
    /// Upper limit, in the unit of the sum; +∞ for a row without an upper limit.
    pub upper: f64,
    /// Whether the row is hard or soft.
    pub kind: RowKind,
}

/// Whether a row is hard or soft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RowKind {
    /// The row is kept with the tolerance [`QpSettings::feasibility`](crate::qp::QpSettings::feasibility). If hard
    /// rows contradict each other or the limits of the inputs, the sum of their violations is minimized.
    Hard,
    /// The row can be violated at the cost of [`MpcOptions::limit_penalty`](super::MpcOptions::limit_penalty), per
    /// unit of the row.
    Soft,
    /// The row can be violated at the cost of this penalty, per unit of the row.
    Penalized(Penalty),
}

impl<const N: usize, const M: usize> MpcRow<N, M> {
    /// The row `lower ≤ G_y y + G_v ẏ + G_u u ≤ upper`. A row with inputs is hard, because the controller can choose
    /// the inputs. A row without inputs is soft, because a disturbance can make it impossible to keep.
    pub const fn new(
        name: &'static str,
        positions: [f64; N],
        velocities: [f64; N],
        inputs: [f64; M],
        [lower, upper]: [f64; 2],
    ) -> Self {
        let row = Self { name, positions, velocities, inputs, lower, upper, kind: RowKind::Soft };
        if row.has_inputs() { row.hard() } else { row }
    }

    /// The torque–speed line of a motor, `|G_u u + c ẏ| ≤ limit`, as a hard row. `inputs` is G_u and `slopes` is c. If
    /// the motor turns in the direction of the joint, c is positive. At high speed, the available torque is then
    /// smaller for driving and larger for braking.
    ///
    /// A DC motor has the torque constant k (N m/A), the equal speed constant k (V s/rad) and the resistance R (Ω). At
    /// the voltage U (V), the current I (A) and the speed ω (rad/s) satisfy |R I + k ω| ≤ U. For the gear ratio i,
    /// the limit is k U/R and c is i k²/R. In terms of a data sheet, the limit is the stall torque, and c is i times
    /// the stall torque divided by the no-load speed.
    ///
    /// If a description has `stall_torque` and `no_load_speed` of a drive, [`Self::of_limits`] returns this row.
    pub const fn torque_speed_line(
        name: &'static str,
        inputs: [f64; M],
        slopes: [f64; N],
        limit: f64,
    ) -> Self {
        Self::new(name, [0.0; N], slopes, inputs, [-limit, limit]).hard()
    }

    /// The limits `lower ≤ G y + g₀ ≤ upper` [rad or m] of the position of a joint that follows the coordinates y, as a
    /// soft row. `ratios` is G, `offset` is g₀ [rad or m], and `limits` are the lower and upper limit.
    pub const fn dependent_joint(
        name: &'static str,
        ratios: [f64; N],
        offset: f64,
        [lower, upper]: [f64; 2],
    ) -> Self {
        Self::new(name, ratios, [0.0; N], [0.0; M], [lower - offset, upper - offset])
    }

    /// Returns the rows that a robot needs. Each row has the name of its joint or motor. The order is:
    ///
    /// 1. position limits of joints that follow several coordinates
    /// 2. velocity limits of these joints
    /// 3. torque–speed lines of motors
    ///
    /// [`MpcOptions::new`](super::MpcOptions::new) uses these rows. To add other rows, destructure the array:
    ///
    /// ```
    /// use gelenk_runtime::mpc::{LtvMpc, MpcOptions, MpcRow};
    /// use gelenk_runtime::trajectory::RestToRest;
    ///
    /// gelenk_runtime::dynamics!(pub struct Palletizer = gelenk_generated::palletizer);
    ///
    /// let motion = RestToRest::new([0.0, 0.3, 0.8, 0.0], [0.4, 0.3, 1.2, 0.5], 2.0)?;
    /// let [forearm] = MpcRow::of_limits(&Palletizer);
    /// assert_eq!(forearm.name, "forearm");
    /// let supply = MpcRow::new("supply", [0.0; 4], [0.0; 4], [1.0, 1.0, 0.0, 0.0], [-900.0, 900.0]);
    /// let options = MpcOptions::new(&Palletizer, 0.01, 15).with_rows([forearm, supply]);
    /// let mpc = LtvMpc::new(Palletizer, motion, options)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of_limits<D, const NR: usize, const NY: usize>(model: &D) -> [Self; NR]
    where
        D: Dynamics<N, M, NY> + LimitRows<NR>,
    {
        let limits = model.limits();
        let joints = || limits.dependent.iter().filter(|joint| joint.is_sum());
        let positions = joints().filter(|joint| joint.has_position_limit()).map(Self::of_position);
        let velocities = joints().filter(|joint| joint.has_velocity_limit()).map(Self::of_velocity);
        let mut rows = positions.chain(velocities).chain(limits.torque_speed.iter().map(Self::of_line));
        // A hand-written robot may declare more rows than it has limits.
        let free = Self::new("free", [0.0; N], [0.0; N], [0.0; M], [f64::NEG_INFINITY, f64::INFINITY]);
        core::array::from_fn(|_| rows.next().unwrap_or(free))
    }

    fn of_line(line: &TorqueSpeedLine<N>) -> Self {
        let mut inputs = [0.0; M];
        inputs[line.input] = 1.0;
        Self::torque_speed_line(line.name, inputs, line.slopes, line.limit)
    }

    fn of_position(joint: &DependentJoint<N>) -> Self {
        Self::dependent_joint(joint.name, joint.ratios, joint.offset, joint.position)
    }

    fn of_velocity(joint: &DependentJoint<N>) -> Self {
        let sides = [-joint.velocity, joint.velocity];
        Self::new(joint.name, [0.0; N], joint.ratios, [0.0; M], sides)
    }

    /// Makes the row hard.
    #[must_use]
    pub const fn hard(self) -> Self {
        Self { kind: RowKind::Hard, ..self }
    }

    /// Makes the row soft, with the penalty of [`RowKind::Soft`].
    #[must_use]
    pub const fn soft(self) -> Self {
        Self { kind: RowKind::Soft, ..self }
    }

    /// Makes the row soft, with this penalty.
    #[must_use]
    pub const fn penalized(self, penalty: Penalty) -> Self {
        Self { kind: RowKind::Penalized(penalty), ..self }
    }

    pub(super) const fn has_inputs(&self) -> bool {
        let mut i = 0;
        while i < M {
            if self.inputs[i] != 0.0 {
                return true;
            }
            i += 1;
        }
        false
    }

    /// Value of the weighted sum at positions [rad or m], velocities [rad/s or m/s] and inputs [N m, N or A],
    /// in the unit of the row.
    #[must_use]
    pub fn value(&self, positions: &[f64; N], velocities: &[f64; N], inputs: &[f64; M]) -> f64 {
        dot(&self.positions, positions) + dot(&self.velocities, velocities) + dot(&self.inputs, inputs)
    }

    /// Amount by which the value exceeds a limit; zero or negative if the row is kept.
    pub(super) fn excess(&self, sample: &Sample<N>, inputs: &[f64; M]) -> f64 {
        let value = self.value(&sample.positions, &sample.velocities, inputs);
        (self.lower - value).max(value - self.upper)
    }

    pub(super) fn check(&self, input_limits: &[[f64; 2]; M]) -> Result<(), RowFault> {
        let coefficients = || self.positions.iter().chain(&self.velocities).chain(&self.inputs);
        if let Some(&value) = coefficients().find(|c| !c.is_finite()) {
            return Err(RowFault::NotFinite { value });
        }
        let (lower, upper) = (self.lower, self.upper);
        let unit = coefficients().fold(0.0_f64, |max, c| c.abs().max(max));
        let lost = |side: f64| unit > 0.0 && side.is_finite() && !(side / unit).is_finite();
        // The condition is false for NaN, so NaN is rejected.
        let ordered = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
        if !ordered || lost(lower) || lost(upper) {
            return Err(RowFault::Sides { lower, upper });
        }
        if unit == 0.0 && !(lower <= 0.0 && 0.0 <= upper) {
            return Err(RowFault::Zero { lower, upper });
        }
        let of_inputs = self.positions.iter().chain(&self.velocities).all(|c| *c == 0.0);
        if of_inputs && self.kind == RowKind::Hard {
            let [least, most] = range(&self.inputs, input_limits);
            if least > upper || most < lower {
                return Err(RowFault::OutOfReach { lower, upper, least, most });
            }
        }
        match self.kind {
            RowKind::Penalized(p) if !is_penalty(&p) => {
                Err(RowFault::Penalty { linear: p.linear, quadratic: p.quadratic })
            }
            _ => Ok(()),
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Whether the QP solver accepts a penalty.
pub(super) fn is_penalty(p: &Penalty) -> bool {
    p.linear > 0.0 && p.linear.is_finite() && p.quadratic >= 0.0 && p.quadratic.is_finite()
}

/// Smallest and largest value of `Σ factors[i] values[i]` for values within `limits`.
pub(super) fn range<const M: usize>(factors: &[f64; M], limits: &[[f64; 2]; M]) -> [f64; 2] {
    let mut range = [0.0; 2];
    for (factor, [low, high]) in factors.iter().zip(limits) {
        if *factor != 0.0 {
            let ends = [factor * low, factor * high];
            range[0] += ends[0].min(ends[1]);
            range[1] += ends[0].max(ends[1]);
        }
    }
    range
}

/// Reason why a row is not valid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RowFault {
    /// A coefficient is infinite or NaN.
    NotFinite {
        /// Coefficient that is infinite or NaN.
        value: f64,
    },
    /// The limits do not form an interval for one of these reasons:
    ///
    /// - a limit is NaN
    /// - the lower limit is above the upper limit, or is +∞, or the upper limit is −∞
    /// - a limit divided by the largest coefficient overflows
    Sides {
        /// Lower limit of the row.
        lower: f64,
        /// Upper limit of the row.
        upper: f64,
    },
    /// All coefficients are zero, and zero is not between the limits.
    Zero {
        /// Lower limit of the row.
        lower: f64,
        /// Upper limit of the row.
        upper: f64,
    },
    /// The row contains a position of a joint with a quaternion.
    Attitude {
        /// Name of the joint.
        joint: &'static str,
    },
    /// A hard row contains only inputs, and no inputs within their limits keep the row.
    OutOfReach {
        /// Lower limit of the row.
        lower: f64,
        /// Upper limit of the row.
        upper: f64,
        /// Smallest value of the row for inputs within their limits.
        least: f64,
        /// Largest value of the row for inputs within their limits.
        most: f64,
    },
    /// The linear penalty is not positive, the quadratic penalty is negative, or a penalty is not finite.
    Penalty {
        /// Linear penalty, in cost per unit of violation.
        linear: f64,
        /// Quadratic penalty, in cost per squared unit of violation.
        quadratic: f64,
    },
}

impl fmt::Display for RowFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { value } => {
                write!(f, "a coefficient is {value}, but all coefficients must be finite")
            }
            Self::Sides { lower, upper } => write!(
                f,
                "its limits {lower} and {upper} are not an interval. The lower limit must not exceed the upper limit. Write -inf \
                 or inf for a missing limit"
            ),
            Self::Zero { lower, upper } => {
                write!(
                    f,
                    "all its coefficients are zero, and zero is not between its limits {lower} and {upper}"
                )
            }
            Self::Attitude { joint } => write!(
                f,
                "it contains a position of joint {}, whose position is a quaternion. A row can only contain the velocities of this joint",
                Named(joint)
            ),
            Self::OutOfReach { lower, upper, least, most } => write!(
                f,
                "its value must be between {lower} and {upper}, but inputs within their limits give {least} to {most}"
            ),
            Self::Penalty { linear, quadratic } => write!(
                f,
                "its linear penalty is {linear} and its quadratic penalty is {quadratic}. Both must be finite, the first positive \
                 and the second not negative"
            ),
        }
    }
}

/// Sets the matrices and penalties of the rows in the QP. They do not change afterwards.
///
/// - `soft`: penalty of rows of the kind [`RowKind::Soft`]
pub(super) fn set_matrices<const N: usize, const M: usize, const NX: usize, const NR: usize>(
    problem: &mut QpProblem<NX, M, NR>,
    rows: &[MpcRow<N, M>; NR],
    soft: Penalty,
) {
    for (r, row) in rows.iter().enumerate() {
        problem.row_penalty[r] = match row.kind {
            RowKind::Hard => None,
            RowKind::Soft => Some(soft),
            RowKind::Penalized(penalty) => Some(penalty),
        };
        let mut of_state = [0.0; NX];
        of_state[..N].copy_from_slice(&row.positions);
        of_state[N..].copy_from_slice(&row.velocities);
        for stage in &mut problem.stages {
            stage.rows.state_matrix[r] = of_state;
            stage.rows.input_matrix[r] = row.inputs;
        }
        problem.terminal_rows.state_matrix[r] = of_state;
    }
}

/// Sets the limits of the rows in the QP, whose variables are deviations from the reference. For inputs the
/// deviation is `u + d − u_ff`, with the input disturbance d and the feed-forward u_ff.
pub(super) fn set_sides<const N: usize, const M: usize, const NX: usize, const NR: usize>(
    problem: &mut QpProblem<NX, M, NR>,
    rows: &[MpcRow<N, M>; NR],
    reference: impl Fn(usize) -> [f64; NX],
    inputs: &[[f64; M]],
    disturbance: &[f64; M],
) {
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    for (r, row) in rows.iter().enumerate() {
        let by_state = |x: &[f64; NX]| dot(&row.positions, &x[..N]) + dot(&row.velocities, &x[N..]);
        for (k, stage) in problem.stages.iter_mut().enumerate() {
            let by_inputs: f64 = (0..M).map(|i| row.inputs[i] * (inputs[k][i] - disturbance[i])).sum();
            let at = by_state(&reference(k)) + by_inputs;
            let given = k == 0 && !row.has_inputs();
            [stage.rows.lower[r], stage.rows.upper[r]] =
                if given { free } else { [row.lower - at, row.upper - at] };
        }
        let at = by_state(&reference(problem.stages.len()));
        let end = &mut problem.terminal_rows;
        [end.lower[r], end.upper[r]] = if row.has_inputs() { free } else { [row.lower - at, row.upper - at] };
    }
}
