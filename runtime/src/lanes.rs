//! Functions over eight states at once: the form for the widest registers that this processor has.

/// Calls one of three forms of a function over lanes: for any processor, for AVX2, for AVX-512.
///
/// Generated with `--lanes inverse_dynamics`, a module has `inverse_dynamics_lanes`, `inverse_dynamics_lanes_avx2` and
/// `inverse_dynamics_lanes_avx512`; the latter two on x86-64 only. All give the same bits.
///
/// ```
/// # mod robot {
/// #     pub fn double_lanes(x: &[f64; 8], y: &mut [f64; 8]) { *y = x.map(|x| 2.0 * x); }
/// #     #[cfg(target_arch = "x86_64")]
/// #     #[target_feature(enable = "avx2")]
/// #     pub fn double_lanes_avx2(x: &[f64; 8], y: &mut [f64; 8]) { double_lanes(x, y) }
/// #     #[cfg(target_arch = "x86_64")]
/// #     #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
/// #     pub fn double_lanes_avx512(x: &[f64; 8], y: &mut [f64; 8]) { double_lanes(x, y) }
/// # }
/// let (x, mut y) = ([1.5; 8], [0.0; 8]);
/// gelenk_runtime::widest!(
///     [robot::double_lanes, robot::double_lanes_avx2, robot::double_lanes_avx512](&x, &mut y)
/// );
/// assert_eq!(y, [3.0; 8]);
/// ```
#[macro_export]
macro_rules! widest {
    ([$any:path, $avx2:path, $avx512:path] ($($argument:expr),* $(,)?)) => {{
        #[cfg(target_arch = "x86_64")]
        {
            if std::is_x86_feature_detected!("avx512f")
                && std::is_x86_feature_detected!("avx512bw")
                && std::is_x86_feature_detected!("avx512dq")
                && std::is_x86_feature_detected!("avx512vl")
            {
                // SAFETY: the processor has what this form was compiled for.
                unsafe { $avx512($($argument),*) }
            } else if std::is_x86_feature_detected!("avx2") {
                // SAFETY: as above.
                unsafe { $avx2($($argument),*) }
            } else {
                $any($($argument),*)
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            $any($($argument),*)
        }
    }};
}
