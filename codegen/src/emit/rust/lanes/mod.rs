//! Prints functions over lanes: eight states at once. The results are bit-identical to the results of
//! functions over one state.
//!
//! Sines and cosines are computed first, in a separate loop. The other statements are in inlined functions of
//! one state, which are called in a loop over the states. The compiler vectorizes a loop without inner loops
//! and with constant indices, even if its body is long. Arrays of lanes with operators would prevent the
//! vectorization. A long function is divided into several such loops ([`Plan`]).

mod form;
mod scalar;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::body::Body;
use super::context::Context;
use super::signature::Signature;
use super::{parts, straight};
use crate::functions::function::Function;
use crate::program::Operand;
use crate::program::flow::{Flow, operands};
use crate::program::lanes::Plan;

/// Number of states per call. In double precision, eight states need one register of AVX-512, two registers
/// of AVX2, and four registers of SSE2 or Neon.
const LANES: usize = 8;

/// Largest number of statements of one loop over the states. Times of `linearize` per state (ns) on an EPYC
/// processor (Zen 4):
///
/// | statements | UR5, AVX2 | UR5, AVX-512 | Panda, AVX2 | Panda, AVX-512 |
/// |---|---|---|---|---|
/// | 40 | 80 | 60 | 267 | 141 |
/// | 60 | 83 | 60 | 225 | 134 |
/// | 100 | 76 | 60 | 224 | 134 |
/// | 160 | 76 | 61 | 226 | 138 |
/// | 250 | 83 | 80 | 241 | 163 |
/// | 500 | 106 | 75 | 417 | 295 |
///
/// Each value that is needed after its loop has its own place on the stack. If later values reused these
/// places, the compiler could not keep values in registers, and the times would be 95 ns to 128 ns.
const LONGEST_LOOP: usize = 100;

/// Names of items for functions over eight states at once. Other items must not have these names.
pub(super) const RESERVED: [&str; 3] = ["Lanes", "Group", "LINEARIZE_LANES"];

/// The types that functions over eight states use: a type for eight states, and a type for the values between
/// the loops of a function.
pub(super) fn types(context: &Context<'_>) -> Vec<TokenStream> {
    let (ty, len) = (context.ty(), Literal::usize_unsuffixed(LANES));
    let lanes = context.has_lanes.get().then(|| {
        quote! {
            #[doc = " Values of one quantity for eight states, aligned for SIMD registers."]
            #[derive(Debug, Clone, Copy, PartialEq)]
            #[repr(align(64))]
            pub struct Lanes(pub [#ty; #len]);
        }
    });
    let group = context.has_groups.get().then(|| {
        quote! {
            #[doc = " Values of one quantity for the states that are computed at a time."]
            #[derive(Clone, Copy)]
            #[repr(align(64))]
            struct Group<const W: usize>([#ty; W]);
        }
    });
    lanes.into_iter().chain(group).collect()
}

/// Division of a function into loops over eight states (lanes). `None` if no version over lanes is requested,
/// or if the elementary functions are those of std.
pub(super) fn plan(context: &Context<'_>, function: &Function) -> Option<Plan> {
    if !context.module.lanes.contains(&function.name) {
        return None;
    }
    let longest = context.options.longest_function.min(LONGEST_LOOP);
    let plan = Plan::new(&function.program, &Flow::new(&function.program), longest);
    Some(plan.unwrap_or_else(|| unreachable!("`Module::lanes` have a form over lanes")))
}

/// The public functions for one state, the private functions called in loops over lanes, and the functions
/// over lanes (eight states at once).
pub(super) fn items(
    context: &Context<'_>,
    function: &Function,
    name: &Ident,
    plan: &Plan,
) -> Vec<TokenStream> {
    context.has_lanes.set(true);
    let body = Body::new(context, &function.program);
    let signature = Signature::new(&body);
    let angles = plan.angles.iter();
    let angles = angles.map(|&index| body.program.instructions[index].operation);
    let read: Vec<Operand> = angles.flat_map(operands).collect();
    let unused = parts::unused(&body, &plan.parts, read.into_iter());
    // The function for one state has its own text, because it would be slower if it called the bodies for
    // lanes.
    let mut items = straight::items(context, function, name);
    items.extend(scalar::items(&body, name, &signature, plan));
    items.extend(form::items(&body, name, plan, &unused));
    items
}
