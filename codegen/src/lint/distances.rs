//! Distances of two frames: at pseudo-random states, at the ends of the joints' ranges, and the least
//! distance.

use nalgebra::{Matrix3, Vector3};

use crate::model::regularity::{child_from_parent, positions, product_and_sum};
use crate::model::{Attachment, Model, Motion};
use crate::random::Random;

/// Number of pseudo-random states at which the distance is computed.
const STATES: usize = 64;
const SEED: u64 = 0x6469_7374_616e_6365;

/// Number of the states with the least distances from which a search for the least distance begins.
const STARTS: usize = 8;
/// Largest number of steps of a search for the least distance. A search takes about 12 steps, and about 60
/// steps if the distance only touches zero.
const STEPS: usize = 100;
/// Step of the central differences, in rad or m.
const DIFFERENCE: f64 = 1e-6;

/// Number of intervals into which a joint's range is divided.
const INTERVALS: u32 = 720;
/// Number of bisection steps after which the ends of an interval are neighbouring floating-point numbers.
const HALVINGS: u32 = 64;

/// Equally spaced positions in a joint's range, including both ends.
pub(super) fn places([low, high]: [f64; 2]) -> Vec<f64> {
    let part = |k: u32| f64::from(k) / f64::from(INTERVALS);
    (0..=INTERVALS).map(|k| low + (high - low) * part(k)).collect()
}

/// Returns two neighbouring positions by bisection: a condition is false at the first and true at the second.
pub(super) fn crossing([mut before, mut behind]: [f64; 2], is_so: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (before + behind);
        *(if is_so(middle) { &mut behind } else { &mut before }) = middle;
    }
    [before, behind]
}

/// Distance of two frames as a function of the state.
pub(super) struct Distances<'m> {
    model: &'m Model,
    between: &'m [Attachment; 2],
    /// Values of the free parameters, usually those of the description.
    described: Vec<f64>,
    /// Positions of the links' joints. First all joints are at 0 or at the position closest to 0, then at
    /// their lowest and at their highest position, then at pseudo-random states.
    states: Vec<Vec<f64>>,
}

/// Least distance of two frames that the searches found.
pub(super) struct Closest {
    /// Least distance of the frames (m).
    pub(super) distance: f64,
    /// Names and positions of the coordinates that change the distance of the frames, at the least distance.
    pub(super) positions: Vec<(String, f64)>,
    /// Whether all coordinates that change the distance have limits.
    pub(super) is_limited: bool,
}

impl<'m> Distances<'m> {
    pub(super) fn new(model: &'m Model, between: &'m [Attachment; 2]) -> Self {
        let described = model.described_parameters();
        Self::with_parameters(model, between, described)
    }

    /// Creates the distances for given values of the free parameters.
    ///
    /// - `described`: values of the free parameters
    pub(super) fn with_parameters(
        model: &'m Model,
        between: &'m [Attachment; 2],
        described: Vec<f64>,
    ) -> Self {
        let mut random = Random::new(SEED);
        let ends: [fn([f64; 2]) -> f64; 3] =
            [|[low, high]| 0.0_f64.clamp(low, high), |[low, _]| low, |[_, high]| high];
        let mut states: Vec<Vec<f64>> =
            ends.map(|end| positions(model, &described, |_, range| end(range))).into();
        for _ in 0..STATES {
            states.push(positions(model, &described, |_, [low, high]| random.between(low, high)));
        }
        Self { model, between, described, states }
    }

    /// Distances of the frames at the pseudo-random states (m).
    pub(super) fn at_states(&self) -> Vec<f64> {
        self.states.iter().map(|state| self.gap(state).norm()).collect()
    }

