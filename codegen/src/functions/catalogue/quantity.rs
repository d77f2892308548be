//! Row type of the catalogue of functions: arguments, results with dimensions, and derivation.

use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::matrix::Matrix;
use crate::dynamics::search::routes::Formulations;
use crate::functions::function::{ArgumentText, Constant, FrameKind, Function};
use crate::functions::positions;
use crate::graph::Scalar;
use crate::layout::{Dimension, Extent};
use crate::model::{Actuator, Joint, JointKind, Model, Wrench, WrenchAxes};
use crate::program::arrays::Arrays;
use crate::program::{InputArray, Program};
use crate::spatial::Pose;

/// An argument of a generated function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
    /// Positions y of the coordinates.
    Coordinates,
    /// Velocities ẏ of the coordinates.
    Velocities,
    /// Accelerations ÿ of the coordinates.
    Accelerations,
    /// Inputs u: motor torques, motor currents, or forces at frames.
    Inputs,
    /// Multipliers λ, one for each generalized force, in the Hessian of the inverse dynamics
    /// `λᵀ (M ÿ + k − q)`.
    Multipliers,
    /// Wrenches w that act at frames.
    Wrenches,
    /// Prescribed motion of the driven joints: position, velocity and acceleration of each.
    Driven,
}

use Argument::{Accelerations, Coordinates, Driven, Inputs, Multipliers, Velocities, Wrenches};

impl Argument {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Coordinates => "y",
            Velocities => "v",
            Accelerations => "a",
            Inputs => "u",
            Multipliers => "lambda",
            Wrenches => "w",
            Driven => "d",
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Coordinates => "coordinates",
            Velocities => "velocities ẏ",
            Accelerations => "accelerations ÿ",
            Inputs => "inputs",
            Multipliers => "multipliers λ, one for each force",
            Wrenches => "wrenches, each force [N], then moment about the origin of its frame [N m]",
            Driven => "driven motion: position, velocity and acceleration of each driven joint",
        }
    }

    /// Documentation of the argument for a model.
    pub(in crate::functions) fn text(self, model: &Model) -> ArgumentText {
        let by_joint = |units: [&'static str; 2]| {
            let entry = |joint: &Joint| {
                let row = usize::from(joint.kind == JointKind::Prismatic);
                (joint.name.clone(), units[row])
            };
            model.joints().map(entry).collect()
        };
        let entries = match self {
            Coordinates => position_entries(model),
            Velocities => by_joint(["rad/s", "m/s"]),
            Accelerations => by_joint(["rad/s²", "m/s²"]),
            Inputs => {
                let entry = |input: Actuator<'_>| (input.name().to_owned(), model.input_unit(input));
                model.inputs().map(entry).collect()
            }
            Multipliers => Vec::new(),
            Driven => {
                let unit = |joint: &Joint| match joint.kind {
                    JointKind::Prismatic => "m, m/s, m/s²",
                    _ => "rad, rad/s, rad/s²",
                };
                model.driven_joints().map(|joint| (joint.name.clone(), unit(joint))).collect()
            }
            Wrenches => {
                let axes = |wrench: &Wrench| match wrench.axes {
                    WrenchAxes::Frame => "the axes of its frame",
                    WrenchAxes::Base => "the axes of the base",
                };
                model.wrenches.iter().map(|wrench| (wrench.name.clone(), axes(wrench))).collect()
            }
        };
        let meaning = match self {
            Coordinates if !model.quaternion_joints.is_empty() => {
                "positions; quaternions are x y z w with unit length"
            }
            Velocities if !model.quaternion_joints.is_empty() => {
                "velocities v, written ẏ in equations; for a joint with a quaternion, linear and angular \
                 velocity in the frame of its body"
            }
            Accelerations if !model.quaternion_joints.is_empty() => "accelerations v̇, written ÿ in equations",
            _ => self.meaning(),
        };
        ArgumentText { meaning: meaning.to_owned(), entries }
    }

    pub(in crate::functions) fn extent(self, model: &Model) -> Extent {
        let velocities = Extent::new(Dimension::Velocities, model.coordinates.len());
        match self {
            Inputs => Extent::new(Dimension::Inputs, model.inputs().count()),
            Wrenches => Extent::new(Dimension::Wrenches, 6 * model.wrenches.len()),
            Driven => Extent::new(Dimension::Driven, 3 * model.driven.len()),
            Coordinates => {
                let dimension = match model.quaternion_joints.is_empty() {
                    true => Dimension::Coordinates,
                    false => Dimension::Positions,
                };
                Extent::new(dimension, model.position_count())
            }
            Velocities | Accelerations | Multipliers => velocities,
        }
    }
}

/// Names and units of the positions.
fn position_entries(model: &Model) -> Vec<(String, &'static str)> {
    let entries = positions::names(model).into_iter().zip(positions::units(model));
    entries.collect()
}

/// A result of a function as nodes of the expression graph.
pub struct Value<'g> {
    /// Lengths of the dimensions, rows first; empty for a scalar.
    pub(in crate::functions) lengths: Vec<usize>,
    pub(in crate::functions) entries: Vec<Scalar<'g>>,
}

