//! Branches of a floating or spherical body that lie as in a mirror, as the legs of a quadruped.
//!
//! The components of their origins p are ±c with the same c. On the way outwards the products of c are formed once. On the
//! way inwards sums of the forces f with the signs s = ±1 of a component come before its product,
//!
//! ```text
//! Σ p × f = Σ_k c_k e_k × Σ s_k f
//! ```
//!
//! and what these sums have in common with each other and with Σ f is added once.

use crate::dynamics::recursion::placement::Placement;
use crate::graph::Scalar;
use crate::kinematics::{JointAxis, Mechanism};
use crate::spatial::{Force, Vector3};

/// The constant origin of a body in its parent's frame, along its axis included; `None` where no other branch of the parent
/// lies as in a mirror.
pub(super) fn mirrored<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    index: usize,
) -> Option<Vector3<Scalar<'g>>> {
    let (parent, own) = (mechanism.bodies[index].parent?, branch_origin(mechanism, placements, index)?);
    let lengths = |v: Vector3<Scalar<'g>>| v.values().map(|v| v.map(f64::abs));
    let others =
        (0..mechanism.bodies.len()).filter(|&k| k != index && mechanism.bodies[k].parent == Some(parent));
    let mut origins = others.filter_map(|other| branch_origin(mechanism, placements, other));
    origins.any(|other| lengths(other) == lengths(own)).then_some(own)
}

fn branch_origin<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    index: usize,
) -> Option<Vector3<Scalar<'g>>> {
    let (body, placement) = (&mechanism.bodies[index], &placements[index]);
    let on_chain = body.chain.is_none() && mechanism.bodies[body.parent?].chain.is_some();
    let turns = body.axis == JointAxis::Revolute && body.unit_ratio == 1.0;
    let zero = placement.extension.constant(0.0);
    let lift = body.twist.to_parent(Vector3([zero, zero, placement.extension]));
    let origin = placement.translation + lift;
    (on_chain && turns && origin.values().is_some()).then_some(origin)
}

/// The mirrored branches of a body with the forces that it exerts on them.
#[derive(Debug, Clone, Default)]
pub(super) struct Branches<'g> {
    origins: Vec<[f64; 3]>,
    forces: Vec<Vector3<Scalar<'g>>>,
}

impl<'g> Branches<'g> {
    pub fn push(&mut self, origin: Vector3<Scalar<'g>>, force: Vector3<Scalar<'g>>) {
        self.origins.extend(origin.values());
        self.forces.push(force);
    }

    /// `own` with the forces of all branches, moved to the body's origin.
    pub fn added_to(&self, own: Force<'g>) -> Force<'g> {
        let (mut left, mut result) = ((0..self.forces.len()).collect::<Vec<_>>(), own);
        while let Some(&first) = left.first() {
            let lengths = |k: usize| self.origins[k].map(f64::abs);
            let (group, others) = left.iter().partition(|&&k| lengths(k) == lengths(first));
            left = others;
            result = self.group_added(&group, lengths(first), result);
        }
        result
    }

    fn group_added(&self, group: &[usize], lengths: [f64; 3], own: Force<'g>) -> Force<'g> {
        let plain = vec![1.0; group.len()];
        let signs = |k: usize| group.iter().map(|&branch| self.origins[branch][k].signum()).collect();
        let patterns: Vec<Vec<f64>> = std::iter::once(plain).chain((0..3).map(signs)).collect();
        let mut result = own;
        for i in 0..3 {
            let levers: Vec<usize> = (0..3).filter(|&k| k != i && lengths[k] != 0.0).collect();
            let wanted: Vec<&[f64]> =
                std::iter::once(0).chain(levers.iter().map(|k| k + 1)).map(|k| &patterns[k][..]).collect();
            let terms = group.iter().map(|&branch| self.forces[branch][i]).collect();
            let sums = shared_sums(terms, &wanted);
            result.force.0[i] = result.force[i] + sums[0];
            for (&k, &sum) in levers.iter().zip(&sums[1..]) {
                // e_k × e_i
                let (axis, sign) = (3 - i - k, if (i + 3 - k) % 3 == 1 { 1.0 } else { -1.0 });
                result.moment.0[axis] = result.moment[axis] + sum * (sign * lengths[k]);
            }
        }
        result
    }
}

/// Sums of the same terms with different signs: the pair that most of them contain is added first, and so on.
fn shared_sums<'g>(mut terms: Vec<Scalar<'g>>, patterns: &[&[f64]]) -> Vec<Scalar<'g>> {
    let mut sums: Vec<Vec<(usize, f64)>> =
        patterns.iter().map(|signs| signs.iter().copied().enumerate().collect()).collect();
    while let Some((a, b, relative)) = commonest(&sums) {
        let pair = terms[a] + terms[b].signed(relative);
        for sum in &mut sums {
            if let Some(sign) = sign_of_pair(sum, (a, b, relative)) {
                sum.retain(|(term, _)| *term != a && *term != b);
                sum.push((terms.len(), sign));
            }
        }
        terms.push(pair);
    }
    sums.iter()
        .map(|sum| {
            sum.iter()
                .map(|&(term, sign)| terms[term].signed(sign))
                .fold(terms[0].constant(0.0), |a, b| a + b)
        })
        .collect()
}

/// Two terms and the sign of the second relative to the first.
type Pair = (usize, usize, f64);

fn commonest(sums: &[Vec<(usize, f64)>]) -> Option<Pair> {
    let mut best: Option<(usize, Pair)> = None;
    for sum in sums {
        for (k, &(a, sign)) in sum.iter().enumerate() {
            for &(b, other) in &sum[k + 1..] {
                let pair = (a, b, sign * other);
                let count = sums.iter().filter(|sum| sign_of_pair(sum, pair).is_some()).count();
                if count > best.map_or(0, |(count, _)| count) {
                    best = Some((count, pair));
                }
            }
        }
    }
    best.map(|(_, pair)| pair)
}

/// The sign with which a sum contains a pair.
fn sign_of_pair(sum: &[(usize, f64)], (a, b, relative): Pair) -> Option<f64> {
    let sign = |wanted: usize| sum.iter().find(|(term, _)| *term == wanted).map(|(_, sign)| *sign);
    let (first, second) = (sign(a)?, sign(b)?);
    (first * second == relative).then_some(first)
}
