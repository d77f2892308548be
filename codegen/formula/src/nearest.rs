//! Advice about unknown names.

/// `did you mean …?` with the nearest of the known names, or the list of them where none is near.
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
    match known.len() {
        0..=20 => Some(format!("known are {}", list(&known))),
        more => Some(format!("known are {} and {} more", list(&known[..12]), more - 12)),
    }
}
