//! Checks that the moving bodies are physically possible.
//!
//! Bodies fixed to the base do not enter the dynamics and are not checked. Inertias of a TOML file must be
//! correct, because its author can change them. Inertias of a URDF or an MJCF are often published by somebody
//! else. They are accepted with one warning if the mass matrix is positive definite.

use super::tree::Tree;
use crate::description::{BodyDescription, RobotDescription};
use crate::diagnostic::{Diagnostic, Report, Severity, Span};
use crate::model::inertia::{self, Flaw};
use crate::model::regularity::{Pivots, STATES};
use crate::wording::listed;
use gelenk_formula::Formula;

/// A body that is physically impossible, and the reason.
struct Finding<'d> {
    body: &'d BodyDescription,
    flaw: Flaw,
}

/// Physically impossible bodies whose inertia is from a URDF or an MJCF.
pub(super) struct Published<'d> {
    findings: Vec<Finding<'d>>,
    moving: usize,
}

/// Reports impossible bodies of TOML files. Returns the impossible bodies of URDFs and MJCFs for a later
/// report by [`Published::report`].
///
/// - `tree`: the tree of the links; `None` if the links do not form a tree. All bodies are then checked.
pub(super) fn check<'d>(
    robot: &'d RobotDescription,
    tree: Option<&Tree>,
    defaults: &[f64],
    report: &mut Report,
) -> Published<'d> {
    let moving = tree.map(|tree| tree.moving(robot));
    let moves = |body: &&BodyDescription| match (&moving, tree) {
        (Some(moving), Some(tree)) => {
            let link = tree.index.get(&body.link.value);
            link.is_none_or(|link| moving[*link])
        }
        _ => true,
    };
    let bodies: Vec<&BodyDescription> = robot.bodies.iter().filter(moves).collect();
    let mut published = Published { findings: Vec::new(), moving: bodies.len() };
    for body in bodies {
        let Some(flaw) = flaw(body, defaults) else {
            continue;
        };
        match body.is_published {
            true => published.findings.push(Finding { body, flaw }),
            false => refuse(body, &flaw, report),
        }
    }
    published
}

fn flaw(body: &BodyDescription, defaults: &[f64]) -> Option<Flaw> {
    let value = |formula: &Formula| formula.evaluate(defaults, 0.0, 0.0);
    let mass = body.mass.as_ref().map_or(0.0, |mass| value(&mass.value));
    let center = body.center_in_link().each_ref().map(value);
    let inertia = body.inertia.as_ref();
    let inertia = inertia.map_or([0.0; 6], |inertia| inertia.value.each_ref().map(value));
    let numbers = [mass].into_iter().chain(center).chain(inertia);
    // Values that are not finite and negative masses were already reported.
    let is_checked = mass >= 0.0 && numbers.into_iter().all(f64::is_finite);
    is_checked.then(|| inertia::check(mass, center, inertia)).flatten()
}

fn refuse(body: &BodyDescription, flaw: &Flaw, report: &mut Report) {
    let name = &body.name.value;
    let (code, message) = match flaw {
        Flaw::Massless => {
            ("inertia-without-mass", format!("body `{name}` has {flaw}, which no real body has"))
        }
        Flaw::Triangle(_) => {
            ("inertia-triangle-inequality", format!("no real body has the inertia of body `{name}`: {flaw}"))
        }
        Flaw::NotPositive(_) => (
            "inertia-not-positive-definite",
            format!("the inertia of body `{name}` is not positive definite: {flaw}"),
        ),
    };
    let span = span_of(body);
    let severity = match flaw {
        _ if body.accept_unphysical => Severity::Note,
        Flaw::Massless => Severity::Warning,
        Flaw::Triangle(_) | Flaw::NotPositive(_) => Severity::Error,
    };
    report.push(Some(span), Diagnostic { severity, ..Diagnostic::note(code, message) });
    if severity != Severity::Note {
        report.help(
            "give the mass, and the inertia about the centre of mass. `accept_unphysical = true` in a TOML body accepts the \
             published value",
        );
    }
}

impl Published<'_> {
    /// Adds one warning about all impossible bodies of URDFs and MJCFs.
    ///
    /// - `pivots`: pivots of the mass matrix; `None` if there is no model
    pub(super) fn report(&self, pivots: Option<&Pivots>, report: &mut Report) {
        let Some(first) = self.findings.first() else {
            return;
        };
        let entries = self.findings.iter();
        let entries = entries.map(|Finding { body, flaw }| format!("`{}` ({flaw})", body.name.value));
        let definite = match pivots.is_some_and(Pivots::are_positive) {
            true => format!(". Its mass matrix is positive definite at {STATES} pseudo-random states"),
            false => String::new(),
        };
        let message = format!(
            "{} of {} moving bodies {} not physical: {}. The model uses the published values{definite}",
            self.findings.len(),
            self.moving,
            if self.findings.len() == 1 { "is" } else { "are" },
            listed(entries),
        );
        report.warning(span_of(first.body), "unphysical-bodies", message);
        report.help(
            "a real body has positive mass. No principal moment about its centre of mass is negative or exceeds the sum of the other two",
        );
    }
}

fn span_of(body: &BodyDescription) -> Span {
    let inertia = body.inertia.as_ref();
    inertia.map_or(body.name.span, |inertia| inertia.span)
}
