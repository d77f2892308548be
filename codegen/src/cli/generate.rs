//! The commands `gelenk generate`, which writes modules, and `gelenk check`, which compares them with their
//! descriptions.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gelenk_findings::counted;
use serde_json::{Value, json};

use super::arguments::{Check, Format, Generate};
use super::choices::{Choices, LanguageName, Modules, ScalarName};
use super::failure::{FAULT, Failure};
use super::place::{Output, Target, Workspace, shown};
use super::progress::Progress;
use super::{interface, print};
use crate::diagnostic::Diagnostics;
use crate::emit::{EmitOptions, documentation};
use crate::functions::form::Form;
use crate::output::{self, Outcome, Planned, Replaces};
use crate::pipeline::{self, CONTROL, GenerateOptions, Generated};
use crate::report::counts;
use crate::wording::quoted;

/// Writes the module of one description, or the modules of all descriptions in models/.
pub(super) fn generate(arguments: &Generate, format: Format) -> Result<ExitCode, Failure> {
    let workspace = Workspace::find();
    let Some(description) = &arguments.description else {
        return generate_all(&workspace.ok_or_else(no_workspace)?, &arguments.modules, format);
    };
    let modules = &arguments.modules;
    let output = arguments.output.as_deref();
    let is_piped = output == Some(Path::new("-"));
    if is_piped && modules.control_model.is_some() {
        return Err(Failure::Usage(
            "--control-model makes two modules: name an output folder instead of standard output".to_owned(),
        ));
    }
    let target = Target::new(output, modules.language)?;
    let command = modules_command(description, modules, output, workspace.as_ref());
    let robots = derive_modules(description, modules, command, &target).map_err(problem)?;
    say_notes(&robots, format);
    if is_piped {
        let texts = robots.iter().map(|robot| robot.source.text.as_str());
        print::out(&texts.collect::<String>())?;
        return Ok(ExitCode::SUCCESS);
    }
    let home = workspace.filter(|workspace| target.may_be_home() && workspace.contains(description));
    let paths: Vec<PathBuf> = robots.iter().map(|robot| place(robot, &target, home.as_ref())).collect();
    let root = match &home {
        Some(home) => Some(root_with(home, &robots)?),
        None => None,
    };
    let root = home.as_ref().zip(root.as_deref());
    let outcomes = write(&robots, &paths, root)?;
    let written = robots.iter().zip(&paths).zip(outcomes);
    match format {
        Format::Json => {
            print::json(&written.map(|((robot, path), outcome)| result(robot, path, outcome)).collect())
        }
        Format::Text => {
            let text = written.map(|((robot, path), outcome)| {
                let counts = print::table(&counts(&robot.module.costs(), &[]).plain());
                format!("{}\n{counts}", line(robot, path, outcome))
            });
            print::out(&text.collect::<String>()).map(|()| ExitCode::SUCCESS)
        }
    }
}

/// Writes modules, and the root file of their crate if there is one. If one file must not be overwritten, no
/// file is written.
fn write(
    robots: &[Generated],
    paths: &[PathBuf],
    root: Option<(&Workspace, &str)>,
) -> Result<Vec<Outcome>, Failure> {
    let read: Vec<PathBuf> = robots.iter().flat_map(|robot| robot.files.clone()).collect();
    let modules = robots.iter().zip(paths).map(|(robot, path)| {
        let files = files(robot, path).into_iter();
        let planned = files.map(|(path, text)| Planned::new(&path, text, Replaces::Module, &read));
        planned.collect::<Result<Vec<_>, _>>()
    });
    let modules = modules.collect::<Result<Vec<_>, _>>()?;
    let root = root.map(|(workspace, text)| {
        Planned::new(&workspace.modules().join("lib.rs"), text, Replaces::Root, &read)
    });
    let root = root.transpose()?;
    let outcomes = modules.iter().map(|files| write_files(files)).collect::<Result<_, _>>()?;
    if let Some(root) = root {
        root.write()?;
    }
    Ok(outcomes)
}

