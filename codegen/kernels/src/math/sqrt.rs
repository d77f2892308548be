// Square root, correctly rounded, without branches on the usual path.
//
// `core` has no square root, so the instruction of the processor is not available without std. The results
// are the same. Newton's iteration for 1/√x starts from the bits of x. The remainder, computed in integers,
// determines the last digit.

/// Square root `√x`, correctly rounded. The result is NaN if x is negative or NaN.
#[inline]
pub fn sqrt(x: f64) -> f64 {
    if !(x > 0.0 && x < f64::INFINITY) {
        return if x < 0.0 { f64::NAN } else { x };
    }
    // Subnormal numbers are scaled by 2^54.
    let (x, scale) = if x < f64::MIN_POSITIVE {
        (x * 18_014_398_509_481_984.0, 7.450_580_596_923_828e-9)
    } else {
        (x, 1.0)
    };
    let (exponent, fraction) = (x.to_bits() >> 52, x.to_bits() & 0x000F_FFFF_FFFF_FFFF);
    // x = v 4^e with 1 ≤ v < 4, and v = mantissa / 2^52.
    let odd = (exponent & 1) ^ 1;
    let mantissa = (fraction | 0x0010_0000_0000_0000) << odd;
    let v = mantissa as f64 * 2.220_446_049_250_313e-16;
    // The initial value of 1/√v has a relative error of 3.4e-2. Each step squares the error and multiplies it
    // by 1.5.
    let half = 0.5 * v;
    let y = f64::from_bits(0x5FE6_EB50_C7B5_37A9_u64.wrapping_sub(v.to_bits() >> 1));
    let y = y * (1.5 - half * y * y);
    let y = y * (1.5 - half * y * y);
    let y = y * (1.5 - half * y * y);
    let y = y * (1.5 - half * y * y);
    // The root in units of 2^-52, as an integer. Its remainder is so small that 64 bits suffice.
    let remainder = |root: u64| {
        (mantissa << 52)
            .wrapping_sub(root.wrapping_mul(root))
            .cast_signed()
    };
    let near = (v * y * 4_503_599_627_370_496.0) as u64;
    let correction = remainder(near) as f64 * (y * 1.110_223_024_625_156_5e-16);
    let root = near.wrapping_sub(8).wrapping_add((correction + 8.0) as u64);
    let root = root.wrapping_sub(u64::from(remainder(root) < 0));
    let root = root.wrapping_add(u64::from(remainder(root.wrapping_add(1)) >= 0));
    // If v is above (root + 1/2)², the middle between two numbers, the larger number is nearer. The exact
    // root is never in the middle.
    let root = root.wrapping_add(u64::from(remainder(root) > root.cast_signed()));
    let exponent = exponent.wrapping_add(1023).wrapping_sub(odd) >> 1;
    f64::from_bits((exponent << 52).wrapping_add(root.wrapping_sub(0x0010_0000_0000_0000))) * scale
}
