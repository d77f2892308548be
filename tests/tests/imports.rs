//! The imports of each crate: which file uses what another one defines.
//!
//! Sources are read as tokens, so that comments and texts do not count. Tests inside of sources do not count
//! either. A path is followed through re-exports to the file that defines its item, and it uses the rooms whose
//! re-exports it takes on its way, too. A re-export by itself imports nothing, except those of a crate's root and of a `mod.rs`: a folder's
//! `mod.rs` is above the files that it hands on.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::visit::Visit;

/// The names from the root of the crate to a module.
type ModulePath = Vec<String>;

/// A module of a crate, in a file of its own or inside of one.
#[derive(Debug, Default)]
struct Module {
    file: PathBuf,
    /// Names that `use` brings in, with their paths. The name of a glob is `*`.
    uses: Vec<(String, Vec<String>)>,
    /// Paths of names that are used here, not only handed on.
    own: Vec<Vec<String>>,
    /// Names that are defined here.
    items: BTreeSet<String>,
    /// Paths of two and more names in the code.
    paths: Vec<Vec<String>>,
}

/// The modules of one crate.
#[derive(Debug, Default)]
struct Crate {
    modules: BTreeMap<ModulePath, Module>,
}

impl Crate {
    /// Reads a crate from its root, `src/lib.rs` or `src/main.rs`.
    fn read(root: &Path) -> Self {
        let mut read = Self::default();
        let folder = root.parent().expect("a file stands in a folder");
        read.file(root, folder, &[]);
        read
    }

    /// Reads a file, whose modules stand in a folder.
    fn file(&mut self, file: &Path, folder: &Path, module: &[String]) {
        let text =
            std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let tokens: TokenStream = text.parse().unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.walk(tokens, file, folder, module);
    }

