//! Runge–Kutta steps with derivatives, for several robots at a time. Each number (lane) of a vector belongs to one robot.

mod chart;

use chart::{Bracket, Chart};

use super::hold::instructions;
use super::packed::{pack, unpack};
use super::product::{Blocks, Half, Start, entries, entries_mut, sum};
use crate::dynamics::{Discretizable, Linearization, Point, Step};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::qp::lanes::{Portable, Vector, WIDTH, vectorized};
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use crate::qp::x86::{Avx2, has_avx2};

/// Number of robots that are integrated together. One call of a function for eight states linearizes all of them.
pub(crate) const TOGETHER: usize = 8;
/// Times of the four stages of the classical Runge–Kutta method, in steps.
const TIMES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
/// Weights of the four stages.
const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Positions, velocities or accelerations, with their derivatives with respect to the initial state and to the inputs.
#[derive(Debug, Clone, Copy)]
struct Motion<V, const N: usize, const M: usize> {
    value: Blocks<V, N, 1, 1>,
    by_state: Half<V, N>,
    by_inputs: Blocks<V, N, 1, M>,
}

impl<V: Vector, const N: usize, const M: usize> Motion<V, N, M> {
    fn zero() -> Self {
        let zero = V::zero();
        Self { value: [[[zero]]; N], by_state: [[[zero; N]; 2]; N], by_inputs: [[[zero; M]]; N] }
    }

    /// Sets the derivatives to those of the initial positions (block 0) or velocities (block 1).
    #[inline(always)]
    fn begin(&mut self, block: usize) {
        self.by_state = [[[V::zero(); N]; 2]; N];
        self.by_inputs = [[[V::zero(); M]]; N];
        for i in 0..N {
            self.by_state[i][block][i] = V::one();
        }
    }

    /// Adds `factor · rate`.
    #[inline(always)]
    fn add(&mut self, factor: f64, rate: &Self) {
        let factor = V::splat(factor);
        for i in 0..N {
            add_scaled(&mut self.value[i][0], factor, &rate.value[i][0]);
            add_scaled(self.by_state[i].as_flattened_mut(), factor, rate.by_state[i].as_flattened());
            add_scaled(&mut self.by_inputs[i][0], factor, &rate.by_inputs[i][0]);
        }
    }
}

#[inline(always)]
fn add_scaled<V: Vector>(sum: &mut [V], factor: V, numbers: &[V]) {
    for (sum, number) in sum.iter_mut().zip(numbers) {
        *sum = number.mul_add(factor, *sum);
    }
}

/// Integration of four robots. Motions are pairs of positions and velocities. The positions of robots with quaternions are
/// displacements from the beginning of the step.
#[derive(Debug, Clone)]
struct Rollout<V, const N: usize, const M: usize> {
    /// Motion at the beginning of the step.
    start: [Motion<V, N, M>; 2],
    /// Motion at the present stage.
    stage: [Motion<V, N, M>; 2],
    /// Motion at the end of the step, as a sum over the stages so far.
    end: [Motion<V, N, M>; 2],
    acceleration: Motion<V, N, M>,
    /// Derivatives of the accelerations with respect to positions and velocities.
    by_state: Half<V, N>,
    u: [V; M],
    /// Positions on the manifold, for robots with quaternions.
    chart: Option<Chart<V, N, M>>,
}

impl<V: Vector, const N: usize, const M: usize> Rollout<V, N, M> {
    fn new(has_quaternions: bool) -> Self {
        let zero = Motion::zero();
        Self {
            start: [zero; 2],
            stage: [zero; 2],
            end: [zero; 2],
            acceleration: zero,
            by_state: zero.by_state,
            u: [V::zero(); M],
            chart: has_quaternions.then_some(Chart { positions: [zero; 2], rate: zero }),
        }
    }

    fn begin<const NY: usize>(&mut self, points: [&Point<N, M, NY>; WIDTH]) {
        vectorized!(V, {
            let [y, v] = &mut self.start;
            pack(entries_mut(&mut v.value), points.map(|point| &point.velocities[..]));
            pack(&mut self.u, points.map(|point| &point.inputs[..]));
            v.begin(1);
            if let Some(chart) = &mut self.chart {
                chart.begin();
            } else {
                pack(entries_mut(&mut y.value), points.map(|point| &point.positions[..]));
                y.begin(0);
            }
            (self.stage, self.end) = (self.start, self.start);
        });
    }

