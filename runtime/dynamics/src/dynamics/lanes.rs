//! Linearization at many points. If the module has functions for eight states, eight points are linearized at a time.

use super::functions::Missing;
use super::types::Linearization;

/// Number of states in one call of a function for several states (lanes).
pub(super) const LANES: usize = 8;

/// A point at which a robot is linearized.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point<const N: usize, const M: usize, const NY: usize = N> {
    /// Time (s). Only robots with driven joints depend on the time.
    pub time: f64,
    /// Positions y [rad or m].
    pub positions: [f64; NY],
    /// Velocities ẏ [rad/s or m/s].
    pub velocities: [f64; N],
    /// Inputs u [N m, N or A].
    pub inputs: [f64; M],
}

/// Vector instructions that functions for eight states can use. `gelenk_runtime::lanes::instructions()` returns the widest
/// instructions of the processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instructions(usize);

impl Instructions {
    /// The instructions of the compilation target, which every processor of this target has.
    pub const ANY: Self = Self(0);

    /// The instruction set AVX2.
    ///
    /// # Safety
    /// The processor must have AVX2.
    #[must_use]
    pub const unsafe fn avx2() -> Self {
        Self(1)
    }

    /// The instruction sets AVX-512 F, BW, DQ and VL.
    ///
    /// # Safety
    /// The processor must have these instructions.
    #[must_use]
    pub const unsafe fn avx512() -> Self {
        Self(2)
    }
}

/// Represents the type `Lanes` of a module without functions for eight states.
#[derive(Debug, Clone, Copy)]
pub struct NoLanes(pub [f64; LANES]);

/// Linearization at up to eight points by the table `LINEARIZE_LANES` of a module. The table contains the versions of `linearize`
/// for eight states. [`Missing`] implements this trait for modules without the table. L is the type of eight numbers, and P is the
/// type of the free parameters.
pub trait LinearizeLanes<L, P, const N: usize, const M: usize, const NY: usize> {
    /// Linearizes at up to eight points. Returns false if the module has no function for this.
    fn linearize(
        &self,
        instructions: Instructions,
        parameters: P,
        of: impl Fn([f64; LANES]) -> L,
        numbers: impl Fn(&L) -> &[f64; LANES],
        points: &[Point<N, M, NY>],
        results: &mut [Linearization<N, M, NY>],
    ) -> bool;
}

impl<L, P, const N: usize, const M: usize, const NY: usize> LinearizeLanes<L, P, N, M, NY> for Missing {
    fn linearize(
        &self,
        _: Instructions,
        _: P,
        _: impl Fn([f64; LANES]) -> L,
        _: impl Fn(&L) -> &[f64; LANES],
        _: &[Point<N, M, NY>],
        _: &mut [Linearization<N, M, NY>],
    ) -> bool {
        false
    }
}

/// Writes one number to each result.
#[inline]
fn scatter<T>(numbers: &[f64; LANES], results: &mut [T], entry: impl Fn(&mut T) -> &mut f64) {
    for (number, result) in numbers.iter().zip(results) {
        *entry(result) = *number;
    }
}

type Square<L, const N: usize> = [[L; N]; N];

/// Implements the trait for tables of functions with and without parameters, and with and without the drift
/// of robots with quaternions.
macro_rules! tables {
    ($ny:ident $(, const $more:ident)?; [$($p:ident: $type:ident)?]; [$($drift:ident)?]) => {
        impl<L: Copy, $($type,)? const N: usize, const M: usize $(, const $more: usize)?>
            LinearizeLanes<L, ($(&$type,)?), N, M, $ny>
            for [unsafe fn(
                &[L; $ny], &[L; N], &[L; M], $(&$type,)?
                &mut Square<L, N>, &mut Square<L, N>, &mut [[L; M]; N], &mut [L; N] $(, &mut tables!(@drift $drift))?
            ); 3]
        {
            fn linearize(
                &self,
                instructions: Instructions,
                ($($p,)?): ($(&$type,)?),
                of: impl Fn([f64; LANES]) -> L,
                numbers: impl Fn(&L) -> &[f64; LANES],
                points: &[Point<N, M, $ny>],
                results: &mut [Linearization<N, M, $ny>],
            ) -> bool {
                let Some(last) = points.len().checked_sub(1) else { return true };
                let point = |lane: usize| &points[if lane < last { lane } else { last }];
                let y = core::array::from_fn(|i| of(core::array::from_fn(|lane| point(lane).positions[i])));
                let v = core::array::from_fn(|i| of(core::array::from_fn(|lane| point(lane).velocities[i])));
                let u = core::array::from_fn(|i| of(core::array::from_fn(|lane| point(lane).inputs[i])));
                let zero = of([0.0; LANES]);
                let (mut by_y, mut by_v, mut by_u) = ([[zero; N]; N], [[zero; N]; N], [[zero; M]; N]);
                let mut affine = [zero; N];
                $(let mut $drift = [[zero; N]; N];)?
                // SAFETY: the processor has the instructions, because the constructors of `Instructions` require this.
                unsafe {
                    self[instructions.0](
                        &y, &v, &u, $($p,)? &mut by_y, &mut by_v, &mut by_u, &mut affine $(, &mut $drift)?
                    );
                }
                for i in 0..N {
                    for j in 0..N {
                        scatter(numbers(&by_y[i][j]), results, |result| &mut result.by_coordinates[i][j]);
                        scatter(numbers(&by_v[i][j]), results, |result| &mut result.by_velocities[i][j]);
                    }
                    for j in 0..M {
                        scatter(numbers(&by_u[i][j]), results, |result| &mut result.by_inputs[i][j]);
                    }
                    scatter(numbers(&affine[i]), results, |result| &mut result.affine[i]);
                }
                true
            }
        }
    };
    (@drift $drift:ident) => { Square<L, N> };
}

tables!(N; []; []);
tables!(N; [p: P]; []);
tables!(NY, const NY; []; [drift]);
tables!(NY, const NY; [p: P]; [drift]);
