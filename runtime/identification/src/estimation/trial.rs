//! Fits of the same choice of terms to a changed log or description, and their errors on held-out data.
//!
//! Some hypotheses are tested with fitted bodies. Others are tested with the described bodies, because fitted bodies would
//! explain much of the change. A change must lower the error with its own kind of bodies. With the other kind, it must not
//! raise the error by more than the standard error.

use super::super::error::Result;
use super::super::log::unit_value;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::checks::Checked;
use super::choice::Chosen;
use super::fit::HeldOut;
use super::layout::Layout;
use super::loads::Loads;
use super::prior::Prior;
use super::result::Gravity;
use super::sums::{Sums, moving};
use super::task::Task;
use super::unit::CommonRatio;
use gelenk_findings::{Finding, Rule, Severity, Subject};
use nalgebra::Vector3;
use std::cell::OnceCell;
use std::rc::Rc;
use std::slice;

/// Weight of the prior that keeps an additional parameter at zero.
const HELD: f64 = 1e12;
/// Weight of the prior that is so small that the data alone determine an additional parameter.
const FREE: f64 = 1e-12;
/// Weight of the description at which the bodies stay as described.
const AS_DESCRIBED: f64 = 1e12;

/// Name of a number of a finding: the decrease of the held-out error by the change, in percent.
pub(super) const FALL: &str = "fall of the held-out error";

/// A change of the log or of the description.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    /// The efforts of the joint with this index are multiplied by a factor; with `None`, the efforts of all joints.
    Factor(Option<usize>, f64),
    /// All efforts are in the unit with this name.
    Unit(&'static str),
    /// The efforts contain this part of the robot's weight.
    Gravity(Gravity),
    /// Gravity has this vector in the axes of the base [m/s²].
    Tilt(Vector3<f64>),
    /// Joint j has the columns of joint `order[j]`.
    Order(Vec<usize>),
    /// The efforts of a joint have this delay \[s\] in addition to the stated delay.
    Delay(usize, f64),
    /// A joint has a spring of an unknown stiffness.
    Spring(usize),
    /// These joints have load-dependent friction.
    Load(Vec<usize>),
}

impl Change {
    /// The joint that is changed; `None` if the whole robot is changed.
    pub(super) fn joint(&self) -> Option<usize> {
        match self {
            Self::Factor(joint, _) => *joint,
            Self::Delay(joint, _) | Self::Spring(joint) => Some(*joint),
            _ => None,
        }
    }

    /// The joints whose held-out errors decide about the change; empty if the errors of all joints decide.
    fn deciding(&self) -> &[usize] {
        match self {
            Self::Delay(joint, _) => slice::from_ref(joint),
            Self::Load(joints) => joints,
            _ => &[],
        }
    }

    /// Factor of the efforts of a joint.
    fn factor(&self, joint: usize) -> f64 {
        match self {
            Self::Factor(changed, factor) if changed.is_none_or(|changed| changed == joint) => *factor,
            Self::Unit(name) => unit_value(name).unwrap_or(1.0),
            _ => 1.0,
        }
    }
}

/// Bodies with which a change is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bodies {
    /// The bodies are fitted with the chosen weight of the description.
    Fitted,
    /// The bodies are fitted without the constraint that they are physically possible. This takes less time
    /// for many changes.
    Unbounded,
    /// The bodies stay as described.
    Described,
}

impl Bodies {
    fn other(self) -> Self {
        if self == Self::Described { Self::Fitted } else { Self::Described }
    }

    /// Held-out errors of a choice of terms with bodies of this kind.
    ///
    /// - `own`: number of parameters without the additional ones
    fn errors(self, mut chosen: Chosen, own: usize, prior: &Prior) -> Result<HeldOut> {
        chosen.model.consistent &= self == Self::Fitted;
        if self == Self::Described {
            let additional = chosen.weighting.description / AS_DESCRIBED;
            chosen.weighting.description = AS_DESCRIBED;
            chosen.weighting.trust.iter_mut().skip(own).for_each(|trust| *trust *= additional);
            chosen.weighting.trust.iter_mut().take(own).for_each(|trust| *trust = 1.0);
        }
        chosen.held_out(prior)
    }
}

/// A hypothesis: changes of the log or of the description that may explain the efforts better. It is a row of the table
/// in [`super::hypotheses`].
pub(super) struct Hypothesis {
    /// Rule of the finding.
    pub(super) rule: Rule,
    /// Whether the hypothesis is tried, given the findings of the rows above it in the table of hypotheses.
    pub(super) when: fn(&Case, &[Finding]) -> bool,
    /// Changes of the log or of the description that are tried.
    pub(super) changes: fn(&Case) -> Result<Vec<Change>>,
    /// Kind of bodies (fitted or described) with which a change must lower the held-out error.
    pub(super) bodies: Bodies,
    /// Another change that may also explain the data. The hypothesis is not offered if the other change lowers the error more.
    pub(super) rival: fn(&Case) -> Option<Change>,
    /// Further condition that the held-out error with the change must meet.
    pub(super) accepts: fn(&Case, &HeldOut) -> bool,
    /// Whether every change that explains the data better is offered. If false, only the best change is offered.
    pub(super) each: bool,
    /// Whether the change excludes the changes of the rows above it in the table of hypotheses. If it lowers
    /// the error more than these changes, its finding replaces their findings. Otherwise it is not offered.
    pub(super) is_alone: bool,
    /// The finding about a change, without the part of the robot that it is about; `None` if no robot can have the change.
    pub(super) finding: fn(&Case, &Change, &Rule) -> Result<Option<Finding>>,
}

