//! Builds predictive controllers as a shared library with a C interface, so that whole control steps can be compared with solvers
//! in other languages. `tests/bench/acados.sh` builds and loads the library.
//!
//! The problems are those of the benchmark `control_step`: motions of PowerCube, UR5 and Panda from rest to rest, in which input
//! limits are active. All arrays of the interface are stored row by row.

use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::{Discretizable, Predictable};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::lqr::Lqr;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};
use std::error::Error;
use std::ffi::{c_int, c_void};
use std::slice::{from_raw_parts, from_raw_parts_mut};
use std::time::Instant;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube: Discretizable []);
gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda: Discretizable []);
gelenk_runtime::dynamics!(struct Ur5 = gelenk_generated::ur5: Discretizable []);

const PERIOD: f64 = 0.02;
const HORIZON: usize = 20;
/// Number of intervals of the motion at whose ends terminal weights are computed, as in the controllers.
const TERMINAL_INTERVALS: usize = 32;

/// Interface to a controller of one robot.
trait Contender {
    /// Number of coordinates and of inputs.
    fn sizes(&self) -> [usize; 2];
    /// Number of Runge–Kutta steps in a period, and duration of the motion (s).
    fn course(&self) -> [f64; 2];
    /// Weights of states and inputs, lowest and highest inputs and states, penalties.
    fn settings(&self) -> Vec<f64>;
    /// Desired states and inputs over the horizon from a time on, and the weight at its end.
    fn reference(&self, time: f64) -> Vec<f64>;
    /// The state after a period.
    fn plant(&self, state: &[f64], inputs: &[f64]) -> Vec<f64>;
    /// The inputs of a period and the computing time (s); `None` if the controller fails.
    fn step(&mut self, time: f64, state: &[f64], last: &[f64]) -> Option<(Vec<f64>, f64)>;
}

struct Contest<D, C, const N: usize, const M: usize> {
    model: D,
    motion: RestToRest<N>,
    options: MpcOptions<N, M>,
    terminal: Vec<Vec<f64>>,
    controller: C,
    is_running: bool,
}

fn array<const L: usize>(from: &[f64]) -> [f64; L] {
    core::array::from_fn(|i| from[i])
}

/// Number of Runge–Kutta steps in a period, as in the controllers.
fn substeps<D: Discretizable<N, M>, const N: usize, const M: usize>(
    model: &D,
    motion: &RestToRest<N>,
    forward: &FeedForward<D, N, M>,
) -> f64 {
    let norm = |a: &[[f64; N]; N]| a.iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max);
    let times = (0..=TERMINAL_INTERVALS).map(|k| motion.duration() * k as f64 / TERMINAL_INTERVALS as f64);
    let needed = times.flat_map(|time| {
        let sample = motion.sample(time);
        let inputs = forward.at(&sample).inputs;
        [sample.velocities, [0.0; N]].map(|v| {
            let linear = model.linearize(&sample.positions, &v, &inputs);
            let (a, b): (f64, f64) = (norm(&linear.by_coordinates), norm(&linear.by_velocities));
            (PERIOD * 0.5 * (b + (b * b + 4.0 * a).sqrt()) / 2.5).ceil().max(1.0)
        })
    });
    needed.fold(1.0, f64::max)
}

/// Terminal weights P at equidistant times of the motion.
fn terminal<D, const N: usize, const M: usize, const NX: usize>(
    model: &D,
    motion: &RestToRest<N>,
    options: &MpcOptions<N, M>,
) -> Result<Vec<Vec<f64>>, Box<dyn Error>>
where
    D: Predictable<N, M, NX> + Copy,
{
    let forward = FeedForward::new(*model)?;
    let (mut q, mut r) = ([[0.0; NX]; NX], [[0.0; M]; M]);
    for i in 0..N {
        (q[i][i], q[N + i][N + i]) = (options.position_weight[i], options.velocity_weight[i]);
    }
    for i in 0..M {
        r[i][i] = options.input_weight[i];
    }
    let weight = |k: usize| -> Result<Vec<f64>, Box<dyn Error>> {
        let sample = motion.sample(motion.duration() * k as f64 / TERMINAL_INTERVALS as f64);
        let inputs = forward.at(&sample).inputs;
        let discrete = model.discretize(&sample.positions, &sample.velocities, &inputs, PERIOD);
        let (mut a, mut b) = ([[0.0; NX]; NX], [[0.0; M]; NX]);
        for row in 0..NX {
            for column in 0..NX {
                a[row][column] = discrete.state[row / N][column / N][row % N][column % N];
            }
            b[row] = discrete.input[row / N][row % N];
        }
        Ok(Lqr::new(&a, &b, &q, &r)?.cost_to_go.as_flattened().to_vec())
    };
    (0..=TERMINAL_INTERVALS).map(weight).collect()
}

