//! Whether least squares is biased by noise in the motion.

/// Durbin–Wu–Hausman test.
#[derive(Debug, Clone, PartialEq)]
pub struct BiasTest {
    /// Wald statistic.
    pub statistic: f64,
}