impl Hypothesis {
    /// The hypothesis with the entries that most rows have.
    pub(super) const fn of(
        rule: Rule,
        changes: fn(&Case) -> Result<Vec<Change>>,
        finding: fn(&Case, &Change, &Rule) -> Result<Option<Finding>>,
    ) -> Self {
        Self {
            rule,
            when: |_, _| true,
            changes,
            bodies: Bodies::Fitted,
            rival: |_| None,
            accepts: |_, _| true,
            each: false,
            is_alone: false,
            finding,
        }
    }
}

/// Whether a finding refuses the fit of its joint or of the whole robot.
pub(super) fn is_refusal(doubt: &Finding) -> bool {
    doubt.severity == Severity::Error
}

/// Columns, prior and sums of a changed log or description.
pub(super) struct Data {
    pub(super) layout: Layout,
    pub(super) prior: Prior,
    pub(super) sums: Sums,
}

/// A fit that is compared with fits to changed data.
pub(super) struct Case<'a> {
    pub(super) robot: &'a dyn Robot,
    pub(super) prior: &'a Prior,
    pub(super) chosen: &'a Chosen<'a>,
    /// Ratio of estimated to described forces; `None` if no joint determines this ratio.
    pub(super) ratio: Option<&'a CommonRatio>,
    /// Checks of the residuals; `None` for an estimate from moments, which has no samples.
    pub(super) checked: Option<&'a Checked<'a>>,
    /// Held-out errors of the fit with each kind of bodies.
    own: [HeldOut; 3],
    springs: OnceCell<Rc<Data>>,
}

impl<'a> Case<'a> {
    /// The case of a fit. Computes the held-out errors with unconstrained and with described bodies.
    ///
    /// - `own`: held-out errors of the fit
    pub(super) fn new(
        robot: &'a dyn Robot,
        prior: &'a Prior,
        chosen: &'a Chosen<'a>,
        own: &HeldOut,
        ratio: Option<&'a CommonRatio>,
        checked: Option<&'a Checked<'a>>,
    ) -> Result<Self> {
        let of = |bodies: Bodies| bodies.errors(chosen.over(chosen.centred.sums), prior.held.len(), prior);
        let own = [own.clone(), of(Bodies::Unbounded)?, of(Bodies::Described)?];
        Ok(Self { robot, prior, chosen, ratio, checked, own, springs: OnceCell::new() })
    }

    pub(super) fn layout(&self) -> &Layout {
        self.chosen.centred.layout
    }

    /// Held-out errors without a change.
    pub(super) fn own(&self, bodies: Bodies) -> &HeldOut {
        &self.own[bodies as usize]
    }

    /// The findings about the changes of a hypothesis that explain the data clearly better, with the share by which the
    /// held-out error falls. Unless each change has a remedy of its own, only the change with the largest fall is offered.
    pub(super) fn offered(&self, row: &Hypothesis) -> Result<Vec<Finding>> {
        let rival = (row.rival)(self).map(|rival| self.errors(&rival, None, row.bodies)).transpose()?;
        let mut better: Vec<(Change, f64)> = Vec::new();
        for change in (row.changes)(self)? {
            let data = self.data(&change)?;
            let errors = |bodies: Bodies| self.errors(&change, data.as_deref(), bodies);
            let (other, other_bodies) = (errors(row.bodies)?, row.bodies.other());
            let is_beaten = rival.as_ref().is_some_and(|rival| rival.total() < other.total());
            let share = self.own(row.bodies).gain(&other, change.deciding());
            let Some(share) = share.filter(|_| !is_beaten && (row.accepts)(self, &other)) else { continue };
            if !self.own(other_bodies).is_exceeded_by(&errors(other_bodies)?) {
                better.push((change, share));
            }
        }
        if !row.each {
            better.sort_by(|a, b| b.1.total_cmp(&a.1));
            better.truncate(1);
        }
        let mut found = Vec::new();
        for (change, share) in better {
            let Some(finding) = (row.finding)(self, &change, &row.rule)? else { continue };
            let percent = 100.0 * share;
            let message = format!("{}; the error on held-out data falls by {percent:.0} %", finding.message);
            let subject = change.joint().map_or(Subject::Whole, |joint| self.robot.subject(joint));
            found.push(Finding { message, ..finding }.with(FALL, percent, "%").of(subject));
        }
        Ok(found)
    }