    fn walk(&mut self, tokens: TokenStream, file: &Path, folder: &Path, module: &[String]) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let here = self.modules.entry(module.to_vec()).or_default();
        here.file = file.to_owned();
        let mut at = 0;
        while at < tokens.len() {
            at = match &tokens[at] {
                TokenTree::Punct(mark) if mark.as_char() == '#' && is_test(tokens.get(at + 1)) => {
                    end_of_item(&tokens, at + 2)
                }
                // The text of a generated module is not ours.
                TokenTree::Ident(word) if *word == "quote" && is_mark(tokens.get(at + 1), '!') => at + 3,
                TokenTree::Ident(word) if *word == "pub" => {
                    at + 1 + usize::from(is_visibility(tokens.get(at + 1)))
                }
                TokenTree::Ident(word) if *word == "use" => {
                    let end = end_of_item(&tokens, at);
                    let mut uses = Vec::new();
                    use_tree(&tokens[at + 1..end - 1], &[], &mut uses);
                    let here = self.modules.entry(module.to_vec()).or_default();
                    if !is_public(&tokens[..at]) {
                        here.own.extend(uses.iter().map(|(_, path)| path.clone()));
                    }
                    here.uses.extend(uses);
                    end
                }
                TokenTree::Ident(word) if *word == "mod" => {
                    self.module(&tokens, at, file, folder, module);
                    at + 3
                }
                TokenTree::Ident(_) => self.path(&tokens, at, module),
                TokenTree::Group(group) => {
                    self.walk(group.stream(), file, folder, module);
                    at + 1
                }
                _ => at + 1,
            };
        }
    }

    /// `mod name;` or `mod name { … }`.
    fn module(&mut self, tokens: &[TokenTree], at: usize, file: &Path, folder: &Path, parent: &[String]) {
        let Some(TokenTree::Ident(name)) = tokens.get(at + 1) else { return };
        let name = name.to_string();
        let module = [parent, std::slice::from_ref(&name)].concat();
        let inner = folder.join(&name);
        match tokens.get(at + 2) {
            Some(TokenTree::Group(body)) => self.walk(body.stream(), file, &inner, &module),
            _ => {
                let files = [folder.join(format!("{name}.rs")), inner.join("mod.rs")];
                if let Some(file) = files.iter().find(|file| file.exists()) {
                    self.file(file, &inner, &module);
                }
            }
        }
    }

    /// Notes the definition or the path that begins with a word; gives the place behind it.
    fn path(&mut self, tokens: &[TokenTree], at: usize, module: &[String]) -> usize {
        const DEFINES: [&str; 8] =
            ["fn", "struct", "enum", "trait", "type", "const", "static", "macro_rules"];
        let here = self.modules.entry(module.to_vec()).or_default();
        let word = tokens[at].to_string();
        if DEFINES.contains(&word.as_str()) {
            let skipped = usize::from(is_mark(tokens.get(at + 1), '!'));
            if let Some(TokenTree::Ident(name)) = tokens.get(at + 1 + skipped) {
                here.items.insert(name.to_string());
            }
            return at + 1;
        }
        let mut path = vec![word];
        let mut end = at + 1;
        while is_mark(tokens.get(end), ':') && is_mark(tokens.get(end + 1), ':') {
            let Some(TokenTree::Ident(name)) = tokens.get(end + 2) else { break };
            path.push(name.to_string());
            end += 3;
        }
        if path.len() > 1 {
            here.paths.push(path);
        }
        end
    }

    /// The file that defines what a path of a module names; `None` for what is not an item of this crate.
    fn defined_in(
        &self,
        from: &[String],
        path: &[String],
        seen: &mut BTreeSet<(ModulePath, String)>,
    ) -> Option<&Path> {
        let mut module = from.to_vec();
        let mut rest = path;
        while let [first, others @ ..] = rest {
            match first.as_str() {
                "crate" => module = Vec::new(),
                "self" => {}
                "super" => drop(module.pop()?),
                _ => break,
            }
            rest = others;
        }
        let is_relative = rest.len() == path.len();
        let Some((name, others)) = rest.split_first() else {
            return self.modules.get(&module).map(|found| found.file.as_path());
        };
        let inner = [&module[..], std::slice::from_ref(name)].concat();
        if self.modules.contains_key(&inner) {
            let others: Vec<String> =
                std::iter::once("self".to_owned()).chain(others.iter().cloned()).collect();
            return self.defined_in(&inner, &others, seen);
        }
        if !seen.insert((module.clone(), name.clone())) {
            return None;
        }
        let here = self.modules.get(&module)?;
        if here.items.contains(name) {
            return Some(&here.file);
        }
        let named = here.uses.iter().filter(|(known, _)| known == name);
        let globs = here.uses.iter().filter(|(known, _)| known == "*");
        let named = named.map(|(_, path)| [&path[..], others].concat());
        let globs = globs.map(|(_, path)| [&path[..], rest].concat());
        let found = named.chain(globs).find_map(|path| self.defined_in(&module, &path, seen));
        // Whatever a macro defines is not seen.
        found.or((!is_relative && here.uses.iter().all(|(known, _)| known != name)).then_some(&here.file))
    }

    /// Pairs of files, of which the first uses what the second one defines or hands on, each with a path that does.
    fn edges(&self) -> BTreeMap<(PathBuf, PathBuf), String> {
        let mut edges = BTreeMap::new();
        for (name, module) in &self.modules {
            let is_above = name.is_empty() || module.file.ends_with("mod.rs");
            let handed_on = module.uses.iter().map(|(_, path)| path).filter(|_| is_above);
            for path in module.own.iter().chain(&module.paths).chain(handed_on) {
                let mut passed = BTreeSet::new();
                let found = self.defined_in(name, path, &mut passed);
                let passed =
                    passed.iter().filter_map(|(through, item)| self.handed_on_by(name, through, item));
                for file in found.into_iter().chain(passed).filter(|file| *file != module.file) {
                    edges.insert((module.file.clone(), file.to_owned()), path.join("::"));
                }
            }
        }
        edges
    }

    /// The file of a module that hands on an item which a path of another one takes there. Below the root, a module
    /// may take from those around it whatever they hand on.
    fn handed_on_by(&self, from: &[String], through: &ModulePath, item: &String) -> Option<&Path> {
        let is_around = !through.is_empty() && from.starts_with(through);
        let module = self.modules.get(through).filter(|_| !is_around)?;
        let hands_on = module.uses.iter().any(|(name, _)| name == item);
        hands_on.then_some(&module.file)
    }
}

fn is_mark(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(found)) if found.as_char() == mark)
}

/// Whether the brackets behind `#` hold `cfg(test)`, alone or among other conditions.
fn is_test(token: Option<&TokenTree>) -> bool {
    let text = token.map(|token| token.to_string().replace(' ', "")).unwrap_or_default();
    text == "[cfg(test)]" || text.starts_with("[cfg(all(test,")
}

/// Whether a token is the `(crate)` of `pub(crate)` or the like.
fn is_visibility(token: Option<&TokenTree>) -> bool {
    let Some(TokenTree::Group(group)) = token else { return false };
    let first = group.stream().into_iter().next().map(|token| token.to_string());
    group.delimiter() == Delimiter::Parenthesis
        && matches!(first.as_deref(), Some("crate" | "super" | "self" | "in"))
}

