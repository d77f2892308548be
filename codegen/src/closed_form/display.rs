//! Prints closed forms as text and as LaTeX.
//!
//! Coordinates are printed as y, and velocities as ẏ. Their indices start at 1.

use std::collections::BTreeSet;

use super::symbols::Symbol;
use super::terms::{ClosedForms, Factor, Monomial, Number, Sum, Term, Wave};
use crate::program::letters::greek_letter;
use gelenk_formula::{Formula, Function};

/// Prints the equations of motion as lines of text: the entries of M, k, q and B, the definitions of lumped
/// constants, and the values of symbols. A lumped constant is a constant sum of products that gets its own
/// symbol.
///
/// - `parameters`: values of the free parameters, from which the printed values are computed
#[must_use]
pub fn text(forms: &ClosedForms, parameters: &[f64]) -> String {
    let printer = Printer { forms, style: Style::Text };
    let names = |letter: &str, names: &[String]| {
        let named = names.iter().enumerate();
        let named = named.map(|(k, name)| format!("{letter}{} {name}", subscript(&(k + 1).to_string())));
        named.collect::<Vec<_>>().join(", ")
    };
    let mut out = format!(
        "{}: M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u in closed form\n  coordinates {}\n",
        forms.robot,
        names("y", &forms.coordinates),
    );
    if !forms.inputs.is_empty() {
        out.push_str(&format!("  inputs {}\n", names("u", &forms.inputs)));
    }
    let line = |(name, value): (String, String)| format!("  {name} = {value}\n");
    out.push('\n');
    out.extend(printer.entries().into_iter().map(line));
    let constants = printer.constants(parameters);
    if !constants.is_empty() {
        out.push_str("\nwith\n");
        out.extend(constants.into_iter().map(|(name, sum, value)| format!("  {name} = {sum} = {value}\n")));
    }
    let symbols = printer.symbols(parameters);
    if !symbols.is_empty() {
        out.push_str("\nand\n");
        out.push_str(&aligned(&symbols));
    }
    out
}

/// Prints equations and lumped constants as an `align*` environment of the LaTeX package amsmath. The values
/// of the symbols follow as LaTeX comments.
///
/// - `parameters`: values of the free parameters, from which the printed values are computed
#[must_use]
pub fn latex(forms: &ClosedForms, parameters: &[f64]) -> String {
    let parts = latex_parts(forms, parameters);
    let equations = parts.equations.iter();
    let equations = equations.map(|(name, value)| format!("  {name} &= {value}"));
    let constants = parts.constants.iter();
    let constants = constants.map(|(name, sum, value)| format!("  {name} &= {sum} = {value}"));
    let lines: Vec<String> = equations.chain(constants).collect();
    let symbols = parts.symbols.iter();
    let symbols = symbols.map(|[name, value, meaning]| format!("% {name} = {value}: {meaning}\n"));
    format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n{}", lines.join(" \\\\\n"), symbols.collect::<String>())
}

/// Closed forms in LaTeX, with one string for each equation and each constant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LatexParts {
    /// Name and formula of each entry of the mass matrix M, the Coriolis forces k, the applied forces q and
    /// the input matrix B. M is symmetric, so only its upper triangle is included.
    pub equations: Vec<(String, String)>,
    /// Name, definition and value of each lumped constant (a constant sum of products with its own symbol).
    pub constants: Vec<(String, String, String)>,
    /// Name, value and meaning of each symbol in the equations.
    pub symbols: Vec<[String; 3]>,
}

