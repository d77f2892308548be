//! The command `gelenk new`, which creates a small project: a robot with a simulation in Rust, C or Python,
//! or with ROS 2 controllers.

mod project;
mod robot;
mod source;

use std::fs;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::arguments::{Format, New};
use super::choices::Reading;
use super::failure::Failure;
use super::{print, schema};
use crate::wording::quoted;
use project::Project;
use robot::{Robot, robot};
use source::source;

/// Names that Cargo or the compiler reserves, and names of dependencies.
const TAKEN: [&str; 13] = [
    "alloc",
    "build",
    "core",
    "deps",
    "examples",
    "gelenk-codegen",
    "gelenk-runtime",
    "gelenk_codegen",
    "gelenk_runtime",
    "incremental",
    "proc_macro",
    "std",
    "test",
];

/// Creates the folder and files of a new project.
pub(super) fn new(arguments: &New, format: Format) -> Result<ExitCode, Failure> {
    let folder = &arguments.folder;
    let reading = Reading {
        base: arguments.base,
        hold: arguments.hold.clone(),
        body: arguments.body.clone(),
        ..Reading::default()
    };
    let robot = robot(arguments.urdf.as_deref(), &reading)?;
    let (project, package) = project(arguments, &robot)?;
    let description = format!("#:schema ./{}\n{}", schema::FILE, robot.description);
    let schema = format!("{:#}\n", schema::of_descriptions());
    let described = [("robot.toml", description.as_bytes()), (schema::FILE, schema.as_bytes())];
    let copies = robot.copies.iter().map(|(place, content)| (place.as_str(), content.as_slice()));
    let texts = project.files.iter().map(|(name, text)| (*name, text.as_bytes()));
    let files: Vec<(&str, &[u8])> = described.into_iter().chain(copies).chain(texts).collect();
    require_places(&files)?;
    make(folder)?;
    if let Err(error) = write(folder, &files) {
        // An incomplete project is removed. The message is the same if that fails.
        let _ = fs::remove_dir_all(folder);
        return Err(cannot_make(folder, &error));
    }
    match format {
        Format::Json => {
            let names: Value = files.iter().map(|(name, _)| *name).collect();
            let mut made = json!({ "folder": folder.display().to_string(), "files": names });
            if let Some(package) = package {
                made["package"] = package.into();
            }
            if !robot.notes.is_empty() {
                made["notes"] = print::diagnostics(&robot.notes);
            }
            print::json(&made)
        }
        Format::Text => {
            if !robot.notes.is_empty() {
                print::err(&format!("{}\n\n", robot.notes));
            }
            print::out(&format!(
                "made {0}: robot.toml describes the robot, {1}\n\
                 next: cd {0} && {2}\n\
                 a page about the robot: {3} report {4}\n",
                quoted(&folder.to_string_lossy()),
                project.made,
                project.next,
                quoted(&this_program()),
                quoted(&folder.join("robot.toml").to_string_lossy())
            ))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Returns an error if a file that an MJCF includes has the same path as a file of the project.
fn require_places(files: &[(&str, &[u8])]) -> Result<(), Failure> {
    let mut names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]) {
        None => Ok(()),
        Some(name) => Err(Failure::Usage(format!(
            "the MJCF includes {}, but a file of the project has the same name\n  = help: rename the included file",
            quoted(name)
        ))),
    }
}

/// The project in the requested language, and the name of its package; the name is `None` for C and Python.
fn project(arguments: &New, robot: &Robot) -> Result<(Project, Option<String>), Failure> {
    if arguments.c {
        return Ok((Project::c(robot.floats), None));
    }
    if arguments.ros2 {
        robot.require_efforts("the controllers for ros2_control command")?;
        let name = ros_name(name(&arguments.folder)?)?;
        return Ok((Project::ros2(&name, &robot.joints), Some(name)));
    }
    let source = source(arguments)?;
    if arguments.python {
        return Ok((Project::python(&source, robot.floats)?, None));
    }
    let name = name(&arguments.folder)?;
    if arguments.online_friction {
        robot.require_efforts("the program for --online-friction commands")?;
    }
    Ok((Project::rust(&name, &source, robot, arguments.online_friction), Some(name)))
}

/// Creates the folder of the project. It must not exist, so that it may be removed after a failure.
fn make(folder: &Path) -> Result<(), Failure> {
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty());
    let made = parent.map_or(Ok(()), fs::create_dir_all);
    match made.and_then(|()| fs::create_dir(folder)) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.symlink_metadata().is_ok() => {
            Err(Failure::Problem(format!(
                "{} exists already\n  = help: choose another name, or remove it first",
                folder.display()
            )))
        }
        Err(error) => Err(cannot_make(folder, &error)),
        Ok(()) => Ok(()),
    }
}

fn cannot_make(folder: &Path, error: &io::Error) -> Failure {
    Failure::Problem(format!(
        "cannot create {}: {error}\n  = help: choose a folder with write permission",
        folder.display()
    ))
}

/// Name with which this program was called.
fn this_program() -> String {
    std::env::args().next().unwrap_or_else(|| "gelenk".to_owned())
}

/// Name of the package, which is the folder's name. Returns an error if Cargo would reject it.
fn name(folder: &Path) -> Result<String, Failure> {
    let name = folder.file_name().and_then(|name| name.to_str());
    let Some(name) = name else {
        return Err(Failure::Usage(format!(
            "`{}` does not end in a crate name\n  = help: name a new folder, for example `gelenk new my_arm`",
            folder.display()
        )));
    };
    match fault(name) {
        None => Ok(name.to_owned()),
        Some(fault) => Err(Failure::Usage(format!(
            "`{name}` is not a valid crate name: {fault}\n  = help: the last part of the path is the crate \
             name, for example `gelenk new my_arm`"
        ))),
    }
}

/// Returns the name if ROS accepts it for a package (REP 144), otherwise an error.
fn ros_name(name: String) -> Result<String, Failure> {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if name.chars().all(is_letter) {
        return Ok(name);
    }
    Err(Failure::Usage(format!(
        "`{name}` is not a valid ROS package name\n  = help: use lower-case letters, digits and `_`, for example \
         `gelenk new my_arm --ros2`"
    )))
}

fn fault(name: &str) -> Option<&'static str> {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let as_module = name.replace('-', "_");
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        Some("it must begin with a letter from a to z")
    } else if !name.chars().all(is_letter) {
        Some("only letters from a to z, digits, `-` and `_` are allowed")
    } else if name.len() > 64 {
        Some("it is longer than 64 characters")
    } else if TAKEN.contains(&name) {
        Some("this name is reserved")
    } else if syn::parse_str::<syn::Ident>(&as_module).is_err() {
        Some("it is a Rust keyword")
    } else {
        None
    }
}

fn write(folder: &Path, files: &[(&str, &[u8])]) -> io::Result<()> {
    for (name, text) in files {
        let file = folder.join(name);
        file.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(file, text)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_cargo_takes() {
        for good in ["arm", "my-arm", "arm_2", "Arm"] {
            assert_eq!(fault(good), None, "{good}");
        }
        for bad in ["", "2arm", "-arm", "my arm", "arm!", "ärm", "test", "core", "fn", "a/b"] {
            assert!(fault(bad).is_some(), "{bad}");
        }
    }
}
