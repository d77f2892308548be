//! Functions over eight states side by side, with the same bits as functions over one state.
//!
//! Sines and cosines are computed first, in a separate loop. The rest are inlined functions of one state. The
//! scalar function calls them once, the function over lanes in a loop over the states. A loop with all
//! indices written out becomes SIMD code however long its body is; an inner loop, or arrays of lanes with
//! operators, would prevent this. A long function is divided into several such loops ([`Plan`]).

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

/// States per call: one register of AVX-512, two of AVX2, four of SSE2 or Neon.
const LANES: usize = 8;

/// Statements of one loop over the states. `linearize` of UR5 and Panda, ns per state, AVX2 and AVX-512
/// (EPYC, Zen 4):
///
/// | statements | UR5 | | Panda | |
/// |---|---|---|---|---|
/// | 40 | 80 | 60 | 267 | 141 |
/// | 60 | 83 | 60 | 225 | 134 |
/// | 100 | 76 | 60 | 224 | 134 |
/// | 160 | 76 | 61 | 226 | 138 |
/// | 250 | 83 | 80 | 241 | 163 |
/// | 500 | 106 | 75 | 417 | 295 |
///
/// The values between loops stand on the stack, each in a place of its own: with places that later values
/// take again they could not move to registers (95 to 128 ns).
const LONGEST_LOOP: usize = 100;

/// Names reserved for lanes.
pub(super) const RESERVED: [&str; 3] = ["Lanes", "Group", "LINEARIZE_LANES"];

/// Types that the printed functions use: eight values, and the values between the loops of a function.
pub(super) fn types(context: &Context<'_>) -> Vec<TokenStream> {
    let (ty, len) = (context.ty(), Literal::usize_unsuffixed(LANES));
    let lanes = context.has_lanes.get().then(|| {
        quote! {
            #[doc = " One quantity of eight states side by side, aligned for SIMD registers."]
            #[derive(Debug, Clone, Copy, PartialEq)]
            #[repr(align(64))]
            pub struct Lanes(pub [#ty; #len]);
        }
    });
    let group = context.has_groups.get().then(|| {
        quote! {
            #[doc = " One quantity of those states that are computed at a time."]
            #[derive(Clone, Copy)]
            #[repr(align(64))]
            struct Group<const W: usize>([#ty; W]);
        }
    });
    lanes.into_iter().chain(group).collect()
}

/// Division of a function over lanes into loops; `None` if it is not requested over lanes.
pub(super) fn plan(context: &Context<'_>, function: &Function) -> Option<Plan> {
    if !context.module.lanes.contains(&function.name) {
        return None;
    }
    let longest = context.options.longest_function.min(LONGEST_LOOP);
    let plan = Plan::new(&function.program, &Flow::new(&function.program), longest);
    Some(plan.unwrap_or_else(|| unreachable!("`Module::lanes` have a form over lanes")))
}

/// The public functions of one state, their bodies, and the functions over lanes.
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
    // The bodies as they are cut for lanes would make a slower function of one state.
    let mut items = straight::items(context, function, name);
    items.extend(scalar::items(&body, name, &signature, plan));
    items.extend(form::items(&body, name, plan, &unused));
    items
}
