//! Zero-order holds of several robots at a time. Each number (lane) of a vector belongs to one robot.

use super::packed::{pack, unpack};
use super::product::{Blocks, Half, Start, entries, entries_mut, sum};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::qp::lanes::{Vector, WIDTH, flat, flat_mut, largest, vectorized};
use gelenk_kernels::discrete_time::shared::{COEFFICIENTS, MOST_DOUBLINGS, TERMS, halvings};

/// Largest norm of the system matrix times the step length for which the first two of three parts of the Taylor
/// polynomial are enough. The remainder of the series is then below `0.34¹²/13! = 4e-16`.
const OF_TWO_PARTS: f64 = 0.34;

/// A linearized robot `v̇ = A_y δ + A_v v + B_x u + c`, `δ̇ = D δ + v` with displacements δ, velocities v and
/// inputs u, and its state at the beginning of the period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case<const N: usize, const M: usize> {
    pub by_y: [[f64; N]; N],
    pub by_v: [[f64; N]; N],
    pub by_u: [[f64; M]; N],
    pub rest: [f64; N],
    /// Matrix D of `δ̇ = D δ + v` for robots with quaternions, with displacements δ and velocities v. Arms do
    /// not use it.
    pub drift: [[f64; N]; N],
    /// Displacements δ and velocities v at the beginning of the period.
    pub state: [[f64; N]; 2],
    pub input: [f64; M],
}

/// Zero-order hold of a [`Case`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Held<const N: usize, const M: usize> {
    /// State matrix A_d of the discrete-time system, row by row.
    pub state: [[[[f64; N]; 2]; N]; 2],
    /// Input matrix B_d of the discrete-time system, row by row.
    pub input: [[[f64; M]; N]; 2],
    /// Displacements δ and velocities v at the end of the period.
    pub next: [[f64; N]; 2],
    /// False if the robot is too fast or not finite. The other fields are then undefined.
    pub is_finite: bool,
}

impl<const N: usize, const M: usize> Case<N, M> {
    pub const ZERO: Self = Self {
        by_y: [[0.0; N]; N],
        by_v: [[0.0; N]; N],
        by_u: [[0.0; M]; N],
        rest: [0.0; N],
        drift: [[0.0; N]; N],
        state: [[0.0; N]; 2],
        input: [0.0; M],
    };
}

impl<const N: usize, const M: usize> Held<N, M> {
    pub const ZERO: Self = Self {
        state: [[[[0.0; N]; 2]; N]; 2],
        input: [[[0.0; M]; N]; 2],
        next: [[0.0; N]; 2],
        is_finite: true,
    };
}

/// A column with N entries, one vector for each entry.
type Column<V, const N: usize> = Blocks<V, N, 1, 1>;

/// Memory of the method. The comments of `discrete_time::zero_order_hold` in gelenk-kernels have the equations of the
/// method. This version has two differences. First, products are fused if the vector instructions have fused
/// multiply-add. Second, the Taylor polynomial has degree 11 instead of 17 if the norms of A⁴ and A⁵ prove that this
/// degree is enough (Al-Mohy and Higham, SIAM J. Matrix Anal. Appl. 31, 2009, theorem 4.2).
#[derive(Debug, Clone)]
pub(super) struct Batch<V, const N: usize, const M: usize> {
    by_y: Blocks<V, N, 1, N>,
    by_v: Blocks<V, N, 1, N>,
    by_u: Blocks<V, N, 1, M>,
    rest: Column<V, N>,
    drift: Blocks<V, N, 1, N>,
    from: [Column<V, N>; 2],
    u: [V; M],
    /// Upper halves of the powers of A h, with the system matrix A and the step length h. The upper half of a
    /// power is the lower half of the previous power.
    powers: Vec<Half<V, N>>,
    /// Upper half of the integral Φ of the matrix exponential.
    integral: Half<V, N>,
    spare: [Half<V, N>; 3],
    change: [Half<V, N>; 2],
    input: [Blocks<V, N, 1, M>; 2],
    affine: [Column<V, N>; 2],
    held: [Held<N, M>; WIDTH],
}

impl<V: Vector, const N: usize, const M: usize> Batch<V, N, M> {
    pub fn new() -> Self {
        const { assert!(V::WIDTH == WIDTH, "each lane has one robot") };
        let (zero, column) = ([[[V::zero(); N]; 2]; N], [[[V::zero()]]; N]);
        let (square, by_u) = ([[[V::zero(); N]]; N], [[[V::zero(); M]]; N]);
        Self {
            by_y: square,
            by_v: square,
            by_u,
            rest: column,
            drift: square,
            from: [column; 2],
            u: [V::zero(); M],
            powers: vec![zero; TERMS + 2],
            integral: zero,
            spare: [zero; 3],
            change: [zero; 2],
            input: [by_u; 2],
            affine: [column; 2],
            held: [Held::ZERO; WIDTH],
        }
    }

