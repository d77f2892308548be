//! Reading of samples from a file, and search for positions that contradict the velocities.

use super::{GeodesicMotion, Sample, Sampled, TrajectoryError, require_finite, require_positive};
use crate::dynamics::Dynamics;
use std::io::Read;
use std::path::Path;

/// Largest allowed error of a time in a file, relative to the period.
const TIME_TOLERANCE: f64 = 1e-3;

/// Names of the columns of a file with the time, and with position and velocity of each coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Columns<'c, const N: usize> {
    /// Name of the column of the times (s).
    pub time: &'c str,
    /// Names of the columns of the positions [rad or m].
    pub positions: [&'c str; N],
    /// Names of the columns of the velocities [rad/s or m/s]; `None` if the file has no velocities.
    pub velocities: Option<[&'c str; N]>,
}

/// Recorded or computed positions at the times 0, T, 2T, … with the period T, and velocities if they are known. Positions
/// and velocities can be inconsistent.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording<const N: usize> {
    period: f64,
    positions: Vec<[f64; N]>,
    velocities: Option<Vec<[f64; N]>>,
}

/// A step between two samples in which the change of a position contradicts the velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inconsistency {
    /// Index of the sample before the step.
    pub sample: usize,
    /// Time of the sample before the step (s).
    pub time: f64,
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Change of position minus the integral of the velocities [rad or m].
    pub defect: f64,
}

impl<const N: usize> Recording<N> {
    /// A recording of samples with this `period` (s).
    ///
    /// # Errors
    /// - [`TrajectoryError::TooFew`] for fewer than three samples, or if the numbers of velocities and positions differ.
    /// - [`TrajectoryError::NotFinite`] for an entry that is not finite.
    /// - [`TrajectoryError::NotPositive`] for a period that is not positive.
    pub fn new(
        period: f64,
        positions: Vec<[f64; N]>,
        velocities: Option<Vec<[f64; N]>>,
    ) -> Result<Self, TrajectoryError> {
        require_positive("period", period)?;
        let too_few = |what, needed, given| Err(TrajectoryError::TooFew { what, needed, given });
        if positions.len() < 3 {
            return too_few("samples", 3, positions.len());
        }
        for (k, row) in positions.iter().enumerate() {
            require_finite(&format!("positions of sample {k}"), row)?;
        }
        if let Some(velocities) = &velocities {
            if velocities.len() != positions.len() {
                return too_few("velocities", positions.len(), velocities.len());
            }
            for (k, row) in velocities.iter().enumerate() {
                require_finite(&format!("velocities of sample {k}"), row)?;
            }
        }
        Ok(Self { period, positions, velocities })
    }

    /// Reads a CSV file with a header. Times must be evenly spaced. The first time counts as 0.
    ///
    /// # Errors
    /// [`TrajectoryError::File`] if the file cannot be read, a column is missing, a value is not a number, or
    /// the times are uneven. The other errors are those of [`Recording::new`].
    pub fn open(path: impl AsRef<Path>, columns: &Columns<N>) -> Result<Self, TrajectoryError> {
        let path = path.as_ref();
        let file = std::fs::File::open(path).map_err(|e| TrajectoryError::File {
            place: path.display().to_string(),
            message: e.to_string(),
        })?;
        Self::read(file, &path.display().to_string(), columns)
    }

    /// Reads a recording from any reader like [`Recording::open`]. `place` is the name of the source in errors.
    ///
    /// # Errors
    /// The errors of [`Recording::open`].
    pub fn read(reader: impl Read, place: &str, columns: &Columns<N>) -> Result<Self, TrajectoryError> {
        let fault = |row: usize, message: String| TrajectoryError::File {
            place: if row == 0 { place.to_owned() } else { format!("{place}, row {row}") },
            message,
        };
        let mut csv = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(reader);
        let head = csv.headers().map_err(|e| fault(0, e.to_string()))?.clone();
        let find = |name: &str| {
            let found = head.iter().position(|h| h == name);
            found.ok_or_else(|| {
                let names: Vec<&str> = head.iter().collect();
                fault(0, format!("column {name} is missing. The file has the columns {}", names.join(", ")))
            })
        };
        let time = find(columns.time)?;
        let positions = find_all(&columns.positions, &find)?;
        let velocities = match &columns.velocities {
            Some(names) => Some(find_all(names, &find)?),
            None => None,
        };
        let (mut times, mut y, mut v) = (Vec::new(), Vec::new(), Vec::new());
        for (k, record) in csv.records().enumerate() {
            let record = record.map_err(|e| fault(k + 1, e.to_string()))?;
            let number = |column: usize| {
                let text = record.get(column).unwrap_or_default();
                text.parse::<f64>().map_err(|_| {
                    fault(k + 1, format!("{text:?} in column {} is not a number", &head[column]))
                })
            };
            let row = |columns: &[usize; N]| -> Result<[f64; N], TrajectoryError> {
                let mut values = [0.0; N];
                for (value, column) in values.iter_mut().zip(columns) {
                    *value = number(*column)?;
                }
                Ok(values)
            };
            times.push(number(time)?);
            y.push(row(&positions)?);
            if let Some(columns) = &velocities {
                v.push(row(columns)?);
            }
        }
        if times.len() < 3 {
            return Self::new(1.0, y, None);
        }
        let period = even_period(&times, &fault)?;
        Self::new(period, y, velocities.is_some().then_some(v))
    }

