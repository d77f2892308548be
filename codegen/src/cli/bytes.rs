//! Size of the machine code of generated functions. The module is compiled with rustc for this.

use std::collections::BTreeMap;
use std::process::Command;

use object::{Object, ObjectSymbol};

use super::failure::Failure;
use crate::emit::SourceFile;
use crate::functions::function::Function;
use crate::program::arrays::{ArrayForm, Arrays, Step};

/// Sizes of the machine code of a module's functions, for the default target of rustc.
#[derive(Debug)]
pub(super) struct CodeSizes {
    /// Number of bytes of each symbol of the object file.
    symbols: BTreeMap<String, u64>,
}

impl CodeSizes {
    /// Compiles a module at opt-level 3. The compiler is the value of the environment variable `RUSTC`, or
    /// `rustc` if there is no such variable.
    pub(super) fn measure(source: &SourceFile) -> Result<Self, Failure> {
        let folder = tempfile::tempdir()?;
        let (text, object) = (folder.path().join("robot.rs"), folder.path().join("robot.o"));
        std::fs::write(&text, &source.text)?;
        let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let mut command = Command::new(&rustc);
        command
            .args(["--edition", "2024", "--crate-type", "lib", "--crate-name", "robot"])
            .args(["-Copt-level=3", "-Ccodegen-units=1", "--emit", "obj", "-o"])
            .arg(&object)
            .arg(&text);
        if source.text.contains("target_feature = \"fma\"") && cfg!(target_arch = "x86_64") {
            command.arg("-Ctarget-feature=+fma");
        }
        let output = command.output().map_err(|error| {
            Failure::Problem(format!(
                "cannot run the compiler {}: {error}. Set the environment variable RUSTC to its path",
                rustc.to_string_lossy()
            ))
        })?;
        if !output.status.success() {
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(Failure::Problem(message));
        }
        let data = std::fs::read(&object)?;
        let file = object::File::parse(data.as_slice())?;
        let symbols = file.symbols().filter(|symbol| symbol.size() > 0);
        let symbols = symbols.filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.size())));
        Ok(Self { symbols: symbols.collect() })
    }

    /// Number of bytes of a function, including its parts and the loops that it calls, but not elementary
    /// functions. `None` if the compiler inlines the function.
    pub(super) fn of(&self, name: &str, function: Option<&Function>) -> Option<u64> {
        let shared: Vec<&str> = match function.and_then(|function| function.arrays.as_ref()) {
            Some(ArrayForm::Steps(form)) => shared_loops(form),
            Some(ArrayForm::Affine(_)) | None => vec![],
        };
        let parts = |symbol: &str| {
            let suffixes = ["_into", "_body", "_part_", "_setup"];
            symbol == name
                || shared.contains(&symbol)
                || suffixes
                    .iter()
                    .any(|suffix| symbol.strip_prefix(name).is_some_and(|rest| rest.starts_with(suffix)))
        };
        let sizes = self.symbols.iter().filter(|(symbol, _)| path(symbol).is_some_and(parts));
        let sizes: Vec<u64> = sizes.map(|(_, &size)| size).collect();
        (!sizes.is_empty()).then(|| sizes.iter().sum())
    }
}

/// Names of the functions that a function with loops over joints calls, and of their module.
fn shared_loops(form: &Arrays) -> Vec<&str> {
    let maps = form.steps.iter().filter_map(|step| match step {
        Step::Map(map) => Some(map.name.as_str()),
        _ => None,
    });
    maps.chain(["arrays", "sum_ancestors", "sum_subtrees", "collect", "project", "spread"]).collect()
}

/// Name of a function in the module, from a mangled symbol such as `…5robot11mass_matrix…`.
fn path(symbol: &str) -> Option<&str> {
    let rest = &symbol[symbol.find("5robot")? + 6..];
    let digits = rest.chars().take_while(char::is_ascii_digit).count();
    let length: usize = rest.get(..digits)?.parse().ok()?;
    rest.get(digits..digits + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_mangled_symbols() {
        assert_eq!(path("_ZN5robot11mass_matrix17h0d3bE"), Some("mass_matrix"));
        assert_eq!(path("_RNvCs1_5robot16mass_matrix_into"), Some("mass_matrix_into"));
        assert_eq!(path("memcpy"), None);
    }
}
