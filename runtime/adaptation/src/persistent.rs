//! Saves and restores the learned state as an array of numbers.

use super::bank::Gaussian;
use super::correlation::CELLS;
use super::estimator::{Adaptation, hash};
use super::joint::Joint;
use super::law::{JointScale, TERMS};
use super::settings::AdaptationError;

/// Number of values that identify the origin of a saved state: fingerprint in two halves, number of joints, period, time
/// constant, delay.
const ORIGIN: usize = 6;
/// Names of the parts of the origin, in this order.
const PARTS: [&str; ORIGIN] =
    ["description", "description", "number of joints", "period", "time constant", "delay"];
/// Number of values of a filter: means and covariances of coefficients and their rates of change, cells, and four values of weight
/// and correlation.
const TRACK: usize = 2 * TERMS + 3 * TERMS * TERMS + 2 * CELLS + 4;
/// Number of values of a joint: filters, noise with its weight, mean and covariance of the law, comparison.
const JOINT: usize = super::bank::RATES * TRACK + 2 + TERMS + TERMS * TERMS + 8;

impl<const N: usize> Adaptation<N> {
    /// Number of values of the saved state.
    pub const SAVED: usize = ORIGIN + N * JOINT;

    /// Writes the learned laws of all joints to `numbers`, which must have [`SAVED`](Self::SAVED) entries. The first values
    /// identify the description, the period, the filter and the delay.
    ///
    /// # Errors
    /// [`AdaptationError::Length`] if `numbers` has another length.
    pub fn save(&self, numbers: &mut [f64]) -> Result<(), AdaptationError> {
        self.require_length(numbers.len())?;
        numbers[..ORIGIN].copy_from_slice(&self.origin());
        for (mut joint, numbers) in self.joints.into_iter().zip(numbers[ORIGIN..].chunks_exact_mut(JOINT)) {
            match &mut joint {
                Some(joint) => each(joint).zip(numbers).for_each(|(of_joint, number)| *number = *of_joint),
                None => numbers.fill(0.0),
            }
        }
        Ok(())
    }

    /// Restores laws that [`save`](Self::save) wrote. Motion and time restart. The acting law begins with the described law and
    /// then follows the restored law.
    ///
    /// # Errors
    /// - [`AdaptationError::Length`] if `numbers` has another length than [`SAVED`](Self::SAVED).
    /// - [`AdaptationError::Origin`] if the saved state belongs to another description, period, filter or delay.
    /// - [`AdaptationError::Number`] if a saved number is not valid.
    ///
    /// After an error the state is unchanged.
    pub fn restore(&mut self, numbers: &[f64]) -> Result<(), AdaptationError> {
        self.require_length(numbers.len())?;
        let differs = |(a, b): (&f64, &f64)| a.to_bits() != b.to_bits();
        if let Some(part) = self.origin().iter().zip(numbers).position(differs) {
            return Err(AdaptationError::Origin(PARTS[part]));
        }
        let mut joints = self.joints;
        for (place, (joint, numbers)) in
            joints.iter_mut().zip(numbers[ORIGIN..].chunks_exact(JOINT)).enumerate()
        {
            let Some(joint) = joint else { continue };
            each(joint).zip(numbers).for_each(|(of_joint, number)| *of_joint = *number);
            if let (Some(derived), Some(scale)) = (&self.derived[place], &self.scales[place]) {
                joint.bound(derived, scale);
            }
            if !is_possible(joint, numbers) {
                return Err(AdaptationError::Number(ORIGIN + place * JOINT));
            }
        }
        self.joints = joints;
        self.restart();
        Ok(())
    }

    fn origin(&self) -> [f64; ORIGIN] {
        let half = |bits: u64| (bits & 0xffff_ffff) as f64;
        let settings = &self.settings;
        let magnitudes =
            |s: &JointScale| [s.torque, s.speed, s.least_slope, s.range].into_iter().chain(s.most);
        let scales = self.scales.iter().flatten().flat_map(magnitudes);
        let fingerprint = hash([half(self.described), half(self.described >> 32)].into_iter().chain(scales));
        [
            half(fingerprint),
            half(fingerprint >> 32),
            N as f64,
            settings.period,
            settings.time_constant,
            settings.delay as f64,
        ]
    }

    fn require_length(&self, found: usize) -> Result<(), AdaptationError> {
        let needed = Self::SAVED;
        if found == needed { Ok(()) } else { Err(AdaptationError::Length { found, needed }) }
    }
}

/// Whether the restored numbers of a joint are valid: all numbers are finite, and variances and counts are not negative.
fn is_possible(joint: &Joint, numbers: &[f64]) -> bool {
    let counts = |values: &[f64]| values.iter().all(|value| *value >= 0.0);
    let tracks = joint.bank.tracks.iter().all(|track| {
        (0..TERMS).all(|k| track.state.covariance[k][k] >= 0.0)
            && counts(&track.correlation.counts)
            && track.correlated >= 1.0
    });
    let comparison = &joint.comparison;
    numbers.iter().all(|number| number.is_finite())
        && tracks
        && (0..TERMS).all(|k| joint.law.covariance[k][k] >= 0.0)
        && joint.bank.noise > 0.0
        && joint.bank.taken >= 0.0
        && counts(&comparison.squares)
        && counts(&[comparison.all[0], comparison.all[1], comparison.all[3]])
        && counts(&[comparison.taken, comparison.excluded])
}

/// All saved numbers of a joint.
fn each(joint: &mut Joint) -> impl Iterator<Item = &mut f64> {
    let Joint { bank, law, comparison, .. } = joint;
    let tracks = bank.tracks.iter_mut().flat_map(|track| {
        let correlation = &mut track.correlation;
        let sums = correlation.counts.iter_mut().chain(&mut correlation.sums);
        let last =
            [&mut track.weight, &mut track.correlated, &mut correlation.squares, &mut correlation.products];
        let (state, change) = (entries(&mut track.state), entries(&mut track.change));
        state.chain(change).chain(track.cross.as_flattened_mut()).chain(sums).chain(last)
    });
    let noise = [&mut bank.noise, &mut bank.taken];
    let counts = [&mut comparison.taken, &mut comparison.excluded];
    tracks
        .chain(noise)
        .chain(entries(law))
        .chain(&mut comparison.squares)
        .chain(&mut comparison.all)
        .chain(counts)
}

fn entries(part: &mut Gaussian) -> impl Iterator<Item = &mut f64> {
    part.mean.iter_mut().chain(part.covariance.as_flattened_mut())
}
