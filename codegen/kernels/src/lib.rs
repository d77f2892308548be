//! Elementary functions and discrete time, once: as code, and as the text that the generator pastes into modules.
//!
//! The interpreter of the generator and the runtime call the code; generated modules hold the text ([`math::Kernel::source`],
//! [`discrete_time::Text::source`], [`manifold::Text::source`]). All three therefore agree bit for bit.

#![no_std]

pub mod discrete_time;
pub mod hash;
pub mod manifold;
pub mod math;
