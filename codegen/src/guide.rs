//! Guides. The description format stands in `models/README.md`; how to attach hardware, in the runtime's `transport`.

#[doc = include_str!("../docs/conventions.md")]
pub mod conventions {}

#[doc = include_str!("../docs/generated_code.md")]
pub mod generated_code {}

#[doc = include_str!("../docs/joint_types.md")]
pub mod joint_types {}
