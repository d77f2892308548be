//! Effective number of correlated samples.

/// Cells of the position.
const POSITIONS: usize = 16;
/// Cells of position and direction.
pub(super) const CELLS: usize = 2 * POSITIONS;

/// Correlation of the residuals: between consecutive samples, and among samples of the same position and
/// direction.
///
/// The torque of a gear ripples with its position, so a repeated motion repeats its residuals, and these
/// samples add no information. Residuals are grouped in cells of position and direction. Cell c has the leaky
/// count n_c and sum of residuals s_c. The variance between cells follows from one-way analysis of variance
/// with random effects. A sample counts for 1/d samples, with the design effect of Kish (*Survey Sampling*,
/// 1965, section 5.4):
///
/// ```text
///     σ_b² = (Σ s_c²/n_c − C σ_w²)/n     σ_w² = (Σ ε² − Σ s_c²/n_c)/(n − C)     ρ = σ_b²/(σ_b² + σ_w²)     d = 1 + (n_c − 1) ρ
/// ```
///
/// Consecutive samples with correlation r count for (1 − r)/(1 + r) samples, as in a first-order
/// autoregression. The larger reduction is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Correlation {
    pub counts: [f64; CELLS],
    pub sums: [f64; CELLS],
    /// Sums of squares, and of products of consecutive residuals.
    pub squares: f64,
    pub products: f64,
    /// Previous residual; 0 after a pause.
    pub last: f64,
}

impl Correlation {
    pub(super) const NEW: Self =
        Self { counts: [0.0; CELLS], sums: [0.0; CELLS], squares: 0.0, products: 0.0, last: 0.0 };

    /// Adds a residual at a position (a share of the cells' range); returns the number of correlated samples
    /// that count as one.
    ///
    /// - `keep`: decay factor of the sums from one sample to the next
    pub(super) fn take(&mut self, residual: f64, share: f64, forwards: bool, keep: f64) -> f64 {
        let cell = cell(share, forwards);
        for (count, sum) in self.counts.iter_mut().zip(&mut self.sums) {
            *count *= keep;
            *sum *= keep;
        }
        self.counts[cell] += 1.0;
        self.sums[cell] += residual;
        self.squares = keep * self.squares + residual * residual;
        self.products = keep * self.products + residual * self.last;
        self.last = residual;
        self.repeated(cell).max(self.serial())
    }

    fn repeated(&self, cell: usize) -> f64 {
        let (mut between, mut total, mut used) = (0.0, 0.0, 0.0);
        for (count, sum) in self.counts.iter().zip(&self.sums) {
            let full = if *count >= 1.0 { 1.0 } else { 0.0 };
            between += full * sum * sum / count.max(1.0);
            total += full * count;
            used += full;
        }
        let freedom = total - used;
        if freedom < used {
            return 1.0;
        }
        let within = ((self.squares - between) / freedom).max(0.0);
        let variance = ((between - used * within) / total).max(0.0);
        let correlation = variance / (variance + within).max(f64::MIN_POSITIVE);
        1.0 + (self.counts[cell] - 1.0).max(0.0) * correlation
    }

    fn serial(&self) -> f64 {
        let r = (self.products / self.squares.max(f64::MIN_POSITIVE)).clamp(0.0, 0.98);
        (1.0 + r) / (1.0 - r)
    }
}

/// Cells repeat: a position beyond the range has that of its remainder.
fn cell(share: f64, forwards: bool) -> usize {
    let place = share * POSITIONS as f64;
    // Positions are finite and velocities bounded: a cell number far beyond the integers does not occur, and would saturate.
    let towards_zero = place as i64;
    let below = towards_zero - i64::from(place < towards_zero as f64);
    let index = below.rem_euclid(POSITIONS as i64) as usize;
    2 * index + usize::from(forwards)
}
