//! Sums of products ("moments") of all columns of `[Θ | Y]`, for all samples or for blocks of samples. Θ has the columns of the
//! terms of a library, and Y has the columns of the targets. One pass over the samples computes the sums.
//!
//! Sparse regression and cross-validation need only these sums, so the samples are read once for any number of models. ΘᵀΘ
//! has the squared condition number of Θ. If this number is too large, [`super::least_squares`] factors the samples
//! orthogonally instead.

use super::super::error::{IdentificationError, Result, require_finite, require_length, require_samples};
use super::super::numeric::kernel::{BLOCK, add_products};
use super::super::numeric::spectrum::symmetric_eigenvalues;
use super::super::numeric::statistics::largest;
use super::library::Library;
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;
use std::ops::Range;

/// Returns for each fold the sum of all other folds, and the fold itself.
pub(crate) fn splits(folds: &[Moments]) -> impl Iterator<Item = Result<(Moments, &Moments)>> {
    folds.iter().enumerate().map(|(k, fold)| {
        let others = folds.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, fold)| fold);
        Ok((Moments::sum(others)?, fold))
    })
}

/// Samples `[Θ | Y]` of a regression: Θ has a column for each term of a library, and Y has a column for each target.
#[derive(Debug, Clone)]
pub struct Samples<'a> {
    names: Vec<String>,
    /// Columns of the terms, then columns of the targets.
    columns: Vec<Cow<'a, [f64]>>,
}

impl<'a> Samples<'a> {
    /// Creates samples from stored columns.
    ///
    /// - `names`: names of the terms
    /// - `columns`: columns of the terms
    /// - `targets`: columns of the targets
    ///
    /// # Errors
    /// [`IdentificationError::Empty`] if there are no samples, [`IdentificationError::Shape`] if lengths differ.
    pub fn from_columns(names: &[String], columns: Vec<&'a [f64]>, targets: Vec<&'a [f64]>) -> Result<Self> {
        require_length("names of the columns", columns.len(), names.len())?;
        Self::new(names, columns.into_iter().map(Cow::Borrowed), targets)
    }

    /// Creates samples from a matrix Θ with one row for each sample and one column for each term.
    #[cfg(test)]
    pub(crate) fn from_matrix(
        names: &[String],
        theta: &'a DMatrix<f64>,
        targets: Vec<&'a [f64]>,
    ) -> Result<Self> {
        let columns = theta.as_slice().chunks_exact(theta.nrows().max(1)).collect();
        Self::from_columns(names, columns, targets)
    }

    /// Creates samples from the channels (signals) of a library.
    ///
    /// - `channels`: one column for each channel of `library`, in its order
    /// - `targets`: columns of the targets
    ///
    /// # Errors
    /// [`IdentificationError::Empty`] if there are no samples, [`IdentificationError::Shape`] if the number of channels is
    /// wrong or lengths differ.
    pub fn from_library(library: &Library, channels: Vec<&[f64]>, targets: Vec<&'a [f64]>) -> Result<Self> {
        Self::new(library.terms(), library.columns(&channels)?.into_iter().map(Cow::Owned), targets)
    }

    fn new(
        names: &[String],
        terms: impl Iterator<Item = Cow<'a, [f64]>>,
        targets: Vec<&'a [f64]>,
    ) -> Result<Self> {
        let samples = targets.first().map_or(0, |target| target.len());
        require_samples("the regression", 1, samples)?;
        let columns: Vec<Cow<[f64]>> = terms.chain(targets.into_iter().map(Cow::Borrowed)).collect();
        for column in &columns {
            require_length("samples of a column", samples, column.len())?;
        }
        Ok(Self { names: names.to_vec(), columns })
    }

    /// Number of samples m.
    pub(crate) fn len(&self) -> usize {
        self.columns.last().map_or(0, |target| target.len())
    }

    /// Columns of the terms.
    pub(crate) fn terms(&self) -> &[Cow<'a, [f64]>] {
        &self.columns[..self.names.len()]
    }

