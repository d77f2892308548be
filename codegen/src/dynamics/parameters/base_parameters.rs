//! Base parameters: the identifiable combinations of the inertial parameters (Khalil and Kleinfinger 1987;
//! Gautier 1991).
//!
//! The rows of the regressor at random states are stacked. Gram–Schmidt orthogonalization visits the columns
//! from the first to the last. An independent column starts a new group. A dependent column is added to the
//! groups of the earlier columns on which it depends, so parameters move towards the base. The method is
//! numerical, because the known rules do not cover branches with special axes or gravity along an axis. The
//! seed of the states and the order of all sums are fixed, so the groups are the same on every platform.
//!
//! If free lengths, gear ratios or gravity enter the regressor, groups are formed at several values of these
//! parameters. A coefficient that differs between the values is not constant, for example the factor i² of a
//! rotor's inertia with a free gear ratio i.

use crate::dynamics::parameters::regressor::inertial_regressor;
use crate::dynamics::recursion::motion::MotionInput;
use crate::graph::Graph;
use crate::kinematics::{Mechanism, Number};
use crate::layout::Extent;
use crate::model::{JointKind, Model};
use crate::program::flow::operands;
use crate::program::interpret::interpret;
use crate::program::{GraphOutput, InputArray, Operand, Program, Shape, lower};

/// Largest part of a regressor column's length that may remain after the projection on earlier columns, on
/// which the column then depends. An exact dependency leaves about 1e-15. If the description gives angles
/// with nine digits, about 1e-9 remains.
const DEPENDENT: f64 = 1e-7;

/// A regressor column is treated as zero if it is shorter than this part of the longest column.
const ROUNDING: f64 = 1e-13;

/// Factor for rounding the coefficients of base parameters. Coefficients below 1 keep 12 decimals, and larger
/// coefficients keep 13 digits. Further digits are rounding errors of the factorization.
const DIGITS: f64 = 1e12;

/// Coefficients of base parameters with a smaller magnitude are treated as zero.
const SMALLEST: f64 = 1e-10;

/// Smallest number of random states at which the regressor is evaluated. A link on the base has one row per
/// state for its ten parameters, so at least ten states are needed.
const STATES: usize = 25;

/// Number of tested values of the free parameters if the regressor depends on them.
const VALUES: usize = 3;

/// Largest difference of coefficients at two values of the free parameters that counts as equal. The
/// difference is relative to the larger coefficient if that coefficient is above 1. The value is about a
/// hundred times the rounding error of the factorization.
const SAME: f64 = 1e-9;

/// Base parameters (identifiable combinations of inertial parameters) of a model, valid for almost all values
/// of its free parameters. Special values, for example a length of zero, may reduce the number of base
/// parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// Indices of the leading inertial parameter of each group, in ascending order. The base regressor has
    /// the columns of the regressor for these parameters.
    pub leaders: Vec<usize>,
    /// Terms of all base parameters, in the order of their groups. The first term of a group is the leading
    /// parameter.
    pub terms: Vec<Term>,
}

/// A term of a base parameter: a coefficient times an inertial parameter. The base parameter is the sum of the
/// terms of its group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Index of the base parameter to which the term belongs.
    pub group: usize,
    /// Index of the inertial parameter in the term.
    pub parameter: usize,
    /// Factor of the inertial parameter; `None` if it depends on free parameters.
    pub coefficient: Option<f64>,
}

impl BaseParameters {
    /// Finds the base parameters (identifiable combinations of inertial parameters) of a model.
    pub fn new(model: &Model, mechanism: &Mechanism<Number>) -> Self {
        let program = regressor_program(model, mechanism);
        let mut random = SplitMix64(0x6672_6565);
        let described = || model.parameters.iter().map(|parameter| parameter.default);
        if !reads_parameters(&program) {
            return Self::of_columns(&stacked_columns(model, &program, &described().collect::<Vec<_>>()));
        }
        let found = (0..VALUES).map(|_| {
            let values: Vec<f64> = described().map(|x| random.near(x)).collect();
            Self::of_columns(&stacked_columns(model, &program, &values))
        });
        Self::in_common(&found.collect::<Vec<_>>())
    }

