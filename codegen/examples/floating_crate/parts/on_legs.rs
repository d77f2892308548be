//! The robot of `robot.toml` stands on its feet while its trunk sways, by inverse dynamics with given forces at the feet.
//!
//! Contact is not simulated. In each period the program chooses the forces of the ground at the feet, and the simulated robot gets
//! them, as if the ground had answered so. That holds while all feet press and their friction suffices: the table shows both.
//!
//! 1. The trunk's acceleration is the desired one with feedback of `y_d ⊖ y` and of the velocities. The joints of the legs keep the
//!    feet in their places, `J v̇ + J̇ v = −k_p (p − p_0) − k_d J v`; other joints keep their posture.
//! 2. What the base's six rows of the inverse dynamics need, the feet exert: the forces of the least norm.
//! 3. The other rows, with these forces, are the joint torques.

use std::error::Error;
use std::process::ExitCode;

use gelenk_runtime::dynamics::{Dynamics, plain_entries};
use gelenk_runtime::feed_forward::FeedForward;

gelenk_runtime::include_model!(
    /// The equations of motion, written by the build script.
    mod robot
);
gelenk_runtime::dynamics!(
    /// The robot.
    pub struct Robot = robot
);

use robot::{M, N, NY, WRENCHES};

/// Positions: those of the base with its quaternion x y z w, then those of the joints.
type Positions = [f64; NY];
/// Velocities of the base, linear and angular in its own axes, then those of the joints.
type Velocities = [f64; N];
/// Force and moment at each foot, in the axes of the world.
type Wrenches = [[f64; 6]; WRENCHES];
type Jacobian = [[f64; N]; 6];

/// A foot: where it and the first joint of its leg are, and how the foot moves.
struct Foot {
    hip: fn(&Positions) -> ([f64; 3], [[f64; 3]; 3]),
    pose: fn(&Positions) -> ([f64; 3], [[f64; 3]; 3]),
    jacobian: fn(&Positions) -> Jacobian,
    rate: fn(&Positions, &Velocities) -> [f64; 6],
}

macro_rules! foot {
    ($hip:ident, $pose:ident, $jacobian:ident, $rate:ident) => {
        Foot {
            hip: robot::$hip,
            pose: robot::$pose,
            jacobian: robot::$jacobian,
            rate: robot::$rate,
        }
    };
}

/// The feet, in the order of the wrenches in `robot.toml`.
const FEET: [Foot; WRENCHES] = [
    // FEET
];

/// Period of the control, and duration in s; periods between two printed lines.
const PERIOD: f64 = 1e-3;
const DURATION: f64 = 3.0;
const PRINTED: u32 = 200;
/// Feedback of the trunk and of other joints, and of the feet [1/s², 1/s].
const GAINS: [f64; 2] = [100.0, 20.0];
const STIFF: [f64; 2] = [1e4, 200.0];
/// Length of a standing leg, as a part of its length at the positions closest to 0.
const BENT: f64 = 0.8;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    println!("The robot stands on its feet, and its trunk sways. Contact is not simulated:");
    println!("the forces at the feet are chosen, and act as if the ground had answered so.");
    let standing =
        standing().ok_or("no posture with bent legs was found: write one into standing()")?;
    let forward = FeedForward::new(Robot)?;
    let places = FEET.map(|foot| (foot.pose)(&standing).0);
    let (mut y, mut v) = (standing, [0.0; N]);
    println!(
        "{:>8}  {:>14}  {:>18}  {:>17}",
        "t [s]", "from its way [1]", "least pressing [N]", "used friction [1]"
    );
    for k in 0..=(DURATION / PERIOD).round() as u32 {
        let time = PERIOD * f64::from(k);
        let (forces, wrenches) = control(time, &standing, &y, &v, &places)?;
        if k % PRINTED == 0 {
            // Metres and radians together.
            let error = length(&Robot.difference(&desired(time, &standing), &y)[..6]);
            let pressing = wrenches.iter().map(|w| w[2]).fold(f64::INFINITY, f64::min);
            let used = wrenches
                .iter()
                .map(|w| length(&w[..2]) / w[2].max(1e-9))
                .fold(0.0, f64::max);
            println!("{time:8.3}  {error:16.2e}  {pressing:18.3}  {used:17.3}");
        }
        (y, v) = advanced(&y, &v, &forward.inputs_for(&y, &forces), &wrenches);
    }
    Ok(())
}

