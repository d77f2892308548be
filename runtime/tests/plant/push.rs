//! Pushes from outside, against closed forms and the work that they do.

use super::{SLIDER, Slider};
use gelenk_generated::ur5::{frame_tool_jacobian, frame_tool_pose, potential_energy};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::plant::{Plant, PlantOptions, wrench_forces};

gelenk_runtime::dynamics!(struct Ur5 = gelenk_generated::ur5);

/// Dry friction of 1 N: 4 N for half a second give 0.75 m/s and 0.1875 m, after which it slides 0.5625 m
/// further. Less than the friction moves nothing, nor does a push against a brake.
#[test]
fn a_mass_that_is_pushed_slides_and_rests() {
    let rubbing = Slider { coulomb: 1.0, ..SLIDER };
    let pushed = |force: f64, braked: bool| {
        let mut plant = Plant::new(rubbing, PlantOptions::default()).unwrap();
        if braked {
            plant.brake();
        }
        plant.push(0.5, move |_| [force]);
        let mut states = Vec::new();
        for _ in 0..30 {
            plant.hold(0.1).unwrap();
            states.push((plant.state().0[0], plant.state().1[0]));
        }
        (states[4], states[29])
    };
    let ((y, v), (end, speed)) = pushed(4.0, false);
    assert!((v - 0.75).abs() < 1e-9 && (y - 0.1875).abs() < 1e-9, "{y} {v}");
    assert!((end - 0.75).abs() < 1e-8 && speed == 0.0, "{end} {speed}");
    assert_eq!(pushed(0.9, false).1, (0.0, 0.0));
    assert_eq!(pushed(4.0, true).1, (0.0, 0.0));
}

/// A constant force does the work F · Δx at its frame, which is all that changes the energy of a robot without friction.
#[test]
fn a_force_at_a_frame_does_its_work() {
    const FORCE: [f64; 3] = [15.0, 20.0, -5.0];
    let start = [0.3, -1.2, 1.0, -1.4, -1.5, 0.2];
    let mut plant = Plant::new(Ur5, PlantOptions::default()).unwrap();
    plant.reset(start, [0.0; 6]).unwrap();
    let [x, y, z] = FORCE;
    plant.push(0.3, move |at| wrench_forces(&frame_tool_jacobian(at), &[x, y, z, 0.0, 0.0, 0.0]));
    for _ in 0..30 {
        plant.hold(0.01).unwrap();
    }
    let (end, velocities) = plant.state();
    let gained = Ur5.kinetic_energy(&end, &velocities) + potential_energy(&end) - potential_energy(&start);
    let (from, to) = (frame_tool_pose(&start).0, frame_tool_pose(&end).0);
    let work: f64 = (0..3).map(|i| FORCE[i] * (to[i] - from[i])).sum();
    assert!(work.abs() > 1.0 && (gained - work).abs() < 1e-7, "{gained} J of {work} J");
}
