//! Selection of functions, and omission of functions that cannot be generated.
//!
//! Without a selection, all functions are requested, and a note lists the functions that cannot be generated.
//! If a function requested by name cannot be generated, an error states the reason.

use super::derive;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dynamics::search::routes::Formulations;
use crate::function_names;
use crate::functions::catalogue::{self, FrameQuantity, Quantity, Refusal, Refusals};
use crate::functions::composition::Composition;
use crate::functions::form::{Form, Forms};
use crate::functions::function::{FrameFunction, Function};
use crate::functions::size::{self, TooLarge};
use crate::kinematics::Mechanism;
use crate::model::{Frame, Model};
use crate::program::arrays::ArrayForm;

/// Largest number of frames whose functions are generated if they are not requested by name.
const MOST_FRAMES: usize = 500;

/// A request for functions of a model.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// Names of functions and groups. `frames` requests the functions of all named frames. `all` or an empty
    /// list requests all functions, except the functions that are generated only on request (by name).
    pub names: &'a [String],
    /// Largest number of operations of a function. Larger functions are not generated.
    pub most: usize,
    /// Form of large functions: straight-line code or loops over joints.
    pub form: Form,
    /// Functions that are always straight-line code.
    pub straight: &'a [String],
}

impl Request<'_> {
    fn is_named(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }
}

/// The functions of a module, and notes about omitted functions.
#[derive(Debug, Clone)]
pub struct Selection {
    /// Functions that have their own program.
    pub functions: Vec<Function>,
    /// Functions that call other generated functions (`discretize`, `step`, `step_derivatives`).
    pub compositions: Vec<Composition>,
    /// Notes about omitted functions, with reasons.
    pub notes: Vec<Diagnostic>,
}

/// Derives the requested functions and the functions that they call.
///
/// # Errors
/// - `unknown-function` for each name that the model lacks
/// - `too-large`, or the code of the robot's [`Kind`](catalogue::Kind), for each function that is requested
///   by name but cannot be generated
pub fn derive(model: &Model, request: &Request<'_>) -> Result<Selection, Diagnostics> {
    catalogue::check_names(model, request.names)?;
    let mechanism = Mechanism::new(model);
    let formulations = Formulations::new(model, &mechanism);
    let forms = Forms::new(model, &formulations, request.form, request.straight);
    let (mut left_out, refusals) = (LeftOut::default(), Refusals::new(model));
    let mut compositions = catalogue::compositions(request.names);
    compositions.retain(|each| {
        let refusal = refusals.of(each.name());
        left_out.is_possible(each.name(), refusal, request.is_named(each.name()))
    });
    let wanted = Wanted::new(request, &forms, compositions);
    let mut rows: Vec<_> = rows(model).filter(|row| wanted.includes(row)).collect();
    rows.retain(|row| {
        let (name, refusal) = (row.name(), refusals.of(row.row_name()));
        left_out.is_possible(&name, refusal, wanted.is_asked_for(&name))
    });
    or_problems((), std::mem::take(&mut left_out.problems))?;
    let rows = left_out.many_frames(model, &wanted, rows);
    let rows = left_out.too_large_before(model, &wanted, rows, &forms)?;
    let definiteness = model.definiteness();
    let mut functions: Vec<Function> = Vec::new();
    for row in rows {
        let mut function = row.derive(model, &formulations, &forms);
        derive::say_definiteness(definiteness, &mut function);
        let is_callable = |name: &str| functions.iter().any(|other| other.name == name);
        if let Some(ArrayForm::Affine(form)) = &function.arrays
            && !is_callable(form.name)
        {
            left_out.callers.push(function.name);
        } else if left_out.fits(model, &wanted, &function)? {
            functions.push(function);
        }
    }
    let is_generated = |each: &Composition| functions.iter().any(|f| f.name == each.calls());
    let (compositions, missing): (Vec<_>, Vec<_>) =
        wanted.compositions.iter().copied().partition(is_generated);
    let missing = missing.iter().map(|each| each.name().to_owned());
    left_out.callers.extend(missing);
    Ok(Selection { notes: left_out.notes(model, request.most), functions, compositions })
}