/// Prints the equations in LaTeX as separate strings, for HTML pages.
///
/// - `parameters`: values of the free parameters, from which the printed values are computed
#[must_use]
pub fn latex_parts(forms: &ClosedForms, parameters: &[f64]) -> LatexParts {
    let printer = Printer { forms, style: Style::Latex };
    LatexParts {
        equations: printer.entries(),
        constants: printer.constants(parameters),
        symbols: printer.symbols(parameters),
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Style {
    Text,
    Latex,
}

struct Printer<'a> {
    forms: &'a ClosedForms,
    style: Style,
}

impl Printer<'_> {
    /// Name and formula of each entry of the mass matrix M, the Coriolis forces k, the applied forces q and
    /// the input matrix B. M is symmetric, so only its upper triangle is included.
    fn entries(&self) -> Vec<(String, String)> {
        let mut entries = Vec::new();
        for (i, row) in self.forms.mass_matrix.iter().enumerate() {
            for (j, sum) in row.iter().enumerate().skip(i) {
                entries.push((self.entry("M", &[i, j]), self.sum(sum)));
            }
        }
        let forces = [("k", &self.forms.coriolis_forces), ("q", &self.forms.applied_forces)];
        for (letter, forces) in forces {
            let named = forces.iter().enumerate();
            entries.extend(named.map(|(i, sum)| (self.entry(letter, &[i]), self.sum(sum))));
        }
        for (i, row) in self.forms.input_matrix.iter().enumerate() {
            for (j, sum) in row.iter().enumerate() {
                entries.push((self.entry("B", &[i, j]), self.sum(sum)));
            }
        }
        entries
    }

    /// Name, definition and value of each lumped constant (a constant sum of products with its own symbol).
    fn constants(&self, parameters: &[f64]) -> Vec<(String, String, String)> {
        let constants = self.forms.constants.iter().enumerate();
        let shown = constants.map(|(index, sum)| {
            let value = self.forms.constant_value(index, parameters);
            (self.factor(Factor::Constant(index)), self.polynomial(sum), self.number(rounded(value)))
        });
        shown.collect()
    }

    /// Name, value and meaning of each symbol in the equations.
    fn symbols(&self, parameters: &[f64]) -> Vec<[String; 3]> {
        let used = used(self.forms);
        let symbols = self.forms.symbols.iter().enumerate();
        let symbols = symbols.filter(|(index, _)| used.contains(index));
        let all = symbols.map(|(_, symbol)| symbol).chain(&self.forms.angles);
        let row = |symbol: &Symbol| {
            let value = self.number(rounded(symbol.value.evaluate(parameters, 0.0, 0.0)));
            let meaning = match symbol.meaning.as_str() {
                "" => self.formula(&symbol.value, 0),
                meaning => meaning.to_owned(),
            };
            [self.name(symbol), value, meaning]
        };
        all.map(row).collect()
    }

    fn entry(&self, letter: &str, indices: &[usize]) -> String {
        let index: String = indices.iter().map(|index| (index + 1).to_string()).collect();
        self.indexed(letter, &index)
    }

    fn sum(&self, sum: &Sum) -> String {
        self.joined(sum.iter().map(|term| self.term(term)))
    }

    fn polynomial(&self, sum: &[Monomial]) -> String {
        self.joined(sum.iter().map(|part| (part.number.value < 0.0, self.product(part, &[]))))
    }

    /// Joins summands to a sum. The flag of a summand is true if it is subtracted.
    fn joined(&self, summands: impl Iterator<Item = (bool, String)>) -> String {
        let mut out = String::new();
        for (is_negative, summand) in summands {
            match (out.is_empty(), is_negative) {
                (true, false) => {}
                (true, true) => out.push_str(self.minus()),
                (false, false) => out.push_str(" + "),
                (false, true) => out.push_str(&format!(" {} ", self.minus())),
            }
            out.push_str(&summand);
        }
        if out.is_empty() { "0".to_owned() } else { out }
    }

    /// Returns whether the term of a sum is subtracted, and the text of its magnitude.
    fn term(&self, term: &Term) -> (bool, String) {
        let mut outer = term.outer.clone();
        let mut parts = vec![self.wave(&term.wave)];
        match term.inner.as_slice() {
            // `outer` already contains the number of a single monomial, so this monomial has the number 1.
            [single] => outer.factors.extend(&single.factors),
            several => parts.push(self.bracket(&self.polynomial(several))),
        }
        if let Some((basis, coordinate)) = &term.basis
            && *basis != Formula::ONE
        {
            parts.push(self.formula_of(basis, *coordinate));
        }
        parts.retain(|part| !part.is_empty());
        (outer.number.value < 0.0, self.product(&outer, &parts))
    }

    /// Text of the product `|number| · factors · further`, in which `number` and `factors` are those of the
    /// monomial.
    fn product(&self, monomial: &Monomial, further: &[String]) -> String {
        let mut parts = Vec::new();
        let size = Number {
            value: monomial.number.value.abs(),
            fraction: monomial.number.fraction.map(|(n, d)| (n.abs(), d)),
        };
        let is_one = size.fraction == Some((1, 1));
        if !is_one || (monomial.factors.is_empty() && further.is_empty()) {
            parts.push(self.rational(size));
        }
        let powers = monomial.factors.iter();
        parts.extend(powers.map(|&(factor, exponent)| self.power(&self.factor(factor), exponent)));
        parts.extend_from_slice(further);
        match self.style {
            Style::Text => parts.join(" "),
            Style::Latex => parts.join(" \\, "),
        }
    }

    fn rational(&self, number: Number) -> String {
        match (number.fraction, self.style) {
            (Some((n, 1)), _) => n.to_string(),
            (Some((n, d)), Style::Text) => format!("{n}/{d}"),
            (Some((n, d)), Style::Latex) => format!("\\tfrac{{{n}}}{{{d}}}"),
            (None, _) => self.number(number.value),
        }
    }

    fn power(&self, base: &str, exponent: i32) -> String {
        match (exponent, self.style) {
            (1, _) => base.to_owned(),
            (_, Style::Text) => format!("{base}{}", superscript(exponent)),
            (_, Style::Latex) => format!("{base}^{{{exponent}}}"),
        }
    }

    fn factor(&self, factor: Factor) -> String {
        let number = |index: usize| (index + 1).to_string();
        match factor {
            Factor::Constant(index) => self.indexed("p", &number(index)),
            Factor::Coordinate(index) => self.indexed("y", &number(index)),
            Factor::Velocity(index) => self.velocity(index),
            Factor::Symbol(index) => {
                self.forms.symbols.get(index).map_or_else(String::new, |symbol| self.name(symbol))
            }
        }
    }

    fn velocity(&self, index: usize) -> String {
        match self.style {
            Style::Text => self.indexed("ẏ", &(index + 1).to_string()),
            Style::Latex => format!("\\dot{{y}}_{{{}}}", index + 1),
        }
    }

    fn wave(&self, wave: &Wave) -> String {
        match wave {
            Wave::None => String::new(),
            Wave::Cosine(multiples) => self.call("cos", &self.angle(multiples)),
            Wave::Sine(multiples) => self.call("sin", &self.angle(multiples)),
        }
    }

    fn angle(&self, multiples: &[i32]) -> String {
        let summands = multiples.iter().enumerate().filter(|(_, k)| **k != 0);
        let coordinates = self.forms.coordinates.len();
        self.joined(summands.map(|(index, &multiple)| {
            let angle = match index.checked_sub(coordinates) {
                None => self.factor(Factor::Coordinate(index)),
                Some(fixed) => {
                    self.forms.angles.get(fixed).map_or_else(String::new, |symbol| self.name(symbol))
                }
            };
            let text = match multiple.abs() {
                1 => angle,
                several => format!("{several} {angle}"),
            };
            (multiple < 0, text)
        }))
    }

    fn call(&self, function: &str, argument: &str) -> String {
        match self.style {
            Style::Text => format!("{function}({argument})"),
            Style::Latex => format!("\\{function}\\left({argument}\\right)"),
        }
    }

    fn bracket(&self, text: &str) -> String {
        match self.style {
            Style::Text => format!("({text})"),
            Style::Latex => format!("\\left({text}\\right)"),
        }
    }

    /// Text of a formula as a factor, in brackets if the formula is a sum. y and ẏ in the formula are the
    /// position and velocity of `coordinate`.
    fn formula_of(&self, formula: &Formula, coordinate: usize) -> String {
        match formula {
            Formula::Add(..) | Formula::Subtract(..) | Formula::Negate(_) => {
                self.bracket(&self.formula(formula, coordinate))
            }
            _ => self.formula(formula, coordinate),
        }
    }

    fn formula(&self, formula: &Formula, of: usize) -> String {
        let go = |part: &Formula| self.formula(part, of);
        let tight = |part: &Formula| self.formula_of(part, of);
        let space = if self.style == Style::Text { " " } else { " \\, " };
        match formula {
            Formula::Number(value) => self.number(*value),
            Formula::Parameter(index) => self.factor(Factor::Symbol(*index)),
            Formula::Position => self.factor(Factor::Coordinate(of)),
            Formula::Velocity => self.velocity(of),
            Formula::Negate(a) => format!("{}{}", self.minus(), tight(a)),
            Formula::Add(a, b) => format!("{} + {}", go(a), go(b)),
            Formula::Subtract(a, b) => format!("{} {} {}", go(a), self.minus(), tight(b)),
            Formula::Multiply(a, b) => format!("{}{space}{}", tight(a), tight(b)),
            Formula::Divide(a, b) if self.style == Style::Latex => {
                format!("\\frac{{{}}}{{{}}}", go(a), go(b))
            }
            Formula::Divide(a, b) => format!("({}) / ({})", go(a), go(b)),
            Formula::Power(a, exponent) => {
                let base = match **a {
                    Formula::Parameter(_) | Formula::Position | Formula::Velocity => go(a),
                    _ => self.bracket(&go(a)),
                };
                self.power(&base, i32::try_from(*exponent).unwrap_or(i32::MAX))
            }
            Formula::Call(Function::Abs, a) => format!("|{}|", go(a)),
            Formula::Call(Function::Sign, a) if self.style == Style::Latex => {
                format!("\\operatorname{{sign}}{}", self.bracket(&go(a)))
            }
            Formula::Call(Function::Sqrt, a) if self.style == Style::Latex => {
                format!("\\sqrt{{{}}}", go(a))
            }
            Formula::Call(function, a) => self.call(function.name(), &go(a)),
        }
    }

    fn minus(&self) -> &'static str {
        match self.style {
            Style::Text => "−",
            Style::Latex => "-",
        }
    }

    fn number(&self, number: f64) -> String {
        let shortest = format!("{number:?}");
        let shortest = shortest.strip_suffix(".0").unwrap_or(&shortest);
        let Some((digits, exponent)) = shortest.split_once('e') else {
            return shortest.replace('-', self.minus());
        };
        let digits = digits.replace('-', self.minus());
        match self.style {
            Style::Text => {
                format!("{digits}·10{}", exponent.parse().map_or_else(|_| String::new(), superscript))
            }
            Style::Latex => format!("{digits} \\cdot 10^{{{exponent}}}"),
        }
    }

    /// Text of a symbol: a letter with its index, or a parameter's name.
    fn name(&self, symbol: &Symbol) -> String {
        if !symbol.index.is_empty() || symbol.stem.chars().count() == 1 {
            return self.indexed(&symbol.stem, &symbol.index);
        }
        let end = symbol.stem.find(|c: char| c == '_' || c.is_ascii_digit());
        let (stem, index) = symbol.stem.split_at(end.unwrap_or(symbol.stem.len()));
        let index = index.trim_matches('_');
        let is_number = index.chars().all(|c| c.is_ascii_digit());
        match self.style {
            Style::Text if !is_number || stem.is_empty() => symbol.stem.clone(),
            _ => self.indexed(stem, &index.replace('_', ",")),
        }
    }

    fn indexed(&self, stem: &str, index: &str) -> String {
        let greek = greek_letter(stem);
        if self.style == Style::Text {
            let letter = greek.map_or_else(|| stem.to_owned(), String::from);
            return format!("{letter}{}", subscript(index));
        }
        let letter = match greek {
            Some(_) => format!("\\{stem}"),
            None if stem.chars().count() == 1 => stem.to_owned(),
            None => format!("\\mathrm{{{stem}}}"),
        };
        let (index, primes) = index.split_at(index.find('\'').unwrap_or(index.len()));
        match index.trim_matches('_') {
            "" => format!("{letter}{primes}"),
            index if index.chars().any(char::is_alphabetic) => {
                format!("{letter}{primes}_{{\\mathrm{{{}}}}}", index.replace('_', ","))
            }
            index => format!("{letter}{primes}_{{{index}}}"),
        }
    }
}

