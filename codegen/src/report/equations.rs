//! The equations, typeset.

use gelenk_report::{Block, Cell, Equation, Inline, ReportError, Table, code, plain, text};

use super::robot::Robot;
use crate::functions::function::Function;
use crate::program::display::{self, Notation};

/// Closed forms in LaTeX, free of what made them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ClosedForm {
    /// Entries of M, k, q and B.
    pub equations: Vec<String>,
    /// Lumped constants.
    pub constants: Vec<String>,
    /// The letters.
    pub symbols: Vec<Symbol>,
}

/// A letter of a closed form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// The letter in LaTeX.
    pub name: String,
    /// Its value in LaTeX.
    pub value: String,
    /// Meaning.
    pub meaning: String,
}

/// Largest number of abbreviations shown at once; more are folded away.
const MOST_OPEN: usize = 60;
/// Largest number of typeset abbreviations; a browser needs seconds for tens of thousands.
const MOST: usize = 1_500;
/// Letters on one line of a printed page.
const LETTERS: usize = 85;

/// The equations of motion and what their letters are.
pub(super) fn legend(robot: &Robot<'_>) -> Result<Vec<Block>, ReportError> {
    let equation = Equation::new(motion(robot))?;
    Ok(vec![
        Block::Equations(vec![equation]),
        text("with coordinates $y_i$ and inputs $u_j$ in the order of the tables above, in SI units."),
        text(
            "Each function computes abbreviations from earlier ones, as in Neweul-M², and its result from them: nothing is computed \
             twice. The generated code holds these lines in this order.",
        ),
    ])
}

/// The equations of motion.
pub(super) fn motion(robot: &Robot<'_>) -> String {
    let input_matrix = if robot.model.inputs_depend_on_position() { "B(y)" } else { "B" };
    let motion = format!(r"M(y)\,\ddot{{y}} + k(y,\dot{{y}}) = q(y,\dot{{y}}) + {input_matrix}\,u");
    match robot.has_load_friction() {
        false => motion,
        true => format!(r"{motion} - |\tau_l| \, \sigma(y,\dot{{y}})"),
    }
}

/// A function with its abbreviations.
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
            "{count} abbreviations, too many to typeset; `gelenk inspect program --functions {}` prints them.",
            function.name
        );
        return vec![heading, text(&words)];
    }
    let joined =
        |pairs: Vec<(String, String)>| pairs.into_iter().map(|(name, value)| format!("{name} = {value}"));
    let abbreviations: Vec<String> = joined(equations.abbreviations).collect();
    let results: Vec<String> = joined(equations.results).collect();
    // A name that no LaTeX can hold is rare, and the program as text is as good.
    let (Ok(abbreviations), Ok(results)) = (all(&abbreviations), all(&results)) else {
        let text = display::text(&function.program, &notation);
        return vec![heading, Block::Code(text)];
    };
    let mut blocks = vec![heading];
    if count > 0 {
        let plural = if count == 1 { "abbreviation" } else { "abbreviations" };
        blocks.push(Block::Details {
            summary: vec![Inline::Text(format!("{count} {plural}"))],
            is_open: count <= MOST_OPEN,
            blocks: vec![Block::Abbreviations(abbreviations)],
        });
    }
    blocks.push(Block::Equations(results));
    blocks
}

fn all(latex: &[String]) -> Result<Vec<Equation>, ReportError> {
    latex.iter().map(Equation::new).collect()
}

/// On lines that paper can hold.
fn broken(latex: &[String]) -> Result<Vec<Equation>, ReportError> {
    let lines: Result<Vec<Vec<Equation>>, ReportError> =
        latex.iter().map(|one| Equation::broken(one, LETTERS)).collect();
    lines.map(|lines| lines.concat())
}

/// Equations that may hold names of descriptions: typeset where they can be, else as text.
pub(super) fn set(latex: &[String]) -> Block {
    match broken(latex) {
        Ok(equations) => Block::Equations(equations),
        Err(_) => Block::Code(latex.join("\n")),
    }
}

/// Closed forms as blocks.
pub(super) struct ClosedFormText<'a>(pub &'a ClosedForm);

impl ClosedFormText<'_> {
    pub fn blocks(&self) -> Result<Vec<Block>, ReportError> {
        let ClosedForm { equations, constants, symbols } = self.0;
        let mut blocks = vec![
            text(
                "The same equations with letters for the numbers of the description, derived a second time from Lagrange's equations by the \
                 computer algebra system Symbolica.",
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
            let table = Table::new("closed-form-symbols", "The letters, in SI units.")
                .column("letter", "letter", "")
                .column("value", "value", "")
                .column("meaning", "meaning", "")
                .rows(rows);
            blocks.push(Block::Table(table));
        }
        Ok(blocks)
    }
}
