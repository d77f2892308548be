//! Prints private modules with fixed texts. Names in a private module cannot collide with names of the robot.
//! The pretty printer is not used, because it would remove comments.

use crate::emit::options::Scalar;

/// Text of a module with one line of documentation and an attribute.
pub(super) fn module(documentation: &str, attribute: &str, name: &str, texts: &[&str]) -> String {
    let texts: Vec<String> = texts.iter().map(|text| indented(text)).collect();
    format!("\n/// {documentation}\n{attribute}\nmod {name} {{\n{}}}\n", texts.join("\n"))
}

/// Text of a module of loops, made from texts for `f64`. For `f32`, the types are replaced.
pub(super) fn loops(scalar: Scalar, documentation: &str, name: &str, texts: &[&str]) -> String {
    let attribute =
        "#[allow(clippy::needless_range_loop, reason = \"index notation reads like the formulas\")]";
    loops_with(scalar, documentation, attribute, name, texts)
}

/// Text of a module of loops like [`loops`], for loops of which the module calls only some.
pub(super) fn partly_called_loops(scalar: Scalar, documentation: &str, name: &str, texts: &[&str]) -> String {
    let attribute = "#[allow(\n    dead_code,\n    clippy::needless_range_loop,\n    reason = \"only some of it is called, and index notation reads like the formulas\"\n)]";
    loops_with(scalar, documentation, attribute, name, texts)
}

/// Text of a module of loops that has this attribute.
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
