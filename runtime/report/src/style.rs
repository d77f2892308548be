//! Style sheet of the pages.

pub(super) const STYLE: &str = include_str!("page.css");

/// First definition of a colour in the style sheet. It is the colour of the light theme.
pub(super) fn light(name: &str) -> &'static str {
    let (_, rest) = STYLE.split_once(&format!("{name}: ")).unwrap_or_default();
    rest.split_once(';').map_or("#000", |(colour, _)| colour)
}
