//! Pythons of the tests' own: environments in the target folder, each made once for its list of packages.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::cargo::target;
use crate::workspace;

/// The interpreter of an environment with the packages of `tests/python/requirements.txt`; none, with a note, where there
/// is no Python, or where its packages cannot be had.
pub fn python() -> Option<PathBuf> {
    environment(&["requirements.txt"], "python")
}

/// As [`python()`], with acados and its template. The wheel that has them brings parts of CasADi for another version of
/// Python, over which the whole is installed.
pub fn python_with_acados() -> Option<PathBuf> {
    environment(&["acados.txt", "requirements.txt"], "python-acados")
}

/// As [`python()`], with MuJoCo. `GELENK_MUJOCO_PYTHON` names another one, which may have more packages.
pub fn python_with_mujoco() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("GELENK_MUJOCO_PYTHON") {
        return Some(named.into());
    }
    environment(&["mujoco.txt"], "python-mujoco")
}

/// - `lists`: files of `tests/python/` with packages, installed in this order
/// - `folder`: where they go in the target folder
fn environment(lists: &[&str], folder: &str) -> Option<PathBuf> {
    let lists: Vec<PathBuf> = lists.iter().map(|list| workspace().join("tests/python").join(list)).collect();
    let wanted = lists.iter().map(|list| fs::read_to_string(list).expect("the list of packages"));
    let wanted: String = wanted.collect();
    let folder = target().join(folder);
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    // Another test may be at it.
    let lock = fs::File::create(folder.with_extension("lock")).expect("a file");
    lock.lock().expect("the lock");
    let installed = folder.join("installed.txt");
    if fs::read_to_string(&installed).is_ok_and(|found| found == wanted) {
        return Some(python);
    }
    let named = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let path = |path: &Path| path.display().to_string();
    let pip =
        ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:", "-r"];
    let install = |list: &PathBuf| {
        let words = pip.iter().map(|&word| word.to_owned()).chain([path(list)]);
        (path(&python), words.collect::<Vec<_>>())
    };
    let make = (named, vec!["-m".to_owned(), "venv".to_owned(), "--clear".to_owned(), path(&folder)]);
    for (program, arguments) in std::iter::once(make).chain(lists.iter().map(install)) {
        let done = Command::new(&program).args(&arguments).output();
        if let Some(reason) = refusal(done) {
            println!("skipped: `{program} {}`: {reason}", arguments.join(" "));
            return None;
        }
    }
    fs::write(&installed, wanted).expect("the list of what is installed");
    Some(python)
}

fn refusal(done: std::io::Result<Output>) -> Option<String> {
    match done {
        Err(error) => Some(error.to_string()),
        Ok(output) if output.status.success() => None,
        Ok(output) => Some(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
    }
}

/// The program `gelenk`, which Cargo builds next to the tests of this package.
///
/// # Panics
/// If it is not next to them.
pub fn program() -> PathBuf {
    let test = std::env::current_exe().expect("this program");
    let folder = test.ancestors().nth(2).expect("target/debug/deps");
    let program = folder.join(format!("gelenk_of_tests{}", std::env::consts::EXE_SUFFIX));
    assert!(program.exists(), "no {}: run a test of this package by `cargo test`", program.display());
    program
}

/// The files of the Python package's tests, by their names without `test_` and `.py`.
///
/// # Panics
/// Where they cannot be listed.
pub fn test_files() -> BTreeMap<String, PathBuf> {
    let entries = fs::read_dir(workspace().join("codegen/python/tests")).expect("the tests");
    let named = entries.filter_map(|entry| {
        let path = entry.expect("an entry").path();
        let name = path.file_name()?.to_str()?.strip_prefix("test_")?.strip_suffix(".py")?.to_owned();
        Some((name, path))
    });
    named.collect()
}

/// Runs files of the Python package's tests in a folder of their own, with further environment variables.
///
/// # Panics
/// Where one of them fails.
pub fn pytest(python: &Path, files: &[PathBuf], folder: &Path, variables: &[(&str, &Path)]) {
    let mut command = Command::new(python);
    command
        .args(["-m", "pytest", "-q", "-rs", "--durations=12", "-p", "no:cacheprovider"])
        .args(files)
        .env("PYTHONPATH", workspace().join("codegen/python/src"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("GELENK_PROGRAM", program())
        .env("GELENK_CACHE", folder)
        .envs(variables.iter().copied())
        .env_remove("CC")
        .current_dir(folder);
    let output = command.output().expect("Python starts");
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    println!("{text}");
    assert!(output.status.success(), "{text}");
}

/// Tells whether there is a C compiler by the name of `cc`; a note where there is none.
pub fn has_c_compiler() -> bool {
    let is_there = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    if !is_there {
        println!("skipped: no C compiler `cc`");
    }
    is_there
}
