//! Multipliers of bounds, as the solution stores them.

use super::lanes::{Vector, flat, flat_mut, vectorized};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Multipliers of the lower and upper bounds.
#[derive(Debug, Clone)]
pub(super) struct Multipliers<V>(pub(super) Vec<[V; 2]>);

impl<V: Vector> Multipliers<V> {
    pub(super) fn new(lanes: usize) -> Self {
        Self(vec![[V::zero(); 2]; lanes])
    }

    pub(super) fn clear(&mut self) {
        self.0.fill([V::zero(); 2]);
    }

    /// Multipliers of the lower and upper bounds, by lanes.
    #[inline(always)]
    pub(super) fn pairs(&self) -> impl Iterator<Item = &[V; 2]> {
        self.0.iter()
    }

    /// Mutable multipliers of the lower and upper bounds, by lanes.
    #[inline(always)]
    pub(super) fn lanes(&mut self) -> impl Iterator<Item = &mut [V; 2]> {
        self.0.iter_mut()
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.0.copy_from_slice(&other.0);
    }

    /// Subtracts the forces of the bounds, `λ_lower − λ_upper`, from a gradient.
    pub(super) fn subtract_from(&self, gradient: &mut [V]) {
        vectorized!(V, {
            for (g, [lower, upper]) in gradient.iter_mut().zip(&self.0) {
                *g += *upper - *lower;
            }
        })
    }

    /// Multipliers `[lower, upper]` of number `i` of the padded variables.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> [f64; 2] {
        let [lower, upper] = &self.0[i / V::WIDTH];
        [flat(core::slice::from_ref(lower))[i % V::WIDTH], flat(core::slice::from_ref(upper))[i % V::WIDTH]]
    }

    /// Sets the multipliers `[lower, upper]` of number `i` of the padded variables.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, values: [f64; 2]) {
        for (lane, value) in self.0[i / V::WIDTH].iter_mut().zip(values) {
            flat_mut(core::slice::from_mut(lane))[i % V::WIDTH] = value;
        }
    }

    /// Moves the multipliers of each stage `k + 1` to stage `k`. The stages have `stride` numbers each, and `count` numbers
    /// from `start` on together. The last stage is kept.
    pub(super) fn shift(&mut self, start: usize, stride: usize, count: usize) {
        for i in start..(start + count).saturating_sub(stride) {
            self.set(i, self.get(i + stride));
        }
    }
}
