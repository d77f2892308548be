//! Search for the cheapest formulation, that is the way to write the equations with the smallest weight of
//! operations.

use crate::dynamics::formulation::{
    AngularRoute, BodyChoices, Diagonal, Formulation, LeafAlignment, Lift, RunLink, WorkingFrame,
};
use crate::kinematics::{Body, JointAxis, Mechanism, Number, RegroupChoice, SHORTEST_LEVER};

/// Available choices for writing the equations of a mechanism.
#[derive(Debug, Clone)]
pub struct SearchSpace {
    has_quaternions: bool,
    length_units: Vec<f64>,
    bodies: Vec<BodyOptions>,
}

#[derive(Debug, Clone)]
struct BodyOptions {
    revolute: bool,
    right_angle: bool,
    in_run: bool,
    before_joint: bool,
    is_leaf: bool,
    balances: bool,
    lifted: bool,
    parent: Option<usize>,
    /// For each body, the non-zero lengths of its children's translations and of its own translation along
    /// its axis (m).
    own_lengths: Vec<f64>,
}

impl BodyOptions {
    fn alternatives(&self, now: BodyChoices) -> Vec<BodyChoices> {
        let mut options = Vec::new();
        if self.revolute {
            let angular = match now.angular {
                AngularRoute::Acceleration => AngularRoute::AxisPoints,
                AngularRoute::AxisPoints => AngularRoute::Acceleration,
            };
            options.push(BodyChoices { angular, ..now });
        }
        if self.before_joint {
            let frame = match now.frame {
                WorkingFrame::Body => WorkingFrame::BeforeJoint,
                WorkingFrame::BeforeJoint => WorkingFrame::Body,
            };
            options.push(BodyChoices { frame, ..now });
        }
        if self.in_run {
            let other = |link| {
                if link == RunLink::Parent { RunLink::RunBase } else { RunLink::Parent }
            };
            options.push(BodyChoices { source: other(now.source), ..now });
            options.push(BodyChoices { sink: other(now.sink), ..now });
            options.push(BodyChoices { source: other(now.source), sink: other(now.sink), ..now });
        }
        if self.balances {
            let regroup = match now.regroup {
                RegroupChoice::Massless => RegroupChoice::BalanceParent,
                RegroupChoice::BalanceParent | RegroupChoice::Take(_) => RegroupChoice::Massless,
            };
            options.push(BodyChoices { regroup, ..now });
        }
        if self.is_leaf {
            use LeafAlignment::{FirstMoment, NoOffset, SecondMoment};
            let others = [NoOffset, FirstMoment, SecondMoment].into_iter().filter(|leaf| *leaf != now.leaf);
            options.extend(others.map(|leaf| BodyChoices { leaf, ..now }));
        }
        options
    }

    /// Alternatives for one body that are tried only for the recursive inverse dynamics.
    fn fine_alternatives(&self, now: BodyChoices) -> Vec<BodyChoices> {
        use Diagonal::{Axis, AxisAcross, Squares, Sums};
        let mut options = vec![BodyChoices { by_acceleration: !now.by_acceleration, ..now }];
        options.extend([Sums, Squares, Axis, AxisAcross].map(|diagonal| BodyChoices { diagonal, ..now }));
        if self.revolute && self.parent.is_some() {
            options.extend([0, 1, 2].map(|k| BodyChoices { regroup: RegroupChoice::Take(k), ..now }));
        }
        if self.revolute && self.lifted {
            options.extend(
                [Lift::Own, Lift::OfParent, Lift::OfChildren].map(|lift| BodyChoices { lift, ..now }),
            );
        }
        options
    }

    /// Units of length that may save operations at this body.
    fn units(&self, formulation: &Formulation) -> Vec<f64> {
        let parent = self.parent.map(|parent| formulation.bodies[parent].length_unit);
        self.own_lengths.iter().copied().chain(parent).collect()
    }
}

