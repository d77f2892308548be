//! The `Parameters` struct of a model with free parameters.

use proc_macro2::TokenStream;
use quote::quote;

use super::context::Context;
use super::doc_comment::{DocComment, code, plain};
use super::lints;
use crate::model::Parameter;

/// The struct, its described values, and `Default`; nothing for a model without free parameters.
pub(super) fn items(context: &Context<'_>) -> Vec<TokenStream> {
    if !context.has_parameters() {
        return vec![];
    }
    let scalar = context.options.scalar;
    let ty = scalar.ty();
    let fields = &context.parameters;
    let docs = context.module.parameters.iter().map(documentation);
    let values = context.module.parameters.iter().map(|parameter| scalar.literal(parameter.default));
    let allowed_names = lints::for_names(fields);
    let allowed_numbers =
        lints::for_numbers(context.module.parameters.iter().map(|parameter| parameter.default));
    vec![
        quote! {
            #[doc = " Free parameters of the model; `Default` gives the described values."]
            #[derive(Debug, Clone, Copy, PartialEq)]
            #allowed_names
            pub struct Parameters { #(#docs pub #fields: #ty,)* }
        },
        quote! {
            impl Parameters {
                #[doc = " The described values."]
                #allowed_numbers
                pub const DESCRIBED: Self = Self { #(#fields: #values,)* };
            }
        },
        quote! {
            impl Default for Parameters {
                fn default() -> Self { Self::DESCRIBED }
            }
        },
    ]
}

fn documentation(parameter: &Parameter) -> TokenStream {
    let meaning = match parameter.description.trim() {
        "" => format!("Parameter {}", code(&parameter.name)),
        text => plain(text),
    };
    let unit = if parameter.unit.trim().is_empty() {
        String::new()
    } else {
        format!(" ({})", plain(&parameter.unit))
    };
    let value = format!("; described as {:?}.", parameter.default);
    DocComment::escaped(&format!("{}{unit}{value}", meaning.trim_end_matches('.'))).tokens()
}
