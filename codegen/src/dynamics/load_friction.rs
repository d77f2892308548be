//! Load-dependent friction `|τ_l| s₁(ẏ)`, which is added to the friction s₀(ẏ) without load (Hamon, Gautier
//! and Garrec 2010).
//!
//! The load τ_l of a joint is the drive's force without friction. It is `M ÿ + k − q` if q only includes
//! gravity and springs. The force of the drive is
//!
//! ```text
//! τ_j = τ_l + s₀ + |τ_l| s₁ = s₀ + (1 + s₁ sign τ_l) τ_l
//! ```
//!
//! This force increases with τ_l if |s₁| < 1. Therefore `w = τ_j − s₀` has the sign of the load. The load of
//! each joint can be computed before the accelerations are known:
//!
//! ```text
//! τ_l = w / (1 + s₁ sign w)
//! ```
//!
//! At zero load, τ_j as a function of τ_l and τ_l as a function of w have kinks. There `sign` is 0, so both
//! derivatives are 1. This value is between the one-sided limits.

use super::forces::friction_sum;
use crate::graph::{Graph, Scalar};
use crate::model::Model;
use gelenk_formula::Function;

/// Whether a joint of the model has load-dependent friction.
pub fn is_there(model: &Model) -> bool {
    model.joints().any(|joint| !joint.load_friction.is_empty())
}

/// Coefficient s₁ of load-dependent friction `|τ_l| s₁` of each coordinate (no unit). The load τ_l is the
/// drive's force minus all friction.
pub fn shares<'g>(graph: &'g Graph, model: &Model, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    let joints = model.joints().enumerate();
    let share =
        joints.map(|(index, joint)| friction_sum(graph, &joint.load_friction, y.get(index), v[index]));
    share.collect()
}

/// Load-dependent friction `|τ_l| s₁` at the load τ_l, with `share` = s₁. The load is the drive's force
/// without friction.
pub fn friction<'g>(load: Scalar<'g>, share: Scalar<'g>) -> Scalar<'g> {
    load.call(Function::Abs) * share
}

/// Derivative `1 + s₁ sign τ_l` of the drive's force with respect to the load τ_l, with `share` = s₁. `load`
/// may also be the drive's force minus the friction without load, because both have the same sign.
pub fn gain<'g>(load: Scalar<'g>, share: Scalar<'g>) -> Scalar<'g> {
    load.constant(1.0) + share * load.call(Function::Sign)
}

/// Load τ_l of a joint, the drive's force without friction. `exerted` is the drive's force minus the friction
/// without load.
pub fn load<'g>(exerted: Scalar<'g>, share: Scalar<'g>) -> Scalar<'g> {
    exerted.divided_by(gain(exerted, share))
}