/// Writes the files of one module.
fn write_files(files: &[Planned<'_>]) -> Result<Outcome, Failure> {
    let outcomes = files.iter().map(Planned::write).collect::<Result<Vec<_>, _>>()?;
    Ok(match outcomes.contains(&Outcome::Written) {
        true => Outcome::Written,
        false => Outcome::Unchanged,
    })
}

/// Writes the modules of all descriptions in models/. Nothing is written if a description has an error.
fn generate_all(workspace: &Workspace, modules: &Modules, format: Format) -> Result<ExitCode, Failure> {
    let robots = derive_all(workspace, modules)?;
    say_notes(&robots, format);
    let paths: Vec<PathBuf> =
        robots.iter().map(|robot| place(robot, &Target::default(), Some(workspace))).collect();
    let root = output::root_text(&documented(&robots));
    let outcomes = write(&robots, &paths, Some((workspace, &root)))?;
    let (mut lines, mut results) = (String::new(), Vec::new());
    for ((robot, path), outcome) in robots.iter().zip(&paths).zip(outcomes) {
        lines.push_str(&format!("{}\n", line(robot, path, outcome)));
        results.push(result(robot, path, outcome));
    }
    for path in output::left_over(&workspace.modules(), &names(&robots))? {
        std::fs::remove_file(&path)?;
        lines.push_str(&format!("removed   {}: no description in models/ has this name\n", relative(&path)));
    }
    match format {
        Format::Json => print::json(&Value::Array(results)),
        Format::Text => print::out(&lines).map(|()| ExitCode::SUCCESS),
    }
}

/// Compares one module, or all modules, with the text that the generator would write.
pub(super) fn check(arguments: &Check, format: Format) -> Result<ExitCode, Failure> {
    let workspace = Workspace::find();
    let modules = &arguments.modules;
    let stale = match (&arguments.description, &workspace) {
        (Some(description), _) => {
            let output = arguments.output.as_deref();
            let target = Target::new(output, modules.language)?;
            let command = modules_command(description, modules, output, workspace.as_ref());
            let robots = derive_modules(description, modules, command.clone(), &target).map_err(problem)?;
            let is_home = |place: &&Workspace| target.may_be_home() && place.contains(description);
            let home = workspace.as_ref().filter(is_home);
            let files = robots.iter().flat_map(|robot| files(robot, &place(robot, &target, home)));
            let stale = files.filter(|(path, text)| !output::check(path, text));
            stale.map(|(path, _)| (path, command.clone())).collect()
        }
        (None, Some(workspace)) => stale(workspace, modules)?,
        (None, None) => return Err(no_workspace()),
    };
    report_stale(&stale, format)
}

fn stale(workspace: &Workspace, modules: &Modules) -> Result<Vec<(PathBuf, String)>, Failure> {
    let robots = derive_all(workspace, modules)?;
    let root = output::root_text(&documented(&robots));
    let target = Target::default();
    let modules = robots.iter().map(|robot| (place(robot, &target, Some(workspace)), &robot.source.text));
    let expected = modules.chain([(workspace.modules().join("lib.rs"), &root)]);
    let mut stale: Vec<PathBuf> =
        expected.filter(|(path, text)| !output::check(path, text)).map(|(path, _)| path).collect();
    stale.extend(output::left_over(&workspace.modules(), &names(&robots))?);
    Ok(stale.into_iter().map(|path| (path, "gelenk generate".to_owned())).collect())
}

fn report_stale(stale: &[(PathBuf, String)], format: Format) -> Result<ExitCode, Failure> {
    let code = if stale.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(FAULT) };
    if format == Format::Json {
        let files: Vec<String> = stale.iter().map(|(path, _)| relative(path)).collect();
        let commands: Vec<&String> = stale.iter().map(|(_, command)| command).take(1).collect();
        print::json(&json!({ "fresh": stale.is_empty(), "stale": files, "command": commands.first() }))?;
        return Ok(code);
    }
    let Some((_, command)) = stale.first() else {
        print::out("fresh\n")?;
        return Ok(code);
    };
    let state = |path: &Path| if path.exists() { "stale" } else { "missing" };
    let files: String =
        stale.iter().map(|(path, _)| format!("{}: {}\n", state(path), relative(path))).collect();
    print::err(&format!("{files}run: {command}\n"));
    Ok(code)
}

