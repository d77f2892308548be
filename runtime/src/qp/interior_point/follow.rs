//! Newton's method from the active set of the last solution.
//!
//! The terms of the method of multipliers ([`super::augmented`]) are quadratic on each piece: off the bound, at it, and
//! beyond a soft one. One Newton step reaches the minimum of the pieces that it assumes. If the pieces there are those
//! that were assumed, the forces become multipliers and the point is certified, with what its gradient may gain at most
//! without the weights; what is left of it by the finite weight
//! W goes in further steps with the same factorization. Otherwise the pieces there are assumed next. The first step
//! assumes those of the last solution. If the first sets are not the right one, the interior-point method takes fewer iterations
//! from near the last solution. Noise and motion decide whether that happens, so that it often happens in a row: after each failure more
//! problems are left to it at once ([`super::super::pause`]).
//!
//! Source: Hintermüller, Ito, Kunisch, *The primal-dual active set strategy as a semismooth Newton method*, SIAM J.
//! Optim. 13 (2002), section 3.

use super::super::core::{Core, Start};
use super::super::lanes::Vector;
use super::super::ldl::{factor_ldl, solve_ldl};
use super::super::problem::QpProblem;
use super::super::status::{KktResiduals, QpReport, QpStatus};

/// Most factorizations, and steps that repeat one. With 2 factorizations the bench `control_step` has 4 and 6 % fewer iterations for UR5
/// and Panda, 18 and 40 % more for PowerCube and the quadrotor.
const MOST: usize = 4;
const REPEATED: usize = 3;
/// The weight W of states and rows, relative to the largest weight of the cost; that of inputs is `RIGID` times as
/// large, since that of the states acts on them through the dynamics.
const WEIGHT: f64 = 1e7;
const RIGID: f64 = 10.0;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Solves the problem from the active set of the solution in memory.
    ///
    /// # Errors
    /// Where to start instead, and the number of iterations, if that does not lead to its solution.
    pub(in crate::qp) fn follow(
        &mut self,
        problem: &QpProblem<NX, NU, NR>,
    ) -> Result<QpReport, (Start, usize)> {
        if !self.solved {
            return Err((Start::Cold, 0));
        }
        if !self.pause.is_over() {
            return Err((Start::Near, 0));
        }
        let followed = self.pursue(problem);
        self.pause = self.pause.after(followed.is_ok());
        followed.map_err(|iterations| (Start::Near, iterations))
    }

    fn pursue(&mut self, problem: &QpProblem<NX, NU, NR>) -> Result<QpReport, usize> {
        // A cold start in place of this one forgets what it leaves.
        self.solved = false;
        self.load(problem);
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
                // The set that is factorized.
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

    /// Takes the multipliers of inputs at a bound from the reduced gradient: the force `−W d` has few digits. Returns
    /// by how much the rest of the gradient g may lower the cost at most, `½ gᵀ R⁻¹ g` with the factors of R; the certificate's own measure
    /// has the weights W, which hide what a bound kept by mistake would gain.
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

    /// The inputs of the solution in memory and where they lead to, with the multipliers of its active set.
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

    /// 0 for one iteration that has found no bound active.
    fn counted(&self, iterations: usize) -> usize {
        if self.has_active_bounds() { iterations } else { iterations - 1 }
    }

    /// True if a bound or row has a force.
    pub(super) fn has_active_bounds(&self) -> bool {
        self.equalities.any() || self.input_bounds.is_active() || self.state_bounds.is_active()
    }
}
