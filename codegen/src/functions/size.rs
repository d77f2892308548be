//! Omission of functions that are too large to compile or read.
//!
//! The size is the number of operations in the printed text. A loop over joints counts once, for any number
//! of iterations.

use crate::diagnostic::Diagnostic;
use crate::dynamics::formulation::Formulation;
use crate::dynamics::recursion::composite;
use crate::functions::catalogue::{self, Estimate};
use crate::functions::form::Forms;
use crate::functions::function::Function;
use crate::graph::{Cost, Graph};
use crate::kinematics::{Mechanism, Number};
use crate::model::Model;
use crate::program::Program;
use crate::program::arrays::{ArrayForm, Arrays, Step};
use crate::program::cost::count;

/// Default limit for the number of operations of a function. The function `inertial_regressor` of a robot
/// with 60 joints has half of this number. The compile time at this limit has not been measured.
pub const MOST_OPERATIONS: usize = 300_000;

/// Ratio of the limit for unrolled loops to the limit for printed code. The interpreter needs unrolled loops,
/// and uses about 200 bytes per operation.
const UNROLLED: usize = 10;

/// Estimate of the least number of operations of a function.
fn estimated(estimate: Estimate, mechanism: &Mechanism<Number>) -> usize {
    let joints = mechanism.bodies.len();
    // Pairs include each joint with itself.
    let pairs = || mechanism.pairs() + joints;
    match estimate {
        Estimate::MassMatrix => match pairs() {
            pairs if pairs > MANY_PAIRS => pairs,
            _ => mass_matrix_operations(mechanism),
        },
        Estimate::Regressor => 40 * pairs(),
        Estimate::Inverse => 5_usize.saturating_mul(joints.saturating_pow(3)),
        Estimate::Pairs => 70 * pairs(),
    }
}

/// Number of pairs of joints above which even the plain mass matrix needs gigabytes of memory. The estimate
/// of its operations is then one operation for each pair.
const MANY_PAIRS: usize = 3 * MOST_OPERATIONS;

/// Largest number of joints for which all functions of a robot are derived without an estimate of their size.
const FEW_JOINTS: usize = 50;

/// A function that is left out because it is too large.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TooLarge {
    pub name: String,
    operations: usize,
    /// Whether the number of operations is a lower estimate.
    is_estimate: bool,
    /// Whether the number of operations counts unrolled loops.
    are_loops: bool,
    /// Largest number of operations that is allowed for the function.
    most: usize,
}

/// Finds the functions that are known to be too large before they are derived.
pub(super) fn before(model: &Model, names: &[String], forms: &Forms<'_>, most: usize) -> Vec<TooLarge> {
    if model.coordinates.len() <= FEW_JOINTS {
        return Vec::new();
    }
    let estimated = names.iter().filter_map(|name| {
        let (estimate, are_loops) = forms.estimate(catalogue::row(name)?)?;
        Some((name, estimate, are_loops))
    });
    let estimated: Vec<_> = estimated.collect();
    let of = |estimate: Estimate| {
        let names = estimated.iter().filter(move |each| each.1 == estimate);
        too_large(forms.mechanism(), estimate, &names.collect::<Vec<_>>(), most)
    };
    Estimate::ALL.into_iter().flat_map(of).collect()
}

/// Finds functions that are too large according to one method of estimation.
fn too_large(
    mechanism: &Mechanism<Number>,
    estimate: Estimate,
    functions: &[&(&String, Estimate, bool)],
    most: usize,
) -> Vec<TooLarge> {
    // The estimate takes time, so it is not made without need.
    if functions.is_empty() {
        return Vec::new();
    }
    let operations = estimated(estimate, mechanism);
    let too_large = functions.iter().map(|&&(name, _, are_loops)| TooLarge {
        name: name.clone(),
        operations,
        is_estimate: true,
        are_loops,
        most: match are_loops {
            true => most.saturating_mul(UNROLLED),
            false => most,
        },
    });
    too_large.filter(|each| each.operations > each.most).collect()
}

