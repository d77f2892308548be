//! Documentation of generated items. The text is wrapped, and escaped so that no text of a description
//! becomes markup or code.

use proc_macro2::TokenStream;
use quote::quote;

use crate::emit::documentation::Block;
use crate::emit::text::{visible, wrap};

/// The lines of a Rust documentation comment.
#[derive(Debug, Default)]
pub(super) struct DocComment {
    lines: Vec<String>,
}

impl DocComment {
    /// A documentation comment with one paragraph of Markdown.
    pub(super) fn new(text: &str) -> Self {
        let mut doc = Self::default();
        doc.paragraph(text);
        doc
    }

    /// A documentation comment from the blocks that all languages have in common.
    pub(super) fn of(blocks: &[Block]) -> Self {
        let mut doc = Self::default();
        for block in blocks {
            match block {
                Block::Paragraph(text) => doc.paragraph(text),
                Block::Item(text) => doc.item(text),
                Block::Gap => doc.gap(),
            }
        }
        doc
    }

    /// A documentation comment with one paragraph that is already escaped.
    pub(super) fn escaped(text: &str) -> Self {
        Self { lines: wrap(text, "") }
    }

    /// Adds a paragraph of Markdown after an empty line.
    pub(super) fn paragraph(&mut self, text: &str) {
        if text.trim().is_empty() {
            return;
        }
        self.gap();
        self.lines.extend(wrap(&markdown(text), ""));
    }

    /// Adds the heading of a section, for example `Safety`.
    pub(super) fn heading(&mut self, title: &str) {
        self.gap();
        self.lines.push(format!("# {title}"));
    }

    /// Adds a list item of Markdown. The list needs a [`gap`](Self::gap) before its first item.
    pub(super) fn item(&mut self, text: &str) {
        self.lines.extend(wrap(&format!("- {}", markdown(text)), "  "));
    }

    /// Adds an empty line, except at the beginning and after an empty line.
    pub(super) fn gap(&mut self) {
        if self.lines.last().is_some_and(|line| !line.is_empty()) {
            self.lines.push(String::new());
        }
    }

    /// The documentation comment as `#[doc]` attributes of its item.
    pub(super) fn tokens(&self) -> TokenStream {
        let lines =
            self.lines.iter().map(|line| if line.is_empty() { String::new() } else { format!(" {line}") });
        quote!(#(#[doc = #lines])*)
    }
}

/// Escapes Markdown of the generator. Code in backticks is kept. In all other text, tags and emphasis are
/// escaped, and brackets around units become parentheses, because rustdoc would read brackets as links.
pub(super) fn markdown(text: &str) -> String {
    let text = visible(&text.replace('\n', " "));
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return plain(&text);
    }
    let escaped =
        parts.iter().enumerate().map(|(i, part)| if i % 2 == 0 { prose(part) } else { (*part).to_owned() });
    guard_start(escaped.collect::<Vec<_>>().join("`"))
}

/// Escapes a text of a description so that it contains no markup.
pub(super) fn plain(text: &str) -> String {
    guard_start(escape(&visible(&text.replace('\n', " "))))
}

/// Escapes the beginning of a text that Markdown would read as a list or heading: `-`, `+`, `=` or a number.
fn guard_start(text: String) -> String {
    let text = text.trim_start();
    let digits = text.chars().take_while(char::is_ascii_digit).count();
    if text.starts_with(['-', '+', '=']) || (digits > 0 && text[digits..].starts_with(['.', ')'])) {
        return format!("{}\\{}", &text[..digits], &text[digits..]);
    }
    text.to_owned()
}

fn prose(text: &str) -> String {
    escape(&text.replace('[', "(").replace(']', ")"))
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.replace("://", ":\\//").chars() {
        if matches!(letter, '[' | ']' | '<' | '>' | '*' | '_' | '`' | '#' | '|' | '~' | '&') {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_text_loses_its_meaning() {
        assert_eq!(
            plain("a [link] <b> *x* `c`\r\u{202e}"),
            "a \\[link\\] \\<b\\> \\*x\\* \\`c\\`\\u{d}\\u{202e}"
        );
        assert_eq!(plain("see https://example.org"), "see https:\\//example.org");
        assert_eq!(markdown("forces [N] on `M[0][1]`"), "forces (N) on `M[0][1]`");
        assert_eq!(markdown("one ` alone"), "one \\` alone");
        assert_eq!(plain("- no list"), "\\- no list");
        assert_eq!(plain("12. no list"), "12\\. no list");
    }

    #[test]
    fn combining_marks_stay() {
        assert_eq!(markdown("J̇ẏ"), "J̇ẏ");
    }
}
