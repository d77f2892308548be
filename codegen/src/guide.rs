//! Guides about conventions, use of generated code, and extension of the generator. `models/README.md`
//! documents the description format. The module `transport` of the runtime documents the connection to
//! hardware.

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

#[doc = include_str!("../docs/c.md")]
pub mod c {}

#[doc = include_str!("../docs/casadi.md")]
pub mod casadi {}

#[doc = include_str!("../docs/acados.md")]
pub mod acados {}

#[doc = include_str!("../docs/mujoco.md")]
pub mod mujoco {}

#[doc = include_str!("../docs/floating.md")]
pub mod floating {}

#[doc = include_str!("../docs/guarantees.md")]
pub mod guarantees {}

#[doc = include_str!("../docs/limits.md")]
pub mod limits {}

#[doc = include_str!("../docs/speed.md")]
pub mod speed {}

#[doc = include_str!("../docs/symbolica.md")]
pub mod symbolica {}
