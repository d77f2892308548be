//! Prints functions over lanes, which evaluate eight states at once. One text is compiled for several
//! instruction sets.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::super::body::{Body, place, result_names, tuple};
use super::super::context::Context;
use super::super::doc_comment::DocComment;
use super::super::signature::{in_rows, inputs, item, result, zeros};
use super::super::{lints, math};
use super::LANES;
use super::scalar::body_name;
use crate::emit::options::Scalar;
use crate::program::lanes::Plan;
use crate::program::{Operand, Operation, Output};

/// Instruction set for which a function is compiled: the compiler's target, or an extension of it.
#[derive(Clone, Copy)]
enum InstructionSet {
    Target,
    Avx2,
    Avx512,
}

impl InstructionSet {
    const ALL: [Self; 3] = [Self::Target, Self::Avx2, Self::Avx512];

    /// Suffix of the function's name for this instruction set.
    fn suffix(self) -> &'static str {
        match self {
            Self::Target => "",
            Self::Avx2 => "_avx2",
            Self::Avx512 => "_avx512",
        }
    }

    /// Features of the processor that the function requires; `None` for the compiler's target.
    fn features(self) -> Option<&'static str> {
        match self {
            Self::Target => None,
            Self::Avx2 => Some("avx2"),
            Self::Avx512 => Some("avx512f,avx512bw,avx512dq,avx512vl"),
        }
    }

    /// Number of states that the text computes at a time. These states fit in one register, so there is no
    /// loop over registers that the compiler could unroll.
    ///
    /// With eight states in two AVX2 registers, `linearize` of a UR5 did not fit in the instruction cache and
    /// took 114 ns instead of 76 ns per state.
    fn width(self, scalar: Scalar) -> usize {
        match (self, scalar) {
            (Self::Avx512, _) | (Self::Avx2, Scalar::F32) => LANES,
            (Self::Avx2, Scalar::F64) | (Self::Target, _) => LANES / 2,
        }
    }
}

/// Name of the function whose versions for each instruction set are listed in a table. The runtime selects
/// one of them.
const TABLED: &str = "linearize";

/// Names of variables in functions for eight states at once. Arguments and values must not have these names.
const LOCALS: [&str; 8] = ["p", "group", "lane", "W", "angles", "sines", "cosines", "values"];

/// The loops over states, and one public function for each instruction set.
///
/// - `unused`: arguments that the text does not use
pub(super) fn items(body: &Body<'_>, name: &Ident, plan: &Plan, unused: &[TokenStream]) -> Vec<TokenStream> {
    let form = Form::new(body, name, plan);
    let mut items = vec![form.each(unused)];
    items.extend(InstructionSet::ALL.map(|set| form.public(set)));
    items.extend((name == TABLED).then(|| form.table()));
    items
}

/// Parts of the text that the functions of all instruction sets have in common.
struct Form<'a> {
    context: &'a Context<'a>,
    /// The function's body for one lane (one of eight states).
    body: Body<'a>,
    plan: &'a Plan,
    name: &'a Ident,
    /// Arguments of the function with their types.
    arguments: Vec<TokenStream>,
    /// Names of the function's arguments.
    names: Vec<Ident>,
    /// Names of the function's results.
    results: Vec<Ident>,
    /// For each part of the function, the name of the array of values that later parts read.
    values: Vec<Ident>,
}

