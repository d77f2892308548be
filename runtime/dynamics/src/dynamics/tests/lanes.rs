//! Tests of the linearization by functions for eight states. The modules are generated modules, and two modules whose functions for
//! eight states call the function for one state.

use super::super::*;
use core::sync::atomic::{AtomicUsize, Ordering};

crate::dynamics!(struct PowerCube = gelenk_generated::powercube);
crate::dynamics!(struct Ur5 = gelenk_generated::ur5);

mod pendulum {
    pub use gelenk_generated::double_pendulum::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    pub static CALLS: AtomicUsize = AtomicUsize::new(0);

    #[derive(Clone, Copy)]
    pub struct Lanes(pub [f64; 8]);

    #[allow(clippy::too_many_arguments)]
    fn lanes(
        y: &[Lanes; N],
        v: &[Lanes; N],
        u: &[Lanes; M],
        p: &Parameters,
        a_y: &mut [[Lanes; N]; N],
        a_v: &mut [[Lanes; N]; N],
        b_x: &mut [[Lanes; M]; N],
        c: &mut [Lanes; N],
    ) {
        CALLS.fetch_add(1, Ordering::Relaxed);
        for lane in 0..8 {
            let one = linearize(&y.map(|y| y.0[lane]), &v.map(|v| v.0[lane]), &u.map(|u| u.0[lane]), p);
            for i in 0..N {
                (0..N).for_each(|j| (a_y[i][j].0[lane], a_v[i][j].0[lane]) = (one.0[i][j], one.1[i][j]));
                (0..M).for_each(|j| b_x[i][j].0[lane] = one.2[i][j]);
                c[i].0[lane] = one.3[i];
            }
        }
    }

    #[allow(clippy::type_complexity)]
    pub const LINEARIZE_LANES: [unsafe fn(
        &[Lanes; N],
        &[Lanes; N],
        &[Lanes; M],
        &Parameters,
        &mut [[Lanes; N]; N],
        &mut [[Lanes; N]; N],
        &mut [[Lanes; M]; N],
        &mut [Lanes; N],
    ); 3] = [lanes; 3];
}

mod flight {
    pub use gelenk_generated::quadrotor::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    pub static CALLS: AtomicUsize = AtomicUsize::new(0);

    #[derive(Clone, Copy)]
    pub struct Lanes(pub [f64; 8]);

    #[allow(clippy::too_many_arguments)]
    fn lanes(
        y: &[Lanes; NY],
        v: &[Lanes; N],
        u: &[Lanes; M],
        a_y: &mut [[Lanes; N]; N],
        a_v: &mut [[Lanes; N]; N],
        b_x: &mut [[Lanes; M]; N],
        c: &mut [Lanes; N],
        _: &mut [[Lanes; N]; N],
    ) {
        CALLS.fetch_add(1, Ordering::Relaxed);
        for lane in 0..8 {
            let one = linearize(&y.map(|y| y.0[lane]), &v.map(|v| v.0[lane]), &u.map(|u| u.0[lane]));
            for i in 0..N {
                (0..N).for_each(|j| (a_y[i][j].0[lane], a_v[i][j].0[lane]) = (one.0[i][j], one.1[i][j]));
                (0..M).for_each(|j| b_x[i][j].0[lane] = one.2[i][j]);
                c[i].0[lane] = one.3[i];
            }
        }
    }

    #[allow(clippy::type_complexity)]
    pub const LINEARIZE_LANES: [unsafe fn(
        &[Lanes; NY],
        &[Lanes; N],
        &[Lanes; M],
        &mut [[Lanes; N]; N],
        &mut [[Lanes; N]; N],
        &mut [[Lanes; M]; N],
        &mut [Lanes; N],
        &mut [[Lanes; N]; N],
    ); 3] = [lanes; 3];
}

crate::dynamics!(struct Pendulum { parameters } = pendulum);
crate::dynamics!(struct Flight = flight);

fn instructions() -> Vec<Instructions> {
    let mut all = vec![Instructions::ANY];
    #[cfg(target_arch = "x86_64")]
    {
        if std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            all.push(unsafe { Instructions::avx2() });
        }
        if std::is_x86_feature_detected!("avx512bw")
            && std::is_x86_feature_detected!("avx512dq")
            && std::is_x86_feature_detected!("avx512vl")
        {
            // SAFETY: the processor has these instructions.
            all.push(unsafe { Instructions::avx512() });
        }
    }
    all
}

