//! Cost and residuals of a point that the solver may return, and which of two points is worth more.

use super::status::{KktResiduals, QpReport, QpStatus};

/// Cost and residuals of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Certificate {
    pub(super) cost: f64,
    pub(super) residuals: KktResiduals,
    /// The part of the gap that is left of the gradient.
    pub(super) decrease: f64,
    /// The gap that a solution may have.
    pub(super) allowed: f64,
    /// Residuals divided by their tolerances: at most 1 if the problem is solved, infinite if a number is
    /// not finite.
    pub(super) merit: f64,
}

impl Certificate {
    /// True if the tolerances are met.
    pub(super) fn holds(&self) -> bool {
        self.merit <= 1.0
    }

    /// True if most of what is left is a gradient that exact Newton steps would have removed.
    pub(super) fn is_inexact(&self) -> bool {
        self.decrease > 0.5 * self.residuals.gap
    }

    /// True if this point is worth more than another one, which is not a solution either: the cheaper one where
    /// both keep the hard bounds to `feasibility`, and else the one with the smaller residuals.
    pub(super) fn is_better_than(&self, other: &Self, feasibility: f64) -> bool {
        let keeps = |point: &Self| point.merit.is_finite() && point.residuals.primal <= feasibility;
        if keeps(self) && keeps(other) { self.cost < other.cost } else { self.merit < other.merit }
    }

    /// True if every number is one.
    pub(super) fn is_finite(&self) -> bool {
        let r = &self.residuals;
        (self.cost + r.stationarity + r.primal + r.gap).is_finite()
    }

    pub(super) fn report(&self, status: QpStatus, iterations: usize) -> QpReport {
        QpReport { status, iterations, cost: self.cost, residuals: self.residuals }
    }
}

/// The gap of a solution: `tolerance` of the cost, or of a small share of its quadratic terms where they cancel;
/// at least `negligible`.
pub(super) fn allowed_gap(tolerance: f64, cost: f64, quadratic: f64, negligible: f64) -> f64 {
    (tolerance * cost.abs().max(5e-5 * quadratic)).max(negligible)
}
