//! Array form of a program: the same operations as loops over the joints.
//!
//! Straight-line code grows with the square and the cube of the number of joints, and out of a processor's
//! caches. The array form keeps a straight-line *setup* that grows like n and goes on with *steps* over
//! arrays, one entry per joint in each row, whose code hardly grows at all. [`Arrays::unrolled`] writes the
//! steps out as a straight-line program: it defines what they mean, operation by operation in their order, so
//! that interpreter, counts and texts need to know nothing about arrays.

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
