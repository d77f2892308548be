//! Controller that follows a trajectory with a feedback law.

use super::controller::{Command, Controller, ControllerFault, Cycle, Estimate};
use super::joint_pd::JointPd;
use super::law::JointLaw;
use super::settings::{SettingError, require};
use super::unwrapped::Unwrapped;
use super::velocity_filter::VelocityFilter;
use crate::trajectory::Trajectory;
use core::hint::black_box;

/// Controller that follows a trajectory with a [`JointLaw`]. The law gets the measured velocities. If velocities
/// are not measured, it gets filtered differences of positions ([`VelocityFilter`]). A step without a
/// measurement fails.
#[derive(Debug, Clone)]
pub struct LawController<L, R, const N: usize, const M: usize, const NY: usize = N> {
    law: L,
    trajectory: R,
    period: f64,
    time_constant: f64,
    filter: VelocityFilter<N>,
    /// Last positions of the filter.
    last: Unwrapped<N, NY>,
    /// Periods since the last measurement.
    age: u32,
}

/// Controller with [`JointPd`] along a trajectory.
pub type FeedForwardPd<D, R, const N: usize, const M: usize, const NY: usize = N> =
    LawController<JointPd<D, N, M, NY>, R, N, M, NY>;

impl<L, R, const N: usize, const M: usize, const NY: usize> LawController<L, R, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
{
    /// A controller with this period (s). If velocities are not measured, they are estimated by a filter with the
    /// time constant `time_constant` (s).
    ///
    /// # Errors
    /// [`SettingError`] for a period that is not positive and finite, or a time constant outside 0 to 60 s.
    pub fn new(law: L, trajectory: R, period: f64, time_constant: f64) -> Result<Self, SettingError> {
        require("period", period, "positive and finite", |x| x.is_finite() && x > 0.0)?;
        require("time_constant", time_constant, "0 to 60 s", |x| (0.0..=60.0).contains(&x))?;
        let start = Unwrapped::at(trajectory.sample(0.0).positions, &law);
        Ok(Self {
            law,
            trajectory,
            period,
            time_constant,
            filter: VelocityFilter::new(time_constant, start.coordinates),
            last: start,
            age: 0,
        })
    }

    /// The law, for example to change its model during the motion.
    pub fn law_mut(&mut self) -> &mut L {
        &mut self.law
    }
}

impl<L, R, const N: usize, const M: usize, const NY: usize> Controller<N, M, NY>
    for LawController<L, R, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
{
    fn reset(&mut self, positions: &[f64; NY], _: &[f64; M]) {
        self.last = Unwrapped::at(*positions, &self.law);
        self.filter = VelocityFilter::new(self.time_constant, self.last.coordinates);
        self.age = 0;
    }

    fn step(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault> {
        self.age = self.age.saturating_add(cycle.periods);
        let positions = cycle.positions.ok_or(ControllerFault::NoMeasurement)?;
        self.law.check_attitudes(&positions).map_err(ControllerFault::Attitude)?;
        let span = f64::from(self.age.max(1)) * self.period;
        let moved = self.last.moved_to(&positions, &self.law);
        let taken = match &cycle.velocities {
            Some(velocities) => self.filter.update_measured(&moved.coordinates, velocities),
            None => self.filter.update(&moved.coordinates, span),
        };
        if !taken {
            return Err(ControllerFault::NotFinite);
        }
        self.last = moved;
        self.age = 0;
        let desired = self.trajectory.sample(cycle.time);
        let inputs = self.law.inputs_at_time(cycle.time, &desired, &positions, self.filter.velocities())?;
        Ok(Command { inputs, iterations: 0 })
    }

    fn estimate(&self) -> Option<Estimate<N, NY>> {
        Some(Estimate { positions: self.last.positions, velocities: *self.filter.velocities() })
    }

    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        let desired = self.trajectory.sample(next.time);
        let (y, v) = (&self.last.positions, self.filter.velocities());
        let _ = black_box(self.law.inputs_at_time(next.time, &desired, y, v));
    }
}

#[cfg(test)]
mod tests {
    use super::super::joint_pd::JointGains;
    use super::*;
    use crate::trajectory::RestToRest;

    crate::dynamics!(struct PowerCube = gelenk_generated::powercube);

    type Pd = FeedForwardPd<PowerCube, RestToRest<2>, 2, 2>;

    fn controller(period: f64, time_constant: f64) -> Result<Pd, SettingError> {
        let gains = JointGains { position: [100.0, 50.0], velocity: [10.0, 5.0] };
        let law = JointPd::new(PowerCube, gains).unwrap();
        let motion = RestToRest::new([0.0, 0.1], [1.0, 0.5], 2.0).unwrap();
        LawController::new(law, motion, period, time_constant)
    }

    fn cycle(velocities: Option<[f64; 2]>) -> Cycle<2, 2> {
        Cycle { time: 0.02, positions: Some([0.002, 0.1]), velocities, ..Cycle::default() }
    }

    #[test]
    fn measured_velocities_stand_in_for_differences() {
        let first = |cycle: &Cycle<2, 2>| {
            let mut pd = controller(0.02, 0.0).unwrap();
            pd.reset(&[0.0, 0.1], &[0.0; 2]);
            let inputs = pd.step(cycle).unwrap().inputs;
            (inputs, pd.estimate().unwrap().velocities)
        };
        let (differentiated, v) = first(&cycle(None));
        assert!((v[0] - 0.1).abs() < 1e-12, "2 mrad in 20 ms");
        let (same, _) = first(&cycle(Some(v)));
        assert_eq!(same, differentiated);
        let (other, measured) = first(&cycle(Some([0.3, 0.0])));
        assert_eq!(measured, [0.3, 0.0]);
        // 10 N m s/rad · 0.2 rad/s over the gear ratio of 161.
        assert!((differentiated[0] - other[0] - 2.0 / 161.0).abs() < 1e-12);
    }

    #[test]
    fn periods_and_time_constants_are_checked() {
        for (period, time_constant, message) in [
            (0.0, 0.01, "setting period of the loop is 0, but must be positive and finite"),
            (-0.02, 0.01, "setting period of the loop is -0.02, but must be positive and finite"),
            (f64::INFINITY, 0.01, "setting period of the loop is inf, but must be positive and finite"),
            (0.02, f64::NAN, "setting time_constant of the loop is NaN, but must be 0 to 60 s"),
        ] {
            let error = controller(period, time_constant).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }

    /// A reading that overflows is a fault of its period, and not of later periods.
    #[test]
    fn an_overflow_passes() {
        let mut pd = controller(0.02, 0.01).unwrap();
        pd.reset(&[0.0, 0.1], &[0.0; 2]);
        let wild = Cycle { positions: Some([1e308, 0.1]), ..cycle(None) };
        assert_eq!(pd.step(&wild), Err(ControllerFault::NotFinite));
        assert!(pd.step(&cycle(None)).is_ok());
    }

    #[test]
    fn a_warm_up_changes_nothing() {
        let mut warm = controller(0.02, 0.01).unwrap();
        let mut cold = warm.clone();
        for k in 1..20 {
            let now = Cycle {
                time: 0.02 * f64::from(k),
                positions: Some([0.01 * f64::from(k), 0.1]),
                ..Cycle::default()
            };
            warm.warm_up(&now);
            assert_eq!(warm.step(&now), cold.step(&now));
            assert_eq!(warm.estimate(), cold.estimate());
        }
    }
}
