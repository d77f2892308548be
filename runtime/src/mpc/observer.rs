//! Kalman filter that estimates the state and the input disturbance from measured positions.

use super::error::{MpcError, require};
use super::integrate::{Span, integrate};
use crate::dynamics::{Discretizable, Dynamics, Step};
use crate::lanes::widened;

/// Standard deviations of the noise that [`DisturbanceObserver`] assumes. The noise of different periods is
/// independent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObserverOptions<const N: usize, const M: usize> {
    /// Standard deviation of a measured position [rad or m], > 0. It is resolution/√12 for the rounding error
    /// of an encoder, plus other noise.
    pub encoder_noise: [f64; N],
    /// Standard deviation of the part of the velocity change in a period that the model does not explain [rad/s or
    /// m/s], ≥ 0.
    pub velocity_noise: [f64; N],
    /// Standard deviation of the change of the disturbance in a period, in units of the input, ≥ 0. If the value is
    /// 0, the disturbance is not estimated.
    pub disturbance_noise: [f64; M],
    /// Standard deviation of a measured velocity [rad/s or m/s], > 0; `None` if measured velocities are not used.
    pub velocity_sensor_noise: Option<[f64; N]>,
}

impl<const N: usize, const M: usize> Default for ObserverOptions<N, M> {
    /// Encoder noise of 1e-5 rad (or m), unexplained velocity changes of 1e-3 rad/s (or m/s), and no disturbance.
    /// [`MpcOptions::new`](super::MpcOptions::new) derives the noise of the disturbance from the limits of the
    /// inputs.
    fn default() -> Self {
        Self {
            encoder_noise: [1e-5; N],
            velocity_noise: [1e-3; N],
            disturbance_noise: [0.0; M],
            velocity_sensor_noise: None,
        }
    }
}

impl<const N: usize, const M: usize> ObserverOptions<N, M> {
    pub(super) fn check(&self) -> Result<(), MpcError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let weight = |x: f64| x.is_finite() && x >= 0.0;
        require("observer.encoder_noise", &self.encoder_noise, "positive (rad or m)", positive)?;
        let sensors = self.velocity_sensor_noise.as_ref().map_or(&[][..], |n| n);
        require("observer.velocity_sensor_noise", sensors, "positive (rad/s or m/s)", positive)?;
        require("observer.velocity_noise", &self.velocity_noise, "not negative (rad/s or m/s)", weight)?;
        require(
            "observer.disturbance_noise",
            &self.disturbance_noise,
            "not negative (unit of the input)",
            weight,
        )
    }
}

/// Kalman filter that estimates positions y, velocities ẏ and the input disturbance d. The disturbance acts like an
/// input u, and is constant except for its noise:
///
/// ```text
///     (y, ẏ)⁺ = f(y, ẏ, u + d)     d⁺ = d     measured: y
/// ```
///
/// The filter is an extended Kalman filter. It predicts the state with the nonlinear robot f, and the covariance with
/// the exact sensitivities of the robot (Anderson, Moore, *Optimal Filtering*, 1979, section 8.2). The disturbance
/// model for offset-free control is from Pannocchia, Rawlings, *AIChE J.* 49 (2003). Measured positions are
/// processed one after another. Because their noise is independent, the result equals that of simultaneous
/// processing. For robots with quaternions, the filter estimates the error state `(y ⊖ ŷ, v − v̂, d − d̂)` (Solà,
/// *Quaternion kinematics for the error-state Kalman filter*, 2017, section 6).
#[derive(Debug, Clone)]
pub struct DisturbanceObserver<const N: usize, const M: usize, const NY: usize = N> {
    options: ObserverOptions<N, M>,
    positions: [f64; NY],
    velocities: [f64; N],
    disturbance: [f64; M],
    /// Covariance of the augmented state (positions, velocities, disturbance), in rows of 2 N + M entries.
    covariance: Vec<f64>,
    /// Memory for the prediction of the covariance.
    work: Vec<f64>,
    /// Transpose of the sensitivity matrix F of the last prediction, without the columns of the disturbance.
    transition: Vec<f64>,
    /// Correction of the augmented state by the measurements, before it is applied to the state.
    correction: Vec<f64>,
}

