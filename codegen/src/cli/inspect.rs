//! The command `gelenk inspect`, which prints intermediate results of the generator.

use std::process::ExitCode;

use clap::ValueEnum;
use gelenk_findings::counted;
use gelenk_report::Table;
use serde_json::{Map, Value, json};

use super::arguments::{Format, Inspect, Stage};
use super::bytes::CodeSizes;
use super::failure::Failure;
use super::place::Workspace;
use super::{generate, mechanism, print};
use crate::functions::form::Form;
use crate::functions::function::Function;
use crate::functions::selection::{self, Request};
use crate::functions::size::MOST_OPERATIONS;
use crate::model::Model;
use crate::module::Module;
use crate::pipeline::Generated;
use crate::program::display::{self, Notation};
use crate::report::{self, EQUATIONS, sums, sums_document};

/// Prints one intermediate result of the generator for a description: model, mechanism, operation counts,
/// program or text.
pub(super) fn inspect(arguments: &Inspect, format: Format) -> Result<ExitCode, Failure> {
    if arguments.closed_form {
        return closed_form(arguments, format);
    }
    let what = match arguments.what {
        Some(what) => what,
        None => model_of(arguments)?,
    };
    if arguments.latex && !matches!(what, Stage::Program | Stage::Equations) {
        return Err(Failure::Usage(
            "--latex needs `inspect program`, `inspect equations` or --closed-form".to_owned(),
        ));
    }
    let workspace = Workspace::find();
    let command = generate::command(&arguments.description, &arguments.choices, None, workspace.as_ref());
    let robot = generate::derive(&arguments.description, &arguments.choices, command)?;
    generate::say_notes(std::slice::from_ref(&robot), format);
    if arguments.bytes {
        return counts_and_bytes(&robot, what, format);
    }
    match format {
        Format::Json => print::json(&as_json(&robot, what, arguments.latex)?),
        Format::Text => print::out(&as_text(&robot, what, arguments.latex)?).map(|()| ExitCode::SUCCESS),
    }
}

/// Returns the default intermediate result to print, the model. Returns an error if the only argument is the
/// name of an intermediate result and no file has this name, because the description is then missing.
fn model_of(arguments: &Inspect) -> Result<Stage, Failure> {
    let named = arguments.description.to_str().filter(|name| Stage::from_str(name, false).is_ok());
    match named.filter(|_| !arguments.description.exists()) {
        Some(name) => Err(Failure::Usage(format!(
            "`inspect {name}` needs a description: `gelenk inspect {name} arm.urdf`"
        ))),
        None => Ok(Stage::Model),
    }
}

/// Prints the operation counts with the size of the machine code.
fn counts_and_bytes(robot: &Generated, what: Stage, format: Format) -> Result<ExitCode, Failure> {
    if what != Stage::Counts {
        return Err(Failure::Usage("--bytes needs `inspect counts`".to_owned()));
    }
    let sizes = CodeSizes::measure(&robot.source)?;
    let counts = robot.module.costs();
    let bytes: Vec<Option<u64>> = counts
        .iter()
        .map(|(name, _)| {
            let function = robot.module.functions.iter().find(|function| &function.name == name);
            sizes.of(name, function)
        })
        .collect();
    let table = report::counts(&counts, &bytes);
    match format {
        Format::Json => print::json(&table.records()),
        Format::Text => {
            let text = print::table(&table.plain()) + uncounted(&robot.module).as_str();
            print::out(&text).map(|()| ExitCode::SUCCESS)
        }
    }
}

/// The functions of the equations of motion (M, k, q and B), also if the description does not list them.
fn equations(robot: &Generated) -> Result<Vec<Function>, Failure> {
    let names = EQUATIONS.map(str::to_owned);
    let request = Request { names: &names, most: MOST_OPERATIONS, form: Form::Straight, straight: &[] };
    let derived = selection::derive(&robot.model, &request);
    Ok(derived.map_err(|problems| Failure::Descriptions(vec![problems]))?.functions)
}

fn no_sums(reason: String) -> Failure {
    Failure::Problem(format!(
        "{reason}\n  = help: `gelenk inspect program` prints the equations with intermediate values"
    ))
}

#[cfg(feature = "symbolica")]
fn closed_form(arguments: &Inspect, format: Format) -> Result<ExitCode, Failure> {
    super::closed_form::inspect(arguments, format)
}

