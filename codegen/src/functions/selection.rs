//! Selection of functions, and functions that are left out.
//!
//! Without a selection all functions are wanted, and what cannot be generated is left out with a note. What
//! is asked for by name is generated, or the reason is an error.

use super::derive;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dynamics::load_friction;
use crate::dynamics::search::routes::Formulations;
use crate::function_names;
use crate::functions::catalogue::{self, FrameQuantity, Quantity};
use crate::functions::composition::Composition;
use crate::functions::form::{Form, Forms};
use crate::functions::function::{FrameFunction, Function};
use crate::functions::size::{self, TooLarge};
use crate::kinematics::Mechanism;
use crate::model::{Frame, Model};
use crate::program::arrays::ArrayForm;

/// Frames whose functions are generated without being asked for.
const MOST_FRAMES: usize = 500;

/// A request for functions of a model.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// Names of functions, `frames` for those of all named frames, `all` for all but those on request, as none.
    pub names: &'a [String],
    /// Operations of the largest function that is wanted, see [`size::MOST_OPERATIONS`].
    pub most: usize,
    /// Form of large functions.
    pub form: Form,
    /// Functions that are straight-line code in any case.
    pub straight: &'a [String],
}

/// The functions of a module.
#[derive(Debug, Clone)]
pub struct Selection {
    /// Functions with a program of their own.
    pub functions: Vec<Function>,
    /// Functions that call them.
    pub compositions: Vec<Composition>,
    /// Notes about functions that were left out, with the reason.
    pub notes: Vec<Diagnostic>,
}

/// Derives the wanted functions, and the functions that they call.
///
/// # Errors
/// `unknown-function` for each name that the model does not have; `singular-mass-matrix` and `too-large` for
/// functions that are asked for by name and cannot be generated.
pub fn derive(model: &Model, request: &Request<'_>) -> Result<Selection, Diagnostics> {
    catalogue::check_names(model, request.names)?;
    let mechanism = Mechanism::new(model);
    let formulations = Formulations::new(model, &mechanism);
    let forms = Forms::new(model, &formulations, request.form, request.straight);
    let wanted = Wanted::new(request, &forms);
    let mut left_out = LeftOut::default();
    let rows = left_out.many_frames(model, &wanted, rows(model));
    let rows = left_out.without_load(model, &wanted, rows)?;
    let rows = left_out.without_inverse(model, &wanted, rows)?;
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
    let (of_driven, compositions): (Vec<_>, Vec<_>) =
        wanted.compositions.iter().copied().partition(|_| !model.driven.is_empty());
    left_out.of_driven(&wanted, &of_driven)?;
    let (compositions, missing): (Vec<_>, Vec<_>) = compositions.into_iter().partition(is_generated);
    let missing = missing.iter().map(|each| each.name().to_owned());
    left_out.callers.extend(missing);
    Ok(Selection { notes: left_out.notes(model, request.most), functions, compositions })
}

/// Derives the selected functions of a model, and those that selected ones call; an empty selection and `all`
/// mean all but those on request and those that cannot be generated, `frames` all functions of named frames.
///
/// - `most`: operations of the largest function that is wanted, see
///   [`MOST_OPERATIONS`](crate::functions::size::MOST_OPERATIONS)
///
/// # Errors
/// As [`derive()`].
pub fn derive_functions(
    model: &Model,
    selection: &[String],
    most: usize,
) -> Result<Vec<Function>, Diagnostics> {
    derive_in_form(model, selection, most, Form::Cheapest, &[])
}

/// As [`derive_functions()`], with the form of large functions chosen.
///
/// - `straight`: functions that are straight-line code in any case
///
/// # Errors
/// As [`derive()`].
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

/// A row of the catalogue for a model.
enum Row<'m> {
    Quantity(&'static Quantity),
    Frame(&'m Frame, &'static FrameQuantity),
}

/// All that can be generated, in the order of the module.
fn rows(model: &Model) -> impl Iterator<Item = Row<'_>> {
    let quantities = catalogue::all_quantities(model).map(Row::Quantity);
    let frames = model.frames.iter().flat_map(|frame| {
        let quantities = catalogue::FRAME_QUANTITIES.iter();
        quantities.map(move |quantity| Row::Frame(frame, quantity))
    });
    quantities.chain(frames)
}

