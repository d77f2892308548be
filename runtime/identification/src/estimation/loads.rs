//! Load-dependent friction of a gear, `|τ_l| s₁(v)` (Hamon, Gautier, Garrec 2010), in the fit of all unknowns.
//!
//! The load τ_l of a gear is the force of the rigid body without friction. It depends on the estimated
//! values, so the term is not linear in the unknowns. The fit is repeated in passes. Each pass computes the
//! load with the values of the previous pass. The term is then a column like the other friction terms.

use super::super::error::{Place, Result};
use super::super::robot::Robot;
use super::layout::{ARMATURE, Layout};
use super::levels;
use super::result::{Estimate, Uncertain};
use nalgebra::DVector;

/// Largest number of passes. Loads are mostly gravity, which the first estimate determines to a few percent. Usually three
/// passes are enough.
pub(super) const PASSES: usize = 6;

/// Differences from the described robot that change the loads.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Loads {
    /// Estimated minus described inertial parameters.
    changes: Vec<f64>,
    /// Estimated reflected inertias in addition to the described ones [kg m² or kg].
    armatures: Vec<f64>,
    /// For each joint, whether it has a term of load-dependent friction.
    pub(super) joints: Vec<bool>,
}

impl Loads {
    /// Loads computed with the values of an estimate.
    ///
    /// # Errors
    /// [`IdentificationError::File`](crate::error::IdentificationError::File) if no moving joint with a measured effort has
    /// an input that drives it alone.
    pub(super) fn new(robot: &dyn Robot, layout: &Layout, found: &Estimate) -> Result<Self> {
        let own = robot.own_inputs();
        let joints: Vec<bool> = (0..layout.joints).map(|joint| layout.moves[joint] && own[joint]).collect();
        if !joints.contains(&true) {
            return Err(Place::default().fault(
                "load-dependent friction needs a moving joint with an input that drives only this joint. Leave out --load-friction",
            ));
        }
        let values = found.parameters.iter().zip(robot.parameters());
        let armature = |value: Option<Uncertain>| value.map_or(0.0, |value| value.value);
        Ok(Self {
            changes: values.map(|(found, described)| found.value - described).collect(),
            armatures: found.joints.iter().map(|joint| armature(joint.armature)).collect(),
            joints,
        })
    }

    /// Loads computed with the values of the unknowns of a fit, with load-dependent friction at some joints.
    pub(super) fn of(layout: &Layout, unknowns: &DVector<f64>, joints: &[usize]) -> Self {
        Self {
            changes: unknowns.rows(0, layout.parameters).iter().copied().collect(),
            armatures: (0..layout.joints).map(|j| unknowns[layout.term(j, ARMATURE)]).collect(),
            joints: (0..layout.joints).map(|j| joints.contains(&j)).collect(),
        }
    }

    /// Magnitude |τ_l| of the load of a joint's gear [N·m or N].
    ///
    /// - `rigid`: described force of the rigid body, including gravity
    /// - `row`: the joint's row of the regressor W, including gravity
    pub(super) fn magnitude(&self, joint: usize, rigid: f64, row: &[f64], acceleration: f64) -> f64 {
        let change: f64 = row.iter().zip(&self.changes).map(|(w, change)| w * change).sum();
        (rigid + change + self.armatures[joint] * acceleration).abs()
    }
}

/// Whether the load-dependent friction of two passes agrees within a fraction of the standard errors.
pub(super) fn settled(before: &Estimate, after: &Estimate) -> bool {
    before.joints.iter().zip(&after.joints).all(|(before, after)| match (&before.load, &after.load) {
        (None, None) => true,
        (Some(before), Some(after)) => {
            let (old, new) = (before.coefficient, after.coefficient);
            (new.value - old.value).abs() <= levels::SETTLED_LOADS.get() * new.standard_error
        }
        _ => false,
    })
}
