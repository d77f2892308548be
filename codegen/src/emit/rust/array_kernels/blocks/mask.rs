/// Bits that choose where a condition holds. Compilers make branches of choices by `if`, and of loops with them single
/// operations instead of vectors.
#[inline(always)]
fn mask(condition: bool) -> u64 {
    u64::from(condition).wrapping_neg()
}
