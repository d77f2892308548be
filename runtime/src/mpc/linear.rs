//! Linear time-varying model predictive control.

use super::delegation::{delegated_controller_methods, delegated_methods};
use super::error::MpcError;
use super::horizon::Horizon;
use super::integrate::midpoint;
use super::node::{Node, Prediction};
use super::options::{LinearizationPoint, MpcOptions, PredictionRule};
use crate::control_loop::zero_order_hold::too_fast;
use crate::control_loop::{Command, Controller, ControllerFault, Cycle};
use crate::dynamics::{Discretizable, Linearization, PhaseSpace, Point};
use crate::feed_forward::FeedForwardError;
use crate::lanes::batch::{Case, Held};
use crate::lanes::{ZeroOrderHolds, instructions};
use crate::qp::lanes::WIDTH;
use crate::trajectory::{Sample, Trajectory};

/// Linear time-varying MPC. The [module](super) documents the equations.
///
/// The robot is linearized in the middle of each period of the horizon, around the previous plan or around the
/// desired trajectory with its feed-forward ([`MpcOptions::linearization`]). The prediction over a period is the
/// exact zero-order hold of this linearization, or a step of the implicit midpoint rule ([`PredictionRule`]).
///
/// ```
/// use gelenk_runtime::control_loop::{Controller, Cycle};
/// use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
/// use gelenk_runtime::trajectory::RestToRest;
///
/// gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// let motion = RestToRest::new([0.0, 0.0], [0.3, 0.4], 2.0)?;
/// let options = MpcOptions::new(&PowerCube, 0.02, 20);
/// let mut mpc = LtvMpc::new(PowerCube, motion, options)?;
/// mpc.reset(&[0.0; 2], &[0.0; 2]);
/// let cycle = Cycle { periods: 0, positions: Some([0.0; 2]), ..Cycle::default() };
/// let command = mpc.step(&cycle)?;
/// assert!(command.inputs.iter().all(|u| u.abs() <= 0.5), "the motor's peak torque");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LtvMpc<
    D,
    T,
    const N: usize,
    const M: usize,
    const NX: usize,
    const NR: usize = 0,
    const NY: usize = N,
> {
    horizon: Horizon<D, T, N, M, NX, NR, NY>,
    memory: Memory<N, M, NY>,
}

/// Memory for stages that are computed together.
#[derive(Debug, Clone)]
struct Memory<const N: usize, const M: usize, const NY: usize> {
    stages: Vec<usize>,
    points: Vec<Point<N, M, NY>>,
    linear: Vec<Linearization<N, M, NY>>,
    cases: Vec<Case<N, M>>,
    holds: ZeroOrderHolds<N, M>,
}

impl<const N: usize, const M: usize, const NY: usize> Memory<N, M, NY> {
    fn new(stages: usize) -> Self {
        Self {
            stages: Vec::with_capacity(stages),
            points: Vec::with_capacity(stages),
            linear: vec![Linearization::ZERO; stages],
            cases: vec![Case::ZERO; WIDTH],
            holds: ZeroOrderHolds::new(),
        }
    }
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    LtvMpc<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    /// Constructs a controller of `model` along `trajectory`. Allocates all memory and computes all terminal weights.
    ///
    /// # Errors
    /// [`MpcError`] with the reason why the controller cannot be constructed.
    pub fn new(model: D, trajectory: T, options: MpcOptions<N, M, NR>) -> Result<Self, MpcError>
    where
        D: PhaseSpace<NX>,
    {
        let mut horizon = Horizon::new(model, trajectory, options)?;
        if horizon.options.prediction == PredictionRule::ImplicitMidpoint {
            horizon.note_alternating();
        }
        Ok(Self { memory: Memory::new(horizon.options.horizon), horizon })
    }

    delegated_methods!();