    /// Number of columns of terms and targets.
    pub(crate) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Calls `visit` for blocks of at most 256 samples within `rows`. The arguments are the columns of the
    /// terms, followed by the targets.
    pub(crate) fn visit(&self, rows: Range<usize>, visit: &mut dyn FnMut(&[&[f64]])) {
        for start in rows.clone().step_by(BLOCK) {
            let block = start..rows.end.min(start + BLOCK);
            visit(&self.columns.iter().map(|column| &column[block.clone()]).collect::<Vec<_>>());
        }
    }

    /// Returns the error about the first value that is not finite. If all values are finite, the error is an overflow.
    fn explain_not_finite(&self) -> IdentificationError {
        let name = |i: usize| match self.names.get(i) {
            Some(term) => format!("the term {term}"),
            None => format!("target {}", i - self.names.len()),
        };
        let largest = |i: &usize| largest(&*self.columns[*i]);
        let wrong = self.columns.iter().enumerate().find_map(|(i, x)| require_finite(&name(i), x).err());
        wrong.unwrap_or_else(|| {
            let all = 0..self.columns.len();
            let i = all.max_by(|i, j| largest(i).total_cmp(&largest(j))).unwrap_or(0);
            IdentificationError::Overflow { what: name(i), largest: largest(&i) }
        })
    }
}

/// Sums of products `[Θ | Y]ᵀ [Θ | Y]` over a set of samples. Θ has the columns of the terms, and Y has the columns of the
/// targets.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    names: Vec<String>,
    samples: usize,
    products: DMatrix<f64>,
}

impl Moments {
    /// Computes the sums over all samples.
    ///
    /// # Errors
    /// - [`IdentificationError::NotFinite`] with column and row: a value is not finite
    /// - [`IdentificationError::Overflow`]: squares overflow
    pub fn new(samples: &Samples) -> Result<Self> {
        Ok(Self::blocks(samples, 1)?.remove(0))
    }

    /// Computes the sums over `count` contiguous blocks of nearly equal size. If the division has a remainder, the first
    /// blocks have one sample more.
    ///
    /// # Errors
    /// - [`IdentificationError::TooFewSamples`]: there are fewer samples than blocks
    /// - The errors of [`Self::new`]
    pub fn blocks(samples: &Samples, count: usize) -> Result<Vec<Self>> {
        require_samples(&format!("a division into {count} blocks"), count.max(1), samples.len())?;
        let ranges: Vec<_> = contiguous_blocks(samples.len(), count.max(1)).collect();
        Self::ranges(samples, &ranges)
    }

    /// Computes the sums over given ranges of samples, for example the runs of a log.
    ///
    /// # Errors
    /// - `Empty`: a range is empty
    /// - `Shape`: a range ends after the last sample
    /// - The errors of [`Self::new`]
    pub(crate) fn ranges(samples: &Samples, ranges: &[Range<usize>]) -> Result<Vec<Self>> {
        let mut blocks = Vec::with_capacity(ranges.len());
        for rows in ranges.iter().cloned() {
            require_samples("a range of samples", 1, rows.len())?;
            if rows.end > samples.len() {
                require_length("samples up to the end of a range", rows.end, samples.len())?;
            }
            let block = Self::over(samples, rows);
            if block.products.iter().any(|x| !x.is_finite()) {
                return Err(samples.explain_not_finite());
            }
            blocks.push(block);
        }
        Ok(blocks)
    }

    /// Computes the sums over folds. Each fold consists of several ranges of samples.
    ///
    /// # Errors
    /// The errors of [`Self::ranges`], and `Empty` if a fold has no ranges
    pub(crate) fn folds(samples: &Samples, folds: &[Vec<Range<usize>>]) -> Result<Vec<Self>> {
        folds.iter().map(|ranges| Self::sum(&Self::ranges(samples, ranges)?)).collect()
    }

