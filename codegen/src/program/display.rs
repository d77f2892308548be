//! Prints programs with intermediate values as text and as LaTeX, for readers.
//!
//! Each value is an equation on its own line. Names of Greek letters become Greek letters, and digits at the
//! end of a name become subscripts. The inputs `y`, `v`, `a` are written y, ẏ, ÿ with indices from 1.

use super::flow::Flow;
use super::letters::greek_letter;
use super::{Operand, Operation, Output, Program, Shape};
use gelenk_formula::Function;

/// Names of the free parameters, which have only an index in a program.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Notation {
    /// Names of all free parameters of the program.
    pub parameters: Vec<String>,
}

/// Prints the program as aligned lines of text.
#[must_use]
pub fn text(program: &Program, notation: &Notation) -> String {
    let printer = Printer { program, notation, style: Style::Text };
    let equations = printer.equations();
    let width = equations.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let lines = equations.iter().map(|(name, value)| format!("  {name}{} = {value}\n", space(width, name)));
    let results = program.outputs.iter().map(|output| printer.text_result(output));
    lines.chain(results).collect()
}

/// Prints the program as an `align*` environment of LaTeX (amsmath).
#[must_use]
pub fn latex(program: &Program, notation: &Notation) -> String {
    let LatexEquations { abbreviations, results } = latex_equations(program, notation);
    let results = results.into_iter().map(|result| (result.name.clone(), result.value()));
    let lines: Vec<String> = abbreviations
        .into_iter()
        .chain(results)
        .map(|(name, value)| format!("  {name} &= {value}"))
        .collect();
    format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n", lines.join(" \\\\\n"))
}

/// A program as LaTeX equations, each with its left-hand side and right-hand side.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LatexEquations {
    /// Equations of the intermediate values, each with its left-hand side and right-hand side.
    pub abbreviations: Vec<(String, String)>,
    /// Results in terms of intermediate values.
    pub results: Vec<LatexResult>,
}

/// A result of a program in LaTeX.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LatexResult {
    /// Symbol of the result in LaTeX.
    pub name: String,
    /// Entries of the result in LaTeX, by row. A scalar has one entry.
    pub rows: Vec<Vec<String>>,
    is_scalar: bool,
}

impl LatexResult {
    /// The whole result in LaTeX: the entry of a scalar, or a LaTeX vector or matrix of all entries.
    #[must_use]
    pub fn value(&self) -> String {
        if self.is_scalar {
            return self.rows.concat().concat();
        }
        let rows: Vec<String> = self.rows.iter().map(|row| row.join(" & ")).collect();
        format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}", rows.join(" \\\\ "))
    }
}

