//! Causal filter for torques and regressors, and computation of the motion at one instant.

use super::law::TERMS;

/// Number of filtered signals: the terms, the torque that the described robot does not explain, and the applied
/// torque.
pub(super) const SIGNALS: usize = TERMS + 2;

/// Low-pass filter 1/(τ s + 1)² with two equal poles of the time constant τ, in discrete time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LowPass<const S: usize = SIGNALS> {
    pub states: [[f64; S]; 2],
}

impl<const S: usize> LowPass<S> {
    pub(super) const ZERO: Self = Self { states: [[0.0; S]; 2] };

    /// Filters one sample of all signals.
    ///
    /// - `weight`: weight T/(T + τ) of the new sample, with the period T and the time constant τ of the
    ///   filter
    pub(super) fn take(&mut self, signals: &[f64; S], weight: f64) -> [f64; S] {
        let [first, second] = &mut self.states;
        for i in 0..S {
            first[i] += weight * (signals[i] - first[i]);
            second[i] += weight * (first[i] - second[i]);
        }
        *second
    }
}

/// The last three measurements of all joints.
///
/// At the middle measurement, the velocity is the central difference of the positions, and the acceleration
/// is their second difference. The low-pass filter L is applied to the torque of the inertia, `L[M (v⁺ −
/// v⁻)/T]`. M is the mass matrix, T is the period, and v⁻ and v⁺ are the mean velocities of two periods. This
/// is the momentum form of Slotine and Li (*Int. J. Robotics Research* 6, 1987) in discrete time. By the
/// product rule of differences,
///
/// ```text
///     M_k (v⁺ − v⁻) = (M⁺ v⁺ − M⁻ v⁻) − (M⁺ − M⁻) v        M⁺, M⁻ half a period later and earlier, up to O(T³)
/// ```
///
/// Therefore L filters differences of the momentum, and noise only passes within the bandwidth of L. The derivative of M is not
/// needed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window<const N: usize> {
    positions: [[f64; N]; 3],
    /// Number of consecutive measurements.
    length: usize,
}

impl<const N: usize> Window<N> {
    pub(super) const EMPTY: Self = Self { positions: [[0.0; N]; 3], length: 0 };

    pub(super) fn clear(&mut self) {
        self.length = 0;
    }

    /// Adds a measurement.
    pub(super) fn push(&mut self, positions: &[f64; N]) {
        self.positions = [self.positions[1], self.positions[2], *positions];
        self.length = (self.length + 1).min(3);
    }

    /// Positions, velocities and accelerations one period ago; `None` for fewer than three consecutive measurements.
    pub(super) fn middle(&self, period: f64) -> Option<[[f64; N]; 3]> {
        let [before, middle, after] = &self.positions;
        (self.length == 3).then(|| {
            [
                *middle,
                core::array::from_fn(|i| (after[i] - before[i]) / (2.0 * period)),
                core::array::from_fn(|i| {
                    ((after[i] - middle[i]) - (middle[i] - before[i])) / (period * period)
                }),
            ]
        })
    }
}
