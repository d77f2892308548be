//! Traits of robots for control and identification, and macros that implement these traits for generated modules.
//!
//! `gelenk-runtime` re-exports this crate under the same names.

#![cfg_attr(not(test), no_std)]

pub mod dynamics;
pub mod pseudo_inverse;
