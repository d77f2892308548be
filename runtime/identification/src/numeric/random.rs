//! Random numbers from a seed: SplitMix64 (Steele, Lea, Flood 2014), with uniform and normal (Box–Muller) distributions.
//!
//! Random starts and synthetic data must be the same in every language and release. The default generator of a library does
//! not guarantee this.

/// SplitMix64 generator with 64 bits of state. It computes `state += 0x9E3779B97F4A7C15` before each output.
#[derive(Debug, Clone)]
pub(crate) struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// Starts the sequence that belongs to `seed`.
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Next 64 random bits.
    pub(crate) fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform number in [0, 1) with 53 random bits.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.bits53() / TWO_53
    }

    /// Returns a standard normal number `√(−2 ln u₁) cos 2π u₂` from two uniform numbers of the sequence.
    pub(crate) fn normal(&mut self) -> f64 {
        let u1 = (self.bits53() + 1.0) / TWO_53;
        let u2 = self.bits53() / TWO_53;
        (-2.0 * u1.ln()).sqrt() * (2.0 * std::f64::consts::PI * u2).cos()
    }

    /// Uniform integer in 0..`bound` (`bound` > 0). The bias of the product method is below 2⁻⁵³·bound.
    #[cfg(test)]
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((self.uniform() * bound as f64) as usize).min(bound.saturating_sub(1))
    }

    fn bits53(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64
    }
}

const TWO_53: f64 = 9_007_199_254_740_992.0;