/// Prints the program as separate LaTeX equations, for HTML pages.
#[must_use]
pub fn latex_equations(program: &Program, notation: &Notation) -> LatexEquations {
    let printer = Printer { program, notation, style: Style::Latex };
    let outputs = program.outputs.iter();
    LatexEquations {
        abbreviations: printer.equations(),
        results: outputs.map(|output| printer.latex_result(output)).collect(),
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Style {
    Text,
    Latex,
}

struct Printer<'a> {
    program: &'a Program,
    notation: &'a Notation,
    style: Style,
}

impl Printer<'_> {
    /// Name and right-hand side of each intermediate value. A sine is left out if it is computed only
    /// together with its cosine.
    fn equations(&self) -> Vec<(String, String)> {
        let is_read = Flow::new(self.program).is_read;
        let read = self.program.instructions.iter().zip(is_read).filter(|(_, is_read)| *is_read);
        read.map(|(i, _)| (self.letters(&i.name), self.expression(i.operation))).collect()
    }

    fn expression(&self, operation: Operation) -> String {
        let latex = self.style == Style::Latex;
        let (first, other) = (|a| self.operand(a, false), |b| self.operand(b, true));
        match operation {
            Operation::Add(a, b) => format!("{} + {}", first(a), other(b)),
            Operation::Subtract(a, b) => format!("{} {} {}", first(a), self.minus(), other(b)),
            Operation::Multiply(a, b) if a == b && latex => format!("{}^{{2}}", first(a)),
            // A constant factor is printed first, as readers expect. The product is the same.
            Operation::Multiply(a, b @ Operand::Constant(_)) if !is_constant(a) => {
                self.product(first(b), &other(a))
            }
            Operation::Multiply(a, b) => self.product(first(a), &other(b)),
            Operation::Divide(a, b) if latex => format!("\\frac{{{}}}{{{}}}", first(a), first(b)),
            Operation::Divide(a, b) => format!("{} / {}", first(a), other(b)),
            Operation::Negate(a) => format!("{}{}", self.minus(), other(a)),
            Operation::MultiplyAdd(a, b, c) if latex => {
                format!("\\mathrm{{fma}}\\left({}, {}, {}\\right)", first(a), first(b), first(c))
            }
            Operation::MultiplyAdd(a, b, c) => {
                format!("fma({}, {}, {})", first(a), first(b), first(c))
            }
            Operation::SinCos(a) => self.call(Function::Sin, a),
            Operation::CosineOf(pair) => match self.program.instructions[pair].operation {
                Operation::SinCos(a) => self.call(Function::Cos, a),
                _ => unreachable!("a cosine names the instruction that makes its sine"),
            },
            Operation::Call(function, a) => self.call(function, a),
        }
    }

    fn product(&self, a: String, b: &str) -> String {
        match self.style {
            Style::Text => format!("{a} · {b}"),
            Style::Latex => format!("{a} \\, {b}"),
        }
    }

    fn minus(&self) -> &'static str {
        match self.style {
            Style::Text => "−",
            Style::Latex => "-",
        }
    }

    fn call(&self, function: Function, argument: Operand) -> String {
        let argument = self.operand(argument, false);
        let name = match function {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tanh => "tanh",
            Function::Exp => "exp",
            Function::Sign => "sign",
            Function::Abs => "abs",
            Function::Sqrt => "sqrt",
        };
        match (self.style, function) {
            (_, Function::Abs) => format!("|{argument}|"),
            (Style::Text, _) => format!("{name}({argument})"),
            (Style::Latex, Function::Sign) => {
                format!("\\operatorname{{sign}}\\left({argument}\\right)")
            }
            (Style::Latex, Function::Sqrt) => format!("\\sqrt{{{argument}}}"),
            (Style::Latex, _) => format!("\\{name}\\left({argument}\\right)"),
        }
    }

    /// Text of an operand in an equation. If `guarded` is true, a negative number is put in parentheses.
    fn operand(&self, operand: Operand, guarded: bool) -> String {
        match operand {
            Operand::Value(index) => self.letters(&self.program.instructions[index].name),
            Operand::Input(array, index) => self.indexed(&self.program.inputs[array].name, index + 1),
            Operand::Parameter(index) => self.letters(&self.notation.parameters[index]),
            Operand::Constant(number) if guarded && number.is_sign_negative() => {
                format!("({})", self.number(number))
            }
            Operand::Constant(number) => self.number(number),
        }
    }

    fn number(&self, number: f64) -> String {
        match self.style {
            Style::Text => text_number(number),
            Style::Latex => latex_number(number),
        }
    }

    /// Text for an entry of an input array, with an index that counts from 1.
    fn indexed(&self, array: &str, index: usize) -> String {
        let (text, latex) = match array {
            "v" => ("ẏ", "\\dot{y}"),
            "a" => ("ÿ", "\\ddot{y}"),
            other => return self.letters(&format!("{other}_{index}")),
        };
        match self.style {
            Style::Text => format!("{text}{}", subscript(&index.to_string()).unwrap_or_default()),
            Style::Latex => format!("{latex}_{{{index}}}"),
        }
    }

    /// Converts a name to a letter with subscripts: `beta_2` becomes β₂, `s12` becomes s₁₂.
    fn letters(&self, name: &str) -> String {
        match self.style {
            Style::Text => text_letters(name),
            Style::Latex => latex_letters(name),
        }
    }

    fn rows(&self, output: &Output) -> Vec<Vec<String>> {
        let entries: Vec<String> = output.entries.iter().map(|&entry| self.operand(entry, false)).collect();
        let columns = match output.shape {
            Shape::Matrix(_, columns) => columns.len.max(1),
            Shape::Scalar | Shape::Vector(_) => 1,
        };
        entries.chunks(columns).map(<[String]>::to_vec).collect()
    }

    fn text_result(&self, output: &Output) -> String {
        let rows = self.rows(output);
        let name = self.letters(&output.name);
        if output.shape == Shape::Scalar {
            return format!("\n  {name} = {}\n", rows.concat().concat());
        }
        let width = |column: usize| {
            rows.iter().filter_map(|row| Some(row.get(column)?.chars().count())).max().unwrap_or(0)
        };
        let lines = rows.iter().enumerate().map(|(i, row)| {
            let cells =
                row.iter().enumerate().map(|(column, cell)| format!("{}{cell}", space(width(column), cell)));
            let head = if i == 0 { format!("{name} = ") } else { " ".repeat(name.chars().count() + 3) };
            format!("  {head}[ {} ]\n", cells.collect::<Vec<_>>().join("  "))
        });
        format!("\n{}", lines.collect::<String>())
    }

    fn latex_result(&self, output: &Output) -> LatexResult {
        let is_scalar = output.shape == Shape::Scalar;
        LatexResult { name: self.letters(&output.name), rows: self.rows(output), is_scalar }
    }
}

