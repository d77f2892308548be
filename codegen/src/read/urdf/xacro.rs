//! Detection of xacro macros in a URDF. The message names the command that expands them.

use std::path::Path;

use roxmltree::Node;

use crate::diagnostic::{Report, Span};
use crate::wording::quoted;

/// Tags of elements whose texts name files and plugins. An expression `$(find …)` in them does not affect the
/// dynamics.
const LOOKS: [&str; 5] = ["visual", "collision", "material", "gazebo", "transmission"];

/// First macro or macro expression that may affect the dynamics; `None` without one.
pub(super) fn first<'a, 'i>(robot: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    let mut stack = vec![robot];
    while let Some(node) = stack.pop() {
        if is_macro(node) || has_expression(node) {
            return Some(node);
        }
        if !LOOKS.contains(&node.tag_name().name()) {
            let children = node.children().filter(Node::is_element);
            let inner: Vec<_> = children.collect();
            stack.extend(inner.into_iter().rev());
        }
    }
    None
}

fn is_macro(node: Node<'_, '_>) -> bool {
    let namespace = node.tag_name().namespace().unwrap_or("");
    // Without a declaration the prefix is part of the name.
    namespace.contains("xacro") || node.tag_name().name().starts_with("xacro.")
}

fn has_expression(node: Node<'_, '_>) -> bool {
    let mut values = node.attributes().map(|attribute| attribute.value());
    values.any(|value| value.contains("${") || value.contains("$("))
}

/// Reports the command that expands the file.
pub(super) fn report(node: Node<'_, '_>, span: Span, file: &str, report: &mut Report) {
    let name = node.tag_name().name();
    let message = match is_macro(node) {
        true => format!("<xacro:{}> is a macro", name.trim_start_matches("xacro.")),
        false => format!("<{name}> contains a xacro expression"),
    };
    report.error(span, "xacro-not-expanded", format!("{message}: expand the file first"));
    let expanded = expanded(file);
    report.help(format!(
        "`xacro {} > {}` expands the file. Install it by the ROS package xacro, or by `pip install xacro`. Write arguments of the \
         file as `name:=value` after its name",
        quoted(file),
        quoted(&expanded)
    ));
}

/// Name of the expanded file: `arm.urdf` for `arm.urdf.xacro` and `arm.xacro`, `arm_expanded.urdf` for
/// `arm.urdf`.
fn expanded(file: &str) -> String {
    let path = Path::new(file);
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let stem = stem.unwrap_or("robot");
    let name = match path.extension().is_some_and(|end| end == "xacro") {
        true => format!("{}.urdf", stem.trim_end_matches(".urdf")),
        false => format!("{stem}_expanded.urdf"),
    };
    path.with_file_name(name).display().to_string()
}
