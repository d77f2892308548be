//! Polynomials through points: cubic splines that begin and end at rest, and monotonic polynomials.

use super::TrajectoryError;
use super::polynomial::{End, Quintic};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Polynomials of all joints over one span, which is the time between two knots.
pub(super) type Piece<const N: usize> = [Quintic; N];

/// Durations of the polynomials, from the durations `ways` of the segments between points. The first and the
/// last segment have an additional knot in their middle. A single segment has two additional knots.
pub(super) fn spans(ways: &[f64]) -> Vec<f64> {
    if let [way] = ways {
        return vec![way / 3.0; 3];
    }
    let last = ways.len() - 1;
    let mut spans = Vec::with_capacity(ways.len() + 2);
    for (k, way) in ways.iter().enumerate() {
        if k == 0 || k == last {
            spans.extend([0.5 * way; 2]);
        } else {
            spans.push(*way);
        }
    }
    spans
}

/// Index of the segment to which a polynomial belongs.
pub(super) fn way_of(span: usize, ways: usize) -> usize {
    span.saturating_sub(1).min(ways - 1)
}

/// Polynomials of all joints through `points`, with the durations `ways` of the segments and `spans` of the polynomials. The
/// polynomials of a joint are a cubic spline. If the spline leaves the limits of the joint, or the joint is in
/// `is_monotone`, they are monotonic polynomials of degree five.
///
/// # Errors
/// [`TrajectoryError::OutOfRange`] if the durations and distances lead to an overflow.
pub(super) fn through<const N: usize>(
    points: &[[f64; N]],
    ways: &[f64],
    spans: &[f64],
    limits: &[[f64; 2]; N],
    is_monotone: &[bool; N],
) -> Result<Vec<Piece<N>>, TrajectoryError> {
    let mut pieces = vec![[Quintic::default(); N]; spans.len()];
    for i in 0..N {
        let values: Vec<f64> = points.iter().map(|point| point[i]).collect();
        let spline = if is_monotone[i] { None } else { cubic(&values, spans) };
        let spline = spline.filter(|spline| keeps_within(spline, spans, limits[i]));
        let joint = match spline {
            Some(spline) => spline,
            None => monotone(&values, ways, spans),
        };
        for (piece, polynomial) in pieces.iter_mut().zip(joint) {
            piece[i] = polynomial;
        }
    }
    let finite = |(piece, span): (&Piece<N>, &f64)| {
        let bounds = piece.iter().flat_map(|p| p.bounds(*span));
        bounds.into_iter().all(f64::is_finite)
    };
    if pieces.iter().zip(spans).all(finite) {
        Ok(pieces)
    } else {
        Err(TrajectoryError::OutOfRange {
            what: "the duration of a segment",
            value: ways.iter().copied().fold(f64::INFINITY, f64::min),
            range: "a duration for which speeds and accelerations are finite",
        })
    }
}

fn keeps_within(spline: &[Quintic], spans: &[f64], [low, high]: [f64; 2]) -> bool {
    let unlimited = low == f64::NEG_INFINITY && high == f64::INFINITY;
    unlimited
        || spline.iter().zip(spans).all(|(piece, span)| {
            let [[least, most], ..] = piece.extremes(*span);
            // A rounding error at a point on the limit is not an overshoot.
            let slack = 1e-12 * (1.0 + least.abs().max(most.abs()));
            least >= low - slack && most <= high + slack
        })
}

