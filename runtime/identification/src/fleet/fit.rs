//! Identification of a robot from moments (sums of products) of its logs.

use super::super::doubts::written::judge;
use super::super::error::{IdentificationError, Result, at};
use super::super::estimation::{
    Columns, Estimate, Gravity, ShareSums, SharedData, SharedEstimate, estimate_shares,
};
use super::super::friction::{FrictionData, SETTINGS, SharedFriction, note_on_direction};
use super::super::identify::{Identification, IdentificationSettings, JointFriction, unless_refused};
use super::super::log::{Labels, Recording};
use super::super::methods::moments::Moments;
use super::super::methods::subset::seen_both_ways;
use super::super::preparation::{Filter, PreparationReport};
use super::super::robot::Robot;
use super::super::shafts::RobotRows;
use super::exact::Exact;
use super::file::hash_of;
use super::levels;
use super::logs::{JointFacts, LogMoments, ReducedLog};
use gelenk_findings::{Finding, Rule, counted};
use nalgebra::{DMatrix, DVector};

/// Sees: moments of logs that passed different filters.
/// Matters: the sums mix signals of different bandwidths.
/// Example: 4 Hz and 9 Hz.
/// Fixture: `fleet/tests.rs`.
const OTHER_FILTERS: Rule = Rule::warning("different-filters");

/// Sees: moments of logs from whose efforts different delays were removed.
/// Matters: one of the delays may be wrong.
/// Example: 0 ms and 12 ms.
/// Fixture: `merge` in `codegen/tests/findings/arm.rs`.
const OTHER_DELAYS: Rule = Rule::warning("different-delays");

/// Sees: the number of logs and samples in moments.
/// Matters: efforts and residuals over time are not available.
/// Example: 3 logs, 4200 samples.
/// Fixture: `merge` in `codegen/tests/findings/arm.rs`.
const OF_MOMENTS: Rule = Rule::note("moments");

