//! Builds the QP solver as a shared library with a C interface, for comparisons with solvers in other languages.
//!
//! Build the library for the processor of this machine, and pass `libmpc_plugin.so` to the benchmark:
//!
//! ```sh
//! RUSTFLAGS="-C target-cpu=native" cargo build --release -p gelenk-runtime --example mpc_plugin
//! ```
//!
//! All matrices of the interface are column-major. The library contains solvers for 2, 4, 12 and 14 states with 1, 2, 6 and 7
//! inputs.

use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStage, QpStatus};
use std::ffi::{c_int, c_void};
use std::slice::from_raw_parts;

/// Data of one problem: dynamics `x_{k+1} = A_k x_k + B_k u_k`, weights Q, R and P (terminal), bounds of x_1 … x_N and
/// u_0 … u_{N−1}.
#[repr(C)]
#[derive(Debug)]
pub struct Problem {
    nx: c_int,
    nu: c_int,
    horizon: c_int,
    q: *const f64,
    r: *const f64,
    p: *const f64,
    a: *const f64,
    b: *const f64,
    x0: *const f64,
    xmin: *const f64,
    xmax: *const f64,
    umin: *const f64,
    umax: *const f64,
}

/// Interface to a solver for problems of one size.
trait Contender {
    /// Copies the data of a problem.
    ///
    /// # Safety
    /// The pointers of `problem` must be valid for the sizes for which the solver was created.
    unsafe fn prepare(&mut self, problem: &Problem);

    /// Solves the problem and writes the inputs to `u`. Returns 0 if the problem is solved, and the number of iterations.
    ///
    /// # Safety
    /// `u` must be valid for all inputs of the horizon.
    unsafe fn solve(&mut self, u: *mut f64) -> (c_int, c_int);
}

struct Pair<const NX: usize, const NU: usize> {
    problem: QpProblem<NX, NU>,
    solver: QpSolver<NX, NU>,
}

/// Converts a column-major matrix to rows.
fn transpose<const R: usize, const C: usize>(from: &[f64], to: &mut [[f64; C]; R]) {
    for (i, row) in to.iter_mut().enumerate() {
        for (j, v) in row.iter_mut().enumerate() {
            *v = from[j * R + i];
        }
    }
}

impl<const NX: usize, const NU: usize> Contender for Pair<NX, NU> {
    unsafe fn prepare(&mut self, problem: &Problem) {
        let n = self.problem.stages.len();
        // SAFETY: the caller ensures that all pointers are valid.
        let view = |p: *const f64, count: usize| unsafe { from_raw_parts(p, count) };
        transpose(view(problem.q, NX * NX), &mut self.problem.state_weight);
        transpose(view(problem.r, NU * NU), &mut self.problem.input_weight);
        transpose(view(problem.p, NX * NX), &mut self.problem.terminal_weight);
        self.problem.initial_state.copy_from_slice(view(problem.x0, NX));
        let (a, b) = (view(problem.a, n * NX * NX), view(problem.b, n * NX * NU));
        let (xmin, xmax) = (view(problem.xmin, n * NX), view(problem.xmax, n * NX));
        let (umin, umax) = (view(problem.umin, n * NU), view(problem.umax, n * NU));
        for (k, stage) in self.problem.stages.iter_mut().enumerate() {
            let QpStage { state_matrix, input_matrix, .. } = stage;
            transpose(&a[k * NX * NX..][..NX * NX], state_matrix);
            transpose(&b[k * NX * NU..][..NX * NU], input_matrix);
            stage.state_lower.copy_from_slice(&xmin[k * NX..][..NX]);
            stage.state_upper.copy_from_slice(&xmax[k * NX..][..NX]);
            stage.input_lower.copy_from_slice(&umin[k * NU..][..NU]);
            stage.input_upper.copy_from_slice(&umax[k * NU..][..NU]);
        }
    }

    unsafe fn solve(&mut self, u: *mut f64) -> (c_int, c_int) {
        let report = self.solver.solve(&self.problem);
        for k in 0..self.problem.stages.len() {
            for (i, value) in self.solver.input(k).into_iter().enumerate() {
                // SAFETY: the index is within the inputs of the horizon, for which the caller ensures that `u` is valid.
                unsafe { u.add(k * NU + i).write(value) };
            }
        }
        (c_int::from(report.status != QpStatus::Solved), report.iterations as c_int)
    }
}

fn contender<const NX: usize, const NU: usize>(horizon: usize, tolerance: f64) -> Option<Box<dyn Contender>> {
    let settings = QpSettings { tolerance, ..QpSettings::default() };
    let solver = QpSolver::<NX, NU>::new(horizon, settings).ok()?;
    Some(Box::new(Pair { problem: QpProblem::new(horizon), solver }))
}

/// Creates a solver for problems of this size. Returns null if the library has no solver for the size.
///
/// # Safety
/// `problem` must point to a problem.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_create(problem: *const Problem, tolerance: f64) -> *mut c_void {
    // SAFETY: the caller satisfies the conditions of this function.
    let problem = unsafe { &*problem };
    let horizon = usize::try_from(problem.horizon).unwrap_or(0);
    let contender = match (problem.nx, problem.nu) {
        (2, 1) => contender::<2, 1>(horizon, tolerance),
        (4, 2) => contender::<4, 2>(horizon, tolerance),
        (12, 6) => contender::<12, 6>(horizon, tolerance),
        (14, 7) => contender::<14, 7>(horizon, tolerance),
        _ => None,
    };
    contender.map_or(std::ptr::null_mut(), |c| Box::into_raw(Box::new(c)).cast())
}

/// Copies the data of a new problem. Returns 0 on success.
///
/// # Safety
/// `solver` must come from [`mpc_create`]. `problem` must have the size for which the solver was created.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_prepare(solver: *mut c_void, problem: *const Problem) -> c_int {
    // SAFETY: by this function's contract.
    unsafe { (*solver.cast::<Box<dyn Contender>>()).prepare(&*problem) };
    0
}

/// Solves the problem with a cold start. Returns 0 if the problem is solved.
///
/// # Safety
/// `solver` must come from [`mpc_create`]. `u` must be valid for all inputs of the horizon, and `iterations` for one number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_solve(solver: *mut c_void, u: *mut f64, iterations: *mut c_int) -> c_int {
    // SAFETY: by this function's contract.
    unsafe {
        let (status, count) = (*solver.cast::<Box<dyn Contender>>()).solve(u);
        *iterations = count;
        status
    }
}

/// Frees a solver.
///
/// # Safety
/// `solver` must come from [`mpc_create`], and must not be used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_destroy(solver: *mut c_void) {
    // SAFETY: by this function's contract.
    drop(unsafe { Box::from_raw(solver.cast::<Box<dyn Contender>>()) });
}
