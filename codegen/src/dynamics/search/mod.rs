//! The search for the cheapest way to write each quantity.

pub mod descent;
pub mod routes;
