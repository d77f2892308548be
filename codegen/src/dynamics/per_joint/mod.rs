//! Jacobians of the inverse and forward dynamics in array form, that is as loops over joints. Spatial vectors
//! are in the base frame.
//!
//! In the base frame, every sum along a path or over a subtree is a sum of arrays. Each matrix entry of two
//! joints is a product of two columns with six or nine entries. The symbols are:
//!
//! - S: screw of a joint, the spatial velocity of the joint's body for a unit of the joint's velocity
//! - v, a: spatial velocity and acceleration of the joint's body
//! - Ψ̇ = v × S, Ψ̈ = a × S + v × Ψ̇
//! - I: composite inertia, the sum of the inertias of all bodies beyond the joint
//! - f: sum of the forces of these bodies
//! - 2B s = Σ 2 ∫ r ∧ (ω_s × ṙ) dm: force that the velocities ṙ of these bodies add for a motion s with the
//!   angular part ω_s
//!
//! For a joint j on the path from the base to joint i:
//!
//! ```text
//! M_ji = S_jᵀ I_i S_i = M_ij
//! ∂τ_j/∂ẏ_i = S_jᵀ (2B_i S_i + 2 I_i Ψ̇_i)          ∂τ_i/∂ẏ_j = S_iᵀ (2B_i S_j + 2 I_i Ψ̇_j)
//! ∂τ_j/∂y_i = S_jᵀ (2B_i Ψ̇_i + I_i Ψ̈_i + S_i ×* f_i)   ∂τ_i/∂y_j = S_iᵀ (2B_i Ψ̇_j + I_i Ψ̈_j)
//! ```
//!
//! The velocities of a joint with a quaternion are columns of one matrix S that is fixed in the joint's body.
//! In robots with such joints, Ψ̇ = v_λ × S and Ψ̈ = a_λ × S + v_λ × Ψ̇ use the motion of the joint's carrier
//! λ. In the derivatives with respect to ẏ, Ṡ = v × S with the motion of the body replaces one of the two Ψ̇.
//! Pairs within one joint use the formulas for j before i in both orders.
//!
//! The equations are those of Singh, Russell and Wensing (2022). B is computed from the moments 2 ∫ ṙ dm and
//! 2 ∫ ṙ rᵀ dm, which multiply only ω_s.

mod bodies;
mod builder;
mod joints;
mod moving;
mod products;
mod rotors;
mod rows;
mod setup;
mod tree;

use self::builder::ArrayBuilder;
use self::joints::{jacobians, joint_forces, mass_matrix, remaining_forces};
use self::moving::{Moving, accelerate, set_moving};
use self::setup::{Joints, Last, Setup, set_up};
use self::tree::LoopJoints;

use self::products::put_derivatives;
pub use self::products::{forward_dynamics_derivatives_by_products, products_are_possible};

use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::kinematics::{Mechanism, Number};
use crate::program::arrays::Arrays;
use crate::program::{InputArray, Shape};

/// Whether functions of a mechanism without prescribed motions can be written as loops over joints. This is
/// always possible if a joint follows another joint or has a quaternion. Otherwise each rotor must be on the
/// parent body of the joint that it turns with.
pub fn is_possible(mechanism: &Mechanism<Number>) -> bool {
    !mechanism.bodies.is_empty()
        && (mechanism.is_coupled() || mechanism.has_quaternions() || mechanism.rotors_are_neighbours())
}

/// Array form of the function `inverse_dynamics_derivatives`: straight-line code, then loops over joints.
pub fn inverse_dynamics_derivatives<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let (builder, _) = inverse_dynamics_and_jacobians(equations, arguments);
    builder.finish(equations.graph, inputs)
}

/// Array form of the function `inverse_dynamics_derivatives_and_mass_matrix`: straight-line code, then loops
/// over joints.
pub fn inverse_dynamics_derivatives_and_mass_matrix<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let (mut builder, moving) = inverse_dynamics_and_jacobians(equations, arguments);
    let mass = mass_matrix(&mut builder, &moving);
    let n = builder.each_coordinate();
    builder.output("M", Shape::Matrix(n, n), mass);
    builder.finish(equations.graph, inputs)
}

/// Begins an array form with the straight-line code before its loops.
fn begin<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    last: impl FnOnce() -> Last<'g>,
) -> (ArrayBuilder, Setup) {
    let mechanism = equations.mechanism();
    let loops = LoopJoints::new(&mechanism);
    let (coordinates, chains) = (loops.coordinates(&mechanism), loops.chains(&mechanism));
    let mut builder = ArrayBuilder::new(loops.tree.clone(), coordinates, chains);
    let joints = Joints { mechanism: &mechanism, loops: &loops };
    let setup = set_up(&mut builder, equations, &joints, arguments, last());
    (builder, setup)
}

/// Begins an array form with the inverse dynamics and their Jacobians. Also returns the arrays from which the
/// mass matrix is computed.
fn inverse_dynamics_and_jacobians<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
) -> (ArrayBuilder, Moving) {
    let (mut builder, setup) = begin(equations, arguments, || Last::Accelerations(arguments.a.clone()));
    let moving = set_moving(&mut builder, setup, true);
    let forces = joint_forces(&mut builder, &moving);
    builder.output("B u", Shape::Vector(builder.each_coordinate()), forces);
    let (by_coordinates, by_velocities) = jacobians(&mut builder, &moving);
    let n = builder.each_coordinate();
    builder.output("∂/∂y", Shape::Matrix(n, n), by_coordinates);
    builder.output("∂/∂ẏ", Shape::Matrix(n, n), by_velocities);
    (builder, moving)
}

/// Array form of the function `forward_dynamics_derivatives`: straight-line code, then loops over joints.
pub fn forward_dynamics_derivatives<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let driving = || equations.driving_forces(&arguments.y, &arguments.v, &arguments.u);
    let (mut builder, setup) = begin(equations, arguments, || Last::DrivingForces(driving()));
    let steady = set_moving(&mut builder, setup, false);
    let mass = mass_matrix(&mut builder, &steady);
    let inverse = builder.invert(mass, "inverse");
    let remaining = remaining_forces(&mut builder, &steady);
    let accelerations = builder.apply(inverse, remaining, "accelerations");
    let spread = builder.spread(accelerations, "accelerations_of_joints");
    let moving = accelerate(&mut builder, steady, spread);
    let (by_coordinates, by_velocities) = jacobians(&mut builder, &moving);
    put_derivatives(&mut builder, accelerations, inverse, [by_coordinates, by_velocities]);
    builder.finish(equations.graph, inputs)
}
