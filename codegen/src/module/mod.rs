//! Module: the plain value between derivation and printing.
//!
//! A printer takes a [`Module`] and its own options alone. It asks no [`Model`] and derives nothing.

pub mod constants;

use crate::functions::catalogue;
use crate::functions::composition::{ComposedResult, Composition};
use crate::functions::function::{Constant, Function};
use crate::functions::position_functions::PositionFunction;
use crate::model::{Model, Parameter};
use crate::program::cost::Cost;
use crate::self_test::SelfTest;

/// A robot's module: everything that its text says, in the order of the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Name of the robot.
    pub name: String,
    /// Paragraphs of the description, may be empty.
    pub description: Vec<String>,
    /// Lines below the description of the robot, for readers of this module.
    pub remarks: Vec<String>,
    /// Number of coordinates and of velocities.
    pub coordinates: usize,
    /// Number of position entries: more than coordinates where joints have quaternions.
    pub positions: usize,
    /// Number of inputs.
    pub inputs: usize,
    /// Number of driven coordinates.
    pub driven: usize,
    /// Number of position entries of each joint; none if the positions are one for each coordinate.
    pub joint_positions: Vec<usize>,
    /// Names, units, limits, drives, gravity.
    pub constants: Vec<Constant>,
    /// Free parameters, an argument of every function if there are any.
    pub parameters: Vec<Parameter>,
    /// Functions with a program of their own, each after the constants that explain it.
    pub functions: Vec<Function>,
    /// The constant that functions of several steps read; none without such functions.
    pub substeps: Option<Constant>,
    /// Functions over a sample time, which call others.
    pub compositions: Vec<ComposedFunction>,
    /// Functions that are also written over eight states at once; each has such a form.
    pub lanes: Vec<String>,
    /// Calls with their results, for a test at the end; none without such a test.
    pub self_tests: Vec<SelfTest>,
}

/// A function that calls another one of its module.
#[derive(Debug, Clone, PartialEq)]
pub struct ComposedFunction {
    /// Which one.
    pub composition: Composition,
    /// The equation in Unicode.
    pub equation: &'static str,
    /// It is true if joints have quaternions.
    pub has_quaternions: bool,
    /// The results of the function.
    pub results: Vec<ComposedResult>,
    /// Its operations; none if the function that it calls is not in the module.
    pub cost: Option<Cost>,
    /// The sentence about the costs in the function's documentation.
    pub cost_text: String,
}

impl Module {
    /// The module of a model's functions: straight-line code without remarks, lanes and tests.
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

    /// Whether there are joints with quaternions.
    #[must_use]
    pub fn has_quaternions(&self) -> bool {
        self.positions != self.coordinates
    }

    /// Names and operations of all functions, in their order.
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
            None => format!("Cost: {calls} of `{callee}`, and its own operations."),
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