impl<D, C, const N: usize, const M: usize> Contender for Contest<D, C, N, M>
where
    D: Discretizable<N, M> + Copy,
    C: Controller<N, M>,
{
    fn sizes(&self) -> [usize; 2] {
        [N, M]
    }

    fn course(&self) -> [f64; 2] {
        let steps = FeedForward::new(self.model).map(|forward| substeps(&self.model, &self.motion, &forward));
        [steps.unwrap_or(f64::NAN), self.motion.duration()]
    }

    fn settings(&self) -> Vec<f64> {
        let options = &self.options;
        let [low, high] = [0, 1].map(|side| options.input_limits.map(|limits| limits[side]));
        let [least, most] = [0, 1].map(|side| options.position_limits.map(|limits| limits[side]));
        let (speed, penalty) = (options.velocity_limits, options.limit_penalty);
        let weights =
            [&options.position_weight[..], &options.velocity_weight, &options.input_weight].concat();
        let states = [least, speed.map(|v| -v), most, speed].concat();
        [weights, low.to_vec(), high.to_vec(), states, vec![penalty.linear, penalty.quadratic]].concat()
    }

    fn reference(&self, time: f64) -> Vec<f64> {
        let Ok(forward) = FeedForward::new(self.model) else { return vec![] };
        let at = |k: f64| self.motion.sample(time + k * PERIOD);
        let states = (0..=HORIZON).flat_map(|k| {
            let sample = at(k as f64);
            [sample.positions, sample.velocities].concat()
        });
        let inputs = (0..HORIZON).flat_map(|k| forward.at(&at(k as f64 + 0.5)).inputs);
        let share = ((time + HORIZON as f64 * PERIOD) / self.motion.duration()).clamp(0.0, 1.0);
        let terminal = &self.terminal[(share * TERMINAL_INTERVALS as f64).round() as usize];
        states.chain(inputs).chain(terminal.iter().copied()).collect()
    }

    fn plant(&self, state: &[f64], inputs: &[f64]) -> Vec<f64> {
        const STEPS: usize = 12;
        let mut state = (array(&state[..N]), array(&state[N..]));
        for _ in 0..STEPS {
            state = self.model.step(&state.0, &state.1, &array(inputs), PERIOD / STEPS as f64);
        }
        [state.0, state.1].concat()
    }

    fn step(&mut self, time: f64, state: &[f64], last: &[f64]) -> Option<(Vec<f64>, f64)> {
        let positions = array(&state[..N]);
        let last_inputs = array(last);
        if !self.is_running {
            self.controller.reset(&positions, &last_inputs);
        }
        let periods = u32::from(self.is_running);
        let cycle = Cycle { time, periods, positions: Some(positions), last_inputs, ..Cycle::default() };
        self.is_running = true;
        let begin = Instant::now();
        let command = self.controller.step(&cycle).ok()?;
        Some((command.inputs.to_vec(), begin.elapsed().as_secs_f64()))
    }
}

fn contest<D, const N: usize, const M: usize, const NX: usize>(
    model: D,
    motion: RestToRest<N>,
    most: [f64; M],
    is_nonlinear: bool,
) -> Result<Box<dyn Contender>, Box<dyn Error>>
where
    D: Predictable<N, M, NX> + Copy + 'static,
{
    let mut options = MpcOptions::new(&model, PERIOD, HORIZON);
    options.input_limits = most.map(|u| [-u, u]);
    // The other solvers do not estimate disturbances.
    options.observer.disturbance_noise = [0.0; M];
    let terminal = terminal::<D, N, M, NX>(&model, &motion, &options)?;
    let is_running = false;
    Ok(if is_nonlinear {
        let controller = Nmpc::<D, _, N, M, NX>::new(model, motion, options.clone())?;
        Box::new(Contest { model, motion, options, terminal, controller, is_running })
    } else {
        let controller = LtvMpc::<D, _, N, M, NX>::new(model, motion, options.clone())?;
        Box::new(Contest { model, motion, options, terminal, controller, is_running })
    })
}

