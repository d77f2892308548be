//! Suggestions for unknown names.

/// Least number of letters of an unknown name for which known names that contain it are suggested. `MOST` is
/// the largest number of these suggestions.
const PART: usize = 3;
const MOST: usize = 4;

/// Suggests known names for an unknown name.
///
/// - If a known name is similar, the text is `did you mean …?` with the nearest name.
/// - Otherwise it suggests the known names that contain the given name (`left_knee` contains `knee`).
/// - Otherwise it lists known names.
///
/// Returns `None` if there are no known names.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let known: Vec<&str> = known.into_iter().collect();
    let lower = name.chars().take(64).collect::<String>().to_lowercase();
    let distance = |candidate: &str| strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
    let best =
        known.iter().take(1000).map(|candidate| (distance(candidate), *candidate)).min_by_key(|(d, _)| *d)?;
    if best.0 <= 1 + lower.chars().count() / 3 {
        return Some(format!("did you mean `{}`?", best.1));
    }
    let list = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let holds =
        |candidate: &&&str| lower.chars().count() >= PART && candidate.to_lowercase().contains(&lower);
    let holding: Vec<&str> = known.iter().filter(holds).copied().collect();
    match (holding.len(), known.len()) {
        (1..=MOST, _) => Some(format!("did you mean {}?", list(&holding))),
        (_, 0..=20) => Some(format!("known names are {}", list(&known))),
        (_, more) => Some(format!("known names are {} and {} more", list(&known[..12]), more - 12)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_hold_a_name_are_asked_for() {
        let known = ["left_index_q1", "right_index_q1", "left_thumb_q1"];
        let help = |name| nearest(name, known).unwrap_or_default();
        assert_eq!(help("index_q1"), "did you mean `left_index_q1`, `right_index_q1`?");
        assert_eq!(help("left_index_q2"), "did you mean `left_index_q1`?");
        assert_eq!(help("q1"), "known names are `left_index_q1`, `right_index_q1`, `left_thumb_q1`");
        assert_eq!(nearest("any", []), None);
    }
}
