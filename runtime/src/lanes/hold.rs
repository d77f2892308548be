//! Zero-order holds of many robots with the vector instructions of this processor.

use super::batch::{Batch, Case, Held};
use crate::dynamics::{Discretization, Instructions, Linearization};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::qp::lanes::{Portable, WIDTH};
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use crate::qp::x86::{Avx2, has_avx2};

/// Returns the widest vector instructions that this processor supports, for
/// [`linearize_along`](crate::dynamics::Differentiable::linearize_along).
pub fn instructions() -> Instructions {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    {
        let with_avx512 = std::is_x86_feature_detected!("avx512f")
            && std::is_x86_feature_detected!("avx512bw")
            && std::is_x86_feature_detected!("avx512dq")
            && std::is_x86_feature_detected!("avx512vl");
        if with_avx512 {
            // SAFETY: the processor has them.
            return unsafe { Instructions::avx512() };
        }
        if std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has it.
            return unsafe { Instructions::avx2() };
        }
    }
    Instructions::ANY
}

/// Computes exact zero-order holds `x⁺ = A_d x + B_d u + c_d` of many linearized robots, four at a time.
/// Predictive controllers use these holds for the stages of a horizon. A value of this type holds the memory of
/// the method. Nothing is allocated after [`Self::new`].
///
/// Method and error bounds are those of
/// [`Discretizable::discretize`](crate::dynamics::Discretizable::discretize). The results differ from it in the
/// last digits for two reasons:
///
/// - Products are fused if the processor has AVX2 with fused multiply-add. The last digits therefore depend on the
///   processor.
/// - The Taylor polynomial is shorter if the shorter polynomial is accurate enough.
///
/// The result for one robot does not depend on the other robots.
///
/// ```
/// use gelenk_runtime::dynamics::Differentiable;
/// use gelenk_runtime::lanes::ZeroOrderHolds;
///
/// gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
///
/// let linear: [_; 20] = core::array::from_fn(|k| {
///     PowerCube.linearize(&[0.02 * k as f64, -0.3], &[0.5, 0.0], &[0.0; 2])
/// });
/// let mut held = [linear[0].discretize(0.02); 20];
/// ZeroOrderHolds::new().discretize(&linear, None, 0.02, &mut held);
/// for (held, linear) in held.iter().zip(&linear) {
///     let single = linear.discretize(0.02);
///     assert!((held.state[1][1][0][0] - single.state[1][1][0][0]).abs() < 1e-14);
/// }
/// ```
#[derive(Debug, Clone)]
pub struct ZeroOrderHolds<const N: usize, const M: usize>(Engine<N, M>);

/// The method, compiled for the vector instructions of this processor.
#[derive(Debug, Clone)]
enum Engine<const N: usize, const M: usize> {
    Portable(Box<Batch<Portable, N, M>>),
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx2(Box<Batch<Avx2, N, M>>),
}

impl<const N: usize, const M: usize> Default for ZeroOrderHolds<N, M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize, const M: usize> ZeroOrderHolds<N, M> {
    /// Selects the vector instructions and allocates all memory.
    pub fn new() -> Self {
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        if has_avx2() {
            return Self(Engine::Avx2(Box::new(Batch::new())));
        }
        Self(Engine::Portable(Box::new(Batch::new())))
    }

    /// Computes the hold of each robot over `period` (s). If a robot is too fast or its linearization is not
    /// finite, every entry of its result is +∞.
    ///
    /// - `linear`: the linearized robots
    /// - `drifts`: the matrix [`drift`](crate::dynamics::Differentiable::drift) of each robot with quaternions, see
    ///   [`Linearization::discretize_with`]; `None` for robots without quaternions
    /// - `results`: one result for each robot
    ///
    /// The three slices should have the same length. Additional elements of a longer slice are ignored.
    pub fn discretize<const NY: usize>(
        &mut self,
        linear: &[Linearization<N, M, NY>],
        drifts: Option<&[[[f64; N]; N]]>,
        period: f64,
        results: &mut [Discretization<N, M, NY>],
    ) {
        let count = linear.len().min(results.len()).min(drifts.map_or(usize::MAX, <[_]>::len));
        let mut cases = [Case::ZERO; WIDTH];
        for first in (0..count).step_by(WIDTH) {
            let of = first..count.min(first + WIDTH);
            for (case, k) in cases.iter_mut().zip(of.clone()) {
                case.set_robot(&linear[k]);
                case.drift = drifts.map_or(case.drift, |drifts| drifts[k]);
            }
            let held = self.hold(&cases[..of.len()], drifts.is_some(), period);
            for (result, held) in results[of].iter_mut().zip(held) {
                *result = held.discretization();
            }
        }
    }

    /// Computes the holds of up to `WIDTH` cases.
    ///
    /// - `turns`: whether the robots have drift matrices
    pub(crate) fn hold(&mut self, cases: &[Case<N, M>], turns: bool, period: f64) -> &[Held<N, M>; WIDTH] {
        match &mut self.0 {
            Engine::Portable(batch) => batch.hold(cases, turns, period),
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Engine::Avx2(batch) => batch.hold(cases, turns, period),
        }
    }
}

impl<const N: usize, const M: usize> Case<N, M> {
    pub fn set_robot<const NY: usize>(&mut self, linear: &Linearization<N, M, NY>) {
        self.by_y = linear.by_coordinates;
        self.by_v = linear.by_velocities;
        self.by_u = linear.by_inputs;
        self.rest = linear.affine;
    }
}

impl<const N: usize, const M: usize> Held<N, M> {
    /// The discretization of a case with the initial state 0. The final state of this case is the affine term
    /// c_d.
    fn discretization<const NY: usize>(&self) -> Discretization<N, M, NY> {
        let infinite = f64::INFINITY;
        if !self.is_finite {
            return Discretization {
                state: [[[[infinite; N]; N]; 2]; 2],
                input: [[[infinite; M]; N]; 2],
                affine: [[infinite; N]; 2],
            };
        }
        Discretization { state: self.blocks(), input: self.input, affine: self.next }
    }

    /// State matrix A_d of the discrete-time system as blocks.
    pub fn blocks(&self) -> [[[[f64; N]; N]; 2]; 2] {
        let mut blocks = [[[[0.0; N]; N]; 2]; 2];
        for half in 0..2 {
            for i in 0..N {
                for block in 0..2 {
                    blocks[half][block][i] = self.state[half][i][block];
                }
            }
        }
        blocks
    }
}
