//! Violation, penalty and duality gap of a point with respect to the bounds.

use super::super::lanes::{Vector, largest, vectorized};
use super::super::multipliers::Multipliers;
use super::Bounds;

/// Distances to a bound below this value count as rounding. They are relative to the bound if its magnitude
/// exceeds 1.
pub(in crate::qp) const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl<V: Vector> Bounds<V> {
    /// Number of complementarity pairs, for example of a slack and its multiplier.
    pub(in crate::qp) fn count(&self) -> f64 {
        vectorized!(V, {
            let mut sum = V::zero();
            for (sides, soft) in self.sides.iter().zip(&self.soft) {
                for side in 0..2 {
                    sum += sides[side].active + soft[side].active;
                }
            }
            sum.reduce_add()
        })
    }

    /// Largest violation of a bound by `z`, relative to the bound if its magnitude exceeds 1; 0 if all bounds
    /// are kept. Only hard bounds are considered if `hard` is true.
    pub(in crate::qp) fn violation(&self, z: &[V], hard: bool) -> f64 {
        vectorized!(V, {
            let mut max = V::zero();
            for (i, ([lower, upper], z)) in self.sides.iter().zip(z).enumerate() {
                let mut excess = [lower.relative * (lower.bound - *z), upper.relative * (*z - upper.bound)];
                if hard {
                    for (excess, soft) in excess.iter_mut().zip(&self.soft[i]) {
                        *excess = (V::one() - soft.active + soft.relaxed) * *excess;
                    }
                }
                max = max.fast_max(excess[0]).fast_max(excess[1]);
            }
            largest(max)
        })
    }

    /// Clamps `z` to the bounds. Each result is exactly a bound or the given number.
    pub(in crate::qp) fn clip(&self, z: &mut [V]) {
        vectorized!(V, {
            for ([lower, upper], z) in self.sides.iter().zip(z) {
                *z = lower.active * z.fast_max(lower.bound) + (V::one() - lower.active) * *z;
                *z = upper.active * z.fast_min(upper.bound) + (V::one() - upper.active) * *z;
            }
        })
    }

    /// Cost of the violation of soft bounds by `z`. If `relaxed` is true, hard bounds that were softened are included.
    pub(in crate::qp) fn penalty(&self, z: &[V], relaxed: bool) -> f64 {
        vectorized!(V, {
            let less = V::splat(f64::from(u8::from(!relaxed)));
            let mut sum = V::zero();
            for (([lower, upper], soft), z) in self.sides.iter().zip(&self.soft).zip(z) {
                for (soft, excess) in soft.iter().zip([lower.bound - *z, *z - upper.bound]) {
                    let v = (soft.active - less * soft.relaxed) * excess.fast_max(V::zero());
                    sum += v * (soft.w1 + soft.w2 * v * V::splat(0.5));
                }
            }
            sum.reduce_add()
        })
    }

    /// Duality gap of the bounds at `z` with the given multipliers. Each term is the remainder of Fenchel's
    /// inequality: `φ(v) + φ*(λ) + λ d ≥ 0` for the distance `d` into the bound, its violation
    /// `v = max(−d, 0)` and the penalty φ. For a hard bound the term is `|λ d|`, so that a violation counts
    /// too.
    pub(in crate::qp) fn gap(&self, z: &[V], multipliers: &Multipliers<V>) -> f64 {
        vectorized!(V, {
            let mut sum = V::zero();
            for (i, z) in z.iter().enumerate() {
                let [lower, upper] = &self.sides[i];
                let distances = [*z - lower.bound, upper.bound - *z];
                for (side, d) in distances.into_iter().enumerate() {
                    let soft = &self.soft[i][side];
                    let (active, l) = (self.sides[i][side].active, multipliers.0[i][side]);
                    let rounding = V::splat(ROUNDING) * self.sides[i][side].bound.abs().fast_max(V::one());
                    let d = d - d.fast_max(-rounding).fast_min(rounding);
                    let hard = l.abs() * d.abs();
                    sum += active * (soft.active * soft.gap(l, d) + (V::one() - soft.active) * hard);
                }
            }
            sum.reduce_add()
        })
    }

    /// Largest linear penalty of a soft bound.
    pub(in crate::qp) fn steepest(&self) -> f64 {
        vectorized!(V, {
            let mut max = V::zero();
            for soft in self.soft.iter().flatten() {
                max = max.fast_max(soft.active * soft.w1);
            }
            largest(max)
        })
    }

    /// Multipliers of all bounds, zero for infinite bounds.
    pub(in crate::qp) fn multipliers(&self, out: &mut Multipliers<V>) {
        vectorized!(V, {
            for (out, sides) in out.0.iter_mut().zip(&self.sides) {
                for side in 0..2 {
                    out[side] = sides[side].active * sides[side].multiplier;
                }
            }
        })
    }
}
