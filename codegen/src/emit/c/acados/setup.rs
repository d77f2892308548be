//! Prints the Python file that defines an optimal control problem for acados. Constants of the robot are
//! inserted into a fixed text.

use super::super::context::Context;
use super::functions;
use super::python::{array, number, string, strings};
use crate::emit::header;
use crate::functions::function::{Constant, ConstantValue};
use crate::program::interpret::interpret;

/// Fixed text of the Python file, without the robot's constants and the code for the parameters of a stage.
const TEXT: &str = include_str!("setup.py");

/// Python code for the parameters of a stage of the optimal control problem, for robots without quaternions.
const PARAMETERS: &str = include_str!("parameters.py");

/// Python code for the parameters of a stage of the optimal control problem, for robots with quaternions.
/// They include reference positions.
const REFERENCES: &str = include_str!("references.py");

const STATE: &str = "The dynamics are discrete: they give x = (y, ẏ) after a period with constant inputs u. The parameters p are the period in s,
then the free parameters of the description.";

const STATE_ABOUT: &str = "The dynamics are discrete: they give x = (d, v) after a period with constant inputs u. The positions are
y_ref ⊕ d with the reference positions y_ref of each stage. Rotations in d are at most half a turn. The parameters p are the
period in s, the reference positions at the beginning and end of the period, then the free parameters of the description.";

/// Prints the file `<name>_acados.py`, which defines an optimal control problem.
pub(in crate::emit::c) fn text(context: &Context<'_>) -> String {
    let lines = header::lines(context.module, &context.options.command);
    let top: String = lines.iter().map(|line| format!("#{}\n", line.trim_start_matches('/'))).collect();
    let constants = Robot::new(context).constants();
    let text = TEXT.replace("gelenk_acados", &format!("{}_acados", context.name));
    let (state, parameters) = match context.module.has_quaternions() {
        false => (STATE, PARAMETERS),
        true => (STATE_ABOUT, REFERENCES),
    };
    let text = text.replace("STATE", state).replace("# parameters\n", parameters);
    format!("{top}{}", text.replace("# constants\n", &constants))
}

/// Data of a robot for the constants in the Python file for acados.
struct Robot<'a> {
    context: &'a Context<'a>,
    n: usize,
    m: usize,
    /// Entries of the input matrix B, row-major, for the parameter values of the description; `None` if B
    /// depends on positions.
    input_matrix: Option<Vec<f64>>,
}

impl<'a> Robot<'a> {
    fn new(context: &'a Context<'a>) -> Self {
        let module = context.module;
        let described: Vec<f64> = module.parameters.iter().map(|parameter| parameter.default).collect();
        let function = module.functions.iter().find(|function| function.name == "input_matrix");
        let program = function.map(|function| &function.program).filter(|program| program.inputs.is_empty());
        let results = program.and_then(|program| interpret(program, &[], &described).ok());
        let input_matrix = results.and_then(|results| results.into_iter().next());
        Self { context, n: module.coordinates, m: module.inputs, input_matrix }
    }

    fn constants(&self) -> String {
        let [names, limits, inputs] = [self.names(), self.of_states(), self.of_inputs()];
        let all = [names, self.of_positions(), limits, inputs, vec![self.left_out()]].concat();
        all.iter().map(|(name, value, about)| format!("\n{name} = {value}\n\"\"\"{about}\"\"\"\n")).collect()
    }