    /// Time between two samples (s).
    #[must_use]
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Recorded positions [rad or m].
    #[must_use]
    pub fn positions(&self) -> &[[f64; N]] {
        &self.positions
    }

    /// Recorded velocities [rad/s or m/s]; `None` if the recording has no velocities.
    #[must_use]
    pub fn velocities(&self) -> Option<&[[f64; N]]> {
        self.velocities.as_deref()
    }

    /// Returns the steps between samples in which positions contradict velocities. The magnitude of the defect
    ///
    /// ```text
    ///     d_k = y_{k+1} − y_k − T/2 (v_k + v_{k+1})
    /// ```
    ///
    /// of these steps exceeds `tolerance` [rad or m], with the positions y, the velocities v and the period T. The defects
    /// of a smooth motion are about T³/12 times its jerk. The result is empty for a recording without velocities.
    #[must_use]
    pub fn inconsistencies(&self, tolerance: f64) -> Vec<Inconsistency> {
        let Some(v) = &self.velocities else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for k in 0..self.positions.len() - 1 {
            for i in 0..N {
                let step = self.positions[k + 1][i] - self.positions[k][i];
                let defect = step - 0.5 * self.period * (v[k][i] + v[k + 1][i]);
                // If the tolerance is NaN, every step counts as inconsistent.
                let consistent = defect.abs() <= tolerance;
                if !consistent {
                    found.push(Inconsistency {
                        sample: k,
                        time: k as f64 * self.period,
                        coordinate: i,
                        defect,
                    });
                }
            }
        }
        found
    }

    /// The motion through the samples without smoothing. If the recording has no velocities, central differences replace
    /// them. Accelerations are central differences, one-sided at the ends. Inconsistencies between positions and
    /// velocities remain. [`Recording::smoothed`] removes them.
    ///
    /// # Errors
    /// The errors of [`Sampled::new`], for example if a difference overflows.
    pub fn raw(&self) -> Result<Sampled<N>, TrajectoryError> {
        let velocities = match &self.velocities {
            Some(v) => v.clone(),
            None => differences(&self.positions, self.period),
        };
        let accelerations = differences(&velocities, self.period);
        let samples = (0..self.positions.len())
            .map(|k| Sample {
                positions: self.positions[k],
                velocities: velocities[k],
                accelerations: accelerations[k],
            })
            .collect();
        Sampled::new(samples, self.period)
    }

    /// Motion of a robot with quaternions through all recorded positions. The recording has one column for each of the `N`
    /// position entries of the robot, in the order of the entries. A quaternion is x, y, z, w. The motion begins and ends
    /// at rest. Velocities follow from neighbouring positions, see [`GeodesicMotion::through`]. Recorded velocities are not
    /// used. Accelerations are 0 at the samples; use [`Self::smoothed_poses`] for a motion with the accelerations of the
    /// recording.
    ///
    /// # Errors
    /// [`TrajectoryError::Attitude`] for a quaternion that is zero or not of unit length, with the index of the sample. The
    /// other errors are those of [`GeodesicMotion::through`].
    pub fn through_poses<D: Dynamics<V, M, N>, const V: usize, const M: usize>(
        &self,
        robot: D,
    ) -> Result<GeodesicMotion<D, V, M, N>, TrajectoryError> {
        let times = (0..).map(|k| f64::from(k) * self.period);
        let points: Vec<(f64, [f64; N])> = times.zip(self.positions.iter().copied()).collect();
        GeodesicMotion::through(robot, &points)
    }
}

/// Spacing of `times` (s), which must be even.
fn even_period(
    times: &[f64],
    fault: &impl Fn(usize, String) -> TrajectoryError,
) -> Result<f64, TrajectoryError> {
    let last = times.len() - 1;
    let period = (times[last] - times[0]) / last as f64;
    require_positive("period", period)?;
    let expected = |k: usize| times[0] + k as f64 * period;
    // This form counts NaN as uneven.
    let is_even = |k: &usize| (times[*k] - expected(*k)).abs() <= TIME_TOLERANCE * period;
    match (0..=last).find(|k| !is_even(k)) {
        None => Ok(period),
        Some(k) => {
            let (time, due) = (times[k], expected(k));
            let message = format!(
                "the time is {time} s, but an even spacing of {period} s requires {due} s. Resample the file"
            );
            Err(fault(k + 1, message))
        }
    }
}

fn find_all<const N: usize>(
    names: &[&str; N],
    find: &impl Fn(&str) -> Result<usize, TrajectoryError>,
) -> Result<[usize; N], TrajectoryError> {
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        *column = find(name)?;
    }
    Ok(columns)
}

fn differences<const N: usize>(x: &[[f64; N]], period: f64) -> Vec<[f64; N]> {
    let last = x.len() - 1;
    (0..=last)
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            core::array::from_fn(|i| (x[b][i] - x[a][i]) / ((b - a) as f64 * period))
        })
        .collect()
}
