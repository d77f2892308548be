//! Check that the inputs of a robot can exert a force on each learned joint alone.

use super::settings::AdaptationError;
use gelenk_dynamics::pseudo_inverse::pseudo_inverse;

/// Returns the pseudo-inverse `B⁺` of an input matrix B (joint forces per unit of each input). The inputs must be able to exert
/// a force on each learned joint k alone: `B B⁺ e_k = e_k` with the unit vector e_k.
///
/// # Errors
/// [`AdaptationError::Inputs`] if the inputs cannot exert a force on a learned joint alone, and for an empty, zero or
/// non-finite matrix.
pub fn input_inverse<const N: usize, const M: usize>(
    matrix: &[[f64; M]; N],
    is_learned: impl Fn(usize) -> bool,
) -> Result<[[f64; N]; M], AdaptationError> {
    let inverse = pseudo_inverse(matrix).ok_or(AdaptationError::Inputs)?;
    let reached = |i: usize, k: usize| (0..M).map(|j| matrix[i][j] * inverse[j][k]).sum::<f64>();
    let is_own = |k: usize| (0..N).all(|i| (reached(i, k) - f64::from(u8::from(i == k))).abs() < 1e-9);
    match (0..N).all(|k| !is_learned(k) || is_own(k)) {
        true => Ok(inverse),
        false => Err(AdaptationError::Inputs),
    }
}
