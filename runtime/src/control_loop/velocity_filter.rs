//! Measured velocities, or velocities estimated from positions.

/// Filter for the velocities of joints. If velocities are measured, it returns them. Otherwise it estimates them
/// by low-pass filtered differences of positions,
///
/// ```text
///     v̂ += Δt/(Δt + T_v) ((y − y_before)/Δt − v̂)
/// ```
///
/// with the time constant T_v and the time Δt between two positions. The delay of a difference is Δt/2. The
/// filter adds the delay T_v. If T_v = 0, the velocity is the unfiltered difference.
///
/// ```
/// use gelenk_runtime::control_loop::VelocityFilter;
///
/// let mut filter = VelocityFilter::new(0.01, [1.0]);
/// for k in 1..=50 {
///     filter.update(&[1.0 + 0.005 * f64::from(k)], 0.01);
/// }
/// assert!((filter.velocities()[0] - 0.5).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityFilter<const N: usize> {
    time_constant: f64,
    positions: [f64; N],
    velocities: [f64; N],
}

impl<const N: usize> VelocityFilter<N> {
    /// A filter at rest at `positions` [rad or m]. A `time_constant` (s) that is negative or NaN counts as 0.
    #[must_use]
    pub fn new(time_constant: f64, positions: [f64; N]) -> Self {
        Self { time_constant: time_constant.max(0.0), positions, velocities: [0.0; N] }
    }

    /// Updates the velocities with positions [rad or m], `span` seconds after the previous positions. Returns
    /// false and changes nothing if the velocity is undefined, because `span` is not positive or a number is
    /// not finite or overflows.
    pub fn update(&mut self, positions: &[f64; N], span: f64) -> bool {
        let weight = span / (span + self.time_constant);
        let velocities: [f64; N] = core::array::from_fn(|i| {
            let slope = (positions[i] - self.positions[i]) / span;
            self.velocities[i] + weight * (slope - self.velocities[i])
        });
        let possible = span > 0.0 && velocities.iter().all(|v| v.is_finite());
        if possible {
            (self.positions, self.velocities) = (*positions, velocities);
        }
        possible
    }

    /// Updates the filter with positions [rad or m] and measured velocities [rad/s or m/s]. The measured velocities
    /// are not filtered. Returns false and changes nothing if a number is not finite.
    pub fn update_measured(&mut self, positions: &[f64; N], velocities: &[f64; N]) -> bool {
        let possible = positions.iter().chain(velocities).all(|x| x.is_finite());
        if possible {
            (self.positions, self.velocities) = (*positions, *velocities);
        }
        possible
    }

    /// Last positions [rad or m].
    #[must_use]
    pub fn positions(&self) -> &[f64; N] {
        &self.positions
    }

    /// Velocities [rad/s or m/s].
    #[must_use]
    pub fn velocities(&self) -> &[f64; N] {
        &self.velocities
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_settle_at_the_slope() {
        let mut filter = VelocityFilter::new(0.01, [1.0]);
        for k in 1..=50 {
            assert!(filter.update(&[1.0 + 0.005 * f64::from(k)], 0.01));
        }
        assert!((filter.velocities()[0] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn measured_velocities_are_taken_as_they_are() {
        let mut filter = VelocityFilter::new(0.01, [1.0]);
        assert!(filter.update_measured(&[1.1], &[-3.0]));
        assert_eq!((filter.positions(), filter.velocities()), (&[1.1], &[-3.0]));
    }

    #[test]
    fn what_gives_no_velocity_is_not_taken() {
        let mut filter = VelocityFilter::new(f64::NAN, [1.0]);
        let before = filter.clone();
        for (y, span) in [
            (2.0, 0.0),
            (2.0, -0.01),
            (2.0, f64::NAN),
            (2.0, f64::INFINITY),
            (2.0, 5e-324),
            (f64::NAN, 0.01),
            (f64::INFINITY, 0.01),
            (1e308, 1e-3),
        ] {
            assert!(!filter.update(&[y], span), "{y} after {span}");
            assert_eq!(filter, before);
        }
        for (y, v) in [(f64::NAN, 1.0), (1.0, f64::NAN), (1.0, f64::INFINITY)] {
            assert!(!filter.update_measured(&[y], &[v]));
            assert_eq!(filter, before);
        }
        assert!(filter.update(&[1.1], 0.01), "and it goes on");
        assert!((filter.velocities()[0] - 10.0).abs() < 1e-12);
    }
}