/// The cubic spline through `values` that begins and ends with zero velocity and acceleration; `None` on overflow. With the
/// second derivatives M_j at the knots and the durations g_j of the polynomials, the first derivative is continuous if
///
/// ```text
///     g_{j−1} M_{j−1}/6 + (g_{j−1} + g_j) M_j/3 + g_j M_{j+1}/6 = (y_{j+1} − y_j)/g_j − (y_j − y_{j−1})/g_{j−1}
/// ```
///
/// The positions of the two knots that are not points follow from the condition of rest at the ends: y_1 = y_0 + g_0²
/// M_1/6, and correspondingly at the end.
fn cubic(values: &[f64], spans: &[f64]) -> Option<Vec<Quintic>> {
    let knots = spans.len();
    // The positions of the knots are y_j = base_j + factor_j M_j.
    let mut base = vec![0.0; knots + 1];
    base[0] = values[0];
    base[1] = values[0];
    base[knots - 1] = values[values.len() - 1];
    base[knots] = values[values.len() - 1];
    for (j, value) in values.iter().enumerate().skip(1).take(values.len() - 2) {
        base[j + 1] = *value;
    }
    let factor = |j: usize| {
        if j == 1 {
            spans[0] * spans[0] / 6.0
        } else if j + 1 == knots {
            spans[knots - 1] * spans[knots - 1] / 6.0
        } else {
            0.0
        }
    };
    let mut system = Tridiagonal::default();
    for j in 1..knots {
        let (before, after) = (spans[j - 1], spans[j]);
        system.push(
            before / 6.0 - factor(j - 1) / before,
            (before + after) / 3.0 + factor(j) * (1.0 / before + 1.0 / after),
            after / 6.0 - factor(j + 1) / after,
            (base[j + 1] - base[j]) / after - (base[j] - base[j - 1]) / before,
        );
    }
    let inner = system.solve()?;
    let curvature = |j: usize| {
        if j == 0 || j == knots { 0.0 } else { inner[j - 1] }
    };
    let position = |j: usize| base[j] + factor(j) * curvature(j);
    Some(
        (0..knots)
            .map(|j| {
                let (y, m, g) = ([position(j), position(j + 1)], [curvature(j), curvature(j + 1)], spans[j]);
                let slope = (y[1] - y[0]) / g - g * (2.0 * m[0] + m[1]) / 6.0;
                Quintic::cubic([y[0], slope, 0.5 * m[0], (m[1] - m[0]) / (6.0 * g)])
            })
            .collect(),
    )
}

/// A system of equations with a tridiagonal matrix.
#[derive(Default)]
struct Tridiagonal {
    /// Entries below, on and above the diagonal, and the right-hand side of each row.
    rows: Vec<[f64; 4]>,
}

impl Tridiagonal {
    fn push(&mut self, below: f64, diagonal: f64, above: f64, right: f64) {
        self.rows.push([below, diagonal, above, right]);
    }

    /// Solves by elimination without pivoting, because the matrix of the spline is diagonally dominant. Returns `None` on
    /// overflow.
    fn solve(mut self) -> Option<Vec<f64>> {
        let n = self.rows.len();
        for j in 1..n {
            let [_, pivot, above, right] = self.rows[j - 1];
            let factor = self.rows[j][0] / pivot;
            self.rows[j][1] -= factor * above;
            self.rows[j][3] -= factor * right;
        }
        let mut x = vec![0.0; n];
        for j in (0..n).rev() {
            let [_, pivot, above, right] = self.rows[j];
            let next = x.get(j + 1).copied().unwrap_or(0.0);
            x[j] = (right - above * next) / pivot;
        }
        x.iter().all(|x| x.is_finite()).then_some(x)
    }
}

/// Largest ratio of the velocity at a point to the slope of a neighbouring segment.
const STEEPEST: f64 = 1.25;

/// Polynomials of degree five that are monotonic between two values and have zero acceleration there.
fn monotone(values: &[f64], ways: &[f64], spans: &[f64]) -> Vec<Quintic> {
    let slopes: Vec<f64> = values.windows(2).zip(ways).map(|(w, way)| (w[1] - w[0]) / way).collect();
    let velocity = |k: usize| {
        if k == 0 || k == ways.len() {
            0.0
        } else {
            velocity_between([slopes[k - 1], slopes[k]], [ways[k - 1], ways[k]])
        }
    };
    let mut pieces = Vec::with_capacity(spans.len());
    let mut spans = spans.iter();
    for (k, way) in ways.iter().enumerate() {
        let whole = Quintic::new([values[k], velocity(k), 0.0], [values[k + 1], velocity(k + 1), 0.0], *way);
        let parts = parts_of(k, ways.len());
        let mut begin: End = whole.at(0.0);
        for part in 1..=parts {
            let end = whole.at(way * part as f64 / parts as f64);
            // The number of spans equals the total number of parts of the segments.
            let span = spans.next().copied().unwrap_or(*way);
            pieces.push(Quintic::new(begin, end, span));
            begin = end;
        }
    }
    pieces
}

/// Number of polynomials of segment `k`, according to [`spans`].
fn parts_of(k: usize, ways: usize) -> usize {
    match (ways, k) {
        (1, _) => 3,
        (_, 0) => 2,
        _ if k + 1 == ways => 2,
        _ => 1,
    }
}

/// Velocity at a point between two segments with these slopes and durations.
fn velocity_between(slopes: [f64; 2], ways: [f64; 2]) -> f64 {
    let [a, b] = slopes;
    if a * b <= 0.0 {
        return 0.0;
    }
    let [g, h] = ways;
    let mean = 3.0 * (g + h) / ((2.0 * h + g) / a + (h + 2.0 * g) / b);
    let steepest = STEEPEST * a.abs().min(b.abs());
    mean.clamp(-steepest, steepest)
}
