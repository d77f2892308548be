//! Robots whose inputs load joints separately.

use super::settings::AdaptationError;
use gelenk_dynamics::pseudo_inverse::pseudo_inverse;

/// Pseudo-inverse `B⁺` of an input matrix B whose inputs load each learned joint separately: `B B⁺ e_k = e_k`
/// for each such joint k.
///
/// # Errors
/// [`AdaptationError::Inputs`] for other matrices, and for empty, zero or non-finite ones.
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
