//! Items of a module as formatted text.

use proc_macro2::TokenStream;

/// Appends items, each after an empty line.
pub(super) fn push_items(text: &mut String, items: impl IntoIterator<Item = TokenStream>) {
    for item in items {
        text.push('\n');
        text.push_str(&print(item));
    }
}

/// Formats one item. The tokens were made by this folder: where they are not Rust, that is a defect here, and
/// the unformatted tokens with rustc's message about them help more than a panic.
fn print(item: TokenStream) -> String {
    match syn::parse2::<syn::File>(item.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(_) => format!("{item}\n"),
    }
}
