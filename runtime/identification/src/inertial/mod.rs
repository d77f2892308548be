//! Inertial parameters π of `W π = M ÿ + k − q_gravity`: those of bodies that can exist, and a payload's.
//!
//! π has ten numbers per body, all in the body's frame: m, m cₓ, m c_y, m c_z, then Ixx, Ixy, Iyy, Ixz, Iyz,
//! Izz about the frame's origin, in the order of a generated module's `INERTIAL_PARAMETER_NAMES`. Further parameters (rotor inertias) may stand behind those
//! of the bodies. A body exists with these numbers if and only if its pseudo-inertia `[[Σ, m c], [m cᵀ, m]]`,
//! `Σ = ½ tr(I) 1 − I`, is positive definite (Wensing, Kim, Slotine 2017).
//!
//! `consistent` minimizes a quadratic function over bodies that can exist.

pub(crate) mod consistent;
mod interior_point;
mod pseudo_inertia;
mod scaled;

pub(crate) use pseudo_inertia::PER_BODY;
pub use pseudo_inertia::margin;
pub(crate) use pseudo_inertia::{from_pseudo_inertia, pseudo_inertia};
#[cfg(test)]
pub(crate) use pseudo_inertia::{is_physically_consistent, tests as bodies};