    /// The choice of terms with a change, not fitted yet.
    ///
    /// - `data`: data with the change; `None` if the change does not affect the data
    pub(super) fn changed<'b>(&'b self, change: &Change, data: Option<&'b Data>) -> Chosen<'b> {
        let (layout, sums) =
            data.map_or((self.layout(), self.chosen.centred.sums), |data| (&data.layout, &data.sums));
        let mut chosen = self.chosen.with_more(layout, sums, HELD);
        match change {
            Change::Spring(joint) => chosen.weighting.trust[self.layout().parameters + joint] = FREE,
            Change::Load(joints) => joints.iter().for_each(|joint| chosen.model.load[*joint] = true),
            Change::Order(order) => chosen.reorder(order),
            _ => {}
        }
        for (joint, gain) in chosen.values.gains.iter_mut().enumerate() {
            *gain *= change.factor(joint);
        }
        chosen
    }

    /// Held-out errors with a change, in the units and the order of the recorded efforts.
    pub(super) fn errors(&self, change: &Change, data: Option<&Data>, bodies: Bodies) -> Result<HeldOut> {
        let prior = data.map_or(self.prior, |data| &data.prior);
        let mut found = bodies.errors(self.changed(change, data), self.layout().parameters, prior)?;
        found.rss.iter_mut().enumerate().for_each(|(joint, rss)| *rss /= change.factor(joint).powi(2));
        if let Change::Order(order) = change {
            let moved = found.rss.clone();
            order.iter().zip(moved).for_each(|(column, rss)| found.rss[*column] = rss);
        }
        Ok(found)
    }

    /// Data with a change; `None` if the sums of the original data are sufficient.
    pub(super) fn data(&self, change: &Change) -> Result<Option<Rc<Data>>> {
        let Some(&Checked { task, .. }) = self.checked else { return Ok(None) };
        let of = |task: Task| Some(Rc::new(Data::of(&task)));
        Ok(match change {
            Change::Factor(..) | Change::Unit(_) => None,
            Change::Gravity(gravity) => of(Task { gravity: *gravity, ..task.clone() }),
            Change::Tilt(gravity) => {
                // The gravity part under this gravity minus the part under the described gravity.
                let turned = gravity - task.robot.gravity().map_or(*gravity, Vector3::from);
                let more = |y: &[f64], regressor: &mut [f64]| {
                    let turned = at_rest(task.robot, y, task.layout.joints, turned);
                    regressor.iter_mut().zip(turned).for_each(|(entry, turned)| *entry += turned);
                };
                Some(Rc::new(task.with_more(0, &more, Data::of)))
            }
            Change::Order(order) => {
                let runs: Vec<PreparedRun> = task.runs.iter().map(|run| run.in_order(order)).collect();
                let layout = Layout::new(task.robot, &runs, task.settings.steepness.as_deref(), false)?;
                of(Task { runs: &runs, layout: &layout, first_fit: None, ..task.clone() })
            }
            Change::Delay(joint, seconds) => {
                let mut delays = vec![0.0; task.runs.first().map_or(0, |run| run.efforts.len())];
                task.layout.acting(*joint).for_each(|(effort, _)| delays[effort] = *seconds);
                let runs = task.runs.iter().map(|run| run.clone().without_delays(&delays));
                of(Task { runs: &runs.collect::<Vec<_>>(), ..task.clone() })
            }
            Change::Spring(_) => {
                Some(Rc::clone(self.springs.get_or_init(|| Rc::new(Data::with_springs(task)))))
            }
            Change::Load(joints) => {
                let widths = task.layout.steepness.iter().zip(&self.chosen.model.coulomb);
                let steepness: Vec<f64> = widths.map(|(steepness, width)| steepness[*width]).collect();
                let layout = Layout::of(task.robot, task.runs, task.settings, Some(&steepness), true)?;
                let loads = Loads::of(task.layout, &self.chosen.values.unknowns, joints);
                of(Task { layout: &layout, loads: Some(&loads), ..task.clone() })
            }
        })
    }
}

impl Data {
    /// Data with the stiffness of a spring at each joint as an additional parameter.
    fn with_springs(task: &Task) -> Self {
        let (layout, count) = (task.layout, task.layout.parameters);
        let columns = |y: &[f64], regressor: &mut [f64]| {
            let rows = regressor.chunks_exact_mut(count + layout.joints).zip(y).enumerate();
            rows.for_each(|(joint, (row, y))| row[count + joint] = *y);
        };
        task.with_more(layout.joints, &columns, Self::of)
    }

    pub(super) fn of(task: &Task) -> Self {
        Self { layout: task.layout.clone(), prior: task.prior.clone(), sums: task.sums_of(&moving) }
    }
}

/// Regressor at rest under a gravity; zero without gravity.
pub(super) fn at_rest(robot: &dyn Robot, y: &[f64], joints: usize, gravity: Vector3<f64>) -> Vec<f64> {
    let mut regressor = vec![0.0; joints * robot.parameters().len()];
    if gravity != Vector3::zeros() {
        robot.regressor_at_rest(y, gravity.into(), &mut regressor);
    }
    regressor
}
