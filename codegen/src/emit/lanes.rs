//! Many states at once: a function over eight states that stand side by side, with the bits of the scalar one.
//!
//! The scalar body is one inlined function that takes sines and cosines as arguments. Over lanes it stands in a loop
//! whose every index is written out: an inner loop or a closure over arrays would keep the compiler from making SIMD
//! code of it. Sines and cosines are made before, by loops of their own.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::Body;
use super::doc_comment::DocComment;
use super::function::{Signature, blocks};
use super::math::{self, Math};
use super::{Context, into, lints};
use crate::program::flow::operands;
use crate::program::{Operand, Operation, Output, Program, Shape};

/// States per call: one register of AVX-512, two of AVX2, four of SSE2 or Neon.
const LANES: usize = 8;

/// Names that the module takes for lanes.
pub(super) const RESERVED: [&str; 1] = ["Lanes"];

/// The type of eight values.
pub(super) fn item(context: &Context<'_>) -> TokenStream {
    let ty = context.options.scalar.ty();
    let len = Literal::usize_unsuffixed(LANES);
    quote! {
        #[doc = " One quantity of eight states side by side, aligned for SIMD registers."]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[repr(align(64))]
        pub struct Lanes(pub [#ty; #len]);
    }
}

/// How a function is split between its angles and the rest.
pub(super) struct Split {
    /// Instructions of the angles: what they are computed from, then each `SinCos`.
    angles: Vec<usize>,
    /// The instructions of the body.
    body: Vec<usize>,
    /// The sines and cosines that the body reads.
    takes: Vec<usize>,
    /// Input arrays that the body reads.
    inputs: Vec<usize>,
    reads_parameters: bool,
}

impl Split {
    /// `None` where a sine is needed of what is itself computed from a sine, or functions come from std.
    pub(super) fn new(context: &Context<'_>, body: &Body<'_>) -> Option<Self> {
        let program = body.program;
        let is_pair =
            |index: usize| matches!(program.instructions[index].operation, Operation::SinCos(_));
        let made = (0..program.instructions.len()).filter(|&index| body.flow.is_made(index));
        let angles: Vec<usize> = made.clone().filter(|&index| is_pair(index)).collect();
        let before = needed(
            program,
            angles
                .iter()
                .map(|&index| program.instructions[index].operation),
        );
        let is_late = made
            .clone()
            .any(|index| before[index] && !is_cheap(program, index));
        if is_late || context.options.math == Math::Std || angles.is_empty() {
            return None;
        }
        let body_needs = needed_by_results(program);
        let body_made = |index: &usize| body_needs[*index] && !is_trigonometric(program, *index);
        let instructions: Vec<usize> = made.clone().filter(body_made).collect();
        let takes = made.filter(|&index| body_needs[index] && is_trigonometric(program, index));
        let takes: Vec<usize> = takes.filter(|&index| body.flow.is_read[index]).collect();
        let read: Vec<Operand> = instructions
            .iter()
            .flat_map(|&index| operands(program.instructions[index].operation))
            .chain(
                program
                    .outputs
                    .iter()
                    .flat_map(|output| output.entries.iter().copied()),
            )
            .collect();
        let reads_array = |array: &usize| {
            read.iter()
                .any(|o| matches!(o, Operand::Input(read, _) if read == array))
        };
        Some(Self {
            angles: (0..program.instructions.len())
                .filter(|&index| before[index] || angles.contains(&index))
                .collect(),
            body: instructions,
            takes,
            inputs: (0..program.inputs.len()).filter(reads_array).collect(),
            reads_parameters: read.iter().any(|o| matches!(o, Operand::Parameter(_))),
        })
    }
}

fn is_trigonometric(program: &Program, index: usize) -> bool {
    matches!(
        program.instructions[index].operation,
        Operation::SinCos(_) | Operation::CosineOf(_)
    )
}

fn is_cheap(program: &Program, index: usize) -> bool {
    !is_trigonometric(program, index)
        && !matches!(program.instructions[index].operation, Operation::Call(..))
}

/// What operations need, sines and cosines included.
fn needed(program: &Program, operations: impl Iterator<Item = Operation>) -> Vec<bool> {
    let mut needed = vec![false; program.instructions.len()];
    operations
        .flat_map(operands)
        .for_each(|operand| mark(&mut needed, operand));
    for index in (0..needed.len()).rev() {
        if needed[index] {
            operands(program.instructions[index].operation)
                .for_each(|operand| mark(&mut needed, operand));
        }
    }
    needed
}

/// What the results need beside the angles.
fn needed_by_results(program: &Program) -> Vec<bool> {
    let mut needed = vec![false; program.instructions.len()];
    let results = program.outputs.iter().flat_map(|output| &output.entries);
    results.for_each(|&entry| mark(&mut needed, entry));
    for index in (0..needed.len()).rev() {
        if needed[index] && !is_trigonometric(program, index) {
            operands(program.instructions[index].operation)
                .for_each(|operand| mark(&mut needed, operand));
        }
    }
    needed
}

fn mark(needed: &mut [bool], operand: Operand) {
    if let Operand::Value(value) = operand {
        needed[value] = true;
    }
}

/// The statements of the scalar function: its angles, then the body.
pub(super) fn scalar_statements(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    split: &Split,
) -> TokenStream {
    let end = split.angles.last().map_or(0, |&last| last + 1);
    let angles = body.statements_among(0..end, |index| split.angles.contains(&index));
    let takes = split.takes.iter().map(|&value| body.name(value));
    let inputs = split.inputs.iter().map(|&input| &body.arguments[input]);
    let parameters = split.parameters(context);
    let (results, callee) = (&body.results, body_name(name));
    quote!(#(#angles)* #callee([#(#takes),*], #(#inputs,)* #parameters #(#results),*))
}

impl Split {
    fn parameters(&self, context: &Context<'_>) -> Option<TokenStream> {
        (self.reads_parameters && context.has_parameters()).then(|| quote!(p,))
    }
}

fn body_name(name: &Ident) -> Ident {
    format_ident!("{}_body", name)
}

/// The body and the functions over lanes.
pub(super) fn items(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    split: &Split,
) -> Vec<TokenStream> {
    let lanes = Form::new(context, body, name, signature);
    vec![
        body_item(context, body, name, signature, split),
        lanes.each(split),
        lanes.public("", None),
        lanes.public("_avx2", Some("avx2")),
        lanes.public("_avx512", Some("avx512f,avx512bw,avx512dq,avx512vl")),
    ]
}

fn body_item(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    split: &Split,
) -> TokenStream {
    let ty = context.options.scalar.ty();
    let callee = body_name(name);
    let takes = split.takes.iter().map(|&value| body.name(value));
    let count = Literal::usize_unsuffixed(split.takes.len());
    let inputs = split
        .inputs
        .iter()
        .map(|&input| &signature.arguments[input]);
    let parameters = split.parameters(context).map(|_| quote!(p: &Parameters,));
    let results = body.results.iter().zip(&signature.results);
    let results: Vec<TokenStream> = results.map(|(name, ty)| quote!(#name: &mut #ty)).collect();
    let constants = into::stores(body, |made| made.is_none());
    let (taken_results, arrow, value) = match results.is_empty() {
        true => {
            let (result, value) = (&signature.result, body.returned());
            (vec![], Some(quote!(-> #result)), Some(value))
        }
        false => {
            let taken = split.takes.clone();
            (
                into::stores(body, |made| made.is_some_and(|made| taken.contains(&made))),
                None,
                None,
            )
        }
    };
    let constants = if results.is_empty() {
        vec![]
    } else {
        constants
    };
    let statements = blocks(body, |index| split.body.binary_search(&index).is_ok());
    let documentation = DocComment::new(&format!("`{name}` from sines and cosines.")).tokens();
    let allowed = [
        lints::for_names(body.value_names().chain(&body.arguments).chain([name])),
        lints::for_numbers(body.numbers()),
        lints::for_result(&signature.dimensions),
        lints::for_arguments(2 + split.inputs.len() + results.len()),
    ];
    let allowed = allowed.iter().flatten();
    quote! {
        #documentation
        #[inline(always)]
        #(#allowed)*
        fn #callee([#(#takes),*]: [#ty; #count], #(#inputs,)* #parameters #(#results),*) #arrow {
            #(#constants)* #(#taken_results)* #statements #value
        }
    }
}

/// What the functions over lanes have in common.
struct Form<'a> {
    context: &'a Context<'a>,
    body: &'a Body<'a>,
    name: &'a Ident,
    /// Arguments with their types.
    arguments: Vec<TokenStream>,
    /// Names of the arguments.
    names: Vec<Ident>,
    /// Names of the results.
    results: Vec<Ident>,
}

impl<'a> Form<'a> {
    fn new(
        context: &'a Context<'a>,
        body: &'a Body<'a>,
        name: &'a Ident,
        signature: &Signature,
    ) -> Self {
        let mut taken = context.reserved.clone();
        taken.extend(["p", "lane", "angles", "sines", "cosines", "result"].map(str::to_owned));
        taken.extend(body.arguments.iter().map(ToString::to_string));
        let results = into::result_names(body.program, &taken);
        let inputs = body.program.inputs.iter().zip(&body.arguments).enumerate();
        let inputs = inputs.map(|(index, (_, name))| {
            let len = &signature.lengths[index];
            quote!(#name: &[Lanes; #len])
        });
        let parameters = context.has_parameters().then(|| quote!(p: &Parameters));
        let outputs = body
            .program
            .outputs
            .iter()
            .zip(&results)
            .zip(&signature.shapes);
        let outputs = outputs.map(|((_, name), lengths)| {
            let ty = lengths
                .iter()
                .rev()
                .fold(quote!(Lanes), |entry, len| quote!([#entry; #len]));
            quote!(#name: &mut #ty)
        });
        let mut names = body.arguments.clone();
        names.extend(context.has_parameters().then(|| format_ident!("p")));
        names.extend(results.iter().cloned());
        Self {
            arguments: inputs.chain(parameters).chain(outputs).collect(),
            context,
            body,
            name,
            names,
            results,
        }
    }

    fn allowed(&self) -> Vec<TokenStream> {
        let allowed = [
            lints::for_arguments(self.arguments.len()),
            lints::for_names(
                self.body
                    .value_names()
                    .chain(&self.names)
                    .chain([self.name]),
            ),
            lints::for_numbers(self.body.numbers()),
        ];
        allowed.into_iter().flatten().collect()
    }

    /// The loop, inlined into one function for each instruction set.
    fn each(&self, split: &Split) -> TokenStream {
        let (each, arguments, allowed) = (self.each_name(), &self.arguments, self.allowed());
        let documentation = DocComment::new(&format!("`{}` of eight states.", self.name)).tokens();
        let (angles, body) = (self.angles(split), self.loop_body(split));
        let end = Literal::usize_unsuffixed(LANES);
        let unused = self.unused(split);
        quote! {
            #documentation
            #[inline(always)]
            #(#allowed)*
            fn #each(#(#arguments),*) {
                #(let _ = #unused;)*
                #angles
                for lane in 0..#end { #body }
            }
        }
    }

    fn unused(&self, split: &Split) -> Vec<&Ident> {
        let read = split
            .angles
            .iter()
            .flat_map(|&index| operands(self.body.program.instructions[index].operation));
        let read: Vec<Operand> = read.collect();
        let is_read = |array: usize| {
            split.inputs.contains(&array)
                || read
                    .iter()
                    .any(|o| matches!(o, Operand::Input(read, _) if *read == array))
        };
        let inputs = self
            .body
            .arguments
            .iter()
            .enumerate()
            .filter(|(array, _)| !is_read(*array));
        let reads_parameters =
            split.reads_parameters || read.iter().any(|o| matches!(o, Operand::Parameter(_)));
        let p = self.names.get(self.body.arguments.len());
        let p = p.filter(|_| self.context.has_parameters() && !reads_parameters);
        inputs.map(|(_, name)| name).chain(p).collect()
    }

    fn angles(&self, split: &Split) -> TokenStream {
        let zero = self.context.options.scalar.literal(0.0);
        let is_pair = |index: &&usize| {
            matches!(
                self.body.program.instructions[**index].operation,
                Operation::SinCos(_)
            )
        };
        let pairs: Vec<usize> = split.angles.iter().filter(is_pair).copied().collect();
        let sums = self.body.statements_in_lane(
            split
                .angles
                .iter()
                .copied()
                .filter(|index| !pairs.contains(index)),
        );
        let (count, len) = (
            Literal::usize_unsuffixed(pairs.len()),
            Literal::usize_unsuffixed(LANES),
        );
        let values = pairs.iter().enumerate().filter_map(|(k, &index)| {
            let Operation::SinCos(angle) = self.body.program.instructions[index].operation else {
                return None;
            };
            let (k, angle) = (
                Literal::usize_unsuffixed(k),
                self.body.operand_in_lane(angle),
            );
            Some(quote!(angles[#k].0[lane] = #angle;))
        });
        let call = math::sin_cos_array(self.context, &quote!(angles[k].0));
        quote! {
            let mut angles = [Lanes([#zero; #len]); #count];
            for lane in 0..#len { #(#sums)* #(#values)* }
            let (mut sines, mut cosines) = (angles, angles);
            for k in 0..#count { (sines[k].0, cosines[k].0) = #call; }
        }
    }

    fn loop_body(&self, split: &Split) -> TokenStream {
        let is_pair = |index: &usize| {
            matches!(
                self.body.program.instructions[*index].operation,
                Operation::SinCos(_)
            )
        };
        let pairs: Vec<usize> = split.angles.iter().copied().filter(is_pair).collect();
        let takes = split.takes.iter().map(|&value| {
            let pair = self.body.flow.made_at[value];
            let k = Literal::usize_unsuffixed(
                pairs.iter().position(|&index| index == pair).unwrap_or(0),
            );
            match pair == value {
                true => quote!(sines[#k].0[lane]),
                false => quote!(cosines[#k].0[lane]),
            }
        });
        let inputs = split.inputs.iter().map(|&input| {
            let name = &self.body.arguments[input];
            let entries = (0..self.body.program.inputs[input].len).map(Literal::usize_unsuffixed);
            quote!(&[#(#name[#entries].0[lane]),*])
        });
        let parameters = split.parameters(self.context);
        let callee = body_name(self.name);
        let locals: Vec<Ident> = (1..=self.results.len())
            .map(|k| format_ident!("result_{}", k))
            .collect();
        let outputs = self
            .body
            .program
            .outputs
            .iter()
            .zip(&self.results)
            .zip(&locals);
        let stores = outputs.flat_map(|((output, result), local)| copies(output, result, local));
        if self.body.results.is_empty() {
            let locals = match locals.as_slice() {
                [local] => quote!(#local),
                _ => quote!((#(#locals),*)),
            };
            return quote! {
                let #locals = #callee([#(#takes),*], #(#inputs,)* #parameters);
                #(#stores)*
            };
        }
        let zero = self.context.options.scalar.literal(0.0);
        let zeros = self
            .body
            .program
            .outputs
            .iter()
            .map(|output| into::zeros(output.shape, &zero));
        quote! {
            #(let mut #locals = #zeros;)*
            #callee([#(#takes),*], #(#inputs,)* #parameters #(&mut #locals),*);
            #(#stores)*
        }
    }

    fn each_name(&self) -> Ident {
        format_ident!("{}_each", self.name)
    }

    /// The function for one instruction set; never inlined, since in a caller's loop the lanes would be undone.
    fn public(&self, suffix: &str, features: Option<&str>) -> TokenStream {
        let (each, arguments, names) = (self.each_name(), &self.arguments, &self.names);
        let name = format_ident!("{}_lanes{}", self.name, suffix);
        let mut documentation = DocComment::new(&format!(
            "`{}` of eight states, the same bits as of each{}.",
            self.name,
            features.map_or(String::new(), |features| format!(
                "; for processors with {}",
                features.split(',').next().unwrap_or_default()
            ))
        ));
        documentation.paragraph("Nothing that stood in the results is read.");
        if features.is_some() {
            documentation.heading("Safety");
            documentation.paragraph(
                "The processor must have these instructions: `is_x86_feature_detected!` tells.",
            );
        }
        let documentation = documentation.tokens();
        let allowed = lints::for_arguments(self.arguments.len());
        let features = features.map(|features| {
            quote! {
                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = #features)]
            }
        });
        quote! {
            #documentation
            #features
            #[inline(never)]
            #allowed
            pub fn #name(#(#arguments),*) { #each(#(#names),*); }
        }
    }
}

/// Copies each entry of one lane's result.
fn copies(output: &Output, result: &Ident, local: &Ident) -> Vec<TokenStream> {
    let literal = Literal::usize_unsuffixed;
    (0..output.entries.len())
        .map(|index| match output.shape {
            Shape::Scalar => quote!(#result.0[lane] = #local;),
            Shape::Vector(_) => {
                let index = literal(index);
                quote!(#result[#index].0[lane] = #local[#index];)
            }
            Shape::Matrix(_, columns) => {
                let (row, column) = (literal(index / columns), literal(index % columns));
                quote!(#result[#row][#column].0[lane] = #local[#row][#column];)
            }
        })
        .collect()
}
