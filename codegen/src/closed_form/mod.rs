//! Formulas for people: M, k, q and B in closed form with symbolic parameters, by the computer algebra system
//! Symbolica.
//!
//! This folder stands behind the feature `symbolica`, which is off by default, and is the only one that names
//! it; no generated number depends on it. Symbolica is source-available, not open source: without a key of
//! the user's own it is for non-commercial use, one instance and one core per machine. Hence everything here
//! takes an [`Instance`], the one of this machine, and stays on one thread. Symbolica prints a banner to
//! standard output when it is first used.
//!
//! The equations come from Lagrange's equations of the second kind, energies and frames alone, so that the
//! formulas also check the recursive derivation of [`crate::dynamics`], with which they share nothing but the
//! model.
//!
//! Sizes grow quickly in closed forms (they are why generated code never uses them): [`MAXIMUM_JOINTS`] is
//! the limit.

mod algebra;
mod bodies;
pub mod display;
mod fourier;
mod group;
mod lagrange;
mod letters;
pub mod lock;
mod symbols;
mod terms;

pub use lock::Instance;
pub use symbols::Symbol;
pub use terms::{ClosedForms, Factor, Monomial, Number, Sum, Term, Values, Wave};

use symbolica::atom::{Atom, AtomCore};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::functions::catalogue::CLOSED_FORMS;
use crate::model::Model;
use algebra::Variables;
use bodies::Bodies;
use fourier::Part;
use group::Constants;
use letters::Letters;

/// Closed forms of more coordinates fill pages that nobody reads.
pub const MAXIMUM_JOINTS: usize = 3;

/// Coordinates and angles that are not quarter turns, together: each multiplies the number of terms by five at
/// most. Three general joints with one such angle give 30 kB of formulas, with two 130 kB, with three hours
/// of work.
pub const MAXIMUM_ANGLES: usize = 4;

/// `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a model with letters for its numbers.
///
/// - `instance`: the right to use Symbolica
///
/// # Errors
/// The code of a [`Kind`](crate::functions::catalogue::Kind) that has no closed forms; `too-many-joints` if more than
/// [`MAXIMUM_JOINTS`] coordinates move, `too-many-angles` beyond [`MAXIMUM_ANGLES`].
pub fn derive(model: &Model, instance: &Instance) -> Result<ClosedForms, Diagnostics> {
    check_size(model)?;
    let variables = Variables::new(instance);
    let mut letters = Letters::new(variables, model);
    let equations = lagrange::derive(variables, model, &Bodies::new(model), &mut letters);
    let forces = letters.joint_forces();
    let input_matrix = letters.input_matrix();
    let mut writer = Writer {
        variables,
        phases: model.coordinates.len() + letters.angles.len(),
        letters: &letters,
        constants: Constants::default(),
    };
    let mass_matrix = writer.rows(&equations.mass_matrix)?;
    let (mut coriolis_forces, mut applied_forces) = (Vec::new(), Vec::new());
    for (coordinate, bias) in equations.bias_forces.iter().enumerate() {
        let (coriolis, mut applied) = writer.split(bias)?;
        for (coefficient, basis) in &forces[coordinate] {
            let parts = writer.parts(coefficient)?;
            let basis = (basis.clone(), coordinate);
            applied.extend(writer.constants.group(&parts, &letters.symbols.entries, Some(&basis)));
        }
        coriolis_forces.push(coriolis);
        applied_forces.push(applied);
    }
    let input_matrix = writer.rows(&input_matrix)?;
    let constants = writer.constants.definitions();
    Ok(ClosedForms {
        robot: model.name.clone(),
        coordinates: names_of_coordinates(model),
        inputs: names_of_inputs(model),
        symbols: letters.symbols.entries,
        angles: letters.angles,
        constants,
        mass_matrix,
        coriolis_forces,
        applied_forces,
        input_matrix,
    })
}

/// Checks that a model is small enough for closed forms, and that M, k, q and B are its whole equations. No instance of Symbolica is needed.
///
/// # Errors
/// As [`derive()`].
pub fn check_size(model: &Model) -> Result<(), Diagnostics> {
    CLOSED_FORMS.check(model)?;
    check_coordinates(model)
}

/// Formulas grow with the coordinates, and with the angles that stay in them.
fn check_coordinates(model: &Model) -> Result<(), Diagnostics> {
    let n = model.coordinates.len();
    if n > MAXIMUM_JOINTS {
        let message = format!(
            "closed forms are offered for up to {MAXIMUM_JOINTS} coordinates; `{}` has {n}",
            model.name
        );
        let problem = Diagnostic::error("too-many-joints", message).help(
            "hold joints at a position in the description (`held = 0`), or use `gelenk inspect program` for the \
             equations with their abbreviations",
        );
        return Err(Diagnostics::new(vec![problem]));
    }
    let angles = letters::count_angles(&Bodies::new(model));
    if n + angles > MAXIMUM_ANGLES {
        let message = format!(
            "closed forms are offered for up to {MAXIMUM_ANGLES} coordinates and angles that are not multiples of 90°; `{}` \
             has {n} and {angles}",
            model.name
        );
        let problem = Diagnostic::error("too-many-angles", message).help(
            "`--snap-angles 1e-4` rounds angles within 1e-4 rad of a multiple of 90° to it; `gelenk inspect program` shows \
             the equations with their abbreviations whatever the angles",
        );
        return Err(Diagnostics::new(vec![problem]));
    }
    Ok(())
}

/// From Symbolica's expressions to sums of ours.
struct Writer<'a, 'm> {
    variables: Variables<'m>,
    phases: usize,
    letters: &'a Letters<'m>,
    constants: Constants,
}

impl Writer<'_, '_> {
    fn parts(&self, expression: &Atom) -> Result<Vec<Part>, Diagnostics> {
        fourier::parts(self.variables, &expression.expand(), self.phases)
    }

    fn rows(&mut self, rows: &[Vec<Atom>]) -> Result<Vec<Vec<Sum>>, Diagnostics> {
        let mut all = Vec::new();
        for row in rows {
            let mut sums = Vec::new();
            for entry in row {
                let parts = self.parts(entry)?;
                sums.push(self.group(&parts));
            }
            all.push(sums);
        }
        Ok(all)
    }

    /// `k − q_gravity` as k, which is quadratic in the velocities, and q_gravity, which knows none.
    fn split(&mut self, bias: &Atom) -> Result<(Sum, Sum), Diagnostics> {
        let moves = |part: &Part| {
            let mut factors = part.motion.iter();
            factors.any(|(factor, _)| matches!(factor, Factor::Velocity(_)))
        };
        let (coriolis, gravity): (Vec<Part>, Vec<Part>) = self.parts(bias)?.into_iter().partition(moves);
        let gravity: Vec<Part> = gravity.into_iter().map(Part::negated).collect();
        Ok((self.group(&coriolis), self.group(&gravity)))
    }

    fn group(&mut self, parts: &[Part]) -> Sum {
        self.constants.group(parts, &self.letters.symbols.entries, None)
    }
}

fn names_of_coordinates(model: &Model) -> Vec<String> {
    let joints = model.joints();
    joints.map(|joint| joint.name.clone()).collect()
}

fn names_of_inputs(model: &Model) -> Vec<String> {
    model.inputs().map(|input| input.name().to_owned()).collect()
}
