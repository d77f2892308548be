//! Choice of the acting law by prequential comparison.

/// Samples before which the described law acts.
const FEWEST: f64 = 20.0;

/// Share of samples beyond the interval from which on the described law acts.
const CONTRADICTED: f64 = 0.5;

/// Share of the torque's variance that may remain unexplained by the learned law, or the described one acts: with a swapped sign, no
/// law within the box explains much of it.
const UNEXPLAINED: f64 = 0.5;

/// Acting law of a joint, and the reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trust {
    /// There are too few samples, or the friction that was learned without bounds accelerates the joint: the described law acts.
    Unknown,
    /// The learned law predicts better and acts.
    Learned,
    /// The described law predicts better and acts.
    Described,
    /// Most residuals are outside the interval, or the learned law explains less than half of the torque's
    /// variance, as in contact or with a wrong sensor: the described law acts.
    Contradicted,
}

impl Trust {
    /// Name in logs.
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

/// Leaky means of the squared one-step prediction errors.
///
/// Each error is that of the law before it learned from the sample (Dawid, *J. R. Stat. Soc. A* 147, 1984),
/// so additional terms give no unearned advantage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Comparison {
    /// Sums of squared errors: described, learned.
    pub squares: [f64; 2],
    pub taken: f64,
    pub excluded: f64,
    /// Sums that include excluded samples: squared errors of the learned law, squared torques, torques,
    /// number of samples.
    pub all: [f64; 4],
}

impl Comparison {
    pub(super) const NEW: Self = Self { squares: [0.0; 2], taken: 0.0, excluded: 0.0, all: [0.0; 4] };

    /// Adds any sample: error of the learned law, and torque.
    pub(super) fn whole(&mut self, [error, torque]: [f64; 2], keep: f64) {
        let sums = self.squares.iter_mut().chain([&mut self.taken, &mut self.excluded]).chain(&mut self.all);
        sums.for_each(|sum| *sum *= keep);
        for (sum, value) in self.all.iter_mut().zip([error * error, torque * torque, torque, 1.0]) {
            *sum += value;
        }
    }

    /// Adds the errors of both laws.
    pub(super) fn take(&mut self, errors: [f64; 2]) {
        for (square, error) in self.squares.iter_mut().zip(errors) {
            *square += error * error;
        }
        self.taken += 1.0;
    }

    /// Counts a sample outside the interval.
    pub(super) fn exclude(&mut self) {
        self.excluded += 1.0;
    }

    /// - `dissipates`: whether the friction that was learned without bounds dissipates
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

    /// Root-mean-square errors: described, learned [N m or N]; NaN before the first sample.
    pub(super) fn errors(&self) -> [f64; 2] {
        self.squares.map(|square| super::law::root(square / self.taken))
    }
}
