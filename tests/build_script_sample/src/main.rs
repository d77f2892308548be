//! Swings the pendulum for a second and lifts the crane's boom: robots that the build script generated.

use gelenk_runtime::dynamics::Dynamics;

gelenk_runtime::include_model!(
    /// The crane of `crane.toml`.
    mod crane
);
gelenk_runtime::include_model!(
    /// The pendulum of `pendulum.urdf`.
    mod pendulum
);

gelenk_runtime::dynamics!(
    /// The crane.
    pub struct Crane { parameters } = crane
);
gelenk_runtime::dynamics!(
    /// The pendulum.
    pub struct Pendulum = pendulum
);

fn main() {
    let crane = Crane { parameters: crane::Parameters { payload_mass: 2.0 } };
    let torque = crane.inverse_dynamics(&[0.0; 2], &[0.0; 2], &[0.0; 2])[1];
    println!("crane: {torque:.4} N·m hold the boom with 2 kg");
    println!("pendulum: {:.4} rad after 1 s", swing(1000));
}

/// Angle after `steps` milliseconds from rest at 0.5 rad, by the semi-implicit Euler method.
fn swing(steps: u32) -> f64 {
    const STEP: f64 = 1e-3;
    let (mut y, mut v) = ([0.5], [0.0]);
    for _ in 0..steps {
        v[0] += STEP * Pendulum.forward_dynamics(&y, &v, &[0.0])[0];
        y[0] += STEP * v[0];
    }
    y[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAVITY: f64 = 9.81;

    /// A horizontal boom: −m g l of itself and the payload, about an axis that points upwards when lifting is
    /// negative.
    #[test]
    fn the_boom_is_held_against_its_weight() {
        for payload in [0.0, 0.5, 2.0] {
            let crane = Crane { parameters: crane::Parameters { payload_mass: payload } };
            let [slew, luff] = crane.inverse_dynamics(&[0.3, 0.0], &[0.0; 2], &[0.0; 2]);
            let expected = -GRAVITY * (4.0 * 0.6 + payload * 1.2);
            assert!((luff - expected).abs() < 1e-12 * expected.abs(), "{luff}");
            assert_eq!(slew, 0.0);
        }
        assert_eq!(Crane::default().parameters.payload_mass, 0.5);
    }

    #[test]
    fn the_slewing_drive_turns_with_its_gear() {
        let input_matrix = Crane::default().drive_matrix();
        assert_eq!(input_matrix, [[160.0, 0.0], [0.0, 1.0]]);
        assert_eq!(Crane::default().friction_torques(&[0.0; 2], &[2.0, 0.0]), [6.0, 0.0]);
    }

    #[test]
    fn the_hook_is_at_the_end_of_the_boom() {
        let (origin, _) = crane::frame_hook_pose(&[0.0, 0.0], &crane::Parameters::DESCRIBED);
        assert_eq!(origin, [1.2, 0.0, 0.0]);
    }

    /// ÿ = −(g/l) sin y − d v / (m l²).
    #[test]
    fn the_pendulum_swings_as_textbooks_say() {
        let (y, v) = (0.7_f64, -0.4);
        let expected = -GRAVITY / 0.5 * y.sin() - 0.1 * v / 0.5;
        let [acceleration] = Pendulum.forward_dynamics(&[y], &[v], &[0.0]);
        assert!((acceleration - expected).abs() < 1e-12, "{acceleration}");
        assert_eq!(Pendulum.limits().position, [[-3.0, 3.0]]);
        let angle = swing(1000);
        assert!(angle.abs() < 0.5, "{angle}");
    }
}
