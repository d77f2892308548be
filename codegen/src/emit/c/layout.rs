//! Breaks statements and signatures into lines of limited length.

/// Largest number of characters of a line of code.
const WIDTH: usize = 118;

/// Indentation of continuation lines relative to the first line.
const FURTHER: &str = "    ";

/// The text `head(arguments)tail`. The arguments are on separate lines if the text is too long for one line.
///
/// - `indent`: number of characters by which the statement is indented
pub(super) fn call(indent: usize, head: &str, arguments: &[String], tail: &str) -> String {
    let line = format!("{head}({}){tail}", arguments.join(", "));
    if indent + line.chars().count() <= WIDTH {
        return line;
    }
    format!("{head}(\n{}){tail}", filled(indent, arguments))
}

/// A list of entries in braces. The entries are on separate lines if the list is too long for one line.
///
/// - `indent`: number of characters by which the statement is indented
pub(super) fn braces(indent: usize, entries: &[String]) -> String {
    let line = format!("{{{}}}", entries.join(", "));
    if indent + line.chars().count() <= WIDTH {
        return line;
    }
    format!("{{\n{}\n}}", filled(indent, entries))
}

/// Distributes the entries of a list over lines of limited length.
fn filled(indent: usize, entries: &[String]) -> String {
    let mut lines = vec![FURTHER.to_owned()];
    for (index, entry) in entries.iter().enumerate() {
        let comma = if index + 1 < entries.len() { "," } else { "" };
        let last = lines.last().map_or(0, |line| indent + line.chars().count());
        if last > indent + FURTHER.len() && last + 1 + entry.chars().count() + 1 > WIDTH {
            lines.push(FURTHER.to_owned());
        }
        if let Some(line) = lines.last_mut() {
            let space = if line.len() > FURTHER.len() { " " } else { "" };
            line.push_str(&format!("{space}{entry}{comma}"));
        }
    }
    lines.join("\n")
}

/// The text of a C function with its statements indented.
pub(super) fn function(head: &str, statements: &[String]) -> String {
    let body: String = statements.iter().map(|statement| indented(statement)).collect();
    format!("{head}\n{{\n{body}}}\n")
}

/// The statement, indented by one level.
pub(super) fn indented(statement: &str) -> String {
    let lines = statement.lines().map(|line| format!("    {line}\n"));
    lines.collect()
}
