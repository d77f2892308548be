//! A function as loops over joints. It has its own loops, or its results are affine in the results of another
//! function.

use super::super::Program;
use super::{Affine, Arrays};

/// A function with loops over arrays.
#[derive(Debug, Clone, PartialEq)]
pub enum ArrayForm {
    /// The function has its own loops over joints.
    Steps(Arrays),
    /// The function is the linearization, which calls another function.
    Affine(Affine),
}

impl ArrayForm {
    /// The straight-line program with the same operations as the loops.
    #[must_use]
    pub fn unrolled(&self) -> Program {
        match self {
            Self::Steps(arrays) => arrays.unrolled(),
            Self::Affine(affine) => affine.unrolled(),
        }
    }

    /// The form with products and sums contracted to fused multiply-adds.
    #[must_use]
    pub fn fused(&self) -> Self {
        match self {
            Self::Steps(arrays) => Self::Steps(arrays.fused()),
            Self::Affine(affine) => Self::Affine(Affine { called: affine.called.fused(), ..affine.clone() }),
        }
    }

    /// The loops over joints. For the linearization, they are those of the called function.
    #[must_use]
    pub fn arrays(&self) -> &Arrays {
        match self {
            Self::Steps(arrays) => arrays,
            Self::Affine(affine) => &affine.called,
        }
    }
}
