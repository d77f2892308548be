//! Sweeps of the Riccati recursion. They compute solutions for a right-hand side, gradients, and roll-outs (the states
//! that follow from inputs).

use super::lanes::{Vector, at, dot, flat, flat_mut, reduce_each, vectorized};
use super::ldl::solve_ldl;
use super::riccati::{MAX_LANES, Riccati};
use super::trajectory::Trajectory;

impl<V: Vector, const NX: usize, const NU: usize> Riccati<V, NX, NU> {
    /// Computes the minimizer `step` for the linear costs `gradient`.
    ///
    /// - `affine`: affine terms c of the dynamics `x⁺ = A x + B u + c` for which the last factorization was
    ///   prepared; `None` for c = 0
    pub(crate) fn solve(&self, gradient: &Trajectory<V>, step: &mut Trajectory<V>, affine: Option<&[V]>) {
        vectorized!(V, {
            self.backward(gradient, flat_mut(&mut step.u), affine.is_some());
            self.forward(flat_mut(&mut step.u), &mut step.x, affine);
        })
    }

    /// Decrease `½ Σ wᵀ (Λ D Λᵀ)⁻¹ w` of a function by a Newton step. w are the gradients of the inputs after
    /// the dynamics are eliminated, and `Λ D Λᵀ` are the input Hessians of the last factorization. `gradient`
    /// are the gradients with respect to inputs and states before the dynamics are eliminated. `scratch` is
    /// overwritten.
    pub(crate) fn decrease(&self, gradient: &Trajectory<V>, scratch: &mut Trajectory<V>) -> f64 {
        vectorized!(V, { self.backward(gradient, flat_mut(&mut scratch.u), false) })
    }

    /// Computes the backward sweep. Writes the feed-forward terms `d_k` to `d`, and returns the decrease of the cost by
    /// these terms.
    #[inline(always)]
    fn backward(&self, gradient: &Trajectory<V>, d: &mut [f64], affine: bool) -> f64 {
        let mut decrease = 0.0;
        let n = Self::RX;
        let rate = self.rate.is_some();
        let mut p = [V::zero(); MAX_LANES];
        let mut pv = [0.0; NU];
        p[..n].copy_from_slice(&gradient.x[(self.horizon - 1) * n..][..n]);
        for k in (0..self.horizon).rev() {
            let mut e = gradient.input::<NU>(k);
            if rate {
                for j in 0..NU {
                    e[j] += pv[j];
                }
            }
            if affine {
                for r in 0..n {
                    p[r] += self.pc[k * n + r];
                }
                if rate {
                    let s = &self.sc[k];
                    for j in 0..NU {
                        e[j] += s[j];
                    }
                }
            }
            let b = &self.b[k * NU * n..][..NU * n];
            let mut w = e;
            for j in 0..NU {
                w[j] += dot(&b[j * n..][..n], &p[..n]);
            }
            let step = solve_ldl(&self.ldl[k], &w);
            for j in 0..NU {
                d[k * NU + j] = -step[j];
                decrease += 0.5 * step[j] * w[j];
            }
            if k == 0 {
                break;
            }
            if rate {
                pv = [0.0; NU];
                for i in 0..NU {
                    for j in 0..NU {
                        pv[j] += self.kv[k][i][j] * w[i];
                    }
                }
            }
            self.costate(k, &gradient.x[(k - 1) * n..][..n], &e, &mut p);
        }
        decrease
    }

    /// Computes the costate `p = g + Kᵀe + Φᵀp⁺` of a stage from the costate p⁺ of the next stage, the
    /// gradient g of the states, the gain K and the closed-loop matrix Φ.
    #[inline(always)]
    fn costate(&self, k: usize, g: &[V], e: &[f64; NU], p: &mut [V; MAX_LANES]) {
        let n = Self::RX;
        let phi = &self.phi[k * NX * n..][..NX * n];
        let gain = &self.k[k * NU * n..][..NU * n];
        let old = *p;
        for r in 0..n {
            let mut sum = [g[r], V::zero()];
            for j in 0..NU {
                sum[0] = gain[j * n + r].mul_add(V::splat(e[j]), sum[0]);
            }
            for i in 0..NX {
                sum[i % 2] = phi[i * n + r].mul_add(V::splat(at(&old, i)), sum[i % 2]);
            }
            p[r] = sum[0] + sum[1];
        }
    }

