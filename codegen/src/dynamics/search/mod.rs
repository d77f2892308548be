//! Search for the cheapest formulation of each quantity.

pub mod descent;
pub mod routes;
