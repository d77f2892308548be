//! Values of a library or a friction law at the samples. If the torques passed a filter, the values pass the same filter.

use super::super::error::Result;
use super::super::methods::filtered::Filtered;
use super::super::methods::library::Library;
use super::super::numeric::statistics::largest;
use super::super::result::FrictionLaw;
use super::levels;
use super::task::FrictionData;
use nalgebra::DMatrix;

impl FrictionData<'_> {
    /// The speed above which the filter does not distort the law. This speed is the tenth smallest
    /// speed of the samples that are farther from rests and reversals than the filter reaches. If there are fewer than ten of
    /// these samples, it is the largest speed of all samples.
    pub(super) fn resolved_from(&self) -> f64 {
        let near = self.filtered.map_or_else(|| vec![false; self.velocities.len()], Filtered::near);
        let away = self.velocities.iter().zip(near).filter(|(_, near)| !near);
        let mut speeds: Vec<f64> = away.map(|(v, _)| v.abs()).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.get(levels::RESOLVING.get() - 1).copied().unwrap_or_else(|| self.fastest())
    }

    /// The largest speed of the samples.
    pub(super) fn fastest(&self) -> f64 {
        largest(self.velocities)
    }

    /// The terms of a library at the samples.
    pub(super) fn columns(&self, library: &Library) -> Result<Vec<Vec<f64>>> {
        match self.filtered {
            Some(filtered) => filtered.columns(|v| library.matrix(&[v])),
            None => library.columns(&[self.velocities]),
        }
    }

    /// The torques of a law at the samples.
    pub(super) fn torques_of(&self, law: &FrictionLaw) -> Result<Vec<f64>> {
        match self.filtered {
            Some(filtered) => {
                let torques = |v: &[f64]| Ok(DMatrix::from_column_slice(v.len(), 1, &law.torques(v)?));
                Ok(filtered.columns(torques)?.pop().unwrap_or_default())
            }
            None => law.torques(self.velocities),
        }
    }

    /// Derivatives of a law's torques with respect to its coefficients, at the samples.
    pub(super) fn gradients_of(&self, law: &FrictionLaw) -> Result<DMatrix<f64>> {
        match self.filtered {
            Some(filtered) => {
                let columns = filtered.columns(|v| law.gradients(v))?;
                Ok(DMatrix::from_fn(self.velocities.len(), columns.len(), |i, k| columns[k][i]))
            }
            None => law.gradients(self.velocities),
        }
    }
}
