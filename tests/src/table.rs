//! A table of the public functions of generated modules, as Rust text: read from the modules themselves, so
//! that no function is forgotten.

use std::fmt::Write;

/// The table's entry of one module: a [`Robot`](crate::flat::Robot), with names of `flat` in scope.
///
/// - `name`: of the module
/// - `path`: path to it, e.g. `gelenk_test_robots::ur5`
/// - `text`: its source
///
/// # Panics
/// If the source is not Rust.
pub fn entry(name: &str, path: &str, text: &str) -> String {
    let file = syn::parse_file(text).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut entry = format!("({name:?}, &[\n");
    let parameters = fields(&file);
    for item in &file.items {
        let syn::Item::Fn(function) = item else {
            continue;
        };
        if is_listed(function) {
            let call = call(path, function, &parameters);
            let _ = writeln!(
                entry,
                "    ({:?}, |x: &[Vec<f64>], p: &[f64]| {{ let _ = (x, p); {call} }}),",
                function.sig.ident.to_string()
            );
        }
    }
    entry + "]),\n"
}

/// Names of the public functions of a module, in the order of its table.
///
/// # Panics
/// If the source is not Rust.
pub fn functions(text: &str) -> Vec<String> {
    let file = syn::parse_file(text).unwrap_or_else(|error| panic!("{error}"));
    let names = file.items.iter().filter_map(|item| match item {
        syn::Item::Fn(function) if is_listed(function) => Some(function.sig.ident.to_string()),
        _ => None,
    });
    names.collect()
}

/// Public functions with results that are programs. What writes into its arguments is called by the function
/// of the same name that returns them; functions over a sample time, a number by value, call others.
fn is_listed(function: &syn::ItemFn) -> bool {
    matches!(function.vis, syn::Visibility::Public(_))
        && matches!(function.sig.output, syn::ReturnType::Type(..))
        && !function.sig.inputs.iter().any(is_number)
        && !OF_POSITIONS.iter().any(|name| function.sig.ident == name)
}

/// Functions of positions with quaternions: texts that are the same for every robot, and no programs.
const OF_POSITIONS: [&str; 4] = ["integrate", "difference", "integrate_derivatives", "normalize"];

fn is_number(argument: &syn::FnArg) -> bool {
    matches!(argument, syn::FnArg::Typed(argument) if matches!(*argument.ty, syn::Type::Path(_)))
}

/// Fields of a module's `Parameters`, in order.
///
/// # Panics
/// If the source is not Rust.
pub fn parameters(text: &str) -> Vec<String> {
    fields(&syn::parse_file(text).unwrap_or_else(|error| panic!("{error}")))
}

/// Fields of `Parameters`, in order.
fn fields(file: &syn::File) -> Vec<String> {
    let structs = file.items.iter().filter_map(|item| match item {
        syn::Item::Struct(item) if item.ident == "Parameters" => Some(item),
        _ => None,
    });
    let fields = structs.flat_map(|item| item.fields.iter());
    fields.filter_map(|field| field.ident.as_ref()).map(ToString::to_string).collect()
}

/// True for the struct `Parameters`; among the other named types, `Driven` is an array.
fn is_parameters(ty: &syn::Type) -> bool {
    matches!(ty, syn::Type::Path(path) if path.path.is_ident("Parameters"))
}

/// The call of a function with arguments from `x` and parameters from `p`.
fn call(path: &str, function: &syn::ItemFn, parameters: &[String]) -> String {
    let types = function.sig.inputs.iter().filter_map(|input| match input {
        syn::FnArg::Typed(argument) => Some(&*argument.ty),
        _ => None,
    });
    // What the function writes to.
    let mut results = Vec::new();
    let arguments: Vec<String> = types
        .enumerate()
        .map(|(index, ty)| match ty {
            syn::Type::Reference(to) if is_parameters(&to.elem) => {
                let fields = parameters.iter().enumerate();
                let fields: Vec<String> =
                    fields.map(|(index, field)| format!("{field}: number(p[{index}])")).collect();
                format!("&{path}::Parameters {{ {} }}", fields.join(", "))
            }
            syn::Type::Reference(to) if to.mutability.is_some() => {
                results.push(format!("r{index}"));
                format!("&mut r{index}")
            }
            _ => format!("&array(&x[{index}])"),
        })
        .collect();
    let call = format!("{path}::{}({})", function.sig.ident, arguments.join(", "));
    if results.is_empty() {
        return format!("flat(&{call})");
    }
    let blank: String = results.iter().map(|r| format!("let mut {r} = blank(); ")).collect();
    let flat: Vec<String> = results.iter().map(|r| format!("flat(&{r})")).collect();
    format!("{blank}{call}; [{}].concat()", flat.join(", "))
}