/// Derives the modules of all descriptions of the workspace. A failure has the problems of all descriptions.
fn derive_all(workspace: &Workspace, modules: &Modules) -> Result<Vec<Generated>, Failure> {
    if modules.language != LanguageName::Rust {
        return Err(Failure::Usage(
            "`--language c` needs a description. Without one, only the Rust crate of models/ can be generated"
                .to_owned(),
        ));
    }
    let target = Target::default();
    let (mut robots, mut problems) = (Vec::new(), Vec::new());
    for description in workspace.descriptions()? {
        let command = modules_command(&description, modules, None, Some(workspace));
        match derive_modules(Path::new(&relative(&description)), modules, command, &target) {
            Ok(derived) => robots.extend(derived),
            Err(diagnostics) => problems.push(diagnostics),
        }
    }
    if !problems.is_empty() {
        return Err(Failure::Descriptions(problems));
    }
    robots.sort_by(|a, b| a.source.name.cmp(&b.source.name));
    if let Some(pair) = names(&robots).windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Failure::Problem(format!(
            "two descriptions have the robot name `{}`: rename one",
            pair[0]
        )));
    }
    names(&robots).iter().try_for_each(|name| refuse_root(name))?;
    Ok(robots)
}

fn names(robots: &[Generated]) -> Vec<String> {
    let names = robots.iter().map(|robot| robot.source.name.clone());
    names.collect()
}

/// Names and documentation of the modules, for the root file of the crate.
fn documented(robots: &[Generated]) -> Vec<(String, String)> {
    let modules = robots.iter().map(|robot| {
        let documentation = documentation(&robot.source.text);
        (robot.source.name.clone(), documentation)
    });
    modules.collect()
}

/// Returns an error if a module has the name of the crate's root file, `lib`.
fn refuse_root(name: &str) -> Result<(), Failure> {
    match name {
        "lib" => Err(Failure::Problem(
            "`lib` is the root file of the crate generated/: rename the robot".to_owned(),
        )),
        _ => Ok(()),
    }
}

/// Generates the module of one description, and prints progress.
pub(super) fn derive(description: &Path, choices: &Choices, command: String) -> Result<Generated, Failure> {
    let _progress = Progress::start(description.display().to_string());
    pipeline::generate(description, &options(choices, command)).map_err(problem)
}

/// Generates the module of a description, or the exact and the smooth module.
fn derive_modules(
    description: &Path,
    modules: &Modules,
    command: String,
    target: &Target,
) -> Result<Vec<Generated>, Diagnostics> {
    let _progress = Progress::start(description.display().to_string());
    let mut options = options(&modules.choices, command);
    options.emit.language = modules.language.into();
    options.emit.companions = modules.companions();
    options.emit.name = target.name.clone();
    match modules.control_model {
        Some(slope) => pipeline::generate_pair(description, &options, slope).map(Vec::from),
        None => pipeline::generate(description, &options).map(|robot| vec![robot]),
    }
}

fn problem(diagnostics: Diagnostics) -> Failure {
    Failure::Descriptions(vec![diagnostics])
}

/// Prints the notes to standard error without duplicates. With JSON nothing is printed, because the notes are
/// part of the result.
pub(super) fn say_notes(robots: &[Generated], format: Format) {
    let notes = robots.iter().flat_map(|robot| robot.notes.entries());
    let notes = Diagnostics::new(notes.cloned().collect());
    if format == Format::Text && !notes.is_empty() {
        print::err(&format!("{notes}\n\n"));
    }
}

fn options(choices: &Choices, command: String) -> GenerateOptions {
    GenerateOptions {
        functions: choices.functions.clone(),
        reading: choices.reading.options(),
        fused_multiply_add: choices.fused_multiply_add,
        self_test: choices.self_test,
        form: Form::Cheapest,
        max_operations: choices.max_operations,
        lanes: choices.lanes.clone(),
        remarks: vec![],
        emit: EmitOptions { scalar: choices.scalar.into(), command, ..EmitOptions::default() },
    }
}

