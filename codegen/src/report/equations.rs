//! Typeset equations on the page of a robot.

use gelenk_findings::counted;
use gelenk_report::{Block, Cell, Equation, Inline, ReportError, Table, code, plain, text};

use super::robot::Robot;
use crate::functions::function::Function;
use crate::model::Model;
use crate::program::display::{self, LatexResult, Notation};
use crate::program::expanded::{MOST_TERMS, expanded};

/// Closed forms of the equations of motion in LaTeX.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ClosedForm {
    /// Entries of the mass matrix M, the Coriolis forces k, the applied forces q and the input matrix B, as
    /// equations.
    pub equations: Vec<String>,
    /// Definitions of lumped constants (constant sums with their own symbols), as equations.
    pub constants: Vec<String>,
    /// Symbols that occur in the equations.
    pub symbols: Vec<Symbol>,
}

/// A symbol of the equations, with value and meaning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// The symbol in LaTeX.
    pub name: String,
    /// Value of the symbol in the description, in LaTeX.
    pub value: String,
    /// Meaning of the symbol in the equations.
    pub meaning: String,
}

/// Largest number of abbreviations (intermediate values) in an open list. Longer lists are folded at first.
const MOST_OPEN: usize = 60;
/// Largest number of typeset abbreviations. A browser needs seconds for tens of thousands.
const MOST: usize = 1_500;
/// Number of letters that fit on one line of a printed page.
const LETTERS: usize = 85;
/// Width of the space between two columns of a matrix, in letters.
const COLUMN_GAP: usize = 3;

/// Block with the equations of motion and the meaning of their symbols.
pub(super) fn legend(robot: &Robot<'_>) -> Result<Vec<Block>, ReportError> {
    let equation = Equation::new(motion(robot))?;
    Ok(vec![
        Block::Equations(vec![equation]),
        text("with coordinates $y_i$ and inputs $u_j$ in the order of the tables above, in SI units."),
        text(
            "Each function computes intermediate values from earlier intermediate values (as in Neweul-M²), and \
             its results from these values. No value is computed twice. The generated code has the same lines in the same order. \
             Numbers on this page are rounded to 12 digits.",
        ),
    ])
}

/// The equations of motion in LaTeX.
pub(super) fn motion(robot: &Robot<'_>) -> String {
    let input_matrix = if robot.model.inputs_depend_on_position() { "B(y)" } else { "B" };
    let motion = format!(r"M(y)\,\ddot{{y}} + k(y,\dot{{y}}) = q(y,\dot{{y}}) + {input_matrix}\,u");
    match robot.has_load_friction() {
        false => motion,
        true => format!(r"{motion} - |\tau_l| \, \sigma(y,\dot{{y}})"),
    }
}

/// Names of the functions that compute the mass matrix, Coriolis forces, applied forces and input matrix.
pub(crate) const EQUATIONS: [&str; 4] = ["mass_matrix", "coriolis_forces", "applied_forces", "input_matrix"];
/// Largest number of coordinates for which equations are written as sums.
const MOST_COORDINATES: usize = 3;

/// Entries of the mass matrix, Coriolis forces, applied forces and input matrix as sums without intermediate
/// values, in LaTeX and with the numbers of the description. The mass matrix is symmetric, so only its upper
/// triangle is given.
///
/// # Errors
/// Returns a message if the robot has more than three coordinates, or if an entry has more than 1000 terms.
pub fn sums(model: &Model, functions: &[Function]) -> Result<Vec<String>, String> {
    let coordinates = model.coordinates.len();
    if coordinates > MOST_COORDINATES {
        return Err(format!(
            "closed forms support up to {MOST_COORDINATES} coordinates, but this robot has {coordinates}"
        ));
    }
    let names = model.parameters.iter().map(|parameter| parameter.name.clone());
    let notation = Notation { parameters: names.collect() };
    let mut sums = Vec::new();
    for function in EQUATIONS.iter().filter_map(|name| functions.iter().find(|known| known.name == *name)) {
        let entries = expanded(&function.program, &notation, function.name == EQUATIONS[0]);
        let entries = entries
            .ok_or_else(|| format!("an entry of `{}` has more than {MOST_TERMS} terms", function.name))?;
        sums.extend(entries.into_iter().map(|entry| format!("{} = {}", entry.name, entry.value)));
    }
    Ok(sums)
}

/// The equations of motion as sums ([`sums`]) in a LaTeX document (amsmath).
///
/// # Errors
/// Returns the errors of [`sums`], or the text of a [`ReportError`] if a sum cannot be typeset.
pub fn sums_document(model: &Model, functions: &[Function]) -> Result<String, String> {
    let mut lines = Vec::new();
    for sum in sums(model, functions)? {
        let broken = Equation::broken(&sum, LETTERS).map_err(|error| error.to_string())?;
        lines.extend(broken.iter().map(|line| format!("  & {}", line.latex())));
    }
    let joints = model.moving_joints();
    let names: Vec<&str> =
        joints.iter().take(model.coordinates.len()).map(|joint| joint.joint.name.as_str()).collect();
    Ok(format!(
        "% {}: M ÿ + k = q + B u, in SI units; coordinates: {}\n\\documentclass{{article}}\n\\usepackage{{amsmath}}\n\
         \\usepackage[a4paper, margin=15mm]{{geometry}}\n\\allowdisplaybreaks\n\\begin{{document}}\n\
         \\begin{{align*}}\n{}\n\\end{{align*}}\n\\end{{document}}\n",
        model.name,
        names.join(", "),
        lines.join(" \\\\\n"),
    ))
}

