//! A simulated robot in the same process.

use super::{Brakes, Reading, Transport, TransportError, require_finite};
use crate::clock::Clock;
use crate::dynamics::Dynamics;
use crate::plant::Plant;
use std::time::Duration;

/// Transport to a simulated robot ([`Plant`]) in the same process. The plant moves with a clock. If plant and loop share a
/// [`VirtualClock`](crate::control_loop::VirtualClock), a run only takes its computing time. If the loop stalls, the plant
/// continues to move with its last inputs.
///
/// Inputs act from the end of the period of the plant in which they are written. If the plant loses a measurement, the
/// loop gets no reading.
pub struct InProcess<D, K, const N: usize, const M: usize, const NY: usize = N> {
    plant: Plant<D, N, M, NY>,
    clock: K,
    period: Duration,
    /// Clock time up to which the plant has moved.
    reached: Duration,
    /// Inputs that were written since the last step of the plant; `None` if no inputs were written.
    written: Option<[f64; M]>,
    /// Plant time of the last reading (s); `None` before the first reading.
    last: Option<f64>,
}

impl<D, K, const N: usize, const M: usize, const NY: usize> InProcess<D, K, N, M, NY>
where
    D: Dynamics<N, M, NY>,
    K: Clock,
{
    /// A transport to `plant`, which moves in steps of `period` from now on. Use the period of the loop. Periods below one
    /// microsecond count as one microsecond.
    #[must_use]
    pub fn new(plant: Plant<D, N, M, NY>, clock: K, period: Duration) -> Self {
        Self {
            plant,
            reached: clock.now(),
            clock,
            period: period.max(Duration::from_micros(1)),
            written: None,
            last: None,
        }
    }

    /// The plant after its last step.
    pub fn plant(&self) -> &Plant<D, N, M, NY> {
        &self.plant
    }

    fn catch_up(&mut self) -> Result<(), TransportError> {
        let now = self.clock.now();
        // If the end of the period exceeds the range of the clock, the period never ends.
        while let Some(next) = self.reached.checked_add(self.period).filter(|next| *next <= now) {
            self.reached = next;
            let period = self.period.as_secs_f64();
            let moved = match self.written.take() {
                Some(inputs) => self.plant.apply(&inputs, period),
                None => self.plant.hold(period),
            };
            moved.map_err(|_| TransportError::Simulation)?;
        }
        Ok(())
    }
}

impl<D, K, const N: usize, const M: usize, const NY: usize> Transport<N, M, NY> for InProcess<D, K, N, M, NY>
where
    D: Dynamics<N, M, NY>,
    K: Clock,
{
    fn read(&mut self) -> Result<Option<Reading<N, NY>>, TransportError> {
        self.catch_up()?;
        let measurement = self.plant.measure();
        if self.last == Some(measurement.time) {
            return Ok(None);
        }
        self.last = Some(measurement.time);
        Ok(Some(Reading {
            positions: measurement.positions,
            velocities: measurement.velocities,
            torques: measurement.torques,
            brakes: if self.plant.is_braked() { Brakes::Engaged } else { Brakes::Released },
        }))
    }

    fn write(&mut self, inputs: &[f64; M]) -> Result<(), TransportError> {
        require_finite(inputs)?;
        self.catch_up()?;
        self.written = Some(*inputs);
        Ok(())
    }

    fn release(&mut self) -> Result<(), TransportError> {
        self.catch_up()?;
        self.plant.release();
        Ok(())
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        // The plant brakes also if the simulation cannot continue.
        let caught_up = self.catch_up();
        self.plant.brake();
        caught_up
    }
}
