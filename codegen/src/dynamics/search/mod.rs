//! Search for the formulation of each quantity with the fewest operations. A formulation is one way to write
//! the equations.

pub mod descent;
pub mod routes;
