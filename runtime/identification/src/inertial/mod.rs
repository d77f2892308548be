//! Inertial parameters π of `W π = M ÿ + k − q_g`, and the constraints of physically possible bodies. W is the regressor, M is
//! the mass matrix, k is the bias force, and q_g is the gravity force.
//!
//! π has ten numbers per body in the body's frame: mass m, first moments m cₓ, m c_y, m c_z, then the moments of inertia
//! Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the frame's origin, in the order of `INERTIAL_PARAMETER_NAMES` of a generated module.
//! Other parameters (rotor inertias) may follow the parameters of the bodies. A body is physically possible if and
//! only if its pseudo-inertia `[[Σ, m c], [m cᵀ, m]]` with `Σ = ½ tr(I) 1 − I` is positive definite (Wensing, Kim, Slotine
//! 2017).
//!
//! `consistent` minimizes a quadratic function over physically possible bodies.

pub(crate) mod consistent;
mod interior_point;
mod pseudo_inertia;
mod scaled;

pub(crate) use pseudo_inertia::PER_BODY;
pub use pseudo_inertia::margin;
pub(crate) use pseudo_inertia::{from_pseudo_inertia, pseudo_inertia};
#[cfg(test)]
pub(crate) use pseudo_inertia::{is_physically_consistent, tests as bodies};
