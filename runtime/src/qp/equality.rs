//! Equal bounds: fixed inputs, and states that must pass through a point.
//!
//! An interior-point method needs an interior, which a pair of equal bounds does not have. An input with equal bounds is
//! not a variable. It starts at its value, and a diagonal term far beyond all other terms keeps it there exactly
//! ([`Fixed`]). A state with equal bounds is an equality `x − b = 0` with a multiplier π of any sign. Each Newton step is
//! a step of the proximal method of multipliers,
//!
//! ```text
//!     π⁺ = π − W (x + dx − b)        that is, a term W in the diagonal and the force π − W (x − b) on x
//! ```
//!
//! with the weight W. The regularization 1/W vanishes at the optimum, where `dπ = 0` (Rockafellar, *Augmented
//! Lagrangians and applications of the proximal point algorithm in convex programming*, Math. Oper. Res. 1,
//! 1976; Friedlander, Orban, *A primal–dual regularized interior-point method for convex quadratic programs*,
//! Math. Program. Comput. 4, 2012).

use super::lanes::{Vector, flat_mut, largest, vectorized};
use super::multipliers::Multipliers;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Diagonal term of a fixed input, far beyond all weights and far from overflow.
const FIXING: f64 = 1e100;

/// Target values of some numbers of a vector, stored in lanes.
#[derive(Debug, Clone)]
struct Targets<V> {
    any: bool,
    /// 1 if a number has a target, 0 otherwise.
    active: Vec<V>,
    target: Vec<V>,
}

impl<V: Vector> Targets<V> {
    fn new(lanes: usize) -> Self {
        Self { any: false, active: vec![V::zero(); lanes], target: vec![V::zero(); lanes] }
    }

    fn clear(&mut self) {
        if self.any {
            self.any = false;
            self.active.fill(V::zero());
            self.target.fill(V::zero());
        }
    }

    fn set(&mut self, i: usize, target: f64) {
        self.any = true;
        flat_mut(&mut self.active)[i] = 1.0;
        flat_mut(&mut self.target)[i] = target;
    }

    /// Sets the numbers of a vector to their target values.
    fn place(&self, z: &mut [V]) {
        if self.any {
            vectorized!(V, {
                for ((z, active), target) in z.iter_mut().zip(&self.active).zip(&self.target) {
                    *z = (V::one() - *active) * *z + *target;
                }
            });
        }
    }
}

/// Inputs whose bounds are equal.
#[derive(Debug, Clone)]
pub(super) struct Fixed<V>(Targets<V>);

impl<V: Vector> Fixed<V> {
    pub(super) fn new(lanes: usize) -> Self {
        Self(Targets::new(lanes))
    }

    /// Removes all fixed inputs, before the bounds of a new problem are set.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Fixes number `i` of the inputs at `value`.
    pub(super) fn set(&mut self, i: usize, value: f64) {
        self.0.set(i, value);
    }

    /// Sets the fixed inputs to their values.
    pub(super) fn place(&self, u: &mut [V]) {
        self.0.place(u);
    }

    /// Sets the fixed inputs of a step to zero.
    pub(super) fn hold(&self, step: &mut [V]) {
        if self.0.any {
            vectorized!(V, {
                for (step, active) in step.iter_mut().zip(&self.0.active) {
                    *step = (V::one() - *active) * *step;
                }
            });
        }
    }

    /// Adds the diagonal terms of the fixed inputs.
    pub(super) fn weigh(&self, weight: &mut [V]) {
        if self.0.any {
            vectorized!(V, {
                for (weight, active) in weight.iter_mut().zip(&self.0.active) {
                    *weight = active.mul_add(V::splat(FIXING), *weight);
                }
            });
        }
    }

    /// Adds a linear cost that moves the minimum to the fixed values.
    pub(super) fn attract(&self, linear: &mut [V]) {
        if self.0.any {
            vectorized!(V, {
                for (linear, target) in linear.iter_mut().zip(&self.0.target) {
                    *linear = target.mul_add(V::splat(-FIXING), *linear);
                }
            });
        }
    }

    /// Moves the reduced gradient of fixed inputs to their multipliers. These multipliers can have any size.
    pub(super) fn absorb(&self, gradient: &mut [V], multipliers: &mut Multipliers<V>) {
        if self.0.any {
            vectorized!(V, {
                for ((g, active), [lower, upper]) in
                    gradient.iter_mut().zip(&self.0.active).zip(multipliers.lanes())
                {
                    *lower += *active * g.fast_max(V::zero());
                    *upper += *active * (-*g).fast_max(V::zero());
                    *g = (V::one() - *active) * *g;
                }
            });
        }
    }
}

/// States whose hard bounds are equal.
#[derive(Debug, Clone)]
pub(super) struct Equalities<V> {
    targets: Targets<V>,
    /// Weight W of the squared violation of an equality.
    weight: V,
    /// Multipliers π of the equalities.
    force: Vec<V>,
    /// Step of the multipliers of the equalities.
    step: Vec<V>,
}

impl<V: Vector> Equalities<V> {
    pub(super) fn new(lanes: usize) -> Self {
        Self {
            targets: Targets::new(lanes),
            weight: V::one(),
            force: vec![V::zero(); lanes],
            step: vec![V::zero(); lanes],
        }
    }

    /// Removes all equalities, before the bounds of a new problem are set.
    pub(super) fn clear(&mut self) {
        self.targets.clear();
    }

    /// Whether the problem has an equality.
    #[inline(always)]
    pub(super) fn any(&self) -> bool {
        self.targets.any
    }

