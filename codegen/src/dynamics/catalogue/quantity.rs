//! What a row of the catalogue says: arguments, results with their dimensions, how it is built.

use crate::dynamics::equations::{Equations, Formulations};
use crate::dynamics::function::{ArgumentText, Constant};
use crate::dynamics::matrix::Matrix;
use crate::dynamics::size::Estimate;
use crate::graph::Scalar;
use crate::layout::{Dimension, Extent};
use crate::model::{Drive, Joint, JointKind, Model};
use crate::program::arrays::Arrays;
use crate::program::{InputArray, Program};
use crate::spatial::Pose;

/// An argument of a generated function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
    /// y
    Coordinates,
    /// ẏ
    Velocities,
    /// ÿ
    Accelerations,
    /// u
    Inputs,
    /// λ
    Multipliers,
}

use Argument::{Accelerations, Coordinates, Inputs, Multipliers, Velocities};

impl Argument {
    pub(super) fn name(self) -> &'static str {
        match self {
            Coordinates => "y",
            Velocities => "v",
            Accelerations => "a",
            Inputs => "u",
            Multipliers => "lambda",
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Coordinates => "coordinates",
            Velocities => "velocities ẏ",
            Accelerations => "accelerations ÿ",
            Inputs => "inputs",
            Multipliers => "multipliers λ, one for each force",
        }
    }

    /// What its documentation says.
    pub(super) fn text(self, model: &Model) -> ArgumentText {
        let by_joint = |units: [&'static str; 2]| {
            let entry = |joint: &Joint| {
                let row = usize::from(joint.kind == JointKind::Prismatic);
                (joint.name.clone(), units[row])
            };
            model.joints().map(entry).collect()
        };
        let entries = match self {
            Coordinates => by_joint(["rad", "m"]),
            Velocities => by_joint(["rad/s", "m/s"]),
            Accelerations => by_joint(["rad/s²", "m/s²"]),
            Inputs => {
                let entry = |drive: &Drive| (drive.name.clone(), model.input_unit(drive));
                model.inputs().map(entry).collect()
            }
            Multipliers => Vec::new(),
        };
        ArgumentText {
            meaning: self.meaning().to_owned(),
            entries,
        }
    }

    pub(super) fn extent(self, model: &Model) -> Extent {
        let velocities = Extent::new(Dimension::Velocities, model.coordinates.len());
        match self {
            Inputs => Extent::new(Dimension::Inputs, model.inputs().count()),
            Coordinates => Extent::new(Dimension::Coordinates, model.coordinates.len()),
            Velocities | Accelerations | Multipliers => velocities,
        }
    }
}

/// Scalars of the arguments of a function.
pub struct Arguments<'g> {
    pub(in crate::dynamics) y: Vec<Scalar<'g>>,
    pub(in crate::dynamics) v: Vec<Scalar<'g>>,
    pub(in crate::dynamics) a: Vec<Scalar<'g>>,
    pub(in crate::dynamics) u: Vec<Scalar<'g>>,
    pub(in crate::dynamics) lambda: Vec<Scalar<'g>>,
}

/// A result in the making.
pub struct Value<'g> {
    /// Its lengths, rows first.
    pub(super) lengths: Vec<usize>,
    pub(super) entries: Vec<Scalar<'g>>,
}

