//! Names of friction terms and of identification methods on the command line.

use super::super::error::{IdentificationError, Result};
use super::super::methods::expression::fault;
use super::super::methods::lasso::Lasso;
use super::super::methods::library::Library;
use super::super::methods::stribeck::StribeckRegression;
use super::super::methods::thresholding::Thresholding;
use super::selection::FrictionMethod;
use super::task::FrictionIdentification;
use std::collections::BTreeMap;

/// Names of groups of terms, each with its terms.
const WORDS: [(&str, &[&str]); 4] = [
    ("viscous", &["v"]),
    ("coulomb", &["sign(v)", "tanh(5*v)", "tanh(10*v)", "tanh(20*v)", "tanh(100*v)"]),
    ("asymmetric", &["abs(v)", "abs(tanh(20*v))"]),
    ("quadratic", &["v*abs(v)"]),
];

/// The Stribeck law with five parameters, which is not a sum of terms.
const STRIBECK: &str = "stribeck";

/// A function that makes a method from a threshold. Only STLS (sequentially thresholded least squares) uses the threshold.
type Make = fn(Option<f64>) -> FrictionMethod;

/// Methods that choose the terms of a friction law: name on the command line, description in one sentence, and a function that
/// makes the method from the threshold of STLS.
pub const METHODS: [(&str, &str, Make); 4] = [
    (
        "subset",
        "Best subset: the fewest terms within one standard error of the least error on held-out data",
        |_| FrictionMethod::BestSubset,
    ),
    ("stls", "SINDy: sequentially thresholded least squares, with --threshold", |threshold| {
        let standard = Thresholding::default();
        let threshold = threshold.unwrap_or(standard.threshold);
        FrictionMethod::Thresholding(Thresholding { threshold, ..standard })
    }),
    (
        "lasso",
        "LASSO with a cross-validated penalty (one standard error), then least squares on its terms",
        |_| FrictionMethod::Lasso(Lasso { standardize: true, ..Lasso::default() }),
    ),
    ("all", "Least squares on all terms", |_| FrictionMethod::LeastSquares),
];

impl FrictionIdentification {
    /// Returns the same settings with another method.
    ///
    /// - `word`: name of one of the [`METHODS`]
    /// - `threshold`: threshold of `stls` in the units of the coefficients; 0.1 if it is `None`
    ///
    /// # Errors
    /// [`IdentificationError::Expression`] if the name is unknown or if these settings are for the Stribeck law, which has
    /// no terms to choose from. [`IdentificationError::Setting`] if a threshold is given for another method than `stls`.
    pub fn by_method(&self, word: &str, threshold: Option<f64>) -> Result<Self> {
        if matches!(self.method, FrictionMethod::Stribeck(_)) {
            let message = "the Stribeck law has fixed terms, so no method chooses them: leave --method out";
            return Err(fault(STRIBECK, message));
        }
        let Some((.., make)) = METHODS.iter().find(|(known, ..)| *known == word) else {
            return Err(fault(word, "no method has this name: use subset, stls, lasso or all"));
        };
        match (make(threshold), threshold) {
            (method @ FrictionMethod::Thresholding(_), _) | (method, None) => {
                Ok(Self { method, ..self.clone() })
            }
            (_, Some(value)) => Err(IdentificationError::Setting {
                name: "threshold".to_owned(),
                value,
                requirement: "only --method stls has a threshold: leave --threshold out".to_owned(),
            }),
        }
    }