impl<const N: usize, const M: usize> DisturbanceObserver<N, M> {
    /// An observer for a robot at rest at y = 0. All memory is allocated here.
    ///
    /// # Errors
    /// [`MpcError::Option`] for the first standard deviation out of its range.
    pub fn new(options: ObserverOptions<N, M>) -> Result<Self, MpcError> {
        Self::starting_at(&[0.0; N], options)
    }

    /// Corrects the estimate with measured positions [rad or m].
    pub fn correct(&mut self, measured: &[f64; N]) {
        self.correct_sums(measured);
    }
}

impl<const N: usize, const M: usize, const NY: usize> DisturbanceObserver<N, M, NY> {
    const SIZE: usize = 2 * N + M;

    /// An observer for a robot at rest at `positions` [rad or m]. All memory is allocated here.
    ///
    /// # Errors
    /// [`MpcError::Option`] for the first standard deviation out of its range.
    pub fn starting_at(positions: &[f64; NY], options: ObserverOptions<N, M>) -> Result<Self, MpcError> {
        options.check()?;
        let mut observer = Self {
            options,
            positions: *positions,
            velocities: [0.0; N],
            disturbance: [0.0; M],
            covariance: vec![0.0; Self::SIZE * Self::SIZE],
            work: vec![0.0; Self::SIZE * Self::SIZE],
            transition: vec![0.0; Self::SIZE * 2 * N],
            correction: vec![0.0; Self::SIZE],
        };
        observer.reset(positions, &[0.0; N]);
        Ok(observer)
    }

    /// Restarts at known positions [rad or m] and velocities [rad/s or m/s] without disturbance. The initial
    /// covariance is that of the noise of one period. For positions, the encoder noise is added.
    pub fn reset(&mut self, positions: &[f64; NY], velocities: &[f64; N]) {
        (self.positions, self.velocities) = (*positions, *velocities);
        self.disturbance = [0.0; M];
        self.covariance.fill(0.0);
        for i in 0..Self::SIZE {
            let measured = if i < N { self.options.encoder_noise[i] } else { 0.0 };
            self.covariance[i * Self::SIZE + i] = self.noise(i) + measured * measured;
        }
    }

    /// Variance that a period adds to entry `i` of the augmented state.
    fn noise(&self, i: usize) -> f64 {
        let deviation = if i < N {
            0.0
        } else if i < 2 * N {
            self.options.velocity_noise[i - N]
        } else {
            self.options.disturbance_noise[i - 2 * N]
        };
        deviation * deviation
    }

    /// Predicts the estimate over `period` (s), in which `inputs` [N m, N or A] acted. The integration makes
    /// `substeps` Runge–Kutta steps. For robots with driven joints call [`predict_from`](Self::predict_from),
    /// because this method would make their estimate NaN.
    pub fn predict(
        &mut self,
        model: &impl Discretizable<N, M, NY>,
        inputs: &[f64; M],
        period: f64,
        substeps: usize,
    ) {
        self.predict_from(f64::NAN, model, inputs, period, substeps);
    }

    /// Predicts the estimate over the `period` (s) that begins at the time `start` (s), and in which `inputs` [N m, N
    /// or A] acted. The integration makes `substeps` Runge–Kutta steps.
    pub fn predict_from(
        &mut self,
        start: f64,
        model: &impl Discretizable<N, M, NY>,
        inputs: &[f64; M],
        period: f64,
        substeps: usize,
    ) {
        let total: [f64; M] = core::array::from_fn(|i| inputs[i] + self.disturbance[i]);
        let span = Span { start, period, substeps: substeps.max(1) };
        let step = integrate(model, &self.positions, &self.velocities, &total, span);
        (self.positions, self.velocities) = (step.coordinates, step.velocities);
        widened(
            #[inline(always)]
            || self.predict_covariance(&step),
        );
    }

