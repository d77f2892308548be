//! Bounds of a problem, and initial values of slacks and multipliers.

use super::super::lanes::{Vector, flat_mut, vectorized};
use super::super::multipliers::Multipliers;
use super::Bounds;
use super::side::Softening;

/// Smallest distance between two bounds for the start of the method. Closer bounds are treated as if they had this
/// distance.
const MIN_WIDTH: f64 = 1e-6;

/// Smallest slack at the start, relative to the violation of the bound or of the opposite bound.
const VIOLATION_SHARE: f64 = 0.1;

impl<V: Vector> Bounds<V> {
    /// Sets the bounds of number `i` of the padded variables. `penalty` are the penalty weights `(w₁, w₂)` of soft
    /// bounds; `None` for hard bounds. Infinite bounds become inactive.
    pub(in crate::qp) fn set(&mut self, i: usize, lower: f64, upper: f64, penalty: Option<(f64, f64)>) {
        let (lane, i) = (i / V::WIDTH, i % V::WIDTH);
        for (side, bound) in [(0, lower), (1, upper)] {
            let finite = bound.is_finite();
            let active = f64::from(u8::from(finite));
            let bound = if finite { bound } else { 0.0 };
            let s = &mut self.sides[lane][side];
            set_number(&mut s.bound, i, bound);
            set_number(&mut s.active, i, active);
            set_number(&mut s.relative, i, active / bound.abs().max(1.0));
            if let Some((w1, w2)) = penalty {
                let soft = &mut self.soft[lane][side];
                set_number(&mut soft.active, i, active);
                set_number(&mut soft.w1, i, w1);
                set_number(&mut soft.w2, i, w2);
            }
        }
    }

    /// Removes all softening, before the bounds of a new problem are set.
    pub(in crate::qp) fn harden(&mut self) {
        self.soft.fill([Softening::default(); 2]);
    }

    /// Gives all hard bounds the penalty `linear · v` of a violation v.
    pub(in crate::qp) fn soften(&mut self, linear: f64) {
        vectorized!(V, {
            for (sides, soft) in self.sides.iter().zip(&mut self.soft) {
                for (side, soft) in sides.iter().zip(soft) {
                    let hard = side.active * (V::one() - soft.active);
                    soft.w1 = (V::one() - hard) * soft.w1 + hard * V::splat(linear);
                    soft.active = side.active;
                    soft.relaxed = hard;
                }
            }
        })
    }

    /// Adds a quadratic cost with its minimum in the middle between the bounds. At a distance equal to their width, the
    /// cost is `size`. For a single bound b, the minimum is at the distance 1 + |b| into the bound.
    pub(in crate::qp) fn attract(&self, size: f64, weight: &mut [V], linear: &mut [V]) {
        vectorized!(V, {
            let (half, one) = (V::splat(0.5), V::one());
            for (i, [lower, upper]) in self.sides.iter().enumerate() {
                let both = lower.active * upper.active;
                let (of_lower, of_upper) = (lower.active - both, upper.active - both);
                let (l, u) = (lower.bound, upper.bound);
                let width = both * (u - l) + of_lower * (one + l.abs()) + of_upper * (one + u.abs());
                let middle = both * half * (l + u) + of_lower * (l + width) + of_upper * (u - width);
                let any = both + of_lower + of_upper;
                let width = width.fast_max(V::splat(MIN_WIDTH));
                let w = any * V::splat(size) / (width * width);
                weight[i] += w;
                linear[i] = w.mul_neg_add(middle, linear[i]);
            }
        })
    }

    /// Raises slacks and softenings whose product with their multiplier is below `least`, because they would
    /// block every step. The residual compensates the change.
    pub(in crate::qp) fn recentre(&mut self, least: f64) {
        vectorized!(V, {
            let least = V::splat(least);
            for (sides, softs) in self.sides.iter_mut().zip(&mut self.soft) {
                for (side, soft) in sides.iter_mut().zip(softs) {
                    let slack = side.slack.fast_max(least / side.multiplier);
                    side.slack = V::select_positive(side.active, slack, side.slack);
                    let t = soft.t.fast_max(least / soft.nu);
                    let t = V::select_positive(soft.active, t, soft.t);
                    soft.nu = soft.w2.mul_add(t - soft.t, soft.nu);
                    soft.t = t;
                }
            }
        })
    }

    /// Raises slacks to ten times the residual that remains after the variables move to `z`, because smaller slacks would
    /// block every step.
    pub(in crate::qp) fn loosen(&mut self, z: &[V]) {
        vectorized!(V, {
            let several = V::splat(10.0);
            for ((sides, softs), z) in self.sides.iter_mut().zip(&self.soft).zip(z) {
                let distances = [*z - sides[0].bound, sides[1].bound - *z];
                for ((side, soft), d) in sides.iter_mut().zip(softs).zip(distances) {
                    let residual = soft.active.mul_add(soft.t, d) - side.slack;
                    let least = side.active * several * residual.abs();
                    side.slack = side.slack.fast_max(least);
                }
            }
        })
    }

    /// Sets initial slacks and multipliers. A slack s is the distance of the variable `z` from its bound, but
    /// not less than the smaller of two values. The first value is `share` times the distance between the
    /// bounds (1 + |z| for a single bound). The second value is μ/λ with the initial product μ of slack and
    /// multiplier, and the multiplier λ of the last solution. The initial multiplier is `μ/s`.
    #[inline(always)]
    pub(super) fn start_as<const SOFT: bool>(
        &mut self,
        z: &[V],
        mu: f64,
        share: f64,
        far: bool,
        last: Option<&Multipliers<V>>,
    ) {
        let mu = V::splat(mu);
        for i in 0..self.sides.len() {
            let ([lower, upper], [soft_lower, soft_upper]) = (&mut self.sides[i], &mut self.soft[i]);
            let both = lower.active * upper.active;
            let width = both * (upper.bound - lower.bound) + (V::one() - both) * (V::one() + z[i].abs());
            let least = width.fast_max(V::splat(MIN_WIDTH)) * V::splat(share);
            let (below, above) = (z[i] - lower.bound, upper.bound - z[i]);
            // If two bounds are close to each other relative to their violation, slacks that only depend on the distance
            // between the bounds would be far too small.
            let least = least.fast_max(V::splat(VIOLATION_SHARE) * (-below.fast_min(above)));
            let [of_lower, of_upper] = last.map_or([V::zero(); 2], |last| last.0[i]);
            let at_most = |l: V| least.fast_min(mu / l.fast_max(V::splat(f64::MIN_POSITIVE)));
            lower.start::<SOFT>(soft_lower, [below, at_most(of_lower)], mu, far);
            upper.start::<SOFT>(soft_upper, [above, at_most(of_upper)], mu, far);
        }
    }
}

/// Writes one number of a lane.
fn set_number<V: Vector>(lane: &mut V, i: usize, value: f64) {
    flat_mut(core::slice::from_mut(lane))[i] = value;
}
