//! What limits of inputs have to be, and what motors give at speed, for the loop and the plant alike.

use crate::dynamics::TorqueSpeedLine;

/// A part of the limits that has to lie in a range: its name, its value for each input, the range in words, and
/// whether a value lies in it.
pub(crate) type Requirement<const M: usize> = (&'static str, [f64; M], &'static str, fn(f64) -> bool);

/// Lowest and highest inputs enclose 0, and there is something between them.
pub(crate) fn requirements<const M: usize>(limits: &[[f64; 2]; M]) -> [Requirement<M>; 3] {
    [
        ("input_limits (lowest)", limits.map(|[low, _]| low), "not positive", |x| x <= 0.0),
        ("input_limits (highest)", limits.map(|[_, high]| high), "not negative", |x| x >= 0.0),
        ("input_limits (highest minus lowest)", limits.map(|[low, high]| high - low), "positive", |x| {
            x > 0.0
        }),
    ]
}

/// Part of a limit that is rounding: a controller that keeps a line computes it otherwise.
const ROUNDING: f64 = 1e-9;

/// Cuts inputs off at the torque–speed lines of their motors; returns how many were. Inputs must be finite; speeds that are no
/// numbers cut nothing off.
pub(crate) fn limit_torques<const N: usize, const M: usize>(
    inputs: &mut [f64; M],
    lines: &[TorqueSpeedLine<N>],
    velocities: &[f64; N],
) -> u64 {
    let mut limited = 0;
    for line in lines {
        let ([low, high], u) = (line.range(velocities), &mut inputs[line.input]);
        let slack = ROUNDING * line.limit;
        if *u < low - slack || *u > high + slack {
            *u = u.max(low).min(high);
            limited += 1;
        }
    }
    limited
}
