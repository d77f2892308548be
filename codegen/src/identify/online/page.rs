//! Report page of a replay: learned friction over time, and errors of the predictions.

use gelenk_findings::digits::significant;
use gelenk_report::{Axis, Block, Cell, Figure, Marks, Plot, Report, Section, Table, text};

use super::super::page::thinned;
use super::batch::{BatchLaw, best_causal, best_in_hindsight};
use super::replay::{JointReplay, OnlineSample};

/// Duration in s over which errors are averaged in the figure of the report page.
const SMOOTHING: f64 = 5.0;

/// Results of a replay for one joint, with batch laws (fitted to whole intervals of the log) for comparison.
#[derive(Debug, Clone)]
pub struct OnlineJoint {
    /// Name of the joint in the description.
    pub name: String,
    /// Unit of the joint's position, `rad` or `m`.
    pub unit: &'static str,
    /// Learned friction law and samples of the joint.
    pub replay: JointReplay,
    /// Best batch law that predicts each run from the samples before this run; `None` if no such law has a finite
    /// error.
    pub by_run: Option<BatchLaw>,
    /// Best batch law that predicts each sample from the samples before this sample; `None` if no such law has a
    /// finite error.
    pub causal: Option<BatchLaw>,
    /// Best batch law that was fitted to all samples; `None` if no such law has a finite error.
    pub hindsight: Option<BatchLaw>,
}

impl OnlineJoint {
    /// Fits batch laws (to whole intervals of the log) to the samples of the replay.
    #[must_use]
    pub fn new(name: String, unit: &'static str, replay: JointReplay) -> Self {
        let by_run = best_causal(&replay, |sample| sample.begin);
        let causal = best_causal(&replay, |sample| sample.time);
        let hindsight = best_in_hindsight(&replay);
        Self { name, unit, replay, by_run, causal, hindsight }
    }

    /// Returns root mean squares of prediction errors in N·m or N, or NaN if the law does not exist. They
    /// belong to these laws, in this order:
    ///
    /// - described law
    /// - learned law
    /// - acting law
    /// - best batch law that was fitted before each run
    /// - best batch law that was fitted before each sample
    /// - best law of the whole log
    #[must_use]
    pub fn errors(&self) -> [f64; 6] {
        let of = |law: &Option<BatchLaw>| law.as_ref().map_or(f64::NAN, |law| law.error);
        [
            self.replay.error(|sample| sample.prediction.torque),
            self.replay.error(|sample| sample.prediction.error),
            self.replay.error(|sample| sample.acting),
            of(&self.by_run),
            of(&self.causal),
            of(&self.hindsight),
        ]
    }

    /// Returns the number of samples that lie outside the interval of their prediction. The estimator does not
    /// learn from these samples.
    #[must_use]
    pub fn unexplained(&self) -> usize {
        self.replay.samples.iter().filter(|sample| !sample.prediction.is_explained).count()
    }

    fn force(&self) -> &'static str {
        if self.unit == "m" { "N" } else { "N·m" }
    }
}

/// Creates the report page of a replay.
///
/// - `joints`: joints whose friction is learned
/// - `command`: command line that made the page
#[must_use]
pub fn online_page(name: &str, joints: &[OnlineJoint], command: &str) -> Report {
    let mut report = Report::new(format!("Friction of {name}, learned online")).lead(
        "The estimator of the control loop processed the log period by period. It predicted each sample before it used the \
         sample for learning.",
    );
    report.made_by = command.to_owned();
    let mut section = Section::new("joints", "Joints").block(text(
        "Left: friction at the joint's root-mean-square speed. Right: root mean square of the prediction errors over 5 s. The \
         batch law is the best law that is fitted to the samples before each predicted sample. Its number of terms and its time \
         window are chosen afterwards.",
    ));
    for (index, joint) in joints.iter().enumerate() {
        section = section.block(Block::Figure(figure(index, joint)));
    }
    report.section(
        section
            .block(Block::Table(errors(joints)))
            .block(Block::Table(trust(joints)))
            .block(Block::Table(terms(joints))),
    )
}

