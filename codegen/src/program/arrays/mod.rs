//! Array form of a program: the same operations as loops over the joints.
//!
//! Straight-line code grows with the square and the cube of the number of joints and exceeds a processor's
//! caches. The array form has a straight-line *setup* that grows like n. *Steps* over arrays follow. Each row
//! of an array has one entry per joint, and the code of the steps hardly grows with n. [`Arrays::unrolled`]
//! converts the steps to a straight-line program. This program defines the meaning of the steps, operation by
//! operation in order, so interpreter, counts and texts need no knowledge of arrays.

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