impl Row<'_> {
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

/// A request with the functions that its functions call.
struct Wanted<'a> {
    request: &'a Request<'a>,
    compositions: Vec<Composition>,
    /// Functions that wanted ones call.
    called: Vec<&'static str>,
}

impl<'a> Wanted<'a> {
    fn new(request: &'a Request<'a>, forms: &Forms<'_>) -> Self {
        let compositions = catalogue::compositions(request.names);
        let calls = compositions.iter().map(|each| each.calls());
        let mut called: Vec<&'static str> = calls.collect();
        let named = request.names.iter().map(String::as_str);
        let callees = named.chain(called.clone()).filter_map(|name| forms.callee(name));
        called.extend(callees.collect::<Vec<_>>());
        Self { request, compositions, called }
    }

    fn is_named(&self, name: &str) -> bool {
        self.request.names.iter().any(|other| other == name)
    }

    fn selects_all(&self) -> bool {
        function_names::select_all(self.request.names)
    }

    fn names_row(&self, row: &Row<'_>) -> bool {
        let is_frame = matches!(row, Row::Frame(..)) && self.is_named(function_names::FRAMES);
        is_frame || self.is_named(&row.name())
    }

    fn includes(&self, row: &Row<'_>) -> bool {
        let name = row.name();
        let is_included = self.selects_all() && !catalogue::is_on_request(&name);
        is_included || self.names_row(row) || self.called.contains(&&*name)
    }

    /// The function's name, and the function that needs it if it is not requested itself.
    fn with_caller(&self, name: &str) -> String {
        let mut callers = self.compositions.iter();
        let caller = callers.find(|each| each.calls() == name);
        match caller {
            Some(caller) if !self.is_named(name) => {
                format!("`{name}`, which `{}` calls,", caller.name())
            }
            _ => format!("`{name}`"),
        }
    }

    /// Whether it is asked for by name, itself or by something that calls it.
    fn is_asked_for(&self, name: &str) -> bool {
        let is_straight = self.request.straight.iter().any(|other| other == name);
        let is_called = !self.selects_all() && self.called.contains(&name);
        self.is_named(name) || is_straight || is_called
    }
}

/// Functions of the default selection that cannot be generated.
#[derive(Default)]
struct LeftOut {
    need_inverse: Vec<String>,
    ignore_load: Vec<String>,
    too_large: Vec<TooLarge>,
    /// Functions over a sample time, where joints are driven.
    over_time: Vec<String>,
    /// Functions of frames, if there are very many.
    of_frames: usize,
    /// Functions that call others which are left out.
    callers: Vec<String>,
}