/// Derives the selected functions of a model and the functions that they call. An empty selection or `all`
/// requests all functions that can be generated, except the functions that are generated only on request (by
/// name). `frames` requests the functions of all named frames.
///
/// - `most`: largest number of operations of a function, see
///   [`MOST_OPERATIONS`](crate::functions::size::MOST_OPERATIONS)
///
/// # Errors
/// See [`derive()`].
pub fn derive_functions(
    model: &Model,
    selection: &[String],
    most: usize,
) -> Result<Vec<Function>, Diagnostics> {
    derive_in_form(model, selection, most, Form::Cheapest, &[])
}

/// Derives functions like [`derive_functions()`], but the caller chooses the form of large functions.
///
/// - `straight`: functions that are always straight-line code
///
/// # Errors
/// See [`derive()`].
pub fn derive_in_form(
    model: &Model,
    selection: &[String],
    most: usize,
    form: Form,
    straight: &[String],
) -> Result<Vec<Function>, Diagnostics> {
    let request = Request { names: selection, most, form, straight };
    Ok(derive(model, &request)?.functions)
}

/// A row of the catalogue of functions for a model.
enum Row<'m> {
    Quantity(&'static Quantity),
    Frame(&'m Frame, &'static FrameQuantity),
}

/// Rows of all functions that a model can have, in the order of the module.
fn rows(model: &Model) -> impl Iterator<Item = Row<'_>> {
    let quantities = catalogue::all_quantities(model).map(Row::Quantity);
    let frames = model.frames.iter().flat_map(|frame| {
        let quantities = catalogue::FRAME_QUANTITIES.iter();
        quantities.map(move |quantity| Row::Frame(frame, quantity))
    });
    quantities.chain(frames)
}

impl Row<'_> {
    /// Name of the function in the table of kinds of robots.
    fn row_name(&self) -> &'static str {
        match self {
            Self::Quantity(quantity) => quantity.name,
            Self::Frame(_, quantity) => quantity.kind.pattern(),
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Quantity(quantity) => quantity.name.to_owned(),
            Self::Frame(frame, quantity) => FrameFunction::new(frame, quantity.kind).name(),
        }
    }

    fn derive(&self, model: &Model, formulations: &Formulations<'_>, forms: &Forms<'_>) -> Function {
        match self {
            Self::Quantity(quantity) => derive::derive_quantity(model, formulations, quantity, forms),
            Self::Frame(frame, quantity) => derive::derive_frame(model, formulations, frame, quantity),
        }
    }
}

/// The requested functions, and the functions that they call.
struct Wanted<'a> {
    request: &'a Request<'a>,
    compositions: Vec<Composition>,
    /// Functions that requested functions call.
    called: Vec<&'static str>,
}

impl<'a> Wanted<'a> {
    fn new(request: &'a Request<'a>, forms: &Forms<'_>, compositions: Vec<Composition>) -> Self {
        let calls = compositions.iter().map(|each| each.calls());
        let mut called: Vec<&'static str> = calls.collect();
        let named = request.names.iter().map(String::as_str);
        let callees = named.chain(called.clone()).filter_map(|name| forms.callee(name));
        called.extend(callees.collect::<Vec<_>>());
        Self { request, compositions, called }
    }

    fn selects_all(&self) -> bool {
        function_names::select_all(self.request.names)
    }

    fn names_row(&self, row: &Row<'_>) -> bool {
        let is_frame = matches!(row, Row::Frame(..)) && self.request.is_named(function_names::FRAMES);
        is_frame || self.request.is_named(&row.name())
    }

    fn includes(&self, row: &Row<'_>) -> bool {
        let name = row.name();
        let is_included = self.selects_all() && !catalogue::is_on_request(&name);
        is_included || self.names_row(row) || self.called.contains(&&*name)
    }

    /// Whether the function, or a function that calls it, is requested by name.
    fn is_asked_for(&self, name: &str) -> bool {
        let is_straight = self.request.straight.iter().any(|other| other == name);
        let is_called = !self.selects_all() && self.called.contains(&name);
        self.request.is_named(name) || is_straight || is_called
    }
}

