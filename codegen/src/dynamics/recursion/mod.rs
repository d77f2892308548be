//! Recursive equations over the bodies of a mechanism, from the base to the leaves and back.

pub mod articulated;
pub mod composite;
pub mod derivatives;
pub mod factorization;
pub mod frame_motion;
mod mirrored;
pub mod motion;
pub mod newton_euler;
pub mod placement;
pub mod quaternion;
pub(super) mod rotor;
mod shared_ratios;