    /// Computes the holds of up to `WIDTH` cases over `period` (s). Further cases are ignored.
    ///
    /// - `turns`: whether the robots have quaternions. Only then the matrix D ([`Case::drift`]) is used.
    pub fn hold(&mut self, cases: &[Case<N, M>], turns: bool, period: f64) -> &[Held<N, M>; WIDTH] {
        if let Some(last) = cases.len().min(WIDTH).checked_sub(1) {
            let cases = core::array::from_fn(|lane| &cases[lane.min(last)]);
            vectorized!(V, { self.compute(cases, turns, period) });
        }
        &self.held
    }

    #[inline(always)]
    fn compute(&mut self, cases: [&Case<N, M>; WIDTH], turns: bool, period: f64) {
        self.load(cases);
        if turns {
            self.turn_rates(cases);
        }
        let halvings = self.halvings(period);
        let counts = halvings.map(Option::unwrap_or_default);
        let repetitions = counts.map(|count| count.saturating_sub(MOST_DOUBLINGS));
        let h = of_lanes(counts.map(|count| period / (1_u32 << count) as f64));
        self.set_integral(h);
        self.double_integral(counts.map(|count| count.min(MOST_DOUBLINGS)));
        self.set_changes(h);
        self.double_steps(repetitions);
        for half in 0..2 {
            for i in 0..N {
                self.change[half][i][half][i] += V::one();
            }
        }
        if turns {
            self.turn_back();
        }
        self.store();
        let zeros = [self.zero_if_finite()];
        for (lane, halvings) in halvings.iter().enumerate() {
            self.held[lane].is_finite = halvings.is_some() && flat(&zeros)[lane] == 0.0;
        }
    }

    #[inline(always)]
    fn load(&mut self, cases: [&Case<N, M>; WIDTH]) {
        pack(entries_mut(&mut self.by_y), cases.map(|case| case.by_y.as_flattened()));
        pack(entries_mut(&mut self.by_v), cases.map(|case| case.by_v.as_flattened()));
        pack(entries_mut(&mut self.by_u), cases.map(|case| case.by_u.as_flattened()));
        pack(entries_mut(&mut self.rest), cases.map(|case| &case.rest[..]));
        for half in 0..2 {
            pack(entries_mut(&mut self.from[half]), cases.map(|case| &case.state[half][..]));
        }
        pack(&mut self.u, cases.map(|case| &case.input[..]));
    }

    /// Replaces the velocities v of the robot by the rates `D δ + v` of its displacements δ: `A_y ← A_y − A_v
    /// D`, `A_v ← A_v + D`.
    #[inline(always)]
    fn turn_rates(&mut self, cases: [&Case<N, M>; WIDTH]) {
        pack(entries_mut(&mut self.drift), cases.map(|case| case.drift.as_flattened()));
        let of_v = &mut self.spare[0];
        let mut negative = self.drift;
        for i in 0..N {
            for j in 0..N {
                of_v[i][1][j] = self.by_v[i][0][j];
                self.by_v[i][0][j] += self.drift[i][0][j];
                negative[i][0][j] = -self.drift[i][0][j];
            }
        }
        let start = self.by_y;
        sum(&mut self.by_y, Start::Scaled(1.0, &start), of_v, &[(1, &negative)]);
    }

    /// Transforms the result from the rates back to the velocities v.
    #[inline(always)]
    fn turn_back(&mut self) {
        let [by_drift, minus, spare] = &mut self.spare;
        for i in 0..N {
            for j in 0..N {
                by_drift[i][0][j] = self.drift[i][0][j];
                by_drift[i][1][j] = V::zero();
                minus[i][1][j] = -self.drift[i][0][j];
            }
        }
        for half in &mut self.change {
            sum(spare, Start::Scaled(1.0, half), half, &[(1, by_drift)]);
            core::mem::swap(half, spare);
        }
        let [upper, lower] = &mut self.change;
        sum(spare, Start::Scaled(1.0, lower), minus, &[(1, upper)]);
        core::mem::swap(lower, spare);
        let start = self.input[1];
        let [upper, lower] = &mut self.input;
        sum(lower, Start::Scaled(1.0, &start), minus, &[(1, upper)]);
        let start = self.affine[1];
        let [upper, lower] = &mut self.affine;
        sum(lower, Start::Scaled(1.0, &start), minus, &[(1, upper)]);
    }

    /// Number of halvings of the period for the robot of each lane; `None` if the robot is too fast.
    #[inline(always)]
    fn halvings(&self, period: f64) -> [Option<u32>; WIDTH] {
        let (a, b) = ([norm(&self.by_y)], [norm(&self.by_v)]);
        core::array::from_fn(|lane| halvings(flat(&a)[lane], flat(&b)[lane], period))
    }

