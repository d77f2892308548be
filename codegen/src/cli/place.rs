//! Where descriptions and modules lie.

use std::env;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use gelenk_files::is_same_file;

use super::Failure;

/// A folder with `models/` and `generated/src/`: this project's workspace, or one like it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Workspace {
    pub(super) root: PathBuf,
}

impl Workspace {
    /// The nearest one at or above the current folder.
    pub(super) fn find() -> Option<Self> {
        Self::above(&env::current_dir().ok()?)
    }

    fn above(folder: &Path) -> Option<Self> {
        let is_root =
            |folder: &&Path| folder.join("models").is_dir() && folder.join("generated/src").is_dir();
        folder.ancestors().find(is_root).map(|root| Self { root: root.to_owned() })
    }

    /// Folder of the generated modules.
    pub(super) fn modules(&self) -> PathBuf {
        self.root.join("generated/src")
    }

    /// Descriptions in models/, sorted by name: each TOML, and each URDF without a TOML of the same name.
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

    /// Tells whether the file lies directly in models/.
    pub(super) fn contains(&self, description: &Path) -> bool {
        let folder = fs::canonicalize(description).ok().and_then(|path| path.parent().map(Path::to_owned));
        folder.is_some() && folder == fs::canonicalize(self.root.join("models")).ok()
    }
}

/// Fails where a file that is to be written was read, or has no folder.
pub(super) fn require_writable<'a>(
    file: &Path,
    mut read: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    match read.any(|known| is_same_file(known, file)) {
        true => Err(Failure::Problem(format!("{} is read, and is not written over", file.display()))),
        false => folder(file).map(|_| ()),
    }
}

/// Folder of a file that is to be written, absolute.
pub(super) fn folder(file: &Path) -> Result<PathBuf, Failure> {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    folder.canonicalize().map_err(|error| {
        let help = "name a file in a folder that exists with --output";
        Failure::Problem(format!("{}: {error}\n  = help: {help}", folder.display()))
    })
}

/// A path for a header: relative to the workspace where it lies in models/, as given where that is relative,
/// and the bare name otherwise. Machines differ in everything else.
pub(super) fn shown(path: &Path, workspace: Option<&Workspace>) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if workspace.is_some_and(|workspace| workspace.contains(path)) {
        return format!("models/{name}");
    }
    if path.is_absolute() {
        return name;
    }
    let parts = path.components().filter(|part| *part != Component::CurDir);
    parts.map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
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
