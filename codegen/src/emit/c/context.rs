//! State that all parts of the printer share while a module is printed.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

use gelenk_kernels::math::Kernel;

use super::literal::in_scalar;
use super::names;
use crate::emit::names::Spelling;
use crate::emit::options::EmitOptions;
use crate::module::Module;

/// A module and the names in it while it is printed as C.
pub(super) struct Context<'a> {
    pub(super) module: &'a Module,
    pub(super) options: &'a EmitOptions,
    /// Name of the module's files without extension.
    pub(super) name: String,
    /// Prefix of the names of functions and types, for example `ur5`.
    prefix: String,
    /// Rules for names inside functions, such as reserved words.
    pub(super) spelling: Spelling,
    /// Names of the free parameters as fields of the struct `Parameters`.
    pub(super) parameters: Vec<String>,
    /// Names of the functions in C, in the order of the module.
    pub(super) functions: Vec<String>,
    /// Elementary functions that the printed text calls.
    pub(super) kernels: RefCell<BTreeSet<Kernel>>,
    /// Elementary functions that the printed text calls for several states at once.
    pub(super) lanes_kernels: RefCell<BTreeSet<Kernel>>,
    /// Whether the printed text calls the sign function.
    pub(super) sign: Cell<bool>,
    /// Whether the printed text negates a fused multiply-add.
    pub(super) negation: Cell<bool>,
    /// Private functions for loops over joints, which several functions may call.
    pub(super) shared: Shared,
    /// Private constants that loops over joints read.
    pub(super) tables: Shared,
    /// Private elementary functions for eight states at once.
    pub(super) of_lanes: Shared,
    /// Names in C of the functions for eight states at once, by the module's names of the functions for one
    /// state.
    lanes: BTreeMap<&'a str, String>,
}

impl<'a> Context<'a> {
    pub(super) fn new(module: &'a Module, options: &'a EmitOptions) -> Self {
        let own = names::spelling(vec![]);
        let name = options.name.clone().unwrap_or_else(|| names::prefix(&module.name));
        let prefix = names::prefix(&name);
        let functions = module.functions.iter().map(|function| function.name.as_str());
        let functions = own.distinct(functions, &[]);
        let parameters = module.parameters.iter().map(|each| each.name.as_str());
        let asked = module.lanes.iter().map(|name| format!("{name}_lanes")).collect::<Vec<_>>();
        let lanes = own.distinct(asked.iter().map(String::as_str), &functions).into_iter();
        let lanes = lanes.map(|name| format!("{prefix}_{name}"));
        let lanes = module.lanes.iter().map(String::as_str).zip(lanes).collect();
        let spelling = names::spelling(vec![format!("{prefix}_"), format!("{}_", prefix.to_uppercase())]);
        Self {
            module,
            options,
            functions: functions.iter().map(|name| format!("{prefix}_{name}")).collect(),
            parameters: spelling.distinct(parameters, &[]),
            spelling,
            name,
            prefix,
            kernels: RefCell::default(),
            lanes_kernels: RefCell::default(),
            sign: Cell::default(),
            negation: Cell::default(),
            shared: Shared::default(),
            tables: Shared::default(),
            of_lanes: Shared::default(),
            lanes,
        }
    }

    /// Name in C of a function or type of the module: `name` with the prefix.
    pub(super) fn function(&self, name: &str) -> String {
        format!("{}_{name}", self.prefix)
    }

    /// Name in C of the version of a function for eight states at once; `None` if there is no such version.
    pub(super) fn lanes_of(&self, function: &str) -> Option<&str> {
        self.lanes.get(function).map(String::as_str)
    }

    pub(super) fn has_lanes(&self) -> bool {
        !self.lanes.is_empty()
    }

    /// Name in C of a constant or macro of the module: `name` with the prefix in capitals.
    pub(super) fn constant(&self, name: &str) -> String {
        format!("{}_{name}", self.prefix.to_uppercase())
    }

    /// Number type in C: `double` or `float`.
    pub(super) fn ty(&self) -> &'static str {
        self.options.scalar.c_type()
    }

    /// A number as a literal of C.
    pub(super) fn literal(&self, number: f64) -> String {
        self.options.scalar.c_literal(number)
    }

    pub(super) fn has_parameters(&self) -> bool {
        !self.parameters.is_empty()
    }

    /// Argument of a call for the free parameters; `None` if there are no free parameters.
    pub(super) fn passed_parameters(&self) -> Option<String> {
        self.has_parameters().then(|| "p".to_owned())
    }

    /// Declaration of the argument for the free parameters; `None` if there are no free parameters.
    pub(super) fn declared_parameters(&self) -> Option<String> {
        self.has_parameters()
            .then(|| format!("const {} *{} p", self.function("parameters"), self.constant("RESTRICT")))
    }

    /// Inserts the names of this module into a fixed text. If there are no free parameters, their argument is
    /// removed.
    pub(super) fn pasted(&self, text: &str) -> String {
        let text = match self.has_parameters() {
            true => text.to_owned(),
            false => text.replace(", p,", ",").replace("const gelenk_parameters *p, ", ""),
        };
        self.pasted_names(&text)
    }

    /// Inserts the names of this module into a fixed text that does not have the argument for free
    /// parameters.
    pub(super) fn pasted_names(&self, text: &str) -> String {
        let text = text.replace("gelenk_", &format!("{}_", self.prefix));
        text.replace("GELENK_", &format!("{}_", self.prefix.to_uppercase()))
    }

    /// Inserts the names and the number type of this module into a fixed text.
    pub(super) fn pasted_loops(&self, text: &str) -> String {
        self.pasted(&in_scalar(text, self.options.scalar))
    }
}

/// Private items that several functions use, in the order in which they were added.
#[derive(Debug, Default)]
pub(super) struct Shared {
    names: RefCell<BTreeMap<String, String>>,
    items: RefCell<Vec<String>>,
}

impl Shared {
    /// The text of all shared items, in the order in which they were added.
    pub(super) fn text(&self) -> String {
        self.items.borrow().iter().map(|item| format!("\n{item}")).collect()
    }

    /// Adds an item if it was not yet added, and returns its name. The name gets a number if another item
    /// already has the name `stem`.
    pub(super) fn add(&self, stem: &str, item: impl Fn(&str) -> String) -> String {
        let mut names = self.names.borrow_mut();
        let mut number = 1;
        let mut name = stem.to_owned();
        loop {
            let text = item(&name);
            match names.get(&name) {
                Some(other) if *other != text => {
                    number += 1;
                    name = format!("{stem}_{number}");
                }
                Some(_) => return name,
                None => {
                    names.insert(name.clone(), text.clone());
                    self.items.borrow_mut().push(text);
                    return name;
                }
            }
        }
    }
}