    /// Computes the forward sweep. Replaces the feed-forward terms in `u` by the inputs, and writes the states to `x`.
    #[inline(always)]
    fn forward(&self, u: &mut [f64], x: &mut [V], affine: Option<&[V]>) {
        let n = Self::RX;
        let rate = self.rate.is_some();
        let mut state = [V::zero(); MAX_LANES];
        let mut last = [0.0; NU];
        for k in 0..self.horizon {
            let b = &self.b[k * NU * n..][..NU * n];
            let u = &mut u[k * NU..][..NU];
            if rate && k > 0 {
                for i in 0..NU {
                    for j in 0..NU {
                        u[i] += self.kv[k][i][j] * last[j];
                    }
                }
            }
            let mut next = [V::zero(); MAX_LANES];
            if let Some(c) = affine {
                next[..n].copy_from_slice(&c[k * n..][..n]);
            }
            if k > 0 {
                add_product::<V, NX>(&self.phi[k * NX * n..][..NX * n], &state, &mut next, n);
            }
            for j in 0..NU {
                for r in 0..n {
                    next[r] = b[j * n + r].mul_add(V::splat(u[j]), next[r]);
                }
            }
            if k > 0 {
                let gain = &self.k[k * NU * n..][..NU * n];
                for j in 0..NU {
                    u[j] += dot(&gain[j * n..][..n], &state[..n]);
                }
            }
            last.copy_from_slice(u);
            x[k * n..][..n].copy_from_slice(&next[..n]);
            state = next;
        }
    }

    /// Computes the states of the dynamics `x⁺ = A x + B u + c` from the inputs u, with the affine terms c.
    /// The first affine term includes the contribution of the initial state.
    pub(crate) fn roll_out(&self, z: &mut Trajectory<V>, affine: &[V]) {
        vectorized!(V, {
            let mut state = [V::zero(); MAX_LANES];
            for k in 0..self.horizon {
                state = self.follow(k, &state, &z.input(k), affine);
                z.x[k * Self::RX..][..Self::RX].copy_from_slice(&state[..Self::RX]);
            }
        })
    }

    /// Computes the states like [`Self::roll_out`], but with sums in another order and therefore other rounding errors. Two
    /// orders of a sum of n terms differ by up to 2nε times the sum of the magnitudes (Higham, *Accuracy and Stability of
    /// Numerical Algorithms*, 2002, section 3.1).
    pub(crate) fn roll_out_otherwise(&self, z: &mut Trajectory<V>, affine: &[V]) {
        vectorized!(V, {
            let error = 2.0 * (NX + NU) as f64 * f64::EPSILON;
            let (more, less) = (1.0 + error, 1.0 - error);
            let mut state = [V::zero(); MAX_LANES];
            for k in 0..self.horizon {
                let mut input = z.input::<NU>(k);
                for u in &mut input {
                    *u *= less;
                }
                state = self.follow(k, &state, &input, affine);
                z.x[k * Self::RX..][..Self::RX].copy_from_slice(&state[..Self::RX]);
                for x in &mut state[..Self::RX] {
                    *x = *x * V::splat(more);
                }
            }
        })
    }

    /// Replaces the inputs of `z` by `limit(k, u_k)`, and the states by those that follow from these inputs. The gains of the
    /// last factorization change later inputs so that they counteract the changes and the rounding errors. Otherwise an
    /// unstable system would amplify them.
    pub(crate) fn project(
        &self,
        z: &mut Trajectory<V>,
        affine: &[V],
        limit: impl Fn(usize, [f64; NU]) -> [f64; NU],
    ) {
        vectorized!(V, {
            let n = Self::RX;
            let (mut state, mut off) = ([V::zero(); MAX_LANES], [V::zero(); MAX_LANES]);
            let mut last = [0.0; NU];
            for k in 0..self.horizon {
                let planned = z.input(k);
                let mut u: [f64; NU] = planned;
                if k > 0 {
                    for (j, row) in self.k[k * NU * n..][..NU * n].chunks_exact(n).enumerate() {
                        u[j] += dot(row, &off[..n]);
                        if self.rate.is_some() {
                            u[j] += product(&self.kv[k][j], &last);
                        }
                    }
                }
                let u = limit(k, u);
                last = core::array::from_fn(|j| u[j] - planned[j]);
                z.set_input(k, &u);
                state = self.follow(k, &state, &u, affine);
                let x = &mut z.x[k * n..][..n];
                for r in 0..n {
                    off[r] = state[r] - x[r];
                    x[r] = state[r];
                }
            }
        })
    }

    /// The next state `A_k x_k + B_k u_k + c_k` from the state x_k and the input u_k.
    #[inline(always)]
    fn follow(&self, k: usize, state: &[V; MAX_LANES], u: &[f64; NU], affine: &[V]) -> [V; MAX_LANES] {
        let n = Self::RX;
        let mut next = [V::zero(); MAX_LANES];
        next[..n].copy_from_slice(&affine[k * n..][..n]);
        if k > 0 {
            add_product::<V, NX>(&self.a[k * NX * n..][..NX * n], state, &mut next, n);
        }
        for j in 0..NU {
            for r in 0..n {
                next[r] = self.b[(k * NU + j) * n + r].mul_add(V::splat(u[j]), next[r]);
            }
        }
        next
    }

