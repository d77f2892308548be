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
    let text = path
        .to_str()
        .ok()
        .and_then(|path| std::fs::read_to_string(path).ok());
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
    for (i, column) in to.iter_mut().enumerate() {
        for (entry, row) in column.iter_mut().zip(matrix) {
            *entry = row[i];
        }
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
    robot::inverse_dynamics_derivatives_and_mass_matrix_into(
        y,
        v,
        a,
        &mut forces,
        &mut dy,
        &mut dv,
        mass,
    );
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
    robot::forward_dynamics_derivatives_into(
        y,
        v,
        u,
        &mut accelerations,
        &mut dy,
        &mut dv,
        by_inputs,
    );
    leave(&dy, by_coordinates);
    leave(&dv, by_velocities);
}
