//! The Markdown pages are true as far as a program can tell: links and paths lead somewhere, commands name
//! what exists, and the examples of the README are what the generator writes and the runtime's documentation
//! runs.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use gelenk_codegen::functions::catalogue;
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};
use gelenk_tests::workspace;

fn read(path: &str) -> String {
    fs::read_to_string(workspace().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Files and folders of the repository, relative to its root.
fn everything() -> Vec<PathBuf> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let is_ours = name != "target" && (!name.starts_with('.') || name == ".ci");
            if is_ours && path.is_dir() {
                walk(&path, found);
            }
            if is_ours {
                found.push(path);
            }
        }
    }
    let root = workspace();
    let mut found = Vec::new();
    walk(&root, &mut found);
    let relative = |path: &PathBuf| path.strip_prefix(&root).ok().map(Path::to_owned);
    found.iter().filter_map(relative).collect()
}

/// Every page with its text.
fn pages() -> Vec<(PathBuf, String)> {
    let pages = everything()
        .into_iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .map(|path| (path.clone(), read(&path.to_string_lossy())));
    let pages: Vec<_> = pages.collect();
    assert!(pages.len() > 15, "only {} pages", pages.len());
    pages
}

/// A text without its blocks of code.
fn prose(text: &str) -> String {
    let mut is_code = false;
    let outside = |line: &&str| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    };
    text.lines().filter(outside).collect::<Vec<_>>().join("\n")
}

/// The blocks of code of a language.
fn blocks<'t>(text: &'t str, language: &str) -> Vec<&'t str> {
    let fence = format!("```{language}\n");
    let after = text.split(fence.as_str()).skip(1);
    after.filter_map(|rest| rest.split("\n```").next()).collect()
}

/// The anchors of a page, as GitHub makes them of headings.
fn anchors(text: &str) -> BTreeSet<String> {
    let slug = |heading: &str| {
        let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
        let lower = heading.trim_matches('#').trim().to_lowercase();
        lower.chars().filter(kept).collect::<String>().replace(' ', "-")
    };
    let text = prose(text);
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(slug).collect()
}

