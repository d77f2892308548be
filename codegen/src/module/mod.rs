//! The module as data, between derivation and printing.
//!
//! A printer uses only a [`Module`] and its own options. It needs no [`Model`] and derives nothing.

pub mod constants;

use crate::functions::catalogue;
use crate::functions::composition::{ComposedResult, Composition};
use crate::functions::function::{Constant, Function};
use crate::functions::position_functions::PositionFunction;
use crate::model::{Model, Parameter};
use crate::program::cost::Cost;
use crate::self_test::SelfTest;

/// Module of a robot: all contents of its text, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Name of the robot as an identifier in snake case.
    pub name: String,
    /// Paragraphs of the robot's description; may be empty.
    pub description: Vec<String>,
    /// Lines added to the documentation of the robot.
    pub remarks: Vec<String>,
    /// Number of coordinates. It is also the number of velocities.
    pub coordinates: usize,
    /// Number of position entries. A joint with a quaternion has one more position entry than velocities.
    pub positions: usize,
    /// Number of inputs, for example of motor torques.
    pub inputs: usize,
    /// Number of driven coordinates, whose motion is prescribed.
    pub driven: usize,
    /// Number of position entries of each joint; empty without quaternions.
    pub joint_positions: Vec<usize>,
    /// Constants of the robot: names, units, limits, drives and gravity.
    pub constants: Vec<Constant>,
    /// Free parameters. They are an argument of all functions except the functions of positions with
    /// quaternions, for example `integrate`.
    pub parameters: Vec<Parameter>,
    /// Functions with their own program. Each is printed after the constants that document it.
    pub functions: Vec<Function>,
    /// Constant with the number of Runge–Kutta steps in one sample time; `None` if no function has several
    /// steps.
    pub substeps: Option<Constant>,
    /// Functions over a sample time. They call other functions of the module.
    pub compositions: Vec<ComposedFunction>,
    /// Names of the functions that also exist in a version for eight states at once (`--lanes`).
    pub lanes: Vec<String>,
    /// Function calls with expected results, for tests in the module; empty without tests.
    pub self_tests: Vec<SelfTest>,
}

/// A function over a sample time, which calls another function of its module.
#[derive(Debug, Clone, PartialEq)]
pub struct ComposedFunction {
    /// Kind of the function: `discretize`, `step` or `step_derivatives`.
    pub composition: Composition,
    /// Equation of the function in Unicode.
    pub equation: &'static str,
    /// Whether the robot has joints with quaternions.
    pub has_quaternions: bool,
    /// Symbols, shapes and meanings of the function's results.
    pub results: Vec<ComposedResult>,
    /// Number of operations of the function; `None` if the module lacks the called function, or the robot has
    /// joints with quaternions.
    pub cost: Option<Cost>,
    /// Sentence about the operations in the function's documentation.
    pub cost_text: String,
}

impl Module {
    /// Creates the module of a model's functions, without remarks, tests and functions for eight states at
    /// once.
    #[must_use]
    pub fn new(model: &Model, functions: Vec<Function>, compositions: &[Composition]) -> Self {
        let has_substeps = compositions.iter().any(|each| each.has_substeps());
        let composed = compositions.iter().map(|each| each.name());
        let names = functions.iter().map(|function| function.name.as_str());
        let of_positions = PositionFunction::ALL.map(PositionFunction::name).into_iter();
        let of_positions = of_positions.filter(|_| !model.quaternion_joints.is_empty());
        let list = constants::functions(names.chain(composed).chain(of_positions));
        let compositions = compositions.iter();
        let compositions = compositions.map(|&each| ComposedFunction::new(model, &functions, each));
        Self {
            name: model.name.clone(),
            description: model.description.clone(),
            remarks: vec![],
            coordinates: model.coordinates.len(),
            positions: model.position_count(),
            inputs: model.inputs().count(),
            driven: model.driven.len(),
            joint_positions: constants::joint_positions(model),
            constants: [constants::all(model), vec![list]].concat(),
            parameters: model.parameters.clone(),
            substeps: has_substeps.then(|| constants::substeps(model)),
            compositions: compositions.collect(),
            functions,
            lanes: vec![],
            self_tests: vec![],
        }
    }

    /// Whether the robot has joints with quaternions.
    #[must_use]
    pub fn has_quaternions(&self) -> bool {
        self.positions != self.coordinates
    }

    /// Names and numbers of operations of all functions, in order. Functions with unknown numbers are left
    /// out.
    #[must_use]
    pub fn costs(&self) -> Vec<(String, Cost)> {
        let functions = self.functions.iter();
        let functions = functions.map(|each| (each.name.clone(), each.cost()));
        let compositions = self.compositions.iter();
        let compositions =
            compositions.filter_map(|each| Some((each.composition.name().to_owned(), each.cost?)));
        functions.chain(compositions).collect()
    }
}

impl ComposedFunction {
    fn new(model: &Model, functions: &[Function], composition: Composition) -> Self {
        let other = catalogue::otherwise(model, composition.name()).filter_map(|said| said.equation).last();
        // Operations of the texts for quaternions are not counted, except their calls.
        let cost = composition.cost_in(model, functions).filter(|_| model.quaternion_joints.is_empty());
        let calls = match composition.call_count(model.options.substeps.unwrap_or(1)) {
            1 => "one call".to_owned(),
            count => format!("{count} calls"),
        };
        let callee = composition.calls();
        let cost_text = match cost {
            Some(cost) => {
                let text = format!("Cost: {cost}, {calls} of `{callee}` included.");
                let note = composition.cost_note(model, functions);
                [Some(text), note].into_iter().flatten().collect::<Vec<_>>().join(" ")
            }
            None => format!("Cost: {calls} of `{callee}`, and operations that are not counted."),
        };
        Self {
            composition,
            equation: other.unwrap_or(composition.equation()),
            has_quaternions: !model.quaternion_joints.is_empty(),
            results: composition.results(model),
            cost,
            cost_text,
        }
    }
}
