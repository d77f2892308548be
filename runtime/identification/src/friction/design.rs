//! The regression without offsets: the mean of each run is subtracted from the columns and from the torque.
//!
//! Least squares then gives the same coefficients as least squares with a constant for each run (Frisch, Waugh 1933; Lovell
//! 1963). So offsets are separated before the law is fitted, and the library needs no constant term.

use super::super::error::{IdentificationError, Result};
use super::super::methods::confidence::LongRun;
use super::super::methods::least_squares::Reduced;
use super::super::methods::library::Library;
use super::super::methods::moments::{Moments, Samples, contiguous_blocks};
use super::super::methods::offset::{Offset, centre, mean};
use super::super::methods::subset::seen_both_ways;
use super::levels;
use super::settings::Setting;
use super::task::{FrictionData, FrictionIdentification, Offsets};
use gelenk_findings::{Finding, Rule};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Sees: friction terms that cannot be distinguished from an offset.
/// Matters: these terms are left out of the law.
/// Example: Coulomb friction of a joint that moves in one direction only.
/// Fixture: `parameters_that_the_data_do_not_show` in `runtime/tests/identification_bad_input.rs`.
const HIDDEN: Rule = Rule::warning("terms-hidden");

/// Smallest share of a column's norm that must remain after the means of the runs are subtracted. If the share is smaller,
/// the column cannot be distinguished from offsets, and six digits of the data would be lost.
const LEAST_REMAINDER: f64 = 1e-6;

/// Columns of the candidate terms and the torque, without offsets.
pub(super) struct Design<'a> {
    pub(super) data: &'a FrictionData<'a>,
    /// The terms of the library that may be part of the law.
    pub(super) library: Library,
    columns: Vec<Vec<f64>>,
    torque: Vec<f64>,
    pub(super) runs: Vec<Range<usize>>,
    pub(super) separate: bool,
    /// Sentences on terms that were left out of the library, with reasons.
    pub(super) notes: Vec<Setting>,
    /// Sentence on terms that the data do not distinguish from an offset, although friction may have them; `None` if there is
    /// no such term.
    pub(super) hidden: Option<Finding>,
}

impl<'a> Design<'a> {
    pub(super) fn new(settings: &FrictionIdentification, data: &'a FrictionData<'a>) -> Result<Self> {
        let separate = settings.offsets == Offsets::Separate;
        let (library, notes) = seen(&settings.library, settings.offsets, data.velocities)?;
        let (library, hidden) = if separate { without_offsets(library, data)? } else { (library, None) };
        let mut columns = data.columns(&library)?;
        let mut torque = data.torques.to_vec();
        let runs = runs(data);
        require_independent(&library, &columns, data, separate)?;
        if separate {
            for (term, column) in library.terms().iter().zip(&mut columns) {
                centre_term(term, column, &runs)?;
            }
            centre(&mut torque, &runs);
        }
        Ok(Self { data, library, columns, torque, runs, separate, notes, hidden })
    }

    /// Samples of all terms for least squares.
    pub(super) fn samples(&self) -> Result<Samples<'_>> {
        self.samples_of(&(0..self.library.len()).collect::<Vec<_>>())
    }

    /// Samples of some of the terms.
    pub(super) fn samples_of(&self, terms: &[usize]) -> Result<Samples<'_>> {
        let names: Vec<String> = terms.iter().map(|&i| self.library.terms()[i].clone()).collect();
        let columns = terms.iter().map(|&i| self.columns[i].as_slice()).collect();
        Samples::from_columns(&names, columns, vec![&self.torque])
    }

    /// The column of a term.
    pub(super) fn column(&self, term: usize) -> &[f64] {
        &self.columns[term]
    }

    /// Products `Θᵀ F` of some of the terms (Θ) with the terms of another library (F), without offsets.
    pub(super) fn products(&self, terms: &[usize], other: &Library) -> Result<DMatrix<f64>> {
        let mut others = self.data.columns(other)?;
        if self.separate {
            others.iter_mut().for_each(|column| centre(column, &self.runs));
        }
        let product = |term: usize, other: &[f64]| -> f64 {
            self.columns[term].iter().zip(other).map(|(x, f)| x * f).sum()
        };
        Ok(DMatrix::from_fn(terms.len(), others.len(), |i, k| product(terms[i], &others[k])))
    }

    /// Moments of the folds of the cross-validation.
    pub(super) fn folds(&self, samples: &Samples, count: usize) -> Result<Vec<Moments>> {
        Moments::folds(samples, &folds(self.data, count))
    }

    /// Residuals of a law: torque minus offset minus law, for each sample.
    pub(super) fn residuals(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        let mut residuals = self.torque.clone();
        for (column, coefficient) in self.columns.iter().zip(coefficients.iter()) {
            if *coefficient != 0.0 {
                residuals.iter_mut().zip(column).for_each(|(r, x)| *r -= coefficient * x);
            }
        }
        residuals
    }

    /// The constant of each run in addition to a law; empty if constants are part of the law or known.
    pub(super) fn offsets(&self, law: &[f64], residuals: &[f64]) -> Vec<Offset> {
        if !self.separate {
            return Vec::new();
        }
        offsets(self.data, &self.runs, law, residuals)
    }
}

/// The folds of the data, or contiguous blocks. There is at most one block for each sample.
pub(super) fn folds(data: &FrictionData, count: usize) -> Vec<Vec<Range<usize>>> {
    let samples = data.velocities.len();
    let blocks = || contiguous_blocks(samples, count.clamp(1, samples)).map(|block| vec![block]).collect();
    data.folds.map_or_else(blocks, <[_]>::to_vec)
}

