//! Guides: what the code means, and how to add to it. The description format stands in `models/README.md`;
//! how to attach hardware, in the runtime's `transport`.

#[doc = include_str!("../docs/conventions.md")]
pub mod conventions {}

#[doc = include_str!("../docs/generated_code.md")]
pub mod generated_code {}

#[doc = include_str!("../docs/identification.md")]
pub mod identification {}

#[doc = include_str!("../docs/joint_types.md")]
pub mod joint_types {}

#[doc = include_str!("../docs/functions.md")]
pub mod functions {}

#[doc = include_str!("../docs/printers.md")]
pub mod printers {}

#[doc = include_str!("../docs/friction_terms.md")]
pub mod friction_terms {}

#[doc = include_str!("../docs/glossary.md")]
pub mod glossary {}

#[doc = include_str!("../docs/microcontrollers.md")]
pub mod microcontrollers {}

#[doc = include_str!("../docs/operation_counts.md")]
pub mod operation_counts {}
