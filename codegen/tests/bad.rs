//! Every file of tests/bad is refused with all of its problems; the messages are snapshots in
//! tests/snapshots.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gelenk_codegen::diagnostic::Severity;
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use std::path::Path;

#[test]
fn bad_descriptions_are_explained() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    let entries = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.collect();
    files.sort();
    assert!(files.len() >= 30);
    for file in files {
        let name = file.file_name().unwrap().to_str().unwrap();
        let Err(diagnostics) = generate(&file, &GenerateOptions::default()) else {
            panic!("{name} was accepted")
        };
        assert!(diagnostics.has_errors(), "{name}");
        let errors = diagnostics.entries().iter().filter(|entry| entry.severity == Severity::Error);
        for error in errors {
            assert!(error.remedy.is_some(), "{name}: nothing says what to do about: {error}");
        }
        // Paths are shown as given; here they begin with this machine's checkout.
        let text = diagnostics.to_string().replace(&format!("{}/", folder.display()), "");
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.set_snapshot_path("snapshots/bad");
        settings.bind(|| insta::assert_snapshot!(name, text));
    }
}
