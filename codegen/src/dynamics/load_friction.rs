//! Friction that grows with the load of a gear: `|τ_l| s₁(ẏ)` in addition to the friction s₀(ẏ) of the velocity
//! alone (Hamon, Gautier and Garrec 2010).
//!
//! The load τ_l of a joint is what its drive would exert without friction, `M ÿ + k − q` with gravity and
//! springs alone in q. A drive exerts
//!
//! ```text
//! τ_j = τ_l + s₀ + |τ_l| s₁ = s₀ + (1 + s₁ sign τ_l) τ_l
//! ```
//!
//! which grows with τ_l where |s₁| < 1. So `w = τ_j − s₀` has the sign of the load, and
//!
//! ```text
//! τ_l = w / (1 + s₁ sign w)
//! ```
//!
//! solves it joint by joint, before the accelerations are known. Both have a kink where the load vanishes:
//! there sign is 0, and the derivatives 1 of both, between those of either side, are inverse to each other.

use super::forces::friction_sum;
use crate::graph::{Graph, Scalar};
use crate::model::Model;
use gelenk_formula::Function;

/// Whether friction of a joint grows with its load.
pub fn is_there(model: &Model) -> bool {
    model.joints().any(|joint| !joint.load_friction.is_empty())
}

/// s₁ by coordinate: the part of the load that becomes friction.
pub fn shares<'g>(graph: &'g Graph, model: &Model, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    let joints = model.joints().enumerate();
    let share =
        joints.map(|(index, joint)| friction_sum(graph, &joint.load_friction, y.get(index), v[index]));
    share.collect()
}

/// `|τ_l| s₁`
pub fn friction<'g>(load: Scalar<'g>, share: Scalar<'g>) -> Scalar<'g> {
    load.call(Function::Abs) * share
}

/// `1 + s₁ sign τ_l`: what the drive has to exert for one more unit of load. The argument may be the load, or
/// the drive's force beyond s₀.
pub fn gain<'g>(load: Scalar<'g>, share: Scalar<'g>) -> Scalar<'g> {
    load.constant(1.0) + share * load.call(Function::Sign)
}

/// τ_l from `w`, the drive's force beyond s₀.
pub fn load<'g>(exerted: Scalar<'g>, share: Scalar<'g>) -> Scalar<'g> {
    exerted.divided_by(gain(exerted, share))
}
