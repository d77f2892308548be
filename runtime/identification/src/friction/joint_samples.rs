//! The samples of one joint over all runs, from which its friction law is identified.

use super::super::error::Result;
use super::super::estimation::{CommonTerms, Estimate, FEWEST_MOTIONS};
use super::super::methods::offset::Offset;
use super::super::preparation::PreparationReport;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::settings::note_on_filter;
use super::{Filtered, FilteredRun, FrictionData, FrictionIdentification, FrictionReport, Offsets};
use std::ops::Range;

/// Samples of one joint over all runs.
pub(crate) struct JointSamples<'a> {
    joint: usize,
    pub(crate) name: &'a str,
    unit: &'a str,
    /// Estimated offset of each run of the samples. It is subtracted before the law is fitted.
    offsets: Vec<Offset>,
    runs: Vec<Range<usize>>,
    /// The samples of each motion; `None` if runs do not repeat motions.
    motions: Option<Vec<Vec<Range<usize>>>>,
    /// The complete runs to which the samples belong.
    whole: Vec<FilteredRun<'a>>,
    pub(crate) velocities: Vec<f64>,
    pub(crate) torques: Vec<f64>,
    /// Friction terms of the joint in the estimate of all joints; `None` if the joint has no terms there.
    common: Option<&'a CommonTerms>,
}

impl<'a> JointSamples<'a> {
    /// Collects the samples of velocity and friction torque of a joint from prepared runs.
    ///
    /// - `motions`: index of the motion of each run; `None` if runs do not repeat motions
    pub(crate) fn new(
        joint: usize,
        prepared: &'a [PreparedRun],
        motions: Option<&[usize]>,
        estimate: &'a Estimate,
    ) -> Self {
        let mut samples = Self {
            joint,
            name: &estimate.joints[joint].name,
            unit: estimate.joints[joint].unit,
            offsets: Vec::new(),
            runs: Vec::new(),
            motions: motions.map(|numbers| vec![Vec::new(); numbers.iter().max().map_or(0, |last| last + 1)]),
            whole: Vec::new(),
            velocities: Vec::new(),
            torques: Vec::new(),
            common: estimate.common[joint].as_ref(),
        };
        let of_joint = &estimate.joints[joint];
        for (index, (run, torques)) in prepared.iter().zip(&estimate.friction).enumerate() {
            let errors = &of_joint.offset_errors;
            let offset =
                [of_joint.offsets[index], errors.get(index).or(errors.first()).copied().unwrap_or(0.0)];
            let motion = motions.map(|numbers| numbers[index]);
            match estimate.load_friction.get(index) {
                Some(load) => {
                    let torques = torques[joint].iter().zip(&load[joint]);
                    let torques: Vec<f64> = torques.map(|(all, load)| all - load).collect();
                    samples.extend(run, offset, motion, &torques);
                }
                None => samples.extend(run, offset, motion, &torques[joint]),
            }
        }
        samples.motions.iter_mut().for_each(|motions| motions.retain(|ranges| !ranges.is_empty()));
        samples.motions = samples.motions.take_if(|motions| motions.len() >= FEWEST_MOTIONS);
        samples
    }

    /// Adds the samples of a run at which the joint moves and its torque is known.
    ///
    /// - `value`, `standard_error`: offset of the run, and its standard error
    /// - `motion`: index of the run's motion
    fn extend(
        &mut self,
        run: &'a PreparedRun,
        [value, standard_error]: [f64; 2],
        motion: Option<usize>,
        torques: &[f64],
    ) {
        let start = self.torques.len();
        let kept: Vec<usize> = kept(run, self.joint, torques).collect();
        for &i in &kept {
            self.velocities.push(run.velocities[self.joint][i]);
            self.torques.push(torques[i]);
        }
        if self.torques.len() > start {
            let rows = start..self.torques.len();
            if let (Some(motions), Some(motion)) = (&mut self.motions, motion) {
                motions[motion].push(rows.clone());
            }
            self.offsets.push(Offset { samples: rows.clone(), value, standard_error: Some(standard_error) });
            self.runs.push(rows);
            self.whole.push(FilteredRun { velocities: &run.velocities[self.joint], kept });
        }
    }

    /// Identifies the friction law of the joint.
    ///
    /// # Errors
    /// The errors are those of [`FrictionIdentification::identify`].
    pub(crate) fn law(
        &mut self,
        robot: &dyn Robot,
        settings: &FrictionIdentification,
        source: &str,
        preparation: &PreparationReport,
    ) -> Result<FrictionReport> {
        let bandwidth = preparation.joints.first().map(|joint| joint.bandwidth);
        let filter = bandwidth.map(|bandwidth| note_on_filter(bandwidth, preparation.sample_rate));
        let mut torques = self.torques.clone();
        for offset in &self.offsets {
            torques[offset.samples.clone()].iter_mut().for_each(|torque| *torque -= offset.value);
        }
        let filtered = Filtered { filter: &preparation.filter, runs: std::mem::take(&mut self.whole) };
        let data = FrictionData {
            joint: self.name,
            unit: self.unit,
            velocity_unit: if self.unit == "N" { "m/s" } else { "rad/s" },
            velocities: &self.velocities,
            torques: &torques,
            folds: self.motions.as_deref(),
            runs: Some(&self.runs),
            filtered: Some(&filtered),
            common: self.common,
            limits: robot.limits().get(self.joint).copied(),
            data: source,
            settings: filter.as_slice(),
        };
        let library = settings.library.scaled(robot.speed_scales()[self.joint])?;
        let settings = FrictionIdentification { library, offsets: Offsets::Known, ..settings.clone() };
        let mut report = settings.identify(&data)?;
        report.result.offsets.clone_from(&self.offsets);
        Ok(report)
    }
}

/// Samples of a run at which a joint moves and its torque is known.
pub(crate) fn kept(run: &PreparedRun, joint: usize, torques: &[f64]) -> impl Iterator<Item = usize> {
    (0..torques.len()).filter(move |i| torques[*i].is_finite() && !run.rests(joint, *i))
}
