//! Prints functions with loops over joints: straight-line code for the first arrays, then calls of the loops.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::Body;
use super::context::Context;
use super::doc_comment::DocComment;
use super::shared_rows::SharedRows;
use super::signature::{Signature, item};
use super::{lints, names, parts, public};
use crate::emit::arrays::{self, Row, is_only_result, table};
use crate::functions::function::Function;
use crate::program::arrays::{Arrays, Map, Pairs, Step};
use crate::program::split::{self, Part};
use crate::program::{Operand, Program, Shape};

/// Names of items and variables in functions with loops over joints. Other items must not have these names.
pub(super) const RESERVED: [&str; 15] = [
    "arrays",
    "sum_ancestors",
    "sum_subtrees",
    "collect",
    "project",
    "spread",
    "gather_carriers",
    "gather_last",
    "RELATIONS",
    "MEETINGS",
    "BLOCKS_BEFORE",
    "BLOCKS_BEYOND",
    "ROWS_OF_BLOCKS",
    "joint",
    "is_before",
];

/// The public functions, and the function of the straight-line code before the loops.
pub(super) fn items(
    context: &Context<'_>,
    function: &Function,
    form: &Arrays,
    name: &Ident,
) -> Vec<TokenStream> {
    let face = function.program.face();
    let body = Body::in_place(context, &face);
    let signature = Signature::new(&body);
    let emission = Emission::new(form, &body, name);
    let statements = emission.statements();
    let mut items = public::items(function, &body, name, &signature, &statements);
    items.extend(emission.setup_items(&signature));
    items
}

/// Place of an array's entries in the printed function.
#[derive(Clone)]
enum Place {
    /// The array is a constant of the module.
    Table(Ident),
    /// The array is a local variable of the function.
    Local(Ident),
    /// The array is a result of the function.
    Result(Ident),
}

pub(super) struct Emission<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) form: &'a Arrays,
    body: &'a Body<'a>,
    name: &'a Ident,
    pub(super) row: Row,
    places: Vec<Place>,
    /// Variables that store several arrays one after another, each with the number and length of its rows.
    variables: Vec<(Ident, [usize; 2])>,
    /// For each array, the index of its shared variable; `None` if the array has its own variable.
    shares: Vec<Option<usize>>,
}

impl<'a> Emission<'a> {
    fn new(form: &'a Arrays, body: &'a Body<'a>, name: &'a Ident) -> Self {
        let context = body.context;
        let mut taken = context.reserved.clone();
        taken.push("p".to_owned());
        taken.extend(body.arguments.iter().chain(&body.results).map(ToString::to_string));
        let locals = names::distinct(form.arrays.iter().map(|array| array.name.as_str()), &taken);
        let place = |(index, local): (usize, Ident)| {
            let output = form.outputs.iter().position(|output| output.array == index);
            match output {
                _ if table(form, index).is_some() => {
                    Place::Table(names::identifier(&local.to_string().to_uppercase()))
                }
                Some(output) if is_only_result(form, index) => Place::Result(body.results[output].clone()),
                _ => Place::Local(local),
            }
        };
        taken.extend(locals.iter().map(ToString::to_string));
        let (row, places) = (Row::new(form), locals.into_iter().enumerate().map(place).collect());
        let emission =
            Self { context, form, body, name, row, places, variables: Vec::new(), shares: Vec::new() };
        // If a row is one block, the compiler itself removes unnecessary variables.
        match row.is_one_block() {
            true => Self { shares: vec![None; form.arrays.len()], ..emission },
            false => emission.with_shared_rows(&taken),
        }
    }

    /// Assigns arrays to variables that several arrays use one after another.
    fn with_shared_rows(self, taken: &[String]) -> Self {
        let is_local = |array: usize| matches!(self.places[array], Place::Local(_));
        let shared = SharedRows::new(self.form, self.row, is_local);
        let names = names::distinct(shared.sizes.iter().map(|_| "rows"), taken);
        let variables = names.into_iter().zip(shared.sizes).collect();
        Self { variables, shares: shared.of_arrays, ..self }
    }

