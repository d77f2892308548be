//! Motions made of channels: smoothed positions with their derivatives, segment by segment, and columns per
//! joint.

use super::super::differentiation::{Derivatives, KalmanSmoother, SavitzkyGolay, TotalVariation};
use super::super::error::{IdentificationError, Result, require_samples};
use super::super::torque::Motion;
use super::{Channel, Log, Quantity};

/// A method that smooths and differentiates.
#[derive(Debug, Clone, PartialEq)]
pub enum Differentiation {
    /// For motions whose acceleration jumps.
    TotalVariation(TotalVariation),
    /// Local polynomials.
    SavitzkyGolay(SavitzkyGolay),
    /// For smooth motions; the choice where nothing speaks against it.
    KalmanSmoother(KalmanSmoother),
}

impl Differentiation {
    /// Smoothed signal and derivatives.
    ///
    /// # Errors
    /// As the method.
    pub fn differentiate(&self, times: &[f64], signal: &[f64]) -> Result<Derivatives> {
        match self {
            Self::TotalVariation(method) => method.differentiate(times, signal),
            Self::SavitzkyGolay(method) => method.differentiate(times, signal),
            Self::KalmanSmoother(method) => method.differentiate(times, signal),
        }
    }
}

/// Columns of the selected rows, as [`Motion`] borrows them.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionColumns<const N: usize, const M: usize> {
    /// y.
    pub positions: [Vec<f64>; N],
    /// ẏ.
    pub velocities: [Vec<f64>; N],
    /// ÿ.
    pub accelerations: [Vec<f64>; N],
    /// u.
    pub inputs: [Vec<f64>; M],
}

impl<const N: usize, const M: usize> MotionColumns<N, M> {
    /// The columns as slices.
    pub fn motion(&self) -> Motion<'_, N, M> {
        Motion {
            positions: self.positions.each_ref().map(Vec::as_slice),
            velocities: self.velocities.each_ref().map(Vec::as_slice),
            accelerations: self.accelerations.each_ref().map(Vec::as_slice),
            inputs: self.inputs.each_ref().map(Vec::as_slice),
        }
    }
}

impl Log {
    /// Adds the channels `<position>_smooth`, `<position>_velocity` and `<position>_acceleration`, each
    /// segment differentiated by itself; returns the regularization used in each segment
    /// ([`Derivatives::parameter`]).
    ///
    /// # Errors
    /// Unknown channel, no time channel, NaN or times that do not increase (with the log's row), or segments
    /// too short for the method.
    pub fn differentiate(&mut self, position: &str, method: &Differentiation) -> Result<Vec<f64>> {
        let (time, signal) = (self.time()?, self.channel(position)?);
        let mut columns: [Vec<f64>; 3] = Default::default();
        let mut parameters = Vec::with_capacity(self.segments.len());
        for rows in &self.segments {
            let derivatives = method
                .differentiate(&time[rows.clone()], &signal[rows.clone()])
                .map_err(|e| at_log_row(e, rows.start, position))?;
            columns[0].extend(derivatives.value);
            columns[1].extend(derivatives.first);
            columns[2].extend(derivatives.second);
            parameters.push(derivatives.parameter);
        }
        let source = self.channels.iter().find(|c| c.name == position);
        let (joint, unit) = source.map_or((None, String::new()), |c| (c.joint, c.unit.clone()));
        let kinds = [
            ("smooth", Quantity::Position, unit.clone()),
            ("velocity", Quantity::Velocity, format!("{unit}/s")),
            ("acceleration", Quantity::Acceleration, format!("{unit}/s^2")),
        ];
        for ((suffix, quantity, unit), values) in kinds.into_iter().zip(columns) {
            self.add(Channel { name: format!("{position}_{suffix}"), quantity, unit, joint, values })?;
        }
        Ok(parameters)
    }

    /// Those of `rows` that are at least `margin` samples away from both ends of their segment, where
    /// smoothers are at their worst.
    ///
    /// # Errors
    /// [`IdentificationError::TooFewSamples`] if none is left.
    pub fn inner_rows(&self, rows: &[usize], margin: usize) -> Result<Vec<usize>> {
        let inner = |row: &usize| {
            let segment = self.segments.iter().find(|s| s.contains(row));
            segment.is_some_and(|s| *row - s.start >= margin && s.end - *row > margin)
        };
        let kept: Vec<usize> = rows.iter().copied().filter(inner).collect();
        if kept.is_empty() {
            let longest = self.segments.iter().map(ExactSizeIterator::len).max();
            return Err(IdentificationError::TooFewSamples {
                what: format!("a margin of {margin} samples at both ends of a segment"),
                needed: margin.saturating_mul(2).saturating_add(1),
                got: longest.unwrap_or(0),
            });
        }
        Ok(kept)
    }