    /// Requires that entry `i` of the padded states is `value`.
    pub(super) fn set(&mut self, i: usize, value: f64) {
        self.targets.set(i, value);
    }

    /// Sets the states to their values.
    pub(super) fn place(&self, x: &mut [V]) {
        self.targets.place(x);
    }

    /// Sets the weight W of the equalities, which is also their diagonal term in the Newton system.
    pub(super) fn cap_weights(&mut self, weight: f64) {
        self.weight = V::splat(weight);
    }

    /// Starts with zero multipliers, or with those of the last solution.
    pub(super) fn start(&mut self, last: Option<&Multipliers<V>>) {
        if !self.any() {
            return;
        }
        vectorized!(V, {
            self.force.fill(V::zero());
            let Some(last) = last else { return };
            for ((force, active), [lower, upper]) in
                self.force.iter_mut().zip(&self.targets.active).zip(last.pairs())
            {
                *force = *active * (*lower - *upper);
            }
        })
    }

    #[inline(always)]
    fn residual(&self, x: &[V], i: usize) -> V {
        self.targets.active[i] * (x[i] - self.targets.target[i])
    }

    /// Largest violation `|x − b|` of an equality between a state x and its value b, relative to b if |b|
    /// exceeds 1.
    pub(super) fn violation(&self, x: &[V]) -> f64 {
        if !self.any() {
            return 0.0;
        }
        vectorized!(V, {
            let mut max = V::zero();
            for i in 0..x.len() {
                let size = self.targets.target[i].abs().fast_max(V::one());
                max = max.fast_max(self.residual(x, i).abs() / size);
            }
            largest(max)
        })
    }

    /// Adds the weights W of the equalities to the diagonal terms.
    pub(super) fn weigh(&self, weight: &mut [V]) {
        if self.any() {
            vectorized!(V, {
                for (weight, active) in weight.iter_mut().zip(&self.targets.active) {
                    *weight = active.mul_add(self.weight, *weight);
                }
            });
        }
    }

    /// Adds diagonal terms and a linear cost, so that the minimum of the cost is near the required values of
    /// the states.
    pub(super) fn attract(&self, weight: &mut [V], linear: &mut [V]) {
        self.weigh(weight);
        if self.any() {
            vectorized!(V, {
                for (linear, target) in linear.iter_mut().zip(&self.targets.target) {
                    *linear = target.mul_neg_add(self.weight, *linear);
                }
            });
        }
    }

    /// Subtracts the forces `π − W (x − b)` from the gradient of a step, with the multipliers π, the weight
    /// W, the states x and their values b.
    pub(super) fn pull(&self, x: &[V], rhs: &mut [V]) {
        if self.any() {
            vectorized!(V, {
                for i in 0..rhs.len() {
                    let pull = self.residual(x, i).mul_neg_add(self.weight, self.force[i]);
                    rhs[i] = rhs[i] - pull;
                }
            });
        }
    }

    /// Derivative of the terms of the equalities along `dx` at `x + length · dx`.
    pub(super) fn slope(&self, x: &[V], dx: &[V], length: f64) -> f64 {
        if !self.any() {
            return 0.0;
        }
        vectorized!(V, {
            let mut sum = V::zero();
            for i in 0..dx.len() {
                let left = (self.targets.active[i] * dx[i]).mul_add(V::splat(length), self.residual(x, i));
                sum += (self.weight * left - self.force[i]) * dx[i];
            }
            sum.reduce_add()
        })
    }

    /// Computes the step of the multipliers for the step `dx` of the states.
    pub(super) fn corrector(&mut self, x: &[V], dx: &[V]) {
        if self.any() {
            vectorized!(V, {
                for i in 0..dx.len() {
                    let left = self.targets.active[i].mul_add(dx[i], self.residual(x, i));
                    self.step[i] = -(self.weight * left);
                }
            });
        }
    }

    /// Takes the step of the multipliers with this length.
    pub(super) fn advance(&mut self, length: f64) {
        if self.any() {
            vectorized!(V, {
                for (force, step) in self.force.iter_mut().zip(&self.step) {
                    *force = step.mul_add(V::splat(length), *force);
                }
            });
        }
    }

    /// Adds the multipliers of the equalities to those of the bounds.
    pub(super) fn multipliers(&self, out: &mut Multipliers<V>) {
        if self.any() {
            vectorized!(V, {
                for ([lower, upper], force) in out.lanes().zip(&self.force) {
                    *lower += force.fast_max(V::zero());
                    *upper += (-*force).fast_max(V::zero());
                }
            });
        }
    }

    /// The gap `Σ |π (x − b)|` of the equalities between states x and their values b, with the multipliers π
    /// from `multipliers`.
    pub(super) fn gap(&self, x: &[V], multipliers: &Multipliers<V>) -> f64 {
        if !self.any() {
            return 0.0;
        }
        vectorized!(V, {
            let mut sum = V::zero();
            for (i, [lower, upper]) in multipliers.pairs().enumerate() {
                sum += ((*lower - *upper) * self.residual(x, i)).abs();
            }
            sum.reduce_add()
        })
    }

    /// Removes all targets. Calls `bound` with the position and the value of each target, so that a pair of equal bounds
    /// can replace it.
    pub(super) fn release(&mut self, mut bound: impl FnMut(usize, f64)) {
        if self.any() {
            for i in 0..self.force.len() * V::WIDTH {
                if flat_mut(&mut self.targets.active)[i] == 1.0 {
                    bound(i, flat_mut(&mut self.targets.target)[i]);
                }
            }
            self.clear();
        }
    }
}
