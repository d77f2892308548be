//! A function in array form. It has its own steps, or its results are affine in the results of another
//! function.

use super::super::Program;
use super::{Affine, Arrays};

/// A function with loops over arrays.
#[derive(Debug, Clone, PartialEq)]
pub enum ArrayForm {
    /// The function has its own steps over arrays.
    Steps(Arrays),
    /// The function is the linearization, which calls another function.
    Affine(Affine),
}

impl ArrayForm {
    /// Equivalent straight-line program.
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

    /// The steps. For the linearization, these are the steps of the called function.
    #[must_use]
    pub fn arrays(&self) -> &Arrays {
        match self {
            Self::Steps(arrays) => arrays,
            Self::Affine(affine) => &affine.called,
        }
    }
}
