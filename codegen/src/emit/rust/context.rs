//! State shared by all parts of a module during printing.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

use gelenk_kernels::math::Kernel;
use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::names;
use crate::emit::options::EmitOptions;
use crate::module::Module;

/// A module during printing.
pub(super) struct Context<'a> {
    pub(super) module: &'a Module,
    pub(super) options: &'a EmitOptions,
    /// Field names of `Parameters`.
    pub(super) parameters: Vec<Ident>,
    /// Names of the functions.
    pub(super) functions: Vec<Ident>,
    /// Elementary functions called so far.
    pub(super) calls: Calls,
    /// Whether a function over lanes is printed.
    pub(super) has_lanes: Cell<bool>,
    /// Whether a function over lanes keeps values between its loops.
    pub(super) has_groups: Cell<bool>,
    /// Names that no argument or value may have: in a pattern the name of a constant would match the
    /// constant.
    pub(super) reserved: Vec<String>,
    /// Private functions of array forms, shared by several functions.
    pub(super) shared: Shared,
}

impl<'a> Context<'a> {
    /// - `reserved`: names of the module's constants and functions
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

    /// Free parameters as an argument of a call.
    pub(super) fn passed_parameters(&self) -> Option<TokenStream> {
        self.has_parameters().then(|| quote!(p))
    }

    /// Free parameters as an argument of a signature.
    pub(super) fn declared_parameters(&self) -> Option<TokenStream> {
        self.has_parameters().then(|| quote!(p: &Parameters))
    }

    /// Number type.
    pub(super) fn ty(&self) -> TokenStream {
        self.options.scalar.ty()
    }

    /// Zero.
    pub(super) fn zero(&self) -> TokenStream {
        self.options.scalar.literal(0.0)
    }
}

/// Elementary functions called by the printed functions.
#[derive(Debug, Default)]
pub(super) struct Calls {
    pub(super) kernels: RefCell<BTreeSet<Kernel>>,
    pub(super) sign: Cell<bool>,
}

/// Private functions shared by several functions, by name.
#[derive(Debug, Default)]
pub(super) struct Shared {
    items: RefCell<BTreeMap<String, TokenStream>>,
}

impl Shared {
    /// All functions, sorted by name.
    pub(super) fn take(&self) -> Vec<TokenStream> {
        self.items.take().into_values().collect()
    }

    /// Adds a function if it is absent; returns its name, which is numbered if another function has the name.
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
