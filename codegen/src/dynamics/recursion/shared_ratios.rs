//! Joints that follow a coordinate with equal ratios. Their forces are added before they are multiplied by
//! the ratio.

use crate::graph::Scalar;
use crate::kinematics::{Mechanism, Transmission};

/// Sums of forces on joints that follow the same coordinate with the same ratio, one sum for each such pair.
pub(super) struct SharedRatios<'g> {
    sums: Vec<SharedRatio<'g>>,
}

struct SharedRatio<'g> {
    coordinate: usize,
    ratio: Scalar<'g>,
    force: Scalar<'g>,
}

impl<'g> SharedRatios<'g> {
    /// Finds ratios with which several joints follow one coordinate. Ratios of ±1 are left out, because they
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

    /// Adds the generalized forces of a force along the motion of a joint. Terms whose ratio several joints
    /// share are collected until [`finish`](Self::finish).
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

    /// Multiplies the collected sums of forces by their ratios and adds the products to the generalized
    /// forces.
    pub(super) fn finish(self, generalized: &mut [Scalar<'g>]) {
        for SharedRatio { coordinate, ratio, force } in self.sums {
            generalized[coordinate] = generalized[coordinate] + force * ratio;
        }
    }
}

impl<'g> SharedRatio<'g> {
    /// Returns 1 for this coordinate and ratio, −1 for this coordinate and the negative ratio, otherwise
    /// `None`.
    fn sign(&self, coordinate: usize, ratio: Scalar<'g>) -> Option<f64> {
        match (coordinate == self.coordinate, ratio.edge()) {
            (true, edge) if edge == self.ratio.edge() => Some(1.0),
            (true, edge) if edge == (-self.ratio).edge() => Some(-1.0),
            _ => None,
        }
    }
}