pub(in crate::dynamics) fn scalar(x: Scalar<'_>) -> Value<'_> {
    Value {
        lengths: Vec::new(),
        entries: vec![x],
    }
}

pub(in crate::dynamics) fn vector(entries: Vec<Scalar<'_>>) -> Value<'_> {
    Value {
        lengths: vec![entries.len()],
        entries,
    }
}

pub(in crate::dynamics) fn matrix(rows: Matrix<'_>) -> Value<'_> {
    Value {
        lengths: vec![rows.len(), rows.first().map_or(0, Vec::len)],
        entries: rows.concat(),
    }
}

/// A result of a quantity: its symbol, what its dimensions are, rows first, and its meaning.
pub(in crate::dynamics) type QuantityResult = (&'static str, &'static [Dimension], &'static str);

pub(in crate::dynamics) const SCALAR: &[Dimension] = &[];
pub(in crate::dynamics) const VECTOR: &[Dimension] = &[Dimension::Velocities];
pub(in crate::dynamics) const SQUARE: &[Dimension] =
    &[Dimension::Velocities, Dimension::Velocities];
pub(in crate::dynamics) const BY_INPUTS: &[Dimension] = &[Dimension::Velocities, Dimension::Inputs];
pub(in crate::dynamics) const PARAMETERS: &[Dimension] = &[Dimension::Parameters];
pub(in crate::dynamics) const REGRESSOR: &[Dimension] =
    &[Dimension::Velocities, Dimension::Parameters];
pub(super) const IN_SPACE: &[Dimension] = &[Dimension::Fixed];
pub(super) const ROTATION: &[Dimension] = &[Dimension::Fixed, Dimension::Fixed];
pub(super) const FRAME_JACOBIAN: &[Dimension] = &[Dimension::Fixed, Dimension::Velocities];

/// How a quantity is built from the equations of motion.
pub(in crate::dynamics) type Build =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>;

/// A row of the catalogue.
pub struct Quantity {
    /// Name of the generated function.
    pub name: &'static str,
    pub(in crate::dynamics) summary: &'static str,
    pub(in crate::dynamics) equation: &'static str,
    pub(in crate::dynamics) arguments: &'static [Argument],
    pub(in crate::dynamics) results: &'static [QuantityResult],
    pub(in crate::dynamics) notes: &'static [&'static str],
    pub(in crate::dynamics) build: Build,
    /// Which of several derivations was cheapest, for the documentation.
    pub(in crate::dynamics) route: fn(&Formulations<'_>) -> Option<&'static str>,
    /// Constants that stand before the function.
    pub(in crate::dynamics) constants: fn(&Model, &Formulations<'_>, &Program) -> Vec<Constant>,
    /// Whether it divides by the pivots of the mass matrix.
    pub(in crate::dynamics) needs_inverse: bool,
    /// Operations that straight-line code takes at least, for robots that make it very large.
    pub(in crate::dynamics) straight_size: Option<Estimate>,
    /// How it is written as loops over joints, where it can be.
    pub(in crate::dynamics) loops: Option<Loops>,
}

/// A function as loops over joints.
#[derive(Clone, Copy)]
pub(in crate::dynamics) enum Loops {
    /// The loops of the function itself, and the operations that they stand for.
    PerJoint { build: BuildLoops, size: Estimate },
    /// Its results are affine in those of another function, which it calls.
    Affine { called: &'static str },
}

/// How loops over joints are built.
pub(in crate::dynamics) type BuildLoops =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>, Vec<InputArray>) -> Arrays;

impl Quantity {
    /// What a row does not say: nothing of it is large, and it needs nothing beside it.
    pub(in crate::dynamics) const PLAIN: Self = Self {
        name: "",
        summary: "",
        equation: "",
        arguments: &[],
        results: &[],
        notes: &[],
        build: |_, _| Vec::new(),
        route: |_| None,
        constants: |_, _, _| Vec::new(),
        needs_inverse: false,
        straight_size: None,
        loops: None,
    };
}

/// How a quantity of a named frame is built.
pub(super) type FrameBuild =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>, usize, &Pose<'g>) -> Vec<Value<'g>>;

/// A function of each named frame: `frame_<name>_<suffix>`.
pub(in crate::dynamics) struct FrameQuantity {
    pub(super) suffix: &'static str,
    pub(super) summary: &'static str,
    pub(super) equation: &'static str,
    pub(super) arguments: &'static [Argument],
    pub(super) results: &'static [QuantityResult],
    pub(super) build: FrameBuild,
}
