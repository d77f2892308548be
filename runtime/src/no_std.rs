//! Replacements for items of the standard library in builds without `std`: types from `alloc`, and numeric functions
//! from `libm`.

pub(crate) use alloc::borrow::ToOwned;
pub(crate) use alloc::boxed::Box;
pub(crate) use alloc::string::String;
pub(crate) use alloc::vec::Vec;
pub(crate) use alloc::{format, vec};
pub(crate) use num_traits::Float as _;
