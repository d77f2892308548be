//! Elementary functions whose results have the same bits on every platform.
//!
//! The text of each file is compiled here for the interpreter, and pasted into generated modules by the
//! emitter ([`Kernel`]), so interpreter and generated code agree bit for bit. The texts
//!
//! - use only `core` paths
//! - have no branches on the usual path, no tables and no fused operations
//! - do not panic
//! - have no inner attributes or inner doc comments
//!
//! The texts for f32 compute only in f32, because small processors have no f64.

/// C99 text of the functions that convert between `double` and its bits. The texts of [`Kernel::c_source`]
/// call them.
pub const C_BITS: &str = include_str!("bits.c");

/// C99 text of the functions that convert between `float` and its bits, for texts whose names end in `_f32`.
pub const C_BITS_F32: &str = include_str!("bits_f32.c");

/// Makes the enum [`Kernel`] of elementary functions from one row for each function. A row contains the name
/// (also of its Rust file), the elementary function that it calls, and its C99 files for one state and for
/// several states.
macro_rules! kernels {
    ($($(#[$doc:meta])* $kernel:ident $name:literal after [$($needs:ident)?] c [$($c:literal)?] lanes [$($lanes:literal)?],)+) => {
        $(include!(concat!($name, ".rs"));)+

        /// Elementary function with its Rust and C99 text.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Kernel {
            $($(#[$doc])* $kernel,)+
        }

        impl Kernel {
            /// Name of the elementary function, for example `sin_cos`.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kernel => $name,)+
                }
            }

            /// Text of the function's Rust items. In a module it follows the text of [`Kernel::requires`].
            pub fn source(self) -> &'static str {
                match self {
                    $(Self::$kernel => include_str!(concat!($name, ".rs")),)+
                }
            }

            /// C99 text of the function, with the same operations as in Rust. All names begin with `gelenk_`.
            /// The text follows [`C_BITS`] or [`C_BITS_F32`]. `None` for square roots, which are an
            /// instruction in C, and for Rust functions over several states.
            pub fn c_source(self) -> Option<&'static str> {
                let text: &[&str] = match self {
                    $(Self::$kernel => &[$(include_str!($c))?],)+
                };
                text.first().copied()
            }

            /// C99 text of the function over several states, with the same operations. It follows
            /// [`Self::c_source`]. Names end in `_lanes` or `_lanes_f32`. `None` if compilers vectorize a
            /// loop over the states. The text also needs the type `gelenk_group` with its functions, which
            /// the printer writes.
            pub fn c_lanes_source(self) -> Option<&'static str> {
                let text: &[&str] = match self {
                    $(Self::$kernel => &[$(include_str!($lanes))?],)+
                };
                text.first().copied()
            }

            /// The elementary function that this function calls; `None` if it calls no other. The called
            /// function may call a further one.
            pub fn requires(self) -> Option<Self> {
                let needed: &[Self] = match self {
                    $(Self::$kernel => &[$(Self::$needs)?],)+
                };
                needed.first().copied()
            }
        }
    };
}

kernels! {
    /// Text of [`sin_cos`]: sine and cosine of an angle.
    SinCos "sin_cos" after [] c ["sin_cos.c"] lanes ["sin_cos_lanes.c"],
    /// Text of [`sin_cos_array`]: sines and cosines of an array of angles.
    SinCosArray "sin_cos_array" after [SinCos] c ["sin_cos_array.c"] lanes [],
    /// Text of [`sin_cos_lanes`]: sines and cosines of an angle at several states.
    SinCosLanes "sin_cos_lanes" after [SinCos] c [] lanes [],
    /// Text of [`sin_cos_2`]: sines and cosines of two angles.
    SinCos2 "sin_cos_2" after [SinCosArray] c ["sin_cos_2.c"] lanes [],
    /// Text of [`sin_cos_4`]: sines and cosines of four angles.
    SinCos4 "sin_cos_4" after [SinCosArray] c ["sin_cos_4.c"] lanes [],
    /// Text of [`sin_cos_8`]: sines and cosines of eight angles.
    SinCos8 "sin_cos_8" after [SinCosArray] c ["sin_cos_8.c"] lanes [],
    /// Text of [`sin_cos_f32`]: sine and cosine of an angle in single precision.
    SinCosF32 "sin_cos_f32" after [] c ["sin_cos_f32.c"] lanes ["sin_cos_lanes_f32.c"],
    /// Text of [`sin_cos_array_f32`]: sines and cosines of an array of angles in single precision.
    SinCosArrayF32 "sin_cos_array_f32" after [SinCosF32] c ["sin_cos_array_f32.c"] lanes [],
    /// Text of [`sin_cos_lanes_f32`]: sines and cosines of an angle at several states in single precision.
    SinCosLanesF32 "sin_cos_lanes_f32" after [SinCosF32] c [] lanes [],
    /// Text of [`sin_cos_2_f32`]: sines and cosines of two angles in single precision.
    SinCos2F32 "sin_cos_2_f32" after [SinCosArrayF32] c ["sin_cos_2_f32.c"] lanes [],
    /// Text of [`sin_cos_4_f32`]: sines and cosines of four angles in single precision.
    SinCos4F32 "sin_cos_4_f32" after [SinCosArrayF32] c ["sin_cos_4_f32.c"] lanes [],
    /// Text of [`sin_cos_8_f32`]: sines and cosines of eight angles in single precision.
    SinCos8F32 "sin_cos_8_f32" after [SinCosArrayF32] c ["sin_cos_8_f32.c"] lanes [],
    /// Text of the argument reduction `exp x = (hi + low) 2^k` for the integer k, which [`exp`] and [`tanh`]
    /// call.
    ExpReduced "exp_reduced" after [] c ["exp_reduced.c"] lanes ["exp_reduced_lanes.c"],
    /// Text of [`exp`]: the exponential function.
    Exp "exp" after [ExpReduced] c ["exp.c"] lanes ["exp_lanes.c"],
    /// Text of the argument reduction `exp x = (hi + low) 2^k` for the integer k, which [`exp_f32`] and
    /// [`tanh_f32`] call.
    ExpReducedF32 "exp_reduced_f32" after [] c ["exp_reduced_f32.c"] lanes ["exp_reduced_lanes_f32.c"],
    /// Text of [`exp_f32`]: the exponential function in single precision.
    ExpF32 "exp_f32" after [ExpReducedF32] c ["exp_f32.c"] lanes ["exp_lanes_f32.c"],
    /// Text of [`tanh`]: the hyperbolic tangent.
    Tanh "tanh" after [ExpReduced] c ["tanh.c"] lanes ["tanh_lanes.c"],
    /// Text of [`tanh_f32`]: the hyperbolic tangent in single precision.
    TanhF32 "tanh_f32" after [ExpReducedF32] c ["tanh_f32.c"] lanes ["tanh_lanes_f32.c"],
    /// Text of [`sqrt`]: the square root.
    Sqrt "sqrt" after [] c [] lanes [],
    /// Text of [`sqrt_f32`]: the square root in single precision.
    SqrtF32 "sqrt_f32" after [] c [] lanes [],
}
