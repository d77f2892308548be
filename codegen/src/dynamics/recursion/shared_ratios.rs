//! Joints that follow a coordinate with equal ratios. Their forces are added before they are multiplied by
//! the ratio.

use crate::graph::Scalar;
use crate::kinematics::{Mechanism, Transmission};

/// Sums of forces for each pair of coordinate and ratio that occurs several times.
pub(super) struct SharedRatios<'g> {
    sums: Vec<SharedRatio<'g>>,
}

struct SharedRatio<'g> {
    coordinate: usize,
    ratio: Scalar<'g>,
    force: Scalar<'g>,
}

impl<'g> SharedRatios<'g> {
    /// Finds the ratios of a mechanism that occur several times. Ratios of ±1 are left out, because they
    /// require no product.
    pub(super) fn of(mechanism: &Mechanism<Scalar<'g>>) -> Self {
        let zero = mechanism.graph.constant(0.0);
        let terms = mechanism.bodies.iter().flat_map(|body| &body.transmission.terms);
        let terms = terms.filter(|term| term.ratio.value().is_none_or(|ratio| ratio.abs() != 1.0));
        let (mut once, mut several): (Vec<(usize, Scalar<'g>)>, Vec<SharedRatio<'g>>) = (vec![], vec![]);
        for term in terms {
            let (coordinate, ratio) = (term.coordinate, term.ratio);
            if several.iter().any(|sum| sum.sign(coordinate, ratio).is_some()) {
                continue;
            }
            let sum = SharedRatio { coordinate, ratio, force: zero };
            match once.iter().any(|(of, other)| sum.sign(*of, *other).is_some()) {
                true => several.push(sum),
                false => once.push((coordinate, ratio)),
            }
        }
        Self { sums: several }
    }

    /// Adds the generalized forces of a force along the motion of a joint. Terms with a shared ratio are
    /// collected until [`finish`](Self::finish).
    pub(super) fn add_force(
        &mut self,
        moved: &Transmission<Scalar<'g>>,
        force: Scalar<'g>,
        generalized: &mut [Scalar<'g>],
    ) {
        for term in &moved.terms {
            let mut sums = self.sums.iter_mut();
            let shared = sums.find_map(|sum| Some((sum.sign(term.coordinate, term.ratio)?, sum)));
            match shared {
                Some((sign, sum)) => sum.force = sum.force + force.signed(sign),
                None => {
                    let sum = &mut generalized[term.coordinate];
                    *sum = *sum + force * term.ratio;
                }
            }
        }
    }

    /// Multiplies the collected sums by their ratios and adds the products.
    pub(super) fn finish(self, generalized: &mut [Scalar<'g>]) {
        for SharedRatio { coordinate, ratio, force } in self.sums {
            generalized[coordinate] = generalized[coordinate] + force * ratio;
        }
    }
}

impl<'g> SharedRatio<'g> {
    /// Returns 1 if the term has this coordinate and ratio, −1 if it has the negative ratio, otherwise
    /// `None`.
    fn sign(&self, coordinate: usize, ratio: Scalar<'g>) -> Option<f64> {
        match (coordinate == self.coordinate, ratio.edge()) {
            (true, edge) if edge == self.ratio.edge() => Some(1.0),
            (true, edge) if edge == (-self.ratio).edge() => Some(-1.0),
            _ => None,
        }
    }
}