    /// Computes the integral Φ of the matrix exponential over the step length h of each lane. Here the second
    /// half of the state is h ẏ.
    #[inline(always)]
    fn set_integral(&mut self, h: V) {
        let square = h * h;
        for i in 0..N {
            for j in 0..N {
                self.powers[2][i][0][j] = square * self.by_y[i][0][j];
                self.powers[2][i][1][j] = h * self.by_v[i][0][j];
            }
        }
        for k in 2..=TERMS {
            let (known, next) = self.powers.split_at_mut(k + 1);
            sum(&mut next[0], Start::Shifted(&known[k]), &known[k], &[(1, &known[2])]);
        }
        let (left, right) = (&self.powers[TERMS], &self.powers[TERMS + 1]);
        let ([first, second, third], middle) = (&mut self.spare, &mut self.change[0]);
        let needed = needs_third_part(&self.powers);
        if largest(needed) > 0.0 {
            combine(&self.powers, COEFFICIENTS.each_ref(), [first, middle, third]);
            for entry in entries_mut(third) {
                *entry = V::select_positive(needed, *entry, V::zero());
            }
            sum(second, Start::Scaled(1.0, middle), third, &[(0, left), (1, right)]);
        } else {
            combine(&self.powers, [&COEFFICIENTS[0], &COEFFICIENTS[1]], [first, second]);
        }
        sum(&mut self.integral, Start::Scaled(1.0, first), second, &[(0, left), (1, right)]);
    }

    /// Computes the integral Φ of the matrix exponential over 2ᵏ times the step length, with k = `counts` for
    /// each lane.
    #[inline(always)]
    fn double_integral(&mut self, counts: [u32; WIDTH]) {
        let [change, other, _] = &mut self.spare;
        let (mut integral, mut next) = (&mut self.integral, other);
        let most = counts.into_iter().max().unwrap_or(0);
        for done in 0..most {
            sum(change, Start::Shifted(integral), integral, &[(1, &self.powers[2])]);
            sum(next, Start::Scaled(2.0, integral), change, &[(0, &*integral), (1, &*change)]);
            keep_done(entries_mut(next), entries(integral), counts, done);
            core::mem::swap(&mut integral, &mut next);
        }
        if most % 2 == 1 {
            *next = *integral;
        }
    }

    /// Computes `A_d − 1`, `B_d` and `c_d` of the discrete-time system from the integral of the matrix
    /// exponential.
    #[inline(always)]
    fn set_changes(&mut self, h: V) {
        let (system, [upper, lower], integral) = (&mut self.spare[0], &mut self.change, &mut self.integral);
        let square = h * h;
        sum(upper, Start::Shifted(integral), integral, &[(1, &self.powers[2])]);
        for i in 0..N {
            for j in 0..N {
                system[i][0][j] = h * self.by_y[i][0][j];
                system[i][1][j] = h * self.by_v[i][0][j];
            }
        }
        sum(lower, Start::Shifted(upper), upper, &[(1, system)]);
        for i in 0..N {
            for j in 0..N {
                upper[i][1][j] = h * upper[i][1][j];
                integral[i][1][j] = square * integral[i][1][j];
            }
        }
        for (half, by_acceleration) in [&*integral, &*upper].into_iter().enumerate() {
            sum(&mut self.input[half], Start::Zero, by_acceleration, &[(1, &self.by_u)]);
            sum(&mut self.affine[half], Start::Zero, by_acceleration, &[(1, &self.rest)]);
        }
    }

    /// Computes `A_d − 1`, `B_d` and `c_d` of the discrete-time system over 2ᵏ times the step length, with k
    /// = `counts` for each lane.
    #[inline(always)]
    fn double_steps(&mut self, counts: [u32; WIDTH]) {
        for done in 0..counts.into_iter().max().unwrap_or(0) {
            let (change, input, affine) = (self.change, self.input, self.affine);
            for half in 0..2 {
                let by = &change[half];
                let pairs = [(0, &input[0]), (1, &input[1])];
                sum(&mut self.input[half], Start::Scaled(2.0, &input[half]), by, &pairs);
                keep_done(entries_mut(&mut self.input[half]), entries(&input[half]), counts, done);
                let pairs = [(0, &affine[0]), (1, &affine[1])];
                sum(&mut self.affine[half], Start::Scaled(2.0, &affine[half]), by, &pairs);
                keep_done(entries_mut(&mut self.affine[half]), entries(&affine[half]), counts, done);
                let pairs = [(0, &change[0]), (1, &change[1])];
                sum(&mut self.change[half], Start::Scaled(2.0, by), by, &pairs);
                keep_done(entries_mut(&mut self.change[half]), entries(by), counts, done);
            }
        }
    }

