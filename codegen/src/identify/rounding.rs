//! Rounding of identified bodies to significant digits.
//!
//! A value has two digits of half the width of its confidence interval. Rounding must not change two
//! properties: a physically possible body stays possible, and the written bodies explain the data as well
//! as the identified ones. If rounding changes one of these properties, the body gets more digits. If a
//! value equals the described value when rounded to these digits, the described value is written.

use gelenk_findings::digits::rounded;
use gelenk_identification::estimation::Estimate;
use gelenk_identification::inertial::margin;
use gelenk_identification::payload::Payload;
use nalgebra::{DMatrix, DVector};

use super::bodies::{BodyValues, LinkBodies};
use crate::dynamics::parameters::regressor::PER_LINK;

/// Largest change of a joint's coefficient of determination R² by rounding the parameters of its body.
const MOST_LOST: f64 = 1e-4;
/// Number of additional digits from which on a body is written without rounding.
const MOST_DIGITS: i32 = 8;
/// Largest change of a load's parameter by rounding, as a fraction of half the width of its confidence
/// interval.
const NOTICED: f64 = 0.1;

/// Rounds the identified bodies of all links to the digits that their intervals justify.
///
/// - `described`: the same bodies with the described parameters
pub fn round_bodies(links: &mut [LinkBodies], described: &[LinkBodies], estimate: &Estimate) {
    let found: Vec<Found> = links
        .iter()
        .zip(described)
        .enumerate()
        .map(|(place, (link, described))| Found::new(place, link, described, estimate))
        .collect();
    let mut digits: Vec<i32> = found.iter().map(|link| link.possible_from(0)).collect();
    loop {
        let changes = || found.iter().zip(&digits).map(|(link, digits)| link.change(*digits));
        let together: Vec<f64> = changes().flatten().collect();
        if lost(estimate, 0, &together) <= MOST_LOST {
            break;
        }
        let alone = changes().enumerate().map(|(place, change)| lost(estimate, place, &change));
        let worst = alone.enumerate().filter(|(place, _)| digits[*place] < MOST_DIGITS);
        let Some((worst, _)) = worst.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        digits[worst] = found[worst].possible_from(digits[worst] + 1);
    }
    let written: Vec<BodyValues> =
        found.iter().zip(digits).map(|(found, digits)| found.written(digits)).collect();
    links.iter_mut().zip(written).for_each(|(link, body)| link.body = body);
}

/// Returns the largest change of a joint's coefficient of determination R² if the parameters of a link
/// change.
fn lost(estimate: &Estimate, link: usize, change: &[f64]) -> f64 {
    let mut all = vec![0.0; estimate.parameters.len()];
    all[PER_LINK * link..][..change.len()].copy_from_slice(change);
    estimate.r_squared_lost(&all).into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// An identified body with the errors of its values. The values are in the order of [`BodyValues::numbers`].
struct Found<'a> {
    body: &'a BodyValues,
    /// Inertial parameters of the link that come from rotors of held joints, not from bodies.
    fixed: &'a [f64],
    /// Mass, centre of mass and moments of inertia of the described body.
    described: [Option<f64>; PER_LINK],
    /// Half the width of each value's confidence interval; `None` if it is unknown.
    errors: [Option<f64>; PER_LINK],
}

impl<'a> Found<'a> {
    fn new(place: usize, link: &'a LinkBodies, described: &LinkBodies, estimate: &Estimate) -> Self {
        let rows = PER_LINK * place;
        let covariance = estimate.parameter_covariance.view((rows, rows), (PER_LINK, PER_LINK));
        let slopes = slopes(&link.body);
        let uncertain = estimate.parameters.iter().filter(|p| p.standard_error > 0.0);
        let factors = uncertain.map(|p| 0.5 * (p.interval[1] - p.interval[0]) / p.standard_error);
        // Half the width of an interval in standard errors.
        let factor = factors.fold(1.0, f64::max);
        let error = |k: usize| {
            let slope: DVector<f64> = slopes.row(k).transpose();
            let error = factor * slope.dot(&(covariance * &slope)).max(0.0).sqrt();
            Some(error).filter(|error| *error > 0.0 && error.is_finite())
        };
        Self {
            body: &link.body,
            fixed: &link.fixed,
            described: described.body.numbers().map(Some),
            errors: std::array::from_fn(error),
        }
    }

