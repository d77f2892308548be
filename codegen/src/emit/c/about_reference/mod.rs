//! States relative to a reference: small motions d from reference positions, y = y_ref ⊕ d, for tools that
//! only support vectors.
//!
//! The texts call only each other, and use the module's constants JOINT_POSITIONS, FIRST_POSITIONS and
//! FIRST_VELOCITIES. Each has a guard, because the source for acados may include the source for CasADi.

/// `gelenk_about_blocks`: a matrix times a block-diagonal matrix with a block per joint.
pub(super) const BLOCKS: &str = include_str!("blocks.c");

/// `gelenk_about_rows`: a block-diagonal matrix with a block per joint times a matrix.
pub(super) const ROWS: &str = include_str!("rows.c");

/// `gelenk_about_rates`: rate of d with its derivatives. The derivative by the velocities is the inverse of
/// the derivative of ⊕ by d, and therefore the derivative of d = y ⊖ y_ref by small motions of y.
pub(super) const RATES: &str = include_str!("rates.c");
