//! Functions of positions with quaternions, which do not form a vector space: ⊕, ⊖ and normalization.

use crate::layout::{Dimension, Extent};

/// A function of the positions of a robot with quaternions. Its text is the same for all these robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionFunction {
    /// Positions `y ⊕ d` after a displacement d from the positions y. d has one entry per velocity.
    Integrate,
    /// Displacement `to ⊖ from`, which leads from the positions `from` to the positions `to`.
    Difference,
    /// Derivatives of the positions `y ⊕ d` with respect to small motions of y and with respect to d.
    IntegrateDerivatives,
    /// Scales each quaternion of the positions to unit length.
    Normalize,
}

/// An argument or a result of a function of positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositionValue {
    /// Name of the argument or result.
    pub name: &'static str,
    /// Dimensions of the argument or result, outermost first.
    pub dimensions: &'static [Dimension],
    /// Meaning of the argument or result, for documentation.
    pub meaning: &'static str,
}

const POSITIONS: &[Dimension] = &[Dimension::Positions];
const VELOCITIES: &[Dimension] = &[Dimension::Velocities];
const SQUARE: &[Dimension] = &[Dimension::Velocities, Dimension::Velocities];

const fn value(name: &'static str, dimensions: &'static [Dimension], meaning: &'static str) -> PositionValue {
    PositionValue { name, dimensions, meaning }
}

impl PositionFunction {
    /// All functions of positions, in the order of the generated module.
    pub const ALL: [Self; 4] =
        [Self::Integrate, Self::Difference, Self::IntegrateDerivatives, Self::Normalize];

    /// Name of the generated function, for example `integrate`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Integrate => "integrate",
            Self::Difference => "difference",
            Self::IntegrateDerivatives => "integrate_derivatives",
            Self::Normalize => "normalize",
        }
    }

    /// First line of the function's documentation.
    pub(crate) fn summary(self) -> &'static str {
        match self {
            Self::Integrate => "Positions `y ⊕ d` after one second with the velocities d.",
            Self::Difference => {
                "Velocities `to ⊖ from` that lead from one position to another within one second."
            }
            Self::IntegrateDerivatives => "Derivatives of `integrate` along small motions.",
            Self::Normalize => "Brings every quaternion to unit length.",
        }
    }

    /// The function's equation in Unicode.
    pub(crate) fn equation(self) -> &'static str {
        match self {
            Self::Integrate => {
                "y ⊕ d: y + d for a joint with one position, q ⊗ exp(d/2) for a quaternion, X exp(d) on SE(3) for a floating body"
            }
            Self::Difference => "from ⊕ (to ⊖ from) = to",
            Self::IntegrateDerivatives => "(y ⊕ δy) ⊕ (d + δd) ≈ (y ⊕ d) ⊕ (∂/∂y δy + ∂/∂d δd)",
            Self::Normalize => "q / |q|",
        }
    }

    /// The function's arguments, with names, dimensions and meanings.
    #[must_use]
    pub fn arguments(self) -> Vec<PositionValue> {
        const Y: PositionValue = value("y", POSITIONS, "positions with quaternions of unit length");
        const D: PositionValue =
            value("d", VELOCITIES, "displacement: velocities times one second, in the frames of the bodies");
        match self {
            Self::Integrate | Self::IntegrateDerivatives => vec![Y, D],
            Self::Difference => {
                vec![
                    value("from", POSITIONS, "positions"),
                    value("to", POSITIONS, "positions after the displacement"),
                ]
            }
            Self::Normalize => vec![value("y", POSITIONS, "positions, changed in place")],
        }
    }

    /// The function's results; empty if the function changes its argument.
    #[must_use]
    pub fn results(self) -> Vec<PositionValue> {
        match self {
            Self::Integrate => vec![value("y ⊕ d", POSITIONS, "positions with quaternions of unit length")],
            Self::Difference => {
                vec![value("d", VELOCITIES, "the shortest displacement, with rotations of at most π")]
            }
            Self::IntegrateDerivatives => vec![
                value("∂/∂y", SQUARE, "the adjoint matrix of exp(−d)"),
                value("∂/∂d", SQUARE, "the right Jacobian of exp at d"),
            ],
            Self::Normalize => vec![],
        }
    }

    /// Notes of the function's documentation: method and limits.
    pub(crate) fn notes(self) -> &'static [&'static str] {
        match self {
            Self::Integrate => &["Quaternions keep their unit length, also after many steps."],
            Self::Difference => &["The quaternions q and −q are the same attitude."],
            Self::IntegrateDerivatives => {
                &["Both matrices depend only on d (Solà, Deray and Atchuthan 2018, sections III and IV)."]
            }
            Self::Normalize => {
                &["Returns `false` if a quaternion is zero or not finite, and replaces it by the identity."]
            }
        }
    }
}

/// Lengths of an argument's or result's dimensions for these numbers of position entries and velocities.
#[must_use]
pub fn extents(value: &PositionValue, positions: usize, velocities: usize) -> Vec<Extent> {
    let length = |dimension: &Dimension| match dimension {
        Dimension::Positions => positions,
        _ => velocities,
    };
    value.dimensions.iter().map(|dimension| Extent::new(*dimension, length(dimension))).collect()
}