/// Asserts that results of batches equal those of single points bit for bit, also for partial batches and all instructions. Counts
/// the calls of functions for eight states.
fn has_the_bits_of_one_by_one<D, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    calls: &AtomicUsize,
) -> usize
where
    D: Differentiable<N, M, NY>,
{
    let before = calls.load(Ordering::Relaxed);
    for count in [0, 1, 2, 3, 8, 20, 21] {
        let points: Vec<Point<N, M, NY>> = (0..count)
            .map(|k| {
                let share = |i: usize, factor: f64| (factor * (k + 3 * i) as f64).sin();
                let positions = robot.integrate(&robot.neutral(), &core::array::from_fn(|i| share(i, 0.7)));
                let velocities = core::array::from_fn(|i| share(i, 1.3));
                Point { time: 0.0, positions, velocities, inputs: core::array::from_fn(|i| share(i, 0.4)) }
            })
            .collect();
        for instructions in instructions() {
            let mut results = vec![Linearization::ZERO; count + 1];
            robot.linearize_along(instructions, &points, &mut results);
            for (point, result) in points.iter().zip(&results) {
                let one = robot.linearize(&point.positions, &point.velocities, &point.inputs);
                assert_eq!(*result, one, "{instructions:?}");
            }
            assert_eq!(results[count], Linearization::ZERO, "nothing is written after the last point");
        }
    }
    calls.load(Ordering::Relaxed) - before
}

#[test]
fn linearizations_over_lanes_have_the_bits_of_single_ones() {
    let none = AtomicUsize::new(0);
    has_the_bits_of_one_by_one(&PowerCube, &none);
    has_the_bits_of_one_by_one(&Ur5, &none);
    let mut heavier = Pendulum::default();
    heavier.parameters.m2 *= 2.0;
    // One call is expected for 3 and for 8 points, and three calls for 20 and for 21 points.
    let expected = 8 * instructions().len();
    assert_eq!(has_the_bits_of_one_by_one(&heavier, &pendulum::CALLS), expected);
    assert_eq!(has_the_bits_of_one_by_one(&Flight, &flight::CALLS), expected);
}

/// A wrapper without functions for eight states is linearized point by point.
#[test]
fn other_robots_are_linearized_at_their_times() {
    struct Timed(f64);

    impl Dynamics<2, 2> for Timed {
        fn at_time<R>(&self, time: f64, f: impl FnOnce(&Self) -> R) -> R {
            f(&Self(time))
        }
        fn limits(&self) -> Limits<2, 2> {
            PowerCube.limits()
        }
        fn mass_matrix(&self, y: &[f64; 2]) -> [[f64; 2]; 2] {
            PowerCube.mass_matrix(y)
        }
        fn coriolis_forces(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
            PowerCube.coriolis_forces(y, v)
        }
        fn gravity_forces(&self, y: &[f64; 2]) -> [f64; 2] {
            PowerCube.gravity_forces(y)
        }
        fn spring_forces(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
            PowerCube.spring_forces(y, v)
        }
        fn friction_torques(&self, y: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
            PowerCube.friction_torques(y, v)
        }
        fn friction_jumps(&self) -> &'static [[usize; 2]] {
            PowerCube.friction_jumps()
        }
        fn input_matrix(&self, y: &[f64; 2]) -> [[f64; 2]; 2] {
            PowerCube.input_matrix(y)
        }
    }

    impl Differentiable<2, 2> for Timed {
        fn inverse_dynamics_derivatives(
            &self,
            y: &[f64; 2],
            v: &[f64; 2],
            a: &[f64; 2],
        ) -> ForceDerivatives<2> {
            PowerCube.inverse_dynamics_derivatives(y, v, a)
        }
        fn linearize(&self, _: &[f64; 2], _: &[f64; 2], _: &[f64; 2]) -> Linearization<2, 2> {
            Linearization { affine: [self.0; 2], ..Linearization::ZERO }
        }
    }

    let points = [0.5, 1.5, 2.5].map(|time| Point {
        time,
        positions: [0.0; 2],
        velocities: [0.0; 2],
        inputs: [0.0; 2],
    });
    let mut results = [Linearization::ZERO; 3];
    Timed(0.0).linearize_along(Instructions::ANY, &points, &mut results);
    assert_eq!(results.map(|result| result.affine[0]), [0.5, 1.5, 2.5]);
}
