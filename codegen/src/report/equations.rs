//! The equations, typeset.

use gelenk_report::{
    Axis, Block, Cell, Equation, Figure, Inline, Marks, Plot, ReportError, Table, code, plain, text,
};

use super::formula;
use super::robot::Robot;
use crate::functions::function::Function;
use crate::model::{FrictionTerm, Joint, JointKind};
use crate::program::display::{self, Notation};
use gelenk_formula::Formula;

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
    /// What it stands for.
    pub meaning: String,
}

/// So many abbreviations are shown at once; more are folded away.
const MOST_OPEN: usize = 60;
/// So many are typeset at all; a browser needs seconds for tens of thousands.
const MOST: usize = 1_500;
/// So many letters stand on one line of a printed page.
const LETTERS: usize = 85;
/// Joints in one plot.
const CURVES: usize = 6;

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

/// Friction laws of the joints that have one.
pub(super) fn friction_laws(robot: &Robot<'_>) -> Vec<String> {
    let joints = robot.joints().into_iter().enumerate();
    let rubbing = joints.filter(|(_, joint)| !joint.friction.is_empty());
    rubbing.map(|(index, joint)| law(robot, index + 1, ("\\tau", &joint.friction))).collect()
}

/// Friction over load of the joints that have such friction.
pub(super) fn load_friction_laws(robot: &Robot<'_>) -> Vec<String> {
    let joints = robot.joints().into_iter().enumerate();
    let loaded = joints.filter(|(_, joint)| !joint.load_friction.is_empty());
    loaded.map(|(index, joint)| law(robot, index + 1, ("\\sigma", &joint.load_friction))).collect()
}

fn law(robot: &Robot<'_>, number: usize, (letter, terms): (&str, &[FrictionTerm])) -> String {
    let print = |part: &Formula| formula::latex(part, &robot.parameter_names, number);
    let bracketed = |part: &Formula| formula::factor(part, &robot.parameter_names, number);
    let term = |term: &FrictionTerm| match (term.coefficient.as_number(), term.basis.as_number()) {
        (Some(1.0), _) => print(&term.basis),
        (_, Some(1.0)) => print(&term.coefficient),
        _ => format!("{} \\, {}", bracketed(&term.coefficient), bracketed(&term.basis)),
    };
    let terms: Vec<String> = terms.iter().map(term).collect();
    format!("{letter}_{{{number}}} = {}", terms.join(" + "))
}

/// Forces of springs and dampers on the joints that have some.
pub(super) fn spring_laws(robot: &Robot<'_>) -> Vec<String> {
    let joints = robot.joints().into_iter().zip(1..);
    let sprung = joints.filter(|(joint, _)| !joint.springs.is_empty());
    let law = |(joint, number): (&Joint, usize)| {
        let forces = formula::sum(&joint.springs, &robot.parameter_names, number);
        format!("s_{{{number}}} = {forces}")
    };
    sprung.map(law).collect()
}

const CAPTION: &str = "Friction over velocity, up to the velocity limit (1 where there is none), with the other joints at rest. \
    Friction that depends on the position is drawn at both limits and in the middle.";

/// Friction over velocity, as the generated function computes it.
pub(super) fn friction_figure(robot: &Robot<'_>) -> Option<Figure> {
    let joints = robot.joints().into_iter().enumerate();
    let rubbing: Vec<(usize, &Joint)> = joints.filter(|(_, joint)| !joint.friction.is_empty()).collect();
    let caption = match robot.has_load_friction() {
        false => CAPTION.to_owned(),
        true => format!("{CAPTION} What the load adds is left out."),
    };
    let mut figure = Figure::new("friction-curves", &caption);
    for prismatic in [false, true] {
        let of_kind: Vec<&(usize, &Joint)> =
            rubbing.iter().filter(|(_, joint)| (joint.kind == JointKind::Prismatic) == prismatic).collect();
        for group in of_kind.chunks(CURVES) {
            figure = figure.plot(friction_plot(robot, group, prismatic)?);
        }
    }
    (!figure.plots.is_empty()).then_some(figure)
}

fn friction_plot(robot: &Robot<'_>, joints: &[&(usize, &Joint)], prismatic: bool) -> Option<Plot> {
    let (velocity, force) = if prismatic {
        (Axis::new("velocity", "m/s"), Axis::new("friction force", "N"))
    } else {
        (Axis::new("velocity", "rad/s"), Axis::new("friction torque", "N m"))
    };
    let mut plot = Plot::new("", velocity, force);
    for (index, joint) in joints {
        for (name, position) in friction_positions(joint) {
            let points = friction_curve(robot, *index, joint, position)?;
            plot = plot.series(name, Marks::Line, points);
        }
    }
    Some(plot)
}

/// Positions at which a joint's friction is drawn, with the names of the curves: 0 alone, or both limits and
/// their mean (−1, 0 and 1 without limits) where the law depends on the position.
fn friction_positions(joint: &Joint) -> Vec<(String, f64)> {
    let terms = &joint.friction;
    if !terms.iter().any(|term| term.basis.depends_on_position()) {
        return vec![(joint.name.clone(), 0.0)];
    }
    let [low, high] = joint.limits.position.unwrap_or([-1.0, 1.0]);
    let named = |position: f64| (format!("{} at y = {position:.3}", joint.name), position);
    [low, 0.5 * (low + high), high].map(named).to_vec()
}

/// Velocities are spaced more closely around 0, where laws are steep.
fn friction_curve(robot: &Robot<'_>, index: usize, joint: &Joint, position: f64) -> Option<Vec<[f64; 2]>> {
    const HALF: i32 = 200;
    let most = joint.limits.velocity.unwrap_or(1.0);
    let point = |k: i32| {
        let part = f64::from(k) / f64::from(HALF);
        let mut velocities = vec![0.0; robot.n()];
        *velocities.get_mut(index)? = most * part * part * part;
        let velocity = *velocities.get(index)?;
        let mut positions = vec![0.0; robot.n()];
        *positions.get_mut(index)? = position;
        let torques = robot.friction_torques(&positions, &velocities)?;
        Some([velocity, *torques.get(index)?])
    };
    (-HALF..=HALF).map(point).collect()
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
