//! Closed forms of M, k, q and B with symbolic parameters, from the computer algebra system Symbolica.
//!
//! This folder requires the feature `symbolica`, which is off by default, and is the only one that uses
//! Symbolica. Generated code does not depend on it. Symbolica is source-available, not open source: without a
//! key it is for non-commercial use, one instance and one core per machine. Therefore all functions take an
//! [`Instance`] and run on one thread. Symbolica prints a banner to standard output at its first use.
//!
//! The equations are Lagrange's equations of the second kind. They share only the model with the recursive
//! derivation of [`crate::dynamics`], so they also verify it.
//!
//! Closed forms grow quickly with the number of joints, so generated code does not use them. The limit is
//! [`MAXIMUM_JOINTS`].

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

/// Largest number of coordinates; closed forms of more are too long to read.
pub const MAXIMUM_JOINTS: usize = 3;

/// Largest number of coordinates and angles that are not multiples of 90°, together. Each multiplies the
/// number of terms by up to five: three general joints give 30 kB of formulas with one such angle, 130 kB
/// with two, hours of computation with three.
pub const MAXIMUM_ANGLES: usize = 4;

/// `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a model with symbols instead of numbers.
///
/// - `instance`: the right to use Symbolica
///
/// # Errors
/// The code of a [`Kind`](crate::functions::catalogue::Kind) without closed forms; `too-many-joints` for more
/// than [`MAXIMUM_JOINTS`] coordinates, `too-many-angles` beyond [`MAXIMUM_ANGLES`].
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

/// Checks that a model is small enough for closed forms, and that M, k, q and B are its complete equations.
/// Needs no instance of Symbolica.
///
/// # Errors
/// See [`derive()`].
pub fn check_size(model: &Model) -> Result<(), Diagnostics> {
    CLOSED_FORMS.check(model)?;
    check_coordinates(model)
}

/// Formulas grow with the coordinates, and with the angles that stay in them.
fn check_coordinates(model: &Model) -> Result<(), Diagnostics> {
    let n = model.coordinates.len();
    if n > MAXIMUM_JOINTS {
        let message =
            format!("closed forms support up to {MAXIMUM_JOINTS} coordinates; `{}` has {n}", model.name);
        let problem = Diagnostic::error("too-many-joints", message).help(
            "hold joints in the description (`held = 0`), or print the equations with intermediate values: \
             `gelenk inspect program`",
        );
        return Err(Diagnostics::new(vec![problem]));
    }
    let angles = letters::count_angles(&Bodies::new(model));
    if n + angles > MAXIMUM_ANGLES {
        let message = format!(
            "closed forms support up to {MAXIMUM_ANGLES} coordinates and angles that are not multiples of \
             90°; `{}` has {n} and {angles}",
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
