//! A controller whose model includes a learned load.

use super::controller::{Adaptive, TakesModel};
use super::model::LearnedFriction;
use crate::control_loop::{Command, Controller, ControllerFault, Cycle, Estimate, LearnedJoint};
use crate::dynamics::Dynamics;
use gelenk_adaptation::{AdaptationError, LoadEstimator};

/// A controller that learns friction and P parameters of a load during motion.
///
/// The joint torques of the model must be linear in the load parameters, for example in the mass at the tool.
/// The regressor of [`LoadEstimator`] is the change of the inverse dynamics for a unit of each parameter. Its
/// computation needs P + 1 evaluations of the inverse dynamics per period. Before each step of the inner
/// controller, its model gets the [acting](LoadEstimator::acting) load parameters.
#[derive(Debug, Clone)]
pub struct Carrying<C, D, const N: usize, const M: usize, const P: usize> {
    adaptive: Adaptive<C, D, N, M>,
    load: LoadEstimator<N, P>,
    empty: D,
    loaded: fn(&D, &[f64; P]) -> D,
}

impl<C, D: Dynamics<N, M> + Clone, const N: usize, const M: usize, const P: usize> Carrying<C, D, N, M, P> {
    /// Constructs a controller that learns a load, from a controller that learns friction.
    ///
    /// - `bounds`: smallest and largest value of each parameter, with 0 between them
    /// - `loaded`: function that returns the model of the robot with load. Its arguments are the robot without
    ///   load and the load parameters. Friction and input matrix must not depend on the load.
    ///
    /// # Errors
    /// [`AdaptationError::Load`] if bounds are not finite or 0 is not between them.
    pub fn new(
        adaptive: Adaptive<C, D, N, M>,
        bounds: [[f64; 2]; P],
        loaded: fn(&D, &[f64; P]) -> D,
    ) -> Result<Self, AdaptationError> {
        let empty = adaptive.robot().robot().clone();
        Ok(Self { adaptive, load: LoadEstimator::new(bounds)?, empty, loaded })
    }

    /// The controller that learns friction.
    pub fn adaptive(&self) -> &Adaptive<C, D, N, M> {
        &self.adaptive
    }

    /// The estimator of the load.
    pub fn load(&self) -> &LoadEstimator<N, P> {
        &self.load
    }

    /// Joint torques per unit of each load parameter.
    fn columns(&self, [y, v, a]: &[[f64; N]; 3]) -> [[f64; P]; N] {
        let of_load = |load: &[f64; P]| (self.loaded)(&self.empty, load).inverse_dynamics(y, v, a);
        let empty = of_load(&[0.0; P]);
        let units: [[f64; N]; P] =
            core::array::from_fn(|k| of_load(&core::array::from_fn(|l| f64::from(u8::from(l == k)))));
        core::array::from_fn(|i| core::array::from_fn(|k| units[k][i] - empty[i]))
    }
}

impl<C, D, const N: usize, const M: usize, const P: usize> Controller<N, M> for Carrying<C, D, N, M, P>
where
    D: Dynamics<N, M> + Clone,
    C: Controller<N, M> + TakesModel<LearnedFriction<D, N, M>>,
{
    fn reset(&mut self, positions: &[f64; N], inputs: &[f64; M]) {
        self.adaptive.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<N, M>) -> Result<Command<M>, ControllerFault> {
        let columns = self.adaptive.learn(cycle).map(|motion| self.columns(&motion));
        self.load.step(columns.as_ref(), self.adaptive.adaptation());
        self.adaptive.set_robot((self.loaded)(&self.empty, self.load.acting()));
        self.adaptive.control(cycle)
    }

    fn planned(&self, periods: u32) -> Option<[f64; M]> {
        self.adaptive.planned(periods)
    }

    fn estimate(&self) -> Option<Estimate<N>> {
        self.adaptive.estimate()
    }

    fn learned(&self, y: &[f64; N], v: &[f64; N]) -> [Option<LearnedJoint>; N] {
        self.adaptive.learned(y, v)
    }

    fn warm_up(&mut self, next: &Cycle<N, M>) {
        self.adaptive.warm_up(next);
    }
}
