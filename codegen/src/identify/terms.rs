//! Tables of the friction terms, with their intervals and probabilities, for the report page ([`super::page`]) and for the JSON
//! output.

use gelenk_findings::digits::{plain, significant};
use gelenk_identification::friction::{Candidate, FrictionReport};
use gelenk_identification::identify::Identification;
use gelenk_identification::methods::subset::ValidatedSubset;
use gelenk_report::{Cell, Table};
use serde_json::{Value, json};

/// Number of digits with which values of unknown error are printed.
const DIGITS: usize = 4;

/// Returns the terms of all friction laws with their intervals, and the probability that a law contains the
/// term.
pub(super) fn table(found: &Identification) -> Table {
    let mut table = Table::new(
        "friction_terms",
        "Candidate terms of the friction laws. Terms that were not chosen have no coefficient. The probability of a term is the \
         total weight of the subsets with this term, by the Bayesian information criterion.",
    )
    .columns(&["joint", "term", "coefficient", "lowest", "highest", "probability"]);
    for joint in &found.friction {
        let Ok(report) = &joint.report else { continue };
        table = table.rows(report.candidates().iter().map(|candidate| row(&joint.name, candidate)));
    }
    table
}

fn row(joint: &str, candidate: &Candidate) -> Vec<Cell> {
    let probability = candidate.probability.map_or(Cell::Empty, |share| Cell::Rounded(share, 3));
    let error = candidate.chosen.and_then(|term| term.standard_error);
    let ends = candidate.interval;
    let numbers =
        [candidate.chosen.map(|term| term.coefficient), ends.map(|[low, _]| low), ends.map(|[_, high]| high)];
    let numbers = numbers.map(|number| number.map_or(Cell::Empty, |number| measured(number, error)));
    let names = [Cell::text(joint), Cell::Code(candidate.basis.to_owned())];
    names.into_iter().chain(numbers).chain([probability]).collect()
}

/// Returns the table cell of a number with the digits that its error justifies.
pub(super) fn measured(value: f64, error: Option<f64>) -> Cell {
    Cell::Rounded(value, significant(value, error).unwrap_or(DIGITS))
}

/// Returns the tables of the choice of terms of all friction laws as rows of text. The columns are joint, number of
/// terms, rms error on held-out data, `*` for the chosen row, and terms.
#[must_use]
pub fn front(found: &Identification) -> Vec<Vec<String>> {
    let head =
        ["joint", "terms", "rms error on held-out data", "", "terms of the law"].map(str::to_owned).to_vec();
    let mut table = vec![head];
    for joint in &found.friction {
        let Some((report, subsets)) = joint.report.as_ref().ok().and_then(|r| Some((r, r.subsets.as_ref()?)))
        else {
            continue;
        };
        table.extend(subsets.best.iter().enumerate().map(|(place, subset)| {
            let terms: Vec<&str> = subset.active.iter().map(|&i| report.terms[i].as_str()).collect();
            vec![
                joint.name.clone(),
                subset.active.len().to_string(),
                plain(subset.mean_error.sqrt(), DIGITS),
                if place == subsets.chosen { "*" } else { "" }.to_owned(),
                terms.join(", "),
            ]
        }));
    }
    table
}

/// Returns the table of the choice of terms (error against number of terms) of a friction law as JSON.
#[must_use]
pub fn front_as_json(report: &FrictionReport) -> Value {
    let Some(subsets) = &report.subsets else { return Value::Null };
    let of = |(place, subset): (usize, &ValidatedSubset)| {
        json!({
            "terms": subset.active.iter().map(|&i| report.terms[i].as_str()).collect::<Vec<_>>(),
            "squared_error": subset.mean_error,
            "standard_error": subset.standard_error,
            "chosen": place == subsets.chosen,
        })
    };
    subsets.best.iter().enumerate().map(of).collect()
}

/// Returns the terms of a friction law as JSON. Terms that were not chosen have no coefficient.
#[must_use]
pub fn terms_as_json(report: &FrictionReport) -> Value {
    let of = |candidate: &Candidate| {
        let term = candidate.chosen;
        json!({
            "term": candidate.basis,
            "coefficient": term.map(|term| term.coefficient),
            "standard_error": term.and_then(|term| term.standard_error),
            "interval": candidate.interval,
            "probability": candidate.probability,
        })
    };
    report.candidates().iter().map(of).collect()
}
