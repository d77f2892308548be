//! Generated robots as types: the traits that control and identification ask for, and the macros that
//! implement them.
//!
//! `gelenk-runtime` has the same module and macros under the same names.

#![cfg_attr(not(test), no_std)]

pub mod dynamics;
pub mod pseudo_inverse;