/// The base at the origin, each joint at 0 or at the nearest position within its limits.
fn home() -> Positions {
    let mut home = Robot.neutral();
    within_limits(&mut home);
    home
}

fn within_limits(y: &mut Positions) {
    let limits = Robot.limits().position;
    for (joint, position) in plain_entries(Robot.quaternion_joints(), N) {
        let [low, high] = limits[joint];
        y[position] = y[position].max(low).min(high);
    }
}

/// Legs bent so that each foot stands below its hip, by damped steps of Gauss and Newton.
fn standing() -> Option<Positions> {
    let mut y = home();
    let targets = FEET.map(|foot| {
        let (hip, [_, side, height]) = ((foot.hip)(&y).0, (foot.pose)(&y).0);
        let along = (foot.pose)(&y).0[0] - hip[0];
        [hip[0], side, hip[2] - BENT * along.hypot(height - hip[2])]
    });
    let bent = bend(&y);
    y = Robot.integrate(&y, &bent);
    within_limits(&mut y);
    for _ in 0..400 {
        let mut step = [0.0; N];
        for (foot, target) in FEET.iter().zip(&targets) {
            let (place, jacobian) = ((foot.pose)(&y).0, (foot.jacobian)(&y));
            let error = core::array::from_fn(|i| target[i] - place[i]);
            let joints = least(&jacobian, &error, 1e-6)?;
            (6..N).for_each(|c| step[c] += joints[c].clamp(-0.2, 0.2));
        }
        y = Robot.integrate(&y, &step);
        within_limits(&mut y);
    }
    let far = FEET.iter().zip(&targets).any(|(foot, target)| {
        let place = (foot.pose)(&y).0;
        length(&core::array::from_fn::<f64, 3, _>(|i| target[i] - place[i])) > 1e-3
    });
    // The feet stand at the height 0.
    y[2] = -(FEET[0].pose)(&y).0[2];
    (!far).then_some(y)
}

/// A bend of each leg's last two joints, away from a straight leg, from which no step leads.
fn bend(y: &Positions) -> Velocities {
    let mut bend = [0.0; N];
    for foot in &FEET {
        let jacobian = (foot.jacobian)(y);
        let moves = |c: &usize| jacobian[3..].iter().any(|row| row[*c] != 0.0);
        for (c, angle) in (6..N).rev().filter(moves).zip([-1.2, 0.6]) {
            bend[c] = angle;
        }
    }
    bend
}

/// The least motion of the joints that moves a foot as wanted: `Jᵀ (J Jᵀ + damping)⁻¹ wanted`.
fn least(jacobian: &Jacobian, wanted: &[f64; 3], damping: f64) -> Option<Velocities> {
    let square = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let product: f64 = (6..N).map(|c| jacobian[i][c] * jacobian[j][c]).sum();
            if i == j { product + damping } else { product }
        })
    });
    let forces: [f64; 3] = solve(square, *wanted)?;
    let joint = |c: usize| {
        if c < 6 {
            0.0
        } else {
            (0..3).map(|i| jacobian[i][c] * forces[i]).sum()
        }
    };
    Some(core::array::from_fn(joint))
}

/// The desired positions: the trunk sways, dips and turns by small amounts.
fn desired(time: f64, standing: &Positions) -> Positions {
    let s = time.min(1.0);
    let grown = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    let wave = |period: f64| grown * (std::f64::consts::TAU * time / period).sin();
    let height = standing[2].abs();
    let mut motion = [0.0; N];
    motion[0] = 0.05 * height * wave(1.5);
    motion[1] = 0.05 * height * wave(2.0);
    motion[2] = 0.05 * height * wave(1.0);
    motion[3] = 0.05 * wave(2.0);
    motion[4] = 0.05 * wave(1.5);
    motion[5] = 0.1 * wave(3.0);
    Robot.integrate(standing, &motion)
}

/// Desired velocity and acceleration, by differences along ⊕ over a millisecond.
fn desired_rates(time: f64, standing: &Positions) -> [Velocities; 2] {
    let h = 1e-3;
    let at = desired(time, standing);
    let [ahead, back] =
        [h, -h].map(|h| Robot.difference(&at, &desired((time + h).max(0.0), standing)));
    [
        core::array::from_fn(|i| (ahead[i] - back[i]) / (2.0 * h)),
        core::array::from_fn(|i| (ahead[i] + back[i]) / (h * h)),
    ]
}

