//! The generator: all stages from a description to the text of a module.

use std::path::{Path, PathBuf};

use crate::advice;
use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::emit::{self, Companion, EmitOptions, Language, SourceFile};
use crate::functions::form::Form;
use crate::functions::module_constants;
use crate::functions::selection::{self, Request, Selection};
use crate::functions::size::MOST_OPERATIONS;
use crate::lanes::{self, Lanes};
use crate::model::Model;
use crate::module::Module;
use crate::program::arrays::ArrayForm;
use crate::program::fuse_multiply_adds;
use crate::read::{DescriptionFiles, Loaded, ReadOptions};
use crate::self_test::self_tests;
use crate::snapping;
use crate::tools;
use crate::verify;

/// Options of [`generate`] that a description does not have, or that replace options of the description.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GenerateOptions {
    /// Names of the functions to generate. If empty, the description chooses the functions, by default all
    /// functions.
    pub functions: Vec<String>,
    /// Options for reading the description.
    pub reading: ReadOptions,
    /// Whether a product and a sum are contracted to a fused multiply-add, which rounds once. The code is
    /// faster, but compiles only for processors with these instructions.
    pub fused_multiply_add: bool,
    /// Choice between straight-line code and loops over joints for large functions.
    pub form: Form,
    /// Whether the module has tests of its functions. The tests compare results with values that the
    /// generator computed.
    pub self_test: bool,
    /// Largest number of operations of a function. If `None`, [`MOST_OPERATIONS`] is the limit.
    pub max_operations: Option<usize>,
    /// Names of functions that are also written for eight states at once. If empty, the description chooses
    /// them.
    pub lanes: Vec<String>,
    /// Lines that are added to the module's documentation of the robot.
    pub remarks: Vec<String>,
    /// Options of the printer, for example language and precision.
    pub emit: EmitOptions,
}

/// Results of [`generate`]: robot, module and text.
#[derive(Debug, Clone, PartialEq)]
pub struct Generated {
    /// The robot that was read from the description.
    pub model: Model,
    /// The module: functions and other printed items, before printing.
    pub module: Module,
    /// Text of the module, with its name and language.
    pub source: SourceFile,
    /// Whether this is the smooth module of [`generate_pair`].
    pub is_control_model: bool,
    /// Warnings and notes about the description and the functions.
    pub notes: Diagnostics,
    /// All files that were read. The first is the description.
    pub files: Vec<PathBuf>,
}

/// Generates the text of a module from a description. It reads files, but writes no files.
///
/// # Errors
/// All [`Diagnostics`] of the first stage that has errors.
pub fn generate(description: &Path, options: &GenerateOptions) -> Result<Generated, Diagnostics> {
    generate_from(&mut DescriptionFiles::of(description), options)
}

fn generate_from(
    description: &mut DescriptionFiles,
    options: &GenerateOptions,
) -> Result<Generated, Diagnostics> {
    check_slope(options.reading.smooth_sign)?;
    check_language(options)?;
    let Loaded { model, notes, files } = description.load(&options.reading)?;
    check_size(&model)?;
    tools::check(&model, &options.emit.companions)?;
    let lanes = Lanes::new(&model, &options.lanes)?;
    let selection = lanes.selected_with(selection(&model, options));
    let selected = derive(&model, options, &selection, &lanes);
    let selected = selected.map_err(|problems| with_warnings(problems, &notes))?;
    let Selection { mut functions, compositions, notes: left_out } = selected;
    tools::check_functions(&functions, &compositions, &options.emit.companions)?;
    let not_for_tools = Vec::from_iter(tools::notes(&functions, &compositions, &options.emit.companions));
    if options.emit.companions.contains(&Companion::Casadi) {
        functions.extend(tools::by_parameters(&model, &functions));
    }
    #[cfg(test)]
    wrong_functions::spoil(&mut functions);
    verify::verify(&model, &functions)?;
    let notes = snapping::priced(notes, description, &options.reading, &functions);
    let (mut lanes, obstacles) = lanes.possible(&functions);
    if options.emit.companions.contains(&Companion::Python) {
        lanes.extend(lanes::of_straight_line_code(&functions, &lanes));
    }
    let incomplete = Vec::from_iter(module_constants::notes(&functions));
    let advice = advice::notes(&model, &functions, &compositions);
    let others = [left_out, advice, obstacles, incomplete, not_for_tools].concat();
    let notes = Diagnostics::new([notes.into_entries(), others].concat());
    let self_tests = match options.self_test {
        true => self_tests(&model, &functions),
        false => Vec::new(),
    };
    let module = Module {
        lanes,
        self_tests,
        remarks: options.remarks.clone(),
        ..Module::new(&model, functions, &compositions)
    };
    Ok(Generated {
        source: emit::module(&module, &options.emit),
        model,
        module,
        is_control_model: false,
        notes,
        files,
    })
}

/// Suffix of the name of the smooth module of [`generate_pair`].
pub const CONTROL: &str = "_control";

