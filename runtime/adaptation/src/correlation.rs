//! Number of correlated samples that have the information of one independent sample.

/// Number of cells for the position.
const POSITIONS: usize = 16;
/// Number of cells for position and direction.
pub(super) const CELLS: usize = 2 * POSITIONS;

/// Estimator of the correlation of residuals between consecutive samples, and between samples at the same position and with the
/// same direction.
///
/// The torque of a gear has a ripple that depends on its position. A repeated motion therefore repeats its residuals, and these
/// samples add no information. Residuals are grouped in C cells of position and direction. The leaky count of cell c is n_c, and
/// the leaky sum of its residuals ε is s_c. The variance σ_b² between cells and the variance σ_w² within cells follow from one-way
/// analysis of variance with random effects. The design effect d of Kish (*Survey Sampling*, 1965, section 5.4) is the number of
/// samples that have the information of one independent sample:
///
/// ```text
///     σ_b² = (Σ s_c²/n_c − C σ_w²)/n     σ_w² = (Σ ε² − Σ s_c²/n_c)/(n − C)     ρ = σ_b²/(σ_b² + σ_w²)     d = 1 + (n_c − 1) ρ
/// ```
///
/// If consecutive samples have the correlation r, (1 + r)/(1 − r) samples have the information of one independent sample
/// (first-order autoregression). The larger of the two numbers is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Correlation {
    pub counts: [f64; CELLS],
    pub sums: [f64; CELLS],
    /// Leaky sum of the squares of residuals.
    pub squares: f64,
    /// Leaky sum of the products of consecutive residuals.
    pub products: f64,
    /// Previous residual; 0 after a pause.
    pub last: f64,
}

impl Correlation {
    pub(super) const NEW: Self =
        Self { counts: [0.0; CELLS], sums: [0.0; CELLS], squares: 0.0, products: 0.0, last: 0.0 };

    /// Adds a residual. Returns the number of correlated samples that have the information of one independent sample.
    ///
    /// - `share`: position relative to the range of positions, which is divided into cells
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

/// Index of the cell of a position and direction. Cells repeat with the range.
fn cell(share: f64, forwards: bool) -> usize {
    let place = share * POSITIONS as f64;
    // Positions are finite and velocities are bounded, so a cell number beyond the integers does not occur. It would saturate.
    let towards_zero = place as i64;
    let below = towards_zero - i64::from(place < towards_zero as f64);
    let index = below.rem_euclid(POSITIONS as i64) as usize;
    2 * index + usize::from(forwards)
}