/// Identifies a robot from moments of its logs ([`LogMoments`]), as [`super::super::identify::identify`] does from the logs.
/// Runs, efforts, predictions and offsets in the result are empty, because they cannot be computed from sums.
///
/// - `description`: source of the robot: contents of its files and the options for reading them
/// - `progress`: receives a sentence at each step
///
/// # Errors
/// [`IdentificationError::File`] if the moments belong to another description, were made by another version, or come from
/// too few logs. The other errors are those of [`crate::estimation::estimate()`].
pub fn identify_moments(
    robot: &dyn Robot,
    description: &[&[u8]],
    moments: &LogMoments,
    settings: &IdentificationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification> {
    moments.require_description(description)?;
    let rows = RobotRows::of(robot);
    let (joints, robot) = (robot, &rows as &dyn Robot);
    let columns = moments.columns(robot)?;
    let shares = moments.share_sums()?;
    progress("Friction terms and the weight of the description are chosen by the error on held-out data.");
    let data = SharedData {
        robot,
        settings: &settings.estimation,
        gravity: Gravity::of(moments.about.gravity_compensated),
        columns: &columns,
        shares: &shares,
        correlation_time: moments.logs.iter().map(|log| log.correlation).fold(1.0, f64::max),
    };
    let found = estimate_shares(&data)?;
    progress("choosing the friction terms");
    let mut friction = moments.friction(&data, settings, &found);
    let mut estimate = found.estimate;
    for JointFriction { joint, report, .. } in &mut friction {
        let Ok(report) = report else { continue };
        judge(&mut estimate.joints[*joint], &mut report.result);
    }
    if let Some(shafts) = rows.of_shafts() {
        estimate.findings.splice(0..0, shafts.found(joints, &estimate));
    }
    estimate.findings.extend(moments.differences().into_iter().chain(moments.doubts()));
    Ok(Identification {
        recording: moments.recording(),
        preparation: moments.preparation()?,
        runs: Vec::new(),
        estimate,
        friction,
        shafts: rows.of_shafts().cloned(),
    })
}

fn fault(message: &str) -> IdentificationError {
    at("the moments").fault(message)
}

impl LogMoments {
    /// Fails unless the moments belong to a description.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if the moments belong to another description.
    pub(super) fn require_description(&self, description: &[&[u8]]) -> Result<()> {
        if self.about.description == hash_of(description) {
            return Ok(());
        }
        Err(fault(
            "the file of moments was made with another description, other options for reading, or files that have changed since. \
             Name the same description and options, or repeat `gelenk identify --reduce`",
        ))
    }

    /// The columns of the sums.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if the sums have other columns, or if efforts are currents with unknown motor constants
    /// and an input drives several joints.
    fn columns(&self, robot: &dyn Robot) -> Result<Columns> {
        let spans: Vec<f64> = self.joints.iter().map(|joint| joint.span).collect();
        let weighs = |joint: usize| {
            let mut sums = self.shares.iter().filter_map(|share| share.joints.get(joint));
            sums.any(|sums| sums.weight.value() > 0.0)
        };
        let measured = (0..spans.len()).map(weighs).collect();
        let columns = Columns::new(robot, self.about.effort, &spans, measured)?;
        if columns.widths() == self.about.widths {
            return Ok(columns);
        }
        Err(fault(
            "the file of moments was made by another version of gelenk. Reduce the logs again with this version",
        ))
    }

    /// Sums of products of the shares that have samples. A share is a group of samples of many logs.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if there are too few shares with samples.
    fn share_sums(&self) -> Result<Vec<ShareSums<f64>>> {
        let fewest = levels::FEWEST_SHARES.get();
        let filled = self.shares.iter().filter(|share| share.samples > 0);
        let shares =
            filled.map(|share| share.converted(|sum| Ok(sum.value()))).collect::<Result<Vec<_>>>()?;
        if shares.len() >= fewest {
            return Ok(shares);
        }
        Err(fault(&format!(
            "cross-validation needs samples in at least {fewest} of 16 groups, but only {}. Add more logs or longer logs",
            counted(shares.len(), "group has samples", "groups have samples")
        )))
    }

    /// Friction of the joints that moved. No friction is estimated for joints with a quaternion.
    fn friction(
        &self,
        data: &SharedData,
        settings: &IdentificationSettings,
        found: &SharedEstimate,
    ) -> Vec<JointFriction> {
        let rubs =
            |joint: &usize| found.estimate.joints[*joint].moves && !found.estimate.joints[*joint].exact;
        let moving = (0..found.friction.len()).filter(rubs);
        let (source, summary) = (self.source(), self.summary());
        let friction = moving.map(|joint| {
            let of_joint = JointMoments {
                joint,
                facts: &self.joints[joint],
                shares: data.shares,
                library: data.columns.library(joint),
                factors: &found.friction[joint],
                gain: found.estimate.joints[joint].gain.map_or(1.0, |gain| gain.value),
            };
            of_joint.friction(data.robot, settings, &found.estimate, &source, &summary)
        });
        friction.collect()
    }

    fn recording(&self) -> Recording {
        Recording {
            runs: Vec::new(),
            effort: self.about.effort,
            findings: Vec::new(),
            labels: Labels::default(),
            columns: Vec::new(),
            unused: Vec::new(),
            hashes: self.logs.iter().map(|log| (log.name.clone(), log.hash())).collect(),
        }
    }

    /// Number, duration and filters of the logs.
    fn summary(&self) -> Finding {
        let [narrow, wide] = self.range(&|log| [log.bandwidth; 2]);
        let range = if narrow < wide { format!("{narrow:.3} to ") } else { String::new() };
        SETTINGS.found(format!(
            "moments of {}, {} samples, {:.1} s, in {} groups for cross-validation, low-pass filter {range}{wide:.3} Hz. R² is \
             computed with one offset for each run. The values of these offsets cannot be computed from moments, so they are not \
             reported",
            counted(self.logs.len(), "log", "logs"),
            self.samples(),
            self.logs.iter().map(|log| log.seconds).sum::<f64>(),
            self.shares()
        ))
    }

    /// Findings about different filters and different delays of the logs.
    fn differences(&self) -> Vec<Finding> {
        let [narrow, wide] = self.range(&|log| [log.bandwidth; 2]);
        let [early, late] = self.range(&|log| log.delays);
        let filters = (wide > levels::OTHER_FILTER.get() * narrow).then(|| {
            let message = format!(
                "the logs passed filters of different bandwidths, {narrow:.3} to {wide:.3} Hz, so their sums mix different signals"
            );
            OTHER_FILTERS.found(message).help("use the same --bandwidth for every --reduce")
        });
        let delays = (late - early > levels::OTHER_DELAY.get()).then(|| {
            let [early, late] = [early, late].map(|delay| 1e3 * delay);
            let message = format!(
                "the delays that were removed from the efforts of the logs differ: {early:.1} to {late:.1} ms. One of these \
                 delays may be wrong"
            );
            OTHER_DELAYS.found(message).help("use the same --delay for every --reduce")
        });
        filters.into_iter().chain(delays).collect()
    }

    fn range(&self, of: &dyn Fn(&ReducedLog) -> [f64; 2]) -> [f64; 2] {
        let all = self.logs.iter().map(of);
        all.fold([f64::MAX, f64::MIN], |[a, b], [x, y]| [a.min(x), b.max(y)])
    }

    fn preparation(&self) -> Result<PreparationReport> {
        let bandwidth = self.range(&|log| [log.bandwidth; 2])[1];
        // Signals do not pass this filter, which only has the bandwidth for the report.
        let sample_rate = 10.0 * bandwidth;
        let filter = Filter::new(bandwidth, 1.0 / sample_rate)?;
        let findings = vec![OF_MOMENTS.found(self.summary().message)];
        Ok(PreparationReport { joints: Vec::new(), delays: Vec::new(), filter, sample_rate, findings })
    }

    /// The logs as text for the comments of a law. The complete list is at the beginning of the description.
    fn source(&self) -> String {
        match self.logs.as_slice() {
            [only] => format!("{} (sha256 {})", only.name, &only.hash()[..16]),
            several => format!("{} logs", several.len()),
        }
    }
}

/// Friction of one joint, from the residual of the rigid body.
struct JointMoments<'a> {
    joint: usize,
    facts: &'a JointFacts,
    shares: &'a [ShareSums<f64>],
    library: Vec<(String, usize)>,
    /// Factors of the linear combination of the joint's columns (regressor, terms, measured force) that is
    /// its friction torque.
    factors: &'a DVector<f64>,
    gain: f64,
}