/// Returns the size of a derived function if the function is too large; otherwise `None`.
pub(super) fn after(function: &Function, most: usize) -> Option<TooLarge> {
    let operations = emitted(function);
    (operations > most).then(|| TooLarge {
        name: function.name.clone(),
        operations,
        is_estimate: false,
        are_loops: false,
        most,
    })
}

/// Number of operations in the printed text of a function.
pub(super) fn emitted(function: &Function) -> usize {
    match &function.arrays {
        None => operations(&function.program),
        Some(ArrayForm::Steps(arrays)) => emitted_in_loops(arrays),
        // The text is a call and a few loops.
        Some(ArrayForm::Affine(_)) => 0,
    }
}

/// Number of operations in the straight-line code before the loops and in the loop bodies over joints. All
/// other loops have the same text for all robots.
fn emitted_in_loops(arrays: &Arrays) -> usize {
    let bodies = arrays.steps.iter().map(|step| match step {
        Step::Map(map) => operations(&map.body),
        _ => 0,
    });
    operations(&arrays.setup) + bodies.sum::<usize>()
}

fn operations(program: &Program) -> usize {
    let cost = count(program);
    cost.multiplications + cost.additions + cost.divisions
}

impl TooLarge {
    fn takes(&self) -> String {
        let operations = self.operations;
        match (self.are_loops, self.is_estimate) {
            (true, _) => format!("loops that replace about {operations} operations"),
            (false, true) => format!("about {operations} operations or more"),
            (false, false) => format!("{operations} operations"),
        }
    }

    /// Error for a function that is requested by name but is too large.
    pub(super) fn error(&self, model: &Model) -> Diagnostic {
        let (joints, most) = (model.coordinates.len(), self.most);
        let takes = self.takes();
        Diagnostic::error(
            "too-large",
            format!("`{}` needs {takes} for {joints} joints, but the limit is {most} operations", self.name),
        )
        .help(format!(
            "raise the limit (`--max-operations {}`), or generate smaller functions (`gelenk generate \
             --functions inverse_dynamics`)",
            self.limit_needed()
        ))
    }

    /// Smallest value of `--max-operations` with which the function is generated.
    fn limit_needed(&self) -> usize {
        match self.are_loops {
            true => rounded_up(self.operations.div_ceil(UNROLLED)),
            false => rounded_up(self.operations),
        }
    }
}

/// Makes the note about functions that are too large and were not requested by name.
pub(super) fn note(model: &Model, left_out: &[TooLarge], callers: &str, most: usize) -> Diagnostic {
    let listed = left_out.iter().map(|each| format!("`{}` ({})", each.name, each.takes()));
    let listed: Vec<String> = listed.collect();
    let needed = left_out.iter().map(TooLarge::limit_needed).max().unwrap_or(most);
    let message = format!(
        "these functions are omitted, because with {} joints they exceed the limit of {most} operations: {}{callers}",
        model.coordinates.len(),
        listed.join(", "),
    );
    Diagnostic::note("left-out", message).help(format!("`--max-operations {needed}` generates all of them"))
}

/// Rounds a number of operations up to two digits, with a margin for errors of the estimate.
fn rounded_up(operations: usize) -> usize {
    let unit = 10_usize.pow(operations.max(10).ilog10() - 1);
    (operations / unit + 2) * unit
}

/// Number of operations of the mass matrix by the usual recursion. The search for a cheaper formulation would
/// take minutes for large robots.
fn mass_matrix_operations(mechanism: &Mechanism<Number>) -> usize {
    let graph = Graph::new();
    let y = mechanism.positions_on(&graph);
    let formulation = Formulation::plain(mechanism.bodies.len());
    let mechanism = formulation.mechanism(&graph, mechanism);
    let matrix = composite::mass_matrix(&mechanism, &formulation, &y).concat();
    let edges: Vec<_> = matrix.iter().map(|x| x.edge()).collect();
    let cost = Cost::of(&graph, &edges);
    usize::try_from(cost.multiplications + cost.additions).unwrap_or(usize::MAX)
}
