//! The command `gelenk inspect`.

use std::process::ExitCode;

use clap::ValueEnum;
use serde_json::{Value, json};

use super::arguments::{Format, Inspect, Stage};
use super::bytes::CodeSizes;
use super::failure::Failure;
use super::inspect_forces::{self, followed, position};
use super::place::Workspace;
use super::{generate, mechanism, print};
use crate::functions::form::Form;
use crate::functions::function::Function;
use crate::functions::selection::{self, Request};
use crate::functions::size::MOST_OPERATIONS;
use crate::model::{JointKind, Model, Motion};
use crate::module::Module;
use crate::pipeline::Generated;
use crate::program::display::{self, Notation};
use crate::report::{EQUATIONS, sums, sums_document};

/// Prints one stage of the generator for a description.
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
            "--latex is an option of `inspect program`, `inspect equations` and --closed-form".to_owned(),
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

/// The stage if no stage is named: the model. Returns an error if the description has the name of a stage and
/// does not exist.
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
        return Err(Failure::Usage("--bytes is an option of `inspect counts`".to_owned()));
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
    match format {
        Format::Json => print::json(&print::counts(&counts, &bytes)),
        Format::Text => {
            let table = print::counts_table(&counts, &bytes);
            print::out(&format!("{table}{}", uncounted(&robot.module))).map(|()| ExitCode::SUCCESS)
        }
    }
}

/// The functions for M, k, q and B, also if the description does not list them.
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

/// This build has no closed forms, because it lacks the feature `symbolica`.
#[cfg(not(feature = "symbolica"))]
fn closed_form(_: &Inspect, _: Format) -> Result<ExitCode, Failure> {
    Err(Failure::Usage(
        "closed forms with symbols need a build with `--features symbolica`; this build lacks the feature. \
         Symbolica is source-available: commercial use needs a licence of your own, from \
         https://symbolica.io\n  = help: `gelenk inspect equations DESCRIPTION` prints closed forms with \
         the numbers of the description\n  = help: cargo run --release --features symbolica -- inspect \
         --closed-form DESCRIPTION"
            .to_owned(),
    ))
}

