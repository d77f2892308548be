//! Texts for human readers in generated files. They are printable, and their lines have a limited length.

/// Largest number of characters of a line of documentation.
const WIDTH: usize = 110;

/// Escapes control characters and invisible characters, because rustc rejects some of them, for example those
/// that reverse the text direction.
pub(super) fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        if is_invisible(letter) {
            shown.extend(letter.escape_unicode());
        } else {
            shown.push(letter);
        }
    }
    shown
}

fn is_invisible(letter: char) -> bool {
    letter.is_control()
        || matches!(letter,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// The text as code in backticks. A backtick inside becomes an apostrophe.
pub(super) fn code(text: &str) -> String {
    format!("`{}`", visible(&text.replace('\n', " ")).replace('`', "'"))
}

/// Wraps a text at spaces outside backticks. No line begins with a word that Markdown would read as the
/// beginning of a list, heading or quote.
///
/// - `indent`: text at the beginning of further lines
pub(super) fn wrap(text: &str, indent: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut in_code = false;
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        let line = lines.last_mut().map(|line| line.chars().count()).unwrap_or_default();
        let can_begin = word.starts_with(|first: char| first.is_alphabetic() || first == '`' || first == '(');
        if line > 0 && line + 1 + word.chars().count() > WIDTH && can_begin && !in_code {
            lines.push(indent.to_owned());
        } else if line > 0 {
            lines.last_mut().into_iter().for_each(|line| line.push(' '));
        }
        lines.last_mut().into_iter().for_each(|line| line.push_str(word));
        in_code ^= word.matches('`').count() % 2 == 1;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_where_no_list_can_begin() {
        let text = format!("{} - minus 1. one word", "x".repeat(WIDTH - 2));
        assert_eq!(wrap(&text, "").len(), 2);
        assert!(wrap(&text, "")[1].starts_with("minus"));
        let code = format!("{} `a b c`", "x".repeat(WIDTH - 2));
        assert_eq!(wrap(&code, "  ")[1], "  `a b c`");
    }
}
