//! A controller whose model includes the learned friction.

use super::model::LearnedFriction;
use crate::control_loop::{
    Command, Controller, ControllerFault, Cycle, Estimate, FeedForwardPd, LearnedJoint,
};
use crate::dynamics::Dynamics;
use crate::feed_forward::FeedForwardError;
#[cfg(feature = "std")]
use crate::mpc::{LtvMpc, Nmpc};
use crate::trajectory::Trajectory;
use gelenk_adaptation::{Adaptation, AdaptationError, AdaptationSettings, DescribedForces, Measured};

/// A controller whose model can be replaced without a restart.
pub trait TakesModel<D> {
    /// Replaces the model from the next step on. The state estimate and the plan of the controller are kept.
    /// Does not allocate if the input matrix is unchanged.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`] if the new input matrix cannot be used. The controller then keeps the
    /// old model.
    fn take_model(&mut self, model: D) -> Result<(), FeedForwardError>;
}

macro_rules! takes_model {
    ($($controller:ident),*) => {$(
        #[cfg(feature = "std")]
        impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize> TakesModel<D>
            for $controller<D, T, N, M, NX, NR>
        where
            D: crate::dynamics::Discretizable<N, M>,
            T: Trajectory<N>,
        {
            fn take_model(&mut self, model: D) -> Result<(), FeedForwardError> {
                self.set_model(model)
            }
        }
    )*};
}
takes_model!(LtvMpc, Nmpc);

impl<D: Dynamics<N, M>, R: Trajectory<N>, const N: usize, const M: usize> TakesModel<D>
    for FeedForwardPd<D, R, N, M>
{
    fn take_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        self.law_mut().set_model(model)
    }
}

/// Source of the joint torques from which friction is learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TorqueSource {
    /// The torques `B u`, with the input matrix B and the inputs u that the loop wrote.
    #[default]
    Inputs,
    /// The torques that the robot measures. The mean of the values at both ends of a period is used. Periods
    /// without measured torques are skipped.
    Measured,
}

/// A wrapper that learns friction during motion and updates the model of the wrapped (inner) controller.
///
/// In each step, the estimator first processes the last measurement. The model of the inner controller then
/// gets the acting friction laws, and the inner controller computes the inputs. The acting laws follow the
/// learned laws with the time constant [`AdaptationSettings::blending`], so the inputs do not jump.
///
/// ```
/// use gelenk_runtime::adaptation::{AdaptationSettings, Adaptive};
/// use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
/// use gelenk_runtime::trajectory::RestToRest;
///
/// gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// let motion = RestToRest::new([0.0, 0.0], [0.2, -0.1], 1.0)?;
/// let adaptive = Adaptive::new(PowerCube, AdaptationSettings::new(0.02), |robot| {
///     let options = MpcOptions::new(&robot, 0.02, 20);
///     LtvMpc::new(robot, motion, options)
/// })??;
/// assert!(adaptive.adaptation().states()[0].is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Adaptive<C, D, const N: usize, const M: usize> {
    inner: C,
    robot: LearnedFriction<D, N, M>,
    adaptation: Adaptation<N>,
    source: TorqueSource,
    /// Last measured torques.
    measured: Option<[f64; N]>,
    matrix: [[f64; M]; N],
    limits: [[f64; 2]; M],
}

impl<C, D: Dynamics<N, M> + Clone, const N: usize, const M: usize> Adaptive<C, D, N, M> {
    /// Constructs the estimator for `robot`, and the inner controller. `make` returns the inner controller for the
    /// model of the robot with learned friction.
    ///
    /// # Errors
    /// - The outer error is an [`AdaptationError`] if friction of this robot cannot be learned.
    /// - The inner error is the error of `make`.
    pub fn new<E>(
        robot: D,
        settings: AdaptationSettings,
        make: impl FnOnce(LearnedFriction<D, N, M>) -> Result<C, E>,
    ) -> Result<Result<Self, E>, AdaptationError> {
        let adaptation = Adaptation::for_robot(&robot, settings)?;
        let (matrix, limits) = (robot.drive_matrix(), robot.input_limits().peak);
        let robot = LearnedFriction::new(robot, &adaptation)?;
        let source = TorqueSource::default();
        let measured = None;
        Ok(make(robot.clone()).map(|inner| Self {
            inner,
            robot,
            adaptation,
            source,
            measured,
            matrix,
            limits,
        }))
    }

    /// Sets the source of the joint torques from which friction is learned. The default is
    /// [`TorqueSource::Inputs`].
    #[must_use]
    pub fn with_torques(self, source: TorqueSource) -> Self {
        Self { source, ..self }
    }