    /// Returns the body with `digits` digits more than the confidence intervals justify.
    fn written(&self, digits: i32) -> BodyValues {
        if digits >= MOST_DIGITS {
            return self.body.clone();
        }
        let numbers = self.body.numbers();
        let number = |k: usize| {
            let Some(error) = self.errors[k] else { return numbers[k] };
            let error = (0..digits).fold(error, |error, _| 0.1 * error);
            let digits = |number: f64| rounded(number, Some(error));
            let text = digits(numbers[k]);
            let described = self.described[k].filter(|described| digits(*described) == text);
            described.unwrap_or_else(|| text.parse().unwrap_or(numbers[k]))
        };
        BodyValues {
            mass: number(0),
            center_of_mass: std::array::from_fn(|k| number(1 + k)),
            inertia: std::array::from_fn(|k| number(4 + k)),
            ..self.body.clone()
        }
    }

    /// Returns the change of the link's parameters if the body is rounded to `digits`.
    fn change(&self, digits: i32) -> Vec<f64> {
        let [before, after] = [self.body.parameters(), self.written(digits).parameters()];
        after.iter().zip(before).map(|(after, before)| after - before).collect()
    }

    /// Returns the smallest number of digits, beginning with `digits`, for which rounding keeps a possible
    /// body and its link possible.
    fn possible_from(&self, digits: i32) -> i32 {
        let is_kept = |digits: &i32| {
            let [before, after] = [self.body.parameters(), self.written(*digits).parameters()];
            let with_fixed = |own: [f64; PER_LINK]| std::array::from_fn(|k| own[k] + self.fixed[k]);
            keeps_existing(&before, &after) && keeps_existing(&with_fixed(before), &with_fixed(after))
        };
        (digits..MOST_DIGITS).find(is_kept).unwrap_or(MOST_DIGITS)
    }
}

fn keeps_existing(before: &[f64; PER_LINK], after: &[f64; PER_LINK]) -> bool {
    margin(before) <= 0.0 || margin(after) > 0.0
}

/// Returns the derivatives of a body's numbers with respect to the ten parameters of its link.
fn slopes(body: &BodyValues) -> DMatrix<f64> {
    let mut slopes = DMatrix::zeros(PER_LINK, PER_LINK);
    let [x, y, z] = body.center_of_mass;
    slopes[(0, 0)] = 1.0;
    if body.mass > 0.0 {
        for (axis, place) in body.center_of_mass.into_iter().enumerate() {
            slopes[(1 + axis, 0)] = -place / body.mass;
            slopes[(1 + axis, 1 + axis)] = 1.0 / body.mass;
        }
    }
    // Rows for xx, yy, zz, xy, xz, yz about the centre: the index of the parameter, and the effects of mass
    // and m c.
    let moments = [
        (4, [y * y + z * z, 0.0, -2.0 * y, -2.0 * z]),
        (6, [x * x + z * z, -2.0 * x, 0.0, -2.0 * z]),
        (9, [x * x + y * y, -2.0 * x, -2.0 * y, 0.0]),
        (5, [-x * y, y, x, 0.0]),
        (7, [-x * z, z, 0.0, x]),
        (8, [-y * z, 0.0, z, y]),
    ];
    for (row, (own, others)) in moments.into_iter().enumerate() {
        slopes[(4 + row, own)] = 1.0;
        others.into_iter().enumerate().for_each(|(k, slope)| slopes[(4 + row, k)] = slope);
    }
    slopes
}

