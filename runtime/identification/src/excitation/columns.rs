//! Columns of the regressor that a planned motion has to excite.

use super::super::numeric::random::SplitMix64;
use super::super::robot::Robot;
use super::chart::Chart;
use super::{ExcitationLimits, Instant};
use nalgebra::DMatrix;

/// Number of random states at which dependent columns of the regressor are detected.
const STATES: usize = 60;

/// Random positions, velocities and accelerations within the limits.
pub(super) fn random_states(limits: &[ExcitationLimits], chart: &Chart) -> Vec<Instant> {
    let mut random = SplitMix64::new(1);
    let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
    let mut state = || {
        let y = limits.iter().map(|l| between(l.position[0], l.position[1])).collect();
        let v = limits.iter().map(|l| between(-l.velocity, l.velocity)).collect();
        let a = limits.iter().map(|l| between(-l.acceleration, l.acceleration)).collect();
        chart.instant(&[y, v, a])
    };
    (0..STATES).map(|_| state()).collect()
}

/// Indices of columns of the regressor W that are linearly independent at random states (Gautier 1991).
///
/// - `columns`: number of columns that are considered, from the first column on
pub(super) fn independent_columns(robot: &dyn Robot, columns: usize, states: &[Instant]) -> Vec<usize> {
    let (n, all) = (robot.joint_names().len(), robot.parameter_names().len());
    let mut stacked = DMatrix::zeros(n * states.len(), columns);
    let mut regressor = vec![0.0; n * all];
    for (i, [y, v, a]) in states.iter().enumerate() {
        robot.inertial_regressor(y, v, a, &mut regressor);
        for (joint, row) in regressor.chunks_exact(all.max(1)).enumerate() {
            row.iter().take(columns).enumerate().for_each(|(k, value)| stacked[(i * n + joint, k)] = *value);
        }
    }
    let largest = stacked.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let (mut kept, mut basis): (Vec<usize>, Vec<nalgebra::DVector<f64>>) = (Vec::new(), Vec::new());
    for (k, column) in stacked.column_iter().enumerate() {
        let mut rest = column.clone_owned();
        // Twice is enough (Parlett 1980, section 6-9).
        for _ in 0..2 {
            basis.iter().for_each(|q| rest.axpy(-q.dot(&rest), q, 1.0));
        }
        if rest.norm() > 1e-8 * largest {
            basis.push(rest.normalize());
            kept.push(k);
        }
    }
    kept
}
