//! States about a reference: small motions d from reference positions, y = y_ref ⊕ d, for tools that know vectors alone.
//!
//! The texts call nothing of the module but each other, and read its constants JOINT_POSITIONS, FIRST_POSITIONS and
//! FIRST_VELOCITIES. Each has a guard, since the source for acados may include that for CasADi.

/// `gelenk_about_blocks`: a matrix times one with a block for each joint.
pub(super) const BLOCKS: &str = include_str!("blocks.c");

/// `gelenk_about_rows`: a matrix with a block for each joint times another one.
pub(super) const ROWS: &str = include_str!("rows.c");

/// `gelenk_about_rates`: the rate of d with its derivatives. That by the velocities is the inverse of the derivative of ⊕ by d,
/// and hence the derivative of d = y ⊖ y_ref by small motions of y.
pub(super) const RATES: &str = include_str!("rates.c");
