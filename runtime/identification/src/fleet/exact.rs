//! Sums that do not depend on the order of their terms: integers of 128 bits in units of 2⁻⁷².

use super::super::error::{IdentificationError, Result};
use serde::{Deserialize, Serialize};

/// Number of binary digits after the point. The unit is 2⁻⁷² ≈ 2.1e-22. Floating-point numbers below 2⁻²⁰ lose digits.
const BITS: i32 = 72;
/// Bound of the integers. Sums stay below 2⁵⁴ ≈ 1.8e16.
const LARGEST: u128 = 1 << 126;

/// An exact number, stored as a multiple of 2⁻⁷².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(into = "(u32, i128)", try_from = "(u32, i128)")]
pub(super) struct Exact(i128);

impl Exact {
    /// The multiple that is nearest to a number.
    ///
    /// # Errors
    /// [`IdentificationError::Overflow`] if the number is not finite or too large. This happens if the units of the log are not
    /// SI units.
    pub(super) fn new(x: f64) -> Result<Self> {
        let scaled = (x * 2.0_f64.powi(BITS)).round_ties_even();
        if scaled.is_finite() && scaled.abs() < LARGEST as f64 {
            return Ok(Self(scaled as i128));
        }
        Err(too_large(x))
    }

    /// The exact sum of two numbers.
    ///
    /// # Errors
    /// [`IdentificationError::Overflow`] if the sum is too large.
    pub(super) fn plus(self, other: Self) -> Result<Self> {
        let sum = self.0.checked_add(other.0).filter(|sum| sum.unsigned_abs() < LARGEST);
        sum.map(Self).ok_or_else(|| too_large(self.value() + other.value()))
    }

    /// The nearest floating-point number.
    pub(super) fn value(self) -> f64 {
        self.0 as f64 * 2.0_f64.powi(-BITS)
    }
}

/// The number of trailing zero bits, and the rest. The rest of a floating-point number is short.
impl From<Exact> for (u32, i128) {
    fn from(Exact(units): Exact) -> Self {
        let zeros = if units == 0 { 0 } else { units.trailing_zeros() };
        (zeros, units >> zeros)
    }
}

impl TryFrom<(u32, i128)> for Exact {
    type Error = &'static str;

    fn try_from((zeros, rest): (u32, i128)) -> std::result::Result<Self, Self::Error> {
        let units = rest.checked_shl(zeros).filter(|units| units >> zeros == rest);
        let units = units.filter(|units| units.unsigned_abs() < LARGEST);
        units.map(Self).ok_or("a sum is too large")
    }
}

fn too_large(x: f64) -> IdentificationError {
    IdentificationError::Overflow { what: "a sum of products of the log".into(), largest: x.abs() }
}

#[cfg(test)]
mod tests {
    use super::super::super::numeric::random::SplitMix64;
    use super::*;

    fn numbers() -> Vec<f64> {
        let mut random = SplitMix64::new(3);
        let mut all: Vec<f64> =
            (0..500).map(|_| random.normal() * 10_f64.powf(20.0 * random.uniform() - 10.0)).collect();
        all.extend([0.0, 1.0, -1.0, 127.0, 128.0, -128.0, -129.0, 1e16, -1e16, 2e-22]);
        all
    }

    #[test]
    fn any_order_gives_the_same_sum() {
        let all: Vec<Exact> = numbers().iter().map(|x| Exact::new(*x).unwrap()).collect();
        let sum = |parts: &[Exact]| parts.iter().try_fold(Exact::default(), |a, b| a.plus(*b)).unwrap();
        let mut backwards = all.clone();
        backwards.reverse();
        let (left, right) = all.split_at(77);
        assert_eq!(sum(&all), sum(&backwards));
        assert_eq!(sum(&all), sum(right).plus(sum(left)).unwrap());
    }

    #[test]
    fn numbers_survive_their_bytes_and_keep_their_digits() {
        for x in numbers() {
            let exact = Exact::new(x).unwrap();
            assert!((exact.value() - x).abs() <= 1.1e-22, "{x}");
            let bytes = postcard::to_stdvec(&exact).unwrap();
            assert!(bytes.len() <= 10, "{x}: {bytes:?}");
            assert_eq!(postcard::from_bytes(&bytes), Ok(exact), "{x}: {bytes:?}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        for x in [f64::NAN, f64::INFINITY, 2e16, -1e300] {
            assert!(Exact::new(x).unwrap_err().to_string().contains("overflow"), "{x}");
        }
        let large = Exact::new(1.5e16).unwrap();
        assert!(large.plus(large).is_err());
        for parts in [(127, 3), (200, 1), (0, i128::MAX)] {
            assert!(Exact::try_from(parts).is_err());
        }
    }
}
