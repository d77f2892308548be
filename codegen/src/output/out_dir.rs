//! Output of a build script in `$OUT_DIR` for `include_model!`: modules, their documentation, and a list of
//! their names.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::cargo;
use super::crate_root::{begins_with, left_over};
use super::modules::{self, BuildError, Robot};
use super::write::{Planned, Replaces, WriteError};
use crate::diagnostic::{Diagnostics, Severity};
use crate::emit::{FIRST_LINE, documentation};

/// File with the list of modules, which the macro `include_model!` reads.
const LIST: &str = "gelenk.modules.rs";

/// Names of the modules that this process has written, with the paths of their descriptions. A build script may
/// write modules in several calls.
static WRITTEN: Mutex<Vec<(String, PathBuf)>> = Mutex::new(Vec::new());

/// Output folder of a build script. Names of helper files begin with `gelenk.`; no module name contains a dot.
pub(super) struct OutDir {
    folder: PathBuf,
}

impl OutDir {
    pub(super) fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Writes modules and their helper files. Removes modules of earlier runs.
    pub(super) fn write(&self, robots: &[Robot], hides_notes: bool) -> Result<Vec<PathBuf>, BuildError> {
        let mut written = WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        for robot in robots {
            let name = &robot.generated.source.name;
            if written.iter().any(|(other, _)| other == name) {
                return Err(BuildError::SameName(name.clone()));
            }
            written.push((name.clone(), robot.description.clone()));
        }
        let paths = modules::write(&self.folder, robots)?;
        let names: Vec<String> = written.iter().map(|(name, _)| name.clone()).collect();
        self.remove_others(&names)?;
        self.put(LIST, &list(&written))?;
        for robot in robots {
            let source = &robot.generated.source;
            self.put(&format!("gelenk.{}.md", source.name), &documentation(&source.text))?;
            if !hides_notes {
                self.tell(&source.name, &robot.generated.notes)?;
            }
        }
        Ok(paths)
    }

    /// Removes modules of robots that were renamed or that have no description any more.
    fn remove_others(&self, names: &[String]) -> Result<(), BuildError> {
        let fault = |path: &Path| {
            let path = path.to_owned();
            move |source| BuildError::Write(WriteError::System { path, source })
        };
        for path in left_over(&self.folder, names).map_err(fault(&self.folder))? {
            let is_list = path.file_name().is_some_and(|name| name == LIST);
            if !is_list && begins_with(&path, &header()) {
                fs::remove_file(&path).map_err(fault(&path))?;
            }
        }
        Ok(())
    }

    fn put(&self, name: &str, text: &str) -> Result<(), BuildError> {
        let path = self.folder.join(name);
        let planned = Planned::new(&path, text, Replaces::Helper, &[]);
        planned.and_then(|file| file.write()).map_err(BuildError::Write)?;
        Ok(())
    }

    /// Prints notes that have not been printed before. Cargo would repeat them until the build script runs
    /// again. Therefore the printed notes are written to a file that Cargo watches: the script runs once more
    /// and prints nothing.
    fn tell(&self, name: &str, notes: &Diagnostics) -> Result<(), BuildError> {
        let file = format!("gelenk.{name}.notes");
        let path = self.folder.join(&file);
        let (mere, grave): (Vec<_>, Vec<_>) =
            notes.entries().iter().partition(|note| note.severity == Severity::Note);
        // Warnings and errors are printed in every run, so Cargo may repeat them.
        grave.into_iter().for_each(cargo::warn);
        if mere.is_empty() {
            // An error is ignored: at worst, the same notes are not printed again if they return later.
            let _ = fs::remove_file(&path);
            return Ok(());
        }
        let text: String = mere.iter().map(|note| format!("{note}\n")).collect();
        if !super::check(&path, &text) {
            mere.into_iter().for_each(cargo::warn);
        }
        self.put(&file, &text)?;
        cargo::watch(&path);
        Ok(())
    }
}

/// Text of a macro with an arm for each module, and an arm that lists the modules in an error.
fn list(modules: &[(String, PathBuf)]) -> String {
    let arm = |(name, _): &(String, PathBuf)| {
        let file = format!("/{name}.rs");
        format!("    ({name}) => {{ include!(concat!(env!(\"OUT_DIR\"), {file:?})); }};\n")
    };
    let arms: String = modules.iter().map(arm).collect();
    let named = modules.iter();
    let named = named.map(|(name, from)| format!("`{name}` from {}", from.display()));
    let known = format!(
        "`, but {}. A module has the name of its robot, which is `name` in a TOML file and <robot name=\"...\"> in a URDF. Write \
         this name in `include_model!(mod ...)`, or rename the robot",
        named.collect::<Vec<_>>().join(", ")
    );
    format!(
        "{}\n\n#[doc(hidden)]\n#[allow(unused_macro_rules)]\nmacro_rules! gelenk_module {{\n{arms}    ($other:ident) => \
         {{\n        compile_error!(concat!(\n            \"the build script generates no robot `\",\n            \
         stringify!($other),\n            {known:?}\n        ));\n    }};\n}}\n",
        header()
    )
}

/// First lines that mark a file of this build script. Files that begin with other lines are kept, for example
/// files that a build script generates by calling `gelenk`.
fn header() -> String {
    format!("{FIRST_LINE}\n//\n//     {}\n", cargo::command())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_names_what_there_is() {
        let text = list(&[
            ("arm".to_owned(), PathBuf::from("robot \"1\".toml")),
            ("arm_control".to_owned(), PathBuf::from("robot \"1\".toml")),
        ]);
        assert!(text.contains("(arm) => { include!(concat!(env!(\"OUT_DIR\"), \"/arm.rs\")); };"));
        assert!(text.contains(r#"`arm` from robot \"1\".toml, `arm_control` from robot"#), "{text}");
        assert!(syn::parse_file(&text).is_ok());
    }
}
