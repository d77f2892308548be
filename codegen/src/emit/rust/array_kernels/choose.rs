/// Selects `chosen` for the set bits of the mask, and `other` for all other bits.
#[inline(always)]
fn choose(mask: u64, chosen: f64, other: f64) -> f64 {
    f64::from_bits((chosen.to_bits() & mask) | (other.to_bits() & !mask))
}
