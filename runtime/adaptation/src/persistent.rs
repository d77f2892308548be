//! Saving and restoring of the learned state as numbers.

use super::bank::{Bank, Gaussian};
use super::correlation::CELLS;
use super::estimator::Adaptation;
use super::joint::Joint;
use super::law::TERMS;
use super::settings::AdaptationError;

/// Numbers of the origin: fingerprint in two halves, joints, period, time constant, delay.
const ORIGIN: usize = 6;
/// Names of the parts of the origin, in this order.
const PARTS: [&str; ORIGIN] =
    ["description", "description", "number of joints", "period", "time constant", "delay"];
/// Numbers of a law: mean and covariance.
const LAW: usize = TERMS + TERMS * TERMS;
/// Numbers of a joint: filters with their weights, the filter of independent samples, the average, cells, noise and correlation,
/// comparison.
const JOINT: usize = super::bank::RATES * (LAW + 1) + 2 * LAW + 2 * CELLS + 5 + 8;

impl<const N: usize> Adaptation<N> {
    /// Length of the saved state.
    pub const SAVED: usize = ORIGIN + N * JOINT;

    /// Writes the learned laws, after a fingerprint of the description, the period, the filter and the delay.
    ///
    /// # Errors
    /// [`AdaptationError::Length`].
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

    /// Restores saved laws. Motion and time restart; the described law acts until the first period.
    ///
    /// # Errors
    /// [`AdaptationError::Length`], [`AdaptationError::Origin`], [`AdaptationError::Number`]; the state is
    /// then unchanged.
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
        let Self { settings, fingerprint, .. } = self;
        [
            half(*fingerprint),
            half(*fingerprint >> 32),
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

/// Whether an estimator can have these numbers: finite, with variances and counts that are not negative.
fn is_possible(joint: &Joint, numbers: &[f64]) -> bool {
    let counts = |values: &[f64]| values.iter().all(|value| *value >= 0.0);
    let bank = &joint.bank;
    let mut laws = bank.tracks.iter().map(|track| &track.state).chain([&bank.independent, &joint.law]);
    let comparison = &joint.comparison;
    numbers.iter().all(|number| number.is_finite())
        && laws.all(|law| (0..TERMS).all(|k| law.covariance[k][k] >= 0.0))
        && counts(&bank.correlation.counts)
        && bank.correlated >= 1.0
        && bank.noise > 0.0
        && bank.taken >= 0.0
        && counts(&comparison.squares)
        && counts(&[comparison.all[0], comparison.all[1], comparison.all[3]])
        && counts(&[comparison.taken, comparison.excluded])
}

/// All saved numbers of a joint.
fn each(joint: &mut Joint) -> impl Iterator<Item = &mut f64> {
    let Joint { bank, law, comparison, .. } = joint;
    let Bank { tracks, independent, correlation, correlated, noise, taken } = bank;
    let tracks = tracks.iter_mut().flat_map(|track| numbers(&mut track.state).chain([&mut track.weight]));
    let cells = correlation.counts.iter_mut().chain(&mut correlation.sums);
    let of_noise = [&mut correlation.squares, &mut correlation.products, correlated, noise, taken];
    let counts = [&mut comparison.taken, &mut comparison.excluded];
    tracks
        .chain(numbers(independent))
        .chain(numbers(law))
        .chain(cells)
        .chain(of_noise)
        .chain(&mut comparison.squares)
        .chain(&mut comparison.all)
        .chain(counts)
}

fn numbers(law: &mut Gaussian) -> impl Iterator<Item = &mut f64> {
    law.mean.iter_mut().chain(law.covariance.as_flattened_mut())
}