    /// Predicts the covariance P by `F P Fᵀ` plus the noise. F is the sensitivity matrix of the augmented state. F
    /// differs from the identity only in the rows of y and ẏ.
    #[inline(always)]
    fn predict_covariance(&mut self, step: &Step<N, M, NY>) {
        let n = Self::SIZE;
        // Fᵀ is stored without the columns of d, because loops over its rows are vectorized.
        for k in 0..n {
            for i in 0..2 * N {
                self.transition[k * 2 * N + i] = sensitivity(step, i, k);
            }
        }
        self.work[..2 * N * n].fill(0.0);
        for i in 0..2 * N {
            let row = &mut self.work[i * n..][..n];
            for k in 0..n {
                add_scaled(row, self.transition[k * 2 * N + i], &self.covariance[k * n..][..n]);
            }
        }
        self.work[2 * N * n..].copy_from_slice(&self.covariance[2 * N * n..]);
        for i in 0..n {
            let (row, factors) = (&mut self.covariance[i * n..][..n], &self.work[i * n..][..n]);
            row[..2 * N].fill(0.0);
            for (k, factor) in factors.iter().enumerate() {
                add_scaled(&mut row[..2 * N], *factor, &self.transition[k * 2 * N..][..2 * N]);
            }
            row[2 * N..].copy_from_slice(&factors[2 * N..]);
            self.covariance[i * n + i] += self.noise(i);
        }
        // Rounding makes the product unsymmetric, and in many periods the difference would grow.
        for i in 0..n {
            for j in 0..i {
                self.covariance[j * n + i] = self.covariance[i * n + j];
            }
        }
    }

    /// Corrects the estimate with measured positions [rad or m], also for robots with quaternions. The innovation is
    /// `y ⊖ ŷ`, with one entry for each velocity. Attitudes are measured as quaternions, and their errors are
    /// expressed in the frame of the body.
    pub fn correct_by(&mut self, model: &impl Dynamics<N, M, NY>, measured: &[f64; NY]) {
        if N == NY {
            return self.correct_sums(measured);
        }
        let (difference, noise) = (model.difference(&self.positions, measured), self.options.encoder_noise);
        self.correct_entries(model, 0, &difference, &noise);
    }

    /// Corrects the estimate with measured velocities [rad/s or m/s]. Has no effect if
    /// [`ObserverOptions::velocity_sensor_noise`] is `None`.
    pub fn correct_velocities_by(&mut self, model: &impl Dynamics<N, M, NY>, measured: &[f64; N]) {
        if N == NY {
            return self.correct_velocity_sums(measured);
        }
        if let Some(noise) = self.options.velocity_sensor_noise {
            let difference = core::array::from_fn(|i| measured[i] - self.velocities[i]);
            self.correct_entries(model, N, &difference, &noise);
        }
    }

    /// Corrects the estimate with positions, for robots without quaternions (N = NY).
    fn correct_sums(&mut self, measured: &[f64; NY]) {
        for m in 0..N {
            let innovation = measured[m] - self.positions[m];
            self.take(m, innovation, self.options.encoder_noise[m], Self::add);
        }
    }

    /// Corrects the estimate with velocities, for robots without quaternions (N = NY).
    fn correct_velocity_sums(&mut self, measured: &[f64; N]) {
        let Some(noise) = self.options.velocity_sensor_noise else {
            return;
        };
        for m in 0..N {
            let innovation = measured[m] - self.velocities[m];
            self.take(N + m, innovation, noise[m], Self::add);
        }
    }

    /// Corrects the estimate with measured entries from index `first` on, one after another. Applies the correction
    /// to the state after the last entry.
    fn correct_entries(
        &mut self,
        model: &impl Dynamics<N, M, NY>,
        first: usize,
        difference: &[f64; N],
        noise: &[f64; N],
    ) {
        self.correction.fill(0.0);
        for m in 0..N {
            let innovation = difference[m] - self.correction[first + m];
            self.take(first + m, innovation, noise[m], |observer, i, change| {
                observer.correction[i] += change;
            });
        }
        let way = core::array::from_fn(|i| self.correction[i]);
        self.positions = model.integrate(&self.positions, &way);
        for i in 0..N {
            self.velocities[i] += self.correction[N + i];
        }
        for i in 0..M {
            self.disturbance[i] += self.correction[2 * N + i];
        }
    }

