//! Inputs and states over the horizon, stored in lanes.

use super::lanes::{Vector, flat, flat_mut, lanes, largest, vectorized, zeros};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Inputs and states over the horizon. `u` has u_0 … u_{N−1} without padding between stages. `x` has x_1 …
/// x_N, each padded to whole lanes, and then the values of the rows of nodes 0 … N, padded in the same way
/// ([`super::rows`]).
#[derive(Debug, Clone)]
pub(crate) struct Trajectory<V> {
    pub(crate) u: Vec<V>,
    pub(crate) x: Vec<V>,
}

impl<V: Vector> Trajectory<V> {
    /// Zeros. `rows` is the number of lanes of the rows.
    pub(crate) fn new(horizon: usize, nx: usize, nu: usize, rows: usize) -> Self {
        Self { u: zeros(lanes::<V>(horizon * nu)), x: zeros(horizon * lanes::<V>(nx) + rows) }
    }

    /// Copies another trajectory of the same shape.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.u.copy_from_slice(&other.u);
        self.x.copy_from_slice(&other.x);
    }

    /// Sets all numbers to zero.
    pub(super) fn clear(&mut self) {
        self.u.fill(V::zero());
        self.x.fill(V::zero());
    }

    /// Whether an entry differs from that of another trajectory.
    pub(super) fn differs_from(&self, other: &Self) -> bool {
        flat(&self.u) != flat(&other.u) || flat(&self.x) != flat(&other.x)
    }

    /// Adds a step: `self += length · step`.
    pub(super) fn advance(&mut self, step: &Self, length: f64) {
        vectorized!(V, {
            let length = V::splat(length);
            for (z, d) in self.u.iter_mut().zip(&step.u) {
                *z = d.mul_add(length, *z);
            }
            for (z, d) in self.x.iter_mut().zip(&step.x) {
                *z = d.mul_add(length, *z);
            }
        })
    }

    /// Inner product `selfᵀ other`.
    pub(super) fn inner(&self, other: &Self) -> f64 {
        vectorized!(V, {
            let mut sum = V::zero();
            for (a, b) in self.u.iter().zip(&other.u).chain(self.x.iter().zip(&other.x)) {
                sum = a.mul_add(*b, sum);
            }
            sum.reduce_add()
        })
    }

    /// Largest magnitude of an input.
    pub(super) fn largest_input(&self) -> f64 {
        vectorized!(V, {
            let mut max = V::zero();
            for u in &self.u {
                max = max.fast_max(u.abs());
            }
            largest(max)
        })
    }

    /// Largest magnitude of a state or of a value of a row.
    pub(super) fn largest_state(&self) -> f64 {
        vectorized!(V, {
            let mut max = V::zero();
            for x in &self.x {
                max = max.fast_max(x.abs());
            }
            largest(max)
        })
    }

    /// Inputs `u_k` of stage k.
    #[inline(always)]
    pub(super) fn input<const NU: usize>(&self, k: usize) -> [f64; NU] {
        let mut u = [0.0; NU];
        u.copy_from_slice(&flat(&self.u)[k * NU..][..NU]);
        u
    }

    /// State `x_{k+1}` after stage k.
    #[inline(always)]
    pub(super) fn state<const NX: usize>(&self, k: usize) -> [f64; NX] {
        let x = lanes::<V>(NX);
        let mut state = [0.0; NX];
        state.copy_from_slice(&flat(&self.x[k * x..][..x])[..NX]);
        state
    }

    #[inline(always)]
    pub(super) fn set_input<const NU: usize>(&mut self, k: usize, value: &[f64; NU]) {
        flat_mut(&mut self.u)[k * NU..][..NU].copy_from_slice(value);
    }

    #[inline(always)]
    pub(super) fn set_state<const NX: usize>(&mut self, k: usize, value: &[f64; NX]) {
        let x = lanes::<V>(NX);
        flat_mut(&mut self.x[k * x..][..x])[..NX].copy_from_slice(value);
    }
}
