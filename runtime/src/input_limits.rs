//! What limits of inputs have to be, for the loop and the plant alike.

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
