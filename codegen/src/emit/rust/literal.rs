//! Prints literals of Rust that have exactly the bits of the numbers.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::emit::options::Scalar;

impl Scalar {
    /// Tokens of the number type: `f64` or `f32`.
    pub(super) fn ty(self) -> TokenStream {
        match self {
            Self::F64 => quote!(f64),
            Self::F32 => quote!(f32),
        }
    }

    /// Literal of a number for an operand of `+ - * /`, an array entry or an argument.
    pub(super) fn literal(self, number: f64) -> TokenStream {
        self.signed(number, Suffix::None)
    }

    /// Literal of a number on which a method is called. It has its type as suffix, and is in parentheses if
    /// it is negative.
    pub(super) fn receiver(self, number: f64) -> TokenStream {
        let literal = self.typed(number);
        if number.is_sign_negative() { quote!((#literal)) } else { literal }
    }

    /// Literal of a number with its type as suffix, for places in which the type is not inferred.
    pub(super) fn typed(self, number: f64) -> TokenStream {
        self.signed(number, Suffix::Type)
    }

    fn signed(self, number: f64, suffix: Suffix) -> TokenStream {
        let magnitude = self.magnitude(number.abs(), suffix);
        let ty = self.ty();
        if number == f64::NEG_INFINITY {
            return quote!(#ty::NEG_INFINITY);
        }
        if number.is_sign_negative() && !number.is_nan() { quote!(-#magnitude) } else { magnitude }
    }

    fn magnitude(self, number: f64, suffix: Suffix) -> TokenStream {
        #[allow(clippy::cast_possible_truncation, reason = "f32 constants are the rounded f64 ones")]
        let (is_finite, is_nan, single) = match self {
            Self::F64 => (number.is_finite(), number.is_nan(), 0.0),
            Self::F32 => ((number as f32).is_finite(), number.is_nan(), number as f32),
        };
        let ty = self.ty();
        match (self, suffix) {
            _ if is_nan => quote!(#ty::NAN),
            _ if !is_finite => quote!(#ty::INFINITY),
            (Self::F64, Suffix::None) => shortest(&format!("{number:?}")),
            (Self::F64, Suffix::Type) => shortest(&format!("{number:?}_f64")),
            (Self::F32, Suffix::None) => shortest(&format!("{single:?}")),
            (Self::F32, Suffix::Type) => shortest(&format!("{single:?}_f32")),
        }
    }
}

#[derive(Clone, Copy)]
enum Suffix {
    None,
    Type,
}

/// Literal from the text `{:?}` of a finite, non-negative float, for example `0.1`, `1e-7` or `1e300`.
fn shortest(text: &str) -> TokenStream {
    text.parse::<Literal>()
        .map_or_else(|_| quote!(compile_error!("not a number")), |literal| quote!(#literal))
}

/// Hexadecimal literal of a number, for example `0x0123_4567_89ab_cdef`.
pub(super) fn hexadecimal(number: u64) -> TokenStream {
    let groups = [48, 32, 16, 0].map(|shift| format!("{:04x}", number >> shift & 0xffff));
    shortest(&format!("0x{}", groups.join("_")))
}

/// Whether clippy's lint `approx_constant` may treat a literal as a rounded constant of `core::f64::consts`.
///
/// The result is true for more numbers than clippy reports, because an unnecessary `allow` has no effect.
pub(super) fn resembles_constant(number: f64) -> bool {
    use core::f64::consts as c;
    let constants = [
        c::E,
        c::FRAC_1_PI,
        c::FRAC_1_SQRT_2,
        c::FRAC_2_PI,
        c::FRAC_2_SQRT_PI,
        c::FRAC_PI_2,
        c::FRAC_PI_3,
        c::FRAC_PI_4,
        c::FRAC_PI_6,
        c::FRAC_PI_8,
        c::LN_2,
        c::LN_10,
        c::LOG10_2,
        c::LOG10_E,
        c::LOG2_10,
        c::LOG2_E,
        c::PI,
        c::SQRT_2,
        c::TAU,
        1.618_033_988_749_895,
        0.577_215_664_901_532_9,
    ];
    constants.iter().any(|constant| (number.abs() - constant).abs() <= 1e-3 * constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_read_back_to_the_same_bits() {
        for number in [0.0, 0.1, 1e-7, 1e300, f64::MIN_POSITIVE, 5e-324, f64::MAX, 161.0, 9.80665] {
            let text = Scalar::F64.literal(number).to_string();
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
        }
    }

    #[test]
    fn signs_types_and_rounding() {
        let cases = [
            (Scalar::F64.literal(-0.5), "- 0.5"),
            (Scalar::F64.literal(-0.0), "- 0.0"),
            (Scalar::F64.receiver(-0.5), "(- 0.5_f64)"),
            (Scalar::F64.receiver(2.0), "2.0_f64"),
            (Scalar::F32.literal(0.1), "0.1"),
            (Scalar::F32.literal(9.806_65), "9.80665"),
            (Scalar::F32.literal(1e300), "f32 :: INFINITY"),
            (Scalar::F64.literal(f64::NEG_INFINITY), "f64 :: NEG_INFINITY"),
        ];
        for (tokens, expected) in cases {
            assert_eq!(tokens.to_string(), expected);
        }
    }

    #[test]
    #[allow(clippy::approx_constant, reason = "these are what is tested")]
    fn rounded_pi_resembles_pi() {
        assert!(resembles_constant(-3.14));
        assert!(resembles_constant(0.707_106_781_186_547_6));
        assert!(!resembles_constant(3.2));
    }
}
