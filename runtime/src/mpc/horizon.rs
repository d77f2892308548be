//! Common parts of the predictive controllers: estimate, reference over the horizon, QP, and plan.

use super::error::MpcError;
use super::integrate::{Span, integrate, substeps};
use super::margins::{Margins, narrowed, quantile};
use super::node::{Node, Prediction, in_deviations};
use super::note::{MpcNote, alternating, beyond_limits, beyond_rows, dry_friction, not_kept};
use super::observer::DisturbanceObserver;
use super::options::{LinearizationPoint, MpcOptions};
use super::reference::Reference;
use super::row;
use crate::control_loop::zero_order_hold::{discretize, flat_input, flat_state};
use crate::control_loop::{Command, ControllerFault, Cycle, Estimate};
use crate::dynamics::{Discretizable, Discretization};
use crate::feed_forward::{FeedForward, FeedForwardError};
use crate::lanes::batch::Held;
use crate::lqr::Lqr;
use crate::qp::{QpProblem, QpReport, QpSolver, QpStage, QpStatus};
use crate::trajectory::{Sample, Trajectory};
use std::hint::black_box;

/// Largest number of periods over which a step predicts the state. This bounds the computing time after a stall of
/// the loop. After a longer stall the predicted state would be useless.
const MAX_BRIDGED: u32 = 100;
/// Number of equal time intervals of the trajectory. Terminal weights are computed at their ends.
const TERMINAL_INTERVALS: usize = 32;

/// The plan from the solution of the last QP: states x_0 … x_K and inputs `u + d` of K periods, with the
/// input disturbance d.
#[derive(Debug, Clone)]
pub(super) struct Plan<const N: usize, const M: usize, const NY: usize> {
    pub states: Vec<Node<N, NY>>,
    pub inputs: Vec<[f64; M]>,
    disturbance: [f64; M],
    /// Time on the trajectory at which the plan begins (s); NaN if there is no plan.
    pub start: f64,
}

impl<const N: usize, const M: usize, const NY: usize> Plan<N, M, NY> {
    fn is_finite(&self) -> bool {
        self.states.iter().all(Node::is_finite) && finite(self.inputs.as_flattened())
    }
}

#[derive(Debug, Clone)]
pub(super) struct Horizon<
    D,
    T,
    const N: usize,
    const M: usize,
    const NX: usize,
    const NR: usize,
    const NY: usize,