fn text_letters(name: &str) -> String {
    let (stem, index) = stem_and_index(name);
    match subscript(index) {
        Some(index) if !stem.is_empty() => format!("{}{index}", greek(stem)),
        _ => name.to_owned(),
    }
}

/// Converts a name to LaTeX letters.
pub(crate) fn latex_letters(name: &str) -> String {
    match stem_and_index(name) {
        ("", _) => name.to_owned(),
        (stem, index) => latex_subscript(&latex_letter(stem), &index.replace('_', ",")),
    }
}

fn stem_and_index(name: &str) -> (&str, &str) {
    let stem_end = name.find(|c: char| c == '_' || c.is_ascii_digit()).unwrap_or(name.len());
    let (stem, index) = name.split_at(stem_end);
    (stem, index.trim_matches('_'))
}

fn text_number(number: f64) -> String {
    match digits_and_exponent(number) {
        (digits, None) => digits.replace('-', "−"),
        (digits, Some(exponent)) => {
            let digits = digits.replace('-', "−");
            format!("{digits}·10{}", superscript(&exponent))
        }
    }
}

/// Prints a number in LaTeX with 12 digits, for example 0.214 for 0.21400000000000002.
pub(crate) fn latex_number(number: f64) -> String {
    match digits_and_exponent(format!("{number:.11e}").parse().unwrap_or(number)) {
        (digits, None) => digits,
        (digits, Some(exponent)) => format!("{digits} \\cdot 10^{{{exponent}}}"),
    }
}

/// The shortest digits that distinguish the number from neighbouring numbers, and its exponent; `None`
/// without an exponent.
fn digits_and_exponent(number: f64) -> (String, Option<String>) {
    let shortest = format!("{number:?}");
    let shortest = shortest.strip_suffix(".0").unwrap_or(&shortest);
    match shortest.split_once('e') {
        Some((digits, exponent)) => (digits.to_owned(), Some(exponent.to_owned())),
        None => (shortest.to_owned(), None),
    }
}

fn is_constant(operand: Operand) -> bool {
    matches!(operand, Operand::Constant(_))
}

fn space(width: usize, text: &str) -> String {
    " ".repeat(width.saturating_sub(text.chars().count()))
}

/// The Greek letter with this name. Other words are returned unchanged.
fn greek(stem: &str) -> String {
    greek_letter(stem).map_or_else(|| stem.to_owned(), String::from)
}

fn latex_letter(stem: &str) -> String {
    match greek_letter(stem) {
        // LaTeX has no command for omicron, which looks like an o.
        Some('ο') => "o".to_owned(),
        Some(_) => format!("\\{stem}"),
        None if stem.chars().count() == 1 => stem.to_owned(),
        None => format!("\\mathrm{{{stem}}}"),
    }
}

fn latex_subscript(stem: &str, index: &str) -> String {
    if index.is_empty() {
        return stem.to_owned();
    }
    let parts: Vec<String> = index.split(',').map(latex_index).collect();
    format!("{stem}_{{{}}}", parts.join(","))
}

/// A part of an index in LaTeX: words become upright, and letters and numbers are unchanged.
fn latex_index(part: &str) -> String {
    match greek_letter(part) {
        Some(_) => latex_letter(part),
        None if part.chars().filter(|c| c.is_alphabetic()).count() > 1 => {
            format!("\\mathrm{{{part}}}")
        }
        None => part.to_owned(),
    }
}

/// Converts digits to subscripts and `_` to a comma; `None` if a letter has no subscript.
fn subscript(index: &str) -> Option<String> {
    let letter = |c: char| match c {
        '0'..='9' => char::from_u32(u32::from('₀') + (u32::from(c) - u32::from('0'))),
        '_' => Some(','),
        _ => None,
    };
    index.chars().map(letter).collect()
}

fn superscript(exponent: &str) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let letter =
        |c: char| c.to_digit(10).and_then(|digit| DIGITS.get(digit as usize).copied()).unwrap_or('⁻');
    exponent.chars().map(letter).collect()
}
