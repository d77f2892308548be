//! What was skipped or changed in a URDF: one note for each kind.

use crate::diagnostic::{Diagnostic, Report, Severity, Span};
use crate::wording::listed;
use std::collections::BTreeMap;

/// Elements that never enter the dynamics; they share one note.
const HARMLESS: [&str; 14] = [
    "<visual>",
    "<collision>",
    "<material>",
    "<transmission>",
    "<ros2_control>",
    "<gazebo>",
    "<mujoco>",
    "<sensor>",
    "<contact>",
    "<safety_controller>",
    "<calibration>",
    "<self_filter>",
    "<collision_checking>",
    "<self_collision_checking>",
];

/// Something about a description that is worth a note, once for all places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Remark {
    AxisNormalized,
    ContinuousLimits,
    DuplicateElement,
    EmptyInertial,
    LimitMissing,
    LimitUnset,
    LimitUnusable,
    PlanarLimits,
    ReductionIgnored,
}

impl Remark {
    fn code(self) -> &'static str {
        match self {
            Self::AxisNormalized => "axis-normalized",
            Self::ContinuousLimits => "continuous-limits",
            Self::DuplicateElement => "duplicate-element",
            Self::EmptyInertial => "empty-inertial",
            Self::LimitMissing => "limit-missing",
            Self::LimitUnset => "limit-unset",
            Self::LimitUnusable => "limit-unusable",
            Self::PlanarLimits => "planar-limits",
            Self::ReductionIgnored => "transmission-ignored",
        }
    }

    fn severity(self) -> Severity {
        match self {
            Self::DuplicateElement | Self::EmptyInertial | Self::LimitUnusable => Severity::Warning,
            _ => Severity::Note,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::AxisNormalized => "axes were brought to length 1",
            Self::ContinuousLimits => {
                "continuous joints turn without end; their position limits were not taken"
            }
            Self::DuplicateElement => "of several elements of one kind the first was taken",
            Self::EmptyInertial => "links whose <inertial> says nothing have no mass",
            Self::LimitMissing => {
                "joints without a <limit> have none here; ROS refuses such revolute and prismatic joints"
            }
            Self::LimitUnset => "limits that are 0, equal or infinite were taken as not given",
            Self::LimitUnusable => "limits that are reversed or negative were taken as not given",
            Self::PlanarLimits => {
                "limits of joints with several degrees of freedom say not of which motion and were not taken; a TOML file gives them \
                 to the parts"
            }
            Self::ReductionIgnored => "mechanical reductions were ignored, drives are ideal",
        }
    }
}

/// Collects remarks while a URDF is read.
#[derive(Debug, Default)]
pub(super) struct UrdfNotes {
    /// Skipped elements and attributes: first place and count.
    skipped: BTreeMap<String, (Span, usize)>,
    /// First place and owners.
    remarks: BTreeMap<Remark, (Span, Vec<String>)>,
}

impl UrdfNotes {
    pub(super) fn skip(&mut self, what: String, span: Span) {
        self.skipped.entry(what).or_insert((span, 0)).1 += 1;
    }

    pub(super) fn remark(&mut self, remark: Remark, span: Span, owner: String) {
        let entry = self.remarks.entry(remark);
        entry.or_insert_with(|| (span, Vec::new())).1.push(owner);
    }

    pub(super) fn report(self, report: &mut Report) {
        let (harmless, unknown): (Vec<_>, Vec<_>) =
            self.skipped.into_iter().partition(|(what, _)| HARMLESS.contains(&what.as_str()));
        note_skipped(harmless, report);
        note_unknown(unknown, report);
        for (remark, (span, owners)) in self.remarks {
            let message = format!("{}: {}", remark.text(), listed(owners.into_iter()));
            let entry =
                Diagnostic { severity: remark.severity(), ..Diagnostic::note(remark.code(), message) };
            report.push(Some(span), entry);
        }
    }
}

pub(super) fn note_skipped(harmless: Vec<(String, (Span, usize))>, report: &mut Report) {
    let spans = harmless.iter().map(|(_, (span, _))| *span);
    let Some(first) = spans.min_by_key(|span| span.start) else {
        return;
    };
    let counts = harmless.iter();
    let counts = counts.map(|(what, (_, count))| format!("{count} {what}"));
    let counts = counts.collect::<Vec<_>>().join(", ");
    let message = format!("skipped: {counts}; they do not enter the dynamics");
    report.note(Some(first), "skipped", message);
}

fn note_unknown(unknown: Vec<(String, (Span, usize))>, report: &mut Report) {
    let spans = unknown.iter().map(|(_, (span, _))| *span);
    let Some(first) = spans.min_by_key(|span| span.start) else {
        return;
    };
    let entries = unknown.iter().map(|(what, (_, count))| match count {
        1 => what.clone(),
        count => format!("{what} ({count} times)"),
    });
    let message = format!("not known and skipped: {}", listed(entries));
    report.note(Some(first), "unknown-tag", message);
}
