//! Keys of TOML descriptions, with one row for each key. The reader, the help on unknown keys,
//! `gelenk schema` and the tables of models/README.md use these rows.

mod advice;
mod bodies;
mod drives;
mod force_laws;
mod frame_forces;
mod joints;
mod robot;
mod row;
#[cfg(test)]
mod tests;
mod values;

pub(super) use advice::advice;
pub(crate) use robot::ROBOT;
pub(crate) use row::{Key, Keys, Value};
pub(crate) use values::FREE;

/// Names of the parts of joints with several degrees of freedom, for example `turn` and `slide`.
#[cfg(feature = "cli")]
pub(crate) fn parts() -> std::collections::BTreeSet<&'static str> {
    crate::read::composite::Composite::ALL
        .iter()
        .flat_map(|joint| joint.parts())
        .map(|part| part.name)
        .collect()
}