/// Joint torques as generalized forces, and the forces at the feet.
fn control(
    time: f64,
    standing: &Positions,
    y: &Positions,
    v: &Velocities,
    places: &[[f64; 3]; WRENCHES],
) -> Result<(Velocities, Wrenches), Box<dyn Error>> {
    let jacobians = FEET.map(|foot| (foot.jacobian)(y));
    let error = Robot.difference(y, &desired(time, standing));
    let [velocity, acceleration] = desired_rates(time, standing);
    let mut a: Velocities = core::array::from_fn(|i| {
        acceleration[i] + GAINS[0] * error[i] + GAINS[1] * (velocity[i] - v[i])
    });
    for ((foot, jacobian), place) in FEET.iter().zip(&jacobians).zip(places) {
        let (at, rate) = ((foot.pose)(y).0, (foot.rate)(y, v));
        let wanted = core::array::from_fn(|i| {
            -STIFF[0] * (at[i] - place[i])
                - STIFF[1] * dot(&jacobian[i], v)
                - rate[i]
                - dot(&jacobian[i], &a)
        });
        let joints = least(jacobian, &wanted, 0.0).ok_or("a leg is stretched")?;
        (6..N).for_each(|c| a[c] += joints[c]);
    }
    let inverse = |w: &Wrenches| robot::inverse_dynamics_with_wrenches(y, v, &a, w);
    let wrenches = at_feet(&inverse(&[[0.0; 6]; WRENCHES]), &jacobians)
        .ok_or("the feet cannot carry the trunk")?;
    Ok((inverse(&wrenches), wrenches))
}

/// Forces at the feet that make the base's six rows, of the least norm.
fn at_feet(rows: &Velocities, jacobians: &[Jacobian; WRENCHES]) -> Option<Wrenches> {
    let product = |i: usize, j: usize| -> f64 {
        jacobians
            .iter()
            .flat_map(|jacobian| &jacobian[..3])
            .map(|row| row[i] * row[j])
            .sum()
    };
    let square = core::array::from_fn(|i| core::array::from_fn(|j| product(i, j)));
    let of_base: [f64; 6] = core::array::from_fn(|i| rows[i]);
    let multipliers: [f64; 6] = solve(square, of_base)?;
    Some(core::array::from_fn(|k| {
        let force = |i: usize| (0..6).map(|c| jacobians[k][i][c] * multipliers[c]).sum();
        core::array::from_fn(|i| if i < 3 { force(i) } else { 0.0 })
    }))
}

/// The state after a period with given inputs and forces, by the midpoint rule along ⊕.
fn advanced(y: &Positions, v: &Velocities, u: &[f64; M], w: &Wrenches) -> (Positions, Velocities) {
    let add = |a: &Velocities, h: f64| -> Velocities { core::array::from_fn(|i| v[i] + h * a[i]) };
    let a = robot::forward_dynamics_with_wrenches(y, v, u, w);
    let (middle, velocity) = (
        Robot.integrate(y, &v.map(|v| 0.5 * PERIOD * v)),
        add(&a, 0.5 * PERIOD),
    );
    let a = robot::forward_dynamics_with_wrenches(&middle, &velocity, u, w);
    (
        Robot.integrate(y, &velocity.map(|v| PERIOD * v)),
        add(&a, PERIOD),
    )
}

/// Solves `A x = b` by elimination with pivots; `None` where A is singular.
fn solve<const K: usize>(mut a: [[f64; K]; K], mut b: [f64; K]) -> Option<[f64; K]> {
    for k in 0..K {
        let pivot = (k..K).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        (a.swap(k, pivot), b.swap(k, pivot));
        if a[k][k].abs() < 1e-12 {
            return None;
        }
        for i in k + 1..K {
            let factor = a[i][k] / a[k][k];
            (0..K).for_each(|j| a[i][j] -= factor * a[k][j]);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..K).rev() {
        b[k] = (b[k] - (k + 1..K).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    Some(b)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(entries: &[f64]) -> f64 {
    dot(entries, entries).sqrt()
}