/// Addresses of links outside code: `](…)`, `[name]: …`, `src="…"` and `srcset="…"`.
fn links(text: &str) -> Vec<String> {
    let text = &prose(text);
    let text = &text.split('`').step_by(2).collect::<Vec<_>>().join("code");
    let until = |rest: &str, end: char| rest.split(end).next().unwrap_or_default().to_owned();
    let inline = text.split("](").skip(1).map(|rest| until(rest, ')'));
    let images = text.split("src=\"").chain(text.split("srcset=\"").skip(1)).skip(1);
    let images = images.map(|rest| until(rest, '"'));
    let named = text.lines().filter_map(|line| {
        let (_, address) = line.strip_prefix('[')?.split_once("]: ")?;
        Some(address.trim().to_owned())
    });
    inline.chain(images).chain(named).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut problems = Vec::new();
    let mut count = 0;
    for (page, text) in pages() {
        for link in links(&text) {
            // Pages elsewhere, and items of Rust, which rustdoc checks.
            if link.contains("://") || link.contains("::") {
                continue;
            }
            count += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let folder = page.parent().unwrap_or(Path::new(""));
            let target = match file {
                "" => workspace().join(&page),
                _ => workspace().join(folder).join(file),
            };
            let has_anchor = || {
                let text = fs::read_to_string(&target).unwrap_or_default();
                anchor.is_empty() || anchors(&text).contains(anchor)
            };
            if !target.exists() || !has_anchor() {
                problems.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(count > 60, "only {count} links were found");
}

/// Links by name have an address: `[c1]` and `[Drake]` of the comparison.
#[test]
fn names_of_links_have_addresses() {
    let text = prose(&read("README.md"));
    let named: BTreeSet<&str> =
        text.lines().filter_map(|line| Some(line.strip_prefix('[')?.split_once("]: ")?.0)).collect();
    let rows = text.lines().filter(|line| line.starts_with('|'));
    let used: BTreeSet<&str> = rows
        .flat_map(|row| row.split('[').skip(1))
        .filter_map(|rest| rest.split_once(']'))
        // Behind the text of a link its name follows at once.
        .filter(|(_, after)| !after.is_empty())
        .map(|(name, _)| name)
        .collect();
    assert_eq!(used, named);
}

/// Paths of this repository in backticks, in the pages for those who work on it.
#[test]
fn paths_that_pages_name_exist() {
    let everything = everything();
    let exists = |path: &str| {
        let path = Path::new(path);
        everything.iter().any(|known| known.ends_with(path))
    };
    let mut problems = Vec::new();
    let mut count = 0;
    for (page, text) in pages() {
        let is_guide = page.starts_with("codegen/docs") || page.parent() == Some(Path::new(""));
        if !is_guide || page.ends_with("CHANGELOG.md") {
            continue;
        }
        let text = prose(&text);
        for path in text.split('`').skip(1).step_by(2) {
            let is_path = [".rs", ".sh", ".md", "/"].iter().any(|end| path.ends_with(end));
            let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '/' | '.' | '_' | '-');
            if !is_path || !path.chars().all(is_plain) || path == "/" {
                continue;
            }
            count += 1;
            if !exists(path.trim_end_matches('/')) {
                problems.push(format!("{}: `{path}`", page.display()));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(count > 100, "only {count} paths were found");
}

/// Commands name packages, examples, benches, tests, scripts and subcommands that exist.
#[test]
fn commands_name_what_exists() {
    let everything = everything();
    let exists = |path: String| everything.iter().any(|known| known.ends_with(&path));
    let is_package = |name: &str| {
        let manifest = |path: &&PathBuf| path.ends_with("Cargo.toml");
        let line = format!("name = \"{name}\"");
        let mut texts = everything.iter().filter(manifest);
        texts.any(|path| read(&path.to_string_lossy()).contains(&line))
    };
    let known = |option: &str, value: &str| match option {
        "-p" | "--package" => is_package(value),
        "--example" => {
            let folder = format!("examples/{value}");
            exists(format!("{folder}.rs")) || exists(format!("{folder}/main.rs"))
        }
        "--bench" => exists(format!("benches/{value}.rs")),
        "--test" => exists(format!("tests/{value}.rs")),
        "gelenk" => {
            ["generate", "check", "export", "inspect", "identify", "report", "new", "schema", "--help"]
                .contains(&value)
        }
        "sh" => exists(value.to_owned()),
        _ => true,
    };
    let mut problems = Vec::new();
    let mut count = 0;
    for (page, text) in pages() {
        let prose = prose(&text);
        let inline = prose.split('`').skip(1).step_by(2);
        let lines = blocks(&text, "sh").into_iter().flat_map(str::lines);
        for command in inline.chain(lines) {
            let command = command.split('#').next().unwrap_or_default();
            let words: Vec<&str> = command.split_whitespace().collect();
            let is_command = matches!(words.first(), Some(&("cargo" | "gelenk" | "sh")));
            if !is_command || words.len() < 2 || command.contains('…') {
                continue;
            }
            for pair in words.windows(2) {
                // Capitals stand for a name of the reader's.
                let is_placeholder = pair[1].chars().all(|c| !c.is_lowercase());
                count += 1;
                if !is_placeholder && !known(pair[0], pair[1]) {
                    problems.push(format!("{}: {command}: {}", page.display(), pair[1]));
                }
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(count > 100, "only {count} pairs of words were found");
}

fn generated(description: &Path) -> Generated {
    generate(description, &GenerateOptions::default()).unwrap_or_else(|error| panic!("{error:?}"))
}

/// The README is a front door: it is short, and its first block holds two commands.
#[test]
fn the_readme_is_short_and_begins_with_two_commands() {
    let readme = read("README.md");
    let commands = "cargo run --release -- generate models/powercube.toml\ncargo test --workspace";
    assert_eq!(blocks(&readme, "sh")[0], commands);
    assert_eq!(readme.find("```"), readme.find("```sh\n"));
    let lines = readme.lines().count();
    assert!(lines <= 220, "{lines} lines");
}

/// The README's description is complete, and the generator writes the function next to it.
#[test]
fn the_readme_shows_what_the_generator_writes() {
    let readme = read("README.md");
    let folder = tempfile::tempdir().expect("a folder");
    let description = folder.path().join("arm.toml");
    fs::write(&description, blocks(&readme, "toml")[0]).expect("written");
    let generated = generated(&description);
    let function = blocks(&readme, "rust")[0];
    assert!(function.contains("pub fn"));
    assert!(generated.source.text.contains(function), "{function}");
    let count = format!("one of the {} functions", generated.module.costs().len());
    assert!(readme.contains(&count), "{count}");
    assert!(generated.notes.entries().is_empty(), "{:?}", generated.notes);
}

/// The README's loop is the example of the runtime's documentation, which rustdoc compiles and runs; its
/// build script and its two lines are those that `gelenk new` writes.
#[test]
fn the_readme_shows_code_that_is_compiled() {
    let readme = read("README.md");
    let blocks = blocks(&readme, "rust");
    let documented = read("runtime/src/control_loop/mod.rs");
    let documented: Vec<&str> =
        documented.lines().map(|line| line.trim_start_matches("//!").trim()).collect();
    let control = blocks.iter().find(|block| block.contains("ControlLoop::new"));
    for line in control.expect("the loop").lines() {
        assert!(documented.contains(&line.trim()), "{line}");
    }
    let template = read("codegen/src/cli/template/rust/build.rs");
    let build = blocks.iter().find(|block| block.contains("fn main"));
    for line in build.expect("the build script").lines() {
        assert!(template.contains(line), "{line}");
    }
}

/// Words of the documents written by hand: tokens with a letter or digit in every page, blocks of code included, without the
/// changelog, the code of conduct and generated parts (findings, tables of keys).
#[test]
fn documents_have_at_most_35_000_words() {
    let is_generated = ["CHANGELOG.md", "CODE_OF_CONDUCT.md", "findings.md"];
    let by_hand =
        pages().into_iter().filter(|(page, _)| !is_generated.iter().any(|name| page.ends_with(name)));
    let words =
        |text: &str| text.split_whitespace().filter(|word| word.contains(char::is_alphabetic)).count();
    let count = |text: &str| {
        let mut parts = text.split("<!-- keys:");
        let first = words(parts.next().unwrap_or_default());
        first
            + parts
                .filter_map(|part| part.split_once("<!-- end of keys -->"))
                .map(|(_, rest)| words(rest))
                .sum::<usize>()
    };
    let total: usize = by_hand.map(|(_, text)| count(&text)).sum();
    println!("{total} words");
    assert!((20_000..=35_000).contains(&total), "{total} words");
}

/// Every function of a robot stands in the list of functions.
#[test]
fn the_list_of_functions_is_complete() {
    let page = read("codegen/docs/generated_code.md");
    let model = generated(&workspace().join("models/powercube.toml")).model;
    for name in catalogue::names(&model) {
        let name = name.replace("frame_tool_", "frame_<name>_");
        assert!(page.contains(&format!("| `{name}(")), "{name}");
    }
}

/// Paths that the test of words leaves out, by their beginnings: comments that are printed into generated modules, whose
/// bytes are checked, and help texts of the command line, which begin with a verb or a preposition as switches do.
const NOT_YET: [&str; 4] =
    ["codegen/kernels/", "codegen/src/cli/arguments.rs", "codegen/src/cli/choices.rs", "generated/"];

/// Doc comments of a source, each with the number of its first line.
fn doc_comments(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut is_inside = false;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start();
        let comment = line.strip_prefix("//!").or_else(|| line.strip_prefix("///"));
        match (comment, found.last_mut()) {
            (Some(comment), Some((_, block))) if is_inside => {
                block.push(' ');
                block.push_str(comment.trim());
            }
            (Some(comment), _) => found.push((index + 1, comment.trim().to_owned())),
            (None, _) => {}
        }
        is_inside = comment.is_some();
    }
    found
}

/// The first forbidden phrase of a text outside of code. `There is no` is plain English; `is no` as a predicate
/// is not.
fn forbidden_phrase(text: &str) -> Option<String> {
    const PAIRS: [[&str; 2]; 5] =
        [["is", "told"], ["are", "told"], ["is", "no"], ["are", "no"], ["so", "many"]];
    let text = text.split('`').step_by(2).collect::<Vec<_>>().join(" code ").to_lowercase();
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
    let is_forbidden = |index: usize| {
        let pair = words.get(index..index + 2).is_some_and(|pair| PAIRS.iter().any(|known| known == pair));
        let follows_there = index > 0 && words[index - 1] == "there";
        words[index] == "beside" || pair && !(follows_there && words[index + 1] == "no")
    };
    let index = (0..words.len()).find(|&index| is_forbidden(index))?;
    Some(words[index..words.len().min(index + 2)].join(" "))
}

/// Doc comments begin with a noun or a verb, and documents use the plain words.
#[test]
fn words_are_plain() {
    assert!(NOT_YET.len() <= 30);
    let mut problems = Vec::new();
    for path in everything() {
        let name = path.to_string_lossy().replace('\\', "/");
        let is_left_out = NOT_YET.iter().any(|start| name.starts_with(start)) || name == "CHANGELOG.md";
        let texts = match path.extension().and_then(|extension| extension.to_str()) {
            _ if is_left_out => continue,
            Some("rs") => doc_comments(&read(&name)),
            Some("md") => vec![(1, prose(&read(&name)))],
            _ => continue,
        };
        let is_document = name.ends_with(".md");
        for (line, text) in texts {
            let first = text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            if !is_document && ["What", "Of", "By", "With"].contains(&first) {
                problems.push(format!("{name}:{line}: begins with `{first}`"));
            }
            if let Some(phrase) = forbidden_phrase(&text) {
                problems.push(format!("{name}:{line}: `{phrase}`"));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