    /// All terms as (group, parameter, coefficient). The base parameter of a group is β\[group\] = Σ
    /// coefficient · π\[parameter\] with the inertial parameters π. `None` if any coefficient depends on free
    /// parameters.
    pub fn constant_terms(&self) -> Option<Vec<(usize, usize, f64)>> {
        let terms = self.terms.iter();
        terms.map(|term| Some((term.group, term.parameter, term.coefficient?))).collect()
    }

    /// Combines the base parameters found at several values of free parameters: the leading inertial
    /// parameters of all results, and the coefficients that agree in all results.
    fn in_common(found: &[Self]) -> Self {
        let mut leaders: Vec<usize> = found.iter().flat_map(|one| one.leaders.clone()).collect();
        leaders.sort_unstable();
        leaders.dedup();
        let mut terms: Vec<Term> = Vec::new();
        for one in found {
            for term in &one.terms {
                let group = leaders.binary_search(&one.leaders[term.group]);
                let group =
                    group.unwrap_or_else(|_| unreachable!("each leading parameter is an inertial parameter"));
                terms.push(Term { group, ..*term });
            }
        }
        terms.sort_by_key(|term| (term.group, term.parameter));
        let same = terms.chunk_by(|a, b| (a.group, a.parameter) == (b.group, b.parameter));
        let terms = same.map(|same| {
            let is_everywhere = same.len() == found.len();
            let first = same[0];
            let is_constant = is_everywhere && same.iter().all(|term| is_same(term, &first));
            Term { coefficient: first.coefficient.filter(|_| is_constant), ..first }
        });
        let terms = terms.collect();
        Self { leaders, terms }
    }

    /// Finds the base parameters from the columns of a regressor that is stacked over random states.
    fn of_columns(columns: &[Vec<f64>]) -> Self {
        let longest = columns.iter().map(|c| dot(c, c).sqrt()).fold(0.0, f64::max);
        let mut basis = Basis::default();
        let mut leaders = Vec::new();
        let mut terms = Vec::new();
        for (index, column) in columns.iter().enumerate() {
            match basis.project(column, ROUNDING * longest) {
                Projection::Independent => {
                    terms.push(Term { group: leaders.len(), parameter: index, coefficient: Some(1.0) });
                    leaders.push(index);
                }
                Projection::Dependent(coefficients) => {
                    let kept = coefficients.iter().enumerate().filter_map(|(group, &c)| {
                        let rounded = without_rounding(c);
                        (rounded.abs() >= SMALLEST).then_some(Term {
                            group,
                            parameter: index,
                            coefficient: Some(rounded),
                        })
                    });
                    terms.extend(kept);
                }
            }
        }
        terms.sort_by_key(|term| (term.group, term.parameter));
        Self { leaders, terms }
    }

    /// Terms of each base parameter. The first term is the leading inertial parameter.
    pub fn groups(&self) -> impl Iterator<Item = &[Term]> {
        self.terms.chunk_by(|a, b| a.group == b.group)
    }
}

fn is_same(one: &Term, other: &Term) -> bool {
    match (one.coefficient, other.coefficient) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME * a.abs().max(b.abs()).max(1.0),
        _ => false,
    }
}

/// Whether a free parameter enters the regressor. Lengths, gear ratios and gravity can enter the regressor,
/// masses cannot.
fn reads_parameters(program: &Program) -> bool {
    let is_parameter = |operand: &Operand| matches!(operand, Operand::Parameter(_));
    let mut read = program.instructions.iter().flat_map(|made| operands(made.operation));
    let mut entries = program.outputs.iter().flat_map(|output| &output.entries);
    read.any(|operand| is_parameter(&operand)) || entries.any(is_parameter)
}

/// The regressor of the inertial parameters as a program with the arguments y, v and a.
fn regressor_program(model: &Model, mechanism: &Mechanism<Number>) -> Program {
    let graph = Graph::new();
    let (free, n) = (model.coordinates.len(), model.motion_count());
    let y = mechanism.positions_on(&graph);
    let [v, a] = [1, 2].map(|array| (0..n).map(|k| graph.input(array, k)).collect::<Vec<_>>());
    let input = MotionInput { y: &y, v: &v, a: &a };
    let mut matrix = inertial_regressor(&mechanism.on(&graph), model, input);
    // Rows of driven coordinates are left out, because their forces are not measured.
    matrix.truncate(free);
    let columns = matrix.first().map_or(0, Vec::len);
    let output = GraphOutput {
        name: "W".to_owned(),
        shape: Shape::Matrix(Extent::fixed(free), Extent::fixed(columns)),
        entries: matrix.concat().iter().map(|x| x.edge()).collect(),
    };
    let lengths = [("y", model.position_count() + model.driven.len()), ("v", n), ("a", n)];
    let inputs = lengths.map(|(name, n)| InputArray { name: name.to_owned(), extent: Extent::fixed(n) });
    lower(&graph, inputs.into(), &[output])
}

