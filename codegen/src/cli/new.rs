//! The command `gelenk new`, which creates a small project: a robot with a simulation in Rust, C or Python,
//! or with ROS 2 controllers.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{Value, json};

use super::arguments::{Format, New};
use super::choices::BaseName;
use super::failure::Failure;
use super::new_project::Project;
use super::new_robot::{Feet, Robot, robot};
use super::{print, schema};
use crate::wording::{quoted, toml_text};

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

/// Creates the project.
pub(super) fn new(arguments: &New, format: Format) -> Result<ExitCode, Failure> {
    let folder = &arguments.folder;
    let is_crate = !(arguments.c || arguments.python || arguments.ros2);
    let feet = if is_crate { Feet::Of(&arguments.feet) } else { Feet::None };
    let robot = robot(
        arguments.urdf.as_deref(),
        arguments.base == Some(BaseName::Floating),
        (&arguments.hold, arguments.body.as_deref()),
        feet,
    )?;
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

/// The project in the requested language, and the name of its package; `None` for C and Python.
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
        return Ok((Project::python(&source.requirement()?, robot.floats), None));
    }
    let name = name(&arguments.folder)?;
    let manifest = manifest(&name, &source);
    if arguments.online_friction {
        robot.require_efforts("a program that learns friction commands")?;
        return Ok((Project::online_friction(manifest, robot), Some(name)));
    }
    Ok((Project::rust(manifest, robot), Some(name)))
}

/// Creates the folder. It must not exist, so that it may be removed after a failure.
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