    /// Writes the results. They contain the state at the end of the period instead of the affine term c_d.
    #[inline(always)]
    fn store(&mut self) {
        for half in 0..2 {
            let mut next = self.affine[half];
            let by = [(0, &self.from[0]), (1, &self.from[1])];
            sum(&mut next, Start::Scaled(1.0, &self.affine[half]), &self.change[half], &by);
            for i in 0..N {
                for j in 0..M {
                    next[i][0][0] = self.input[half][i][0][j].mul_add(self.u[j], next[i][0][0]);
                }
            }
            self.affine[half] = next;
            let held = &mut self.held;
            unpack(
                entries(&self.change[half]),
                held.each_mut().map(|held| entries_mut(&mut held.state[half])),
            );
            unpack(
                entries(&self.input[half]),
                held.each_mut().map(|held| held.input[half].as_flattened_mut()),
            );
            unpack(entries(&next), held.each_mut().map(|held| &mut held.next[half][..]));
        }
    }

    /// Zero in lanes whose results are finite, NaN in the other lanes.
    #[inline(always)]
    fn zero_if_finite(&self) -> V {
        let mut sum = V::zero();
        for half in 0..2 {
            for i in 0..N {
                sum += zero_if_finite(self.change[half][i].as_flattened());
                sum += zero_if_finite(&self.input[half][i][0]);
            }
            sum += zero_if_finite(entries(&self.affine[half]));
        }
        sum
    }
}

/// Zero in lanes in which all numbers are finite, NaN in the other lanes.
#[inline(always)]
fn zero_if_finite<V: Vector>(numbers: &[V]) -> V {
    let mut sum = V::zero();
    for number in numbers {
        sum = number.mul_add(V::zero(), sum);
    }
    sum
}

/// 1 in lanes in which `‖A⁴‖^¼` or `‖A⁵‖^⅕` of the system matrix A times the step length exceeds
/// [`OF_TWO_PARTS`], 0 in the other lanes.
#[inline(always)]
fn needs_third_part<V: Vector, const N: usize>(powers: &[Half<V, N>]) -> V {
    let (fourth, fifth, sixth) = (norm(&powers[4]), norm(&powers[5]), norm(&powers[6]));
    let square = OF_TWO_PARTS * OF_TWO_PARTS;
    let most = [square * square, square * square * OF_TWO_PARTS].map(V::splat);
    // The lower half of a power is the upper half of the next power.
    let excess = (fourth.fast_max(fifth) - most[0]).fast_max(fifth.fast_max(sixth) - most[1]);
    V::select_positive(excess, V::one(), V::zero())
}

/// Restores the entries of lanes whose step already has its full length after `done` doublings.
#[inline(always)]
fn keep_done<V: Vector>(new: &mut [V], old: &[V], counts: [u32; WIDTH], done: u32) {
    if counts.iter().all(|count| *count > done) {
        return;
    }
    let goes_on = of_lanes(counts.map(|count| f64::from(u8::from(count > done))));
    for (new, old) in new.iter_mut().zip(old) {
        *new = V::select_positive(goes_on, *new, *old);
    }
}

/// The vector with these numbers.
#[inline(always)]
fn of_lanes<V: Vector>(numbers: [f64; WIDTH]) -> V {
    let mut vector = V::zero();
    flat_mut(core::slice::from_mut(&mut vector)).copy_from_slice(&numbers);
    vector
}

/// Computes the sums `Σ c_k Aᵏ` over the terms of each part of the Taylor polynomial in the system matrix A,
/// with the coefficients c_k.
#[inline(always)]
fn combine<V: Vector, const N: usize, const P: usize>(
    powers: &[Half<V, N>],
    coefficients: [&[f64; TERMS]; P],
    sums: [&mut Half<V, N>; P],
) {
    for i in 0..N {
        for block in 0..2 {
            for j in 0..N {
                let mut entry = [V::zero(); P];
                for k in 2..TERMS {
                    let power = powers[k][i][block][j];
                    for part in 0..P {
                        entry[part] = power.mul_add(V::splat(coefficients[part][k]), entry[part]);
                    }
                }
                for part in 0..P {
                    sums[part][i][block][j] = entry[part];
                }
            }
            for part in 0..P {
                sums[part][i][block][i] += V::splat(coefficients[part][block]);
            }
        }
    }
}

/// Maximum norm: largest sum of the magnitudes in a row.
#[inline(always)]
fn norm<V: Vector, const N: usize, const B: usize>(blocks: &Blocks<V, N, B, N>) -> V {
    let mut largest = V::zero();
    for row in blocks {
        let mut sum = V::zero();
        for entry in row.as_flattened() {
            sum += entry.abs();
        }
        largest = largest.fast_max(sum);
    }
    largest
}