/// Whether the words before `use` end with a visibility.
fn is_public(before: &[TokenTree]) -> bool {
    let before = match before {
        [others @ .., last] if is_visibility(Some(last)) => others,
        all => all,
    };
    matches!(before.last(), Some(TokenTree::Ident(word)) if *word == "pub")
}

/// The place behind an item: its semicolon, or the braces of its body.
fn end_of_item(tokens: &[TokenTree], from: usize) -> usize {
    let is_use = |at: usize| matches!(&tokens[at], TokenTree::Ident(word) if *word == "use");
    let mut imports = false;
    for at in from..tokens.len() {
        imports |= is_use(at);
        let is_body = matches!(&tokens[at], TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
        if is_mark(tokens.get(at), ';') || (is_body && !imports) {
            return at + 1;
        }
    }
    tokens.len()
}

/// The names of a tree behind `use`, with their paths.
fn use_tree(tokens: &[TokenTree], prefix: &[String], uses: &mut Vec<(String, Vec<String>)>) {
    // Nothing follows the last comma of a list.
    for branch in tokens.split(|token| is_mark(Some(token), ',')).filter(|branch| !branch.is_empty()) {
        let mut path = prefix.to_vec();
        let mut name = None;
        let mut words = branch.iter();
        while let Some(word) = words.next() {
            match word {
                TokenTree::Ident(word) if *word == "as" => name = words.next().map(ToString::to_string),
                TokenTree::Ident(word) if *word == "self" && !path.is_empty() => {}
                TokenTree::Ident(word) => path.push(word.to_string()),
                TokenTree::Punct(mark) if mark.as_char() == '*' => name = Some("*".to_owned()),
                TokenTree::Group(group) => {
                    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                    use_tree(&inner, &path, uses);
                    path.clear();
                }
                _ => {}
            }
        }
        if let Some(last) = path.last() {
            uses.push((name.unwrap_or_else(|| last.clone()), path));
        }
    }
}

/// A room of a folder: a file, or a folder with the file of its name.
fn room(folder: &Path, file: &Path) -> Option<String> {
    let inside = file.strip_prefix(folder).ok()?;
    let first = inside.components().next()?.as_os_str().to_string_lossy().into_owned();
    let stem = first.strip_suffix(".rs").unwrap_or(&first);
    let is_folder = folder.join(stem).is_dir();
    Some(if is_folder { format!("{stem}/") } else { first })
}

/// The circles of a crate, each with the imports that close it.
fn circles(source: &Path) -> Vec<String> {
    let roots = ["lib.rs", "main.rs"].map(|name| source.join(name));
    let mut edges = BTreeMap::new();
    roots.iter().filter(|root| root.exists()).for_each(|root| edges.extend(Crate::read(root).edges()));
    let mut folders: BTreeSet<PathBuf> = BTreeSet::new();
    for (from, _) in edges.keys() {
        folders.extend(
            from.ancestors().skip(1).take_while(|folder| folder.starts_with(source)).map(Path::to_owned),
        );
    }
    let inner = folders.iter().flat_map(|folder| circles_of(folder, &edges));
    inner.collect()
}

/// The rooms between two of which there are imports.
type Between = BTreeMap<(String, String), Vec<String>>;

fn reached_from<'a>(room: &'a String, between: &'a Between) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::from([room]);
    let mut open = vec![room];
    while let Some(room) = open.pop() {
        let next = between.keys().filter(|(from, _)| from == room).map(|(_, to)| to);
        open.extend(next.filter(|next| reached.insert(next)));
    }
    reached
}

/// The circles between the rooms of a folder.
fn circles_of(folder: &Path, edges: &BTreeMap<(PathBuf, PathBuf), String>) -> Vec<String> {
    let mut between = Between::new();
    for ((from, to), path) in edges {
        let (Some(a), Some(b)) = (room(folder, from), room(folder, to)) else { continue };
        if a != b {
            let short = |file: &Path| file.strip_prefix(folder).unwrap_or(file).display().to_string();
            between.entry((a, b)).or_default().push(format!("{} → {} ({path})", short(from), short(to)));
        }
    }
    let rooms: BTreeSet<&String> = between.keys().flat_map(|(a, b)| [a, b]).collect();
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        rooms.iter().map(|room| (*room, reached_from(room, &between))).collect();
    let circle = |room: &String| -> BTreeSet<&String> {
        reached[room].iter().filter(|other| reached[*other].contains(room)).copied().collect()
    };
    let circles: BTreeSet<BTreeSet<&String>> = rooms.iter().map(|room| circle(room)).collect();
    let forbidden = circles.into_iter().filter(|circle| {
        circle.len() > 2 || (circle.len() == 2 && circle.iter().any(|room| room.ends_with('/')))
    });
    let described = forbidden.map(|circle| {
        let names: Vec<&str> = circle.iter().map(|room| room.as_str()).collect();
        let inside = between.iter().filter(|((a, b), _)| circle.contains(a) && circle.contains(b));
        let lines: Vec<String> =
            inside.flat_map(|(_, lines)| lines).map(|line| format!("    {line}")).collect();
        format!("{}: {}\n{}", folder.display(), names.join(", "), lines.join("\n"))
    });
    described.collect()
}

