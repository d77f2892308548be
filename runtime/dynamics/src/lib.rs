//! Generated robots as types: traits used by control and identification, and macros that implement them.
//!
//! `gelenk-runtime` re-exports this crate under the same names.

#![cfg_attr(not(test), no_std)]

pub mod dynamics;
pub mod pseudo_inverse;
