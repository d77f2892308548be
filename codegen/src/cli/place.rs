//! Paths of descriptions and modules.

use std::env;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use gelenk_files::is_same_file;

use super::choices::LanguageName;
use super::failure::Failure;

/// A folder with `models/` and `generated/src/`, such as the workspace of gelenk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Workspace {
    pub(super) root: PathBuf,
}

impl Workspace {
    /// Finds the workspace that contains the current folder; `None` if there is none.
    pub(super) fn find() -> Option<Self> {
        Self::above(&env::current_dir().ok()?)
    }

    fn above(folder: &Path) -> Option<Self> {
        let is_root =
            |folder: &&Path| folder.join("models").is_dir() && folder.join("generated/src").is_dir();
        folder.ancestors().find(is_root).map(|root| Self { root: root.to_owned() })
    }

    /// Folder of generated modules.
    pub(super) fn modules(&self) -> PathBuf {
        self.root.join("generated/src")
    }

    /// Paths of the descriptions in models/, sorted by name. These are all TOML files, and the URDF files
    /// without a TOML file of the same name.
    pub(super) fn descriptions(&self) -> io::Result<Vec<PathBuf>> {
        let entries = fs::read_dir(self.root.join("models"))?;
        let paths = entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>()?;
        let has = |path: &Path, extension: &str| path.extension().is_some_and(|own| own == extension);
        let is_description = |path: &&PathBuf| {
            has(path, "toml") || has(path, "urdf") && !paths.contains(&path.with_extension("toml"))
        };
        let mut descriptions: Vec<PathBuf> = paths.iter().filter(is_description).cloned().collect();
        descriptions.sort();
        Ok(descriptions)
    }

    /// Whether the file is directly in models/.
    pub(super) fn contains(&self, description: &Path) -> bool {
        let folder = fs::canonicalize(description).ok().and_then(|path| path.parent().map(Path::to_owned));
        folder.is_some() && folder == fs::canonicalize(self.root.join("models")).ok()
    }
}

/// Path and name of a module to be written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Target {
    pub(super) output: Output,
    /// Name of the module from the file name; `None` if the module has the robot's name.
    pub(super) name: Option<String>,
}

/// Path to which a module is written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) enum Output {
    /// The module is written to the default path of Rust modules.
    #[default]
    Default,
    /// The module is written to this file. A C header is written next to it.
    File(PathBuf),
    /// The module is written to this folder, in a file with the module's name.
    Folder(PathBuf),
}

impl Target {
    pub(super) fn new(output: Option<&Path>, language: LanguageName) -> Result<Self, Failure> {
        match (language, output) {
            (LanguageName::Rust, None) => Ok(Self::default()),
            (LanguageName::Rust, Some(file)) if is_of_c(file) => Err(Failure::Usage(format!(
                "{} is a name for a C module: add `--language c`",
                file.display()
            ))),
            (LanguageName::Rust, Some(folder)) if is_folder(folder) => Ok(Self::folder(folder)),
            (LanguageName::Rust, Some(file)) => {
                Ok(Self { output: Output::File(file.to_owned()), name: None })
            }
            (LanguageName::C, None) => Ok(Self::folder(Path::new(""))),
            (LanguageName::C, Some(output)) => Self::of_c(output),
        }
    }

    /// Whether the module may be written to the crate of the workspace.
    pub(super) fn may_be_home(&self) -> bool {
        self.output == Output::Default
    }

    fn folder(folder: &Path) -> Self {
        Self { output: Output::Folder(folder.to_owned()), name: None }
    }

    fn of_c(output: &Path) -> Result<Self, Failure> {
        let usage = |message: String| Err(Failure::Usage(message));
        if output == Path::new("-") {
            return usage(
                "a C module consists of two files: name an output folder instead of standard output"
                    .to_owned(),
            );
        }
        if is_folder(output) {
            return Ok(Self::folder(output));
        }
        if !is_of_c(output) {
            return usage(format!(
                "{} is neither a folder nor a file name that ends with .c. The header of a C module is written next to the .c file",
                output.display()
            ));
        }
        let name = output.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_-.".contains(letter);
        if name.is_empty() || !name.chars().all(is_plain) {
            return usage(format!(
                "the file name {} is not usable in C: use letters, digits, `_` and `-`",
                output.display()
            ));
        }
        Ok(Self { output: Output::File(output.with_extension("c")), name: Some(name.to_owned()) })
    }
}

/// Whether the path is a folder for modules: it exists as a folder, or has no extension. A hyphen is standard
/// output.
fn is_folder(output: &Path) -> bool {
    output.is_dir() || (output.extension().is_none() && output != Path::new("-"))
}

/// Whether the file has the extension of a C source or header.
fn is_of_c(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "c" || extension == "h")
}

/// Returns an error if an output file is an input of the command, or if its folder does not exist.
pub(super) fn require_writable<'a>(
    file: &Path,
    mut read: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    match read.any(|known| is_same_file(known, file)) {
        true => Err(Failure::Problem(format!(
            "{} is an input of this command and is not overwritten: name another output file",
            file.display()
        ))),
        false => folder(file).map(|_| ()),
    }
}

/// Absolute path of an output file's folder. Returns an error if the folder does not exist.
pub(super) fn folder(file: &Path) -> Result<PathBuf, Failure> {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    folder.canonicalize().map_err(|error| {
        let help = "name a file in an existing folder with --output";
        Failure::Problem(format!("{}: {error}\n  = help: {help}", folder.display()))
    })
}

/// Path for comments in generated files. The path must not depend on the machine. It is relative to the
/// workspace for files in models/. Other relative paths only lose components `.`. For other absolute paths it
/// is the file name.
pub(super) fn shown(path: &Path, workspace: Option<&Workspace>) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if workspace.is_some_and(|workspace| workspace.contains(path)) {
        return format!("models/{name}");
    }
    if path.is_absolute() {
        return name;
    }
    let parts = path.components().filter(|part| *part != Component::CurDir);
    let shown = parts.map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/");
    if shown.is_empty() { ".".to_owned() } else { shown }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_workspace_lists_each_robot_once() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir_all(root.join("models/urdf")).unwrap();
        fs::create_dir_all(root.join("generated/src")).unwrap();
        for name in ["b.toml", "a.toml", "a.urdf", "c.urdf", "README.md"] {
            fs::write(root.join("models").join(name), "").unwrap();
        }
        let workspace = Workspace::above(&root.join("models/urdf")).unwrap();
        let names: Vec<_> =
            workspace.descriptions().unwrap().iter().map(|path| shown(path, Some(&workspace))).collect();
        assert_eq!(names, ["models/a.toml", "models/b.toml", "models/c.urdf"]);
        assert_eq!(Workspace::above(Path::new("/nowhere")), None);
    }

    #[test]
    fn headers_hold_no_absolute_path() {
        assert_eq!(shown(Path::new("/home/someone/arm.urdf"), None), "arm.urdf");
        assert_eq!(shown(Path::new("./robots/arm.urdf"), None), "robots/arm.urdf");
    }
}
