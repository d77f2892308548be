// Square root for f32, correctly rounded, computed in f32 and integers of 32 bits (with the method of
// sqrt.rs).

/// Square root `√x`, correctly rounded. The result is NaN if x is negative or NaN.
#[inline]
pub fn sqrt_f32(x: f32) -> f32 {
    if !(x > 0.0 && x < f32::INFINITY) {
        return if x < 0.0 { f32::NAN } else { x };
    }
    // Subnormal numbers are scaled by 2^24.
    let (x, scale) = if x < f32::MIN_POSITIVE {
        (x * 16_777_216.0, 0.000_244_140_63)
    } else {
        (x, 1.0)
    };
    let (exponent, fraction) = (x.to_bits() >> 23, x.to_bits() & 0x007F_FFFF);
    // x = v 4^e with 1 ≤ v < 4, and v = mantissa / 2^23.
    let odd = (exponent & 1) ^ 1;
    let mantissa = (fraction | 0x0080_0000) << odd;
    let v = f32::from_bits(fraction | (127 + odd) << 23);
    // The initial value of 1/√v has a relative error of 3.4e-2. Each step squares the error and multiplies it
    // by 1.5.
    let half = 0.5 * v;
    let y = f32::from_bits(0x5F37_59DF_u32.wrapping_sub(v.to_bits() >> 1));
    let y = y * (1.5 - half * y * y);
    let y = y * (1.5 - half * y * y);
    let y = y * (1.5 - half * y * y);
    // The root in units of 2^-23, as an integer with an error of at most 3. Its remainder is so small that
    // the last 32 bits suffice.
    let remainder = |root: u32| {
        (mantissa << 23)
            .wrapping_sub(root.wrapping_mul(root))
            .cast_signed()
    };
    let root = ((v * y * 8_388_608.0) as u32).wrapping_sub(3);
    let root = root.wrapping_add(u32::from(remainder(root.wrapping_add(4)) >= 0) << 2);
    let root = root.wrapping_add(u32::from(remainder(root.wrapping_add(2)) >= 0) << 1);
    let root = root.wrapping_add(u32::from(remainder(root.wrapping_add(1)) >= 0));
    // If v is above (root + 1/2)², the middle between two numbers, the larger number is nearer. The exact
    // root is never in the middle.
    let root = root.wrapping_add(u32::from(remainder(root) > root.cast_signed()));
    let exponent = exponent.wrapping_add(127).wrapping_sub(odd) >> 1;
    f32::from_bits((exponent << 23).wrapping_add(root.wrapping_sub(0x0080_0000))) * scale
}
