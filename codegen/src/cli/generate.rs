//! `gelenk generate` and `gelenk check`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{Value, json};

use super::Failure;
use super::arguments::{Check, Choices, Format, Generate, ScalarName};
use super::place::{Workspace, shown};
use super::print;
use super::progress::Progress;
use crate::diagnostic::Diagnostics;
use crate::dynamics::array_form::Form;
use crate::emit::EmitOptions;
use crate::output::{self, Outcome};
use crate::pipeline::{self, GenerateOptions, Generated};
pub(super) use crate::wording::quoted;

/// Writes one description's module, or all.
pub(super) fn generate(arguments: &Generate, format: Format) -> Result<ExitCode, Failure> {
    let workspace = Workspace::find();
    let Some(description) = &arguments.description else {
        return generate_all(
            &workspace.ok_or_else(no_workspace)?,
            &arguments.choices,
            format,
        );
    };
    let choices = &arguments.choices;
    let command = command(
        description,
        choices,
        arguments.output.as_deref(),
        workspace.as_ref(),
    );
    let robot = derive(description, choices, command)?;
    say_notes(&robot, format);
    if arguments.output.as_deref() == Some(Path::new("-")) {
        print::out(&robot.source.text)?;
        return Ok(ExitCode::SUCCESS);
    }
    let (path, is_ours) = place(
        description,
        &robot,
        arguments.output.as_deref(),
        workspace.as_ref(),
    );
    if is_ours {
        refuse_root(&robot.source.name)?;
    }
    let outcome = output::write(&path, &robot.source.text)?;
    if let (true, Some(workspace)) = (is_ours, &workspace) {
        add_to_root(workspace, &robot.source.name)?;
    }
    match format {
        Format::Json => print::json(&json!([result(&robot, &path, outcome)])),
        Format::Text => {
            print::out(&format!(
                "{}\n{}",
                line(&robot, &path, outcome),
                print::counts_table(&robot.costs(), &[])
            ))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Everything in models/. Nothing is written unless all descriptions are right.
fn generate_all(
    workspace: &Workspace,
    choices: &Choices,
    format: Format,
) -> Result<ExitCode, Failure> {
    let robots = derive_all(workspace, choices)?;
    robots.iter().for_each(|robot| say_notes(robot, format));
    let (mut lines, mut results) = (String::new(), Vec::new());
    for robot in &robots {
        let path = workspace
            .modules()
            .join(format!("{}.rs", robot.source.name));
        let outcome = output::write(&path, &robot.source.text)?;
        lines.push_str(&format!("{}\n", line(robot, &path, outcome)));
        results.push(result(robot, &path, outcome));
    }
    let names: Vec<String> = robots
        .iter()
        .map(|robot| robot.source.name.clone())
        .collect();
    output::write(
        &workspace.modules().join("lib.rs"),
        &output::root_text(&names),
    )?;
    for path in output::left_over(&workspace.modules(), &names)? {
        std::fs::remove_file(&path)?;
        lines.push_str(&format!(
            "removed   {}: nothing in models/ describes it\n",
            relative(&path)
        ));
    }
    match format {
        Format::Json => print::json(&Value::Array(results)),
        Format::Text => print::out(&lines).map(|()| ExitCode::SUCCESS),
    }
}

/// Compares one module, or all, with what would be written.
pub(super) fn check(arguments: &Check, format: Format) -> Result<ExitCode, Failure> {
    let workspace = Workspace::find();
    let choices = &arguments.choices;
    let stale = match (&arguments.description, &workspace) {
        (Some(description), _) => {
            let command = command(
                description,
                choices,
                arguments.output.as_deref(),
                workspace.as_ref(),
            );
            let robot = derive(description, choices, command.clone())?;
            let (path, _) = place(
                description,
                &robot,
                arguments.output.as_deref(),
                workspace.as_ref(),
            );
            if output::check(&path, &robot.source.text) {
                vec![]
            } else {
                vec![(path, command)]
            }
        }
        (None, Some(workspace)) => stale(workspace, choices)?,
        (None, None) => return Err(no_workspace()),
    };
    report_stale(&stale, format)
}

fn stale(workspace: &Workspace, choices: &Choices) -> Result<Vec<(PathBuf, String)>, Failure> {
    let robots = derive_all(workspace, choices)?;
    let names: Vec<String> = robots
        .iter()
        .map(|robot| robot.source.name.clone())
        .collect();
    let expected = robots.iter().map(|robot| {
        (
            format!("{}.rs", robot.source.name),
            robot.source.text.clone(),
        )
    });
    let expected = expected.chain([("lib.rs".to_owned(), output::root_text(&names))]);
    let paths = expected.map(|(name, text)| (workspace.modules().join(name), text));
    let mut stale: Vec<PathBuf> = paths
        .filter(|(path, text)| !output::check(path, text))
        .map(|(path, _)| path)
        .collect();
    stale.extend(output::left_over(&workspace.modules(), &names)?);
    Ok(stale
        .into_iter()
        .map(|path| (path, "gelenk generate".to_owned()))
        .collect())
}

fn report_stale(stale: &[(PathBuf, String)], format: Format) -> Result<ExitCode, Failure> {
    let code = ExitCode::from(u8::from(!stale.is_empty()));
    if format == Format::Json {
        let files: Vec<String> = stale.iter().map(|(path, _)| relative(path)).collect();
        let commands: Vec<&String> = stale.iter().map(|(_, command)| command).take(1).collect();
        print::json(
            &json!({ "fresh": stale.is_empty(), "stale": files, "command": commands.first() }),
        )?;
        return Ok(code);
    }
    let Some((_, command)) = stale.first() else {
        print::out("fresh\n")?;
        return Ok(code);
    };
    let files: String = stale
        .iter()
        .map(|(path, _)| format!("stale: {}\n", relative(path)))
        .collect();
    print::err(&format!("{files}run: {command}\n"));
    Ok(code)
}

/// Derives all robots of the workspace; a failure holds the problems of all descriptions.
fn derive_all(workspace: &Workspace, choices: &Choices) -> Result<Vec<Generated>, Failure> {
    let (mut robots, mut problems) = (Vec::new(), Vec::new());
    for description in workspace.descriptions()? {
        let command = command(&description, choices, None, Some(workspace));
        match derive_one(Path::new(&relative(&description)), choices, command) {
            Ok(robot) => robots.push(robot),
            Err(diagnostics) => problems.push(diagnostics),
        }
    }
    if !problems.is_empty() {
        return Err(Failure::Descriptions(problems));
    }
    robots.sort_by(|a, b| a.source.name.cmp(&b.source.name));
    let names: Vec<&str> = robots
        .iter()
        .map(|robot| robot.source.name.as_str())
        .collect();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Failure::Problem(format!(
            "two descriptions name their robot `{}`: rename one",
            pair[0]
        )));
    }
    names.iter().try_for_each(|name| refuse_root(name))?;
    Ok(robots)
}

/// The crate's root is no robot.
fn refuse_root(name: &str) -> Result<(), Failure> {
    match name {
        "lib" => Err(Failure::Problem(
            "`lib` is the root of the crate of robots: rename the robot".to_owned(),
        )),
        _ => Ok(()),
    }
}

/// Runs the pipeline on one description.
pub(super) fn derive(
    description: &Path,
    choices: &Choices,
    command: String,
) -> Result<Generated, Failure> {
    derive_one(description, choices, command)
        .map_err(|diagnostics| Failure::Descriptions(vec![diagnostics]))
}

fn derive_one(
    description: &Path,
    choices: &Choices,
    command: String,
) -> Result<Generated, Diagnostics> {
    let _progress = Progress::start(description.display().to_string());
    pipeline::generate(description, &options(choices, command))
}

/// Notes go to standard error; in JSON they are part of the result.
pub(super) fn say_notes(robot: &Generated, format: Format) {
    if format == Format::Text && !robot.notes.is_empty() {
        print::err(&format!("{}\n\n", robot.notes));
    }
}

fn options(choices: &Choices, command: String) -> GenerateOptions {
    GenerateOptions {
        functions: choices.functions.clone(),
        snap_angles: choices.reading.snap_angles,
        no_friction: choices.reading.no_friction,
        ignore_mimic: choices.reading.ignore_mimic,
        smooth_sign: choices.reading.smooth_sign,
        accept_unphysical: choices.reading.accept_unphysical,
        fused_multiply_add: choices.fused_multiply_add,
        form: Form::Cheapest,
        max_operations: choices.max_operations,
        emit: EmitOptions {
            scalar: choices.scalar.into(),
            command,
            lanes: choices.lanes.clone(),
            ..EmitOptions::default()
        },
    }
}

/// The command that makes the file again, from the workspace's root or the folder that relative paths begin at.
pub(super) fn command(
    description: &Path,
    choices: &Choices,
    output: Option<&Path>,
    workspace: Option<&Workspace>,
) -> String {
    let mut words = vec![
        "gelenk generate".to_owned(),
        quoted(&shown(description, workspace)),
    ];
    if let Some(output) = output.filter(|output| *output != Path::new("-") && !output.is_absolute())
    {
        words.push(format!("--output {}", quoted(&shown(output, None))));
    }
    if !choices.functions.is_empty() {
        words.push(format!(
            "--functions {}",
            quoted(&choices.functions.join(","))
        ));
    }
    if !choices.lanes.is_empty() {
        words.push(format!("--lanes {}", quoted(&choices.lanes.join(","))));
    }
    if choices.scalar == ScalarName::F32 {
        words.push("--scalar f32".to_owned());
    }
    words.extend(choices.reading.words());
    words.extend(
        choices
            .fused_multiply_add
            .then(|| "--fused-multiply-add".to_owned()),
    );
    if let Some(most) = choices.max_operations {
        words.push(format!("--max-operations {most}"));
    }
    words.join(" ")
}

/// Where the module goes, and whether that is the workspace's own crate.
fn place(
    description: &Path,
    robot: &Generated,
    output: Option<&Path>,
    workspace: Option<&Workspace>,
) -> (PathBuf, bool) {
    let file = format!("{}.rs", robot.source.name);
    match (output, workspace) {
        (Some(output), _) => (output.to_owned(), false),
        (None, Some(workspace)) if workspace.contains(description) => {
            (workspace.modules().join(file), true)
        }
        (None, _) => (PathBuf::from(file), false),
    }
}

/// Makes the module part of the crate `generated`, beside those that are there.
fn add_to_root(workspace: &Workspace, name: &str) -> Result<(), Failure> {
    let others = output::left_over(&workspace.modules(), &[])?;
    let stems = others
        .iter()
        .filter_map(|path| path.file_stem()?.to_str().map(str::to_owned));
    let names: Vec<String> = stems.chain([name.to_owned()]).collect();
    output::write(
        &workspace.modules().join("lib.rs"),
        &output::root_text(&names),
    )?;
    Ok(())
}

fn line(robot: &Generated, path: &Path, outcome: Outcome) -> String {
    let outcome = match outcome {
        Outcome::Written => "wrote    ",
        Outcome::Unchanged => "unchanged",
    };
    let (n, m) = (robot.model.coordinates.len(), inputs(robot));
    let plural =
        |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    format!(
        "{outcome} {}: {}, {}, {}, {} lines",
        relative(path),
        plural(n, "coordinate"),
        plural(m, "input"),
        plural(robot.functions.len() + robot.compositions.len(), "function"),
        robot.source.text.lines().count(),
    )
}

fn inputs(robot: &Generated) -> usize {
    robot
        .model
        .drives
        .iter()
        .filter(|drive| drive.coordinate.is_some())
        .count()
}

fn result(robot: &Generated, path: &Path, outcome: Outcome) -> Value {
    json!({
        "robot": robot.source.name,
        "file": relative(path),
        "written": outcome == Outcome::Written,
        "coordinates": robot.model.coordinates.len(),
        "inputs": inputs(robot),
        "functions": print::counts(&robot.costs(), &[]),
        "notes": print::diagnostics(&robot.notes),
    })
}

/// The path from the current folder where it lies below.
fn relative(path: &Path) -> String {
    let current = std::env::current_dir().unwrap_or_default();
    path.strip_prefix(&current)
        .unwrap_or(path)
        .display()
        .to_string()
}

fn no_workspace() -> Failure {
    Failure::Usage(
        "no description given, and no folder with models/ and generated/src/ at or above this one"
            .to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::super::arguments::Reading;
    use super::*;

    #[test]
    fn the_command_makes_the_same_file_again() {
        let choices = Choices {
            functions: vec!["mass_matrix".into(), "bias_forces".into()],
            scalar: ScalarName::F32,
            reading: Reading {
                snap_angles: Some(1e-4),
                no_friction: true,
                ignore_mimic: false,
                smooth_sign: Some(100.0),
                accept_unphysical: true,
            },
            lanes: vec![],
            fused_multiply_add: false,
            max_operations: None,
        };
        let command = command(
            Path::new("my robots/arm.urdf"),
            &choices,
            Some(Path::new("src/arm.rs")),
            None,
        );
        assert_eq!(
            command,
            "gelenk generate 'my robots/arm.urdf' --output src/arm.rs --functions mass_matrix,bias_forces \
             --scalar f32 --snap-angles 0.0001 --smooth-sign 100.0 --no-friction --accept-unphysical"
        );
    }
}