impl SearchSpace {
    /// Finds the choices for writing the equations of a mechanism.
    pub fn new(mechanism: &Mechanism<Number>) -> Self {
        let children = mechanism.children();
        let parallel = |index: usize| {
            let body = &mechanism.bodies[index];
            is_single_turn(body) && body.twist.is_none()
        };
        let bodies = mechanism.bodies.iter().enumerate().map(|(index, body)| {
            let revolute = is_single_turn(body);
            let parent_revolute = body.parent.is_some_and(|p| is_single_turn(&mechanism.bodies[p]));
            BodyOptions {
                revolute,
                right_angle: body.parent.is_some() && body.twist.alpha.1 == 0.0,
                in_run: parallel(index) && parent_revolute,
                before_joint: revolute && children[index].iter().all(|&child| parallel(child)),
                is_leaf: revolute && children[index].is_empty(),
                balances: revolute
                    && body.parent.is_some()
                    && body.lever().is_some_and(|px| px.abs() >= SHORTEST_LEVER),
                lifted: body.lift.value() != Some(0.0),
                parent: body.parent,
                own_lengths: if all_revolute(mechanism) {
                    own_lengths(mechanism, index, &children[index])
                } else {
                    Vec::new()
                },
            }
        });
        let has_quaternions = mechanism.has_quaternions();
        Self { has_quaternions, length_units: length_units(mechanism), bodies: bodies.collect() }
    }
}

/// Whether the body has a revolute joint and is not part of a joint with a quaternion, for which there are no
/// choices.
fn is_single_turn(body: &Body<Number>) -> bool {
    body.axis == JointAxis::Revolute && body.chain.is_none()
}

/// Whether all joints are revolute. Otherwise some results are forces, and their unit of length is fixed.
fn all_revolute(mechanism: &Mechanism<Number>) -> bool {
    mechanism.bodies.iter().all(is_single_turn)
}

/// Lengths of the robot \[m\] that may become the unit of length. A length that is the unit becomes 1 and
/// saves products.
fn length_units(mechanism: &Mechanism<Number>) -> Vec<f64> {
    if !all_revolute(mechanism) {
        return Vec::new();
    }
    let levers = mechanism
        .bodies
        .iter()
        .filter(|body| body.parent.is_some())
        .flat_map(|body| body.translation.0.into_iter().chain([body.lift]));
    let mut units: Vec<f64> = levers.chain(mechanism.gravity.0).filter_map(nonzero_length).collect();
    units.sort_by(f64::total_cmp);
    units.dedup();
    // Each candidate costs one evaluation. Long chains gain more from separate units for each body.
    units.truncate(16);
    units
}

/// Lengths of a body \[m\] that may become the body's unit of length. A length that is the unit becomes 1 and
/// saves products.
fn own_lengths(mechanism: &Mechanism<Number>, body: usize, children: &[usize]) -> Vec<f64> {
    let levers = children.iter().flat_map(|&child| mechanism.bodies[child].translation.0);
    levers.chain([mechanism.bodies[body].lift]).filter_map(nonzero_length).collect()
}

fn nonzero_length(x: Number) -> Option<f64> {
    x.value().map(f64::abs).filter(|length| *length >= SHORTEST_LEVER)
}

/// Continues the descent of [`cheapest`] with finer choices, which only the recursive inverse dynamics have.
///
/// For robots without quaternions, `start` is returned. `evaluate` returns the same values as in
/// [`cheapest`].
pub fn refined(
    space: &SearchSpace,
    start: Formulation,
    evaluate: impl Fn(&Formulation) -> (u64, usize),
) -> Formulation {
    if !space.has_quaternions {
        return start;
    }
    let (weight, nodes) = evaluate(&start);
    let left = (REFINING_NODES / nodes.max(1)).max(4);
    let mut descent = Descent { evaluate, best: start, weight, left };
    descent.attempt(SearchSpace::refining);
    let mut before = u64::MAX;
    while descent.weight < before && descent.left > 0 {
        before = descent.weight;
        descent.sweep_finely(space);
    }
    descent.best
}

/// Largest number of nodes that the finer descent visits. A humanoid with 29 joints needs two thirds of this
/// number.
const REFINING_NODES: usize = 12_000_000;

