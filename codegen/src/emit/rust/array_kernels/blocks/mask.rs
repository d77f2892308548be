/// A bit mask for a selection: all bits are set if the condition is true. Compilers turn selections by `if`
/// into branches, and do not vectorize loops with branches.
#[inline(always)]
fn mask(condition: bool) -> u64 {
    u64::from(condition).wrapping_neg()
}
