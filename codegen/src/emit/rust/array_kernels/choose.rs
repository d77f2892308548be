/// `chosen` where the mask has its bits, `other` where not.
#[inline(always)]
fn choose(mask: u64, chosen: f64, other: f64) -> f64 {
    f64::from_bits((chosen.to_bits() & mask) | (other.to_bits() & !mask))
}