    fn over(samples: &Samples, rows: Range<usize>) -> Self {
        let q = samples.width();
        let mut sums = vec![0.0; q * q];
        let count = rows.len();
        samples.visit(rows, &mut |columns| add_products(columns, &mut sums));
        let products = DMatrix::from_fn(q, q, |i, j| sums[i.max(j) * q + i.min(j)]);
        Self { names: samples.names.clone(), samples: count, products }
    }

    /// Creates moments from the matrix of products of the terms' columns and one target column.
    pub(crate) fn of_products(names: Vec<String>, samples: usize, products: DMatrix<f64>) -> Self {
        Self { names, samples, products }
    }

    /// Adds several moments of the same columns.
    ///
    /// # Errors
    /// [`IdentificationError::Empty`] if there are no parts, [`IdentificationError::Shape`] if parts have different numbers
    /// of columns.
    pub fn sum<'m>(parts: impl IntoIterator<Item = &'m Self>) -> Result<Self> {
        let mut parts = parts.into_iter();
        let Some(first) = parts.next() else {
            return Err(IdentificationError::Empty { what: "the sum of moments".into() });
        };
        let mut total = first.clone();
        for part in parts {
            require_length("columns of the moments", total.products.ncols(), part.products.ncols())?;
            total.samples += part.samples;
            total.products += &part.products;
        }
        Ok(total)
    }

    /// Returns the texts of the terms.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the number of terms p.
    pub(crate) fn terms(&self) -> usize {
        self.names.len()
    }

    /// Returns the number of samples m.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Returns the number of target columns.
    pub(crate) fn targets(&self) -> usize {
        self.products.ncols() - self.names.len()
    }

    /// Fails if there is no target with this index.
    pub(crate) fn require_target(&self, target: usize) -> Result<()> {
        if target < self.targets() { Ok(()) } else { require_length("targets", target + 1, self.targets()) }
    }

    /// Returns the Gram matrix ΘᵀΘ, which is p × p.
    pub(crate) fn gram(&self) -> DMatrix<f64> {
        let p = self.terms();
        self.products.view((0, 0), (p, p)).into_owned()
    }

    /// Returns the products Θᵀy of the terms' columns Θ with one target y.
    pub(crate) fn projection(&self, target: usize) -> DVector<f64> {
        let p = self.terms();
        self.products.view((0, p + target), (p, 1)).column(0).into_owned()
    }

    /// Returns the sum of squares yᵀy of one target y.
    pub(crate) fn energy(&self, target: usize) -> f64 {
        let i = self.terms() + target;
        self.products[(i, i)]
    }

    /// Returns the residual sum of squares `‖y − Θ ξ‖²`, computed from the sums. Θ has the columns of the terms. Cancellation
    /// limits the accuracy to about 1e-14 of yᵀy.
    ///
    /// - `target`: index of the target column y
    /// - `coefficients`: coefficients ξ of all terms
    pub fn residual(&self, target: usize, coefficients: &DVector<f64>) -> f64 {
        let b = self.projection(target);
        let quadratic = (self.gram() * coefficients).dot(coefficients);
        (self.energy(target) - 2.0 * b.dot(coefficients) + quadratic).max(0.0)
    }

    /// Returns the p × p matrix of cosines of the angles between the terms' columns. It is the correlation matrix of the
    /// terms if their means are not subtracted.
    pub fn correlation(&self) -> DMatrix<f64> {
        let p = self.terms();
        let norm = |i: usize| self.products[(i, i)].sqrt();
        DMatrix::from_fn(p, p, |i, j| {
            let product = norm(i) * norm(j);
            if product > 0.0 { self.products[(i, j)] / product } else { 0.0 }
        })
    }

    /// Returns the condition number of the library with its columns scaled to unit length; ∞ if a column is zero. Values
    /// above 1e7 are only lower bounds, because the number is computed from the Gram matrix.
    pub(crate) fn condition(&self) -> f64 {
        let eigenvalues = symmetric_eigenvalues(&self.correlation());
        let (least, largest) = (eigenvalues.min(), eigenvalues.max());
        if least > 0.0 { (largest / least).sqrt() } else { f64::INFINITY }
    }

    /// Error that these terms cannot be distinguished.
    pub(crate) fn collinear(&self, terms: &[usize]) -> IdentificationError {
        let terms = terms.iter().map(|&i| self.names[i].clone()).collect();
        IdentificationError::Collinear { terms, condition: self.condition(), limit: 1e7 }
    }

    pub(crate) fn require_no_zero_column(&self) -> Result<()> {
        match (0..self.terms()).find(|&i| self.products[(i, i)] == 0.0) {
            None => Ok(()),
            Some(i) => {
                Err(IdentificationError::ZeroColumn { term: self.names[i].clone(), samples: self.samples })
            }
        }
    }
}

