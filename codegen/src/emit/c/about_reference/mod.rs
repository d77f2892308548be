//! States relative to reference positions, for tools that only support vectors. Positions y are replaced by
//! small motions d with y = y_ref ⊕ d.
//!
//! The C texts of this module call only each other. They use the constants JOINT_POSITIONS, FIRST_POSITIONS and
//! FIRST_VELOCITIES of the generated module. Each text has an include guard, because the source for acados
//! may include the source for CasADi, which contains the same texts.

/// Text of `gelenk_about_blocks`: product of a matrix and a block-diagonal matrix with one block per joint.
pub(super) const BLOCKS: &str = include_str!("blocks.c");

/// Text of `gelenk_about_rows`: product of a block-diagonal matrix with one block per joint and a matrix.
pub(super) const ROWS: &str = include_str!("rows.c");

/// Text of `gelenk_about_rates`: rate ḋ of the small motion d from the reference, with its derivatives. Its
/// derivative with respect to the velocities is the inverse of the derivative of y ⊕ d with respect to d.
/// Therefore it is also the derivative of d = y ⊖ y_ref with respect to small motions of y.
pub(super) const RATES: &str = include_str!("rates.c");
