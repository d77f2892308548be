//! Functions as loops over the joints (array form), with the same operations as straight-line code.
//!
//! The length of straight-line code grows with the square or cube of the number n of joints and exceeds a
//! processor's caches. The array form begins with straight-line code, the *setup*, whose length grows
//! linearly with n. *Steps* over arrays follow. Each row of an array has one entry per joint, and the code of
//! the steps hardly grows with n.
//!
//! [`Arrays::unrolled`] converts the steps to a straight-line program. This program defines the meaning of
//! the steps, operation by operation. Therefore the interpreter, the counts of operations and the printed
//! equations need no knowledge of arrays.

mod affine;
mod form;
mod steps;
mod tree;
mod unroll;
mod writer;

pub use affine::{Affine, Drift};
pub use form::ArrayForm;
pub use steps::{Array, ArrayId, ArrayOutput, Arrays, Map, Over, Pairs, Relation, Step};
pub use tree::{Coordinates, Tree};
