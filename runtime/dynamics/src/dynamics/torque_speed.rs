//! Torque–speed lines of motors, `|u + c ẏ| ≤ limit`.

/// Torque–speed line `|u + c ẏ| ≤ limit` of a motor with the input u. The available torque decreases with the speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSpeedLine<const N: usize> {
    /// Name of the input.
    pub name: &'static str,
    /// Index of the input.
    pub input: usize,
    /// Slopes c: loss of torque per velocity of each coordinate, in the unit of the input per rad/s or m/s.
    pub slopes: [f64; N],
    /// Largest input at rest, in the unit of the input.
    pub limit: f64,
}

impl<const N: usize> TorqueSpeedLine<N> {
    /// The sum `u + c ẏ` with the input u, the slopes c and the velocities ẏ. It must be within ±[`Self::limit`].
    #[must_use]
    pub fn value(&self, input: f64, velocities: &[f64; N]) -> f64 {
        input + self.slopes.iter().zip(velocities).map(|(slope, v)| slope * v).sum::<f64>()
    }

    /// Lowest and highest input at these velocities. Above the no-load speed both values have the same sign, so the motor can only
    /// brake.
    #[must_use]
    pub fn range(&self, velocities: &[f64; N]) -> [f64; 2] {
        let taken = self.value(0.0, velocities);
        [-self.limit - taken, self.limit - taken]
    }
}

/// Returns the number of torque–speed lines in `TORQUE_SPEED_LIMITS` of a module. Inputs without a line have an infinite limit.
pub const fn count_lines(limits: &[f64]) -> usize {
    let (mut i, mut lines) = (0, 0);
    while i < limits.len() {
        if limits[i] != f64::INFINITY {
            lines += 1;
        }
        i += 1;
    }
    lines
}

/// Converts the constants of a module to its K torque–speed lines.
///
/// - `slopes`: one row for each input, stored one after the other
pub const fn torque_speed_lines<const N: usize, const K: usize>(
    names: &[&'static str],
    slopes: &[f64],
    limits: &[f64],
) -> [TorqueSpeedLine<N>; K] {
    let mut lines = [TorqueSpeedLine { name: "", input: 0, slopes: [0.0; N], limit: f64::INFINITY }; K];
    let (mut input, mut k) = (0, 0);
    while input < limits.len() {
        if limits[input] != f64::INFINITY {
            let line = &mut lines[k];
            (line.name, line.input, line.limit) = (names[input], input, limits[input]);
            let mut i = 0;
            while i < N {
                line.slopes[i] = slopes[input * N + i];
                i += 1;
            }
            k += 1;
        }
        input += 1;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: [f64; 3] = [2.0, f64::INFINITY, 1.0];
    const LINES: [TorqueSpeedLine<2>; count_lines(&LIMITS)] =
        torque_speed_lines(&["left", "lift", "right"], &[1.0, 1.0, 0.0, 0.0, 1.0, -1.0], &LIMITS);

    #[test]
    fn inputs_without_a_limit_have_no_line() {
        assert_eq!(LINES.map(|line| (line.name, line.input)), [("left", 0), ("right", 2)]);
        assert_eq!(LINES.map(|line| line.slopes), [[1.0, 1.0], [1.0, -1.0]]);
    }

    #[test]
    fn torque_is_short_where_the_motor_drives() {
        let [left, right] = LINES;
        assert_eq!(left.range(&[0.0; 2]), [-2.0, 2.0]);
        assert_eq!(left.range(&[0.5, 0.25]), [-2.75, 1.25]);
        assert_eq!(right.range(&[0.5, 2.0]), [0.5, 2.5], "it turns backwards, faster than without load");
        assert_eq!(left.value(1.25, &[0.5, 0.25]), 2.0);
    }
}