    /// Returns the same settings with a library of the given terms.
    ///
    /// - `terms`: words and expressions in the velocity `v`, separated by commas, for example `viscous, coulomb, v*v*v`. The
    ///   words are `viscous`, `coulomb`, `asymmetric` and `quadratic`. The single word `stribeck` selects the Stribeck law.
    ///
    /// # Errors
    /// [`IdentificationError::Expression`] if a term is not a known word or a valid expression, or if `stribeck` is combined
    /// with other terms. Errors of [`Library::new`] if the list is empty or contains a term twice.
    pub fn of_terms(&self, terms: &str) -> Result<Self> {
        let listed = between_commas(terms);
        if listed.iter().any(|term| term.eq_ignore_ascii_case(STRIBECK)) {
            if listed.len() > 1 {
                let message = "`stribeck` is not combined with other terms: the Stribeck law includes viscous and Coulomb friction";
                return Err(fault(terms, message));
            }
            return Ok(Self {
                method: FrictionMethod::Stribeck(StribeckRegression::default()),
                ..self.clone()
            });
        }
        listed.iter().try_for_each(|term| require_known(term))?;
        let meant = listed.iter().flat_map(|term| {
            let word = WORDS.iter().find(|(word, _)| term.eq_ignore_ascii_case(word));
            word.map_or_else(|| vec![*term], |(_, terms)| terms.to_vec())
        });
        let library = Library::new(&meant.collect::<Vec<_>>(), &["v"])?;
        library.terms().iter().try_for_each(|term| require_generated(term))?;
        let method = match &self.method {
            FrictionMethod::Ladder(_) => FrictionMethod::BestSubset,
            method => method.clone(),
        };
        Ok(Self { library, method, ..self.clone() })
    }
}

/// Fails if a term is a word, but neither the velocity `v` nor one of the [`WORDS`].
fn require_known(term: &str) -> Result<()> {
    let is_word = term.chars().all(|c| c.is_ascii_alphabetic() || c == '_');
    let known = || WORDS.iter().map(|(word, _)| *word).chain([STRIBECK, "v"]);
    if !is_word || known().any(|word| term.eq_ignore_ascii_case(word)) {
        return Ok(());
    }
    let message = gelenk_formula::nearest(term, known()).unwrap_or_default();
    Err(fault(term, format!("no term has this name; {message}")))
}

/// Fails if a description cannot contain a term, because the law is written into a description.
fn require_generated(term: &str) -> Result<()> {
    let found = gelenk_formula::parse(term, gelenk_formula::Allowed::Velocity, &BTreeMap::new());
    found.map(|_| ()).map_err(|error| fault(term, error.to_string()))
}

/// Parts between the commas outside of parentheses, without empty parts.
fn between_commas(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0_i32, 0, Vec::new());
    for (place, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth <= 0 => {
                parts.push(&text[start..place]);
                start = place + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts.into_iter().map(str::trim).filter(|part| !part.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(terms: &str) -> Result<FrictionIdentification> {
        FrictionIdentification::new().unwrap().of_terms(terms)
    }

    #[test]
    fn words_and_expressions_make_a_library() {
        let found = of("viscous, Quadratic,tanh(50*v)").unwrap();
        assert_eq!(found.library.terms(), ["v", "v*abs(v)", "tanh(50*v)"]);
        assert_eq!(found.method, FrictionIdentification::new().unwrap().method);
        let library = of("viscous,coulomb,asymmetric").unwrap().library;
        // The default library without its constant, which is the offset's.
        let mut terms = Library::joint_friction().unwrap().terms().to_vec();
        terms.retain(|term| term != "1");
        assert_eq!(library.terms(), terms);
        assert!(matches!(of("stribeck").unwrap().method, FrictionMethod::Stribeck(_)));
        let method = FrictionMethod::Ladder(StribeckRegression::default());
        let ladder = FrictionIdentification { method, ..FrictionIdentification::new().unwrap() };
        assert_eq!(ladder.of_terms("viscous").unwrap().method, FrictionMethod::BestSubset);
    }

    #[test]
    fn what_names_no_terms_is_refused() {
        let fault = |terms: &str| of(terms).unwrap_err().to_string();
        assert!(fault("stribeck,viscous").contains("is not combined"), "{}", fault("stribeck,viscous"));
        assert!(fault("").contains("the list of friction terms"), "{}", fault(""));
        assert!(fault("viscous,v").contains("twice"), "{}", fault("viscous,v"));
        assert!(fault("viscos").contains("viscos"), "{}", fault("viscos"));
        assert!(fault("viscos").contains("did you mean `viscous`?"), "{}", fault("viscos"));
        assert!(fault("dry").contains("known names are `viscous`"), "{}", fault("dry"));
        assert!(fault("max(v, 0)").contains("max"), "{}", fault("max(v, 0)"));
        assert!(fault("tanh(v").contains("tanh(v"), "{}", fault("tanh(v"));
    }
}
