//! Page of a robot: its parts, equations, operation counts, and self-check.
//!
//! The crate [`gelenk_report`] writes the page and also the pages of the runtime's examples. This module makes the
//! contents of the page.

mod equations;
mod following;
mod formula;
mod friction;
mod robot;
mod scene;
mod self_check;
mod sparsity;
mod springs;
mod tables;

use gelenk_report::{Block, Inline, Report, ReportError, Section, Table, plain, text};

use crate::diagnostic::Diagnostics;
use crate::functions::function::Function;
use crate::model::{Model, QuaternionJoint};
use crate::program::cost;
use equations::ClosedFormText;
use robot::Robot;
use std::ops::Range;

pub(crate) use equations::EQUATIONS;
pub use equations::{ClosedForm, Symbol, sums, sums_document};
pub(crate) use tables::counts;

/// Contents of the page of a robot.
#[derive(Debug, Clone, Copy)]
pub struct Contents<'a> {
    /// The robot of the page.
    pub model: &'a Model,
    /// All generated functions of the robot.
    pub functions: &'a [Function],
    /// Notes on the robot's description.
    pub notes: &'a Diagnostics,
    /// Closed forms of the equations of motion; if they are missing, the reason as text with markup.
    pub closed_form: Result<&'a ClosedForm, &'a str>,
    /// Command line that makes the page.
    pub command: &'a str,
}

/// Returns the page of a robot.
///
/// # Errors
/// Returns a [`ReportError`] if a part cannot be typeset or drawn.
pub fn report(contents: &Contents<'_>) -> Result<Report, ReportError> {
    let robot = Robot::new(contents.model, contents.functions);
    let mut report = head(&robot);
    report.made_by = contents.command.to_owned();
    report = report.section(robot_section(&robot)).section(parameters_section(&robot));
    report = report.section(equations_section(&robot, contents.closed_form)?);
    if let Some(section) = friction::section(&robot)? {
        report = report.section(section);
    }
    if let Some(section) = springs::section(&robot) {
        report = report.section(section);
    }
    report = report.section(structure_section(&robot)).section(self_check_section(&robot));
    if !contents.notes.is_empty() {
        let notes = Section::new("notes", "Notes on the description")
            .block(Block::Table(tables::notes(contents.notes)));
        report = report.section(notes);
    }
    Ok(report)
}

fn head(robot: &Robot<'_>) -> Report {
    let model = robot.model;
    let mut report = Report::new(format!("Equations of motion of {}", model.name))
        .lead(&format!("The generated code computes the terms of ${}$.", equations::motion(robot)))
        .fact("coordinates", robot.n().to_string())
        .fact("inputs", robot.inputs().len().to_string())
        .fact("bodies", robot.bodies().len().to_string());
    if !model.driven.is_empty() {
        report = report.fact("driven joints", model.driven.len().to_string());
    }
    if !model.parameters.is_empty() {
        report = report.fact("free parameters", model.parameters.len().to_string());
    }
    report
}

fn robot_section(robot: &Robot<'_>) -> Section {
    let description = robot.model.description.join(" ");
    let mut section = Section::new("robot", "The robot");
    if !description.trim().is_empty() {
        section = section.block(plain(description.trim()));
    }
    let scene = scene::scene(robot);
    section
        .block(Block::Scene(scene.clone()))
        .blocks(driven(robot).map(|sentence| text(&sentence)))
        .blocks(quaternions(robot).iter().map(|sentence| text(sentence)))
        .block(text(
            "The kinematic tree. Circles are revolute joints, squares are prismatic joints, a circle in a \
                     square is a joint that rotates and translates, and bars are fixed or held joints. Joints with a drive \
                     are filled.",
        ))
        .block(Block::Tree(scene))
}

/// Sentence on the argument d with the prescribed motion of joints; `None` without such joints.
fn driven(robot: &Robot<'_>) -> Option<String> {
    let joints = robot.model.driven_joints().enumerate();
    let names: Vec<String> =
        joints.map(|(index, joint)| format!("$d_{{{}}}$ ({})", index + 1, joint.name)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "The motion of {} is prescribed: its position, velocity and acceleration are the argument $d$ \
             of the functions below.",
            names.join(", ")
        )
    })
}

fn parameters_section(robot: &Robot<'_>) -> Section {
    Section::new("parameters", "Parameters and limits")
        .blocks(tables_of(robot).map(Block::Table))
        .block(text(&format!("Gravity is {} in the base frame.", tables::gravity(robot))))
}

/// Tables of the numbers in the description.
pub(crate) fn tables(model: &Model) -> Vec<Table> {
    tables_of(&Robot::new(model, &[])).collect()
}