    /// All statements of the function with loops that writes its results in place.
    fn statements(&self) -> TokenStream {
        let tables = (0..self.form.setup.outputs.len()).filter_map(|index| self.table(index));
        let locals = (0..self.form.setup.outputs.len()).filter_map(|index| self.declaration(index));
        let setup = self.setup_call();
        let steps = self.form.steps.iter().map(|step| self.step(step));
        let copies = self
            .form
            .outputs
            .iter()
            .zip(&self.body.results)
            .filter_map(|(output, result)| self.copy(output.array, output.shape, result));
        let shared = self.variables.iter().map(|(name, size)| self.variable(name, *size));
        quote!(#(#tables)* #(#shared)* #(#locals)* #setup #(#steps)* #(#copies)*)
    }

    fn table(&self, array: usize) -> Option<TokenStream> {
        let Place::Table(name) = &self.places[array] else {
            return None;
        };
        let scalar = self.context.options.scalar;
        let (count, len) = (Literal::usize_unsuffixed(self.form.arrays[array].rows), self.length(array));
        let ty = quote!(arrays::Rows<#count, #len>);
        let zero = scalar.literal(0.0);
        let entries = table(self.form, array)?;
        let joints = self.form.joints.len();
        let padding = self.row.len - joints;
        let rows = entries.chunks(joints).map(|row| {
            let row = row
                .iter()
                .map(|&entry| scalar.literal(entry))
                .chain(std::iter::repeat_n(zero.clone(), padding));
            quote!([#(#row),*])
        });
        let allowed = lints::for_numbers(entries.iter().copied());
        Some(quote!(#allowed static #name: #ty = arrays::Rows([#(#rows),*]);))
    }

    /// Type in Rust of an array with `rows` rows over joints.
    fn ty(&self, rows: usize) -> TokenStream {
        let ty = self.context.ty();
        let (rows, lanes) = (Literal::usize_unsuffixed(rows), Literal::usize_unsuffixed(self.row.len));
        quote!([[#ty; #lanes]; #rows])
    }

    /// Length of a row of an array, including padding.
    fn length(&self, array: usize) -> Literal {
        Literal::usize_unsuffixed(self.row.of(self.form, array))
    }

    /// Declaration of a local variable: a new variable with zeros, or a reference to a shared variable.
    /// `None` if the array is not a local variable.
    fn declaration(&self, array: usize) -> Option<TokenStream> {
        let Place::Local(name) = &self.places[array] else {
            return None;
        };
        Some(match self.shares[array] {
            Some(shared) => {
                let shared = &self.variables[shared].0;
                quote!(let #name = &mut #shared;)
            }
            None => self.variable(name, [self.form.arrays[array].rows, self.row.of(self.form, array)]),
        })
    }

    fn variable(&self, name: &Ident, size: [usize; 2]) -> TokenStream {
        let zero = self.context.zero();
        let [rows, length] = size.map(Literal::usize_unsuffixed);
        quote!(let mut #name = arrays::Rows([[#zero; #length]; #rows]);)
    }

    fn read(&self, array: usize) -> TokenStream {
        match &self.places[array] {
            Place::Table(name) | Place::Local(name) => quote!(&#name.0),
            Place::Result(name) => quote!(#name),
        }
    }

    fn write(&self, array: usize) -> TokenStream {
        match &self.places[array] {
            Place::Table(name) | Place::Local(name) => quote!(&mut #name.0),
            Place::Result(name) => quote!(#name),
        }
    }

    /// Statement that copies a local array to a result; `None` if the array is not a local variable.
    fn copy(&self, array: usize, shape: Shape, result: &Ident) -> Option<TokenStream> {
        let Place::Local(name) = &self.places[array] else {
            return None;
        };
        let joints = Literal::usize_unsuffixed(self.form.coordinates().len());
        Some(match shape {
            Shape::Matrix(..) => quote! {
                for (to, from) in #result.iter_mut().zip(&#name.0) {
                    to.copy_from_slice(from.split_at(#joints).0);
                }
            },
            _ => quote!(#result.copy_from_slice(#name.0[0].split_at(#joints).0);),
        })
    }

    fn step(&self, step: &Step) -> TokenStream {
        match step {
            Step::Map(map) => self.map(map),
            Step::SumAncestors { from, to } => {
                let name = self.sum_ancestors();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::SumSubtrees { from, to } => {
                let name = self.sum_subtrees();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::Pairs(pairs) => self.pairs(pairs),
            Step::Collect { from, to } => {
                let name = self.collect();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::Project { from, to } => {
                let name = self.project();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::Spread { from, to } => {
                let name = self.spread();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::GatherCarriers { from, to } => {
                let name = self.gather_carriers();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::GatherLast { from, to } => {
                let name = self.gather_last();
                self.call(&quote!(#name), &[*from], *to)
            }
            Step::Invert { from, to } => self.invert(*from, *to),
            Step::NegativeProduct { left, right, to } => self.negative_product([*left, *right], *to),
            Step::Apply { matrix, vector, to } => self.call(&quote!(arrays::apply), &[*matrix, *vector], *to),
        }
    }

    /// Statements that invert a copy of a matrix, because a later step may read the matrix itself.
    fn invert(&self, from: usize, to: usize) -> TokenStream {
        let (Place::Local(matrix), Place::Local(inverse)) = (&self.places[from], &self.places[to]) else {
            unreachable!("matrices that are inverted, and their inverses, are local variables");
        };
        let copy = match self.shares[to] {
            Some(_) => {
                let declaration = self.declaration(to);
                quote!(#declaration #inverse.0 = #matrix.0;)
            }
            None => quote!(let mut #inverse = arrays::Rows(#matrix.0);),
        };
        let order = (!self.row.is_one_block()).then(|| self.pivots());
        quote! {
            #copy
            arrays::invert(&mut #inverse.0, #order);
        }
    }

    /// Arguments for the inversion of the mass matrix: the order of the pivots from the base, and the pairs
    /// of rows with common non-zero entries.
    fn pivots(&self) -> TokenStream {
        let tree = self.form.coordinates();
        let joints = Literal::usize_unsuffixed(tree.len());
        let order = match tree.order.is_sorted() {
            true => quote!(0..#joints),
            false => {
                let order = tree.order.iter();
                let order = order.map(|&joint| Literal::usize_unsuffixed(joint));
                quote!([#(#order),*].into_iter())
            }
        };
        let meet = match tree.is_chain() {
            true => quote!(|_, _| true),
            false => {
                let relations = match self.form.coordinates {
                    None => self.add_relations(),
                    Some(_) => self.add_meetings(),
                };
                quote!(|i, k| #relations[i][k] != 0)
            }
        };
        quote!(#order, #meet)
    }

    fn negative_product(&self, factors: [usize; 2], to: usize) -> TokenStream {
        let declaration = self.declaration(to);
        let ([left, right], to) = (factors.map(|array| self.read(array)), self.write(to));
        let rows = (!self.row.is_chain).then(|| {
            let rows = self.add_rows_of_blocks(factors[1]);
            quote!(, &#rows)
        });
        quote!(#declaration arrays::negative_product(#left, #right, #to #rows);)
    }

    fn call(&self, callee: &TokenStream, from: &[usize], to: usize) -> TokenStream {
        let declaration = self.declaration(to);
        let (from, to) = (from.iter().map(|&array| self.read(array)), self.write(to));
        quote!(#declaration #callee(#(#from,)* #to);)
    }

    fn pairs(&self, pairs: &Pairs) -> TokenStream {
        let declaration = self.declaration(pairs.to);
        let pair = |(i, j): (usize, usize)| {
            let (i, j) = (self.read(i), self.read(j));
            quote!((#i, #j))
        };
        let (before, beyond) = (pair(pairs.before), pair(pairs.beyond));
        let (diagonal, to) = (self.read(pairs.diagonal), self.write(pairs.to));
        let relations = (!self.form.is_chain()).then(|| {
            let (relations, [before, beyond]) = (self.add_relations(), self.add_blocks());
            quote!(, &#relations, [&#before, &#beyond])
        });
        quote! {
            #declaration
            arrays::pairs(#before, #beyond, #diagonal, #to #relations);
        }
    }

    /// Declarations of the arrays that a loop over joints writes, and call of the loop.
    fn map(&self, map: &Map) -> TokenStream {
        let callee = self.map_function(map);
        let written = map.writes.iter();
        let declarations = written.filter_map(|&array| self.declaration(array));
        let reads = map.reads.iter().map(|&array| self.read(array));
        let writes = map.writes.iter().map(|&array| self.write(array));
        quote!(#(#declarations)* #callee(#(#reads,)* #(#writes),*);)
    }

    fn map_function(&self, map: &Map) -> Ident {
        let mut body = Body::in_place(self.context, &map.body);
        body.column = Some(quote!([joint]));
        let inputs = body.program.inputs.iter().zip(&body.arguments);
        let inputs = inputs.map(|(input, name)| {
            let ty = self.ty(input.extent.len);
            quote!(#name: &#ty)
        });
        let outputs = body.program.outputs.iter().zip(&body.results);
        let outputs = outputs.map(|(output, name)| {
            let ty = self.ty(output.entries.len());
            quote!(#name: &mut #ty)
        });
        let arguments: Vec<TokenStream> = inputs.chain(outputs).collect();
        let constants = body.stores(|entry| body.made(entry).is_none());
        let statements = body.statements(0..body.program.instructions.len());
        let allowed = [
            Some(quote!(#[allow(clippy::needless_range_loop, reason = "one index for all arrays")])),
            lints::for_arguments(arguments.len()),
            lints::for_numbers(body.numbers()),
        ];
        let lanes = Literal::usize_unsuffixed(self.row.len);
        let statements = quote!(for joint in 0..#lanes { #(#constants)* #(#statements)* });
        self.context.shared.add(&map.name, |name| {
            item(
                &DocComment::new(&map.about),
                allowed.clone(),
                &quote!(fn #name(#(#arguments),*)),
                &statements,
            )
        })
    }

    fn setup_name(&self) -> Ident {
        format_ident!("{}_setup", self.name)
    }

    /// Indices of the arrays that the straight-line code before the loops fills.
    fn filled(&self) -> impl Iterator<Item = usize> {
        (0..self.form.setup.outputs.len()).filter(|&array| matches!(self.places[array], Place::Local(_)))
    }

    fn setup_call(&self) -> TokenStream {
        let name = self.setup_name();
        let arguments = self.body.arguments.iter().map(|name| quote!(#name));
        let arguments = arguments.chain(self.context.passed_parameters());
        let filled = self.filled().map(|array| self.write(array));
        quote!(#name(#(#arguments,)* #(#filled),*);)
    }

    /// The straight-line code before the loops as a function, which is split into parts if it is long.
    fn setup_items(&self, signature: &Signature) -> Vec<TokenStream> {
        let filled = self.filled();
        let program = Program {
            outputs: filled.map(|array| self.form.setup.outputs[array].clone()).collect(),
            ..self.form.setup.clone()
        };
        let (name, body) = (self.setup_name(), Body::in_place(self.context, &program));
        let split = split::parts(&program, &body.flow, self.context.options.longest_function);
        let mut items = vec![self.setup_item(&body, &split, signature)];
        items.extend(parts::items(&body, &name, signature, &split));
        items
    }

    fn setup_item(&self, body: &Body<'_>, split: &[Part], signature: &Signature) -> TokenStream {
        let name = self.setup_name();
        let statements = match split {
            [_] => {
                // Arrays are initialized with zeros.
                let is_known = |entry| !matches!(entry, Operand::Value(_) | Operand::Constant(0.0));
                let (constants, statements) = (body.stores(is_known), body.blocks());
                quote!(#(#constants)* #statements)
            }
            _ => parts::calls(body, &name, split),
        };
        let unused = parts::unused(body, split, body.program.entries());
        let filled = self.filled().zip(&body.results).map(|(array, name)| {
            let ty = self.ty(self.form.arrays[array].rows);
            quote!(#name: &mut #ty)
        });
        let arguments = signature.arguments.iter().cloned().chain(filled);
        let arguments: Vec<TokenStream> = arguments.collect();
        let about = arrays::about_setup(self.form);
        item(
            &DocComment::new(&format!("{about} `{}`; the arrays contain zeros before the call.", self.name)),
            [
                lints::for_names(body.value_names().chain(&body.arguments).chain([&name])),
                lints::for_numbers(body.numbers()),
                lints::for_arguments(arguments.len()),
            ],
            &quote!(fn #name(#(#arguments),*)),
            &quote!(#(let _ = #unused;)* #statements),
        )
    }
}
