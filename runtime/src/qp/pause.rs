//! Pauses of Newton's method in warm starts. After a failure of Newton's method, some problems are solved without it
//! (exponential backoff).

/// Longest pause, in problems. For the value 3, the number of iterations in the benchmark `control_step` differs by less
/// than 1 %.
const LONGEST: u32 = 31;

/// A pause of n problems. A failure of Newton's method changes n to 2n + 1, up to [`LONGEST`]. A success changes n to 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Pause {
    length: u32,
    left: u32,
}

impl Pause {
    /// Whether Newton's method is tried for the next problem. If not, the remaining pause becomes shorter by one problem.
    pub(super) fn is_over(&mut self) -> bool {
        let is_over = self.left == 0;
        self.left = self.left.saturating_sub(1);
        is_over
    }

    pub(super) fn after(self, success: bool) -> Self {
        let length = if success { 0 } else { (2 * self.length + 1).min(LONGEST) };
        Self { length, left: length }
    }
}

#[cfg(test)]
mod tests {
    use super::Pause;

    #[test]
    fn failures_lengthen_the_pause_and_a_success_ends_it() {
        let mut pause = Pause::default();
        let mut tried = Vec::new();
        for problem in 0..70 {
            if pause.is_over() {
                tried.push(problem);
                pause = pause.after(false);
            }
        }
        // The pauses are 1, 3, 7, 15 and 31 problems.
        assert_eq!(tried, [0, 2, 6, 14, 30, 62]);
        pause = pause.after(true);
        assert!(pause.is_over() && pause.is_over());
    }
}
