//! Closed forms: formulas of the equations of motion with symbols instead of numbers. The computer algebra
//! system Symbolica derives them.
//!
//! This module requires the feature `symbolica`, which is off by default. No other module uses Symbolica, and
//! generated code does not depend on Symbolica.
//!
//! Symbolica is source-available, but not open source. Without a key, only non-commercial use with one
//! instance and one core per machine is permitted. Therefore [`derive()`] takes an [`Instance`] and runs on
//! one thread. Symbolica prints a banner to standard output at its first use.
//!
//! The equations are Lagrange's equations of the second kind. Only the model is shared with the recursive
//! derivation in [`crate::dynamics`], so closed forms are an independent check of that derivation.
//!
//! Closed forms grow quickly with the number of joints, so generated code does not use them. They are
//! available for robots with up to [`MAXIMUM_JOINTS`] coordinates.

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

/// Largest number of coordinates of a robot with closed forms. More coordinates make formulas that are too
/// long to read.
pub const MAXIMUM_JOINTS: usize = 3;

/// Largest sum of the number of coordinates and the number of constant angles that are not multiples of 90°.
/// Each coordinate or angle multiplies the number of terms by up to five. For three general joints, the
/// formulas have 30 kB with one angle and 130 kB with two angles. With three angles, the computation takes
/// hours.
pub const MAXIMUM_ANGLES: usize = 4;

/// Derives the equations of motion `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a model with symbols instead of
/// numbers.
///
/// - `instance`: permission to use Symbolica
///
/// # Errors
/// - the code of a [`Kind`](crate::functions::catalogue::Kind) of robots for which closed forms are not
///   available
/// - `too-many-joints` if the model has more than [`MAXIMUM_JOINTS`] coordinates
/// - `too-many-angles` if the number of coordinates plus the number of angles exceeds [`MAXIMUM_ANGLES`]
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

/// Checks that closed forms of a model are possible. The model must be small enough, and `M ÿ + k = q + B u`
/// must be its complete equations of motion. No instance of Symbolica is needed.
///
/// # Errors
/// Returns the errors of [`derive()`].
pub fn check_size(model: &Model) -> Result<(), Diagnostics> {
    CLOSED_FORMS.check(model)?;
    check_coordinates(model)
}

/// Checks the numbers of coordinates and angles, because formulas grow with these numbers.
fn check_coordinates(model: &Model) -> Result<(), Diagnostics> {
    let n = model.coordinates.len();
    if n > MAXIMUM_JOINTS {
        let message =
            format!("closed forms support up to {MAXIMUM_JOINTS} coordinates, but `{}` has {n}", model.name);
        let problem = Diagnostic::error("too-many-joints", message).help(
            "hold joints in the description (`held = 0`), or print the equations with intermediate values: \
             `gelenk inspect program`",
        );
        return Err(Diagnostics::new(vec![problem]));
    }
    let angles = letters::count_angles(&Bodies::new(model));
    if n + angles > MAXIMUM_ANGLES {
        let message = format!(
            "closed forms support up to {MAXIMUM_ANGLES} coordinates and constant angles together (multiples of 90° do \
             not count), but `{}` has {n} coordinates and {angles} angles",
            model.name
        );
        let problem = Diagnostic::error("too-many-angles", message).help(
            "`--snap-angles 1e-4` rounds angles within 1e-4 rad of a multiple of 90°; `gelenk inspect \
             program` prints the equations with intermediate values for any angles",
        );
        return Err(Diagnostics::new(vec![problem]));
    }
    Ok(())
}

/// Converts Symbolica's expressions to sums of [`Term`]s, and collects the lumped constants.
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

    /// Splits the bias forces into Coriolis forces and gravity. Terms with velocities belong to the Coriolis
    /// forces, terms without velocities to gravity.
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
