//! placeholder
/// pass
pub struct Pass;
/// opt
pub fn optimize() {}
