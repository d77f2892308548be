//! Modules of fixed texts. They are private, so that names of helpers do not collide with those of a robot.
//! The pretty printer is not used, because it would drop their comments.

use crate::emit::options::Scalar;

/// A module with a line of documentation and an attribute.
pub(super) fn module(documentation: &str, attribute: &str, name: &str, texts: &[&str]) -> String {
    let texts: Vec<String> = texts.iter().map(|text| indented(text)).collect();
    format!("\n/// {documentation}\n{attribute}\nmod {name} {{\n{}}}\n", texts.join("\n"))
}

/// A module of loops written for `f64`.
pub(super) fn loops(scalar: Scalar, documentation: &str, name: &str, texts: &[&str]) -> String {
    let attribute =
        "#[allow(clippy::needless_range_loop, reason = \"index notation reads like the formulas\")]";
    loops_with(scalar, documentation, attribute, name, texts)
}

/// A module of loops of which only some are called.
pub(super) fn partly_called_loops(scalar: Scalar, documentation: &str, name: &str, texts: &[&str]) -> String {
    let attribute = "#[allow(\n    dead_code,\n    clippy::needless_range_loop,\n    reason = \"only some of it is called, and index notation reads like the formulas\"\n)]";
    loops_with(scalar, documentation, attribute, name, texts)
}

/// Module of loops with this attribute.
fn loops_with(scalar: Scalar, documentation: &str, attribute: &str, name: &str, texts: &[&str]) -> String {
    let module = module(documentation, attribute, name, texts);
    match scalar {
        Scalar::F64 => module,
        Scalar::F32 => module.replace("f64", "f32").replace("u64", "u32"),
    }
}

fn indented(text: &str) -> String {
    let lines = text.trim().lines().map(|line| match line {
        "" => "\n".to_owned(),
        line => format!("    {line}\n"),
    });
    lines.collect()
}