/// Returns a load with the digits that its confidence intervals justify. Rounding does not change an inertial
/// parameter by more than a tenth of half the width of its interval. This matters because the product of mass
/// and centre may be known better than the two factors.
#[must_use]
pub fn rounded_load(body: &BodyValues, payload: &Payload) -> BodyValues {
    let half =
        |[low, high]: [f64; 2]| Some(0.5 * (high - low)).filter(|half| half.is_finite() && *half > 0.0);
    let [xx, xy, yy, xz, yz, zz] = payload.moments.map(|moment| half(moment.interval));
    let [x, y, z] = payload.centre_of_mass.map(|place| half(place.interval));
    let errors = [half(payload.mass.interval), x, y, z, xx, yy, zz, xy, xz, yz];
    let found = Found { body, fixed: &[0.0; PER_LINK], described: [None; PER_LINK], errors };
    let goes_unnoticed = |digits: &i32| {
        let change = found.change(*digits);
        let limits = payload.parameters.iter().map(|parameter| half(parameter.interval).unwrap_or(0.0));
        change.iter().zip(limits).all(|(change, limit)| change.abs() <= NOTICED * limit)
            && found.possible_from(*digits) == *digits
    };
    found.written((0..MOST_DIGITS).find(goes_unnoticed).unwrap_or(MOST_DIGITS))
}

impl BodyValues {
    /// Returns mass, centre of mass and moments of inertia of the body as ten numbers.
    fn numbers(&self) -> [f64; PER_LINK] {
        let [x, y, z] = self.center_of_mass;
        let [xx, yy, zz, xy, xz, yz] = self.inertia;
        [self.mass, x, y, z, xx, yy, zz, xy, xz, yz]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> BodyValues {
        let parameters = [2.0, 0.1, -0.06, 0.4, 0.5, 0.01, 0.4, 0.02, -0.03, 0.2];
        BodyValues::of_link("body".into(), None, &parameters)
    }

    #[test]
    fn slopes_are_those_of_the_numbers() {
        let (body, step) = (body(), 1e-6);
        let slopes = slopes(&body);
        for k in 0..PER_LINK {
            let at = |sign: f64| {
                let mut parameters = body.parameters();
                parameters[k] += sign * step;
                BodyValues::of_link(String::new(), None, &parameters).numbers()
            };
            for (row, (high, low)) in at(1.0).into_iter().zip(at(-1.0)).enumerate() {
                let slope = (high - low) / (2.0 * step);
                assert!((slope - slopes[(row, k)]).abs() < 1e-8, "{row} {k}: {slope} {}", slopes[(row, k)]);
            }
        }
    }

    #[test]
    fn digits_are_those_of_the_errors_and_bodies_stay_possible() {
        let (mut body, none) = (body(), [None; PER_LINK]);
        let of = |body: &BodyValues, digits: i32, described: [Option<f64>; PER_LINK], error: Option<f64>| {
            let found = Found { body, fixed: &[0.0; PER_LINK], described, errors: [error; PER_LINK] };
            (found.possible_from(digits), found.written(digits))
        };
        let (digits, written) = of(&body, 0, none, Some(0.012));
        assert_eq!((digits, written.mass, written.center_of_mass), (0, 2.0, [0.05, -0.03, 0.2]));
        assert_eq!(of(&body, MOST_DIGITS, none, Some(0.012)).1, body);
        // A plate, whose moments would violate the triangle inequality with one digit less.
        body.inertia = [0.1004, 0.1004, 0.2007, 0.0, 0.0, 0.0];
        let (digits, written) = of(&body, 0, none, Some(0.02));
        assert!(digits == 1 && margin(&written.parameters()) <= 0.0);
        // A body without errors keeps its digits. A value that equals the described one is written as
        // described.
        assert_eq!(of(&body, 0, none, None).1, body);
        let mut described = none;
        described[0] = Some(2.000_03);
        assert_eq!(of(&body, 1, described, Some(0.02)).1.mass, 2.000_03);
        assert_eq!(of(&body, 4, described, Some(0.02)).1.mass, 2.0);
    }
}
