//! Cost and residuals of a point that the solver can return, and the choice between two points.

use super::status::{KktResiduals, QpReport, QpStatus};

/// Cost and residuals of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Certificate {
    pub(super) cost: f64,
    pub(super) residuals: KktResiduals,
    /// Part of the gap: decrease of the cost by a Newton step along the remaining gradient.
    pub(super) decrease: f64,
    /// Largest allowed gap of a solution.
    pub(super) allowed: f64,
    /// Largest ratio of a residual to its tolerance. The ratio is at most 1 if the problem is solved, and infinite if a
    /// number is not finite.
    pub(super) merit: f64,
}

impl Certificate {
    /// Whether the tolerances are met.
    pub(super) fn holds(&self) -> bool {
        self.merit <= 1.0
    }

    /// Whether most of the gap is due to a gradient that exact Newton steps would have removed.
    pub(super) fn is_inexact(&self) -> bool {
        self.decrease > 0.5 * self.residuals.gap
    }

    /// Whether this point is better than `other` if neither point is a solution. If both points keep the hard bounds with
    /// the tolerance `feasibility`, the point with the lower cost is better. Otherwise the point with the smaller
    /// residuals is better.
    pub(super) fn is_better_than(&self, other: &Self, feasibility: f64) -> bool {
        let keeps = |point: &Self| point.merit.is_finite() && point.residuals.primal <= feasibility;
        if keeps(self) && keeps(other) { self.cost < other.cost } else { self.merit < other.merit }
    }

    /// Whether cost and residuals are finite.
    pub(super) fn is_finite(&self) -> bool {
        let r = &self.residuals;
        (self.cost + r.stationarity + r.primal + r.gap).is_finite()
    }

    pub(super) fn report(&self, status: QpStatus, iterations: usize) -> QpReport {
        QpReport { status, iterations, cost: self.cost, residuals: self.residuals }
    }
}

/// The largest allowed gap of a solution. It is `tolerance` times the cost, but at least `tolerance` times a small share of
/// the quadratic terms (which can cancel), and at least `negligible`.
pub(super) fn allowed_gap(tolerance: f64, cost: f64, quadratic: f64, negligible: f64) -> f64 {
    (tolerance * cost.abs().max(5e-5 * quadratic)).max(negligible)
}
