//! `gelenk new`: a small crate with a robot, a build script and a simulation.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{Value, json};

use super::Failure;
use super::arguments::{Format, New};
use super::print;

/// The files of the crate besides its manifest.
const FILES: [(&str, &str); 4] = [
    ("build.rs", include_str!("template/build.rs")),
    ("robot.toml", include_str!("template/robot.toml")),
    ("src/main.rs", include_str!("template/main.rs")),
    (".gitignore", "/target\n/report\n"),
];

/// Names that Cargo or the compiler keep for themselves, and those of the dependencies.
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

/// Makes the crate.
pub(super) fn new(arguments: &New, format: Format) -> Result<ExitCode, Failure> {
    let folder = &arguments.folder;
    let name = name(folder)?;
    let manifest = manifest(&name, &source(arguments)?);
    if folder.symlink_metadata().is_ok() {
        return Err(Failure::Problem(format!(
            "{} exists already\n  = help: choose another name, or remove it first",
            folder.display()
        )));
    }
    let files: Vec<(&str, &str)> = std::iter::once(("Cargo.toml", manifest.as_str()))
        .chain(FILES)
        .collect();
    if let Err(error) = write(folder, &files) {
        // Half a crate helps nobody; whether it could be removed changes nothing about the message.
        let _ = fs::remove_dir_all(folder);
        return Err(Failure::Problem(format!(
            "cannot make {}: {error}",
            folder.display()
        )));
    }
    match format {
        Format::Json => {
            let names: Value = files.iter().map(|(name, _)| *name).collect();
            print::json(
                &json!({ "package": name, "folder": folder.display().to_string(), "files": names }),
            )
        }
        Format::Text => {
            print::out(&format!(
                "made {0}: robot.toml describes the robot, build.rs generates its equations, src/main.rs simulates it\n\
                 next: cd {0} && cargo run\n",
                folder.display()
            ))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// The package's name: the folder's, where Cargo takes it.
fn name(folder: &Path) -> Result<String, Failure> {
    let name = folder.file_name().and_then(|name| name.to_str());
    let Some(name) = name else {
        return Err(Failure::Usage(format!(
            "`{}` does not end in a name for the crate",
            folder.display()
        )));
    };
    match fault(name) {
        None => Ok(name.to_owned()),
        Some(fault) => Err(Failure::Usage(format!(
            "`{name}` cannot name a crate: {fault}"
        ))),
    }
}

fn fault(name: &str) -> Option<&'static str> {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let as_module = name.replace('-', "_");
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        Some("it must begin with a letter from a to z")
    } else if !name.chars().all(is_letter) {
        Some("it may hold letters from a to z, digits, `-` and `_`")
    } else if name.len() > 64 {
        Some("it is longer than 64 letters")
    } else if TAKEN.contains(&name) {
        Some("that name is taken")
    } else if syn::parse_str::<syn::Ident>(&as_module).is_err() {
        Some("that is a word of Rust")
    } else {
        None
    }
}

/// Where the crates of this project come from.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Source {
    /// A checkout.
    Path(PathBuf),
    /// A repository.
    Git(String),
    /// A registry.
    Version(String),
}

fn source(arguments: &New) -> Result<Source, Failure> {
    if let Some(url) = &arguments.git {
        return Ok(Source::Git(url.clone()));
    }
    if let Some(version) = &arguments.version {
        return Ok(Source::Version(version.clone()));
    }
    // Where this program was built, unless that has moved.
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    let folder = arguments
        .checkout
        .as_deref()
        .or(built)
        .unwrap_or(Path::new("."));
    let is_checkout = ["codegen", "runtime"]
        .iter()
        .all(|part| folder.join(part).join("Cargo.toml").is_file());
    if !is_checkout {
        return Err(Failure::Problem(format!(
            "no checkout of gelenk at {}\n  = help: say where its crates come from with --checkout FOLDER, --git URL or --version VERSION",
            folder.display()
        )));
    }
    Ok(Source::Path(fs::canonicalize(folder)?))
}

impl Source {
    /// The entry of a dependency, without the closing brace.
    fn entry(&self, part: &str) -> String {
        match self {
            Self::Path(folder) => {
                format!("{{ path = {}", quoted(&folder.join(part).to_string_lossy()))
            }
            Self::Git(url) => format!("{{ git = {}", quoted(url)),
            Self::Version(version) => format!("{{ version = {}", quoted(version)),
        }
    }
}

fn manifest(name: &str, source: &Source) -> String {
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\npublish = false\n\n\
         # Further features: `identification` for friction from logs, `report` for pages of results.\n\
         [dependencies]\n\
         gelenk-runtime = {}, default-features = false, features = [\"control\"] }}\n\n\
         [build-dependencies]\n\
         gelenk-codegen = {}, default-features = false }}\n\n\
         # A workspace of its own, wherever it lies.\n\
         [workspace]\n",
        source.entry("runtime"),
        source.entry("codegen"),
    )
}

/// A text of TOML.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => out.extend(['\\', letter]),
            control if control.is_control() => {
                out.push_str(&format!("\\u{:04X}", u32::from(control)));
            }
            other => out.push(other),
        }
    }
    out.push('"');
    out
}

fn write(folder: &Path, files: &[(&str, &str)]) -> io::Result<()> {
    fs::create_dir_all(folder.join("src"))?;
    for (name, text) in files {
        fs::write(folder.join(name), text)?;
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
        for bad in [
            "", "2arm", "-arm", "my arm", "arm!", "ärm", "test", "core", "fn", "a/b",
        ] {
            assert!(fault(bad).is_some(), "{bad}");
        }
    }

    #[test]
    fn any_address_stays_one_text() {
        assert_eq!(quoted("C:\\a \"b\"\n"), r#""C:\\a \"b\"\u000A""#);
    }
}