pub(in crate::functions) fn scalar(x: Scalar<'_>) -> Value<'_> {
    Value { lengths: Vec::new(), entries: vec![x] }
}

pub(in crate::functions) fn vector(entries: Vec<Scalar<'_>>) -> Value<'_> {
    Value { lengths: vec![entries.len()], entries }
}

pub(in crate::functions) fn matrix(rows: Matrix<'_>) -> Value<'_> {
    Value { lengths: vec![rows.len(), rows.first().map_or(0, Vec::len)], entries: rows.concat() }
}

/// A result of a function: symbol, dimensions (rows first) and meaning.
pub(in crate::functions) type QuantityResult = (&'static str, &'static [Dimension], &'static str);

pub(in crate::functions) const SCALAR: &[Dimension] = &[];
pub(in crate::functions) const VECTOR: &[Dimension] = &[Dimension::Velocities];
pub(in crate::functions) const SQUARE: &[Dimension] = &[Dimension::Velocities, Dimension::Velocities];
pub(in crate::functions) const BY_INPUTS: &[Dimension] = &[Dimension::Velocities, Dimension::Inputs];
pub(in crate::functions) const PARAMETERS: &[Dimension] = &[Dimension::Parameters];
pub(in crate::functions) const REGRESSOR: &[Dimension] = &[Dimension::Velocities, Dimension::Parameters];
pub(in crate::functions) const IN_SPACE: &[Dimension] = &[Dimension::Fixed];
pub(in crate::functions) const ROTATION: &[Dimension] = &[Dimension::Fixed, Dimension::Fixed];
pub(in crate::functions) const FRAME_JACOBIAN: &[Dimension] = &[Dimension::Fixed, Dimension::Velocities];

/// Function that derives the results of a catalogue row from the equations of motion.
pub(in crate::functions) type Build = for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>;

/// Method to estimate the least number of operations of a function before its derivation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimate {
    /// Number of operations of the mass matrix, which grows with the square of the number of joints.
    MassMatrix,
    /// Ten columns of the regressor for each pair of a joint and a link that the joint moves. These ten
    /// columns have 39 operations for the UR5, and 75 for a chain of 30 joints with right angles between
    /// their axes.
    Regressor,
    /// Products and inverses of matrices. For n joints, they have 5.2 n³ operations for Talos, and 6.9 n³ for a
    /// chain of 60 joints with right angles between their axes.
    Inverse,
    /// Products for each pair of joints. Each pair has 83 operations for a chain of 60 joints with right angles
    /// between their axes.
    Pairs,
}

impl Estimate {
    pub(in crate::functions) const ALL: [Self; 4] =
        [Self::MassMatrix, Self::Regressor, Self::Inverse, Self::Pairs];
}

/// A row of the catalogue: a generated function, with documentation and derivation.
pub struct Quantity {
    /// Name of the function in generated modules.
    pub name: &'static str,
    pub(in crate::functions) summary: &'static str,
    pub(in crate::functions) equation: &'static str,
    pub(in crate::functions) arguments: &'static [Argument],
    pub(in crate::functions) results: &'static [QuantityResult],
    pub(in crate::functions) notes: &'static [&'static str],
    /// Function that adds sentences to the documentation if they depend on the model.
    pub(in crate::functions) describe: fn(&Model, &mut Function),
    pub(in crate::functions) build: Build,
    /// Note on the derivation that needs the fewest operations and was chosen for this reason; `None` without
    /// a note.
    pub(in crate::functions) route: fn(&Formulations<'_>) -> Option<&'static str>,
    /// Constants that are printed before the function.
    pub(in crate::functions) constants: fn(&Model, &Formulations<'_>, &Program) -> Vec<Constant>,
    /// Whether the function contains the derivative of friction with respect to the velocity. This derivative
    /// does not show jumps of a friction law.
    pub(in crate::functions) differentiates_friction: bool,
    /// Method to estimate the operations of straight-line code. `None` for functions that never have very many
    /// operations.
    pub(in crate::functions) straight_size: Option<Estimate>,
    /// Derivation of the function as loops over joints; `None` if the function is always straight-line code.
    pub(in crate::functions) loops: Option<Loops>,
}

/// Derivation of a function as loops over joints.
#[derive(Clone, Copy)]
pub(in crate::functions) enum Loops {
    /// The function has its own loops. `size` is the method to estimate the number of their operations.
    PerJoint { build: BuildLoops, size: Estimate, products: Option<Products> },
    /// The function calls another function. Its results are affine functions of the results of this other
    /// function.
    Affine { called: &'static str },
}

/// Derivation with loops only for products with the inverse mass matrix. All other code is straight-line
/// code.
#[derive(Clone, Copy)]
pub(in crate::functions) struct Products {
    pub build: BuildLoops,
    /// Name of the function that computes the matrices to be multiplied by the inverse mass matrix. If the
    /// straight-line code of these matrices is long, loops for the products are faster.
    pub beside: &'static str,
}

/// Function that derives loops over joints.
pub(in crate::functions) type BuildLoops =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>, Vec<InputArray>) -> Arrays;

impl Quantity {
    /// Default values of a row in the catalogue: a small function without constants.
    pub(in crate::functions) const PLAIN: Self = Self {
        name: "",
        summary: "",
        equation: "",
        arguments: &[],
        results: &[],
        notes: &[],
        describe: |_, _| (),
        build: |_, _| Vec::new(),
        route: |_| None,
        constants: |_, _, _| Vec::new(),
        differentiates_friction: false,
        straight_size: None,
        loops: None,
    };
}

/// Function that derives the results for a quantity of a named frame.
pub(in crate::functions) type FrameBuild =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>, usize, &Pose<Scalar<'g>>) -> Vec<Value<'g>>;

/// A row of the catalogue for one function of each named frame.
pub(in crate::functions) struct FrameQuantity {
    pub(in crate::functions) kind: FrameKind,
    pub(in crate::functions) summary: &'static str,
    pub(in crate::functions) equation: &'static str,
    pub(in crate::functions) arguments: &'static [Argument],
    pub(in crate::functions) results: &'static [QuantityResult],
    pub(in crate::functions) build: FrameBuild,
}
