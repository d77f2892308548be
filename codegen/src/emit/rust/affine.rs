//! Prints `linearize` of robots with loops over joints: a call of `forward_dynamics_derivatives`, and code
//! that computes the linearization from the results of this call.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::Body;
use super::context::Context;
use super::public;
use super::signature::Signature;
use crate::functions::function::Function;
use crate::program::Operand;
use crate::program::arrays::Affine;

/// The public functions of `linearize`.
pub(super) fn items(
    context: &Context<'_>,
    function: &Function,
    form: &Affine,
    name: &Ident,
) -> Vec<TokenStream> {
    let face = function.program.face();
    let body = Body::in_place(context, &face);
    let signature = Signature::new(&body);
    public::items(function, &body, name, &signature, &statements(&body, form))
}

fn statements(body: &Body<'_>, form: &Affine) -> TokenStream {
    let ([y, v, u], [by_y, by_v, by_u, remainder, drift @ ..]) =
        (body.arguments.as_slice(), body.results.as_slice())
    else {
        unreachable!("`Affine::unrolled` has three arguments, and four results or five");
    };
    let called = public::into_name(&format_ident!("{}", form.name));
    let parameters = body.context.passed_parameters().into_iter();
    let zero = body.context.zero();
    let n = Literal::usize_unsuffixed(form.called.coordinates().len());
    let columns = form.inputs.iter().enumerate();
    let columns = columns.map(|(column, gains)| {
        let to = Literal::usize_unsuffixed(column);
        let terms = gains.iter().map(|&(coordinate, gain)| {
            let from = Literal::usize_unsuffixed(coordinate);
            match gain {
                Operand::Constant(1.0) => quote!(from[#from]),
                gain => {
                    let gain = body.operand(gain);
                    quote!(from[#from] * #gain)
                }
            }
        });
        quote!(to[#to] = #(#terms)+*;)
    });
    let by_inputs = (!form.inputs.is_empty())
        .then(|| quote!(for (to, from) in #by_u.iter_mut().zip(&inverse) { #(#columns)* }));
    let by_position = form.drift.is_none().then(|| quote!(arrays::dot(&#by_y[i], #y) +));
    let drift = drift.iter().map(|drift| drift_statements(body, form, drift, v));
    quote! {
        let (mut accelerations, mut inverse) = ([#zero; #n], [[#zero; #n]; #n]);
        #called(#y, #v, #u, #(#parameters,)* &mut accelerations, #by_y, #by_v, &mut inverse);
        #by_inputs
        for i in 0..#n {
            let of_state = #by_position arrays::dot(&#by_v[i], #v);
            #remainder[i] = accelerations[i] - (of_state + arrays::dot(&#by_u[i], #u));
        }
        #(#drift)*
    }
}

/// Statements that write the matrix D in `δ̇ = D δ + v − v̄`, the linearized motion of joints with
/// quaternions.
fn drift_statements(body: &Body<'_>, form: &Affine, drift: &Ident, v: &Ident) -> TokenStream {
    let (zero, n) = (body.context.zero(), Literal::usize_unsuffixed(form.called.coordinates().len()));
    let entries = form.drift.iter().flatten().map(|entry| {
        let [row, column, velocity] =
            [entry.row, entry.column, entry.velocity].map(Literal::usize_unsuffixed);
        let sign = entry.is_negative.then(|| quote!(-));
        quote!(#drift[#row][#column] = #sign #v[#velocity];)
    });
    quote!(*#drift = [[#zero; #n]; #n]; #(#entries)*)
}
