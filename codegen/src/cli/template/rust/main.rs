//! Lets the robot of `robot.toml` swing and prints its motion.

use gelenk_runtime::dynamics::Dynamics;

gelenk_runtime::include_model!(
    /// The equations of motion, written by the build script.
    mod robot
);
gelenk_runtime::dynamics!(
    /// The robot.
    pub struct Robot = robot
);

/// Step of the integration in s.
const STEP: f64 = 1e-3;
/// Duration of the simulation in s.
const DURATION: f64 = 4.0;
/// Number of steps between two printed lines.
const PRINTED: usize = 200;

/// Coordinates and velocities.
type State = ([f64; robot::N], [f64; robot::N]);

fn main() {
    // The robot starts at rest, with the first joint at 1 rad (or 1 m).
    let mut state: State = ([0.0; robot::N], [0.0; robot::N]);
    state.0[0] = 1.0;
    println!(
        "{:>8}  {}  {:>12}",
        "t [s]",
        robot::JOINT_NAMES
            .map(|name| format!("{name:>12}"))
            .join("  "),
        "energy [J]"
    );
    let steps = (DURATION / STEP).round() as usize;
    for step in 0..=steps {
        if step % PRINTED == 0 {
            let (y, v) = &state;
            let energy = Robot.kinetic_energy(y, v) + robot::potential_energy(y);
            let joints = y.map(|y| format!("{y:12.6}")).join("  ");
            println!("{:8.3}  {joints}  {energy:12.6}", step as f64 * STEP);
        }
        state = runge_kutta(&state);
    }
}

/// Inputs of the motors. Replace this function by your controller.
fn inputs(_state: &State) -> [f64; robot::M] {
    [0.0; robot::M]
}

/// One step of the classical method of Runge and Kutta.
fn runge_kutta(state: &State) -> State {
    let rate = |(y, v): &State| (*v, Robot.forward_dynamics(y, v, &inputs(state)));
    let moved = |by: f64, (dy, dv): &State| -> State {
        let (y, v) = state;
        (
            core::array::from_fn(|i| y[i] + by * dy[i]),
            core::array::from_fn(|i| v[i] + by * dv[i]),
        )
    };
    let k1 = rate(state);
    let k2 = rate(&moved(STEP / 2.0, &k1));
    let k3 = rate(&moved(STEP / 2.0, &k2));
    let k4 = rate(&moved(STEP, &k3));
    let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * b + 2.0 * c + d) / 6.0;
    moved(
        STEP,
        &(
            core::array::from_fn(|i| mean(k1.0[i], k2.0[i], k3.0[i], k4.0[i])),
            core::array::from_fn(|i| mean(k1.1[i], k2.1[i], k3.1[i], k4.1[i])),
        ),
    )
}