/// Functions that cannot be generated, with reasons.
#[derive(Default)]
struct LeftOut {
    /// Functions that robots with some property lack, grouped by the reason.
    refused: Vec<(Refusal, Vec<String>)>,
    /// Errors of functions that are requested by name but cannot be generated.
    problems: Vec<Diagnostic>,
    too_large: Vec<TooLarge>,
    /// Number of functions of frames that are left out, because the robot has very many frames.
    of_frames: usize,
    /// Functions that are left out because they call a function that is left out.
    callers: Vec<String>,
}

impl LeftOut {
    /// Whether the function can be generated. If not, the reason is stored as an error or for a note.
    fn is_possible(&mut self, name: &str, refusal: Option<Refusal>, is_asked_for: bool) -> bool {
        let Some(refusal) = refusal else { return true };
        if is_asked_for {
            self.problems.push(refusal.error(&format!("there is no function `{name}`")));
            return false;
        }
        let name = format!("`{name}`");
        match self.refused.iter_mut().find(|(other, _)| *other == refusal) {
            Some((_, names)) => names.push(name),
            None => self.refused.push((refusal, vec![name])),
        }
        false
    }

    /// Removes the functions of frames if there are very many frames. A URDF may have thousands of frames,
    /// and each frame has three functions.
    fn many_frames<'m>(&mut self, model: &Model, wanted: &Wanted<'_>, rows: Vec<Row<'m>>) -> Vec<Row<'m>> {
        if model.frames.len() <= MOST_FRAMES || !wanted.selects_all() {
            return rows;
        }
        let count = rows.len();
        let is_kept = |row: &Row<'_>| matches!(row, Row::Quantity(_)) || wanted.names_row(row);
        let kept: Vec<_> = rows.into_iter().filter(is_kept).collect();
        self.of_frames = count - kept.len();
        kept
    }

    /// Removes the functions that are known to be too large before their derivation.
    fn too_large_before<'m>(
        &mut self,
        model: &Model,
        wanted: &Wanted<'_>,
        rows: Vec<Row<'m>>,
        forms: &Forms<'_>,
    ) -> Result<Vec<Row<'m>>, Diagnostics> {
        let names: Vec<String> = rows.iter().map(Row::name).collect();
        let too_large = size::before(model, &names, forms, wanted.request.most);
        let is_too_large = |name: &str| too_large.iter().any(|each| each.name == name);
        let possible = rows.into_iter().filter(|row| !is_too_large(&row.name()));
        let possible = possible.collect();
        let (asked, others): (Vec<_>, Vec<_>) =
            too_large.into_iter().partition(|each| wanted.is_asked_for(&each.name));
        self.too_large = others;
        let problems = asked.iter().map(|each| each.error(model)).collect();
        or_problems(possible, problems)
    }

    /// Whether the number of operations of a derived function is within the limit.
    fn fits(&mut self, model: &Model, wanted: &Wanted<'_>, function: &Function) -> Result<bool, Diagnostics> {
        let Some(too_large) = size::after(function, wanted.request.most) else {
            return Ok(true);
        };
        if wanted.is_asked_for(&function.name) {
            return Err(too_large.error(model).into());
        }
        self.too_large.push(too_large);
        Ok(false)
    }

    fn notes(&self, model: &Model, most: usize) -> Vec<Diagnostic> {
        let refused = self.refused.iter();
        let mut notes: Vec<Diagnostic> = refused
            .map(|(refusal, names)| {
                refusal.note(&format!("these functions are left out: {}", names.join(", ")))
            })
            .collect();
        if self.of_frames > 0 {
            let message = format!(
                "the robot has {} frames, more than {MOST_FRAMES}, so {} functions of frames are omitted",
                model.frames.len(),
                self.of_frames
            );
            let help = "request single functions by name (`frame_<name>_pose`), or all with `frames`";
            notes.push(Diagnostic::note("left-out", message).help(help));
        }
        if !self.too_large.is_empty() {
            let callers: Vec<String> = self.callers.iter().map(|name| format!("`{name}`")).collect();
            let callers = match callers.is_empty() {
                true => String::new(),
                false => format!(", and their callers {}", callers.join(", ")),
            };
            notes.push(size::note(model, &self.too_large, &callers, most));
        }
        notes
    }
}

fn or_problems<T>(value: T, problems: Vec<Diagnostic>) -> Result<T, Diagnostics> {
    match problems.is_empty() {
        true => Ok(value),
        false => Err(Diagnostics::new(problems)),
    }
}