/// Returns an error, because this build lacks the feature `symbolica`.
#[cfg(not(feature = "symbolica"))]
fn closed_form(_: &Inspect, _: Format) -> Result<ExitCode, Failure> {
    Err(Failure::Usage(
        "this build has no closed forms with symbols. They need a build with `--features symbolica`. Commercial use of \
         Symbolica, which is source-available, needs a licence from https://symbolica.io\n  = help: `gelenk inspect equations \
         DESCRIPTION` prints closed forms with the numbers of the description\n  = help: cargo run --release --features symbolica \
         -- inspect --closed-form DESCRIPTION"
            .to_owned(),
    ))
}

fn as_text(robot: &Generated, what: Stage, latex: bool) -> Result<String, Failure> {
    let notation = notation(&robot.model);
    Ok(match what {
        Stage::Model => model_text(&robot.model),
        Stage::Mechanism => tables_text(&mechanism::tables(&robot.model)),
        Stage::Counts => {
            let table = report::counts(&robot.module.costs(), &[]);
            format!("{}{}", print::table(&table.plain()), uncounted(&robot.module))
        }
        Stage::Source => robot.source.text.clone(),
        Stage::Equations => sums_document(&robot.model, &equations(robot)?).map_err(no_sums)?,
        Stage::Program => {
            let show = if latex { display::latex } else { display::text };
            let programs = robot
                .module
                .functions
                .iter()
                .map(|function| titled(function, &show(&function.program, &notation)));
            programs.collect::<Vec<_>>().join("\n")
        }
    })
}

/// Text which says that operations on quaternions are not counted in functions over a sample time. Empty if
/// the module has no functions of this kind.
fn uncounted(module: &Module) -> String {
    let composed = module.compositions.iter().filter(|each| each.cost.is_none());
    let lines = composed.map(|each| {
        let calls = each.cost_text.trim_start_matches("Cost: ");
        format!("  {}: {calls}\n", each.composition.name())
    });
    match lines.collect::<String>() {
        lines if lines.is_empty() => lines,
        lines => format!(
            "\nNot counted, because their operations on quaternions are not straight-line code:\n{lines}"
        ),
    }
}

fn notation(model: &Model) -> Notation {
    Notation { parameters: model.parameters.iter().map(|parameter| parameter.name.clone()).collect() }
}

fn titled(function: &Function, program: &str) -> String {
    let title = format!("{}: {}", function.name, function.equation);
    format!("{}\n{program}", title.trim_end_matches([':', ' ']))
}

fn as_json(robot: &Generated, what: Stage, latex: bool) -> Result<Value, Failure> {
    let notation = notation(&robot.model);
    Ok(match what {
        Stage::Model => model_json(&robot.model),
        Stage::Mechanism => tables_json(&mechanism::tables(&robot.model)),
        Stage::Counts => report::counts(&robot.module.costs(), &[]).records(),
        Stage::Source => json!({ "name": robot.source.name, "text": robot.source.text }),
        Stage::Equations => {
            json!({ "robot": robot.model.name, "equations": sums(&robot.model, &equations(robot)?).map_err(no_sums)? })
        }
        Stage::Program => {
            let show = if latex { display::latex } else { display::text };
            let entry = |function: &Function| json!({ "function": function.name, "program": show(&function.program, &notation) });
            robot.module.functions.iter().map(entry).collect()
        }
    })
}

/// Numbers of links, coordinates and forces, and the tables of the page.
fn model_text(model: &Model) -> String {
    let description = model.description.iter().map(|line| format!("  {line}\n")).collect::<String>();
    let positions = match model.quaternion_joints.is_empty() {
        true => String::new(),
        false => format!(" with {} positions", model.position_count()),
    };
    let driven = match model.driven.len() {
        0 => String::new(),
        count => format!(", {count} driven"),
    };
    format!(
        "robot {}\n{description}\n{}, {}{positions}{driven}, {}, {}, {}\n{}",
        model.name,
        counted(model.links.len(), "link", "links"),
        counted(model.coordinates.len(), "coordinate", "coordinates"),
        counted(model.drives.len(), "drive", "drives"),
        counted(model.frames.len(), "frame", "frames"),
        counted(model.parameters.len(), "free parameter", "free parameters"),
        tables_text(&report::tables(model))
    )
}

fn model_json(model: &Model) -> Value {
    let mut object = tables_json(&report::tables(model));
    object["name"] = model.name.as_str().into();
    object["description"] = json!(model.description);
    object
}

/// Tables with their captions, each after an empty line.
fn tables_text(tables: &[Table]) -> String {
    let text = |table: &Table| format!("\n{}\n{}", table.title(), print::table(&table.plain()));
    tables.iter().map(text).collect()
}

/// JSON object with the rows of tables by the tables' identifiers.
fn tables_json(tables: &[Table]) -> Value {
    tables.iter().map(|table| (table.id.replace('-', "_"), table.records())).collect::<Map<_, _>>().into()
}