/// The command that regenerates a file. Paths are relative to the workspace or the current folder.
pub(super) fn command(
    description: &Path,
    choices: &Choices,
    output: Option<&Path>,
    workspace: Option<&Workspace>,
) -> String {
    let mut words = vec!["gelenk generate".to_owned(), quoted(&shown(description, workspace))];
    if let Some(output) = output.filter(|output| *output != Path::new("-") && !output.is_absolute()) {
        words.push(format!("--output {}", quoted(&shown(output, None))));
    }
    if !choices.functions.is_empty() {
        words.push(format!("--functions {}", quoted(&choices.functions.join(","))));
    }
    if !choices.lanes.is_empty() {
        words.push(format!("--lanes {}", quoted(&choices.lanes.join(","))));
    }
    if choices.scalar == ScalarName::F32 {
        words.push("--scalar f32".to_owned());
    }
    words.extend(choices.reading.words().iter().map(|word| quoted(word)));
    words.extend(choices.fused_multiply_add.then(|| "--fused-multiply-add".to_owned()));
    words.extend(choices.self_test.then(|| "--self-test".to_owned()));
    if let Some(most) = choices.max_operations {
        words.push(format!("--max-operations {most}"));
    }
    words.join(" ")
}

/// The command that regenerates one module or the pair of modules, including language and tools.
fn modules_command(
    description: &Path,
    modules: &Modules,
    output: Option<&Path>,
    workspace: Option<&Workspace>,
) -> String {
    let mut command = command(description, &modules.choices, output, workspace);
    if modules.language == LanguageName::C {
        command.push_str(" --language c");
    }
    let tools = modules.tools().into_iter().map(|tool| format!("{tool:?}").to_lowercase());
    let tools: Vec<String> = tools.collect();
    if !tools.is_empty() {
        command.push_str(&format!(" --for {}", tools.join(",")));
    }
    if let Some(slope) = modules.control_model {
        command.push_str(&format!(" --control-model {slope:?}"));
    }
    command
}

/// Path of a module's file. `target` decides; by default the file is in the crate of the workspace `home`, or
/// in the current folder if `home` is `None`. The smooth module of a pair is next to the exact module.
fn place(robot: &Generated, target: &Target, home: Option<&Workspace>) -> PathBuf {
    let name = &robot.source.name;
    match (&target.output, home) {
        (Output::Folder(folder), _) => {
            folder.join(format!("{name}.{}", if robot.source.header.is_some() { "c" } else { "rs" }))
        }
        (Output::File(output), _) if robot.is_control_model => {
            let stem = output.file_stem().unwrap_or_default();
            let mut file = stem.to_owned();
            file.push(CONTROL);
            if let Some(extension) = output.extension() {
                file.push(".");
                file.push(extension);
            }
            output.with_file_name(file)
        }
        (Output::File(output), _) => output.to_owned(),
        (Output::Default, Some(home)) => home.modules().join(format!("{name}.rs")),
        (Output::Default, None) => PathBuf::from(format!("{name}.rs")),
    }
}

/// Paths and texts of all files of a module. `path` is the path of its source.
fn files<'r>(robot: &'r Generated, path: &Path) -> Vec<(PathBuf, &'r str)> {
    match robot.source.header {
        None => vec![(path.to_owned(), &robot.source.text)],
        Some(_) => {
            let files = robot.source.files().into_iter();
            files.map(|(ending, text)| (with_ending(path, ending), text)).collect()
        }
    }
}

/// The path of a module's file with another ending after the name of the module.
fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// Text of the root file of the crate `generated`, with these modules and the modules that exist.
fn root_with(home: &Workspace, robots: &[Generated]) -> Result<String, Failure> {
    robots.iter().try_for_each(|robot| refuse_root(&robot.source.name))?;
    let mut modules = documented(robots);
    modules.extend(output::documented(&home.modules())?);
    Ok(output::root_text(&modules))
}