fn tables_of(robot: &Robot<'_>) -> impl Iterator<Item = Table> {
    let tables = [
        Some(tables::coordinates(robot)),
        tables::dependent(robot),
        tables::drives(robot),
        tables::forces_at_frames(robot),
        tables::bodies(robot),
        tables::inertias(robot),
        tables::geometry(robot),
        tables::frames(robot),
        tables::parameters(robot),
    ];
    tables.into_iter().flatten()
}

fn equations_section(
    robot: &Robot<'_>,
    closed_form: Result<&ClosedForm, &str>,
) -> Result<Section, ReportError> {
    let mut section = Section::new("equations", "Equations of motion").blocks(equations::legend(robot)?);
    for function in EQUATIONS {
        if let Some(function) = robot.function(function) {
            section = section.blocks(equations::program(robot, function));
        }
    }
    section = section.block(Block::Heading(vec![Inline::Text("In closed form".to_owned())]));
    if let Ok(sums) = sums(robot.model, robot.functions) {
        section = section
            .block(text("The same equations without abbreviations, with the numbers of the description. M is symmetric."))
            .block(equations::set(&sums));
    }
    section = match closed_form {
        Ok(closed_form) => section.blocks(ClosedFormText(closed_form).blocks()?),
        Err(reason) => section.block(text(reason)),
    };
    Ok(section)
}

fn structure_section(robot: &Robot<'_>) -> Section {
    let costs =
        robot.functions.iter().map(|function| (function.name.clone(), cost::count(&function.program)));
    let costs: Vec<_> = costs.collect();
    let forces = match robot.has_load_friction() {
        false => "$f = M \\ddot y + k - q$ are the forces of the inverse dynamics.",
        true => "$f$ are the forces of the inverse dynamics.",
    };
    let words = format!("Filled entries are computed; all other entries are 0 for every state. {forces}");
    Section::new("structure", "Sparsity and cost")
        .block(text(&words))
        .block(Block::Patterns(sparsity::patterns(robot)))
        .block(Block::Table(counts(&costs, &[])))
}

fn self_check_section(robot: &Robot<'_>) -> Section {
    Section::new("self-check", "Self-check")
        .block(text(&format!(
            "The generated functions are compared with independently derived Newton–Euler equations of the described bodies, at \
             pseudo-random states within the limits. Derivatives are compared with dual numbers. The bound for rounding errors is \
             1e-9 of the largest entry, or 1e-12 of the terms of a sum that cancel. For functions that divide by M, the bound is \
             multiplied by the condition number of M. The mass matrix is examined at {} states.",
            self_check::STATES
        )))
        .block(Block::Claims(self_check::claims(robot)))
}