    /// The friction estimator.
    pub fn adaptation(&self) -> &Adaptation<N> {
        &self.adaptation
    }

    /// The friction estimator as a mutable reference, for example to restore saved laws.
    pub fn adaptation_mut(&mut self) -> &mut Adaptation<N> {
        &mut self.adaptation
    }

    /// The inner controller.
    pub fn inner(&self) -> &C {
        &self.inner
    }

    /// The inner controller as a mutable reference. A direct call of its `step` does not update the friction
    /// estimator.
    pub fn inner_mut(&mut self) -> &mut C {
        &mut self.inner
    }

    /// The model of the robot with the acting friction laws.
    #[must_use]
    pub fn robot(&self) -> LearnedFriction<D, N, M> {
        self.robot.clone().with_laws(&self.adaptation)
    }

    /// Replaces the described robot; friction and input matrix must be the same.
    pub(super) fn set_robot(&mut self, robot: D) {
        self.robot.set_robot(robot);
    }

    /// Mean of the measured torques at both ends of the last period.
    fn mean_torques(&mut self, cycle: &Cycle<N, M>) -> Option<[f64; N]> {
        let now = cycle.torques?;
        let before = self.measured.replace(now).unwrap_or(now);
        Some(core::array::from_fn(|i| 0.5 * (before[i] + now[i])))
    }

    /// Passes the last measurement to the estimator. Returns positions, velocities and accelerations at which the
    /// estimator requested the described forces; `None` if it did not request them.
    pub(super) fn learn(&mut self, cycle: &Cycle<N, M>) -> Option<[[f64; N]; 3]> {
        let of_inputs = |row: &[f64; M]| row.iter().zip(&cycle.last_inputs).map(|(b, u)| b * u).sum();
        let torques = match self.source {
            TorqueSource::Inputs => Some(self.matrix.each_ref().map(of_inputs)),
            TorqueSource::Measured => self.mean_torques(cycle),
        };
        let at_limit = |j: usize| {
            let [low, high] = self.limits[j];
            cycle.last_inputs[j] <= low || cycle.last_inputs[j] >= high
        };
        let measured = Measured {
            positions: cycle.positions.filter(|_| torques.is_some()),
            torques: torques.unwrap_or([0.0; N]),
            saturated: core::array::from_fn(|i| (0..M).any(|j| self.matrix[i][j] != 0.0 && at_limit(j))),
            periods: cycle.periods,
        };
        let robot = self.robot.robot();
        let mut motion = None;
        self.adaptation.step(&measured, |y, v, a| {
            motion = Some([*y, *v, *a]);
            DescribedForces::of(robot, y, v, a)
        });
        motion
    }
}

impl<C, D, const N: usize, const M: usize> Adaptive<C, D, N, M>
where
    D: Dynamics<N, M> + Clone,
    C: Controller<N, M> + TakesModel<LearnedFriction<D, N, M>>,
{
    /// Computes a step of the inner controller with the acting laws.
    pub(super) fn control(&mut self, cycle: &Cycle<N, M>) -> Result<Command<M>, ControllerFault> {
        self.inner.take_model(self.robot()).map_err(|_| ControllerFault::NotFinite)?;
        self.inner.step(cycle)
    }
}

impl<C, D, const N: usize, const M: usize> Controller<N, M> for Adaptive<C, D, N, M>
where
    D: Dynamics<N, M> + Clone,
    C: Controller<N, M> + TakesModel<LearnedFriction<D, N, M>>,
{
    fn reset(&mut self, positions: &[f64; N], inputs: &[f64; M]) {
        self.adaptation.restart();
        self.measured = None;
        self.inner.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<N, M>) -> Result<Command<M>, ControllerFault> {
        self.learn(cycle);
        self.control(cycle)
    }

    fn planned(&self, periods: u32) -> Option<[f64; M]> {
        self.inner.planned(periods)
    }

    fn estimate(&self) -> Option<Estimate<N>> {
        self.inner.estimate()
    }

    fn learned(&self, y: &[f64; N], v: &[f64; N]) -> [Option<LearnedJoint>; N] {
        let (described, states) = (self.robot.robot().friction_torques(y, v), self.adaptation.states());
        let friction = |i: usize| self.adaptation.friction(i, described[i], v[i]);
        core::array::from_fn(|i| Some(LearnedJoint { friction: friction(i)?, state: states[i]? }))
    }

    fn warm_up(&mut self, next: &Cycle<N, M>) {
        self.inner.warm_up(next);
    }
}