/// Folders whose `mod.rs` lists the modules from the lowest floor to the highest, one paragraph for each floor. Files import from
/// floors below their own.
const STAIRCASES: [&str; 2] = ["log", "log/columns"];

/// The floor of each module by the paragraphs of a `mod.rs`.
fn floors(text: &str) -> BTreeMap<String, usize> {
    let name = |line: &str| {
        let (_, name) = line.strip_suffix(';')?.rsplit_once("mod ")?;
        Some(name.to_owned())
    };
    let paragraphs = text.split("\n\n").enumerate();
    paragraphs
        .flat_map(|(floor, lines)| lines.lines().filter_map(name).map(move |name| (name, floor)))
        .collect()
}

/// Imports of the files of a folder from their own floor or from a higher one. What `mod.rs` defines is above all floors.
fn upward(folder: &Path, edges: &BTreeMap<(PathBuf, PathBuf), String>) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("mod.rs")).expect("a folder of modules");
    let floors = floors(&text);
    let floor = |room: &str| {
        let name = room.trim_end_matches('/').trim_end_matches(".rs");
        floors.get(name).copied().unwrap_or(usize::MAX)
    };
    let is_upward = |(from, to): &(PathBuf, PathBuf)| match (room(folder, from), room(folder, to)) {
        (Some(a), Some(b)) => a != b && floor(&a) != usize::MAX && floor(&a) <= floor(&b),
        _ => false,
    };
    let short = |file: &Path| file.strip_prefix(folder).unwrap_or(file).display().to_string();
    let found = edges.iter().filter(|(files, _)| is_upward(files));
    found.map(|((from, to), path)| format!("{} → {} ({path})", short(from), short(to))).collect()
}

#[test]
fn floors_are_those_that_folders_list() {
    let source = gelenk_tests::workspace().join("runtime/identification/src");
    let edges = Crate::read(&source.join("lib.rs")).edges();
    let found: Vec<String> =
        STAIRCASES.iter().flat_map(|folder| upward(&source.join(folder), &edges)).collect();
    assert!(found.is_empty(), "imports from a floor that is not below:\n{}", found.join("\n"));
}

/// Crates of the product.
const PRODUCTS: [&str; 10] = [
    "codegen",
    "codegen/files",
    "codegen/formula",
    "codegen/kernels",
    "runtime",
    "runtime/adaptation",
    "runtime/dynamics",
    "runtime/findings",
    "runtime/identification",
    "runtime/report",
];

/// Functions that take a tuple, one entry for each such parameter.
#[derive(Default)]
struct Tuples(Vec<String>);

impl<'a> Visit<'a> for Tuples {
    fn visit_item_mod(&mut self, module: &'a syn::ItemMod) {
        let is_test = |attribute: &syn::Attribute| {
            attribute.path().is_ident("cfg")
                && attribute.parse_args::<syn::Ident>().is_ok_and(|word| word == "test")
        };
        if !module.attrs.iter().any(is_test) {
            syn::visit::visit_item_mod(self, module);
        }
    }

    fn visit_signature(&mut self, signature: &'a syn::Signature) {
        let is_tuple = |input: &&syn::FnArg| match input {
            syn::FnArg::Typed(typed) => {
                matches!(&*typed.ty, syn::Type::Tuple(tuple) if !tuple.elems.is_empty())
            }
            syn::FnArg::Receiver(_) => false,
        };
        let tuples = signature.inputs.iter().filter(is_tuple);
        self.0.extend(tuples.map(|_| signature.ident.to_string()));
    }
}

/// A tuple as a parameter hides how many arguments a function has. Sine and cosine of an angle, and results of another function,
/// are one value.
#[test]
fn few_parameters_are_tuples() {
    let root = gelenk_tests::workspace();
    let mut found = Tuples::default();
    for name in PRODUCTS {
        let read = Crate::read(&root.join(name).join("src/lib.rs"));
        let files: BTreeSet<&PathBuf> = read.modules.values().map(|module| &module.file).collect();
        for file in files {
            let text = std::fs::read_to_string(file).expect("a source");
            found.visit_file(&syn::parse_file(&text).expect("Rust"));
        }
    }
    assert!(found.0.len() <= MOST_TUPLES, "{} tuples: {:?}", found.0.len(), found.0);
}