fn as_text(robot: &Generated, what: Stage, latex: bool) -> Result<String, Failure> {
    let notation = notation(&robot.model);
    Ok(match what {
        Stage::Model => model_text(&robot.model),
        Stage::Mechanism => mechanism::as_text(&robot.model),
        Stage::Counts => {
            format!("{}{}", print::counts_table(&robot.module.costs(), &[]), uncounted(&robot.module))
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

/// Text about functions over a sample time of robots with quaternions, whose own operations are not counted;
/// otherwise empty.
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
        Stage::Mechanism => mechanism::as_json(&robot.model),
        Stage::Counts => print::counts(&robot.module.costs(), &[]),
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

/// Text about the number of positions of robots with quaternions, and of driven joints.
fn besides(model: &Model) -> String {
    let mut text = String::new();
    if !model.quaternion_joints.is_empty() {
        text.push_str(&format!(" with {} positions", model.position_count()));
    }
    if !model.driven.is_empty() {
        text.push_str(&format!(", {} driven", model.driven.len()));
    }
    text
}

fn model_text(model: &Model) -> String {
    let mut text = format!("robot {}\n", model.name);
    text.extend(model.description.iter().map(|line| format!("  {line}\n")));
    text.push_str(&format!(
        "\n{} links, {} coordinates{}, {} drives, {} frames, {} free parameters\n\n",
        model.links.len(),
        model.coordinates.len(),
        besides(model),
        model.drives.len(),
        model.frames.len(),
        model.parameters.len(),
    ));
    let head = ["link", "parent", "joint", "kind", "motion", "bodies"].map(str::to_owned).to_vec();
    let rows = model.links.iter().map(|link| {
        let parent = link.joint.as_ref().and_then(|joint| model.links.get(joint.parent));
        vec![
            link.name.clone(),
            parent.map_or("", |parent| parent.name.as_str()).to_owned(),
            link.joint.as_ref().map_or("", |joint| joint.name.as_str()).to_owned(),
            link.joint.as_ref().map_or("", |joint| joint.kind.name()).to_owned(),
            link.joint.as_ref().map_or(String::new(), |joint| motion(model, joint.motion)),
            link.bodies.len().to_string(),
        ]
    });
    text.push_str(&print::table(&std::iter::once(head).chain(rows).collect::<Vec<_>>()));
    text.push_str(&lines_text(model));
    text.push_str(&inspect_forces::as_text(model));
    if !model.parameters.is_empty() {
        text.push_str(&format!("\n{}", parameters_text(model)));
    }
    text
}

/// Table of the motors with a torque–speed line; empty if there are none.
fn lines_text(model: &Model) -> String {
    let head = ["motor", "stall torque [N m]", "no-load speed [rad/s]"].map(str::to_owned).to_vec();
    let rows = model.drives.iter().filter_map(|drive| {
        let line = drive.line?;
        Some(vec![drive.name.clone(), print::number(line.stall_torque), print::number(line.no_load_speed)])
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    format!("\n{}", print::table(&std::iter::once(head).chain(rows).collect::<Vec<_>>()))
}

fn parameters_text(model: &Model) -> String {
    let head = ["parameter", "value", "unit"].map(str::to_owned).to_vec();
    let rows =
        model.parameters.iter().map(|p| vec![p.name.clone(), print::number(p.default), p.unit.clone()]);
    print::table(&std::iter::once(head).chain(rows).collect::<Vec<_>>())
}

/// Pitch of a helical joint [m/rad]; `None` for other joints.
fn pitch(kind: JointKind) -> Option<f64> {
    match kind {
        JointKind::Helical { pitch } => Some(pitch),
        JointKind::Fixed | JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => None,
    }
}

fn motion(model: &Model, motion: Motion) -> String {
    match motion {
        Motion::Follower(index) => {
            let moving = model.moving_joints();
            followed(model, &moving[index].follows, moving[index].offset)
        }
        Motion::Fixed => "fixed".to_owned(),
        Motion::Held(position) => format!("held at {}", print::number(position)),
        Motion::Coordinate(index) => match model.quaternion_joint_of(index) {
            None => position(model, index),
            Some(joint) => format!("velocity v{} of {} joint {}", index + 1, joint.kind.name(), joint.name),
        },
    }
}

fn model_json(model: &Model) -> Value {
    let link = |link: &crate::model::Link| {
        json!({
            "name": link.name,
            "bodies": link.bodies.iter().map(|body| &body.name).collect::<Vec<_>>(),
            "joint": link.joint.as_ref().map(|joint| json!({
                "name": joint.name,
                "parent": model.links.get(joint.parent).map(|parent| &parent.name),
                "kind": joint.kind.name(),
                "pitch": pitch(joint.kind),
                "motion": motion(model, joint.motion),
                "position_limits": joint.limits.position,
                "velocity_limit": joint.limits.velocity,
                "effort_limit": joint.limits.effort,
            })),
        })
    };
    let mut object = json!({
        "name": model.name,
        "description": model.description,
        "links": model.links.iter().map(link).collect::<Vec<_>>(),
        "drives": model.drives.iter().map(|drive| &drive.name).collect::<Vec<_>>(),
        "torque_speed_lines": model.drives.iter().filter_map(|drive| drive.line.map(|line| json!({
            "drive": drive.name, "stall_torque": line.stall_torque, "no_load_speed": line.no_load_speed,
        }))).collect::<Vec<_>>(),
        "frames": model.frames.iter().map(|frame| &frame.name).collect::<Vec<_>>(),
        "parameters": model.parameters.iter().map(|p| json!({
            "name": p.name, "default": p.default, "unit": p.unit, "description": p.description,
        })).collect::<Vec<_>>(),
    });
    inspect_forces::add_json(model, &mut object);
    object
}
