//! Checks of input limits and torque–speed lines, for the control loop and the plant.

use crate::dynamics::TorqueSpeedLine;

/// A requirement on input limits. It consists of a name, a value for each input, the allowed range as text, and
/// the test of a value.
pub(crate) type Requirement<const M: usize> = (&'static str, [f64; M], &'static str, fn(f64) -> bool);

/// Requirements that 0 is between lowest and highest value of each input, and that the two values differ.
pub(crate) fn requirements<const M: usize>(limits: &[[f64; 2]; M]) -> [Requirement<M>; 3] {
    [
        ("input_limits (lowest)", limits.map(|[low, _]| low), "not positive", |x| x <= 0.0),
        ("input_limits (highest)", limits.map(|[_, high]| high), "not negative", |x| x >= 0.0),
        ("input_limits (highest minus lowest)", limits.map(|[low, high]| high - low), "positive", |x| {
            x > 0.0
        }),
    ]
}

/// Tolerance for rounding, relative to the limit. A controller that keeps a torque–speed line computes the line in
/// another way, so its inputs can exceed the line by rounding errors.
const ROUNDING: f64 = 1e-9;

/// Clamps inputs to the torque–speed lines of their motors and to the limits of the inputs. Returns the number of
/// changed inputs. Above its no-load speed, a motor brakes with at most its input limit. Inputs must be finite.
/// For NaN velocities, inputs do not change.
pub(crate) fn limit_torques<const N: usize, const M: usize>(
    inputs: &mut [f64; M],
    lines: &[TorqueSpeedLine<N>],
    limits: &[[f64; 2]; M],
    velocities: &[f64; N],
) -> u64 {
    let mut limited = 0;
    for line in lines {
        let ([low, high], u) = (line.range(velocities), &mut inputs[line.input]);
        let slack = ROUNDING * line.limit;
        if *u < low - slack || *u > high + slack {
            let [lowest, highest] = limits[line.input];
            *u = u.max(low).min(high).max(lowest).min(highest);
            limited += 1;
        }
    }
    limited
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_faster_than_without_load_brakes_by_no_more_than_its_input_may() {
        let lines = [TorqueSpeedLine { name: "motor", input: 0, slopes: [0.1], limit: 1.0 }];
        let cut = |u: f64, speed: f64, limits: [f64; 2]| {
            let mut inputs = [u];
            let limited = limit_torques(&mut inputs, &lines, &[limits], &[speed]);
            (inputs[0], limited)
        };
        assert_eq!(cut(0.8, 5.0, [-1.0, 1.0]), (0.5, 1));
        assert_eq!(cut(0.4, 5.0, [-1.0, 1.0]), (0.4, 0));
        // At twice the no-load speed, the line allows inputs from −3 to −1.
        assert_eq!(cut(0.8, 20.0, [-2.0, 2.0]), (-1.0, 1));
        assert_eq!(cut(0.8, 20.0, [-0.5, 0.5]), (-0.5, 1));
        assert_eq!(cut(0.8, f64::INFINITY, [-0.5, 0.5]), (-0.5, 1));
        assert_eq!(cut(0.8, f64::NAN, [-0.5, 0.5]), (0.8, 0));
    }
}