> {
    feed_forward: FeedForward<D, N, M, NY>,
    trajectory: T,
    pub options: MpcOptions<N, M, NR>,
    pub observer: DisturbanceObserver<N, M, NY>,
    /// Number of Runge–Kutta steps in a period.
    pub substeps: usize,
    problem: QpProblem<NX, M, NR>,
    solver: QpSolver<NX, M, NR>,
    /// Regulators at `TERMINAL_INTERVALS + 1` equidistant times of the trajectory.
    terminal: Vec<Lqr<NX, M>>,
    /// Index of the regulator of this step.
    regulator: usize,
    /// Number of standard deviations by which limits are narrowed because of uncertain friction.
    deviations: f64,
    pub reference: Reference<N, M, NY>,
    pub plan: Plan<N, M, NY>,
    /// Time at which the last solved QP begins (s); NaN if the next QP has a cold start.
    solved: f64,
    /// The last computed input. If inputs act one period late, this input acts from now on.
    under_way: [f64; M],
    /// Time of the last step on the trajectory (s).
    time: f64,
    pub notes: Vec<MpcNote>,
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Horizon<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    pub fn new(model: D, trajectory: T, options: MpcOptions<N, M, NR>) -> Result<Self, MpcError> {
        const { assert!(NX == 2 * N, "NX must be 2 N") };
        options.check()?;
        options.check_quaternions(model.quaternion_joints())?;
        options.check_sums(&model.limits())?;
        let stages = options.horizon;
        let neutral = Node { positions: model.neutral(), velocities: [0.0; N] };
        let mut horizon = Self {
            feed_forward: FeedForward::new(model)?,
            observer: DisturbanceObserver::starting_at(&neutral.positions, options.observer)?,
            substeps: 1,
            problem: QpProblem::new(stages),
            solver: QpSolver::new(stages, options.qp)?,
            terminal: Vec::with_capacity(TERMINAL_INTERVALS + 1),
            regulator: 0,
            deviations: options.limit_probability.map_or(0.0, quantile),
            reference: Reference::new(stages, options.period, neutral),
            plan: Plan {
                states: vec![neutral; stages + 1],
                inputs: vec![[0.0; M]; stages],
                disturbance: [0.0; M],
                start: f64::NAN,
            },
            solved: f64::NAN,
            under_way: [0.0; M],
            time: 0.0,
            notes: Vec::new(),
            trajectory,
            options,
        };
        horizon.set_weights();
        horizon.look_along()?;
        let notes = beyond_limits(horizon.model(), &horizon.trajectory, &horizon.options);
        horizon.notes.extend(notes);
        let inputs = |time, sample: &Sample<N, NY>| horizon.feed_forward.at_time(time, sample).inputs;
        let notes = beyond_rows(horizon.model(), &horizon.trajectory, &horizon.options.rows, inputs);
        horizon.notes.extend(notes);
        let notes = not_kept(horizon.model().limits().dependent);
        horizon.notes.extend(notes);
        let start = horizon.trajectory.sample(0.0).positions;
        let notes = horizon.model().at_time(0.0, |model| dry_friction(model, &start));
        horizon.notes.extend(notes);
        Ok(horizon)
    }

    /// Adds notes for the joints for which the implicit midpoint rule is not suitable.
    pub fn note_alternating(&mut self) {
        let (start, period) = (self.trajectory.sample(0.0).positions, self.options.period);
        let notes = self.model().at_time(0.0, |model| alternating(model, &start, period));
        self.notes.extend(notes);
    }

    pub fn model(&self) -> &D {
        self.feed_forward.model()
    }

    /// Replaces the model. Estimate, plan and terminal weights are kept. If the friction of the new model is steeper
    /// at rest, the number of Runge–Kutta steps increases.
    pub fn set_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        self.feed_forward.set_model(model)?;
        self.reference.forget();
        let (y, u) = (*self.observer.positions(), self.under_way);
        let resting = self.model().at_time(self.time, |model| model.linearize(&y, &[0.0; N], &u));
        let needed = substeps(&resting, self.options.period);
        self.substeps = self.substeps.max(needed);
        Ok(())
    }

    fn set_weights(&mut self) {
        let (options, problem) = (&self.options, &mut self.problem);
        for i in 0..N {
            problem.state_weight[i][i] = options.position_weight[i];
            problem.state_weight[N + i][N + i] = options.velocity_weight[i];
            problem.state_penalty[i] = Some(options.limit_penalty);
            problem.state_penalty[N + i] = Some(options.limit_penalty);
        }
        let square = options.period * options.period;
        for i in 0..M {
            problem.input_weight[i][i] = options.input_weight[i];
            problem.input_rate_weight[i][i] = options.input_rate_weight[i] / square;
        }
        row::set_matrices(problem, &options.rows, options.limit_penalty);
    }

    /// Computes the terminal weights and the number of Runge–Kutta steps along the trajectory.
    fn look_along(&mut self) -> Result<(), MpcError> {
        let mut input_weight = self.problem.input_weight;
        for i in 0..M {
            input_weight[i][i] += self.problem.input_rate_weight[i][i];
        }
        let duration = self.trajectory.duration();
        let mut inaccurate = (0.0, 0.0);
        for k in 0..=TERMINAL_INTERVALS {
            let time = duration * k as f64 / TERMINAL_INTERVALS as f64;
            let sample = self.trajectory.sample(time);
            let inputs = self.feed_forward.at_time(time, &sample).inputs;
            if !sample.is_finite() || inputs.iter().any(|u| !u.is_finite()) {
                return Err(MpcError::NotFinite { time });
            }
            let (y, v) = (&sample.positions, &sample.velocities);
            self.model().check_attitudes(y).map_err(|error| MpcError::Attitude { time, error })?;
            let discrete = self.look_at(time, y, v, &inputs)?;
            let (mut a, mut b) = ([[0.0; NX]; NX], [[0.0; M]; NX]);
            flat_state(&discrete.state, &mut a);
            flat_input(&discrete.input, &mut b);
            let discount = self.options.terminal_weight.discount(self.options.period);
            let entries = a.as_flattened_mut().iter_mut().chain(b.as_flattened_mut());
            entries.for_each(|entry| *entry *= discount);
            let regulator = Lqr::stabilizing(&a, &b, &self.problem.state_weight, &input_weight)
                .map_err(|reason| MpcError::Terminal { time, reason })?;
            if !regulator.is_accurate() && regulator.residual > inaccurate.1 {
                inaccurate = (time, regulator.residual);
            }
            self.terminal.push(regulator);
        }
        let (time, residual) = inaccurate;
        if residual > 0.0 {
            self.notes.push(MpcNote::Terminal { time, residual });
        }
        Ok(())
    }

    /// The zero-order hold at a state of the trajectory. Increases `substeps` to the number of Runge–Kutta steps that
    /// a period needs at this state.
    fn look_at(
        &mut self,
        time: f64,
        y: &[f64; NY],
        v: &[f64; N],
        inputs: &[f64; M],
    ) -> Result<Discretization<N, M, NY>, MpcError> {
        let (period, rest) = (self.options.period, &[0.0; N]);
        let of_time = |fault| match fault {
            ControllerFault::TooFast(what) => MpcError::TooFast { time, what },
            _ => MpcError::NotFinite { time },
        };
        let (needed, discrete) = self.model().at_time(time, |model| {
            let needed = substeps(&model.linearize(y, v, inputs), period);
            // Friction is steepest at rest. The integration must be stable at rest too, because the robot can come to
            // rest at any position.
            let resting = substeps(&model.linearize(y, rest, inputs), period);
            let at_rest = discretize(model, y, rest, inputs, period);
            (needed.max(resting), at_rest.and_then(|_| discretize(model, y, v, inputs, period)))
        });
        self.substeps = self.substeps.max(needed);
        discrete.map_err(of_time)
    }

    pub fn reset(&mut self, positions: &[f64; NY], inputs: &[f64; M]) {
        self.observer.reset(positions, &[0.0; N]);
        self.under_way = *inputs;
        self.drop_plan();
    }

    /// Updates the state estimate with the measurement. Returns the time on the trajectory at which the horizon
    /// begins, and the state at this time.
    ///
    /// # Errors
    /// - [`ControllerFault::Stalled`] after more than `MAX_BRIDGED` periods. The next step continues from this
    ///   measurement.
    /// - [`ControllerFault::Attitude`] for a measured quaternion that is not an attitude.
    /// - [`ControllerFault::NotFinite`] for a time that is not finite.
    pub fn observe(&mut self, cycle: &Cycle<N, M, NY>) -> Result<(f64, Node<N, NY>), ControllerFault> {
        self.time = cycle.time;
        self.take_in(cycle)?;
        let start = self.start_at(cycle.time);
        if !start.is_finite() {
            return Err(ControllerFault::NotFinite);
        }
        let (y, v) = (*self.observer.positions(), *self.observer.velocities());
        if !self.options.delay {
            return Ok((start, Node { positions: y, velocities: v }));
        }
        let mut ahead = (y, v);
        let disturbance = self.observer.disturbance();
        let total: [f64; M] = core::array::from_fn(|i| self.under_way[i] + disturbance[i]);
        let span = self.span(cycle.time);
        for time in span.steps() {
            let step = |model: &D| model.step(&ahead.0, &ahead.1, &total, span.length());
            ahead = self.model().at_time(time, step);
        }
        Ok((start, Node { positions: ahead.0, velocities: ahead.1 }))
    }

    /// Predicts the state and corrects it with the measurement. If the estimate is not finite because of an extreme
    /// measurement, the estimation restarts at the present measurement.
    fn take_in(&mut self, cycle: &Cycle<N, M, NY>) -> Result<(), ControllerFault> {
        let check = |positions| self.model().check_attitudes(positions);
        let attitudes = cycle.positions.as_ref().map_or(Ok(()), check);
        // An invalid measurement counts as missing. The estimate is still predicted.
        let (measured, velocities) = match attitudes {
            Ok(()) => (cycle.positions.as_ref(), cycle.velocities.as_ref()),
            Err(_) => (None, None),
        };
        let (period, substeps) = (self.options.period, self.substeps);
        if let (false, Some(positions)) = (self.observer.is_finite(), measured) {
            self.observer.reset(positions, velocities.unwrap_or(&[0.0; N]));
            self.under_way = cycle.last_inputs;
            return Ok(());
        }
        let acted = if self.options.delay { self.under_way } else { cycle.last_inputs };
        let model = self.feed_forward.model();
        let bridged = cycle.periods.min(MAX_BRIDGED);
        for k in 0..bridged {
            let start = cycle.time - f64::from(bridged - k) * period;
            self.observer.predict_from(start, model, &acted, period, substeps);
        }
        if let Some(positions) = measured {
            self.observer.correct_by(model, positions);
        }
        if let Some(velocities) = velocities {
            self.observer.correct_velocities_by(model, velocities);
        }
        self.under_way = cycle.last_inputs;
        if cycle.periods > MAX_BRIDGED {
            let periods = cycle.periods;
            return Err(ControllerFault::Stalled { periods });
        }
        attitudes.map_err(ControllerFault::Attitude)
    }

    /// Time at which the horizon of a step at `time` begins (s).
    pub fn start_at(&self, time: f64) -> f64 {
        if self.options.delay { time + self.options.period } else { time }
    }

    /// Repeats the computations of [`observe`](Self::observe) and [`solve`](Self::solve) only to warm up the processor
    /// caches. The estimate, the plan and the initial guess of the next QP do not change.
    pub fn rehearse(&mut self, next: &Cycle<N, M, NY>) {
        let span = self.span(next.time - self.options.period);
        let (y, v) = (self.observer.positions(), self.observer.velocities());
        let _ = black_box(integrate(self.model(), y, v, &next.last_inputs, span));
        self.solver.rehearse(&self.problem);
    }

    /// Computes the desired states and the feed-forward of the horizon that begins at `start` (s).
    pub fn look_ahead(&mut self, start: f64) {
        let passed = self.reference.look_ahead(start, &self.trajectory, &self.feed_forward);
        if self.options.linearization == LinearizationPoint::Reference {
            self.problem.stages.rotate_left(passed);
        }
    }

    /// The period that begins at `start` (s).
    fn span(&self, start: f64) -> Span {
        Span { start, period: self.options.period, substeps: self.substeps }
    }

    /// Shifts the plan so that it begins at `start` (s). The end of the plan is filled with the reference and its
    /// feed-forward. Without an earlier plan, the whole plan is filled.
    pub fn shift_plan(&mut self, start: f64) {
        let stages = self.options.horizon;
        let periods = ((start - self.plan.start) / self.options.period).round();
        // After NaN, a jump back or a gap of a whole horizon, nothing of the old plan is kept.
        let kept = if (0.0..=stages as f64).contains(&periods) { stages - periods as usize } else { 0 };
        let moved = stages - kept;
        self.plan.states.copy_within(moved.., 0);
        self.plan.inputs.copy_within(moved.., 0);
        if kept == 0 {
            self.plan.states[0] = self.reference.nodes[0];
        }
        for k in kept..stages {
            self.plan.inputs[k] = self.reference.inputs[k];
            self.plan.states[k + 1] = self.reference.nodes[k + 1];
        }
        self.plan.start = start;
    }

    /// Sets stage `k` of the QP, in deviations from the reference.
    pub fn set_stage(&mut self, k: usize, prediction: &Prediction<'_, N, M, NY>) {
        let (at, u) = &prediction.at;
        let model = self.feed_forward.model();
        let (reference, end) = (&self.reference.nodes[k], &self.reference.nodes[k + 1]);
        let mut affine: [f64; NX] = prediction.next.from(end, model);
        let back: [f64; NX] = reference.from(at, model);
        let stage = &mut self.problem.stages[k];
        if N == NY {
            flat_state(prediction.state, &mut stage.state_matrix);
            flat_input(prediction.input, &mut stage.input_matrix);
        } else {
            // The logarithm of the inverse rotation is the negative logarithm.
            let (before, after) = (core::array::from_fn(|i| -back[i]), core::array::from_fn(|i| affine[i]));
            let (state, input) = in_deviations(prediction, &before, &after, &reference.positions, model);
            flat_state(&state, &mut stage.state_matrix);
            flat_input(&input, &mut stage.input_matrix);
        }
        for i in 0..NX {
            let mut sum = affine[i];
            for j in 0..NX {
                sum += stage.state_matrix[i][j] * back[j];
            }
            for j in 0..M {
                sum += stage.input_matrix[i][j] * (self.reference.inputs[k][j] - u[j]);
            }
            affine[i] = sum;
        }
        stage.affine = affine;
    }

    /// Sets stage `k` of an arm from a zero-order hold whose initial state is the reference.
    pub fn set_stage_from_reference(&mut self, k: usize, held: &Held<N, M>) {
        let (stage, end) = (&mut self.problem.stages[k], &self.reference.nodes[k + 1]);
        let (state, input) = (held.state.as_flattened().as_flattened(), held.input.as_flattened());
        stage.state_matrix.as_flattened_mut().copy_from_slice(state.as_flattened());
        stage.input_matrix.as_flattened_mut().copy_from_slice(input.as_flattened());
        let positions = core::array::from_fn(|i| held.next[0][i]);
        let next = Node { positions, velocities: held.next[1] };
        stage.affine = next.from(end, self.feed_forward.model());
    }

    /// Solves the QP that begins in `state` at `start` (s). The stages must be set.
    pub fn solve(&mut self, start: f64, state: &Node<N, NY>) -> Result<Command<M>, ControllerFault> {
        let disturbance = *self.observer.disturbance();
        self.problem.initial_state = state.from(&self.reference.nodes[0], self.feed_forward.model());
        for i in 0..M {
            self.problem.previous_input[i] = self.under_way[i] + disturbance[i] - self.reference.inputs[0][i];
        }
        self.set_terminal(start);
        self.set_bounds(&disturbance);
        let model = self.feed_forward.model();
        let coordinates = |k: usize| self.reference.nodes[k].coordinates(model);
        let inputs = &self.reference.inputs;
        row::set_sides(&mut self.problem, &self.options.rows, coordinates, inputs, &disturbance);
        let report = self.solve_problem(start);
        let iterations = report.iterations as u32;
        if report.status == QpStatus::Invalid {
            return Err(self.refuse(ControllerFault::NoSolution { iterations }));
        }
        self.keep_plan(start, state, &disturbance);
        // The plan is rejected if numbers overflow because the state is far away, for every status of the solver.
        let inputs = (0..self.options.horizon).all(|k| finite(&self.input(k)));
        if !inputs || !self.plan.is_finite() {
            return Err(self.refuse(ControllerFault::NotFinite));
        }
        Ok(Command { inputs: self.input(0), iterations })
    }

    /// Solves the QP with a warm start from the last solution, shifted by the number of periods since then. If this
    /// number is K (the horizon) or more, the start is cold.
    fn solve_problem(&mut self, start: f64) -> QpReport {
        let periods = ((start - self.solved) / self.options.period).round();
        self.solved = start;
        // NaN is not in the range either.
        if !(0.0..self.options.horizon as f64).contains(&periods) {
            return self.solver.solve(&self.problem);
        }
        for _ in 0..periods as usize {
            self.solver.shift();
        }
        self.solver.solve_warm(&self.problem)
    }

    pub fn drop_plan(&mut self) {
        (self.plan.start, self.solved) = (f64::NAN, f64::NAN);
    }

    /// Drops the plan. Returns `fault` if the data of the QP are finite, and `NotFinite` otherwise.
    fn refuse(&mut self, fault: ControllerFault) -> ControllerFault {
        self.drop_plan();
        let stages = self.problem.stages.iter().all(|stage| {
            finite(stage.state_matrix.as_flattened())
                && finite(stage.input_matrix.as_flattened())
                && finite(&stage.affine)
        });
        if stages && finite(&self.problem.initial_state) && finite(&self.problem.previous_input) {
            fault
        } else {
            ControllerFault::NotFinite
        }
    }

    fn set_bounds(&mut self, disturbance: &[f64; M]) {
        let (options, model) = (&self.options, self.feed_forward.model());
        let rate = self.problem.input_rate_weight;
        let change = |k: usize, i: usize| {
            if (1..options.horizon).contains(&k) {
                rate[i][i] * (self.reference.inputs[k][i] - self.reference.inputs[k - 1][i])
            } else {
                0.0
            }
        };
        let gain = &self.terminal[self.regulator].gain;
        let mut margins = Margins::new();
        let (mut of_inputs, mut of_states) = ([0.0; M], [0.0; NX]);
        for (k, stage) in self.problem.stages.iter_mut().enumerate() {
            if self.deviations > 0.0 {
                let Node { positions, velocities } = &self.reference.nodes[k];
                let by_friction = model.friction_uncertainty(positions, velocities);
                (of_inputs, of_states) = margins.advance(stage, gain, &by_friction);
            }
            let QpStage { input_lower, input_upper, state_lower, state_upper, input_gradient, .. } = stage;
            for i in 0..M {
                let offset = disturbance[i] - self.reference.inputs[k][i];
                let limits = narrowed(options.input_limits[i], self.deviations * of_inputs[i]);
                [input_lower[i], input_upper[i]] = limits.map(|b| b + offset);
                input_gradient[i] = change(k, i) - change(k + 1, i);
            }
            let reference: [f64; NX] = self.reference.nodes[k + 1].coordinates(model);
            for i in 0..N {
                let speed = options.velocity_limits[i];
                for (entry, limits) in [(i, options.position_limits[i]), (N + i, [-speed, speed])] {
                    let limits = narrowed(limits, self.deviations * of_states[entry]);
                    [state_lower[entry], state_upper[entry]] = limits.map(|b| b - reference[entry]);
                }
            }
        }
    }

    /// Sets the terminal weight and the gain whose time is nearest to the end of the horizon.
    fn set_terminal(&mut self, start: f64) {
        let end = start + self.options.horizon as f64 * self.options.period;
        let share = (end / self.trajectory.duration()).clamp(0.0, 1.0);
        // If the trajectory has the duration 0, the share is NaN, and the conversion gives the index 0.
        let index = (share * TERMINAL_INTERVALS as f64).round() as usize;
        self.regulator = index.min(TERMINAL_INTERVALS);
        self.problem.terminal_weight = self.terminal[self.regulator].cost_to_go;
    }

    fn keep_plan(&mut self, start: f64, state: &Node<N, NY>, disturbance: &[f64; M]) {
        self.plan.start = start;
        self.plan.disturbance = *disturbance;
        self.plan.states[0] = *state;
        for k in 0..self.options.horizon {
            let (input, next) = (self.solver.input(k), self.solver.state(k + 1));
            self.plan.inputs[k] = core::array::from_fn(|i| self.reference.inputs[k][i] + input[i]);
            self.plan.states[k + 1] = self.reference.nodes[k + 1].moved(&next, self.feed_forward.model());
        }
    }

    /// Input of period `k` of the plan, clamped to the input limits.
    fn input(&self, k: usize) -> [f64; M] {
        core::array::from_fn(|i| {
            let [low, high] = self.options.input_limits[i];
            (self.plan.inputs[k][i] - self.plan.disturbance[i]).clamp(low, high)
        })
    }

    pub fn planned(&self, periods: u32) -> Option<[f64; M]> {
        let k = usize::try_from(periods).ok()?;
        let exists = self.plan.start.is_finite() && k < self.options.horizon;
        exists.then(|| self.input(k))
    }

    pub fn estimate(&self) -> Estimate<N, NY> {
        Estimate { positions: *self.observer.positions(), velocities: *self.observer.velocities() }
    }

    /// State `k` of the plan and input `u + d` of period `k`, with the input disturbance d.
    pub fn planned_point(&self, k: usize) -> (Node<N, NY>, [f64; M]) {
        (self.plan.states[k], self.plan.inputs[k])
    }
}

fn finite(values: &[f64]) -> bool {
    values.iter().all(|x| x.is_finite())
}