/// Sentences on the positions, velocities and sliders of joints with quaternions.
fn quaternions(robot: &Robot<'_>) -> Vec<String> {
    let joint = |joint: &QuaternionJoint| {
        let Range { start, end } = joint.coordinates();
        let first = robot.model.first_position(joint.first) + 1;
        let origin = if joint.kind.quaternion() > 0 { "the position of its body, then " } else { "" };
        format!(
            "Joint {} is {}: its positions $y_{{{first}}}$ to $y_{{{}}}$ are {origin}a quaternion x, y, z, \
             w, and its velocities $\\dot{{y}}_{{{}}}$ to $\\dot{{y}}_{{{}}}$ are those of its body, in the \
             axes of the body. The sliders here move and rotate the body along x, y and z, in this order.",
            joint.name,
            joint.kind.name(),
            first + joint.kind.positions() - 1,
            start + 1,
            end
        )
    };
    robot.model.quaternion_joints.iter().map(joint).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::function::ConstantValue;
    use crate::functions::selection;
    use crate::functions::size::MOST_OPERATIONS;
    use crate::module::Module;
    use crate::read::{ReadOptions, from_toml};
    use gelenk_report::{Cell, Verdict};

    const ARM: &str = r#"
        [[joints]]
        name = "lift"
        type = "prismatic"
        drive = "ideal"
        friction = "2*v + 0.5*tanh(20*v)"
        [[joints]]
        name = "swing"
        axis = [0, 1, 0]
        drive = { gear_ratio = 50, rotor_inertia = 1e-5 }
        [[bodies]]
        link = "lift"
        mass = 2
        [[bodies]]
        link = "swing"
        mass = 1
        center_of_mass = [0.1, 0, -0.3]
        inertia = 0.01
        [[frames]]
        name = "tip"
        link = "swing"
        origin = { xyz = [0, 0, -0.5] }
    "#;

    fn arm(text: &str) -> (Model, Vec<Function>) {
        let mut load = |_: &str| Err(Diagnostics::default());
        let loaded = from_toml(text, "arm.toml", &ReadOptions::default(), &mut load);
        let (model, _) = loaded.unwrap_or_else(|problems| panic!("{problems}"));
        let functions = selection::derive_functions(&model, &[], MOST_OPERATIONS);
        let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
        (model, functions)
    }

    fn verdicts(model: &Model, functions: &[Function]) -> Vec<(String, Verdict)> {
        let claims = self_check::claims(&Robot::new(model, functions));
        claims.into_iter().map(|claim| (claim.id.clone(), claim.verdict())).collect()
    }

    #[test]
    fn a_right_robot_passes_its_self_check() {
        let (model, functions) = arm(ARM);
        let verdicts = verdicts(&model, &functions);
        assert_eq!(verdicts.len(), functions.len() - 1);
        for (id, verdict) in verdicts {
            assert_eq!(verdict, Verdict::Holds, "{id}");
        }
    }

    /// No check falls away.
    #[test]
    fn a_free_robot_passes_the_same_self_check() {
        let base = "base = { link = \"base\", type = \"floating\" }\n";
        let ball = "[[joints]]\nname = \"ball\"\nparent = \"swing\"\ntype = \"spherical\"\ndrive = \"ideal\"\n\
            [[bodies]]\nlink = \"ball\"\nmass = 1\ncenter_of_mass = [0.2, 0.1, -0.3]\ninertia = 0.1\n\
            [[bodies]]\nlink = \"base\"\nmass = 5\ninertia = 0.3\n";
        let (model, functions) = arm(&format!("{base}{ARM}{ball}"));
        assert_eq!(model.quaternion_joints.len(), 2);
        let verdicts = verdicts(&model, &functions);
        assert_eq!(verdicts.len(), functions.len() - 1, "{verdicts:?}");
        for (id, verdict) in verdicts {
            assert_eq!(verdict, Verdict::Holds, "{id}");
        }
    }

    /// The page counts positions as the module does: those behind a floating base begin at y₈, their velocities at ẏ₇.
    #[test]
    fn coordinates_of_a_free_robot_are_numbered_as_in_its_module() {
        let base = "base = { link = \"base\", type = \"floating\" }\n";
        let ball = "[[joints]]\nname = \"ball\"\nparent = \"lift\"\ntype = \"spherical\"\n\
            [[bodies]]\nlink = \"ball\"\nmass = 1\ninertia = 0.1\n\
            [[joints]]\nname = \"wheel\"\nparent = \"ball\"\nfriction = \"(2 + y.powi(2))*v\"\n\
            [[bodies]]\nlink = \"wheel\"\nmass = 1\ninertia = 0.1\n\
            [[bodies]]\nlink = \"base\"\nmass = 5\ninertia = 0.3\n";
        let (model, functions) = arm(&format!("{base}{ARM}{ball}"));
        let robot = Robot::new(&model, &functions);
        let constants = Module::new(&model, vec![], &[]).constants;
        let constant = |name: &str| {
            let found = constants.iter().find(|constant| constant.name == name);
            match &found.unwrap_or_else(|| panic!("{name}")).value {
                ConstantValue::Names(_, names) => names.clone(),
                ConstantValue::Indices(_, all) => all.iter().map(usize::to_string).collect(),
                other => panic!("{name}: {other:?}"),
            }
        };
        let [names, sizes, positions, velocities] =
            ["JOINT_NAMES", "JOINT_POSITIONS", "FIRST_POSITIONS", "FIRST_VELOCITIES"].map(constant);
        let number = |text: &str| text.parse::<usize>().unwrap() + 1;
        let table = tables::coordinates(&robot);
        assert_eq!(table.rows.iter().filter(|row| row[0] == Cell::Empty).count(), 9);
        for (joint, name) in names.iter().enumerate() {
            let first = number(&velocities[joint]);
            let row = &table.rows[first - 1];
            assert_eq!(
                row[1],
                Cell::formula([format!("\\dot{{y}}_{{{first}}}"), format!("v{first}")]),
                "{name}"
            );
            let is_plain = sizes[joint] == "1";
            let position = number(&positions[joint]);
            let symbol = [format!("y_{{{position}}}"), format!("y{position}")];
            let expected = if is_plain { Cell::formula(symbol) } else { Cell::Empty };
            assert_eq!(row[0], expected, "{name}");
            assert!(!is_plain || row[2] == Cell::Text(name.clone()), "{name}");
        }
        let laws = friction::friction_laws(&robot);
        let law = laws.last().map_or("", String::as_str);
        assert!(law.starts_with("\\tau_{12} = "), "{law}");
        assert!(law.contains("y_{14}^{2}") && law.contains("\\dot{y}_{12}"), "{law}");
        assert_eq!(friction::friction_figure(&robot, &[]).unwrap().plots.len(), 2);
    }

    /// A slide of a ton that carries a needle: eigenvalues that mix kg and kg m² say nothing.
    #[test]
    fn masses_and_inertias_are_not_compared() {
        let needle = ARM.replace("mass = 2", "mass = 1000");
        let needle = needle.replace(
            "mass = 1\n        center_of_mass = [0.1, 0, -0.3]\n        inertia = 0.01",
            "mass = 0\n        inertia = 5e-10",
        );
        let (model, functions) =
            arm(&needle.replace("drive = { gear_ratio = 50, rotor_inertia = 1e-5 }", "drive = \"ideal\""));
        for (id, verdict) in verdicts(&model, &functions) {
            assert_eq!(verdict, Verdict::Holds, "{id}");
        }
    }

    /// Functions of another robot under this one's: the row of each function notices its own.
    #[test]
    fn each_check_fails_on_the_function_of_another_robot() {
        let (model, functions) = arm(ARM);
        let heavier = ARM.replace("center_of_mass = [0.1", "center_of_mass = [0.2");
        let heavier =
            heavier.replace("50, rotor_inertia", "51, rotor_inertia").replace("0.5*tanh", "0.6*tanh");
        let (_, others) = arm(&heavier.replace("[0, 0, -0.5]", "[0, 0, -0.6]"));
        let same = [
            "coriolis_forces",
            "spring_forces",
            "inertial_regressor",
            "base_regressor",
            "friction_regressor",
        ];
        for other in others.iter().filter(|other| !same.contains(&other.name.as_str())) {
            let own = |own: &Function| if own.name == other.name { other.clone() } else { own.clone() };
            let mixed: Vec<Function> = functions.iter().map(own).collect();
            let check = match other.frame {
                Some(_) => "check-frames".to_owned(),
                None => format!("check-{}", other.name.replace('_', "-")),
            };
            for (id, verdict) in verdicts(&model, &mixed) {
                let expected = if id == check { Verdict::DoesNotHold } else { Verdict::Holds };
                assert_eq!(verdict, expected, "{id} for {}", other.name);
            }
        }
    }

    #[test]
    fn an_indefinite_mass_matrix_is_noticed() {
        let (model, mut functions) = arm(ARM);
        functions[0].program.outputs[0].entries[1] = crate::program::Operand::Constant(1e6);
        functions[0].program.outputs[0].entries[2] = crate::program::Operand::Constant(1e6);
        let found = verdicts(&model, &functions);
        assert_eq!(found[0], ("check-definite".to_owned(), Verdict::DoesNotHold));
        assert_eq!(found[1], ("check-mass-matrix".to_owned(), Verdict::DoesNotHold));
    }

    /// Two coaxial upright hinges without drives have neither gravity nor Coriolis forces: 0 agrees with 0.
    #[test]
    fn forces_that_vanish_agree() {
        let hinges = "[[joints]]\nname = \"a\"\n[[joints]]\nname = \"b\"\n\
            [[bodies]]\nlink = \"a\"\nmass = 1\ninertia = 0.1\n[[bodies]]\nlink = \"b\"\nmass = 1\ninertia = 0.2\n";
        let (model, functions) = arm(hinges);
        for (id, verdict) in verdicts(&model, &functions) {
            assert_eq!(verdict, Verdict::Holds, "{id}");
        }
    }

    #[test]
    fn no_text_of_a_description_becomes_markup() {
        let hostile = ARM
            .replace(
                "[[joints]]\n        name = \"lift\"",
                "description = \"</script><script>alert(1)</script> $x^$ \
                                                             `\"\n[[joints]]\n        name = \"lift\"",
            )
            .replace(
                "link = \"lift\"\n        mass = 2",
                "name = \"<img src=x onerror=alert(1)>\"\n link = \"lift\"\n mass = 2",
            );
        let (model, functions) = arm(&hostile);
        let contents = Contents {
            model: &model,
            functions: &functions,
            notes: &Diagnostics::default(),
            closed_form: Err("none"),
            command: "gelenk report '</code><script>'",
        };
        let page = report(&contents).and_then(|page| page.html());
        let page = page.unwrap_or_else(|error| panic!("{error}"));
        assert!(!page.contains("<img") && !page.contains("alert(1)</script>"));
        // The data and the view's script, nothing else.
        assert_eq!(page.matches("<script").count(), 2);
    }
}