    fn names(&self) -> Vec<Entry> {
        let [step, step_derivatives] = functions(self.context);
        let prefix = self.context.function("");
        let source = format!("{}_acados.c", self.context.name);
        let (coordinates, names_of, units_of) = match self.context.module.has_quaternions() {
            false => {
                (["JOINT_NAMES", "JOINT_UNITS"], "Names of the coordinates.", "Units of the coordinates.")
            }
            true => {
                (["VELOCITY_NAMES", "VELOCITY_UNITS"], "Names of the velocities.", "Units of the velocities.")
            }
        };
        let parameters = self.context.module.parameters.iter();
        let parameters: Vec<String> =
            parameters.map(|each| format!("{}: {}", string(&each.name), number(each.default))).collect();
        let texts = |name: &str| match self.value(name) {
            Some(ConstantValue::Names(_, names)) => strings(names.iter().map(String::as_str)),
            _ => unreachable!("{name} is a list of names in every module"),
        };
        vec![
            entry("NAME", string(prefix.trim_end_matches('_')), "Name of the model."),
            entry("SOURCE", string(&source), "Source file that acados compiles."),
            entry("STEP", string(&step), "Name of the function for the dynamics."),
            entry(
                "STEP_DERIVATIVES",
                string(&step_derivatives),
                "Name of the function for the dynamics with their derivatives.",
            ),
            entry("N", self.n.to_string(), "Number of coordinates."),
            entry("M", self.m.to_string(), "Number of inputs."),
            entry(coordinates[0], texts(coordinates[0]), names_of),
            entry(coordinates[1], texts(coordinates[1]), units_of),
            entry("EFFORT_UNITS", texts("EFFORT_UNITS"), "Units of the forces at the joints."),
            entry("INPUT_NAMES", texts("INPUT_NAMES"), "Names of the inputs."),
            entry("INPUT_UNITS", texts("INPUT_UNITS"), "Units of the inputs."),
            entry(
                "PARAMETERS",
                format!("{{{}}}", parameters.join(", ")),
                "Values of the free parameters in the description, in the order of p after the period.",
            ),
        ]
    }

    /// Additional constants of the Python file for robots with quaternions.
    fn of_positions(&self) -> Vec<Entry> {
        if !self.context.module.has_quaternions() {
            return vec![];
        }
        let indices = |name, about| {
            let indices = match self.value(name) {
                Some(ConstantValue::Indices(_, indices)) => indices,
                _ => unreachable!("{name} is a list of indices in every module with quaternions"),
            };
            let listed: String = indices.iter().map(|index| format!("{index}, ")).collect();
            entry(name, format!("({})", listed.trim_end_matches(' ')), about)
        };
        let ny = self.context.module.positions;
        vec![
            entry("NY", ny.to_string(), "Number of position entries."),
            indices("JOINT_POSITIONS", "Number of position entries of each joint."),
            indices("FIRST_POSITIONS", "Index of the first position entry of each joint."),
            indices("FIRST_VELOCITIES", "Index of the first velocity of each joint."),
            entry(
                "NEUTRAL",
                array(&self.flat("NEUTRAL", ny), None),
                "Positions at which all joint angles and displacements are 0.",
            ),
        ]
    }

    fn of_states(&self) -> Vec<Entry> {
        let followers = match self.value("DEPENDENT_JOINT_NAMES") {
            Some(ConstantValue::Names(_, names)) if !self.follow_driven_joints() => names.len(),
            _ => 0,
        };
        let numbers = |name, about| entry(name, array(&self.numbers(name, self.n), None), about);
        let of_followers =
            |name, columns, about| entry(name, array(&self.flat(name, followers), columns), about);
        vec![
            entry(
                "POSITION_LIMITS",
                array(&self.flat("POSITION_LIMITS", self.n), Some(2)),
                "Lowest and highest position of each joint.",
            ),
            numbers("VELOCITY_LIMITS", "Highest speed of each joint."),
            numbers("EFFORT_LIMITS", "Nominal force at each joint."),
            numbers("PEAK_EFFORT_LIMITS", "Peak force at each joint."),
            of_followers(
                "DEPENDENT_JOINT_RATIOS",
                Some(self.n),
                "Derivatives of the positions of followers (joints that follow others) with respect to the coordinates.",
            ),
            of_followers(
                "DEPENDENT_JOINT_OFFSETS",
                None,
                "Positions of the followers if all coordinates are 0.",
            ),
            of_followers("DEPENDENT_POSITION_LIMITS", Some(2), "Lowest and highest position of followers."),
            of_followers("DEPENDENT_VELOCITY_LIMITS", None, "Highest speed of followers."),
        ]
    }

