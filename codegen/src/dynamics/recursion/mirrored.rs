//! Branches of a body with levers of equal length, for example mirror-symmetric legs of a quadruped or arms
//! of a humanoid.
//!
//! A component of the origin p of each such branch is +c or −c with the same c. For the accelerations,
//! products with c are computed once, and common parts of the origins are added first. For the forces f on
//! the branches, the components are summed with the signs s = ±1 before the multiplication by c:
//!
//! ```text
//! Σ p × f = Σ_k Σ_c c e_k × Σ s f          over the branches with |p_k| = c
//! ```
//!
//! Common parts of these sums and of Σ f are computed once.

use crate::dynamics::recursion::motion::BodyMotion;
use crate::dynamics::recursion::placement::Placement;
use crate::graph::Scalar;
use crate::kinematics::{JointAxis, Mechanism};
use crate::spatial::{Force, Vector3};

/// Constant origin of a body in the parent's frame, including the translation along the joint's axis. `None`
/// if no other branch of the parent has an origin at an equal distance.
pub(super) fn mirrored<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    index: usize,
) -> Option<Vector3<Scalar<'g>>> {
    let own = branch_origin(mechanism, placements, index)?;
    let mut others = other_origins(mechanism, placements, index);
    others.any(|other| levers(own).zip(levers(other)).any(|(a, b)| a != 0.0 && a == b)).then_some(own)
}

fn levers(v: Vector3<Scalar<'_>>) -> impl Iterator<Item = f64> {
    v.values().into_iter().flatten().map(f64::abs)
}

/// Origins of the other branches that a body's parent carries, in the parent's frame.
fn other_origins<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    index: usize,
) -> impl Iterator<Item = Vector3<Scalar<'g>>> {
    let parent = mechanism.bodies[index].parent;
    let others =
        (0..mechanism.bodies.len()).filter(move |&k| k != index && mechanism.bodies[k].parent == parent);
    others.filter_map(|other| branch_origin(mechanism, placements, other))
}

fn branch_origin<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    index: usize,
) -> Option<Vector3<Scalar<'g>>> {
    let (body, placement) = (&mechanism.bodies[index], &placements[index]);
    let on_chain = body.chain.is_none() && mechanism.bodies[body.parent?].chain.is_some();
    // Branches of other bodies are included if their translation along the axis is zero.
    let asked = mechanism.has_quaternions() && body.chain.is_none() && placement.extension.is_zero();
    let turns = body.axis == JointAxis::Revolute && body.unit_ratio == 1.0;
    let zero = placement.extension.constant(0.0);
    let lift = body.twist.to_parent(Vector3([zero, zero, placement.extension]));
    let origin = placement.translation + lift;
    ((on_chain || asked) && turns && origin.values().is_some()).then_some(origin)
}

/// Acceleration of a branch's origin in the parent's frame. Parts that several branches have in common are
/// added first.
pub(super) fn carried<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    index: usize,
    origin: Vector3<Scalar<'g>>,
    parent: &BodyMotion<'g>,
) -> Vector3<Scalar<'g>> {
    let others: Vec<[f64; 3]> =
        other_origins(mechanism, placements, index).filter_map(|other| other.values()).collect();
    let sharing = |k: &usize| others.iter().filter(|other| Some(other[*k]) == origin[*k].value()).count();
    let mut axes = [0, 1, 2];
    axes.sort_by_key(|k| std::cmp::Reverse(sharing(k)));
    axes.iter().fold(parent.acceleration, |sum, &k| sum + parent.spread.column(k).scaled(origin[k]))
}

/// Branches of a body with levers of equal length, and the forces of the body on them.
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

    /// Adds the forces of all branches to `own`, the body's own force, about the body's origin.
    pub fn added_to(&self, own: Force<'g>) -> Force<'g> {
        let mut result = own;
        if self.forces.is_empty() {
            return result;
        }
        for i in 0..3 {
            let levers: Vec<(usize, f64)> = (0..3)
                .filter(|k| *k != i)
                .flat_map(|k| self.lengths(k).into_iter().map(move |c| (k, c)))
                .collect();
            let all = (0..self.forces.len()).map(|branch| (branch, 1.0)).collect();
            let mut wanted = vec![all];
            wanted.extend(levers.iter().map(|&(k, length)| self.signs(k, length)));
            let terms = self.forces.iter().map(|force| force[i]).collect();
            let sums = shared_sums(terms, wanted);
            result.force.0[i] = result.force[i] + sums[0];
            for (&(k, length), &sum) in levers.iter().zip(&sums[1..]) {
                // Product e_k × e_i.
                let (axis, sign) = (3 - i - k, if (i + 3 - k) % 3 == 1 { 1.0 } else { -1.0 });
                result.moment.0[axis] = result.moment[axis] + sum * (sign * length);
            }
        }
        result
    }

    /// The distinct magnitudes of component `k` of the branches' origins, without 0.
    fn lengths(&self, k: usize) -> Vec<f64> {
        let mut lengths: Vec<f64> = Vec::new();
        for length in self.origins.iter().map(|origin| origin[k].abs()) {
            if length != 0.0 && !lengths.contains(&length) {
                lengths.push(length);
            }
        }
        lengths
    }

    /// The branches whose origin has the magnitude `length` in component `k`, each with the sign of this
    /// component.
    fn signs(&self, k: usize, length: f64) -> Vec<(usize, f64)> {
        let components = self.origins.iter().map(|origin| origin[k]).enumerate();
        components.filter(|(_, x)| x.abs() == length).map(|(branch, x)| (branch, x.signum())).collect()
    }
}

/// Computes sums of the same terms with different signs. The pair that occurs in most sums is added first,
/// then the next pair.
fn shared_sums<'g>(mut terms: Vec<Scalar<'g>>, mut sums: Vec<Vec<(usize, f64)>>) -> Vec<Scalar<'g>> {
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

/// Sign with which a sum contains a pair of terms; `None` if the sum does not contain the pair.
fn sign_of_pair(sum: &[(usize, f64)], (a, b, relative): Pair) -> Option<f64> {
    let sign = |wanted: usize| sum.iter().find(|(term, _)| *term == wanted).map(|(_, sign)| *sign);
    let (first, second) = (sign(a)?, sign(b)?);
    (first * second == relative).then_some(first)
}
