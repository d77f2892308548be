//! The columns of the regression: candidate terms that the velocities distinguish.

use super::super::error::{IdentificationError, Result};
use super::super::methods::library::Library;
use super::super::methods::moments::{Moments, Samples, contiguous_blocks};
use super::super::methods::subset::seen_both_ways;
use super::levels;
use super::settings::note_on_direction;
use super::task::{FrictionData, FrictionIdentification, Offsets};
use gelenk_findings::Finding;
use nalgebra::DVector;
use std::ops::Range;

/// Columns of the candidate terms.
pub(super) struct Design<'a> {
    pub(super) data: &'a FrictionData<'a>,
    /// The terms of the library that may be part of the law.
    pub(super) library: Library,
    columns: Vec<Vec<f64>>,
    /// Notes on terms that were left out of the library, with reasons.
    pub(super) notes: Vec<Finding>,
}

impl<'a> Design<'a> {
    pub(super) fn new(settings: &FrictionIdentification, data: &'a FrictionData<'a>) -> Result<Self> {
        let (library, notes) = seen(&settings.library, settings.offsets, data.velocities)?;
        Ok(Self { columns: data.columns(&library)?, data, library, notes })
    }

    /// Samples of all terms for least squares.
    pub(super) fn samples(&self) -> Result<Samples<'_>> {
        self.samples_of(&(0..self.library.len()).collect::<Vec<_>>())
    }

    /// Samples of some of the terms.
    pub(super) fn samples_of(&self, terms: &[usize]) -> Result<Samples<'_>> {
        let names: Vec<String> = terms.iter().map(|&i| self.library.terms()[i].clone()).collect();
        let columns = terms.iter().map(|&i| self.columns[i].as_slice()).collect();
        Samples::from_columns(&names, columns, vec![self.data.torques])
    }

    /// Moments of the folds of the cross-validation.
    pub(super) fn folds(&self, samples: &Samples, count: usize) -> Result<Vec<Moments>> {
        Moments::folds(samples, &folds(self.data, count))
    }

    /// Residuals of a law: torque minus law, for each sample.
    pub(super) fn residuals(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        let mut residuals = self.data.torques.to_vec();
        for (column, coefficient) in self.columns.iter().zip(coefficients.iter()) {
            if *coefficient != 0.0 {
                residuals.iter_mut().zip(column).for_each(|(r, x)| *r -= coefficient * x);
            }
        }
        residuals
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

/// The terms of a library that may be part of a law at these velocities, and notes on the terms that were left out.
fn seen(library: &Library, offsets: Offsets, velocities: &[f64]) -> Result<(Library, Vec<Finding>)> {
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
    Ok((library.only(&told_apart)?, note_on_direction(&out).into_iter().collect()))
}

/// Whether one column is a multiple of the other within the errors of the data.
fn are_alike(one: &DVector<f64>, other: &DVector<f64>) -> bool {
    let left = one - other * (one.dot(other) / other.norm_squared());
    left.norm() < levels::LEAST_CHANGE.get() * one.norm()
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
