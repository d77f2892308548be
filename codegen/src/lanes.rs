//! Functions over lanes. A function over lanes computes eight states at once, and each state is a lane. This
//! module checks and resolves the names of the functions that are requested over lanes.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::function_names;
use crate::functions::catalogue;
use crate::functions::composition::Composition;
use crate::functions::form::is_large;
use crate::functions::function::Function;
use crate::model::Model;
use crate::program::cost::count;
use crate::program::lanes;

/// Names of the functions that are requested over lanes, that is for eight states at once.
pub(crate) struct Lanes(Vec<String>);

impl Lanes {
    /// Takes the names that the caller requests, or the names in the description if the caller requests none.
    ///
    /// - `asked`: names that the caller requests; may be empty
    ///
    /// # Errors
    /// Returns `unknown-function` for each name that the model does not have.
    pub(crate) fn new(model: &Model, asked: &[String]) -> Result<Self, Diagnostics> {
        let asked = match asked.is_empty() {
            true => &model.options.lanes,
            false => asked,
        };
        catalogue::check_names(model, asked)?;
        Ok(Self(asked.to_vec()))
    }

    /// The requested names as written, for example with a group `all` instead of its functions.
    pub(crate) fn names(&self) -> &[String] {
        &self.0
    }

    /// Returns the names of the functions to generate, with those for eight states at once added. A selection
    /// of all functions is unchanged.
    pub(crate) fn selected_with(&self, selection: &[String]) -> Vec<String> {
        let mut all = selection.to_vec();
        if !function_names::select_all(selection) {
            let others = self.0.iter().filter(|name| !selection.contains(name));
            all.extend(others.cloned());
        }
        all
    }

    /// Returns the functions that can be written for eight states at once, and a note for each requested
    /// function that cannot.
    pub(crate) fn possible(&self, functions: &[Function]) -> (Vec<String>, Vec<Diagnostic>) {
        let (mut possible, mut notes) = (Vec::new(), Vec::new());
        for name in self.resolved(functions) {
            match obstacle(&name, functions) {
                None => {
                    notes.extend(without_loops(&name, functions));
                    possible.push(name);
                }
                Some((reason, help)) => {
                    let message =
                        format!("`{name}` cannot be generated for eight states at once (lanes): {reason}");
                    let note = Diagnostic::note("no-lanes", message);
                    notes.push(help.into_iter().fold(note, Diagnostic::help));
                }
            }
        }
        (possible, notes)
    }

    /// Names of the requested functions. A group is replaced by the names of its functions.
    fn resolved(&self, functions: &[Function]) -> Vec<String> {
        let frames = || {
            let of_frames = functions.iter().filter(|function| function.frame.is_some());
            of_frames.map(|function| function.name.clone())
        };
        let names = self.0.iter().flat_map(|name| match name.as_str() {
            function_names::FRAMES => frames().collect(),
            function_names::ALL => functions.iter().map(|function| function.name.clone()).collect(),
            _ => vec![name.clone()],
        });
        names.collect()
    }
}

/// Names of the straight-line functions that can be written over lanes (for eight states at once). Tools that
/// work on arrays of states call them. Functions with loops over joints are left out, so that their text and
/// their results do not change.
///
/// - `others`: names of further excluded functions
pub(crate) fn of_straight_line_code(functions: &[Function], others: &[String]) -> Vec<String> {
    let functions = functions.iter().filter(|function| !others.contains(&function.name));
    let functions = functions.filter(|function| function.arrays.is_none());
    let possible = functions.filter(|function| lanes::obstacle(&function.program).is_none());
    possible.map(|function| function.name.clone()).collect()
}

/// Returns a note if the function would have loops over joints without the request for eight states at once.
/// With the request, the function for one state is also straight-line code, so that both compute the same
/// bits.
fn without_loops(name: &str, functions: &[Function]) -> Option<Diagnostic> {
    let cost = count(&functions.iter().find(|function| function.name == name)?.program);
    let operations = cost.multiplications + cost.additions;
    (catalogue::may_be_loops(name) && is_large(operations)).then(|| {
        let message = format!(
            "`{name}` is straight-line code of {operations} operations also for one state, because it is requested for \
             eight states at once (lanes)"
        );
        let help = format!(
            "loops over joints may be much shorter and faster for single states: generate a second module \
             for them, without `{name}` in `lanes`"
        );
        Diagnostic::note("lanes-without-loops", message).help(help)
    })
}

/// Reason why a function cannot be written for eight states at once, and remedy; `None` if it can.
fn obstacle(name: &str, functions: &[Function]) -> Option<(&'static str, Option<String>)> {
    if let Some(function) = functions.iter().find(|function| function.name == name) {
        return lanes::obstacle(&function.program).map(|reason| (reason, None));
    }
    let composition = Composition::ALL.into_iter().find(|function| function.name() == name);
    Some(match composition {
        Some(composition) => (
            "it is a fixed text that calls another function",
            Some(format!("request `{}` in `lanes` instead", composition.calls())),
        ),
        None => ("the function is not generated", Some(format!("add `{name}` to the functions"))),
    })
}