/// The name if ROS accepts it for a package (REP 144), otherwise an error.
fn ros_name(name: String) -> Result<String, Failure> {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if name.chars().all(is_letter) {
        return Ok(name);
    }
    Err(Failure::Usage(format!(
        "`{name}` is not a valid ROS package name\n  = help: use small letters, digits and `_`, for example \
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

/// Source of gelenk's crates for the new project.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Source {
    /// The folder of a checkout.
    Path(PathBuf),
    /// The address of a Git repository.
    Git(String),
    /// A version in the registry.
    Version(String),
}

fn source(arguments: &New) -> Result<Source, Failure> {
    if let Some(url) = &arguments.git {
        return git(url);
    }
    if let Some(version) = &arguments.version {
        return registry(version);
    }
    let built = Path::new(env!("CARGO_MANIFEST_DIR"));
    let Some(folder) = arguments.checkout.as_deref().or(checkout_of(built)) else {
        return Ok(Source::Version(env!("CARGO_PKG_VERSION").to_owned()));
    };
    let is_checkout =
        ["codegen", "runtime"].iter().all(|part| folder.join(part).join("Cargo.toml").is_file());
    if !is_checkout {
        return Err(Failure::Problem(format!(
            "there is no checkout of gelenk at {}\n  = help: give the source of its crates with --checkout \
             FOLDER, --git URL or --version VERSION",
            folder.display()
        )));
    }
    let folder = fs::canonicalize(folder)?;
    if folder.to_str().is_none() {
        return Err(Failure::Problem(format!(
            "the path {} has characters that a manifest cannot contain\n  = help: move the checkout to a \
             folder whose path is valid Unicode",
            folder.display()
        )));
    }
    Ok(Source::Path(folder))
}

/// The checkout from which this program was built, which may have been moved. `None` if the package came from
/// a registry. Cargo unpacks a package of a registry to a folder with its name and version.
fn checkout_of(package: &Path) -> Option<&Path> {
    let unpacked = concat!(env!("CARGO_PKG_NAME"), "-", env!("CARGO_PKG_VERSION"));
    let folder = package.parent()?;
    (!package.ends_with(unpacked)).then_some(folder)
}

/// Checks the address of a repository. Cargo needs a scheme, so the short form `git@host:path` is an error.
fn git(url: &str) -> Result<Source, Failure> {
    let is_whole = url.split_once("://").is_some_and(|(scheme, rest)| !scheme.is_empty() && !rest.is_empty());
    if is_whole && !url.contains(char::is_whitespace) {
        return Ok(Source::Git(url.to_owned()));
    }
    let ssh = url
        .split_once(':')
        .map_or_else(|| "ssh://git@HOST/PATH".to_owned(), |(host, path)| format!("ssh://{host}/{path}"));
    Err(Failure::Usage(format!(
        "`--git {url}` is not an address that Cargo accepts\n  = help: give the whole address, for example \
         https://HOST/PATH, {ssh} or file:///PATH"
    )))
}

/// Checks a version: one to three numbers with an optional suffix, as Cargo reads it.
fn registry(version: &str) -> Result<Source, Failure> {
    let numbers = version.trim_start_matches(['^', '=', '~']);
    let core = numbers.split(['-', '+']).next().unwrap_or_default();
    let parts: Vec<&str> = core.split('.').collect();
    let is_number = |part: &&str| part.parse::<u64>().is_ok();
    if parts.len() <= 3 && parts.iter().all(is_number) {
        return Ok(Source::Version(version.to_owned()));
    }
    Err(Failure::Usage(format!(
        "`--version {version}` is not a version\n  = help: give one to three numbers, for example `--version 0.1`"
    )))
}

impl Source {
    /// The Python package as a line of `requirements.txt`.
    fn requirement(&self) -> Result<String, Failure> {
        match self {
            Self::Path(folder) => {
                let package = folder.join("codegen/python");
                match package.join("pyproject.toml").is_file() {
                    true => Ok(package.to_string_lossy().into_owned()),
                    false => Err(Failure::Problem(format!(
                        "there is no Python package at {}\n  = help: give another checkout with --checkout FOLDER",
                        package.display()
                    ))),
                }
            }
            Self::Git(url) => Ok(format!("gelenk @ git+{url}#subdirectory=codegen/python")),
            Self::Version(version) => Ok(format!("gelenk=={}", version.trim_start_matches(['^', '=', '~']))),
        }
    }

    /// Entry of a dependency in `Cargo.toml`, without the closing brace.
    fn entry(&self, part: &str) -> String {
        match self {
            Self::Path(folder) => {
                format!("{{ path = {}", toml_text(&folder.join(part).to_string_lossy()))
            }
            Self::Git(url) => format!("{{ git = {}", toml_text(url)),
            Self::Version(version) => format!("{{ version = {}", toml_text(version)),
        }
    }
}

fn manifest(name: &str, source: &Source) -> String {
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\npublish = false\n\n\
         # Beside it: gelenk-identification for friction from logs, gelenk-report for pages of results.\n\
         [dependencies]\n\
         gelenk-runtime = {} }}\n\n\
         [build-dependencies]\n\
         gelenk-codegen = {}, default-features = false }}\n\n\
         # A workspace of its own, wherever it lies.\n\
         [workspace]\n",
        source.entry("runtime"),
        source.entry("codegen"),
    )
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

    #[test]
    fn sources_are_those_that_cargo_takes() {
        for good in ["https://example.org/gelenk.git", "ssh://git@host/a", "file:///srv/gelenk"] {
            assert!(git(good).is_ok(), "{good}");
        }
        for bad in ["", "x", "git@host:a/b.git", "../gelenk", "https://a b", "://x"] {
            assert!(git(bad).is_err(), "{bad}");
        }
        let Err(Failure::Usage(message)) = git("git@host:a/b.git") else {
            panic!("Cargo takes none of this form");
        };
        assert!(message.contains("ssh://git@host/a/b.git"), "{message}");
        for good in ["1", "0.1", "=0.1.2", "^1.2.3", "0.1.0-alpha.1"] {
            assert!(registry(good).is_ok(), "{good}");
        }
        for bad in ["", "banana", "1.", "1.2.3.4", "-1", "v1"] {
            assert!(registry(bad).is_err(), "{bad}");
        }
    }

    /// A package of a registry lies next to other packages, without a checkout.
    #[test]
    fn a_program_from_a_registry_has_no_checkout() {
        let registry = Path::new("/home/a/.cargo/registry/src/index");
        let unpacked = format!("gelenk-codegen-{}", env!("CARGO_PKG_VERSION"));
        assert_eq!(checkout_of(&registry.join(unpacked)), None);
        let checkout = Path::new("/home/a/gelenk");
        assert_eq!(checkout_of(&checkout.join("codegen")), Some(checkout));
    }

    #[test]
    fn any_address_stays_one_text() {
        assert_eq!(toml_text("C:\\a \"b\"\n"), r#""C:\\a \"b\"\u000A""#);
    }
}
