//! Prints items of a module as formatted text.

use proc_macro2::TokenStream;

/// Appends items to a text. Each item follows an empty line.
pub(super) fn push_items(text: &mut String, items: impl IntoIterator<Item = TokenStream>) {
    for item in items {
        text.push('\n');
        text.push_str(&print(item));
    }
}

/// Formats one item. If the tokens are not valid Rust, the printer has a defect. The tokens are then printed
/// without formatting, because a message of rustc helps more than a panic.
fn print(item: TokenStream) -> String {
    match syn::parse2::<syn::File>(item.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(_) => format!("{item}\n"),
    }
}