fn figure(index: usize, joint: &OnlineJoint) -> Figure {
    let samples = &joint.replay.samples;
    let curve = |of: &dyn Fn(&OnlineSample) -> f64| {
        thinned(samples.iter().map(|sample| [sample.time, of(sample)]).collect())
    };
    let end = |side: f64| curve(&|sample| sample.friction[0] + side * sample.friction[1]);
    let error = |of: &dyn Fn(usize) -> f64| thinned(smoothed(samples, of));
    let time = || Axis::new("time", "s");
    let speed = format!("friction at {:.2} {}/s", joint.replay.speed, joint.unit);
    let law = Plot::new(joint.name.clone(), time(), Axis::new(speed, joint.force()))
        .series("learned", Marks::Line, curve(&|sample| sample.friction[0]))
        .series("90 % interval", Marks::Dashed, [end(1.0), vec![[f64::NAN; 2]], end(-1.0)].concat())
        .series("described", Marks::Line, curve(&|_| joint.replay.described))
        .series("acting", Marks::Dashed, curve(&|sample| sample.acting_friction));
    let mut errors = Plot::new(joint.name.clone(), time(), Axis::new("rms error", joint.force()))
        .series("described", Marks::Line, error(&|i| samples[i].prediction.torque))
        .series("learned", Marks::Line, error(&|i| samples[i].prediction.error));
    if let Some(batch) = &joint.causal {
        errors = errors.series("batch", Marks::Dashed, error(&|i| batch.errors[i]));
    }
    Figure::new(format!("online_{}", index + 1), "").plot(law).plot(errors)
}

/// Returns for each sample the root mean square of the values over the last [`SMOOTHING`] seconds, with the
/// sample's time.
fn smoothed(samples: &[OnlineSample], of: &dyn Fn(usize) -> f64) -> Vec<[f64; 2]> {
    let mut sums = vec![0.0];
    for i in 0..samples.len() {
        sums.push(sums[i] + of(i) * of(i));
    }
    let point = |(i, sample): (usize, &OnlineSample)| {
        let first = samples.partition_point(|other| other.time < sample.time - SMOOTHING);
        [sample.time, ((sums[i + 1] - sums[first]).max(0.0) / (i + 1 - first) as f64).sqrt()]
    };
    samples.iter().enumerate().map(point).collect()
}

fn errors(joints: &[OnlineJoint]) -> Table {
    let table = Table::new(
        "errors",
        "Root mean square of the prediction errors. Acting: the law that a controller would have used. By run: the best law \
         fitted to the samples before each run. Batch: the best law fitted to the samples before each sample. Hindsight: the best \
         law fitted to the whole log.",
    )
    .column("joint", "joint", "")
    .column("acts", "trust", "")
    .column("since", "since", "s")
    .column("samples", "samples", "")
    .columns(&["unexplained", "described", "learned", "acting", "by run", "batch", "hindsight"]);
    let row = |joint: &OnlineJoint| {
        let state = [Cell::text(joint.name.clone()), Cell::text(joint.replay.state.trust.name())];
        let counts = [
            Cell::Rounded(joint.replay.since(), 4),
            Cell::Count(joint.replay.samples.len()),
            Cell::Count(joint.unexplained()),
        ];
        let errors = joint.errors().map(|error| Cell::Rounded(error, 3));
        state.into_iter().chain(counts).chain(errors).collect::<Vec<_>>()
    };
    table.rows(joints.iter().map(row))
}

fn trust(joints: &[OnlineJoint]) -> Table {
    let table = Table::new("trust", "Acting law over time: each change of the law, and the reason.")
        .column("joint", "joint", "")
        .column("since", "since", "s")
        .column("acts", "trust", "");
    let rows = joints.iter().flat_map(|joint| {
        let phases = joint.replay.samples.chunk_by(|a, b| a.trust == b.trust);
        phases.map(|phase| {
            let (since, trust) = (phase[0].time, phase[0].trust.name());
            vec![Cell::text(joint.name.clone()), Cell::Rounded(since, 4), Cell::text(trust)]
        })
    });
    table.rows(rows)
}

fn terms(joints: &[OnlineJoint]) -> Table {
    let table = Table::new(
        "terms",
        "Terms that the learned law adds to the described friction $\\tau_d$, $\\delta_1 \\tau_d + \\delta_2 v + \\delta_3 + \
         \\delta_4 |\\tau_d| + \\delta_5 |\\tau_l| s_1$, with the half widths of their 90 % intervals. A coefficient is frozen if \
         the motion does not determine it.",
    )
    .column("joint", "joint", "")
    .column("term", "term", "")
    .column("learned", "learned", "")
    .column("±", "half_width", "")
    .column("acting", "acting", "")
    .column("shown", "shown", "");
    let rows = joints.iter().flat_map(|joint| {
        joint.replay.state.terms().map(|term| {
            let digits = |value| significant(value, Some(term.half_width)).unwrap_or(3);
            vec![
                Cell::text(joint.name.clone()),
                Cell::text(term.name),
                Cell::Rounded(term.learned, digits(term.learned)),
                Cell::Rounded(term.half_width, 2),
                Cell::Rounded(term.acting, digits(term.acting)),
                Cell::text(if term.is_excited { "yes" } else { "no" }),
            ]
        })
    });
    table.rows(rows)
}