fn contender(robot: c_int, is_nonlinear: bool) -> Result<Box<dyn Contender>, Box<dyn Error>> {
    match robot {
        0 => {
            let motion = RestToRest::new([-0.8, -1.0], [0.6, 0.9], 3.0)?;
            contest(PowerCube, motion, [0.4; 2], is_nonlinear)
        }
        1 => {
            let (start, end) = ([0.0, -1.2, 1.0, -0.5, 0.5, 0.0], [1.0, -0.6, 1.6, -1.2, 1.0, 0.8]);
            let motion = RestToRest::new(start, end, 0.5)?;
            contest(Ur5, motion, [25.0, 60.0, 25.0, 4.0, 2.0, 1.0], is_nonlinear)
        }
        2 => {
            let start = [0.0, -0.8, 0.0, -2.2, 0.0, 1.5, 0.8];
            let motion = RestToRest::new(start, [1.0, 0.3, -0.6, -1.2, 0.7, 2.3, -0.4], 1.0)?;
            contest(Panda, motion, [25.0, 60.0, 20.0, 25.0, 4.0, 3.0, 1.5], is_nonlinear)
        }
        _ => Err("there is no such robot".into()),
    }
}

/// Creates a linear or nonlinear controller of PowerCube (0), UR5 (1) or Panda (2). Returns null for other robots and after an
/// error.
#[unsafe(no_mangle)]
pub extern "C" fn steps_create(robot: c_int, is_nonlinear: c_int) -> *mut c_void {
    match contender(robot, is_nonlinear != 0) {
        Ok(contender) => Box::into_raw(Box::new(contender)).cast(),
        Err(error) => {
            eprintln!("step_plugin: {error}");
            std::ptr::null_mut()
        }
    }
}

/// # Safety
/// `contender` must come from [`steps_create`].
unsafe fn of<'a>(contender: *mut c_void) -> &'a mut Box<dyn Contender> {
    // SAFETY: by this function's contract.
    unsafe { &mut *contender.cast::<Box<dyn Contender>>() }
}

/// # Safety
/// `to` must be valid for `numbers.len()` numbers.
unsafe fn write(numbers: &[f64], to: *mut f64) {
    // SAFETY: by this function's contract.
    unsafe { from_raw_parts_mut(to, numbers.len()) }.copy_from_slice(numbers);
}

/// Writes number of coordinates, number of inputs, number of periods in the horizon, period (s), number of steps in a period, and
/// duration of the motion (s).
///
/// # Safety
/// `contender` must come from [`steps_create`]. `to` must be valid for six numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn steps_sizes(contender: *mut c_void, to: *mut f64) {
    // SAFETY: by this function's contract.
    unsafe {
        let contender = of(contender);
        let ([n, m], [steps, seconds]) = (contender.sizes(), contender.course());
        write(&[n as f64, m as f64, HORIZON as f64, PERIOD, steps, seconds], to);
    }
}

/// Writes weights of states and inputs, lowest and highest inputs, lowest and highest states, and penalties.
///
/// # Safety
/// `contender` must come from [`steps_create`]. `to` must be valid for 6 N + 3 M + 2 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn steps_settings(contender: *mut c_void, to: *mut f64) {
    // SAFETY: by this function's contract.
    unsafe { write(&of(contender).settings(), to) };
}

/// Writes desired states of all nodes of the horizon, desired inputs, and the terminal weight.
///
/// # Safety
/// `contender` must come from [`steps_create`]. `to` must be valid for all these numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn steps_reference(contender: *mut c_void, time: f64, to: *mut f64) {
    // SAFETY: by this function's contract.
    unsafe { write(&of(contender).reference(time), to) };
}

/// Replaces `state` by the state of the plant after a period.
///
/// # Safety
/// `contender` must come from [`steps_create`]. The arrays must have the sizes of this controller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn steps_plant(contender: *mut c_void, state: *mut f64, inputs: *const f64) {
    // SAFETY: by this function's contract.
    unsafe {
        let contender = of(contender);
        let [n, m] = contender.sizes();
        let after = contender.plant(from_raw_parts(state, 2 * n), from_raw_parts(inputs, m));
        write(&after, state);
    }
}

/// Computes the inputs of the period that begins at `time`. Returns the computing time (s), or −1 if the controller fails.
///
/// # Safety
/// `contender` must come from [`steps_create`]. The arrays must have the sizes of this controller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn steps_step(
    contender: *mut c_void,
    time: f64,
    state: *const f64,
    inputs: *mut f64,
) -> f64 {
    // SAFETY: by this function's contract.
    unsafe {
        let contender = of(contender);
        let [n, m] = contender.sizes();
        let last = from_raw_parts(inputs, m).to_vec();
        let Some((found, seconds)) = contender.step(time, from_raw_parts(state, 2 * n), &last) else {
            return -1.0;
        };
        write(&found, inputs);
        seconds
    }
}

/// Frees a controller.
///
/// # Safety
/// `contender` must come from [`steps_create`], and must not be used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn steps_destroy(contender: *mut c_void) {
    // SAFETY: by this function's contract.
    drop(unsafe { Box::from_raw(contender.cast::<Box<dyn Contender>>()) });
}
