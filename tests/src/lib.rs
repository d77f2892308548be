//! Shared parts of the tests that cross crates: reference data, random robots, an independent derivation of
//! their equations, and evaluation of derived functions.

#![allow(clippy::expect_used, reason = "what is missing ends a test")]

pub mod agreement;
pub mod browser;
pub mod cargo;
pub mod compiler;
pub mod dual;
pub mod enumerated;
pub mod flat;
pub mod generated;
pub mod literature;
pub mod mujoco;
pub mod oracle;
pub mod packages;
pub mod positions;
pub mod python;
pub mod quaternion_model;
pub mod random_model;
pub mod single;
pub mod table;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use gelenk_codegen::emit::{EmitOptions, Scalar};
use gelenk_codegen::function_names::ALL;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::functions::selection;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::Model;
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};
use gelenk_codegen::program::interpret::interpret;

/// The root of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_owned).unwrap_or_default()
}

/// A file of values that nobody here computed.
///
/// # Panics
/// If there is no such file.
pub fn reference(path: &str) -> serde_json::Value {
    let path = workspace().join("tests/reference").join(path);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The URDF of a robot of others. Tests that call it are ignored without `cfg(robots_of_others)`.
pub fn robot_of_others(name: &str) -> PathBuf {
    workspace().join(format!("tests/reference/robots/{name}.urdf"))
}

/// A folder of published data: below `GELENK_SHARED`, or below `shared` next to the workspace; `None`, with a printed
/// note, if it is missing.
pub fn published(path: &str) -> Option<PathBuf> {
    let beside = || workspace().parent().map(|parent| parent.join("shared"));
    let folder = std::env::var_os("GELENK_SHARED").map(PathBuf::from).or_else(beside)?.join(path);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: {} is not there; set GELENK_SHARED", folder.display());
    None
}

/// Descriptions of all robots, by name.
pub fn descriptions() -> Vec<PathBuf> {
    let folder = workspace().join("models");
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("models/: {error}"));
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let is_description = |path: &PathBuf| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        matches!(extension, Some("toml" | "urdf"))
    };
    let mut paths: Vec<PathBuf> = paths.filter(is_description).collect();
    paths.sort();
    paths
}

/// A robot of models/ with the functions of its description and its module, as `gelenk generate` without arguments makes it.
pub fn generate_model(description: &Path) -> Generated {
    generate_functions(description, Vec::new(), Scalar::F64)
}

/// A robot of models/ with all its functions and its module.
pub fn generate_whole_model(description: &Path, scalar: Scalar) -> Generated {
    generate_functions(description, all_functions(description), scalar)
}

/// The choice of all functions, except of the Go2, whose module would have 134 000 lines.
pub fn all_functions(description: &Path) -> Vec<String> {
    let is_too_large = description.file_stem().is_some_and(|name| name == "go2");
    if is_too_large { Vec::new() } else { vec![ALL.to_owned()] }
}

fn generate_functions(description: &Path, functions: Vec<String>, scalar: Scalar) -> Generated {
    let file = description.file_name().unwrap_or_default();
    let options = GenerateOptions {
        functions,
        emit: EmitOptions {
            scalar,
            command: format!("gelenk generate models/{}", file.to_string_lossy()),
            ..EmitOptions::default()
        },
        ..GenerateOptions::default()
    };
    generate(description, &options).unwrap_or_else(|problems| panic!("{problems}"))
}

/// A robot with its functions, evaluated by the interpreter.
pub struct Robot {
    /// The model.
    pub model: Model,
    functions: Vec<Function>,
}

impl Robot {
    /// Derives the functions that the options choose, or else the description.
    pub fn derive(description: &Path, options: &GenerateOptions) -> Self {
        let robot = generate(description, options);
        let robot = robot.unwrap_or_else(|problems| panic!("{problems}"));
        Self { model: robot.model, functions: robot.module.functions }
    }

    /// Derives all functions of a description.
    pub fn whole(description: &Path) -> Self {
        let functions = all_functions(description);
        Self::derive(description, &GenerateOptions { functions, ..GenerateOptions::default() })
    }

    /// Derives selected functions of a model.
    pub fn of_model(model: Model, selection: &[&str]) -> Self {
        let selection: Vec<String> = selection.iter().map(|name| (*name).to_owned()).collect();
        let functions = selection::derive_functions(&model, &selection, MOST_OPERATIONS)
            .unwrap_or_else(|problems| panic!("{problems}"));
        Self { model, functions }
    }

    /// Derives selected functions of a model in a form.
    pub fn in_form(model: Model, selection: &[&str], form: Form) -> Self {
        let selection: Vec<String> = selection.iter().map(|name| (*name).to_owned()).collect();
        let functions = selection::derive_in_form(&model, &selection, MOST_OPERATIONS, form, &[])
            .unwrap_or_else(|problems| panic!("{problems}"));
        Self { model, functions }
    }

    /// Its functions.
    pub fn functions(&self) -> &[Function] {
        &self.functions
    }

    /// A function by name.
    pub fn function(&self, name: &str) -> &Function {
        let found = self.functions.iter().find(|function| function.name == name);
        found.unwrap_or_else(|| panic!("no function {name}"))
    }

    /// The results of a function, each flattened rows first.
    pub fn call(&self, name: &str, inputs: &[&[f64]]) -> Vec<Vec<f64>> {
        let parameters: Vec<f64> = self.model.parameters.iter().map(|parameter| parameter.default).collect();
        self.call_with(name, inputs, &parameters)
    }

    /// As [`Self::call`], with values of the free parameters.
    pub fn call_with(&self, name: &str, inputs: &[&[f64]], parameters: &[f64]) -> Vec<Vec<f64>> {
        let program = &self.function(name).program;
        interpret(program, inputs, parameters).unwrap_or_else(|problem| panic!("{name}: {problem}"))
    }

    /// Arguments of a function of friction: the velocities, preceded by the coordinates if a friction law
    /// depends on the position.
    pub fn friction_arguments<'a>(&self, name: &str, y: &'a [f64], v: &'a [f64]) -> Vec<&'a [f64]> {
        let arguments = self.function(name).program.inputs.iter();
        arguments
            .map(|input| match input.name.as_str() {
                "y" => y,
                "v" => v,
                other => panic!("{name} takes {other}"),
            })
            .collect()
    }

    /// The first result of a function.
    pub fn first(&self, name: &str, inputs: &[&[f64]]) -> Vec<f64> {
        self.call(name, inputs).swap_remove(0)
    }
}

/// The results of a function of each item, by as many threads as there are processors.
pub fn in_parallel<T: Sync, R: Send + Sync>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let results: Vec<OnceLock<R>> = items.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let run = || {
        while let Some((item, result)) = {
            let index = next.fetch_add(1, Ordering::Relaxed);
            items.get(index).zip(results.get(index))
        } {
            result.get_or_init(|| work(item));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..threads).for_each(|_| _ = scope.spawn(run)));
    results.into_iter().map(|result| result.into_inner().expect("each item was worked on")).collect()
}

/// Largest difference between two arrays, relative to the largest entry of the second.
pub fn relative_error(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len(), "arrays differ in length");
    let scale = expected.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let difference = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    // `max` would drop a NaN.
    let worst =
        difference.fold(0.0, |largest: f64, x| if largest.is_nan() || x <= largest { largest } else { x });
    if scale == 0.0 { worst } else { worst / scale }
}
