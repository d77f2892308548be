//! Quadrotor with its desired motion and the options of its controller.

use gelenk_runtime::mpc::{MpcOptions, ObserverOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, TrajectoryError};

gelenk_runtime::dynamics!(pub struct Quadrotor = gelenk_generated::quadrotor);

pub type Motion = GeodesicMotion<Quadrotor, 6, 4, 7>;

/// Sample time (s).
pub const PERIOD: f64 = 0.03;
/// Number of periods in the horizon.
pub const HORIZON: usize = 20;

/// Pose with x, y, z in m, and the quaternion x, y, z, w for a roll angle and a heading (rad).
pub fn pose([x, y, z]: [f64; 3], roll: f64, heading: f64) -> [f64; 7] {
    let ((a, b), (c, d)) = ((roll / 2.0).sin_cos(), (heading / 2.0).sin_cos());
    // The heading turns about the vertical axis, then the body rolls about its own x axis.
    [x, y, z, d * a, c * a, c * b, d * b]
}

/// Motion along a figure of eight with a whole roll in its middle.
pub fn figure() -> Result<Motion, TrajectoryError> {
    let middle = [0.0, 0.0, 1.5];
    let hover = pose(middle, 0.0, 0.0);
    let mut points = vec![(0.0, hover)];
    let eight = [([1.0, 0.6, 1.5], 0.4), ([2.0, 0.0, 1.8], 0.0), ([1.0, -0.6, 1.5], -0.4), (middle, 0.0)];
    points.extend(
        (1..).zip(eight).map(|(k, (place, heading))| (1.1 * f64::from(k), pose(place, 0.0, heading))),
    );
    let roll = [(0.4, 0.3), (0.6, 1.8), (0.75, 3.3), (0.9, 4.8), (1.1, 6.0), (1.35, std::f64::consts::TAU)];
    points.extend(roll.map(|(after, angle)| (4.4 + after, pose(middle, angle, 0.0))));
    points.push((7.0, hover));
    Motion::through(Quadrotor, &points)
}

/// Options with these weights of position and attitude.
pub fn options([position, attitude]: [f64; 2]) -> MpcOptions<6, 4> {
    MpcOptions {
        position_weight: [position, position, position, attitude, attitude, attitude],
        velocity_weight: [10.0, 10.0, 10.0, 1.0, 1.0, 1.0],
        input_weight: [0.1; 4],
        observer: ObserverOptions { velocity_sensor_noise: Some([1e-5; 6]), ..ObserverOptions::default() },
        ..MpcOptions::new(&Quadrotor, PERIOD, HORIZON)
    }
}