/// Generates two modules from one description. The first is the exact module, for plants. It keeps `sign` in
/// friction and springs. The second is the smooth module `<name>_control`, for controllers. It has
/// `tanh(slope · v)` instead, because controllers need derivatives, and the derivative of `sign` is zero.
///
/// # Errors
/// The errors of [`generate`], and `not-positive` if the slope is not positive and finite.
pub fn generate_pair(
    description: &Path,
    options: &GenerateOptions,
    slope: f64,
) -> Result<[Generated; 2], Diagnostics> {
    let mut description = DescriptionFiles::of(description);
    let mut with = |smooth_sign: Option<f64>, name: Option<String>, remark: String| {
        let mut options = options.clone();
        options.reading.smooth_sign = smooth_sign;
        options.reading.exact_sign = smooth_sign.is_none();
        options.remarks.push(remark);
        options.emit.name = name;
        generate_from(&mut description, &options)
    };
    let exact = with(None, options.emit.name.clone(), "The exact model, for plants.".to_owned())?;
    let name = &exact.source.name;
    let remark = format!("The model for controllers: tanh({slope} v) replaces sign(v) of {name}.");
    let mut smooth = with(Some(slope), Some(format!("{name}{CONTROL}")), remark)?;
    smooth.is_control_model = true;
    Ok([exact, smooth])
}

/// Largest number of velocities of a robot. For longer chains of joints, the mass matrix and its derivatives
/// have more than 640 000 operations, twice the default limit, so their modules would lack the dynamics.
const MOST_VELOCITIES: usize = 400;

fn check_size(model: &Model) -> Result<(), Diagnostics> {
    match model.coordinates.len() {
        0..=MOST_VELOCITIES => Ok(()),
        count => {
            let message = format!(
                "robot `{}` has {count} velocities, but at most {MOST_VELOCITIES} are supported",
                model.name
            );
            let help =
                "hold joints (`held = { \"joint_*\" = 0 }`, `--hold`), or let joints follow other joints";
            Err(Diagnostic::error("too-many-joints", message).help(help).into())
        }
    }
}

fn check_slope(slope: Option<f64>) -> Result<(), Diagnostics> {
    match slope {
        Some(slope) if slope <= 0.0 || !slope.is_finite() => {
            let message = format!("the slope of the smooth sign must be positive and finite, not {slope}");
            let problem = Diagnostic::error("not-positive", message);
            Err(problem.help("give a positive number, e.g. 100").into())
        }
        _ => Ok(()),
    }
}

/// Rejects options that modules in C do not have, such as tests.
fn check_language(options: &GenerateOptions) -> Result<(), Diagnostics> {
    if options.emit.language == Language::Rust {
        return match options.emit.companions.is_empty() {
            true => Ok(()),
            false => {
                let message = "functions for CasADi, acados and Python (`--for`) are written in C, but the language is Rust";
                Err(Diagnostic::error("not-in-rust", message).help("generate C with `--language c`").into())
            }
        };
    }
    let refuse = |what: &str, help: &str| {
        let problem = Diagnostic::error("not-in-c", format!("C modules have no {what}"));
        problem.help(help)
    };
    let refusals = [
        options.self_test.then(|| {
            refuse(
                "tests at their end",
                "remove the self-test or generate Rust; C and Rust compute the same bits",
            )
        }),
        tools::in_single_precision(&options.emit)
            .map(|[what, computes]| refuse(&what, &format!("{computes} in double precision: remove `f32`"))),
    ];
    match Vec::from_iter(refusals.into_iter().flatten()) {
        refusals if refusals.is_empty() => Ok(()),
        refusals => Err(Diagnostics::new(refusals)),
    }
}

fn derive(
    model: &Model,
    options: &GenerateOptions,
    selection: &[String],
    lanes: &Lanes,
) -> Result<Selection, Diagnostics> {
    let request = Request {
        names: selection,
        most: options.max_operations.unwrap_or(MOST_OPERATIONS),
        form: options.form,
        straight: lanes.names(),
    };
    let mut selected = selection::derive(model, &request)?;
    if options.fused_multiply_add {
        for function in &mut selected.functions {
            match function.arrays.as_ref().map(ArrayForm::fused) {
                Some(form) => {
                    function.program = form.unrolled();
                    function.arrays = Some(form);
                }
                None => function.program = fuse_multiply_adds(&function.program),
            }
        }
    }
    Ok(selected)
}

/// Adds the warnings about the model, because they may explain why a function cannot be derived.
fn with_warnings(problems: Diagnostics, notes: &Diagnostics) -> Diagnostics {
    let warnings = notes.entries().iter();
    let warnings = warnings.filter(|entry| entry.severity == Severity::Warning);
    let warnings: Vec<Diagnostic> = warnings.cloned().collect();
    Diagnostics::new([problems.into_entries(), warnings].concat())
}

/// Names of the requested functions. An empty list means all functions.
fn selection<'a>(model: &'a Model, options: &'a GenerateOptions) -> &'a [String] {
    match options.functions.is_empty() {
        true => &model.options.functions,
        false => &options.functions,
    }
}

/// Makes functions wrong in tests, as an error of the derivation would.
#[cfg(test)]
pub(crate) mod wrong_functions {
    use std::cell::Cell;

    use crate::functions::function::Function;
    use crate::program::Operation;

    thread_local!(static ARE_WANTED: Cell<bool> = const { Cell::new(false) });

    /// Calls `run`. Each [`generate`](super::generate) in `run` on this thread then makes wrong functions.
    pub(crate) fn during<T>(run: impl FnOnce() -> T) -> T {
        ARE_WANTED.set(true);
        let result = run();
        ARE_WANTED.set(false);
        result
    }

    /// Replaces every sum of the functions by a difference, if a test requests wrong functions.
    pub(super) fn spoil(functions: &mut [Function]) {
        let instructions = functions.iter_mut().flat_map(|function| &mut function.program.instructions);
        for instruction in instructions.filter(|_| ARE_WANTED.get()) {
            if let Operation::Add(a, b) = instruction.operation {
                instruction.operation = Operation::Subtract(a, b);
            }
        }
    }
}