    /// Replaces the model from the next step on, for example by a model with friction that was identified in
    /// operation. The estimate and the plan are kept. The terminal weights are kept too, because they represent the
    /// time after the horizon and depend little on friction. Does not allocate if the input matrix is unchanged.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`] if the input matrix cannot be used. The old model is then kept.
    pub fn set_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        self.horizon.set_model(model)
    }

    /// Linearizes and discretizes the horizon that begins at `start` (s).
    fn predict(&mut self, start: f64) -> Result<(), ControllerFault> {
        if self.horizon.options.linearization == LinearizationPoint::Plan {
            self.horizon.shift_plan(start);
        }
        let set = self.set_stages();
        if set.is_err() {
            self.horizon.drop_plan();
        }
        set
    }

    /// Sets all stages that are not kept from the previous period. If the robot is linearized around the plan, no stage
    /// is kept.
    fn set_stages(&mut self) -> Result<(), ControllerFault> {
        if self.horizon.options.prediction == PredictionRule::ExactHold {
            return self.set_held_stages();
        }
        for k in 0..self.horizon.options.horizon {
            if !self.horizon.reference.is_set[k] {
                self.set_midpoint_stage(k)?;
                self.horizon.mark_set(k);
            }
        }
        Ok(())
    }

    /// Sets the stages by the exact zero-order hold. All stages are linearized first. Then several holds are computed
    /// at a time.
    fn set_held_stages(&mut self) -> Result<(), ControllerFault> {
        let (horizon, Memory { stages, points, linear, cases, holds }) =
            (&mut self.horizon, &mut self.memory);
        stages.clear();
        stages.extend((0..horizon.options.horizon).filter(|k| !horizon.reference.is_set[*k]));
        points.clear();
        points.extend(stages.iter().map(|k| horizon.middle(*k)));
        horizon.model().linearize_along(instructions(), points, linear);
        for (group, stages) in stages.chunks(WIDTH).enumerate() {
            let (points, linear) = (&points[WIDTH * group..], &linear[WIDTH * group..]);
            for (lane, k) in stages.iter().enumerate() {
                cases[lane].set_robot(&linear[lane]);
                horizon.begin(*k, &points[lane], &mut cases[lane]);
            }
            let held = holds.hold(&cases[..stages.len()], N != NY, horizon.options.period);
            for (lane, k) in stages.iter().enumerate() {
                if !held[lane].is_finite {
                    return Err(horizon.too_fast(&points[lane]));
                }
                horizon.set_held_stage(*k, &points[lane], &held[lane]);
                horizon.mark_set(*k);
            }
        }
        Ok(())
    }

    /// Sets stage `k` by the implicit midpoint rule.
    fn set_midpoint_stage(&mut self, k: usize) -> Result<(), ControllerFault> {
        let (horizon, period) = (&self.horizon, self.horizon.options.period);
        let (at, a, u) = match horizon.options.linearization {
            LinearizationPoint::Plan => {
                let ((at, u), next) = (horizon.planned_point(k), &horizon.plan.states[k + 1]);
                let a = core::array::from_fn(|i| (next.velocities[i] - at.velocities[i]) / period);
                (at, a, u)
            }
            LinearizationPoint::Reference => {
                let middle = &horizon.reference.middles[k];
                let back = middle.velocities.map(|v| -0.5 * period * v);
                let positions = horizon.model().integrate(&middle.positions, &back);
                let before = |i: usize| middle.velocities[i] - 0.5 * period * middle.accelerations[i];
                let velocities = core::array::from_fn(before);
                (Node { positions, velocities }, middle.accelerations, horizon.reference.inputs[k])
            }
        };
        let time = horizon.reference.middle_time(k);
        let step = |model: &D| midpoint(model, &at.positions, &at.velocities, &a, &u, period);
        let step = horizon.model().at_time(time, step)?;
        let prediction = Prediction {
            state: &step.state,
            input: &step.input,
            next: Node { positions: step.coordinates, velocities: step.velocities },
            at: (at, u),
        };
        self.horizon.set_stage(k, &prediction);
        Ok(())
    }
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Horizon<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    /// The point around which stage `k` is linearized.
    fn middle(&self, k: usize) -> Point<N, M, NY> {
        let time = self.reference.middle_time(k);
        match self.options.linearization {
            LinearizationPoint::Plan => {
                let (at, inputs) = self.planned_point(k);
                let Node { positions, velocities } = at.middle(&self.plan.states[k + 1], self.model());
                Point { time, positions, velocities, inputs }
            }
            LinearizationPoint::Reference => {
                let Sample { positions, velocities, .. } = self.reference.middles[k];
                Point { time, positions, velocities, inputs: self.reference.inputs[k] }
            }
        }
    }

    /// Sets the state at which the hold of stage `k` begins. For an arm it is the reference. For a robot with
    /// quaternions it is the point of linearization.
    fn begin(&self, k: usize, point: &Point<N, M, NY>, case: &mut Case<N, M>) {
        if N != NY {
            case.drift = self.model().drift(&point.velocities);
            (case.state, case.input) = ([[0.0; N], point.velocities], point.inputs);
            return;
        }
        let Node { positions, velocities } = &self.reference.nodes[k];
        case.state = [core::array::from_fn(|i| positions[i]), *velocities];
        case.input = self.reference.inputs[k];
    }

    fn set_held_stage(&mut self, k: usize, point: &Point<N, M, NY>, held: &Held<N, M>) {
        if N == NY {
            return self.set_stage_from_reference(k, held);
        }
        let Point { positions, velocities, inputs, .. } = *point;
        let next =
            Node { positions: self.model().integrate(&positions, &held.next[0]), velocities: held.next[1] };
        let at = (Node { positions, velocities }, inputs);
        self.set_stage(k, &Prediction { state: &held.blocks(), input: &held.input, next, at });
    }

    fn too_fast(&self, Point { time, positions, velocities, inputs }: &Point<N, M, NY>) -> ControllerFault {
        let fault = |model: &D| too_fast(model, positions, velocities, inputs, self.options.period);
        self.model().at_time(*time, fault)
    }

    /// Marks stage `k` as set. If the robot is linearized around the reference, the next period can use this stage too.
    fn mark_set(&mut self, k: usize) {
        self.reference.is_set[k] = self.options.linearization == LinearizationPoint::Reference;
    }
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Controller<N, M, NY> for LtvMpc<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    fn reset(&mut self, positions: &[f64; NY], inputs: &[f64; M]) {
        self.horizon.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault> {
        let (start, state) = self.horizon.observe(cycle)?;
        self.horizon.look_ahead(start);
        self.predict(start)?;
        self.horizon.solve(start, &state)
    }

    delegated_controller_methods!();

    /// Computes reference, stages and solution in advance. The next step computes them again, or keeps stages that are
    /// equal. Estimate and plan do not change.
    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        let start = self.horizon.start_at(next.time);
        self.horizon.look_ahead(start);
        // An error is ignored here, because the step has the same error and reports it.
        if self.set_stages().is_ok() {
            self.horizon.rehearse(next);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "test code")]

    use super::*;
    use crate::dynamics::LimitRows;
    use crate::trajectory::{GeodesicMotion, RestToRest};
    use std::cell::Cell;

    gelenk_dynamics::dynamics!(struct Ur5 = gelenk_generated::ur5);
    gelenk_dynamics::dynamics!(struct Quadrotor = gelenk_generated::quadrotor);

    /// Repeats steps from one measurement. This is Newton's method, so the plan converges to a motion that satisfies the
    /// implicit midpoint rule.
    fn converge<D, T, const N: usize, const M: usize, const NX: usize, const NY: usize>(model: D, motion: T)
    where
        D: Discretizable<N, M, NY> + PhaseSpace<NX> + LimitRows<0>,
        T: Trajectory<N, NY>,
    {
        let period = 0.02;
        let mut options = MpcOptions::new(&model, period, 8);
        options.prediction = PredictionRule::ImplicitMidpoint;
        options.observer.disturbance_noise = [0.0; M];
        let start = motion.sample(0.3);
        let mut mpc = LtvMpc::<D, T, N, M, NX, 0, NY>::new(model, motion, options).unwrap();
        mpc.reset(&mpc.model().integrate(&start.positions, &[0.01; N]), &[0.0; M]);
        for _ in 0..12 {
            let cycle = Cycle { time: 0.3, periods: 0, ..Cycle::default() };
            mpc.step(&cycle).unwrap();
        }
        let model = mpc.model();
        for k in 0..8 {
            let (at, u) = mpc.horizon.planned_point(k);
            let next = mpc.horizon.plan.states[k + 1];
            let mean = core::array::from_fn(|i| 0.5 * (at.velocities[i] + next.velocities[i]));
            let a = core::array::from_fn(|i| (next.velocities[i] - at.velocities[i]) / period);
            let middle = model.integrate(&at.positions, &mean.map(|v| 0.5 * period * v));
            let forces = model.inverse_dynamics(&middle, &mean, &a);
            let matrix = model.input_matrix(&middle);
            let end = model.integrate(&at.positions, &mean.map(|v| period * v));
            let gap = model.difference(&next.positions, &end);
            for i in 0..N {
                let of_inputs: f64 = matrix[i].iter().zip(&u).map(|(b, u)| b * u).sum();
                let lacking = (forces[i] - of_inputs).abs();
                assert!(lacking <= 1e-7 * (1.0 + forces[i].abs()), "stage {k}: {lacking} N m are lacking");
                assert!(gap[i].abs() <= 1e-9, "stage {k}: gap {gap:?}");
            }
        }
    }

    #[test]
    fn plans_become_motions_of_the_midpoint_rule() {
        let goal = [1.0, -0.6, 1.6, -1.2, 1.0, 0.8];
        converge(Ur5, RestToRest::new([0.0, -1.2, 1.0, -0.5, 0.5, 0.0], goal, 1.5).unwrap());
        let (start, goal) = ([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], [1.5, -0.5, 1.4, 0.0, 0.0, 0.6, 0.8]);
        converge(Quadrotor, GeodesicMotion::between(Quadrotor, start, goal, 3.0).unwrap());
    }

    /// A trajectory that can switch between two motions.
    struct Changing<'a>(&'a Cell<usize>, [RestToRest<6>; 2]);

    impl Trajectory<6> for Changing<'_> {
        fn duration(&self) -> f64 {
            1.5
        }

        fn sample(&self, t: f64) -> Sample<6> {
            self.1[self.0.get()].sample(t)
        }
    }

    /// The period is 2⁻⁶ s, so all times are exact. Kept stages then equal newly computed stages bit for bit.
    #[test]
    fn stages_around_the_reference_are_kept_until_it_changes() {
        const PERIOD: f64 = 0.015625;
        let start = [0.0, -1.2, 1.0, -0.5, 0.5, 0.0];
        let goals = [[1.0, -0.6, 1.6, -1.2, 1.0, 0.8], [0.4, -0.9, 1.2, -0.2, 0.1, -0.3]];
        let motions = || goals.map(|goal| RestToRest::new(start, goal, 1.5).unwrap());
        for prediction in [PredictionRule::ExactHold, PredictionRule::ImplicitMidpoint] {
            let which = Cell::new(0);
            let linearization = LinearizationPoint::Reference;
            let options =
                MpcOptions { prediction, linearization, ..MpcOptions::<6, 6>::new(&Ur5, PERIOD, 8) };
            let make =
                || LtvMpc::<_, _, 6, 6, 12>::new(Ur5, Changing(&which, motions()), options.clone()).unwrap();
            let (mut keeping, mut forgetting) = (make(), make());
            let mut last_inputs = [0.0; 6];
            for k in 0_u32..12 {
                which.set((k / 6) as usize);
                let time = f64::from(k) * PERIOD;
                let positions = Some(motions()[0].sample(time).positions.map(|y| y + 0.01));
                let cycle =
                    Cycle { time, periods: u32::from(k > 0), positions, last_inputs, ..Cycle::default() };
                forgetting.horizon.reference.forget();
                last_inputs = keeping.step(&cycle).unwrap().inputs;
                assert_eq!(last_inputs, forgetting.step(&cycle).unwrap().inputs, "period {k}");
            }
            keeping.horizon.look_ahead(12.0 * PERIOD);
            let is_set = &keeping.horizon.reference.is_set;
            assert_eq!(is_set.iter().filter(|is_set| **is_set).count(), 7, "all but the last one");
        }
    }
}
