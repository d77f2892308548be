//! A generated module behind the C interface of the comparison of rigid-body libraries: one shared object per
//! robot.
//!
//! `dynamics.sh` compiles it, with the module's path in `GELENK_MODULE` and one `--cfg` for each function
//! that may be missing. Matrices leave column by column.

#[allow(dead_code, reason = "the comparison calls some of the functions")]
mod robot {
    include!(env!("GELENK_MODULE"));
}

use robot::N;

type Vector = [f64; N];
type Matrix = [[f64; N]; N];

#[cfg(not(has_quaternions))]
type Positions = Vector;
#[cfg(has_quaternions)]
type Positions = [f64; robot::NY];

/// The number of coordinates; −1 for a model file of another robot, whose first number is its count of
/// velocities, behind the word `floating` where its base floats.
///
/// # Safety
/// `path` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rbd_init(path: *const std::ffi::c_char) -> i32 {
    // SAFETY: as this function demands.
    let path = unsafe { std::ffi::CStr::from_ptr(path) };
    let text = path.to_str().ok().and_then(|path| std::fs::read_to_string(path).ok());
    let count = text.and_then(|text| {
        let mut words = text.split_whitespace().skip_while(|word| *word == "floating");
        words.next()?.parse::<usize>().ok()
    });
    if count == Some(N) { N as i32 } else { -1 }
}

/// Leaves a matrix column by column. Exchanged in place, single entries would wait for the vectors that were
/// just stored: 80 ns instead of 25 ns for two matrices of a Panda.
#[inline(never)]
fn leave(matrix: &Matrix, to: &mut Matrix) {
    const WHOLE: usize = if cfg!(target_feature = "avx") { N - N % 4 } else { 0 };
    #[cfg(target_feature = "avx")]
    for i in (0..WHOLE).step_by(4) {
        for j in (0..WHOLE).step_by(4) {
            // SAFETY: the processor has AVX, and i + 4 and j + 4 are at most N.
            unsafe { leave_block(matrix, to, i, j) };
        }
    }
    for i in 0..N {
        for j in if i < WHOLE { WHOLE } else { 0 }..N {
            to[j][i] = matrix[i][j];
        }
    }
}

/// Four rows of four entries each, from row `i` and column `j` on: compilers store them one by one.
///
/// # Safety
/// The processor has AVX; i + 4 and j + 4 are at most N.
#[cfg(target_feature = "avx")]
#[target_feature(enable = "avx")]
unsafe fn leave_block(matrix: &Matrix, to: &mut Matrix, i: usize, j: usize) {
    use std::arch::x86_64::*;
    // SAFETY: four entries stand there.
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| unsafe { _mm256_loadu_pd(matrix[i + k].as_ptr().add(j)) });
    let even = [_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d)];
    let odd = [_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d)];
    let columns = [
        _mm256_permute2f128_pd::<0x20>(even[0], even[1]),
        _mm256_permute2f128_pd::<0x20>(odd[0], odd[1]),
        _mm256_permute2f128_pd::<0x31>(even[0], even[1]),
        _mm256_permute2f128_pd::<0x31>(odd[0], odd[1]),
    ];
    for (k, column) in columns.into_iter().enumerate() {
        // SAFETY: four entries stand there.
        unsafe { _mm256_storeu_pd(to[j + k].as_mut_ptr().add(i), column) };
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn rbd_rnea(y: &Positions, v: &Vector, a: &Vector, forces: &mut Vector) {
    *forces = robot::inverse_dynamics(y, v, a);
}

#[unsafe(no_mangle)]
pub extern "C" fn rbd_bias(y: &Positions, v: &Vector, forces: &mut Vector) {
    *forces = robot::bias_forces(y, v);
}

#[unsafe(no_mangle)]
pub extern "C" fn rbd_crba(y: &Positions, mass: &mut Matrix) {
    robot::mass_matrix_into(y, mass);
}

#[cfg(has_mass_matrix_and_bias_forces)]
#[unsafe(no_mangle)]
pub extern "C" fn rbd_mk(y: &Positions, v: &Vector, mass: &mut Matrix, forces: &mut Vector) {
    robot::mass_matrix_and_bias_forces_into(y, v, mass, forces);
}

/// Without friction and springs q is gravity alone.
#[cfg(not(has_mass_matrix_and_bias_forces))]
#[unsafe(no_mangle)]
pub extern "C" fn rbd_mk(y: &Positions, v: &Vector, mass: &mut Matrix, forces: &mut Vector) {
    let (matrix, coriolis, applied) = robot::equations_of_motion(y, v);
    *mass = matrix;
    for i in 0..N {
        forces[i] = coriolis[i] - applied[i];
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn rbd_fd(y: &Positions, v: &Vector, u: &Vector, accelerations: &mut Vector) {
    *accelerations = robot::forward_dynamics(y, v, u);
}

#[cfg(has_inverse_dynamics_derivatives_and_mass_matrix)]
#[unsafe(no_mangle)]
pub extern "C" fn rbd_rnea_der(
    y: &Positions,
    v: &Vector,
    a: &Vector,
    by_coordinates: &mut Matrix,
    by_velocities: &mut Matrix,
    mass: &mut Matrix,
) {
    let mut forces = [0.0; N];
    let (mut dy, mut dv) = ([[0.0; N]; N], [[0.0; N]; N]);
    robot::inverse_dynamics_derivatives_and_mass_matrix_into(y, v, a, &mut forces, &mut dy, &mut dv, mass);
    leave(&dy, by_coordinates);
    leave(&dv, by_velocities);
}

#[cfg(has_forward_dynamics_derivatives)]
#[unsafe(no_mangle)]
pub extern "C" fn rbd_fd_der(
    y: &Positions,
    v: &Vector,
    u: &Vector,
    by_coordinates: &mut Matrix,
    by_velocities: &mut Matrix,
    by_inputs: &mut Matrix,
) {
    let mut accelerations = [0.0; N];
    let (mut dy, mut dv) = ([[0.0; N]; N], [[0.0; N]; N]);
    robot::forward_dynamics_derivatives_into(y, v, u, &mut accelerations, &mut dy, &mut dv, by_inputs);
    leave(&dy, by_coordinates);
    leave(&dv, by_velocities);
}
