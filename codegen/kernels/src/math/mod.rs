//! Elementary functions, in our own text so that they give the same bits on every platform.
//!
//! The text of each file is compiled here, for the interpreter, and pasted into generated modules by the emitter
//! ([`Kernel`]), so interpreter and generated code agree bit for bit. Constraints on it: `core` paths only, no
//! branches on the usual path, no tables, no fused operations, no panic, no inner attributes or inner doc comments. The texts
//! for f32 compute in f32 throughout: small processors have no f64.

include!("sin_cos.rs");
include!("sin_cos_array.rs");
include!("sin_cos_lanes.rs");
include!("sin_cos_2.rs");
include!("sin_cos_4.rs");
include!("sin_cos_8.rs");
include!("sin_cos_f32.rs");
include!("sin_cos_array_f32.rs");
include!("sin_cos_lanes_f32.rs");
include!("sin_cos_2_f32.rs");
include!("sin_cos_4_f32.rs");
include!("sin_cos_8_f32.rs");
include!("exp_reduced.rs");
include!("exp.rs");
include!("exp_reduced_f32.rs");
include!("exp_f32.rs");
include!("tanh.rs");
include!("tanh_f32.rs");
include!("sqrt.rs");
include!("sqrt_f32.rs");

/// The bits of numbers of type `double` in C99, which [`Kernel::c_source`] reads.
pub const C_BITS: &str = include_str!("bits.c");

/// The bits of numbers of type `float`, for the texts whose names end in `_f32`.
pub const C_BITS_F32: &str = include_str!("bits_f32.c");

/// Text of one elementary function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kernel {
    /// [`sin_cos`]
    SinCos,
    /// [`sin_cos_array`]
    SinCosArray,
    /// [`sin_cos_lanes`]
    SinCosLanes,
    /// [`sin_cos_2`]
    SinCos2,
    /// [`sin_cos_4`]
    SinCos4,
    /// [`sin_cos_8`]
    SinCos8,
    /// [`sin_cos_f32`]
    SinCosF32,
    /// [`sin_cos_array_f32`]
    SinCosArrayF32,
    /// [`sin_cos_lanes_f32`]
    SinCosLanesF32,
    /// [`sin_cos_2_f32`]
    SinCos2F32,
    /// [`sin_cos_4_f32`]
    SinCos4F32,
    /// [`sin_cos_8_f32`]
    SinCos8F32,
    /// What [`exp`] and [`tanh`] share.
    ExpReduced,
    /// [`exp`]
    Exp,
    /// What [`exp_f32`] and [`tanh_f32`] share.
    ExpReducedF32,
    /// [`exp_f32`]
    ExpF32,
    /// [`tanh`]
    Tanh,
    /// [`tanh_f32`]
    TanhF32,
    /// [`sqrt`]
    Sqrt,
    /// [`sqrt_f32`]
    SqrtF32,
}

