//! A quadrotor in flight: the equations of a single rigid body stand here by hand, so that nothing of gelenk is in the log.

use nalgebra::{Matrix3, Matrix4, Matrix6, Quaternion, UnitQuaternion, Vector3, Vector4, Vector6};

use super::Noise;

/// Where the propellers act, and the moments of their drag for a unit of thrust.
const PROPELLERS: [([f64; 3], f64); 4] = [
    ([0.13, -0.22, 0.023], 0.016),
    ([-0.13, 0.2, 0.023], 0.016),
    ([0.13, 0.22, 0.023], -0.016),
    ([-0.13, -0.2, 0.023], -0.016),
];
const GRAVITY: f64 = 9.80665;

/// A rigid body about the origin of its frame.
pub struct Body {
    pub mass: f64,
    pub center: Vector3<f64>,
    pub inertia: Matrix3<f64>,
}

/// True parameters of the quadrotor of `models/`: it carries a camera.
pub fn truth() -> Body {
    let (mass, center) = (1.9, Vector3::new(0.012, -0.006, -0.015));
    let own = Matrix3::from_diagonal(&Vector3::new(0.034, 0.037, 0.06));
    let shift = Matrix3::identity() * center.norm_squared() - center * center.transpose();
    Body { mass, center, inertia: own + mass * shift }
}

struct State {
    place: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    /// Linear and angular velocity in the body's frame.
    velocity: Vector6<f64>,
}

impl Body {
    /// Newton's and Euler's equations about the origin of the body's frame.
    fn acceleration(
        &self,
        attitude: &UnitQuaternion<f64>,
        velocity: &Vector6<f64>,
        wrench: &Vector6<f64>,
    ) -> Vector6<f64> {
        let (v, w) = (velocity.fixed_rows::<3>(0).into_owned(), velocity.fixed_rows::<3>(3).into_owned());
        let (m, c) = (self.mass, self.center);
        let gravity = attitude.inverse() * Vector3::new(0.0, 0.0, -GRAVITY);
        let force = wrench.fixed_rows::<3>(0) - m * (w.cross(&v) + w.cross(&w.cross(&c)) - gravity);
        let moment =
            wrench.fixed_rows::<3>(3) - w.cross(&(self.inertia * w)) - m * c.cross(&(w.cross(&v) - gravity));
        let mut matrix = Matrix6::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() * m));
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-m * c.cross_matrix()));
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&(m * c.cross_matrix()));
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.inertia);
        let mut right = Vector6::zeros();
        right.fixed_rows_mut::<3>(0).copy_from(&force);
        right.fixed_rows_mut::<3>(3).copy_from(&moment);
        matrix.lu().solve(&right).unwrap()
    }

    /// A step of Heun's method, short enough that its error is far below the noise.
    fn step(&self, state: &mut State, thrusts: &Vector4<f64>, h: f64) {
        let wrench = wrench(thrusts);
        let first = self.acceleration(&state.attitude, &state.velocity, &wrench);
        let predicted = state.velocity + h * first;
        let middle = 0.5 * (state.velocity + predicted);
        let turn = UnitQuaternion::from_scaled_axis(h * middle.fixed_rows::<3>(3));
        let half = UnitQuaternion::from_scaled_axis(0.5 * h * middle.fixed_rows::<3>(3));
        let second = self.acceleration(&(state.attitude * turn), &predicted, &wrench);
        state.place += h * (state.attitude * half * middle.fixed_rows::<3>(0).into_owned());
        state.attitude *= turn;
        state.velocity += 0.5 * h * (first + second);
    }
}

fn wrench(thrusts: &Vector4<f64>) -> Vector6<f64> {
    let mut sum = Vector6::zeros();
    for ((place, drag), thrust) in PROPELLERS.iter().zip(thrusts) {
        let force = Vector3::new(0.0, 0.0, *thrust);
        let moment = Vector3::from(*place).cross(&force) + Vector3::new(0.0, 0.0, drag * thrust);
        sum += Vector6::new(0.0, 0.0, *thrust, moment.x, moment.y, moment.z);
    }
    sum
}

/// Thrusts that keep the robot near its place while its tilt and its yaw are excited.
fn thrusts(state: &State, t: f64) -> Vector4<f64> {
    let sine = |amplitude: f64, hertz: f64, phase: f64| {
        amplitude * (std::f64::consts::TAU * hertz * t + phase).sin()
    };
    let speed = state.attitude * state.velocity.fixed_rows::<3>(0).into_owned();
    let push = Vector3::new(
        sine(3.0, 0.7, 0.0) + sine(2.0, 1.6, 1.0),
        sine(3.0, 0.9, 2.0) + sine(2.0, 1.3, 0.5),
        sine(2.0, 0.5, 0.3) + sine(2.0, 1.9, 1.7),
    );
    let wanted = push - state.place - 1.5 * speed + Vector3::new(0.0, 0.0, GRAVITY);
    let up = state.attitude.inverse() * wanted.normalize();
    let rate = state.velocity.fixed_rows::<3>(3);
    let tilt = Vector3::z().cross(&up);
    let turn = sine(1.2, 0.4, 0.0) + sine(0.8, 1.1, 1.0);
    let moment =
        Vector3::new(6.0 * tilt.x - 0.5 * rate.x, 6.0 * tilt.y - 0.5 * rate.y, 0.15 * (turn - rate.z));
    let rows = Matrix4::from_fn(|row, column| {
        wrench(&Vector4::from_fn(|i, _| f64::from(u8::from(i == column))))[row + 2]
    });
    let asked = Vector4::new(1.8 * wanted.norm(), moment.x, moment.y, moment.z);
    rows.lu().solve(&asked).unwrap().map(|thrust| thrust.clamp(0.2, 8.0))
}

/// One row of a log.
pub struct Sample {
    pub time: f64,
    pub place: Vector3<f64>,
    pub attitude: Quaternion<f64>,
    pub thrusts: Vector4<f64>,
}

/// A flight of the quadrotor as it is.
pub fn flight(seconds: f64, seed: u64) -> Vec<Sample> {
    flight_of(&truth(), seconds, seed)
}

/// A flight, measured with noise of 1 mm and 2 mrad at uneven times; attitudes change their sign at random.
pub fn flight_of(body: &Body, seconds: f64, seed: u64) -> Vec<Sample> {
    const STEP: f64 = 5e-4;
    let mut noise = Noise::new(seed);
    let mut state =
        State { place: Vector3::zeros(), attitude: UnitQuaternion::identity(), velocity: Vector6::zeros() };
    let mut samples: Vec<Sample> = Vec::new();
    let mut next = 0.0;
    for i in 0..(seconds / STEP) as usize {
        let t = STEP * i as f64;
        let thrusts = thrusts(&state, t + seed as f64);
        if t >= next {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(noise.vector(2e-3)));
            let sign = if noise.uniform() > 0.0 { 1.0 } else { -1.0 };
            samples.push(Sample {
                time: t,
                place: state.place + Vector3::from(noise.vector(1e-3)),
                attitude: (state.attitude * turn).into_inner() * sign,
                thrusts: thrusts.map(|thrust| thrust + 0.02 * noise.normal()),
            });
            next += 5e-3 * (1.0 + 0.2 * noise.uniform());
        }
        body.step(&mut state, &thrusts, STEP);
    }
    samples
}