/// Columns of the regressor at random states. Each column contains the entries of all states.
fn stacked_columns(model: &Model, program: &Program, parameters: &[f64]) -> Vec<Vec<f64>> {
    let ranges = position_ranges(model);
    let rows = model.coordinates.len();
    let count = program.outputs[0].entries.len() / rows.max(1);
    let mut columns = vec![Vec::with_capacity(rows * STATES); count];
    let mut random = SplitMix64(0x6765_6c65_6e6b);
    for _ in 0..state_count(&program.outputs[0].entries, rows) {
        let y: Vec<f64> = ranges.iter().map(|range| random.within(*range)).collect();
        let y = [model.positions_by(&y), y[rows..].to_vec()].concat();
        let v: Vec<f64> = ranges.iter().map(|_| random.within(2.0)).collect();
        let a: Vec<f64> = ranges.iter().map(|_| random.within(5.0)).collect();
        let values = interpret(program, &[&y, &v, &a], parameters);
        #[expect(clippy::expect_used, reason = "the program was made for these inputs")]
        let values = values.expect("inputs fit").concat();
        for row in values.chunks_exact(count.max(1)) {
            for (column, value) in columns.iter_mut().zip(row) {
                column.push(*value);
            }
        }
    }
    columns
}

/// Number of random states that is sufficient to distinguish all regressor columns. Each column is assigned
/// to one row among the rows in which it is not zero: the row with the fewest non-zero columns. The number of
/// states is at least twice the largest number of columns that are assigned to one row.
fn state_count(entries: &[Operand], rows: usize) -> usize {
    let count = entries.len() / rows.max(1);
    let sees = |row: usize, column: usize| entries[row * count + column] != Operand::Constant(0.0);
    let seen: Vec<usize> =
        (0..rows).map(|row| (0..count).filter(|&column| sees(row, column)).count()).collect();
    let mut own = vec![0; rows];
    for column in 0..count {
        let seeing = (0..rows).filter(|&row| sees(row, column));
        if let Some(row) = seeing.min_by_key(|&row| seen[row]) {
            own[row] += 1;
        }
    }
    own.iter().fold(STATES, |most, own| most.max(2 * own))
}

/// Rounds a coefficient: 12 decimals below 1, otherwise 13 digits.
fn without_rounding(coefficient: f64) -> f64 {
    match coefficient.abs() < 1.0 {
        true => (coefficient * DIGITS).round() / DIGITS,
        false => format!("{coefficient:.12e}").parse().unwrap_or(coefficient),
    }
}

/// Largest magnitude of the random position of each coordinate: π for angles, 1 m for prismatic joints.
fn position_ranges(model: &Model) -> Vec<f64> {
    let joints = model.joints().chain(model.driven_joints());
    joints
        .map(|joint| match joint.kind {
            JointKind::Prismatic => 1.0,
            _ => std::f64::consts::PI,
        })
        .collect()
}

/// Orthonormal basis of the independent regressor columns that were visited.
#[derive(Default)]
struct Basis {
    directions: Vec<Vec<f64>>,
    /// Column k of the triangular matrix of the orthogonalization: the components of the k-th independent
    /// column in the basis.
    triangle: Vec<Vec<f64>>,
}

enum Projection {
    /// The regressor column is independent of the earlier columns.
    Independent,
    /// The regressor column is the sum of the independent columns times these coefficients.
    Dependent(Vec<f64>),
}

