//! Interface between generated modules and generic code: the traits [`Dynamics`], [`Differentiable`] and
//! [`Discretizable`], and macros that wrap a module in one line.
//!
//! Generated files have no dependencies, so they cannot implement a trait. The macro [`dynamics!`](crate::dynamics!) implements
//! the traits for a module. The methods call the generated functions.

mod at_rest;
#[doc(hidden)]
pub mod defaults;
mod dependent;
mod dependent_macro;
mod driven;
mod friction_law;
mod functions;
mod include_model;
mod input_matrix;
mod lanes;
mod load_friction;
mod macros;
mod manifold;
mod manifold_macro;
mod midpoint;
mod names;
mod parameters;
mod solve;
#[cfg(test)]
mod tests;
mod torque_speed;
mod traits;
mod types;

pub use at_rest::{JUST_MOVING, jumps, jumps_with};
#[doc(hidden)]
pub use defaults::linearize_along;
pub use dependent::{DependentJoint, LimitRows};
#[doc(hidden)]
pub use dependent::{NO_NAMES, NO_NUMBERS, NO_RANGES, NO_ROWS, count_rows, dependent_joints};
pub use driven::DrivenJoints;
#[doc(hidden)]
pub use driven::{NoDrivenJoints, at_rest_or_unknown, unknown, without_driven_joints};
#[doc(hidden)]
pub use friction_law::{FrictionLaw, FrictionLawWithDriven, FrictionLawWithParameters};
#[doc(hidden)]
pub use functions::{HasDerivatives, MadeOrElse, Missing, NO_SUBSTEPS, OrElse, Required, Yes, has};
#[doc(hidden)]
pub use input_matrix::{
    ALL_DRIVES, InputMatrix, InputMatrixWithDriven, InputMatrixWithParameters, InputRanges,
};
pub use lanes::{Instructions, Point};
#[doc(hidden)]
pub use lanes::{LinearizeLanes, NoLanes};
pub use load_friction::{load, under_load};
pub use manifold::{
    AttitudeError, QuaternionJoint, UNIT_LENGTH, plain_entries, plain_positions, position_rates,
};
#[doc(hidden)]
pub use manifold::{
    NO_POSITIONS, NO_WIDTHS, bracket, count_quaternions, difference, difference_derivatives, integrate,
    integrate_derivatives, neutral, normalize, positions_of, quaternion_joints,
};
pub use names::{Named, numbered};
pub use parameters::{NoFreeParameters, without_parameters};
pub use torque_speed::TorqueSpeedLine;
#[doc(hidden)]
pub use torque_speed::{count_lines, torque_speed_lines};
pub use traits::{Differentiable, Discretizable, Dynamics, PhaseSpace, Predictable};
#[doc(hidden)]
pub use types::OfResults;
pub use types::{
    Discretization, ForceDerivatives, ForceDerivativesAndMass, InputLimits, Limits, Linearization, Step,
};