impl JointMoments<'_> {
    fn friction(
        &self,
        robot: &dyn Robot,
        settings: &IdentificationSettings,
        estimate: &Estimate,
        data: &str,
        summary: &Finding,
    ) -> JointFriction {
        let of_joint = &estimate.joints[self.joint];
        let (library, left_out) = self.seen();
        let about = FrictionData {
            joint: &of_joint.name,
            unit: of_joint.unit,
            velocity_unit: if of_joint.unit == "N" { "m/s" } else { "rad/s" },
            limits: robot.limits().get(self.joint).copied(),
            data,
            settings: &[Some(summary.clone()), left_out].into_iter().flatten().collect::<Vec<_>>(),
            ..FrictionData::default()
        };
        let lost: f64 = self.shares.iter().map(|share| share.joints[self.joint].lost[0]).sum();
        let shared = SharedFriction {
            about,
            shares: self.shares.iter().map(|share| self.moments(share, &library)).collect(),
            lost: self.gain.powi(2) * lost,
            velocity_range: self.facts.velocities,
        };
        JointFriction {
            joint: self.joint,
            name: of_joint.name.clone(),
            velocities: Vec::new(),
            torques: Vec::new(),
            report: unless_refused(settings.friction.identify_shares(&shared), settings.accept_poor),
        }
    }

    /// The library without asymmetric terms that the logs do not determine, and the terms that were left out.
    fn seen(&self) -> (Vec<(String, usize)>, Option<Finding>) {
        let names: Vec<String> = self.library.iter().map(|(name, _)| name.clone()).collect();
        let [vv, v, tt, t] = self.facts.directions.map(Exact::value);
        let energies = |term: usize| {
            let [all, signed] = if names[term] == "v" { [vv, v] } else { [tt, t] };
            [0.5 * (all + signed), 0.5 * (all - signed)]
        };
        let (kept, out) = seen_both_ways(&names, energies);
        (kept.into_iter().map(|term| self.library[term].clone()).collect(), note_on_direction(&out))
    }

    /// Products of the columns of the terms and of the friction torque.
    fn moments(&self, share: &ShareSums<f64>, library: &[(String, usize)]) -> Moments {
        let products = share.joints[self.joint].matrix(self.factors.len());
        let mut map = DMatrix::zeros(products.nrows(), library.len() + 1);
        for (column, (_, place)) in library.iter().enumerate() {
            map[(*place, column)] = 1.0;
        }
        map.set_column(library.len(), self.factors);
        let names = library.iter().map(|(name, _)| name.clone()).collect();
        Moments::of_products(names, share.samples as usize, map.transpose() * products * map)
    }
}
