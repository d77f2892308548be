//! Conversion between several arrays and one array of vectors. Each number of a vector belongs to one array.

use crate::qp::lanes::{Vector, WIDTH, flat, flat_mut};

/// Writes entry k of array e to number e of vector k.
#[inline(always)]
pub(super) fn pack<V: Vector>(to: &mut [V], from: [&[f64]; WIDTH]) {
    let (fours, rest) = to.as_chunks_mut::<WIDTH>();
    let done = fours.len() * WIDTH;
    for (k, vectors) in fours.iter_mut().enumerate() {
        let mut rows = [V::zero(); WIDTH];
        for (row, from) in rows.iter_mut().zip(from) {
            flat_mut(core::slice::from_mut(row)).copy_from_slice(&from[WIDTH * k..][..WIDTH]);
        }
        V::transpose(&mut rows);
        *vectors = rows;
    }
    for (k, numbers) in flat_mut(rest).chunks_exact_mut(WIDTH).enumerate() {
        for (number, from) in numbers.iter_mut().zip(from) {
            *number = from[done + k];
        }
    }
}

/// Reverses [`pack`]: writes number e of vector k to entry k of array e.
#[inline(always)]
pub(super) fn unpack<V: Vector>(from: &[V], mut to: [&mut [f64]; WIDTH]) {
    let (fours, rest) = from.as_chunks::<WIDTH>();
    let done = fours.len() * WIDTH;
    for (k, vectors) in fours.iter().enumerate() {
        let mut rows = *vectors;
        V::transpose(&mut rows);
        for (row, to) in rows.iter().zip(&mut to) {
            to[WIDTH * k..][..WIDTH].copy_from_slice(flat(core::slice::from_ref(row)));
        }
    }
    for (k, numbers) in flat(rest).chunks_exact(WIDTH).enumerate() {
        for (number, to) in numbers.iter().zip(&mut to) {
            to[done + k] = *number;
        }
    }
}
