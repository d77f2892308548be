//! generated/ holds what the generator writes now.

use gelenk_codegen::emit::documentation;
use gelenk_codegen::output::{is_generated, root_text};
use gelenk_tests::{descriptions, generate_model, workspace};

/// Most lines of all modules: what a review of the generator's output can be asked to read.
const MOST_LINES: usize = 100_000;

/// Remedy if this fails.
const COMMAND: &str = "cargo run --release -- generate";

#[test]
fn committed_modules_are_fresh() {
    let folder = workspace().join("generated/src");
    let (mut names, mut modules, mut lines) = (Vec::new(), Vec::new(), 0);
    let mut stale = Vec::new();
    for description in descriptions() {
        let robot = generate_model(&description);
        let file = format!("{}.rs", robot.source.name);
        if std::fs::read_to_string(folder.join(&file)).ok().as_ref() != Some(&robot.source.text) {
            stale.push(file);
        }
        lines += robot.source.text.lines().count();
        modules.push((robot.source.name.clone(), documentation(&robot.source.text)));
        names.push(robot.source.name);
    }
    let root = std::fs::read_to_string(folder.join("lib.rs")).expect("generated/src/lib.rs");
    if root != root_text(&modules) {
        stale.push("lib.rs".to_owned());
    }
    let files = std::fs::read_dir(&folder).expect("generated/src");
    for path in files.map(|file| file.expect("a file").path()) {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let is_known = stem.is_some_and(|stem| stem == "lib" || names.contains(&stem));
        if !is_known && is_generated(&path) {
            stale.push(format!("{} (nothing describes it)", path.display()));
        }
    }
    assert!(lines <= MOST_LINES, "generated/src has {lines} lines: let descriptions choose functions");
    assert!(stale.is_empty(), "stale in generated/src: {stale:?}\nrun: {COMMAND}");
}
