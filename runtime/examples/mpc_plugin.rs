//! The QP solver behind the C ABI of the MPC benchmark.
#![allow(missing_docs, non_snake_case)]
use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
use std::os::raw::{c_int, c_void};

#[repr(C)]
pub struct Problem {
    nx: c_int,
    nu: c_int,
    N: c_int,
    Q: *const f64,
    R: *const f64,
    P: *const f64,
    A: *const f64,
    B: *const f64,
    x0: *const f64,
    xmin: *const f64,
    xmax: *const f64,
    umin: *const f64,
    umax: *const f64,
}

trait Contender {
    unsafe fn prepare(&mut self, p: &Problem);
    fn solve(&mut self, u: &mut [f64]) -> (c_int, c_int);
    fn inputs(&self) -> usize;
}

struct Sized<const NX: usize, const NU: usize> {
    problem: QpProblem<NX, NU>,
    solver: QpSolver<NX, NU>,
}

impl<const NX: usize, const NU: usize> Contender for Sized<NX, NU> {
    unsafe fn prepare(&mut self, p: &Problem) {
        unsafe {
            let n = p.N as usize;
            let s = |x: *const f64, k: usize| std::slice::from_raw_parts(x, k);
            let (q, r, t) = (s(p.Q, NX * NX), s(p.R, NU * NU), s(p.P, NX * NX));
            for i in 0..NX {
                for j in 0..NX {
                    self.problem.state_weight[i][j] = q[j * NX + i];
                    self.problem.terminal_weight[i][j] = t[j * NX + i];
                }
            }
            for i in 0..NU {
                for j in 0..NU {
                    self.problem.input_weight[i][j] = r[j * NU + i];
                }
            }
            self.problem.initial_state.copy_from_slice(s(p.x0, NX));
            let (a, b) = (s(p.A, n * NX * NX), s(p.B, n * NX * NU));
            let (xl, xh, ul, uh) = (
                s(p.xmin, n * NX),
                s(p.xmax, n * NX),
                s(p.umin, n * NU),
                s(p.umax, n * NU),
            );
            for (k, st) in self.problem.stages.iter_mut().enumerate() {
                let a = &a[k * NX * NX..][..NX * NX];
                let b = &b[k * NX * NU..][..NX * NU];
                for i in 0..NX {
                    for j in 0..NX {
                        st.state_matrix[i][j] = a[j * NX + i];
                    }
                    for j in 0..NU {
                        st.input_matrix[i][j] = b[j * NX + i];
                    }
                }
                st.state_lower.copy_from_slice(&xl[k * NX..][..NX]);
                st.state_upper.copy_from_slice(&xh[k * NX..][..NX]);
                st.input_lower.copy_from_slice(&ul[k * NU..][..NU]);
                st.input_upper.copy_from_slice(&uh[k * NU..][..NU]);
            }
        }
    }
    fn solve(&mut self, u: &mut [f64]) -> (c_int, c_int) {
        let r = self.solver.solve(&self.problem);
        for (k, u) in u.chunks_exact_mut(NU).enumerate() {
            u.copy_from_slice(&self.solver.input(k));
        }
        (
            c_int::from(r.status != QpStatus::Solved),
            r.iterations as c_int,
        )
    }
    fn inputs(&self) -> usize {
        self.problem.stages.len() * NU
    }
}

fn boxed<const NX: usize, const NU: usize>(n: usize, tol: f64) -> Box<dyn Contender> {
    let settings = QpSettings {
        tolerance: tol,
        ..QpSettings::default()
    };
    Box::new(Sized::<NX, NU> {
        problem: QpProblem::new(n),
        solver: QpSolver::new(n, settings).unwrap(),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_create(p: *const Problem, tol: f64) -> *mut c_void {
    let p = unsafe { &*p };
    let n = p.N as usize;
    let mut c = match (p.nx, p.nu) {
        (4, 2) => boxed::<4, 2>(n, tol),
        (12, 6) => boxed::<12, 6>(n, tol),
        _ => return std::ptr::null_mut(),
    };
    unsafe { c.prepare(p) };
    Box::into_raw(Box::new(c)) as *mut c_void
}
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_prepare(s: *mut c_void, p: *const Problem) -> c_int {
    let c = unsafe { &mut *(s as *mut Box<dyn Contender>) };
    unsafe { c.prepare(&*p) };
    0
}
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_solve(s: *mut c_void, u: *mut f64, iterations: *mut c_int) -> c_int {
    let c = unsafe { &mut *(s as *mut Box<dyn Contender>) };
    let k = c.inputs();
    let (rc, it) = c.solve(unsafe { std::slice::from_raw_parts_mut(u, k) });
    unsafe { *iterations = it };
    rc
}
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mpc_destroy(s: *mut c_void) {
    drop(unsafe { Box::from_raw(s as *mut Box<dyn Contender>) });
}
