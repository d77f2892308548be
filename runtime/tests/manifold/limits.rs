//! Limits along motions with attitudes: positions of plain joints, velocities and forces of all.

use super::Mixed;
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::limits::{Quantity, Rating, violations};
use gelenk_runtime::trajectory::GeodesicMotion;

#[test]
fn broken_limits_are_those_of_the_joints_that_have_them() {
    let start = Mixed.neutral();
    let turned = |slide: f64, angle: f64| Mixed.integrate(&start, &[slide, 0.0, angle, 0.0, 0.0]);
    let found = |slide: f64, angle: f64, duration: f64| {
        let motion = GeodesicMotion::between(Mixed, start, turned(slide, angle), duration).unwrap();
        violations(&motion, Mixed, Rating::Nominal, 0.01).unwrap()
    };
    assert_eq!(found(0.4, 2.0, 4.0), []);
    // The slide ends at 0.6 m where 0.5 m are allowed; its entry is before the quaternion.
    let far = found(0.6, 0.0, 4.0);
    let [beyond] = far.as_slice() else { panic!("{far:?}") };
    assert_eq!((beyond.quantity, beyond.index, beyond.limit), (Quantity::Position, 0, 0.5));
    // Three radians about an axis of the ball in a second: 1.875 times the mean speed, where 5 rad/s are allowed.
    let fast = found(0.0, 3.0, 1.0);
    let speed = fast.iter().find(|found| found.quantity == Quantity::Velocity).unwrap();
    assert_eq!((speed.index, speed.limit), (2, 5.0));
    assert!((speed.value - 3.0 * 1.875).abs() < 1e-6, "{speed}");
    assert!(fast.iter().all(|found| found.quantity != Quantity::Position), "{fast:?}");
}