/// Largest number of nodes that the descent visits. It limits the run time of the generator.
const VISITED_NODES: usize = 600_000;

/// Improves the plain formulation step by step until no single change makes it cheaper.
///
/// `evaluate` returns the weight of a formulation's operations and the number of its graph's nodes. Changes
/// are tried in a fixed order, and each improvement is kept, so the search is deterministic. The search ends
/// if no change improves the formulation, or after a fixed number of visited nodes.
pub fn cheapest(space: &SearchSpace, evaluate: impl Fn(&Formulation) -> (u64, usize)) -> Formulation {
    let plain = Formulation::plain(space.bodies.len());
    let (weight, nodes) = evaluate(&plain);
    let budget = (VISITED_NODES / nodes.max(1)).max(4);
    let mut descent = Descent { evaluate, best: plain, weight, left: budget.min(600) };
    descent.attempt(|best| space.promising(best));
    let mut before = u64::MAX;
    while descent.weight < before && descent.left > 0 {
        before = descent.weight;
        descent.sweep(space);
    }
    descent.best
}

struct Descent<F> {
    evaluate: F,
    best: Formulation,
    weight: u64,
    left: usize,
}

impl<F: Fn(&Formulation) -> (u64, usize)> Descent<F> {
    fn attempt(&mut self, change: impl FnOnce(&Formulation) -> Formulation) {
        if self.left == 0 {
            return;
        }
        let candidate = change(&self.best);
        if candidate == self.best {
            return;
        }
        self.left -= 1;
        let (weight, _) = (self.evaluate)(&candidate);
        if weight < self.weight {
            (self.best, self.weight) = (candidate, weight);
        }
    }

    fn sweep(&mut self, space: &SearchSpace) {
        for &unit in &space.length_units {
            self.attempt(|best| best.with_unit(unit));
        }
        for rank in 0..2 {
            self.attempt(|best| space.with_own_units(best, rank));
        }
        for (index, options) in space.bodies.iter().enumerate() {
            for choices in options.alternatives(self.best.bodies[index]) {
                self.attempt(|best| best.with_body(index, choices));
            }
            for length_unit in options.units(&self.best) {
                self.attempt(|best| best.with_body(index, BodyChoices { length_unit, ..best.bodies[index] }));
            }
        }
    }
}

impl<F: Fn(&Formulation) -> (u64, usize)> Descent<F> {
    fn sweep_finely(&mut self, space: &SearchSpace) {
        for (index, options) in space.bodies.iter().enumerate() {
            let now = self.best.bodies[index];
            let fine = options.fine_alternatives(now).into_iter();
            for choices in fine.chain(options.alternatives(now)) {
                self.attempt(|best| best.with_body(index, choices));
            }
        }
    }
}

impl SearchSpace {
    /// Start of the search with finer choices: the choices that are cheapest for most bodies.
    fn refining(start: &Formulation) -> Formulation {
        let mut next = start.clone();
        for body in &mut next.bodies {
            body.diagonal = Diagonal::Squares;
            body.by_acceleration = true;
        }
        next
    }

    /// The formulation in which entry `rank` of each body's list of lengths is the body's unit of length.
    fn with_own_units(&self, formulation: &Formulation, rank: usize) -> Formulation {
        let mut next = formulation.clone();
        for (body, options) in next.bodies.iter_mut().zip(&self.bodies) {
            body.length_unit = options.own_lengths.get(rank).copied().unwrap_or(body.length_unit);
        }
        next
    }

    /// Start of the search: the choices that are cheapest for most bodies of most robots.
    fn promising(&self, plain: &Formulation) -> Formulation {
        let mut next = plain.clone();
        for (body, options) in next.bodies.iter_mut().zip(&self.bodies) {
            if options.revolute && options.right_angle {
                body.angular = AngularRoute::AxisPoints;
            }
            if options.balances {
                body.regroup = RegroupChoice::BalanceParent;
            }
            if options.is_leaf {
                body.leaf = LeafAlignment::FirstMoment;
            }
        }
        next
    }
}
