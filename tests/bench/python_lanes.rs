//! Functions over eight states of a module in Rust as a library, for `python_lanes.py`: blocks of eight states stand one
//! behind the other. `python_lanes.sh` compiles it.

#[allow(dead_code, reason = "two functions are called")]
mod robot {
    include!(env!("GELENK_MODULE"));
}

use robot::{Lanes, M, N};

/// Calls the widest form that the processor has.
macro_rules! widest {
    ([$any:ident, $avx2:ident, $avx512:ident] ($($argument:expr),*)) => {{
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            robot::$avx512($($argument),*)
        } else if is_x86_feature_detected!("avx2") {
            robot::$avx2($($argument),*)
        } else {
            robot::$any($($argument),*)
        }
        #[cfg(not(target_arch = "x86_64"))]
        robot::$any($($argument),*)
    }};
}

/// # Safety
/// Each pointer leads to `count` blocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn inverse_dynamics(
    blocks: usize,
    y: *const [Lanes; N],
    v: *const [Lanes; N],
    a: *const [Lanes; N],
    forces: *mut [Lanes; M],
) {
    for k in 0..blocks {
        unsafe {
            let (y, v, a) = (&*y.add(k), &*v.add(k), &*a.add(k));
            widest!([inverse_dynamics_lanes, inverse_dynamics_lanes_avx2, inverse_dynamics_lanes_avx512](
                y, v, a, &mut *forces.add(k)
            ));
        }
    }
}

/// # Safety
/// Each pointer leads to `count` blocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linearize(
    blocks: usize,
    y: *const [Lanes; N],
    v: *const [Lanes; N],
    u: *const [Lanes; M],
    by_y: *mut [[Lanes; N]; N],
    by_v: *mut [[Lanes; N]; N],
    by_u: *mut [[Lanes; M]; N],
    affine: *mut [Lanes; N],
) {
    for k in 0..blocks {
        unsafe {
            let (y, v, u) = (&*y.add(k), &*v.add(k), &*u.add(k));
            let (by_y, by_v, by_u) = (&mut *by_y.add(k), &mut *by_v.add(k), &mut *by_u.add(k));
            widest!([linearize_lanes, linearize_lanes_avx2, linearize_lanes_avx512](
                y, v, u, by_y, by_v, by_u, &mut *affine.add(k)
            ));
        }
    }
}
