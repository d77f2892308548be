//! Same description, same bytes: across runs, threads, the order of work, working directories and processes.

use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::emit::Scalar;
use gelenk_tests::{descriptions, generate_model, workspace};

/// Where a child process of this test writes its modules.
const OUTPUT: &str = "GELENK_TEST_OUTPUT";

/// Names and texts of all modules, in the given order.
fn modules(descriptions: &[PathBuf]) -> Vec<(String, String)> {
    descriptions
        .iter()
        .map(|path| {
            let source = generate_model(path, Scalar::F64).source;
            (source.name, source.text)
        })
        .collect()
}

fn sorted(mut modules: Vec<(String, String)>) -> Vec<(String, String)> {
    modules.sort();
    modules
}

#[test]
fn order_of_work_and_threads_change_nothing() {
    let paths = descriptions();
    let first = sorted(modules(&paths));
    assert!(first.len() >= 9, "{} robots", first.len());
    let backwards: Vec<PathBuf> = paths.iter().rev().cloned().collect();
    let threads = [paths.clone(), backwards, paths];
    let threads = threads.map(|paths| std::thread::spawn(move || sorted(modules(&paths))));
    for thread in threads {
        assert_same(&thread.join().expect("no panic"), &first);
    }
}

/// The difference of two large texts says little; their names do.
fn assert_same(found: &[(String, String)], expected: &[(String, String)]) {
    assert_eq!(found.len(), expected.len());
    for ((name, text), (expected_name, expected)) in found.iter().zip(expected) {
        assert_eq!(name, expected_name);
        assert!(text == expected, "{name} differs");
    }
}

/// No test by itself: what the children of the next one run.
#[test]
fn child() {
    let Some(folder) = std::env::var_os(OUTPUT) else {
        return;
    };
    for (name, text) in modules(&descriptions()) {
        std::fs::write(Path::new(&folder).join(name), text).expect("a file");
    }
}

/// Runs this program again in another working directory and environment.
fn in_a_process(current: &Path, home: &str) -> Vec<(String, String)> {
    let folder = tempfile::tempdir().expect("a folder");
    let program = std::env::current_exe().expect("this program");
    let output = Command::new(program)
        .args(["--exact", "child"])
        .env(OUTPUT, folder.path())
        .env("HOME", home)
        .env("LANG", "de_DE.UTF-8")
        .env("TZ", "Asia/Kolkata")
        .current_dir(current)
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let entries = std::fs::read_dir(folder.path()).expect("the folder");
    let read = |path: PathBuf| {
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        (name, std::fs::read_to_string(&path).expect("a text"))
    };
    sorted(
        entries
            .map(|entry| read(entry.expect("an entry").path()))
            .collect(),
    )
}

#[test]
fn processes_and_working_directories_change_nothing() {
    let here = sorted(modules(&descriptions()));
    let elsewhere = tempfile::tempdir().expect("a folder");
    assert_same(&in_a_process(elsewhere.path(), "/nowhere"), &here);
    assert_same(&in_a_process(&workspace().join("models"), "/"), &here);
}
