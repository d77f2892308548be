//! What a library and a law give at the samples, through the filter of the torques where there is one.

use super::super::error::Result;
use super::super::methods::library::Library;
use super::super::result::FrictionLaw;
use super::task::FrictionData;
use nalgebra::DMatrix;

impl FrictionData<'_> {
    /// The terms of a library at the samples.
    pub(super) fn columns(&self, library: &Library) -> Result<Vec<Vec<f64>>> {
        match self.filtered {
            Some(filtered) => filtered.columns(|v| library.matrix(&[v])),
            None => {
                let matrix = library.matrix(&[self.velocities])?;
                Ok(matrix.column_iter().map(|column| column.iter().copied().collect()).collect())
            }
        }
    }

    /// The torques of a law at the samples.
    pub(super) fn torques_of(&self, law: &FrictionLaw) -> Result<Vec<f64>> {
        match (self.filtered, law) {
            (Some(filtered), FrictionLaw::Terms(_)) => {
                let torques = |v: &[f64]| Ok(DMatrix::from_column_slice(v.len(), 1, &law.torques(v)?));
                Ok(filtered.columns(torques)?.pop().unwrap_or_default())
            }
            (None, _) | (_, FrictionLaw::Stribeck(_)) => law.torques(self.velocities),
        }
    }

    /// Derivatives of a law's torques by its coefficients at the samples.
    pub(super) fn gradients_of(&self, law: &FrictionLaw) -> Result<DMatrix<f64>> {
        match (self.filtered, law) {
            (Some(filtered), FrictionLaw::Terms(_)) => {
                let columns = filtered.columns(|v| law.gradients(v))?;
                Ok(DMatrix::from_fn(self.velocities.len(), columns.len(), |i, k| columns[k][i]))
            }
            (None, _) | (_, FrictionLaw::Stribeck(_)) => law.gradients(self.velocities),
        }
    }
}