/// The runs of the data, or one run with all samples.
pub(super) fn runs(data: &FrictionData) -> Vec<Range<usize>> {
    let whole = 0..data.velocities.len();
    data.runs.map_or_else(|| vec![whole], <[_]>::to_vec)
}

/// The mean of torque minus law in each run, with the standard error of the mean of the residuals.
pub(super) fn offsets(
    data: &FrictionData,
    runs: &[Range<usize>],
    law: &[f64],
    residuals: &[f64],
) -> Vec<Offset> {
    let offset = |rows: &Range<usize>| {
        let left: Vec<f64> = rows.clone().map(|i| data.torques[i] - law[i]).collect();
        let whole = 0..rows.len();
        let spread = LongRun::of_sum(&residuals[rows.clone()], &[whole]);
        Offset {
            samples: rows.clone(),
            value: mean(&left),
            standard_error: (rows.len() >= 24).then(|| spread.standard_error() / rows.len() as f64),
        }
    };
    runs.iter().map(offset).collect()
}

fn centre_term(term: &str, column: &mut [f64], runs: &[Range<usize>]) -> Result<()> {
    let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let before = norm(column);
    centre(column, runs);
    let remains = norm(column) / before;
    if remains > LEAST_REMAINDER {
        return Ok(());
    }
    Err(IdentificationError::Collinear {
        terms: vec![term.into(), "the offset of each run".into()],
        condition: 1.0 / remains,
        limit: 1.0 / LEAST_REMAINDER,
    })
}

/// Fails if terms are collinear. The library is checked together with a constant, so that the message names the terms as
/// they were written.
fn require_independent(
    library: &Library,
    columns: &[Vec<f64>],
    data: &FrictionData,
    separate: bool,
) -> Result<()> {
    let one = vec![1.0; data.velocities.len()];
    let mut names = library.terms().to_vec();
    let mut all: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    if separate {
        names.insert(0, "1".into());
        all.insert(0, &one);
    }
    Reduced::new(&Samples::from_columns(&names, all, vec![data.torques])?).map(|_| ())
}

/// The terms of a library that may be part of a law at these velocities, and sentences on the terms that were left out.
fn seen(library: &Library, offsets: Offsets, velocities: &[f64]) -> Result<(Library, Vec<Setting>)> {
    let library = if offsets == Offsets::PartOfLaw { library.clone() } else { without_constants(library)? };
    let matrix = library.matrix(&[velocities])?;
    let energies = |term: usize| {
        let column = matrix.column(term);
        [1.0, -1.0].map(|sign| column.iter().map(|x| (sign * x).max(0.0).powi(2)).sum())
    };
    let (kept, out) = seen_both_ways(library.terms(), energies);
    let told_apart = kept.iter().enumerate().filter(|(place, term)| {
        let mut steeper = kept[place + 1..].iter();
        offsets != Offsets::Known
            || !steeper.any(|other| {
                are_alike(&matrix.column(**term).into_owned(), &matrix.column(*other).into_owned())
            })
    });
    let told_apart: Vec<usize> = told_apart.map(|(_, term)| *term).collect();
    let note = (!out.is_empty()).then_some(Setting::OneDirection(out));
    Ok((library.only(&told_apart)?, note.into_iter().collect()))
}

/// Whether one column is a multiple of the other within the errors of the data.
fn are_alike(one: &DVector<f64>, other: &DVector<f64>) -> bool {
    let left = one - other * (one.dot(other) / other.norm_squared());
    left.norm() < levels::LEAST_CHANGE.get() * one.norm()
}

/// The library without terms that act as offsets in these data, and a sentence on the terms that were left out. For example,
/// `sign(v)` acts as an offset if each run moves in one direction. If all terms act as offsets, the library is returned
/// unchanged, and the fit refuses it.
fn without_offsets(library: Library, data: &FrictionData) -> Result<(Library, Option<Finding>)> {
    let (matrix, runs) = (library.matrix(&[data.velocities])?, runs(data));
    let varies = |term: &usize| {
        let mut column: Vec<f64> = matrix.column(*term).iter().copied().collect();
        let all: f64 = column.iter().map(|x| x * x).sum();
        centre(&mut column, &runs);
        column.iter().map(|x| x * x).sum::<f64>()
            > levels::LEAST_CHANGE.get() * levels::LEAST_CHANGE.get() * all
    };
    let (kept, out): (Vec<usize>, Vec<usize>) = (0..library.len()).partition(varies);
    // A later check reports too few samples.
    if kept.is_empty() || out.is_empty() || data.velocities.len() <= library.len() {
        return Ok((library, None));
    }
    let out: Vec<&str> = out.iter().map(|i| library.terms()[*i].as_str()).collect();
    let message = format!(
        "the law omits these terms, because they hardly change within a run: {}. The offset of each run contains their forces. \
         Record motion in both directions, including slow motion",
        out.join(", ")
    );
    Ok((library.only(&kept)?, Some(HIDDEN.found(message))))
}

/// The library without terms that are constant at all speeds.
fn without_constants(library: &Library) -> Result<Library> {
    // At these speeds a term of a friction law that is not constant has different values.
    let speeds = [-17.3, -1.1, -0.07, 0.0, 0.003, 0.21, 2.9, 31.0];
    let matrix = library.matrix(&[&speeds])?;
    let varies = |i: &usize| matrix.column(*i).iter().any(|x| *x != matrix[(0, *i)]);
    let kept: Vec<usize> = (0..library.len()).filter(varies).collect();
    if kept.is_empty() {
        return Err(IdentificationError::Empty {
            what: "the list of friction terms (without constant terms, which are offsets)".into(),
        });
    }
    library.only(&kept)
}