impl<'a> Form<'a> {
    fn new(body: &'a Body<'a>, name: &'a Ident, plan: &'a Plan) -> Self {
        let context = body.context;
        let mut taken = context.reserved.clone();
        taken.extend(LOCALS.map(str::to_owned));
        taken.extend(body.arguments.iter().map(ToString::to_string));
        let results = result_names(body.program, &taken);
        let (lanes, parameters) = (quote!(Lanes), context.declared_parameters());
        let outputs = body.program.outputs.iter().zip(&results);
        let outputs = outputs.map(|(output, name)| {
            let ty = result(output, &lanes);
            quote!(#name: &mut #ty)
        });
        let arguments = inputs(body, &lanes).chain(parameters.clone());
        let mut names = body.arguments.clone();
        names.extend(parameters.map(|_| format_ident!("p")));
        names.extend(results.iter().cloned());
        let values = 1..=plan.parts.len();
        Self {
            arguments: arguments.chain(outputs).collect(),
            context,
            body: body.with_column(quote!(.0[W * group + lane])),
            plan,
            name,
            names,
            results,
            values: values.map(|part| format_ident!("values_{}", part)).collect(),
        }
    }

    /// The private function with the loops over states. It is inlined into the function for each instruction
    /// set.
    fn each(&self, unused: &[TokenStream]) -> TokenStream {
        let (each, arguments) = (self.each_name(), &self.arguments);
        let documentation = format!("`{}` for eight states, `W` states at a time.", self.name);
        let names = self.body.value_names().chain(&self.names);
        let len = Literal::usize_unsuffixed(LANES);
        let angles = self.angles();
        let parts = 0..self.plan.parts.len();
        let loops = parts.map(|index| self.part(index));
        item(
            &DocComment::new(&documentation),
            [
                Some(quote!(#[inline(always)])),
                lints::for_arguments(arguments.len()),
                lints::for_names(names.chain([self.name])),
                lints::for_numbers(self.body.numbers()),
            ],
            &quote!(fn #each<const W: usize>(#(#arguments),*)),
            &quote! {
                #(let _ = #unused;)*
                for group in 0..#len / W {
                    #angles
                    #(#loops)*
                }
            },
        )
    }

    /// Statements that compute sines and cosines of all angles.
    fn angles(&self) -> TokenStream {
        let plan = self.plan;
        if plan.pairs.is_empty() {
            return quote!();
        }
        let sums = plan.angles.iter().copied();
        let sums = sums.filter(|index| plan.pairs.binary_search(index).is_err());
        let sums = sums.flat_map(|index| self.body.statements(index..index + 1));
        let values = plan.pairs.iter().enumerate().map(|(k, &index)| {
            let Operation::SinCos(angle) = self.body.program.instructions[index].operation else {
                unreachable!("the plan's pairs are sines with their cosines");
            };
            let (k, angle) = (Literal::usize_unsuffixed(k), self.body.operand(angle));
            quote!(angles[#k].0[lane] = #angle;)
        });
        let calls = (0..plan.pairs.len()).map(|k| {
            let k = Literal::usize_unsuffixed(k);
            let arguments = quote!(&angles[#k].0, &mut sines[#k].0, &mut cosines[#k].0);
            math::sin_cos_lanes(self.context, &arguments)
        });
        let array = self.array(plan.pairs.len());
        quote! {
            let mut angles = #array;
            for lane in 0..W { #(#sums)* #(#values)* }
            let (mut sines, mut cosines) = (#array, #array);
            #(#calls;)*
        }
    }

    /// Array of `count` groups of states with the value zero.
    fn array(&self, count: usize) -> TokenStream {
        self.context.has_groups.set(true);
        let zero = self.context.zero();
        let count = Literal::usize_unsuffixed(count);
        quote!([Group([#zero; W]); #count])
    }

    /// The loop over the states for one part of the function.
    fn part(&self, index: usize) -> TokenStream {
        let part = &self.plan.parts[index];
        let callee = body_name(self.name, self.plan, index);
        let takes = part.takes.iter().map(|&value| self.taken(value));
        let takes = (!part.takes.is_empty()).then(|| quote!([#(#takes),*],));
        let inputs = part.inputs.iter().map(|&input| {
            let extent = self.body.program.inputs[input].extent;
            let entries = (0..extent.len).map(|entry| self.body.operand(Operand::Input(input, entry)));
            let nested = in_rows(extent, entries.collect());
            quote!(&#nested)
        });
        let parameters = self.context.passed_parameters();
        let parameters = parameters.filter(|_| part.reads_parameters).into_iter();
        let arguments = quote!(#takes #(#inputs,)* #(#parameters,)*);
        let body = match self.body.results.is_empty() {
            true => self.returning(index, &quote!(#callee(#arguments))),
            false => self.storing(index, &callee, &arguments),
        };
        let values = &self.values[index];
        let array = (!part.returns.is_empty()).then(|| {
            let array = self.array(part.returns.len());
            quote!(let mut #values = #array;)
        });
        quote! {
            #array
            for lane in 0..W { #body }
        }
    }

    /// Tokens of a value that a part of the function reads: a sine, a cosine or a value of an earlier part.
    fn taken(&self, value: usize) -> TokenStream {
        let made_at = self.body.flow.made_at[value];
        if let Ok(k) = self.plan.pairs.binary_search(&made_at) {
            let k = Literal::usize_unsuffixed(k);
            return match made_at == value {
                true => quote!(sines[#k].0[lane]),
                false => quote!(cosines[#k].0[lane]),
            };
        }
        let parts = self.plan.parts.iter().zip(&self.values);
        let mut places = parts.filter_map(|(part, values)| {
            let k = part.returns.binary_search(&value).ok()?;
            let k = Literal::usize_unsuffixed(k);
            Some(quote!(#values[#k].0[lane]))
        });
        let place = places.next();
        place.unwrap_or_else(|| unreachable!("an earlier part returns what a part takes"))
    }

    /// Statements for one part of a function that returns its results. Only the last part has results.
    fn returning(&self, index: usize, call: &TokenStream) -> TokenStream {
        if index + 1 < self.plan.parts.len() {
            let stores = self.handed_on(index);
            return quote!(let values = #call; #(#stores)*);
        }
        let locals = self.locals();
        let outputs = self.body.program.outputs.iter().zip(&self.results);
        let stores = outputs
            .zip(&locals)
            .flat_map(|((output, result), local)| copies(output, result, local, 0..output.entries.len()));
        let locals = tuple(locals.iter().map(|local| quote!(#local)));
        quote!(let #locals = #call; #(#stores)*)
    }

    /// Statements for one part of a function that writes its results in place. They copy the results of one
    /// state to the results of all states.
    fn storing(&self, index: usize, callee: &Ident, arguments: &TokenStream) -> TokenStream {
        let part = &self.plan.parts[index];
        let all = self.locals();
        let locals: Vec<&Ident> = part.results.iter().map(|(result, _)| &all[*result]).collect();
        let zeros = part.results.iter().map(|(result, _)| {
            let output = &self.body.program.outputs[*result];
            zeros(output.shape, self.context.zero())
        });
        let call = quote!(#callee(#arguments #(&mut #locals),*));
        let call = match part.returns.is_empty() {
            true => quote!(#call;),
            false => quote!(let values = #call;),
        };
        let copies = part.results.iter().flat_map(|(result, entries)| {
            let output = &self.body.program.outputs[*result];
            let (place, local) = (&self.results[*result], &all[*result]);
            copies(output, place, local, entries.iter().copied())
        });
        let handed_on = self.handed_on(index);
        quote! {
            #(let mut #locals = #zeros;)*
            #call
            #(#handed_on)*
            #(#copies)*
        }
    }

    fn handed_on(&self, index: usize) -> Vec<TokenStream> {
        let values = &self.values[index];
        let stores = (0..self.plan.parts[index].returns.len()).map(|k| {
            let k = Literal::usize_unsuffixed(k);
            quote!(#values[#k].0[lane] = values[#k];)
        });
        stores.collect()
    }

    /// Names of local variables for the results of one state.
    fn locals(&self) -> Vec<Ident> {
        let results = 1..=self.results.len();
        results.map(|k| format_ident!("result_{}", k)).collect()
    }

    fn each_name(&self) -> Ident {
        format_ident!("{}_each", self.name)
    }

    /// The constant table with the function's version for each instruction set.
    fn table(&self) -> TokenStream {
        let (arguments, name) =
            (&self.arguments, format_ident!("{}_LANES", self.name.to_string().to_uppercase()));
        let forms = InstructionSet::ALL.map(|set| format_ident!("{}_lanes{}", self.name, set.suffix()));
        let any = &forms[0];
        let documentation = format!(
            "The versions of `{any}` for any processor, for avx2 and for avx512f. The runtime selects one of them."
        );
        let documentation = DocComment::new(&documentation).tokens();
        quote! {
            #documentation
            #[allow(clippy::type_complexity, reason = "blocks of fixed size need no type of their own")]
            pub const #name: [unsafe fn(#(#arguments),*); 3] = {
                #[cfg(target_arch = "x86_64")]
                { [#(#forms),*] }
                #[cfg(not(target_arch = "x86_64"))]
                { [#any; 3] }
            };
        }
    }

    /// The public function for one instruction set. It is never inlined. Inside a loop of the caller, the
    /// compiler would undo the vectorization over states.
    fn public(&self, set: InstructionSet) -> TokenStream {
        let (each, arguments, names) = (self.each_name(), &self.arguments, &self.names);
        let name = format_ident!("{}_lanes{}", self.name, set.suffix());
        let width = Literal::usize_unsuffixed(set.width(self.context.options.scalar));
        let features = set.features();
        let first = features.and_then(|features| features.split(',').next());
        let needed = first.map_or(String::new(), |first| format!("; for processors with {first}"));
        let documentation =
            format!("`{}` for eight states, bit-identical to single calls{needed}.", self.name);
        let mut documentation = DocComment::new(&documentation);
        documentation.paragraph("Previous values of the results are not read.");
        if first.is_some() {
            documentation.heading("Safety");
            documentation.paragraph(
                "The processor must have these instructions. Check this with `is_x86_feature_detected!`.",
            );
        }
        let features = features.map(|features| {
            quote! {
                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = #features)]
            }
        });
        item(
            &documentation,
            [features, Some(quote!(#[inline(never)])), lints::for_arguments(self.arguments.len())],
            &quote!(pub fn #name(#(#arguments),*)),
            &quote!(#each::<#width>(#(#names),*);),
        )
    }
}

/// Statements that copy entries of one state's result to the result of all states.
fn copies(
    output: &Output,
    result: &Ident,
    local: &Ident,
    entries: impl Iterator<Item = usize>,
) -> Vec<TokenStream> {
    let copies = entries.map(|index| {
        let (to, from) = (place(output, result, index), place(output, local, index));
        quote!(#to.0[W * group + lane] = #from;)
    });
    copies.collect()
}