    /// Corrects the estimate with one measurement of entry `m` of the augmented state. With `s = P_m/√(P_mm + noise²)`,
    /// the state changes by `s innovation/√(P_mm + noise²)`, and P by `−s sᵀ`, which keeps its symmetry.
    fn take(&mut self, m: usize, innovation: f64, noise: f64, mut add: impl FnMut(&mut Self, usize, f64)) {
        let n = Self::SIZE;
        let deviation = (self.covariance[m * n + m] + noise * noise).sqrt();
        widened(
            #[inline(always)]
            || {
                let Self { covariance, work, .. } = self;
                let scaled = &mut work[..n];
                for (scaled, entry) in scaled.iter_mut().zip(&covariance[m * n..][..n]) {
                    *scaled = entry / deviation;
                }
                for (row, factor) in covariance.chunks_exact_mut(n).zip(&*scaled) {
                    add_scaled(row, -factor, scaled);
                }
            },
        );
        for i in 0..n {
            add(self, i, self.work[i] * (innovation / deviation));
        }
    }

    fn add(&mut self, i: usize, change: f64) {
        if i < N {
            self.positions[i] += change;
        } else if i < 2 * N {
            self.velocities[i - N] += change;
        } else {
            self.disturbance[i - 2 * N] += change;
        }
    }

    /// Whether the whole estimate is finite. An extreme measurement can make the next prediction overflow.
    pub(super) fn is_finite(&self) -> bool {
        let state = self.positions.iter().chain(&self.velocities);
        state.chain(&self.disturbance).all(|x| x.is_finite())
    }

    /// Estimated positions ŷ [rad or m].
    pub fn positions(&self) -> &[f64; NY] {
        &self.positions
    }

    /// Estimated velocities [rad/s or m/s].
    pub fn velocities(&self) -> &[f64; N] {
        &self.velocities
    }

    /// Estimated disturbance of each input, in the unit of the input.
    pub fn disturbance(&self) -> &[f64; M] {
        &self.disturbance
    }
}

/// Entry (i, k) of the derivatives of the state after a period with respect to the state before (A_d) and the
/// inputs (B_d), as one matrix (A_d, B_d).
fn sensitivity<const N: usize, const M: usize, const NY: usize>(
    step: &Step<N, M, NY>,
    i: usize,
    k: usize,
) -> f64 {
    let (half, i) = (i / N, i % N);
    if k < 2 * N { step.state[half][k / N][i][k % N] } else { step.input[half][i][k - 2 * N] }
}

#[inline(always)]
fn add_scaled(sum: &mut [f64], factor: f64, of: &[f64]) {
    for (sum, entry) in sum.iter_mut().zip(of) {
        *sum += factor * entry;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "test code")]

    use super::*;

    gelenk_dynamics::dynamics!(struct PowerCube = gelenk_generated::powercube);

    /// A difference between P and Pᵀ is not damped. It grew until the estimate was not finite, after minutes of motion.
    #[test]
    fn the_covariance_stays_symmetric() {
        let noise = ObserverOptions { disturbance_noise: [0.1; 2], ..ObserverOptions::default() };
        let mut observer = DisturbanceObserver::<2, 2>::new(noise).unwrap();
        for k in 0..200 {
            let t = 0.02 * f64::from(k);
            observer.predict(&PowerCube, &[2.0 * t.sin(), t.cos()], 0.02, 12);
            observer.correct(&[0.4 * t.sin(), -0.3 * t.cos()]);
            let n = DisturbanceObserver::<2, 2>::SIZE;
            for i in 0..n {
                for j in 0..i {
                    assert_eq!(
                        observer.covariance[i * n + j],
                        observer.covariance[j * n + i],
                        "({i}, {j}), {k}"
                    );
                }
            }
        }
    }
}