impl Basis {
    fn project(&mut self, column: &[f64], rounding: f64) -> Projection {
        let length = dot(column, column).sqrt();
        let mut rest = column.to_vec();
        let mut shares = vec![0.0; self.directions.len()];
        // The second pass removes rounding errors of the first pass.
        for _ in 0..2 {
            for (share, direction) in shares.iter_mut().zip(&self.directions) {
                let along = dot(direction, &rest);
                *share += along;
                for (x, d) in rest.iter_mut().zip(direction) {
                    *x -= along * d;
                }
            }
        }
        let left = dot(&rest, &rest).sqrt();
        if left <= rounding.max(DEPENDENT * length) {
            return Projection::Dependent(self.solve(shares));
        }
        rest.iter_mut().for_each(|x| *x /= left);
        self.directions.push(rest);
        shares.push(left);
        self.triangle.push(shares);
        Projection::Independent
    }

    /// Solves `R x = shares` with the triangular matrix R of the orthogonalization.
    fn solve(&self, mut shares: Vec<f64>) -> Vec<f64> {
        for k in (0..shares.len()).rev() {
            shares[k] /= self.triangle[k][k];
            for i in 0..k {
                shares[i] -= self.triangle[k][i] * shares[k];
            }
        }
        shares
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Random numbers of SplitMix64 (Steele, Lea and Flood 2014).
struct SplitMix64(u64);

impl SplitMix64 {
    /// A random value within 30 % of the description's value, or within ±0.3 if that value is 0.
    fn near(&mut self, described: f64) -> f64 {
        match described {
            0.0 => self.within(0.3),
            _ => described * (1.0 + self.within(0.3)),
        }
    }

    /// A number with uniform distribution between −`range` and `range`.
    fn within(&mut self, range: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        // The upper 53 bits are the significand.
        let unit = (z >> 11) as f64 / (1_u64 << 53) as f64;
        range * (2.0 * unit - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{GENERAL, PUMA, RX90, chain};

    /// Mayeda, Yoshida and Osuka (1990): 7 n − 4 for revolute joints of which the first two are not parallel,
    /// 2 less where the first is upright. (The 40 of the RX-90 in Khalil and Dombre 2002 hold four rotors.)
    #[test]
    fn counts_of_known_geometries() {
        let count = |rows: &[crate::testing::Row], gravity| {
            let model = chain(rows, gravity);
            BaseParameters::new(&model, &Mechanism::new(&model)).leaders.len()
        };
        assert_eq!(count(&RX90, [0.0, 0.0, -9.81]), 36);
        assert_eq!(count(&PUMA, [0.0, 0.0, -9.81]), 36);
        assert_eq!(count(&GENERAL, [0.3, 1.0, -9.0]), 38);
    }

    #[test]
    fn dependent_columns_join_the_groups_of_those_before() {
        let (a, b) = (vec![1.0, 2.0, 0.5, -1.0], vec![0.0, 1.0, -3.0, 2.0]);
        let sum = |x: f64, y: f64| a.iter().zip(&b).map(|(a, b)| x * a + y * b).collect::<Vec<_>>();
        let columns = [a.clone(), vec![0.0; 4], sum(0.25, 0.0), b.clone(), sum(-1.0, 2.0)];
        let base = BaseParameters::of_columns(&columns);
        assert_eq!(base.leaders, [0, 3]);
        let terms = vec![(0, 0, 1.0), (0, 2, 0.25), (0, 4, -1.0), (1, 3, 1.0), (1, 4, 2.0)];
        assert_eq!(base.constant_terms(), Some(terms));
        assert_eq!(base.groups().count(), 2);
    }

    #[test]
    fn what_changes_with_free_parameters_is_no_constant() {
        let column = |x: f64| vec![x, 2.0 * x, -x];
        let at = |length: f64| {
            BaseParameters::of_columns(&[column(1.0), column(0.5), column(length), vec![1.0, 0.0, length]])
        };
        let same = BaseParameters::in_common(&[at(0.3), at(0.3)]);
        assert_eq!(same, at(0.3));
        let base = BaseParameters::in_common(&[at(0.3), at(0.4)]);
        assert_eq!(base.leaders, [0, 3]);
        assert_eq!(base.constant_terms(), None);
        let coefficients: Vec<_> = base.terms.iter().map(|term| term.coefficient).collect();
        assert_eq!(coefficients, [Some(1.0), Some(0.5), None, Some(1.0)]);
        // A column that is a direction of its own at one value has to stand in the regressor.
        let other = |x: f64| BaseParameters::of_columns(&[column(1.0), vec![1.0, 2.0, x]]);
        assert_eq!(BaseParameters::in_common(&[other(-1.0), other(2.0)]).leaders, [0, 1]);
    }
}
