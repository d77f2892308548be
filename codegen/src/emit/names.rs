//! Converts names of descriptions and programs to identifiers of a language.
//!
//! The names of a model are already checked. The conversion ensures once more that no string becomes code.
//! Identifiers are ASCII, because other letters are not valid in C99 and cause lints about confusable names.

use crate::distinct::Distinct;
use crate::program::{Program, letters};

/// Rules for identifiers of a programming language.
pub(super) struct Spelling {
    /// Words that must not be identifiers, in sorted order.
    pub(super) keywords: &'static [&'static str],
    /// Whether the language allows identifiers such as `_x` and `a__b`, which C reserves.
    pub(super) has_free_underscores: bool,
    /// Prefixes with which identifiers must not begin.
    pub(super) prefixes: Vec<String>,
}

impl Spelling {
    /// Converts `name` to an identifier. A name that is already an identifier is returned unchanged.
    pub(super) fn identifier(&self, name: &str) -> String {
        let mut text = String::with_capacity(name.len());
        for letter in name.chars() {
            match letters::greek_name(letter) {
                Some(word) => text.push_str(word),
                None if letter.is_ascii_alphanumeric() => text.push(letter),
                None => text.push('_'),
            }
        }
        if !self.has_free_underscores {
            while text.contains("__") {
                text = text.replace("__", "_");
            }
        }
        let is_first =
            |first: char| first.is_ascii_alphabetic() || (first == '_' && self.has_free_underscores);
        let says_something = text.contains(|letter: char| letter.is_ascii_alphabetic());
        if !text.starts_with(is_first) || !says_something {
            text.insert(0, 'x');
        }
        if self.prefixes.iter().any(|prefix| text.starts_with(prefix.as_str())) {
            text.insert_str(0, "x_");
        }
        if self.keywords.binary_search(&text.as_str()).is_ok() {
            text.push('_');
        }
        text
    }

    /// Converts `names` to identifiers that differ from each other and from `taken`. If an identifier is
    /// already in use, `_` and a number are appended.
    pub(super) fn distinct<'a>(
        &self,
        names: impl IntoIterator<Item = &'a str>,
        taken: &[String],
    ) -> Vec<String> {
        let mut used: Distinct = taken.iter().cloned().collect();
        let spellings = names.into_iter().map(|name| self.identifier(name));
        spellings.map(|spelling| used.take_by_stem(&spelling, spelling.trim_end_matches('_'))).collect()
    }

    /// Determines the names in the body of a function.
    ///
    /// - `reserved`: names that must not be used
    /// - `in_place`: whether the results are arguments
    pub(super) fn of_program(&self, program: &Program, reserved: &[String], in_place: bool) -> ProgramNames {
        let mut taken = reserved.to_vec();
        taken.push("p".to_owned());
        let inputs = program.inputs.iter().map(|input| input.name.as_str());
        let arguments = self.distinct(inputs, &taken);
        taken.extend(arguments.iter().cloned());
        let results = match in_place {
            true => self.results(program, &taken),
            false => vec![],
        };
        taken.extend(results.iter().cloned());
        let instructions = program.instructions.iter();
        let values = self.distinct(instructions.map(|each| each.name.as_str()), &taken);
        ProgramNames { arguments, results, values }
    }

    /// Names of arguments for the results of a program.
    pub(super) fn results(&self, program: &Program, taken: &[String]) -> Vec<String> {
        let spelled = program.outputs.iter().map(|output| spelled(&output.name));
        let spelled: Vec<String> = spelled.collect();
        self.distinct(spelled.iter().map(String::as_str), taken)
    }
}

/// Names of arguments, results and values in the body of a function.
pub(super) struct ProgramNames {
    /// Names of the function's input arrays.
    pub(super) arguments: Vec<String>,
    /// Names of the arguments that receive results; empty if the function returns its results.
    pub(super) results: Vec<String>,
    /// Name of the value that each instruction computes.
    pub(super) values: Vec<String>,
}

/// Spells the symbol of a result in ASCII words, for example `d_a_dy` for `∂ÿ/∂y`.
pub(super) fn spelled(symbol: &str) -> String {
    let name = symbol.replace("⁻¹", "_inverse").replace('ẏ', "v");
    let name = name.replace('⁺', "_next").replace('ÿ', "a").replace('∂', "d");
    name.replace(['/', ' '], "_").to_lowercase()
}
