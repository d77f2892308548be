//! Additional names that a format requires.

use crate::model::Model;

/// The name if it is not in use, otherwise the name with a number: `name_2`.
pub(super) fn distinct(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    let numbered = (2..).map(|count| format!("{name}_{count}"));
    let mut free = numbered.filter(|name| !is_taken(name));
    free.next().unwrap_or_else(|| unreachable!("there are more numbers than names"))
}

/// Name of the prismatic joint that is added for a helical joint.
pub(super) fn slide_name(model: &Model, joint: &str) -> String {
    unlike_others(model, &format!("{joint}_slide"))
}

/// The name if no link or joint has it, otherwise the name with a number.
pub(super) fn unlike_others(model: &Model, name: &str) -> String {
    distinct(name, |name| {
        let mut links = model.links.iter();
        links.any(|link| link.name == name || link.joint.as_ref().is_some_and(|joint| joint.name == name))
    })
}
