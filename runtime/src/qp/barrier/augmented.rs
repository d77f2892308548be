//! Bounds in the method of multipliers (`interior_point::augmented`). They need neither slacks nor an interior.

use super::super::lanes::{Vector, largest, vectorized};
use super::super::multipliers::Multipliers;
use super::Bounds;
use super::side::{Side, Softening};

impl<V: Vector> Bounds<V> {
    /// Sets all multipliers to 0.
    pub(in crate::qp) fn start_augmented(&mut self) {
        for side in self.sides.iter_mut().flatten() {
            side.multiplier = V::zero();
        }
    }

    /// Sets the multipliers to those of another solution with the variables `z` for bounds that were active
    /// there. A bound was active if its multiplier exceeds `c` times the distance into the bound. The other
    /// multipliers become 0.
    pub(in crate::qp) fn recall(&mut self, c: f64, z: &[V], last: &Multipliers<V>) {
        vectorized!(V, {
            let c = V::splat(c);
            for ((sides, z), last) in self.sides.iter_mut().zip(z).zip(last.pairs()) {
                let distances = [*z - sides[0].bound, sides[1].bound - *z];
                for ((side, d), l) in sides.iter_mut().zip(distances).zip(*last) {
                    side.multiplier = side.active * V::select_positive(d.mul_neg_add(c, l), l, V::zero());
                }
            }
        })
    }

    /// Whether a multiplier is positive.
    pub(in crate::qp) fn is_active(&self) -> bool {
        vectorized!(V, {
            let most = self.sides.iter().flatten().fold(V::zero(), |max, side| max.fast_max(side.multiplier));
            largest(most) > 0.0
        })
    }

    /// Sets `weight` to the second derivatives of the terms of the bounds, and `rhs` to the gradient with their forces.
    /// Each term is piecewise quadratic. The piece is selected by `z`, or by the multiplier if `known` is true.
    pub(in crate::qp) fn augment(
        &self,
        w: f64,
        known: bool,
        z: &[V],
        gradient: &[V],
        weight: &mut [V],
        rhs: &mut [V],
    ) {
        vectorized!(V, {
            let w = V::splat(w);
            for (i, (sides, soft)) in self.sides.iter().zip(&self.soft).enumerate() {
                let [lower, of_lower] = sides[0].augmented(&soft[0], w, z[i] - sides[0].bound, known);
                let [upper, of_upper] = sides[1].augmented(&soft[1], w, sides[1].bound - z[i], known);
                weight[i] = of_lower + of_upper;
                rhs[i] = gradient[i] - lower + upper;
            }
        })
    }

    /// Derivative of the terms along `dz` at `z + length · dz`.
    pub(in crate::qp) fn slope(&self, w: f64, z: &[V], dz: &[V], length: f64) -> f64 {
        vectorized!(V, {
            let (w, length, mut sum) = (V::splat(w), V::splat(length), V::zero());
            for (i, (sides, soft)) in self.sides.iter().zip(&self.soft).enumerate() {
                let z = dz[i].mul_add(length, z[i]);
                let [lower, _] = sides[0].augmented(&soft[0], w, z - sides[0].bound, false);
                let [upper, _] = sides[1].augmented(&soft[1], w, sides[1].bound - z, false);
                sum += (upper - lower) * dz[i];
            }
            sum.reduce_add()
        })
    }

    /// Sets the multipliers to the forces at `z`.
    pub(in crate::qp) fn take_forces(&mut self, w: f64, z: &[V]) {
        vectorized!(V, {
            let w = V::splat(w);
            for (i, (sides, soft)) in self.sides.iter_mut().zip(&self.soft).enumerate() {
                let distances = [z[i] - sides[0].bound, sides[1].bound - z[i]];
                for ((side, soft), d) in sides.iter_mut().zip(soft).zip(distances) {
                    side.multiplier = side.augmented(soft, w, d, false)[0];
                }
            }
        })
    }
}

impl<V: Vector> Side<V> {
    /// The force at the distance `d` into the bound, and the increase of the force per unit of violation. The
    /// force is the positive part of `y = λ − W d` with the multiplier λ and the weight W. If y exceeds the
    /// linear penalty w₁ of a soft bound with the quadratic penalty w₂, the force is `w₁ + w₂ v` with the
    /// violation v = (y − w₁)/(w₂ + W).
    #[inline(always)]
    fn augmented(&self, soft: &Softening<V>, w: V, d: V, known: bool) -> [V; 2] {
        let y = d.mul_neg_add(w, self.multiplier);
        let piece = if known { self.multiplier } else { y };
        let beyond = soft.active * (piece - soft.w1);
        let share = soft.w2 / (soft.w2 + w);
        let kept = V::select_positive(piece, y, V::zero());
        let force = V::select_positive(beyond, (y - soft.w1).mul_add(share, soft.w1), kept);
        let stiffness = V::select_positive(beyond, share * w, V::select_positive(piece, w, V::zero()));
        [self.active * force, self.active * stiffness]
    }
}
