//! Prints comments of C. Texts of a description cannot end such a comment.

use crate::emit::documentation::Block;
use crate::emit::text::{visible, wrap};

/// Prints the documentation of an item as lines that begin with `///`.
pub(super) fn documentation(blocks: &[Block]) -> String {
    let mut lines: Vec<String> = vec![];
    let gap = |lines: &mut Vec<String>| {
        if lines.last().is_some_and(|line| !line.is_empty()) {
            lines.push(String::new());
        }
    };
    for block in blocks {
        match block {
            Block::Paragraph(text) => {
                gap(&mut lines);
                lines.extend(wrap(&one_line(text), ""));
            }
            Block::Item(text) => lines.extend(wrap(&format!("- {}", one_line(text)), "  ")),
            Block::Gap => gap(&mut lines),
        }
    }
    lines.iter().map(|line| comment("///", line)).collect()
}

/// Prints one paragraph of documentation.
pub(super) fn paragraph(text: &str) -> String {
    documentation(&[Block::Paragraph(text.to_owned())])
}

/// Ends a line of a comment so that the next line does not continue it and no trigraph changes it.
pub(super) fn ended(line: &str) -> String {
    let line = line.replace("??", "? ?");
    // A backslash at the end of a line would continue the comment on the next line.
    let end = if line.ends_with('\\') { "." } else { "" };
    format!("{line}{end}\n")
}

fn comment(slashes: &str, line: &str) -> String {
    ended(format!("{slashes} {line}").trim_end())
}

fn one_line(text: &str) -> String {
    visible(&text.replace('\n', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_ends_with_its_line() {
        assert_eq!(paragraph("one\ntwo"), "/// one two\n");
        assert_eq!(paragraph("up to here \\"), "/// up to here \\.\n");
        assert_eq!(paragraph("what??/"), "/// what? ?/\n");
        assert_eq!(paragraph("a\u{202e}b"), "/// a\\u{202e}b\n");
    }
}