    /// Computes `gradient = H z + linear` at the inputs and states z with the weights H (without barrier
    /// terms). Returns `(zᵀHz, linearᵀz)`.
    pub(crate) fn gradient(
        &self,
        z: &Trajectory<V>,
        linear: &Trajectory<V>,
        gradient: &mut Trajectory<V>,
    ) -> (f64, f64) {
        vectorized!(V, {
            let n = Self::RX;
            for k in 0..self.horizon {
                let weight = if k + 1 == self.horizon { &self.terminal } else { &self.q };
                let state = &z.x[k * n..][..n];
                for r in 0..n {
                    let mut sum = [linear.x[k * n + r], V::zero()];
                    for j in 0..NX {
                        sum[j % 2] = weight[j * n + r].mul_add(V::splat(at(state, j)), sum[j % 2]);
                    }
                    gradient.x[k * n + r] = sum[0] + sum[1];
                }
            }
            self.input_gradient(flat(&z.u), flat(&linear.u), flat_mut(&mut gradient.u));
            let (mut both, mut line) = (V::zero(), V::zero());
            for ((z, g), l) in
                z.x.iter().zip(&gradient.x).zip(&linear.x).chain(z.u.iter().zip(&gradient.u).zip(&linear.u))
            {
                both = g.mul_add(*z, both);
                line = l.mul_add(*z, line);
            }
            let line = line.reduce_add();
            (both.reduce_add() - line, line)
        })
    }

    #[inline(always)]
    fn input_gradient(&self, u: &[f64], linear: &[f64], gradient: &mut [f64]) {
        for (k, (u, g)) in
            u.chunks_exact(NU).zip(gradient.chunks_exact_mut(NU)).take(self.horizon).enumerate()
        {
            for i in 0..NU {
                g[i] = linear[k * NU + i];
                for j in 0..NU {
                    g[i] += self.r[i][j] * u[j];
                }
            }
        }
        if let Some(w) = &self.rate {
            let change = |k: usize, j: usize| u[k * NU + j] - if k > 0 { u[(k - 1) * NU + j] } else { 0.0 };
            for k in 0..self.horizon {
                for i in 0..NU {
                    let force: f64 = (0..NU).map(|j| w[i][j] * change(k, j)).sum();
                    gradient[k * NU + i] += force;
                    if k > 0 {
                        gradient[(k - 1) * NU + i] -= force;
                    }
                }
            }
        }
    }

    /// The cost `½ Σ_k Δu_kᵀ (Λ D Λᵀ)_k Δu_k` of a change Δu of the inputs from the minimum, with the input
    /// Hessians `Λ D Λᵀ` of the last factorization.
    pub(crate) fn input_energy(&self, u: &Trajectory<V>) -> f64 {
        let mut sum = 0.0;
        for (k, l) in self.ldl.iter().enumerate() {
            let v: [f64; NU] = u.input(k);
            for j in 0..NU {
                let mut w = v[j];
                for i in j + 1..NU {
                    w += l[i][j] * v[i];
                }
                sum += 0.5 * w * w / l[j][j];
            }
        }
        sum
    }

    /// Replaces the gradient h of the inputs by the reduced gradient `h + Bᵀp` with the costate `p = g + Aᵀp⁺`. `gradient`
    /// contains the gradients g (states) and h (inputs) of the Lagrangian without dynamics.
    pub(crate) fn reduce(&self, gradient: &mut Trajectory<V>) {
        vectorized!(V, {
            let n = Self::RX;
            let mut p = [V::zero(); MAX_LANES];
            for k in (0..self.horizon).rev() {
                let mut next = [V::zero(); MAX_LANES];
                for r in 0..n {
                    next[r] = gradient.x[k * n + r];
                    if k + 1 < self.horizon {
                        for i in 0..NX {
                            next[r] =
                                self.a[((k + 1) * NX + i) * n + r].mul_add(V::splat(at(&p, i)), next[r]);
                        }
                    }
                }
                p = next;
                let mut h: [f64; NU] = gradient.input(k);
                for j in 0..NU {
                    h[j] += dot(&self.b[(k * NU + j) * n..][..n], &p[..n]);
                }
                gradient.set_input(k, &h);
            }
        })
    }
}

fn product<const L: usize>(a: &[f64; L], b: &[f64; L]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Adds the product of a matrix and a state: `next += M state`. `rows` are the rows of M.
#[inline(always)]
fn add_product<V: Vector, const ROWS: usize>(
    rows: &[V],
    state: &[V; MAX_LANES],
    next: &mut [V; MAX_LANES],
    n: usize,
) {
    for r in 0..n {
        next[r] += reduce_each(
            #[inline(always)]
            |i| rows_dot::<V, ROWS>(rows, r * V::WIDTH + i, n, state),
        );
    }
}

/// Scalar product of row `i` with a state, as partial sums (one for each number of a lane); zero for padding rows.
#[inline(always)]
fn rows_dot<V: Vector, const ROWS: usize>(rows: &[V], i: usize, n: usize, state: &[V; MAX_LANES]) -> V {
    if i >= ROWS {
        return V::zero();
    }
    let mut sum = rows[i * n] * state[0];
    for r in 1..n {
        sum = rows[i * n + r].mul_add(state[r], sum);
    }
    sum
}
