//! Seeded random numbers that are equal on every platform: SplitMix64 (Steele, Lea and Flood 2014), uniform numbers, and normally
//! distributed numbers by Box–Muller.
#![allow(dead_code, reason = "each program uses its own part")]

/// Random number generator SplitMix64 with 64 bits of state.
#[derive(Debug, Clone)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// A generator with this seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// A uniformly distributed number in the range from 0 to 1 (exclusive) with 53 bits.
    pub fn uniform(&mut self) -> f64 {
        self.bits53() / TWO_53
    }

    /// A standard normal number `√(−2 ln u₁) cos 2π u₂` from two uniform numbers u₁ and u₂.
    pub fn normal(&mut self) -> f64 {
        let u1 = (self.bits53() + 1.0) / TWO_53;
        let u2 = self.bits53() / TWO_53;
        (-2.0 * u1.ln()).sqrt() * (2.0 * std::f64::consts::PI * u2).cos()
    }

    fn bits53(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64
    }
}

const TWO_53: f64 = 9_007_199_254_740_992.0;
