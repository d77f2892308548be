//! Zero-order hold of a model as matrices, for predictive controllers and regulators.

use super::controller::{ControllerFault, TooFast};
use crate::dynamics::{Discretizable, Discretization};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Discrete-time linear model (zero-order hold) at a state.
///
/// # Errors
/// - [`ControllerFault::TooFast`] if a joint is too fast for the zero-order hold.
/// - [`ControllerFault::NotFinite`] if state or model are not finite.
pub(crate) fn discretize<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> Result<Discretization<N, M, NY>, ControllerFault> {
    let discrete = model.discretize(y, v, u, period);
    if discrete.is_finite() { Ok(discrete) } else { Err(too_fast(model, y, v, u, period)) }
}

pub(crate) fn too_fast<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> ControllerFault {
    let linear = model.linearize(y, v, u);
    let rates: [f64; N] = core::array::from_fn(|i| {
        rate(magnitude(&linear.by_coordinates[i]), magnitude(&linear.by_velocities[i]))
    });
    let fastest = (0..N).max_by(|i, j| rates[*i].total_cmp(&rates[*j]));
    let Some(joint) = fastest.filter(|joint| rates[*joint].is_finite()) else {
        return ControllerFault::NotFinite;
    };
    let forces = model.inverse_dynamics_derivatives(y, v, &[0.0; N]);
    ControllerFault::TooFast(TooFast {
        joint,
        name: model.joint_names()[joint],
        slope: forces.by_velocities[joint][joint],
        rate: rates[joint],
        period,
    })
}

/// Upper bound of the rates (magnitudes of the eigenvalues) of `ÿ = A y + B ẏ`, for the largest row sums a of A and
/// b of B.
pub(crate) fn rate(a: f64, b: f64) -> f64 {
    0.5 * (b + (b * b + 4.0 * a).sqrt())
}

/// Sum of the magnitudes of the entries of a row.
pub(crate) fn magnitude<const N: usize>(row: &[f64; N]) -> f64 {
    row.iter().map(|x| x.abs()).sum()
}

/// Copies the blocks of the discrete-time state matrix A_d to one matrix.
pub(crate) fn flat_state<const N: usize, const NX: usize>(
    blocks: &[[[[f64; N]; N]; 2]; 2],
    flat: &mut [[f64; NX]; NX],
) {
    for (half, rows) in blocks.iter().enumerate() {
        for i in 0..N {
            flat[half * N + i][..N].copy_from_slice(&rows[0][i]);
            flat[half * N + i][N..].copy_from_slice(&rows[1][i]);
        }
    }
}

/// Copies the blocks of the discrete-time input matrix B_d to one matrix.
pub(crate) fn flat_input<const N: usize, const M: usize, const NX: usize>(
    blocks: &[[[f64; M]; N]; 2],
    flat: &mut [[f64; M]; NX],
) {
    for (half, rows) in blocks.iter().enumerate() {
        flat[half * N..][..N].copy_from_slice(rows);
    }
}