    /// Least distance that searches from the closest states find, within the limits of the coordinates.
    pub(super) fn closest(&self) -> Closest {
        let mut starts: Vec<(f64, &Vec<f64>)> =
            self.states.iter().map(|state| (self.gap(state).norm(), state)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends = starts.iter().take(STARTS).map(|(_, start)| self.descend((*start).clone()));
        let ends = ends.map(|end| (self.gap(&end).norm(), end));
        let (distance, state) =
            ends.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_else(|| (f64::INFINITY, Vec::new()));
        let moving = self.coordinates().filter(|link| {
            self.states.iter().take(STARTS).any(|state| self.rate(state, *link).norm() > DIFFERENCE)
        });
        let moving: Vec<usize> = moving.collect();
        let is_limited = |link: &usize| self.range(*link).iter().all(|end| end.is_finite());
        Closest {
            distance,
            is_limited: moving.iter().all(is_limited),
            positions: moving.iter().map(|link| (self.name(*link), state[*link])).collect(),
        }
    }

    /// Links of the coordinates that change the distance of the frames, including coordinates with prescribed
    /// motion. All other coordinates do not move the frames relative to each other.
    pub(super) fn changing(&self) -> Vec<usize> {
        let changes = |link: &usize| {
            let rate = |state: &Vec<f64>| self.gap(state).normalize().dot(&self.rate(state, *link));
            self.states.iter().any(|state| rate(state).abs() > DIFFERENCE)
        };
        self.coordinates().filter(changes).collect()
    }

    /// Distance of the frames \[m\] with one coordinate at `position`. All other coordinates are as close to
    /// 0 as their limits allow.
    pub(super) fn with(&self, link: usize, position: f64) -> f64 {
        self.gap(&self.moved(&self.states[0], &[(link, position)])).norm()
    }

    /// Derivative of the distance [`Self::with`] with respect to the position of the coordinate.
    pub(super) fn slope(&self, link: usize, position: f64) -> f64 {
        let [forward, backward] = [1.0, -1.0].map(|sign| self.with(link, position + sign * DIFFERENCE));
        (forward - backward) / (2.0 * DIFFERENCE)
    }

    /// Vector from the first frame to the second frame, in the base frame.
    fn gap(&self, state: &[f64]) -> Vector3<f64> {
        let [a, b] = self.between.each_ref().map(|at| origin(self.model, &self.described, state, at));
        Vector3::from(b) - Vector3::from(a)
    }

    /// The links with independent joints.
    fn coordinates(&self) -> impl Iterator<Item = usize> {
        let links = self.model.links.iter().enumerate();
        links.filter_map(|(index, link)| match link.joint.as_ref()?.motion {
            Motion::Coordinate(_) => Some(index),
            Motion::Fixed | Motion::Held(_) | Motion::Follower(_) => None,
        })
    }

    pub(super) fn name(&self, link: usize) -> String {
        self.model.links[link].joint.as_ref().map_or_else(String::new, |joint| joint.name.clone())
    }

    fn range(&self, link: usize) -> [f64; 2] {
        let joint = self.model.links[link].joint.as_ref();
        joint.and_then(|joint| joint.limits.position).unwrap_or([f64::NEG_INFINITY, f64::INFINITY])
    }

    /// The state with other positions of some coordinates. Joints that follow these coordinates move too.
    fn moved(&self, state: &[f64], changes: &[(usize, f64)]) -> Vec<f64> {
        positions(self.model, &self.described, |link, _| {
            let change = changes.iter().find(|(changed, _)| *changed == link);
            change.map_or(state[link], |(_, position)| *position)
        })
    }

    /// Derivative of the vector between the frames along a coordinate.
    fn rate(&self, state: &[f64], link: usize) -> Vector3<f64> {
        let at = |step: f64| self.gap(&self.moved(state, &[(link, state[link] + step)]));
        (at(DIFFERENCE) - at(-DIFFERENCE)) / (2.0 * DIFFERENCE)
    }

    /// Finds a state with a minimum of the distance by damped least squares (Levenberg 1944, Marquardt 1963).
    /// Coordinates stay within their limits.
    fn descend(&self, mut state: Vec<f64>) -> Vec<f64> {
        let mut damping = 1e-3;
        let mut rates = self.free_rates(&state);
        for _ in 0..STEPS {
            let gap = self.gap(&state);
            let products: Matrix3<f64> = rates.iter().map(|(_, rate)| rate * rate.transpose()).sum();
            let scale = products.trace();
            if scale == 0.0 || damping > 1e12 {
                break;
            }
            let matrix = products + Matrix3::identity() * (damping * scale);
            let Some(weights) = matrix.lu().solve(&gap) else { break };
            let step = |(link, rate): &(usize, Vector3<f64>)| {
                let [low, high] = self.range(*link);
                (*link, (state[*link] - rate.dot(&weights)).max(low).min(high))
            };
            let next = self.moved(&state, &rates.iter().map(step).collect::<Vec<_>>());
            if self.gap(&next).norm() < gap.norm() {
                state = next;
                rates = self.free_rates(&state);
                damping = (damping / 10.0).max(1e-15);
            } else {
                damping *= 10.0;
            }
        }
        state
    }

    /// Derivatives of the vector between the frames along the coordinates whose limits allow a motion that
    /// shortens the distance.
    fn free_rates(&self, state: &[f64]) -> Vec<(usize, Vector3<f64>)> {
        let gap = self.gap(state);
        let rates = self.coordinates().map(|link| (link, self.rate(state, link)));
        let is_free = |(link, rate): &(usize, Vector3<f64>)| {
            let ([low, high], slope) = (self.range(*link), rate.dot(&gap));
            !(state[*link] <= low && slope > 0.0 || state[*link] >= high && slope < 0.0)
        };
        rates.filter(is_free).collect()
    }
}

/// Origin of a frame in the base frame.
pub(super) fn origin(model: &Model, described: &[f64], positions: &[f64], at: &Attachment) -> [f64; 3] {
    let mut point = at.pose.translation.each_ref().map(|x| x.evaluate(described, 0.0, 0.0));
    let mut link = at.link;
    while let Some(joint) = &model.links[link].joint {
        let transform = child_from_parent(joint, positions[link], described);
        // The transform of motions holds Rᵀ and −Rᵀ [r]ₓ.
        let rotation: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| transform[j][i]));
        let cross = |i: usize, j: usize| -(0..3).map(|k| rotation[i][k] * transform[k + 3][j]).sum::<f64>();
        point = product_and_sum(&rotation, &point, &[cross(2, 1), cross(0, 2), cross(1, 0)]);
        link = joint.parent;
    }
    point
}
