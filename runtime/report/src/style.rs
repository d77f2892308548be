//! The style sheet of pages.

pub(super) const STYLE: &str = include_str!("page.css");

/// A light colour of the page, the first one of its name.
pub(super) fn light(name: &str) -> &'static str {
    let (_, rest) = STYLE.split_once(&format!("{name}: ")).unwrap_or_default();
    rest.split_once(';').map_or("#000", |(colour, _)| colour)
}
