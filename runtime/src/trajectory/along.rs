//! Motion of several coordinates along one scalar motion.

use super::{Sample, Trajectory, TrajectoryError, require_finite};

/// A motion `y(t) = y_0 + d s(t)` with the offset y_0, in which all coordinates follow one scalar motion
/// s(t). Each coordinate has a factor in the direction d.
///
/// If two axes are parallel and d = (1, −1), they turn in opposite directions, and the link after the second axis keeps its
/// orientation. Then gravity at the second joint is almost constant. See [`Along::compensated`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along<T, const N: usize> {
    offset: [f64; N],
    direction: [f64; N],
    motion: T,
}

impl<T: Trajectory<1>, const N: usize> Along<T, N> {
    /// A motion with `offset` y_0 [rad or m], `direction` d and the scalar motion s(t) in `motion`. The product d s must be
    /// in rad or m.
    ///
    /// # Errors
    /// [`TrajectoryError::NotFinite`] if an entry is not finite.
    pub fn new(offset: [f64; N], direction: [f64; N], motion: T) -> Result<Self, TrajectoryError> {
        require_finite("offset", &offset)?;
        require_finite("direction", &direction)?;
        Ok(Self { offset, direction, motion })
    }
}

impl<T: Trajectory<1>> Along<T, 2> {
    /// Compensated motion β = β_0 + s(t), γ = γ_0 − s(t) of two parallel axes, in which β + γ is constant. `offset` is
    /// (β_0, γ_0) in rad.
    ///
    /// # Errors
    /// [`TrajectoryError::NotFinite`] if an entry is not finite.
    pub fn compensated(offset: [f64; 2], motion: T) -> Result<Self, TrajectoryError> {
        Self::new(offset, [1.0, -1.0], motion)
    }
}

impl<T: Trajectory<1>, const N: usize> Trajectory<N> for Along<T, N> {
    fn duration(&self) -> f64 {
        self.motion.duration()
    }

    fn begin_period(&self, time: f64) {
        self.motion.begin_period(time);
    }

    fn sample(&self, t: f64) -> Sample<N> {
        let s = self.motion.sample(t);
        Sample {
            positions: core::array::from_fn(|i| self.offset[i] + self.direction[i] * s.positions[0]),
            velocities: self.direction.map(|d| d * s.velocities[0]),
            accelerations: self.direction.map(|d| d * s.accelerations[0]),
        }
    }
}