impl Kernel {
    /// Name of the function.
    pub fn name(self) -> &'static str {
        match self {
            Self::SinCos => "sin_cos",
            Self::SinCosArray => "sin_cos_array",
            Self::SinCosLanes => "sin_cos_lanes",
            Self::SinCos2 => "sin_cos_2",
            Self::SinCos4 => "sin_cos_4",
            Self::SinCos8 => "sin_cos_8",
            Self::SinCosF32 => "sin_cos_f32",
            Self::SinCosArrayF32 => "sin_cos_array_f32",
            Self::SinCosLanesF32 => "sin_cos_lanes_f32",
            Self::SinCos2F32 => "sin_cos_2_f32",
            Self::SinCos4F32 => "sin_cos_4_f32",
            Self::SinCos8F32 => "sin_cos_8_f32",
            Self::ExpReduced => "exp_reduced",
            Self::Exp => "exp",
            Self::ExpReducedF32 => "exp_reduced_f32",
            Self::ExpF32 => "exp_f32",
            Self::Tanh => "tanh",
            Self::TanhF32 => "tanh_f32",
            Self::Sqrt => "sqrt",
            Self::SqrtF32 => "sqrt_f32",
        }
    }

    /// Text of the Rust items, to be pasted into a module after those of [`Kernel::requires`].
    pub fn source(self) -> &'static str {
        match self {
            Self::SinCos => include_str!("sin_cos.rs"),
            Self::SinCosArray => include_str!("sin_cos_array.rs"),
            Self::SinCosLanes => include_str!("sin_cos_lanes.rs"),
            Self::SinCos2 => include_str!("sin_cos_2.rs"),
            Self::SinCos4 => include_str!("sin_cos_4.rs"),
            Self::SinCos8 => include_str!("sin_cos_8.rs"),
            Self::SinCosF32 => include_str!("sin_cos_f32.rs"),
            Self::SinCosArrayF32 => include_str!("sin_cos_array_f32.rs"),
            Self::SinCosLanesF32 => include_str!("sin_cos_lanes_f32.rs"),
            Self::SinCos2F32 => include_str!("sin_cos_2_f32.rs"),
            Self::SinCos4F32 => include_str!("sin_cos_4_f32.rs"),
            Self::SinCos8F32 => include_str!("sin_cos_8_f32.rs"),
            Self::ExpReduced => include_str!("exp_reduced.rs"),
            Self::Exp => include_str!("exp.rs"),
            Self::ExpReducedF32 => include_str!("exp_reduced_f32.rs"),
            Self::ExpF32 => include_str!("exp_f32.rs"),
            Self::Tanh => include_str!("tanh.rs"),
            Self::TanhF32 => include_str!("tanh_f32.rs"),
            Self::Sqrt => include_str!("sqrt.rs"),
            Self::SqrtF32 => include_str!("sqrt_f32.rs"),
        }
    }

    /// The same operations as C99, with `gelenk_` before every name, after [`C_BITS`] or [`C_BITS_F32`]; none for
    /// functions over several states.
    pub fn c_source(self) -> Option<&'static str> {
        Some(match self {
            Self::SinCos => include_str!("sin_cos.c"),
            Self::SinCosArray => include_str!("sin_cos_array.c"),
            Self::SinCos2 => include_str!("sin_cos_2.c"),
            Self::SinCos4 => include_str!("sin_cos_4.c"),
            Self::SinCos8 => include_str!("sin_cos_8.c"),
            Self::SinCosF32 => include_str!("sin_cos_f32.c"),
            Self::SinCosArrayF32 => include_str!("sin_cos_array_f32.c"),
            Self::SinCos2F32 => include_str!("sin_cos_2_f32.c"),
            Self::SinCos4F32 => include_str!("sin_cos_4_f32.c"),
            Self::SinCos8F32 => include_str!("sin_cos_8_f32.c"),
            Self::ExpReduced => include_str!("exp_reduced.c"),
            Self::Exp => include_str!("exp.c"),
            Self::ExpReducedF32 => include_str!("exp_reduced_f32.c"),
            Self::ExpF32 => include_str!("exp_f32.c"),
            Self::Tanh => include_str!("tanh.c"),
            Self::TanhF32 => include_str!("tanh_f32.c"),
            // C names the instruction.
            Self::Sqrt | Self::SqrtF32 | Self::SinCosLanes | Self::SinCosLanesF32 => return None,
        })
    }

    /// The same operations over several states as C99, for [`Self::c_source`] of the same kernel; none where compilers
    /// make vectors of a loop. Names end in `_lanes`, or in `_lanes_f32`. What the texts need beside those of
    /// [`Kernel::requires`] is the type `gelenk_group` with its functions, which the printer has.
    pub fn c_lanes_source(self) -> Option<&'static str> {
        Some(match self {
            Self::SinCos => include_str!("sin_cos_lanes.c"),
            Self::SinCosF32 => include_str!("sin_cos_lanes_f32.c"),
            Self::ExpReduced => include_str!("exp_reduced_lanes.c"),
            Self::ExpReducedF32 => include_str!("exp_reduced_lanes_f32.c"),
            Self::Exp => include_str!("exp_lanes.c"),
            Self::ExpF32 => include_str!("exp_lanes_f32.c"),
            Self::Tanh => include_str!("tanh_lanes.c"),
            Self::TanhF32 => include_str!("tanh_lanes_f32.c"),
            _ => return None,
        })
    }

    /// The kernel whose items this one calls; take them transitively.
    pub fn requires(self) -> Option<Self> {
        match self {
            Self::SinCosArray | Self::SinCosLanes => Some(Self::SinCos),
            Self::SinCos2 | Self::SinCos4 | Self::SinCos8 => Some(Self::SinCosArray),
            Self::SinCos2F32 | Self::SinCos4F32 | Self::SinCos8F32 => Some(Self::SinCosArrayF32),
            Self::SinCosArrayF32 | Self::SinCosLanesF32 => Some(Self::SinCosF32),
            Self::Exp | Self::Tanh => Some(Self::ExpReduced),
            Self::ExpF32 | Self::TanhF32 => Some(Self::ExpReducedF32),
            Self::SinCos
            | Self::SinCosF32
            | Self::ExpReduced
            | Self::ExpReducedF32
            | Self::Sqrt
            | Self::SqrtF32 => None,
        }
    }
}
