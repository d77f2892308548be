//! Reference values for tests of a module: pseudo-random states and the interpreter's results.

use crate::functions::function::Function;
use crate::layout::Dimension;
use crate::model::Model;
use crate::program::interpret::interpret;
use crate::random::Random;

/// Number of states at which each function is called.
pub(crate) const STATES: u64 = 2;

/// One call of a function, with the expected results.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfTest {
    /// Name of the called function.
    pub function: String,
    /// Arguments of the call, in the order of the function. Each is flat and row-major.
    pub arguments: Vec<Vec<f64>>,
    /// Expected results of the call, in the order of the function. Each is flat and row-major.
    pub results: Vec<Vec<f64>>,
}

/// Returns two calls of each function at pseudo-random states with fixed seeds. Free parameters have the values
/// of the description. A call is left out if a result is not finite, for example if the mass matrix is singular.
#[must_use]
pub fn self_tests(model: &Model, functions: &[Function]) -> Vec<SelfTest> {
    let described = model.parameters.iter().map(|parameter| parameter.default);
    let described: Vec<f64> = described.collect();
    let calls = functions.iter().flat_map(|function| (0..STATES).map(move |seed| (function, seed)));
    calls.filter_map(|(function, seed)| self_test(model, function, seed, &described)).collect()
}

fn self_test(model: &Model, function: &Function, seed: u64, parameters: &[f64]) -> Option<SelfTest> {
    let arguments = arguments(model, function, seed);
    let slices: Vec<&[f64]> = arguments.iter().map(Vec::as_slice).collect();
    let results = interpret(&function.program, &slices, parameters).ok()?;
    let is_finite = results.iter().flatten().all(|x| x.is_finite());
    is_finite.then(|| SelfTest { function: function.name.clone(), arguments, results })
}

/// Arguments of a function at a pseudo-random state, which the seed determines.
pub(crate) fn arguments(model: &Model, function: &Function, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Random::new(seed);
    let inputs = function.program.inputs.iter();
    inputs.map(|input| entries(model, input.extent.dimension, &mut random)).collect()
}

/// Pseudo-random entries of an argument. Positions lie within the limits, and no velocity is close to 0,
/// because friction may jump there.
pub(crate) fn entries(model: &Model, dimension: Dimension, random: &mut Random) -> Vec<f64> {
    match dimension {
        Dimension::Coordinates | Dimension::Positions => {
            let ranges = model.joints().map(|joint| joint.seeded_range());
            let values: Vec<f64> = ranges.map(|[low, high]| random.between(low, high)).collect();
            model.positions_by(&values)
        }
        Dimension::Velocities => {
            let velocities = model.joints().map(|_| random.either_side(0.1, 1.0));
            velocities.collect()
        }
        Dimension::Inputs => model.inputs().map(|_| random.either_side(0.1, 1.0)).collect(),
        Dimension::Wrenches => (0..6 * model.wrenches.len()).map(|_| random.either_side(0.1, 1.0)).collect(),
        Dimension::Driven => {
            let joints = model.driven_joints().map(|joint| joint.seeded_range());
            let mut entries = |[low, high]: [f64; 2]| {
                [random.between(low, high), random.either_side(0.1, 1.0), random.either_side(0.1, 1.0)]
            };
            joints.flat_map(&mut entries).collect()
        }
        Dimension::Joints | Dimension::Parameters | Dimension::Fixed => {
            unreachable!(
                "arguments belong to coordinates, velocities, inputs, wrenches and driven coordinates"
            )
        }
    }
}