/// Indices of the symbols that occur in the equations.
fn used(forms: &ClosedForms) -> BTreeSet<usize> {
    let rows = forms.mass_matrix.iter().chain(&forms.input_matrix).flatten();
    let sums = rows.chain(&forms.coriolis_forces).chain(&forms.applied_forces);
    let terms: Vec<&Term> = sums.flatten().collect();
    let outer = terms.iter().map(|term| &term.outer);
    let factors = outer.chain(forms.constants.iter().flatten()).flat_map(|part| &part.factors);
    let mut used: BTreeSet<usize> = factors
        .filter_map(|(factor, _)| match factor {
            Factor::Symbol(index) => Some(*index),
            _ => None,
        })
        .collect();
    let bases = terms.iter().filter_map(|term| term.basis.as_ref());
    for (basis, _) in bases {
        used.extend((0..forms.symbols.len()).filter(|&k| basis.any(&|part| *part == Formula::Parameter(k))));
    }
    used
}

/// Rounds a value to twelve digits. Further digits are rounding errors of combined masses.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn aligned(rows: &[[String; 3]]) -> String {
    let width = |column: usize| {
        let lengths = rows.iter().map(|row| row[column].chars().count());
        lengths.max().unwrap_or(0)
    };
    let (names, values) = (width(0), width(1));
    let line =
        |[name, value, meaning]: &[String; 3]| format!("  {name:names$} = {value:values$}  {meaning}\n");
    rows.iter().map(line).collect()
}

/// Replaces digits by subscript digits.
fn subscript(index: &str) -> String {
    let small = |c: char| match c.to_digit(10) {
        Some(digit) => char::from_u32(u32::from('₀') + digit).unwrap_or(c),
        None => c,
    };
    index.chars().map(small).collect()
}

fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let small = |c: char| match c.to_digit(10) {
        Some(digit) => DIGITS.get(digit as usize).copied().unwrap_or(c),
        None => '⁻',
    };
    exponent.to_string().chars().map(small).collect()
}
