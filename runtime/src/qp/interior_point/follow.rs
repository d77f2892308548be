//! Newton's method from the active set of the last solution.
//!
//! Each term of the method of multipliers ([`super::augmented`]) consists of quadratic pieces: away from the bound, at the
//! bound, and beyond a soft bound. One Newton step reaches the minimum on assumed pieces.
//!
//! 1. The first step assumes the pieces of the last solution.
//! 2. If the new point is on the assumed pieces, the forces become multipliers, and the point is certified. The
//!    certificate includes the largest decrease along the gradient without the weights W. Further steps with the same
//!    factorization remove the error due to the finite weight W.
//! 3. If the new point is on other pieces, the next step assumes these pieces.
//!
//! If the first assumed pieces are wrong, the interior-point method with a start near the last solution usually takes fewer
//! iterations. Failures depend on noise and motion, so they often occur in consecutive problems. Therefore each failure
//! increases the number of problems for which this method is skipped ([`super::super::pause`]).
//!
//! Source: Hintermüller, Ito, Kunisch, *The primal-dual active set strategy as a semismooth Newton method*, SIAM J.
//! Optim. 13 (2002), section 3.

use super::super::core::Core;
use super::super::lanes::Vector;
use super::super::ldl::{factor_ldl, solve_ldl};
use super::super::problem::QpProblem;
use super::super::status::{KktResiduals, QpReport, QpStatus};

/// Largest number of factorizations. With 2 instead of 4 factorizations, the number of iterations in the benchmark
/// `control_step` changes by −4 % (UR5), −6 % (Panda), +18 % (PowerCube) and +40 % (quadrotor).
const MOST: usize = 4;
/// Largest number of steps with the same factorization.
const REPEATED: usize = 3;
/// Weight W of states and rows, relative to the largest weight of the cost. The weight of inputs is `RIGID`
/// times as large, because the weight of the states acts on the inputs through the dynamics.
const WEIGHT: f64 = 1e7;
const RIGID: f64 = 10.0;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Solves the loaded problem from the active set of the solution in memory.
    ///
    /// # Errors
    /// If this method does not find the solution, the error is the number of iterations that were made.
    pub(in crate::qp) fn follow(&mut self, problem: &QpProblem<NX, NU, NR>) -> Result<QpReport, usize> {
        if !self.pause.is_over() {
            return Err(0);
        }
        let followed = self.pursue(problem);
        self.pause = self.pause.after(followed.is_ok());
        followed
    }

    fn pursue(&mut self, problem: &QpProblem<NX, NU, NR>) -> Result<QpReport, usize> {
        // If a cold start replaces this start, it clears the data that this start leaves.
        self.solved = false;
        let weight = factor_ldl(self.riccati.r).map_err(|_| 0_usize)?;
        let scale = self.riccati.largest;
        let w = [RIGID * WEIGHT * scale, WEIGHT * scale];
        self.recall(scale);
        self.augment(w, true);
        let (most, mut iterations, mut repeated) = (MOST.min(self.settings.max_iterations), 0, 0);
        let mut known = false;
        while known || iterations < most {
            if !known {
                self.riccati.factorize(&self.weight, None, &self.rows).map_err(|_| iterations)?;
                // `best` stores the active set of the present factorization.
                self.best.copy_from(&self.weight);
                iterations += 1;
            }
            self.augmented_step();
            self.iterate.advance(&self.step, 1.0);
            self.augment(w, false);
            known = !self.weight.differs_from(&self.best);
            if known {
                self.take_forces(w);
                let certificate = self.certify(problem);
                let hidden = self.settle(problem, &weight);
                let proven = certificate.residuals.gap + hidden <= certificate.allowed;
                if certificate.holds() && proven && self.status(&certificate) == QpStatus::Solved {
                    self.solved = true;
                    let report = certificate.report(QpStatus::Solved, self.counted(iterations));
                    let stationarity = self.gradient.largest_input();
                    return Ok(QpReport {
                        residuals: KktResiduals { stationarity, ..report.residuals },
                        ..report
                    });
                }
                if repeated == REPEATED {
                    break;
                }
                repeated += 1;
                self.input_bounds.recall(0.0, &self.solution.u, &self.multipliers[0]);
                self.augment(w, true);
                known = !self.weight.differs_from(&self.best);
            }
        }
        Err(iterations)
    }

    /// Corrects the multipliers of inputs at a bound by the reduced gradient. The force `−W d` of the weight
    /// W at the distance d has few correct digits. Returns an upper bound `½ gᵀ R⁻¹ g` of the decrease of the
    /// cost along the remaining gradient g, with the input weights R. The decrease in the certificate is
    /// computed with the weights W, so it does not show the decrease for a bound that should not be active.
    fn settle(&mut self, problem: &QpProblem<NX, NU, NR>, weight: &[[f64; NU]; NU]) -> f64 {
        let mut gain = 0.0;
        for (k, stage) in problem.stages.iter().enumerate() {
            let (u, mut g) = (self.solution.input::<NU>(k), self.gradient.input::<NU>(k));
            for i in 0..NU {
                let [at_lower, at_upper] = [u[i] == stage.input_lower[i], u[i] == stage.input_upper[i]];
                if at_lower || at_upper {
                    let [lower, upper] = self.multipliers[0].get(k * NU + i);
                    let force = lower - upper + g[i];
                    let kept = [
                        if at_lower { force.max(0.0) } else { 0.0 },
                        if at_upper { (-force).max(0.0) } else { 0.0 },
                    ];
                    self.multipliers[0].set(k * NU + i, kept);
                    g[i] = force - kept[0] + kept[1];
                }
            }
            let moved = solve_ldl(weight, &g);
            gain += g.iter().zip(&moved).map(|(g, u)| 0.5 * g * u).sum::<f64>();
            self.gradient.set_input(k, &g);
        }
        gain
    }

    /// Sets the iterate to the inputs of the solution in memory and the states that follow from them, with
    /// the multipliers of its active set.
    pub(super) fn recall(&mut self, scale: f64) {
        self.iterate.copy_from(&self.solution);
        let [of_inputs, of_states] = &self.multipliers;
        self.input_bounds.recall(scale, &self.iterate.u, of_inputs);
        self.state_bounds.recall(scale, &self.iterate.x, of_states);
        self.equalities.start(Some(of_states));
        self.fixed.place(&mut self.iterate.u);
        self.riccati.roll_out(&mut self.iterate, &self.affine);
        self.rows.evaluate(&mut self.iterate);
    }

    /// The reported number of iterations. A single iteration without active bounds counts as 0.
    fn counted(&self, iterations: usize) -> usize {
        if self.has_active_bounds() { iterations } else { iterations - 1 }
    }

    /// Whether a bound or row has a force.
    pub(super) fn has_active_bounds(&self) -> bool {
        self.equalities.any() || self.input_bounds.is_active() || self.state_bounds.is_active()
    }
}
