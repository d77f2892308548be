//! Elementary functions, discrete time and positions with quaternions. Each is available as code, and as text
//! that the generator pastes into modules.
//!
//! The runtime and the generator's interpreter call the code. Generated modules contain the text of the same code
//! ([`math::Kernel::source`], [`discrete_time::Text::source`], [`manifold::Text::source`]). Therefore the
//! interpreter, the runtime and the generated modules return the same bits.

#![no_std]

pub mod discrete_time;
pub mod hash;
pub mod manifold;
pub mod math;
