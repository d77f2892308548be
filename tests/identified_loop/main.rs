//! Tracks a reference on the published PowerCube with feed-forward from several models, and prints each one's
//! rms error. Compiled by `tests/identified_loop.rs` into a package of its own, next to the modules that its
//! build script generates.

use gelenk_runtime::dynamics::Dynamics;

gelenk_runtime::include_model!(
    /// The identified friction.
    mod identified
);
gelenk_runtime::include_model!(
    /// The same robot, one coefficient changed.
    mod altered
);
gelenk_runtime::dynamics!(pub struct Published = gelenk_generated::powercube);
gelenk_runtime::dynamics!(pub struct Identified = identified);
gelenk_runtime::dynamics!(pub struct Altered = altered);

/// Sample time of the controller and steps of the plant in it.
const PERIOD: f64 = 0.02;
const STEPS: u32 = 20;
/// Feedback at the joints [N·m/rad, N·m·s/rad].
const STIFFNESS: f64 = 400.0;
const DAMPING: f64 = 20.0;

type Pair = [f64; 2];

fn main() {
    let report = |name: &str, feed_forward: &dyn Fn(&Pair, &Pair, &Pair) -> Pair| {
        println!("{name} {:.9}", track(feed_forward));
    };
    report("published", &|y, v, a| Published.inverse_dynamics(y, v, a));
    report("identified", &|y, v, a| Identified.inverse_dynamics(y, v, a));
    report("altered", &|y, v, a| Altered.inverse_dynamics(y, v, a));
    report("frictionless", &|y, v, a| {
        let (all, friction) = (Identified.inverse_dynamics(y, v, a), Identified.friction_torques(y, v));
        [all[0] - friction[0], all[1] - friction[1]]
    });
}

/// y, ẏ, ÿ of the reference, starting at rest.
fn reference(t: f64) -> [Pair; 3] {
    let wave = |a: f64, w: f64| {
        [a * (1.0 - (w * t).cos()), a * w * (w * t).sin(), a * w * w * (w * t).cos()]
    };
    let (first, second) = (wave(0.3, 1.3), wave(-0.4, 1.0));
    [[first[0], second[0]], [first[1], second[1]], [first[2], second[2]]]
}

/// Rms position error [rad] over ten seconds, both joints.
fn track(feed_forward: &dyn Fn(&Pair, &Pair, &Pair) -> Pair) -> f64 {
    let gear = Published.drive_matrix()[0][0];
    let (mut y, mut v) = ([0.0; 2], [0.0; 2]);
    let mut squares = 0.0;
    let periods = 500;
    for i in 0..periods {
        let t = PERIOD * f64::from(i);
        let [wanted, speeds, _] = reference(t);
        // The input holds for a period: feed forward what its middle needs.
        let [y_ref, v_ref, a_ref] = reference(t + 0.5 * PERIOD);
        let torques = feed_forward(&y_ref, &v_ref, &a_ref);
        let u: Pair = std::array::from_fn(|j| {
            let feedback = STIFFNESS * (wanted[j] - y[j]) + DAMPING * (speeds[j] - v[j]);
            (torques[j] + feedback) / gear
        });
        for _ in 0..STEPS {
            (y, v) = step(&y, &v, &u, PERIOD / f64::from(STEPS));
        }
        let after = reference(t + PERIOD)[0];
        squares += (0..2).map(|j| (y[j] - after[j]).powi(2)).sum::<f64>();
    }
    (squares / f64::from(2 * periods)).sqrt()
}

/// One step of Heun's method on the published arm.
fn step(y: &Pair, v: &Pair, u: &Pair, h: f64) -> (Pair, Pair) {
    let a = Published.forward_dynamics(y, v, u);
    let ahead = [v[0] + h * a[0], v[1] + h * a[1]];
    let b = Published.forward_dynamics(&[y[0] + h * v[0], y[1] + h * v[1]], &ahead, u);
    (
        std::array::from_fn(|j| y[j] + 0.5 * h * (v[j] + ahead[j])),
        std::array::from_fn(|j| v[j] + 0.5 * h * (a[j] + b[j])),
    )
}
