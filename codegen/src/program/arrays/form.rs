//! A function over arrays, of its own steps or affine in another one's results.

use super::super::Program;
use super::{Affine, Arrays};

/// A function with loops over arrays.
#[derive(Debug, Clone, PartialEq)]
pub enum ArrayForm {
    /// Steps over arrays.
    Steps(Arrays),
    /// The linearization, which calls another function.
    Affine(Affine),
}

impl ArrayForm {
    /// The straight-line program that it stands for.
    #[must_use]
    pub fn unrolled(&self) -> Program {
        match self {
            Self::Steps(arrays) => arrays.unrolled(),
            Self::Affine(affine) => affine.unrolled(),
        }
    }

    /// The same with products and sums contracted into fused multiply-adds.
    #[must_use]
    pub fn fused(&self) -> Self {
        match self {
            Self::Steps(arrays) => Self::Steps(arrays.fused()),
            Self::Affine(affine) => Self::Affine(Affine { called: affine.called.fused(), ..affine.clone() }),
        }
    }

    /// The steps, of the function that is called where it is another one.
    #[must_use]
    pub fn arrays(&self) -> &Arrays {
        match self {
            Self::Steps(arrays) => arrays,
            Self::Affine(affine) => &affine.called,
        }
    }
}