impl LeftOut {
    /// The rows that are wanted. A URDF may have thousands of frames, and each has three functions.
    fn many_frames<'m>(
        &mut self,
        model: &Model,
        wanted: &Wanted<'_>,
        rows: impl Iterator<Item = Row<'m>>,
    ) -> Vec<Row<'m>> {
        let are_too_many = model.frames.len() > MOST_FRAMES;
        let is_kept = |row: &Row<'_>| {
            let is_left_out = are_too_many
                && wanted.selects_all()
                && matches!(row, Row::Frame(..))
                && !wanted.names_row(row);
            self.of_frames += usize::from(is_left_out);
            !is_left_out && wanted.includes(row)
        };
        rows.filter(is_kept).collect()
    }

    /// The rows that hold where friction grows with the load, if it does.
    fn without_load<'m>(
        &mut self,
        model: &Model,
        wanted: &Wanted<'_>,
        rows: Vec<Row<'m>>,
    ) -> Result<Vec<Row<'m>>, Diagnostics> {
        if !load_friction::is_there(model) {
            return Ok(rows);
        }
        let (impossible, possible): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|row| matches!(row, Row::Quantity(quantity) if quantity.ignores_load));
        let names = impossible.iter().map(Row::name);
        let (asked, others): (Vec<_>, Vec<_>) = names.partition(|name| wanted.is_asked_for(name));
        self.ignore_load = others;
        let problem = |name: &String| {
            let message = format!(
                "there is no {} where friction grows with the load: {IGNORES}",
                wanted.with_caller(name)
            );
            Diagnostic::error("load-friction", message).help(INSTEAD)
        };
        or_problems(possible, asked.iter().map(problem).collect())
    }

    /// The rows that can do with a singular mass matrix, if it is one.
    fn without_inverse<'m>(
        &mut self,
        model: &Model,
        wanted: &Wanted<'_>,
        rows: Vec<Row<'m>>,
    ) -> Result<Vec<Row<'m>>, Diagnostics> {
        let motions = model.motions_without_inertia();
        if motions.is_empty() {
            return Ok(rows);
        }
        let (impossible, possible): (Vec<_>, Vec<_>) = rows
            .into_iter()
            .partition(|row| matches!(row, Row::Quantity(quantity) if quantity.needs_inverse));
        let names = impossible.iter().map(Row::name);
        let (asked, others): (Vec<_>, Vec<_>) = names.partition(|name| wanted.is_asked_for(name));
        self.need_inverse = others;
        let listed = motions.join(", ");
        let problem = |name: &String| {
            let message = format!(
                "{} needs the inverse of the mass matrix, which is singular: nothing that has inertia moves with {listed}",
                wanted.with_caller(name)
            );
            Diagnostic::error("singular-mass-matrix", message).help(INERTIA)
        };
        or_problems(possible, asked.iter().map(problem).collect())
    }

    /// Functions over a sample time need the driven motion within it.
    fn of_driven(&mut self, wanted: &Wanted<'_>, functions: &[Composition]) -> Result<(), Diagnostics> {
        let names = functions.iter().map(|each| each.name().to_owned());
        let (asked, others): (Vec<_>, Vec<_>) = names.partition(|name| wanted.is_named(name));
        self.over_time = others;
        let problem = |name: &String| {
            let message = format!("there is no `{name}` where joints are driven: {NEEDS_MOTION}");
            Diagnostic::error("driven-joint", message).help(INTEGRATE)
        };
        or_problems((), asked.iter().map(problem).collect())
    }

    /// The rows that are not known to be too large before they are derived.
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

    /// Whether a function is small enough.
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
        let mut notes = Vec::new();
        let callers = match self.callers.as_slice() {
            [] => String::new(),
            callers => format!(", and what calls them, {}", quoted(callers)),
        };
        if !self.need_inverse.is_empty() {
            let message = format!(
                "left out, because the mass matrix is singular: {}{callers}",
                quoted(&self.need_inverse)
            );
            notes.push(Diagnostic::note("left-out", message));
        }
        if !self.ignore_load.is_empty() {
            let message =
                format!("left out, because friction grows with the load: {}", quoted(&self.ignore_load));
            notes.push(Diagnostic::note("left-out", format!("{message}; {IGNORES}")).help(INSTEAD));
        }
        if !self.over_time.is_empty() {
            let message = format!("left out, because joints are driven: {}", quoted(&self.over_time));
            notes.push(Diagnostic::note("left-out", format!("{message}; {NEEDS_MOTION}")).help(INTEGRATE));
        }
        if self.of_frames > 0 {
            let message =
                format!("left out: the {} functions of {} frames", self.of_frames, model.frames.len());
            let help = "ask for single ones by name (`frame_<name>_pose`), or for all by `frames`";
            notes.push(Diagnostic::note("left-out", message).help(help));
        }
        if !self.too_large.is_empty() {
            let callers = match self.need_inverse.is_empty() {
                true => callers.as_str(),
                false => "",
            };
            notes.push(size::note(model, &self.too_large, callers, most));
        }
        notes
    }
}

/// Why functions over a sample time are left out where joints are driven.
const INERTIA: &str =
    "describe the mass or the rotor that moves with it, or ask for functions without the inverse";
const NEEDS_MOTION: &str = "it would need their motion all through the sample time";
const INTEGRATE: &str = "`forward_dynamics` and `linearize` take the driven motion at one time; `DrivenRobot` of gelenk-runtime makes steps of them, with a motion over time";

/// Why functions are left out where friction grows with the load.
const IGNORES: &str = "M and M⁻¹ would be taken for derivatives that have another factor there";
const INSTEAD: &str = "`inverse_dynamics_derivatives` and `linearize` hold; by the accelerations the former has D M, see its documentation";

fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

fn or_problems<T>(value: T, problems: Vec<Diagnostic>) -> Result<T, Diagnostics> {
    match problems.is_empty() {
        true => Ok(value),
        false => Err(Diagnostics::new(problems)),
    }
}
