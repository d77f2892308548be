//! Elementary functions, discrete time and positions with quaternions. Each is available as code, and as text
//! that the generator pastes into modules.
//!
//! The interpreter of the generator and the runtime call the code. Generated modules contain the text
//! ([`math::Kernel::source`], [`discrete_time::Text::source`], [`manifold::Text::source`]). Therefore all
//! three agree bit for bit.

#![no_std]

pub mod discrete_time;
pub mod hash;
pub mod manifold;
pub mod math;
