//! The robots of `models/` as generated Rust: plain functions on fixed-size arrays.
//!
//! `gelenk generate` writes this crate; `gelenk check` tells whether it is fresh.
#![no_std]

/// The robot `cart_pole`.
#[rustfmt::skip]
pub mod cart_pole;

/// The robot `double_pendulum`.
#[rustfmt::skip]
pub mod double_pendulum;

/// The robot `panda`.
#[rustfmt::skip]
pub mod panda;

/// The robot `powercube`.
#[rustfmt::skip]
pub mod powercube;

/// The robot `powercube_alpha`.
#[rustfmt::skip]
pub mod powercube_alpha;

/// The robot `powercube_alpha_parameters`.
#[rustfmt::skip]
pub mod powercube_alpha_parameters;

/// The robot `powercube_parameters`.
#[rustfmt::skip]
pub mod powercube_parameters;

/// The robot `powercube_six_axis`.
#[rustfmt::skip]
pub mod powercube_six_axis;

/// The robot `puma560`.
#[rustfmt::skip]
pub mod puma560;

/// The robot `schunk_lwa4p`.
#[rustfmt::skip]
pub mod schunk_lwa4p;

/// The robot `two_arm`.
#[rustfmt::skip]
pub mod two_arm;

/// The robot `ur5`.
#[rustfmt::skip]
pub mod ur5;
