//! Motion for identification: a sine with varying frequency. It moves a joint with many speeds in both directions, and
//! begins and ends at rest.

use super::polynomial::{End, Quintic};
use super::{Sample, Trajectory, TrajectoryError, require_finite, require_positive, require_representable};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Parameters of a sine with variable frequency (chirp) for each coordinate, with a polynomial run-in and run-out:
///
/// ```text
///     y(t) = y_c + â sin(ω(t) t)        ω(t) = ω_0 + (ω_1 − ω_0) t/T,   0 ≤ t ≤ T
/// ```
///
/// The run-in before the sine is a polynomial of degree five from rest to the position, velocity and acceleration of the
/// sine at t = 0. The run-out after the sine is a polynomial of degree five from the state at t = T to rest. Therefore the
/// motion is C². The initial rest position is y_c − ½ â ω_0 T_in, and the final rest position is y(T) + ½ ẏ(T) T_in. With
/// these positions the speed rises and falls without a change of direction.
///
/// The velocity of the sine is â cos(ω(t) t) (ω_0 + 2 (ω_1 − ω_0) t/T). Therefore the instantaneous frequency changes from
/// ω_0 to ω_0 + 2 (ω_1 − ω_0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentificationSine<const N: usize> {
    /// Centres y_c [rad or m].
    pub center: [f64; N],
    /// Amplitudes â [rad or m]. A coordinate with the amplitude 0 rests at its centre.
    pub amplitude: [f64; N],
    /// Instantaneous frequencies ω_0 at the beginning of the sine [rad/s].
    pub first_frequency: [f64; N],
    /// Frequencies ω_1 [rad/s]. The instantaneous frequency at the end of the sine is 2 ω_1 − ω_0, with the
    /// frequency ω_0 at its beginning.
    pub last_frequency: [f64; N],
    /// Duration T of the sine (s).
    pub sine_duration: f64,
    /// Duration T_in of the run-in and of the run-out (s).
    pub run_in: f64,
}

/// The motion of an [`IdentificationSine`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentificationMotion<const N: usize> {
    sine: IdentificationSine<N>,
    run_in: [Quintic; N],
    run_out: [Quintic; N],
    rest: [[f64; N]; 2],
}

impl<const N: usize> IdentificationSine<N> {
    /// The motion of this sine. Its duration is `sine_duration` + 2 `run_in`.
    ///
    /// # Errors
    /// - [`TrajectoryError::NotFinite`] for a parameter that is not finite.
    /// - [`TrajectoryError::NotPositive`] for a duration that is not positive.
    /// - [`TrajectoryError::OutOfRange`] for an overflow of accelerations.
    pub fn motion(self) -> Result<IdentificationMotion<N>, TrajectoryError> {
        require_finite("center", &self.center)?;
        require_finite("amplitude", &self.amplitude)?;
        require_finite("first_frequency", &self.first_frequency)?;
        require_finite("last_frequency", &self.last_frequency)?;
        require_positive("sine_duration", self.sine_duration)?;
        require_positive("run_in", self.run_in)?;
        let ends: [[End; 2]; N] = core::array::from_fn(|i| [self.at(i, 0.0), self.at(i, self.sine_duration)]);
        let way = |end: &End| 0.5 * end[1] * self.run_in;
        let rest =
            [ends.map(|[first, _]| first[0] - way(&first)), ends.map(|[_, last]| last[0] + way(&last))];
        let motion = IdentificationMotion {
            sine: self,
            run_in: core::array::from_fn(|i| Quintic::new([rest[0][i], 0.0, 0.0], ends[i][0], self.run_in)),
            run_out: core::array::from_fn(|i| Quintic::new(ends[i][1], [rest[1][i], 0.0, 0.0], self.run_in)),
            rest,
        };
        require_representable("duration", &[motion.duration()])?;
        for i in 0..N {
            let reach = self.center[i].abs() + self.amplitude[i].abs();
            require_representable("sine", &[reach, self.steepest(i)])?;
            let ways = [&motion.run_in[i], &motion.run_out[i]];
            for way in ways {
                require_representable("run-in or run-out", &way.bounds(self.run_in))?;
            }
        }
        Ok(motion)
    }

    /// Upper bound of the acceleration of coordinate `i`.
    fn steepest(&self, i: usize) -> f64 {
        let change = (self.last_frequency[i] - self.first_frequency[i]) / self.sine_duration;
        let fastest = self.first_frequency[i].abs() + 2.0 * (change * self.sine_duration).abs();
        self.amplitude[i] * (2.0 * change.abs() + fastest * fastest)
    }

    fn at(&self, i: usize, t: f64) -> End {
        let change = (self.last_frequency[i] - self.first_frequency[i]) / self.sine_duration;
        let rate = self.first_frequency[i] + 2.0 * change * t;
        let (sin, cos) = ((self.first_frequency[i] + change * t) * t).sin_cos();
        let a = self.amplitude[i];
        [self.center[i] + a * sin, a * cos * rate, a * (2.0 * change * cos - rate * rate * sin)]
    }
}

impl<const N: usize> Trajectory<N> for IdentificationMotion<N> {
    fn duration(&self) -> f64 {
        self.sine.sine_duration + 2.0 * self.sine.run_in
    }

    fn sample(&self, t: f64) -> Sample<N> {
        if t.is_nan() || t <= 0.0 {
            return Sample::at_rest(self.rest[0]);
        }
        if t >= self.duration() {
            return Sample::at_rest(self.rest[1]);
        }
        let in_sine = t - self.sine.run_in;
        let after = in_sine - self.sine.sine_duration;
        let states: [End; N] = core::array::from_fn(|i| {
            if in_sine < 0.0 {
                self.run_in[i].at(t)
            } else if after > 0.0 {
                self.run_out[i].at(after)
            } else {
                self.sine.at(i, in_sine)
            }
        });
        Sample {
            positions: states.map(|s| s[0]),
            velocities: states.map(|s| s[1]),
            accelerations: states.map(|s| s[2]),
        }
    }
}
