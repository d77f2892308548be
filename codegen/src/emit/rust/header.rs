//! Prints the comment at the top of a generated Rust module, and makes the module's documentation from this
//! comment.

use super::doc_comment::plain;
use crate::emit::header::{self, ROBOT};
use crate::module::Module;

/// The comment at the top of a generated module with `//`. Inner documentation (`//!`) is not possible,
/// because `include!` does not allow it.
pub(super) fn comment(module: &Module, command: &str) -> String {
    let lines = header::lines(module, command);
    lines.iter().map(|line| format!("{line}\n")).collect()
}

/// Makes the documentation of a module in Markdown from the comment at the top of the module's text. The file
/// that includes the module needs this documentation, because `include!` does not allow inner documentation.
#[must_use]
pub fn documentation(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix("//"));
    let mut lines = comment.map(str::trim).skip_while(|line| !line.starts_with(ROBOT));
    let name = lines.next().and_then(|line| line.strip_prefix(ROBOT));
    let mut documentation = format!("The robot `{}`.\n", name.unwrap_or_default().trim());
    for line in lines {
        documentation.push_str(&format!("{}\n", plain(line)));
    }
    documentation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{PUMA, chain};

    #[test]
    fn documentation_holds_the_description() {
        let mut model = chain(&PUMA, [0.0, 0.0, -9.81]);
        model.name = "puma".to_owned();
        model.description = vec!["An *arm*:".to_owned(), String::new(), "six axes.".to_owned()];
        let mut module = Module::new(&model, vec![], &[]);
        module.remarks.push("Smooth.".to_owned());
        let text = comment(&module, "gelenk generate") + "\n/// Number of coordinates.\n";
        let expected = "The robot `puma`.\n\nAn \\*arm\\*:\n\nsix axes.\n\nSmooth.\n";
        assert_eq!(documentation(&text), expected);
        assert_eq!(documentation("fn main() {}"), "The robot ``.\n");
    }
}