/// A function as equations of its intermediate values and its results.
pub(super) fn program(robot: &Robot<'_>, function: &Function) -> Vec<Block> {
    let heading = Block::Heading(vec![
        Inline::Text(function.summary.replace('`', "").trim_end_matches('.').to_owned()),
        Inline::Text(" — ".to_owned()),
        code(&function.name),
    ]);
    let notation = Notation { parameters: robot.parameter_names.clone() };
    let equations = display::latex_equations(&function.program, &notation);
    let count = equations.abbreviations.len();
    if count > MOST {
        let words = format!(
            "{count} intermediate values are too many to typeset; `gelenk inspect program --functions {}` prints them.",
            function.name
        );
        return vec![heading, text(&words)];
    }
    let joined = |(name, value): (String, String)| format!("{name} = {value}");
    let abbreviations: Vec<String> = equations.abbreviations.into_iter().map(joined).collect();
    let results: Vec<String> = equations.results.iter().flat_map(result_lines).collect();
    // A few names cannot be typeset in LaTeX. The program is then shown as text.
    let (Ok(abbreviations), Ok(results)) = (all(&abbreviations), all(&results)) else {
        let text = display::text(&function.program, &notation);
        return vec![heading, Block::Code(text)];
    };
    let mut blocks = vec![heading];
    if count > 0 {
        blocks.push(Block::Details {
            summary: vec![Inline::Text(counted(count, "abbreviation", "abbreviations"))],
            is_open: count <= MOST_OPEN,
            blocks: vec![Block::Abbreviations(abbreviations)],
        });
    }
    blocks.push(Block::Equations(results));
    blocks
}

/// A function's result as one equation. If a matrix is too wide for paper, it has one equation per non-zero
/// entry.
fn result_lines(result: &LatexResult) -> Vec<String> {
    let width = |entry: &String| Equation::new(entry.as_str()).map_or(0, |equation| equation.width());
    let columns = result.rows.first().map_or(0, Vec::len);
    let column = |k: usize| result.rows.iter().filter_map(|row| row.get(k)).map(width).max().unwrap_or(0);
    if columns < 2 || (0..columns).map(|k| column(k) + COLUMN_GAP).sum::<usize>() <= LETTERS {
        return vec![format!("{} = {}", result.name, result.value())];
    }
    let mut lines = vec![String::new()];
    for (i, row) in result.rows.iter().enumerate() {
        for (j, entry) in row.iter().enumerate().filter(|(_, entry)| *entry != "0") {
            let equation = format!("{}_{{{},{}}} = {entry}", result.name, i + 1, j + 1);
            match lines.last_mut() {
                Some(line) if line.is_empty() => *line = equation,
                Some(line) if width(&format!("{line}{equation}")) + COLUMN_GAP <= LETTERS => {
                    *line += &format!(" \\quad {equation}");
                }
                _ => lines.push(equation),
            }
        }
    }
    lines
}

fn all(latex: &[String]) -> Result<Vec<Equation>, ReportError> {
    latex.iter().map(Equation::new).collect()
}

/// Equations that are broken into lines with the width of paper.
fn broken(latex: &[String]) -> Result<Vec<Equation>, ReportError> {
    let lines: Result<Vec<Vec<Equation>>, ReportError> =
        latex.iter().map(|one| Equation::broken(one, LETTERS)).collect();
    lines.map(|lines| lines.concat())
}

/// Block of equations that may contain names of descriptions: typeset if possible, otherwise as text.
pub(super) fn set(latex: &[String]) -> Block {
    match broken(latex) {
        Ok(equations) => Block::Equations(equations),
        Err(_) => Block::Code(latex.join("\n")),
    }
}

/// Closed forms as blocks of the page.
pub(super) struct ClosedFormText<'a>(pub &'a ClosedForm);

impl ClosedFormText<'_> {
    pub fn blocks(&self) -> Result<Vec<Block>, ReportError> {
        let ClosedForm { equations, constants, symbols } = self.0;
        let mut blocks = vec![
            text(
                "The same equations with symbols instead of numbers, derived independently from Lagrange's \
                 equations by the computer algebra system Symbolica.",
            ),
            Block::Equations(broken(equations)?),
        ];
        if !constants.is_empty() {
            blocks.extend([plain("with"), Block::Equations(broken(constants)?)]);
        }
        if !symbols.is_empty() {
            let rows = symbols.iter().map(|symbol| {
                vec![
                    Cell::Line(vec![Inline::Math(symbol.name.clone())]),
                    Cell::Line(vec![Inline::Math(symbol.value.clone())]),
                    Cell::text(symbol.meaning.clone()),
                ]
            });
            let table = Table::new("closed-form-symbols", "The symbols, in SI units.")
                .column("letter", "letter", "")
                .column("value", "value", "")
                .column("meaning", "meaning", "")
                .rows(rows);
            blocks.push(Block::Table(table));
        }
        Ok(blocks)
    }
}