fn line(robot: &Generated, path: &Path, outcome: Outcome) -> String {
    let outcome = match outcome {
        Outcome::Written => "wrote    ",
        Outcome::Unchanged => "unchanged",
    };
    let (n, m) = (robot.model.coordinates.len(), inputs(robot));
    let (paths, texts) = (files(robot, path).into_iter(), files(robot, path).into_iter());
    let paths = paths.map(|(path, _)| relative(&path));
    let functions = robot.module.functions.len() + robot.module.compositions.len();
    format!(
        "{outcome} {}: {}, {}, {}, {} lines",
        paths.collect::<Vec<_>>().join(", "),
        counted(n, "coordinate", "coordinates"),
        counted(m, "input", "inputs"),
        counted(functions, "function", "functions"),
        texts.map(|(_, text)| text.lines().count()).sum::<usize>(),
    )
}

fn inputs(robot: &Generated) -> usize {
    robot.model.inputs().count()
}

fn result(robot: &Generated, path: &Path, outcome: Outcome) -> Value {
    let mut result = json!({
        "robot": robot.source.name,
        "file": relative(path),
        "files": files(robot, path).iter().map(|(path, _)| relative(path)).collect::<Vec<_>>(),
        "written": outcome == Outcome::Written,
        "coordinates": robot.model.coordinates.len(),
        "inputs": inputs(robot),
        "functions": counts(&robot.module.costs(), &[]).records(),
        "notes": print::diagnostics(&robot.notes),
        "read": robot.files.iter().map(|file| relative(file)).collect::<Vec<_>>(),
    });
    if let Some(interface) = &robot.source.interface {
        result["interface"] = interface::json(interface, &robot.module);
    }
    result
}

/// The path relative to the current folder if the file is below it, otherwise the path unchanged.
fn relative(path: &Path) -> String {
    let current = std::env::current_dir().unwrap_or_default();
    path.strip_prefix(&current).unwrap_or(path).display().to_string()
}

fn no_workspace() -> Failure {
    Failure::Usage(
        "name a description, or run this command below a folder with models/ and generated/src/".to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::super::arguments::{Arguments, Command};
    use super::super::choices::Reading;
    use super::super::failure::INTERNAL;
    use super::*;
    use crate::diagnostic::Diagnostic;
    use crate::pipeline::wrong_functions;
    use crate::verify;
    use clap::Parser;
    use gelenk_formula::Hold;
    use std::ffi::OsString;

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
                base: None,
                hold: vec![Hold { pattern: "finger_*".into(), position: 0.02 }],
                body: None,
            },
            lanes: vec![],
            fused_multiply_add: false,
            self_test: false,
            max_operations: None,
        };
        let command = command(Path::new("my robots/arm.urdf"), &choices, Some(Path::new("src/arm.rs")), None);
        assert_eq!(
            command,
            "gelenk generate 'my robots/arm.urdf' --output src/arm.rs --functions mass_matrix,bias_forces \
             --scalar f32 --snap-angles 0.0001 --smooth-sign 100.0 --no-friction --accept-unphysical --hold 'finger_*=0.02'"
        );
    }

    #[test]
    fn the_current_folder_has_a_name() {
        for folder in [".", "./"] {
            assert_eq!(shown(Path::new(folder), None), ".");
        }
    }

    #[test]
    fn a_wrong_function_refuses_the_module() {
        let folder = tempfile::tempdir().unwrap();
        let description = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/two_arm.toml");
        let words = ["gelenk", "generate", description.to_str().unwrap(), "--output"];
        let words = words.map(OsString::from).into_iter().chain([folder.path().join("arm.rs").into()]);
        let arguments = Arguments::parse_from(words);
        let Command::Generate(arguments) = arguments.command else { panic!("another command") };
        let run = || generate(&arguments, Format::Json);
        let failure = wrong_functions::during(run).unwrap_err();
        let Failure::Descriptions(all) = &failure else { panic!("{failure:?}") };
        let problems: Vec<&Diagnostic> = all.iter().flat_map(Diagnostics::entries).collect();
        assert!(problems.iter().all(|problem| problem.code == verify::INTERNAL), "{problems:?}");
        assert!(
            all[0]
                .to_string()
                .contains(concat!("please report it with the description at ", env!("CARGO_PKG_REPOSITORY")))
        );
        assert_eq!(failure.say(Format::Json), INTERNAL);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0, "something is written");
        run().unwrap();
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    }
}