    fn of_inputs(&self) -> Vec<Entry> {
        let unlimited = [f64::NEG_INFINITY, f64::INFINITY].repeat(self.m);
        let ranges = Some(self.flat("INPUT_RANGES", self.m)).filter(|ranges| !ranges.is_empty());
        let zeros = vec![0.0; self.n * self.m];
        let slopes = Some(self.flat("TORQUE_SPEED_SLOPES", self.m)).filter(|slopes| !slopes.is_empty());
        let numbers = |name, about| entry(name, array(&self.numbers(name, self.m), None), about);
        vec![
            numbers("INPUT_LIMITS", "Largest continuous magnitude of each input."),
            numbers("PEAK_INPUT_LIMITS", "Largest short-time magnitude of each input."),
            entry(
                "INPUT_RANGES",
                array(&ranges.unwrap_or(unlimited), Some(2)),
                "Further limits: lowest and highest value of each input.",
            ),
            entry(
                "TORQUE_SPEED_SLOPES",
                array(slopes.as_ref().unwrap_or(&zeros), Some(self.n)),
                "Matrix C of the torque-speed lines |u + C v| <= limit of the motors, with one row for each input.",
            ),
            numbers(
                "TORQUE_SPEED_LIMITS",
                "Limit of the torque-speed line of each input; infinite if a motor has no line.",
            ),
            entry(
                "INPUT_MATRIX",
                array(self.input_matrix.as_ref().unwrap_or(&zeros), Some(self.m.max(1))),
                "Input matrix B for the parameter values of the description; 0 if B depends on positions.",
            ),
        ]
    }

    /// Names of limits that the Python file does not include, because they are not constant bounds of states
    /// and inputs.
    fn left_out(&self) -> Entry {
        let has_efforts = ["EFFORT_LIMITS", "PEAK_EFFORT_LIMITS"]
            .iter()
            .any(|name| self.numbers(name, self.n).iter().any(|effort| effort.is_finite()));
        let efforts =
            (has_efforts && self.input_matrix.is_none()).then_some("limits of forces at the joints");
        let is_missing = self.value("FOLLOWER_NAMES").is_some() || self.follow_driven_joints();
        let followers = is_missing.then_some("limits of joints that follow others");
        let about = "Limits of the description that are not included, because they are not constant bounds of x and u.";
        entry("LEFT_OUT", strings(efforts.into_iter().chain(followers)), about)
    }

    /// Whether a joint follows joints with prescribed motion. Functions for acados cannot take this motion.
    fn follow_driven_joints(&self) -> bool {
        self.value("DEPENDENT_DRIVEN_RATIOS").is_some()
    }

    fn value(&self, name: &str) -> Option<&ConstantValue> {
        let found: Option<&Constant> = self.context.module.constants.iter().find(|each| each.name == name);
        found.map(|constant| &constant.value)
    }

    /// Entries of a constant of numbers; infinite if the module does not have the constant.
    fn numbers(&self, name: &str, count: usize) -> Vec<f64> {
        match self.value(name) {
            Some(ConstantValue::Numbers(_, numbers)) => numbers.clone(),
            _ => vec![f64::INFINITY; count],
        }
    }

    /// Entries of a constant with `count` rows, row-major; empty if the module does not have the constant.
    fn flat(&self, name: &str, count: usize) -> Vec<f64> {
        match self.value(name) {
            _ if count == 0 => vec![],
            Some(ConstantValue::Numbers(_, numbers)) => numbers.clone(),
            Some(ConstantValue::Ranges(_, ranges)) => ranges.as_flattened().to_vec(),
            Some(ConstantValue::Rows(_, rows)) => rows.concat(),
            _ => vec![],
        }
    }
}

/// Name, value and comment of a constant in the Python file.
type Entry = (&'static str, String, &'static str);

fn entry(name: &'static str, value: String, about: &'static str) -> Entry {
    (name, value, about)
}