/// Parameters of functions of the product that are tuples.
const MOST_TUPLES: usize = 17;

/// In a folder, files and inner folders stand in floors: what imports stands above what it imports. Two files of
/// one folder may know each other; a folder and its neighbours may not.
#[test]
fn no_import_runs_back_up() {
    let root = gelenk_tests::workspace();
    let crates = PRODUCTS.into_iter().chain(["tests"]);
    let found: Vec<String> = crates.flat_map(|name| circles(&root.join(name).join("src"))).collect();
    assert!(found.is_empty(), "imports that run in a circle:\n{}", found.join("\n"));
}

/// Writes sources into a folder of their own and gives the heads of their circles.
fn circles_among(files: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("it is in the folder")).expect("a folder");
        std::fs::write(path, text).expect("a file");
    }
    let heads = circles(folder.path()).into_iter().filter_map(|text| {
        let head = text.lines().next()?;
        Some(head.rsplit(": ").next()?.to_owned())
    });
    heads.collect()
}

#[test]
fn circles_of_files_and_folders_are_found() {
    let lib = ("lib.rs", "pub mod a; mod b; mod c; pub use b::B;");
    // Through a re-export, and by a path in the code.
    let [a, b] =
        [("a/mod.rs", "mod inner; pub use inner::A;"), ("a/inner.rs", "use crate::B; pub struct A(B);")];
    let c = ("c.rs", "");
    assert_eq!(
        circles_among(&[lib, a, b, ("b.rs", "pub struct B; fn f(a: &crate::a::A) {}"), c]),
        ["a/, b.rs, lib.rs"]
    );
    assert!(circles_among(&[lib, a, b, ("b.rs", "pub struct B;"), c]).is_empty());
    // A room takes from where its path leads, be the item of the room that hands it on or not; one below may take
    // from those around it.
    let far = ("b.rs", "pub use crate::c::C; fn f(a: &crate::a::A) {}");
    let taken = |path: &str| format!("use {path}; pub struct A(C);");
    let (through, straight) = (taken("crate::b::C"), taken("crate::c::C"));
    let c = ("c.rs", "pub struct C;");
    let lib_of_three = ("lib.rs", "mod a; mod b; mod c;");
    assert_eq!(circles_among(&[lib_of_three, a, ("a/inner.rs", &through), far, c]), ["a/, b.rs"]);
    assert!(circles_among(&[lib_of_three, a, ("a/inner.rs", &straight), far, c]).is_empty());
    let around = ("a/mod.rs", "mod inner; pub use inner::A; pub use crate::c::C;");
    assert!(circles_among(&[lib_of_three, around, ("a/inner.rs", &taken("super::C")), far, c]).is_empty());
    let c = ("c.rs", "");
    // Tests, comments and emitted text import nothing.
    let quiet = "pub struct B; // crate::a::A\n#[cfg(test)] mod tests { use crate::a::A; }
                 fn f() { quote!(crate::a::A) }";
    assert!(circles_among(&[lib, a, b, ("b.rs", quiet), c]).is_empty());
    // Two files may know each other, three may not.
    let lib = ("lib.rs", "mod a; mod b; mod c;");
    let [a, b] = [("a.rs", "use super::b::B; pub struct A;"), ("b.rs", "use super::{a::A}; pub struct B;")];
    assert!(circles_among(&[lib, a, b, ("c.rs", "pub struct C;")]).is_empty());
    let b = ("b.rs", "use super::c::*; pub struct B;");
    assert_eq!(circles_among(&[lib, a, b, ("c.rs", "pub struct C(super::a::A);")]), ["a.rs, b.rs, c.rs"]);
}

#[test]
fn imports_from_higher_floors_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = [
        ("lib.rs", "mod log;"),
        ("log/mod.rs", "//! Floors.\n\nmod a;\nmod b;\n\nmod c;\n\npub use c::C;\nconst TOP: usize = 1;\n"),
        ("log/a.rs", "use super::C; use super::b::B; pub struct A;"),
        ("log/b.rs", "use super::TOP; pub struct B;"),
        ("log/c.rs", "use super::a::A; pub struct C;"),
    ];
    std::fs::create_dir_all(folder.path().join("log")).expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let edges = Crate::read(&folder.path().join("lib.rs")).edges();
    let found = upward(&folder.path().join("log"), &edges);
    assert_eq!(found, ["a.rs → b.rs (super::b::B)", "a.rs → c.rs (super::C)", "b.rs → mod.rs (super::TOP)"]);
}
