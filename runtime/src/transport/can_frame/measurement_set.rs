//! Assembly of readings from the messages of single drives.

use super::super::{Brakes, Reading};
use super::CanMessage;

/// Collects the measurements of all drives at one sampling time. A message with a new sequence number discards an older
/// incomplete set.
#[derive(Debug, Clone)]
pub struct MeasurementSet<const N: usize, const NY: usize = N> {
    sequence: Option<u8>,
    positions: [Option<f64>; NY],
    /// Velocity and force of each drive.
    rates: [Option<(Option<f64>, Option<f64>)>; N],
    /// Whether a complete set must have the rates (velocity or force) of each drive.
    with_rates: bool,
    brakes: Brakes,
}

impl<const N: usize, const NY: usize> Default for MeasurementSet<N, NY> {
    fn default() -> Self {
        Self::new(false)
    }
}

impl<const N: usize, const NY: usize> MeasurementSet<N, NY> {
    /// An empty set. The set is complete if it has all positions. If `with_rates` is true, it also needs the rates of all
    /// drives.
    pub(super) fn new(with_rates: bool) -> Self {
        Self { sequence: None, positions: [None; NY], rates: [None; N], with_rates, brakes: Brakes::Unknown }
    }

    /// Adds a message. Returns the reading if this message completes the set. Messages to the drives are ignored.
    pub fn take(&mut self, message: &CanMessage) -> Option<Reading<N, NY>> {
        match *message {
            CanMessage::Position { index, value, sequence, brake } => {
                self.begin(sequence);
                *self.positions.get_mut(index)? = Some(value);
                self.brakes = match (self.brakes, brake) {
                    (Brakes::Engaged, _) | (_, Brakes::Engaged) => Brakes::Engaged,
                    (_, other) => other,
                };
            }
            CanMessage::Rates { index, velocity, torque, sequence } => {
                self.begin(sequence);
                *self.rates.get_mut(index)? = Some((velocity, torque));
            }
            CanMessage::Release | CanMessage::Brake | CanMessage::Input { .. } => return None,
        }
        self.complete()
    }

    fn begin(&mut self, sequence: u8) {
        if self.sequence != Some(sequence) {
            *self = Self { sequence: Some(sequence), ..Self::new(self.with_rates) };
        }
    }

    fn complete(&mut self) -> Option<Reading<N, NY>> {
        let positions = all(&self.positions)?;
        let mut reading = Reading::of(positions, self.brakes);
        if self.with_rates {
            let rates = all(&self.rates)?;
            reading.velocities = all(&rates.map(|(velocity, _)| velocity));
            reading.torques = all(&rates.map(|(_, torque)| torque));
        }
        self.positions = [None; NY];
        self.rates = [None; N];
        self.brakes = Brakes::Unknown;
        Some(reading)
    }
}

/// All values; `None` if a value is missing.
fn all<V: Copy + Default, const N: usize>(values: &[Option<V>; N]) -> Option<[V; N]> {
    let complete = values.iter().all(Option::is_some);
    complete.then(|| values.map(Option::unwrap_or_default))
}
