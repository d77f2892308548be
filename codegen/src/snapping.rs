//! Number of operations that snapping saves. Snapping rounds nearly right angles to multiples of 90°.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::functions::function::Function;
use crate::functions::selection;
use crate::program::cost::count;
use crate::read::{DescriptionFiles, NEARLY_RIGHT, NEARLY_RIGHT_ANGLE, ReadOptions};

/// Functions whose operations the note about nearly right angles counts.
const COUNTED: [&str; 2] = ["inverse_dynamics", "mass_matrix"];

/// Adds the number of saved operations to the notes about nearly right angles. If snapping saves no
/// operations, these notes are removed. Other notes stay as they are.
pub fn priced(
    notes: Diagnostics,
    description: &mut DescriptionFiles,
    options: &ReadOptions,
    functions: &[Function],
) -> Diagnostics {
    let concerns = |note: &Diagnostic| note.code == NEARLY_RIGHT_ANGLE;
    if !notes.entries().iter().any(concerns) {
        return notes;
    }
    let Some(savings) = savings(description, options, functions) else {
        return notes;
    };
    let mut entries = notes.into_entries();
    if savings.is_empty() {
        // The dynamics do not depend on these angles, for example angles of frames.
        entries.retain(|note| !concerns(note));
    }
    for note in entries.iter_mut().filter(|note| concerns(note)) {
        note.message = format!("{}: {savings}", note.message);
    }
    Diagnostics::new(entries)
}

/// Text with the operation counts with and without snapped angles; empty if the counts are equal. `None` if
/// no counted function is generated.
fn savings(
    description: &mut DescriptionFiles,
    options: &ReadOptions,
    functions: &[Function],
) -> Option<String> {
    let described: Vec<&Function> =
        functions.iter().filter(|function| COUNTED.contains(&function.name.as_str())).collect();
    let names: Vec<String> = described.iter().map(|f| f.name.clone()).collect();
    if names.is_empty() {
        return None;
    }
    let options = ReadOptions { snap_angles: Some(NEARLY_RIGHT), ..options.clone() };
    let snapped = description.load(&options).ok()?.model;
    let snapped = selection::derive_functions(&snapped, &names, usize::MAX).ok()?;
    let lines: Vec<String> = described
        .iter()
        .filter_map(|function| {
            let other = snapped.iter().find(|other| other.name == function.name)?;
            let (now, then) = (count(&function.program), count(&other.program));
            (now != then).then(|| {
                format!(
                    "`{}` {}/{} instead of {}/{}",
                    function.name, then.multiplications, then.additions, now.multiplications, now.additions
                )
            })
        })
        .collect();
    match lines.is_empty() {
        true => Some(String::new()),
        false => Some(format!("{} (multiplications/additions)", lines.join(", "))),
    }
}
