//! Choice of the acting law by comparison of prediction errors.

/// Number of samples before which the described law acts.
const FEWEST: f64 = 20.0;

/// Share of samples outside the prediction interval above which the described law acts.
const CONTRADICTED: f64 = 0.5;

/// Share of the variance of the torque that the learned law may leave unexplained. Above this share the described law acts. For
/// example, if a sign is wrong, no law within the bounds explains the torque.
const UNEXPLAINED: f64 = 0.5;

/// The law that controllers use for a joint (the acting law), with the reason. For a [`LoadEstimator`](super::LoadEstimator),
/// the learned law is the robot with the learned load, and the described law is the robot without load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trust {
    /// The described law acts, because fewer than 20 samples are available, or because the friction that was learned without
    /// bounds would accelerate the joint.
    Unknown,
    /// The learned law acts, because it predicts the torques better than the described law.
    Learned,
    /// The described law acts, because it predicts the torques at least as well as the learned law.
    Described,
    /// The described law acts, because most residuals are outside the prediction interval, or the learned law explains less
    /// than half of the variance of the torque. Possible reasons are contact or a wrong sensor.
    Contradicted,
}

impl Trust {
    /// Returns the name of the variant for logs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Learned => "learned",
            Self::Described => "described",
            Self::Contradicted => "contradicted",
        }
    }
}

/// Leaky sums of the squared one-step prediction errors of both laws.
///
/// Each error is computed before the law learns from the sample (prequential, Dawid, *J. R. Stat. Soc. A* 147, 1984). Therefore
/// additional terms only have an advantage if they improve the prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Comparison {
    /// Sums of squared errors of the described and of the learned law.
    pub squares: [f64; 2],
    pub taken: f64,
    pub excluded: f64,
    /// Sums that include excluded samples: squared errors of the learned law, squared torques, torques, and number of samples.
    pub all: [f64; 4],
}

impl Comparison {
    pub(super) const NEW: Self = Self { squares: [0.0; 2], taken: 0.0, excluded: 0.0, all: [0.0; 4] };

    /// Adds a sample, also if it will be excluded. `error` is the error of the learned law.
    pub(super) fn whole(&mut self, [error, torque]: [f64; 2], keep: f64) {
        let sums = self.squares.iter_mut().chain([&mut self.taken, &mut self.excluded]).chain(&mut self.all);
        sums.for_each(|sum| *sum *= keep);
        for (sum, value) in self.all.iter_mut().zip([error * error, torque * torque, torque, 1.0]) {
            *sum += value;
        }
    }

    /// Adds the errors of the described and of the learned law for a sample that is not excluded.
    pub(super) fn take(&mut self, errors: [f64; 2]) {
        for (square, error) in self.squares.iter_mut().zip(errors) {
            *square += error * error;
        }
        self.taken += 1.0;
    }

    /// Counts a sample outside the prediction interval.
    pub(super) fn exclude(&mut self) {
        self.excluded += 1.0;
    }

    /// Decides which law acts.
    ///
    /// - `dissipates`: whether the friction that was learned without bounds dissipates energy
    pub(super) fn trust(&self, dissipates: bool) -> Trust {
        let ([described, learned], [unexplained, squares, sum, count]) = (self.squares, self.all);
        let variance = squares - sum * sum / count.max(1.0);
        if self.taken + self.excluded < FEWEST {
            Trust::Unknown
        } else if unexplained > UNEXPLAINED * variance
            || self.excluded > CONTRADICTED * (self.taken + self.excluded)
        {
            Trust::Contradicted
        } else if !dissipates {
            Trust::Unknown
        } else if learned < described {
            Trust::Learned
        } else {
            Trust::Described
        }
    }

    /// Root-mean-square errors of the described and of the learned law [N m or N]; NaN before the first sample.
    pub(super) fn errors(&self) -> [f64; 2] {
        self.squares.map(|square| super::law::root(square / self.taken))
    }
}
