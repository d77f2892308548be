//! The search for the cheapest way to write each quantity.

pub mod formulation;
pub mod routes;
