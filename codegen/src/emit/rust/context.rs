//! State that all parts of the printer share while a module is printed.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

use gelenk_kernels::math::Kernel;
use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::names;
use crate::emit::options::EmitOptions;
use crate::module::Module;

/// A module and the names in it while it is printed as Rust.
pub(super) struct Context<'a> {
    pub(super) module: &'a Module,
    pub(super) options: &'a EmitOptions,
    /// Names of the free parameters as fields of `Parameters`.
    pub(super) parameters: Vec<Ident>,
    /// Names of the functions, in the order of the module.
    pub(super) functions: Vec<Ident>,
    /// Elementary functions that the printed text calls.
    pub(super) calls: Calls,
    /// Whether a function over lanes (eight states at once) was printed.
    pub(super) has_lanes: Cell<bool>,
    /// Whether a function for eight states at once stores values between its loops.
    pub(super) has_groups: Cell<bool>,
    /// Names that arguments and values must not have. For example, the name of a constant in a pattern would
    /// match the constant.
    pub(super) reserved: Vec<String>,
    /// Private functions for loops over joints, which several functions may call.
    pub(super) shared: Shared,
}

impl<'a> Context<'a> {
    /// Begins to print a module.
    ///
    /// - `reserved`: names of items of the module itself, which the robot's functions must not have
    pub(super) fn new(module: &'a Module, options: &'a EmitOptions, mut reserved: Vec<String>) -> Self {
        let parameters = module.parameters.iter().map(|each| each.name.as_str());
        let functions = module.functions.iter().map(|function| function.name.as_str());
        let functions = names::distinct(functions, &reserved);
        reserved.extend(functions.iter().map(ToString::to_string));
        Self {
            module,
            options,
            parameters: names::distinct(parameters, &[]),
            functions,
            calls: Calls::default(),
            has_lanes: Cell::new(false),
            has_groups: Cell::new(false),
            shared: Shared::default(),
            reserved,
        }
    }

    pub(super) fn has_parameters(&self) -> bool {
        !self.parameters.is_empty()
    }

    /// Argument of a call for the free parameters; `None` if there are no free parameters.
    pub(super) fn passed_parameters(&self) -> Option<TokenStream> {
        self.has_parameters().then(|| quote!(p))
    }

    /// Declaration of the argument for the free parameters; `None` if there are no free parameters.
    pub(super) fn declared_parameters(&self) -> Option<TokenStream> {
        self.has_parameters().then(|| quote!(p: &Parameters))
    }

    /// Number type in Rust: `f64` or `f32`.
    pub(super) fn ty(&self) -> TokenStream {
        self.options.scalar.ty()
    }

    /// Literal of zero in the number type.
    pub(super) fn zero(&self) -> TokenStream {
        self.options.scalar.literal(0.0)
    }
}

/// Elementary functions that the printed functions call.
#[derive(Debug, Default)]
pub(super) struct Calls {
    pub(super) kernels: RefCell<BTreeSet<Kernel>>,
    pub(super) sign: Cell<bool>,
}

/// Private items that several functions use, by name.
#[derive(Debug, Default)]
pub(super) struct Shared {
    items: RefCell<BTreeMap<String, TokenStream>>,
}

impl Shared {
    /// Removes and returns all items, sorted by name.
    pub(super) fn take(&self) -> Vec<TokenStream> {
        self.items.take().into_values().collect()
    }

    /// Adds an item if it was not yet added, and returns its name. The name gets a number if another item
    /// already has the name `stem`.
    pub(super) fn add(&self, stem: &str, item: impl Fn(&Ident) -> TokenStream) -> Ident {
        let mut items = self.items.borrow_mut();
        let mut number = 1;
        let mut name = stem.to_owned();
        loop {
            let identifier = names::identifier(&name);
            let tokens = item(&identifier);
            match items.get(&name) {
                Some(other) if other.to_string() != tokens.to_string() => {
                    number += 1;
                    name = format!("{stem}_{number}");
                }
                Some(_) => return identifier,
                None => {
                    items.insert(name, tokens);
                    return identifier;
                }
            }
        }
    }
}