/// Divides 0..samples into `count` contiguous ranges. The first `samples mod count` ranges have one sample more.
pub(crate) fn contiguous_blocks(samples: usize, count: usize) -> impl Iterator<Item = Range<usize>> {
    let (size, longer) = (samples / count, samples % count);
    (0..count).map(move |k| {
        let start = k * size + k.min(longer);
        start..start + size + usize::from(k < longer)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    #[test]
    fn sums_equal_the_matrix_product() {
        let mut random = SplitMix64::new(1);
        let m = 1001;
        let theta = DMatrix::from_fn(m, 5, |_, _| random.normal());
        let y: Vec<f64> = (0..m).map(|_| random.normal()).collect();
        let names: Vec<String> = (0..5).map(|i| format!("t{i}")).collect();
        let samples = Samples::from_matrix(&names, &theta, vec![&y]).unwrap();
        let plain = Moments::new(&samples).unwrap();
        assert!((plain.gram() - theta.transpose() * &theta).amax() < 1e-11);
        let b = theta.transpose() * DVector::from_column_slice(&y);
        assert!((plain.projection(0) - b).amax() < 1e-11);
        let blocks = Moments::blocks(&samples, 7).unwrap();
        assert_eq!(blocks.iter().map(Moments::samples).collect::<Vec<_>>(), [143; 7]);
        assert!((Moments::sum(&blocks).unwrap().gram() - plain.gram()).amax() < 1e-11);
        let runs = Moments::ranges(&samples, &[0..143, 143..1001]).unwrap();
        assert_eq!(runs[0], blocks[0]);
        let message = |range: Range<usize>| {
            let runs = Moments::ranges(&samples, &[range]);
            runs.unwrap_err().to_string()
        };
        assert!(message(900..1002).contains("1002 are expected, but 1001 are given"));
        assert!(message(5..5).starts_with("a range of samples is empty"));
    }

    #[test]
    fn library_evaluated_on_the_fly_equals_the_stored_matrix() {
        let library = Library::friction().unwrap();
        let v: Vec<f64> = (0..3000).map(|i| (0.01 * f64::from(i)).sin()).collect();
        let theta = library.matrix(&[&v]).unwrap();
        let stored = Moments::new(&Samples::from_matrix(library.terms(), &theta, vec![&v]).unwrap()).unwrap();
        let streamed = Moments::new(&Samples::from_library(&library, vec![&v], vec![&v]).unwrap()).unwrap();
        assert_eq!(stored, streamed);
    }

    #[test]
    fn bad_values_are_reported_with_their_row() {
        let mut v = vec![0.5; 600];
        v[321] = f64::NAN;
        v[400] = f64::NAN;
        let library = Library::new(&["v", "v*v"], &["v"]).unwrap();
        let y = vec![1.0; 600];
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let message = Moments::new(&samples).unwrap_err().to_string();
        assert!(message.starts_with(
            "the term v is not finite (NaN) at row 321 (counted from 0), and 2 of 600 values are not finite"
        ));
        let huge = vec![1e200; 600];
        let samples = Samples::from_library(&library, vec![&y], vec![&huge]).unwrap();
        assert!(Moments::new(&samples).unwrap_err().to_string().contains("target 0 has values up to 1e200"));
        assert!(
            Samples::from_library(&library, vec![&[]], vec![&[]]).unwrap_err().to_string().contains("empty")
        );
    }
}
