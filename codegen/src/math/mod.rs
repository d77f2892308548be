//! Elementary functions, in our own text so that they give the same bits on every platform.
//!
//! The text of each file is compiled here, for the interpreter, and pasted into generated modules by the emitter
//! ([`Kernel`]), so interpreter and generated code agree bit for bit. Constraints on it: `core` paths only, no
//! branches on the usual path, no tables, no fused operations, no panic, no inner attributes or inner doc comments.

include!("sin_cos.rs");
include!("sin_cos_array.rs");
include!("sin_cos_f32.rs");
include!("sin_cos_array_f32.rs");
include!("exp_reduced.rs");
include!("exp.rs");
include!("exp_direct_f32.rs");
include!("exp_f32.rs");
include!("tanh.rs");
include!("tanh_f32.rs");

/// Text of one elementary function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kernel {
    /// [`sin_cos`]
    SinCos,
    /// [`sin_cos_array`]
    SinCosArray,
    /// [`sin_cos_f32`]
    SinCosF32,
    /// [`sin_cos_array_f32`]
    SinCosArrayF32,
    /// What [`exp`] and [`tanh`] share.
    ExpReduced,
    /// [`exp`]
    Exp,
    /// What [`exp_f32`] and [`tanh_f32`] share.
    ExpDirectF32,
    /// [`exp_f32`]
    ExpF32,
    /// [`tanh`]
    Tanh,
    /// [`tanh_f32`]
    TanhF32,
}

impl Kernel {
    /// Text of the Rust items, to be pasted into a module after those of [`Kernel::requires`].
    pub fn source(self) -> &'static str {
        match self {
            Self::SinCos => include_str!("sin_cos.rs"),
            Self::SinCosArray => include_str!("sin_cos_array.rs"),
            Self::SinCosF32 => include_str!("sin_cos_f32.rs"),
            Self::SinCosArrayF32 => include_str!("sin_cos_array_f32.rs"),
            Self::ExpReduced => include_str!("exp_reduced.rs"),
            Self::Exp => include_str!("exp.rs"),
            Self::ExpDirectF32 => include_str!("exp_direct_f32.rs"),
            Self::ExpF32 => include_str!("exp_f32.rs"),
            Self::Tanh => include_str!("tanh.rs"),
            Self::TanhF32 => include_str!("tanh_f32.rs"),
        }
    }

    /// The kernel whose items this one calls; take them transitively.
    pub fn requires(self) -> Option<Self> {
        match self {
            Self::SinCosArray | Self::SinCosF32 => Some(Self::SinCos),
            Self::SinCosArrayF32 => Some(Self::SinCosF32),
            Self::Exp | Self::Tanh => Some(Self::ExpReduced),
            Self::ExpF32 | Self::TanhF32 => Some(Self::ExpDirectF32),
            Self::SinCos | Self::ExpReduced | Self::ExpDirectF32 => None,
        }
    }
}
