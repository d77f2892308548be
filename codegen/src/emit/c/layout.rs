//! Statements and signatures in lines of limited length.

/// Longest line of code.
const WIDTH: usize = 118;

/// `head(arguments)tail`, with the arguments on further lines where one does not hold them.
pub(super) fn call(indent: usize, head: &str, arguments: &[String], tail: &str) -> String {
    let line = format!("{head}({}){tail}", arguments.join(", "));
    if indent + line.chars().count() <= WIDTH {
        return line;
    }
    let inner = " ".repeat(indent + 4);
    format!("{head}(\n{}){tail}", filled(&inner, arguments))
}

/// A list in braces.
pub(super) fn braces(indent: usize, entries: &[String]) -> String {
    let line = format!("{{{}}}", entries.join(", "));
    if indent + line.chars().count() <= WIDTH {
        return line;
    }
    format!("{{\n{}\n{}}}", filled(&" ".repeat(indent + 4), entries), " ".repeat(indent))
}

/// Entries on as many lines as they need.
fn filled(indent: &str, entries: &[String]) -> String {
    let mut lines = vec![indent.to_owned()];
    for (index, entry) in entries.iter().enumerate() {
        let comma = if index + 1 < entries.len() { "," } else { "" };
        let last = lines.last().map_or(0, |line| line.chars().count());
        if last > indent.len() && last + 1 + entry.chars().count() + 1 > WIDTH {
            lines.push(indent.to_owned());
        }
        if let Some(line) = lines.last_mut() {
            let space = if line.len() > indent.len() { " " } else { "" };
            line.push_str(&format!("{space}{entry}{comma}"));
        }
    }
    lines.join("\n")
}

/// A function, its statements indented.
pub(super) fn function(head: &str, statements: &[String]) -> String {
    let body: String = statements.iter().map(|statement| indented(statement)).collect();
    format!("{head}\n{{\n{body}}}\n")
}

/// A statement one level deeper.
pub(super) fn indented(statement: &str) -> String {
    let lines = statement.lines().map(|line| format!("    {line}\n"));
    lines.collect()
}