    /// Processes a stage of a step of length `h` (s): stage `done % 4`, if `done` stages are done since the begin. `linear`
    /// are the robots at the states of the stage.
    fn advance<const NY: usize>(&mut self, linear: [&Linearization<N, M, NY>; WIDTH], done: usize, h: f64) {
        vectorized!(V, {
            self.accelerate(linear, done == 0);
            let index = done % TIMES.len();
            let Self { start, stage: [y, v], end, acceleration, chart, .. } = self;
            let rate = match chart {
                Some(chart) if index > 0 => &chart.rate,
                _ => &*v,
            };
            end[0].add(WEIGHTS[index] * h, rate);
            end[1].add(WEIGHTS[index] * h, acceleration);
            if let Some(time) = TIMES.get(index + 1) {
                *y = start[0];
                y.add(time * h, rate);
                *v = start[1];
                v.add(time * h, acceleration);
            } else {
                (*start, self.stage) = (*end, *end);
            }
        });
    }

    /// Computes the accelerations and their derivatives by the chain rule. At the initial state the derivatives of the
    /// motion are unit matrices, which leave those of `linear`.
    #[inline(always)]
    fn accelerate<const NY: usize>(&mut self, linear: [&Linearization<N, M, NY>; WIDTH], is_initial: bool) {
        let Self { stage: [y, v], acceleration: a, by_state, u, chart, .. } = self;
        // With quaternions, the affine part refers to the displacement 0, which is the value of these positions.
        let y = chart.as_ref().map_or(&*y, |chart| &chart.positions[1]);
        for i in 0..N {
            let [by_y, by_v] = &mut by_state[i];
            pack(by_y, linear.map(|linear| &linear.by_coordinates[i][..]));
            pack(by_v, linear.map(|linear| &linear.by_velocities[i][..]));
            pack(&mut a.by_inputs[i][0], linear.map(|linear| &linear.by_inputs[i][..]));
        }
        pack(entries_mut(&mut a.value), linear.map(|linear| &linear.affine[..]));
        for i in 0..N {
            for (u, by_u) in u.iter().zip(&a.by_inputs[i][0]) {
                a.value[i][0][0] = by_u.mul_add(*u, a.value[i][0][0]);
            }
        }
        let (rest, by_inputs) = (a.value, a.by_inputs);
        sum(&mut a.value, Start::Scaled(1.0, &rest), by_state, &[(0, &y.value), (1, &v.value)]);
        if is_initial {
            a.by_state = *by_state;
            return;
        }
        sum(
            &mut a.by_inputs,
            Start::Scaled(1.0, &by_inputs),
            by_state,
            &[(0, &y.by_inputs), (1, &v.by_inputs)],
        );
        sum(&mut a.by_state, Start::Zero, by_state, &[(0, &y.by_state), (1, &v.by_state)]);
    }

    /// Writes the states of the present stage. `starts` are the positions at the beginning of the step. After the last stage
    /// the next step begins.
    fn write_states<const NY: usize>(
        &mut self,
        model: &impl Discretizable<N, M, NY>,
        bracket: &Bracket,
        starts: &mut [Point<N, M, NY>; WIDTH],
        points: &mut [Point<N, M, NY>; WIDTH],
        is_last: bool,
    ) {
        let Self { start, stage: [y, v], end, chart, .. } = self;
        if let Some(chart) = chart {
            chart.place(model, y, starts, points);
            if is_last {
                chart.continue_from(starts, points);
                [start[0], end[0]] = [Motion::zero(); 2];
            } else {
                chart.set_rate(bracket, [y, v]);
            }
        }
        vectorized!(V, {
            if chart.is_none() {
                unpack(entries(&y.value), points.each_mut().map(|point| &mut point.positions[..]));
            }
            unpack(entries(&v.value), points.each_mut().map(|point| &mut point.velocities[..]));
        });
    }

    /// Writes the state at the end of the last step and its derivatives.
    fn write_steps<const NY: usize>(
        &self,
        points: &[Point<N, M, NY>; WIDTH],
        steps: &mut [Step<N, M, NY>; WIDTH],
    ) {
        let [y, v] = &self.end;
        let y = self.chart.as_ref().map_or(y, |chart| &chart.positions[0]);
        for (step, point) in steps.iter_mut().zip(points) {
            step.coordinates = point.positions;
        }
        vectorized!(V, {
            unpack(entries(&v.value), steps.each_mut().map(|step| &mut step.velocities[..]));
            for (half, motion) in [y, v].into_iter().enumerate() {
                for i in 0..N {
                    for block in 0..2 {
                        let to = steps.each_mut().map(|step| &mut step.state[half][block][i][..]);
                        unpack(&motion.by_state[i][block], to);
                    }
                }
                let to = steps.each_mut().map(|step| step.input[half].as_flattened_mut());
                unpack(entries(&motion.by_inputs), to);
            }
        });
    }
}

/// Memory for the integration of up to [`TOGETHER`] robots.
#[derive(Debug, Clone)]
struct Group<V, const N: usize, const M: usize, const NY: usize> {
    bracket: Bracket,
    rollouts: Vec<Rollout<V, N, M>>,
    starts: Vec<Point<N, M, NY>>,
    points: Vec<Point<N, M, NY>>,
    linear: Vec<Linearization<N, M, NY>>,
    steps: Vec<Step<N, M, NY>>,
}

