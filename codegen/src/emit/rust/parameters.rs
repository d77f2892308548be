//! Prints the struct `Parameters` of a model with free parameters.

use proc_macro2::TokenStream;
use quote::quote;

use super::context::Context;
use super::doc_comment::{DocComment, plain};
use super::lints;
use crate::emit::documentation::of_parameter;
use crate::model::Parameter;

/// The struct `Parameters`, the constant with the values of the description, and the implementation of
/// `Default`; empty if there are no free parameters.
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
            #[doc = " Free parameters of the model; `Default` gives the values of the description."]
            #[derive(Debug, Clone, Copy, PartialEq)]
            #allowed_names
            pub struct Parameters { #(#docs pub #fields: #ty,)* }
        },
        quote! {
            impl Parameters {
                #[doc = " Values of the free parameters in the description."]
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
    DocComment::escaped(&of_parameter(parameter, plain)).tokens()
}