    /// Values of a channel at `rows`.
    ///
    /// # Errors
    /// Unknown channel, or a row that the log does not have.
    pub fn values(&self, name: &str, rows: &[usize]) -> Result<Vec<f64>> {
        let channel = self.channel(name)?;
        let value = |&row: &usize| channel.get(row).copied();
        let values: Option<Vec<f64>> = rows.iter().map(value).collect();
        values.ok_or_else(|| IdentificationError::Shape {
            what: format!("rows of channel {name}"),
            expected: rows.iter().max().map_or(0, |r| r.saturating_add(1)),
            got: channel.len(),
        })
    }

    /// Differentiated positions and inputs of the joints at `rows`.
    ///
    /// - `positions`, `inputs`: names of channels; positions went through [`Self::differentiate`] before
    ///
    /// # Errors
    /// Unknown channels, no rows, or rows that the log does not have.
    pub fn motion<const N: usize, const M: usize>(
        &self,
        positions: &[&str; N],
        inputs: &[&str; M],
        rows: &[usize],
    ) -> Result<MotionColumns<N, M>> {
        require_samples("a motion", 1, rows.len())?;
        let derived = |suffix: &str| -> Result<[Vec<f64>; N]> {
            let mut columns = [const { Vec::new() }; N];
            for (column, name) in columns.iter_mut().zip(positions) {
                *column = self.values(&format!("{name}_{suffix}"), rows)?;
            }
            Ok(columns)
        };
        let mut drives = [const { Vec::new() }; M];
        for (column, name) in drives.iter_mut().zip(inputs) {
            *column = self.values(name, rows)?;
        }
        Ok(MotionColumns {
            positions: derived("smooth")?,
            velocities: derived("velocity")?,
            accelerations: derived("acceleration")?,
            inputs: drives,
        })
    }
}

/// Rows of a segment's error, counted in the log.
fn at_log_row(error: IdentificationError, start: usize, position: &str) -> IdentificationError {
    match error {
        IdentificationError::NotFinite { what, row, value, count, samples } => {
            IdentificationError::NotFinite {
                what: format!("{what} ({position})"),
                row: row + start,
                value,
                count,
                samples,
            }
        }
        IdentificationError::Time { row, before, after } => {
            IdentificationError::Time { row: row + start, before, after }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::LogSchema;
    use super::*;
    use std::fmt::Write;

    /// Two runs of 200 samples, the second mirrored.
    fn runs(break_at: Option<usize>) -> Log {
        let mut text = String::from("run,t,q1,u1\n");
        for run in 1..=2 {
            for i in 0..200 {
                let t = 0.01 * f64::from(i);
                let q = if run == 1 { t.sin() } else { -t.sin() };
                let q = match break_at {
                    Some(row) if (run - 1) * 200 + i as usize == row => "nan".into(),
                    _ => format!("{q:.6}"),
                };
                writeln!(text, "{run},{t:.2},{q},{run}").unwrap();
            }
        }
        Log::read(text.as_bytes(), "runs", &LogSchema::default()).unwrap().0
    }

    #[test]
    fn each_run_is_differentiated_by_itself() {
        let mut log = runs(None);
        let method = Differentiation::KalmanSmoother(KalmanSmoother::from_noise(1e-6));
        assert_eq!(log.differentiate("q1", &method).unwrap().len(), 2);
        let all = log.select("run > 0").unwrap();
        let rows = log.inner_rows(&all, 20).unwrap();
        assert_eq!((rows.len(), rows[0], rows[160]), (320, 20, 220));
        let columns = log.motion(&["q1"], &["u1"], &rows).unwrap();
        for (i, row) in rows.iter().enumerate() {
            let (t, sign) = (0.01 * (row % 200) as f64, if *row < 200 { 1.0 } else { -1.0 });
            assert!((columns.velocities[0][i] - sign * t.cos()).abs() < 1e-3);
            assert!((columns.accelerations[0][i] + sign * t.sin()).abs() < 2e-2);
        }
        // Derived channels serve selections too.
        assert!(log.select("abs(q1_velocity) < 0.5").unwrap().len() < 400);
        let message = log.differentiate("q1", &method).unwrap_err().to_string();
        assert!(message.contains("this channel exists already"), "{message}");
    }

    #[test]
    fn faults_name_the_row_of_the_log() {
        let method = Differentiation::SavitzkyGolay(SavitzkyGolay::from_noise(1e-6));
        let message = runs(Some(231)).differentiate("q1", &method).unwrap_err().to_string();
        assert!(message.contains("at row 231 (counted from 0)"), "{message}");
        let log = runs(None);
        let message = log.inner_rows(&[5], 150).unwrap_err().to_string();
        assert!(message.contains("needs at least 301 samples, there are 200"), "{message}");
        assert!(log.values("u1", &[400]).unwrap_err().to_string().contains("401 expected, 400 given"));
        assert!(log.motion(&["q1"], &["u1"], &[]).unwrap_err().to_string().contains("empty"));
        let message = log.motion(&["q1"], &["u1"], &[1]).unwrap_err().to_string();
        assert!(message.starts_with("there is no channel `q1_smooth`"), "{message}");
    }
}
