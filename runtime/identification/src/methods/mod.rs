//! Regression methods: libraries of terms, sparse selection, the Stribeck law, derivatives of signals, and standard errors.

pub(crate) mod confidence;
pub(crate) mod constrained;
pub mod cross_validation;
pub mod differentiation;
pub(crate) mod expression;
pub(crate) mod filter;
pub(crate) mod filtered;
pub mod lasso;
pub mod least_squares;
pub mod library;
pub(crate) mod margin;
pub mod moments;
pub(crate) mod offset;
pub mod stribeck;
pub mod subset;
pub mod thresholding;