impl<V: Vector, const N: usize, const M: usize, const NY: usize> Group<V, N, M, NY> {
    fn new(model: &impl Discretizable<N, M, NY>) -> Self {
        const { assert!(V::WIDTH == WIDTH && TOGETHER.is_multiple_of(WIDTH), "each lane has one robot") };
        let step = Step {
            coordinates: [0.0; NY],
            velocities: [0.0; N],
            state: [[[[0.0; N]; N]; 2]; 2],
            input: [[[0.0; M]; N]; 2],
        };
        Self {
            bracket: Bracket::new(model),
            rollouts: vec![Rollout::new(N != NY); TOGETHER / WIDTH],
            starts: Vec::with_capacity(TOGETHER),
            points: Vec::with_capacity(TOGETHER),
            linear: vec![Linearization::ZERO; TOGETHER],
            steps: vec![step; TOGETHER],
        }
    }

    fn integrate(
        &mut self,
        model: &impl Discretizable<N, M, NY>,
        starts: impl Iterator<Item = Point<N, M, NY>>,
        period: f64,
        substeps: usize,
    ) -> &[Step<N, M, NY>] {
        let Self { bracket, rollouts, starts: first, points, linear, steps } = self;
        first.clear();
        first.extend(starts.take(steps.len()));
        let Some(last) = first.last() else { return &[] };
        let (count, last) = (first.len(), *last);
        // The remaining lanes repeat the last robot.
        first.resize(count.next_multiple_of(WIDTH), last);
        points.clone_from(first);
        for (rollout, points) in rollouts.iter_mut().zip(points.as_chunks().0) {
            rollout.begin(points.each_ref());
        }
        let h = period / substeps as f64;
        for substep in 0..substeps {
            for (index, time) in TIMES.iter().enumerate() {
                let done = substep * TIMES.len() + index;
                for (point, start) in points.iter_mut().zip(&*first) {
                    point.time = start.time + (substep as f64 + time) * h;
                }
                model.linearize_along(instructions(), &points[..count], linear);
                let groups = first.as_chunks_mut().0.iter_mut().zip(points.as_chunks_mut().0);
                for ((rollout, linear), (starts, points)) in
                    rollouts.iter_mut().zip(linear.as_chunks().0).zip(groups)
                {
                    rollout.advance(linear.each_ref(), done, h);
                    rollout.write_states(model, bracket, starts, points, index + 1 == TIMES.len());
                }
            }
        }
        let groups = points.as_chunks().0.iter().zip(steps.as_chunks_mut().0);
        for (rollout, (points, steps)) in rollouts.iter().zip(groups) {
            rollout.write_steps(points, steps);
        }
        &steps[..count]
    }
}

/// Integrates several robots by the classical Runge–Kutta method of order 4, and computes the derivatives by the chain rule over
/// the stages. For robots with quaternions it is the method of Munthe-Kaas. Nothing is allocated after [`Self::new`].
///
/// The results differ from those of [`Discretizable::step_derivatives`] by rounding, because products are fused if the
/// processor has AVX2 with fused multiply-add.
#[derive(Debug, Clone)]
pub(crate) struct Rollouts<const N: usize, const M: usize, const NY: usize>(Engine<N, M, NY>);

/// The method, compiled for the vector instructions of this processor.
#[derive(Debug, Clone)]
enum Engine<const N: usize, const M: usize, const NY: usize> {
    Portable(Group<Portable, N, M, NY>),
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx2(Group<Avx2, N, M, NY>),
}

impl<const N: usize, const M: usize, const NY: usize> Rollouts<N, M, NY> {
    /// Selects the vector instructions and allocates all memory.
    pub fn new(model: &impl Discretizable<N, M, NY>) -> Self {
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        if has_avx2() {
            return Self(Engine::Avx2(Group::new(model)));
        }
        Self(Engine::Portable(Group::new(model)))
    }

    /// Integrates from up to [`TOGETHER`] states, over a period (s) in `parts` parts, each with the number of steps of
    /// [`Discretizable::SUBSTEPS`]. Further states are ignored.
    pub fn integrate<D: Discretizable<N, M, NY>>(
        &mut self,
        model: &D,
        starts: impl Iterator<Item = Point<N, M, NY>>,
        period: f64,
        parts: usize,
    ) -> &[Step<N, M, NY>] {
        let substeps = parts * D::SUBSTEPS;
        match &mut self.0 {
            Engine::Portable(group) => group.integrate(model, starts, period, substeps),
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Engine::Avx2(group) => group.integrate(model, starts, period, substeps),
        }
    }
}
