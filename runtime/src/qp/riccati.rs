//! The Riccati recursion: factorization and solution of the equality-constrained optimal-control problem.
//!
//! With stage Hessians `Q̃_k = Q + diag(σ_k)`, `R̃_k = R + diag(ρ_k)` (σ, ρ: barrier terms of the bounds) the Newton step of the interior-point
//! method minimizes `Σ ½ xᵀQ̃x + gᵀx + ½ uᵀR̃u + hᵀu` over `x⁺ = A x + B u`, `x_0 = 0`. Backwards from `P_N = Q̃_N`:
//!
//! ```text
//!     Λ D Λᵀ = R̃ + Bᵀ P⁺ B          Y = Λ⁻¹ Bᵀ P⁺ A
//!     K = −Λ⁻ᵀ D⁻¹ Y                P = Q̃ + Aᵀ P⁺ A − Yᵀ D⁻¹ Y         Φ = A + B K
//!     d = −(Λ D Λᵀ)⁻¹ (h + Bᵀ p⁺)   p = g + Kᵀ h + Φᵀ p⁺
//! ```
//!
//! and forwards `u = K x + d`, `x⁺ = Φ x + B d`. A weight W of the input's change, `½ (u_k − u_{k−1})ᵀ W (u_k − u_{k−1})`, makes v = u_{k−1} a
//! further state, with `v⁺ = u`. Its rows of the dynamics are an identity and need no products (S = P_xv, V = P_vv are blocks of the cost-to-go):
//!
//! ```text
//!     T = P⁺B + S⁺     Λ D Λᵀ = R̃ + W + BᵀT + S⁺ᵀB + V⁺     Y = Λ⁻¹TᵀA     Y_v = −Λ⁻¹W
//!     K_v = −Λ⁻ᵀ D⁻¹ Y_v    S = −YᵀD⁻¹Y_v    V = W − Y_vᵀD⁻¹Y_v    e = h + p_v⁺    p = g + Kᵀe + Φᵀp⁺    p_v = K_vᵀ(e + Bᵀp⁺)
//! ```
//!
//! which adds O(n m²) to a factorization where a general state of n + m numbers would cost about twice as much.
//! The cost is linear in the horizon, O((n + m)³) per factorization and O((n + m)²) per further
//! right-hand side. The closed-loop matrix Φ is formed once per factorization, because it leaves one matrix-vector product in the chain of
//! dependent operations of both sweeps.
//!
//! Sources: Rao, Wright, Rawlings, *Application of interior-point methods to model predictive control*, JOTA 99 (1998), section 3;
//! Frison, Jørgensen, *Efficient implementation of the Riccati recursion for solving linear-quadratic control problems*, CCA 2013 (symmetric
//! updates, fused products); Frison, Diehl, *HPIPM*, IFAC 2020.

use super::lanes::{Lane, WIDTH, accumulate, at, dot, flat, flat_mut, lanes, pack, reduce4, zeros};
use super::trajectory::Trajectory;

/// Columns of a block of a product held in registers at once.
const COLUMNS: usize = 4;
/// Lanes of a column of a block of a product held in registers at once.
const ROWS: usize = 3;
/// Lanes of the largest state vector.
const MAX_LANES: usize = 8;

/// Data and factors of the recursion over one horizon. All memory is allocated by [`Riccati::new`].
#[derive(Debug, Clone)]
pub(crate) struct Riccati<const NX: usize, const NU: usize> {
    horizon: usize,
    /// Rows of `A_k`, `NX` padded rows per stage.
    a: Vec<Lane>,
    /// Columns of `B_k`, `NU` padded columns per stage.
    b: Vec<Lane>,
    /// Columns of Q, of the terminal weight, and rows of R.
    q: Vec<Lane>,
    terminal: Vec<Lane>,
    r: [[f64; NU]; NU],
    /// W, if the change of the input has a weight.
    rate: Option<[[f64; NU]; NU]>,
    /// Rows of the gains `K_k`.
    k: Vec<Lane>,
    /// Rows of the closed-loop matrices `Φ_k = A_k + B_k K_k`.
    phi: Vec<Lane>,
    /// `Λ` strictly below the diagonal, `D⁻¹` on it.
    ldl: Vec<[[f64; NU]; NU]>,
    /// Columns of `P⁺` and, after a stage, of `P`.
    p: Vec<Lane>,
    /// Columns of `P⁺ A` and `P⁺ B`.
    pa: Vec<Lane>,
    pb: Vec<Lane>,
    /// Rows of `Y` and of `D⁻¹Y`.
    y: Vec<Lane>,
    z: Vec<Lane>,
    /// Columns of `S`; `V`; `K_v` per stage.
    s: Vec<Lane>,
    v: [[f64; NU]; NU],
    kv: Vec<[[f64; NU]; NU]>,
    /// `P_{k+1} c_k`, for the problem with affine dynamics.
    pc: Vec<Lane>,
    /// `S_{k+1}ᵀ c_k`, likewise.
    sc: Vec<[f64; NU]>,
}

/// A pivot of `R̃ + BᵀPB` was not positive: the weights are not positive (semi)definite as required, or not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NotPositive;

impl<const NX: usize, const NU: usize> Riccati<NX, NU> {
    /// Lanes of a state vector.
    pub(crate) const RX: usize = lanes(NX);

    pub(crate) fn new(horizon: usize) -> Self {
        let x = Self::RX;
        Self {
            horizon,
            a: zeros(horizon * NX * x),
            b: zeros(horizon * NU * x),
            q: zeros(NX * x),
            terminal: zeros(NX * x),
            r: [[0.0; NU]; NU],
            rate: None,
            k: zeros(horizon * NU * x),
            phi: zeros(horizon * NX * x),
            ldl: vec![[[0.0; NU]; NU]; horizon],
            p: zeros(NX * x),
            pa: zeros(NX * x),
            pb: zeros(NU * x),
            y: zeros(NU * x),
            z: zeros(NU * x),
            s: zeros(NU * x),
            v: [[0.0; NU]; NU],
            kv: vec![[[0.0; NU]; NU]; horizon],
            pc: zeros(horizon * x),
            sc: vec![[0.0; NU]; horizon],
        }
    }

    /// Constant weights Q, R, P and W, of which only the symmetric part counts; W = 0 is no weight of the input's change.
    pub(crate) fn set_weights(
        &mut self,
        q: &[[f64; NX]; NX],
        r: &[[f64; NU]; NU],
        terminal: &[[f64; NX]; NX],
        rate: &[[f64; NU]; NU],
    ) {
        let (q, terminal) = (symmetric(q), symmetric(terminal));
        for i in 0..NX {
            pack(&mut self.q[i * Self::RX..][..Self::RX], &q[i]);
            pack(&mut self.terminal[i * Self::RX..][..Self::RX], &terminal[i]);
        }
        self.r = symmetric(r);
        let rate = symmetric(rate);
        self.rate = rate.iter().flatten().any(|w| *w != 0.0).then_some(rate);
    }

    /// Dynamics of stage `k`, `x⁺ = A x + B u`.
    #[inline(always)]
    pub(crate) fn set_stage(&mut self, k: usize, a: &[[f64; NX]; NX], b: &[[f64; NU]; NX]) {
        let x = Self::RX;
        for (row, lanes) in a
            .iter()
            .zip(self.a[k * NX * x..][..NX * x].chunks_exact_mut(x))
        {
            pack(lanes, row);
        }
        for (j, lanes) in self.b[k * NU * x..][..NU * x]
            .chunks_exact_mut(x)
            .enumerate()
        {
            let column: [f64; NX] = core::array::from_fn(|i| b[i][j]);
            pack(lanes, &column);
        }
    }

    /// Factorizes with the diagonal terms of inputs and states in `weight`. With `affine`, the terms c_k of `x⁺ = A x + B u + c` (`A_0 x_0`
    /// included in c_0), prepares a solution with them too.
    #[inline(always)]
    pub(crate) fn factorize(
        &mut self,
        weight: &Trajectory,
        affine: Option<&[Lane]>,
    ) -> Result<(), NotPositive> {
        let x = Self::RX;
        let rho = flat(&weight.u);
        self.begin(&weight.x[(self.horizon - 1) * x..][..x]);
        for k in (0..self.horizon).rev() {
            if let Some(c) = affine {
                self.stage_affine(k, &c[k * x..][..x]);
            }
            self.stage_pivot(k, &rho[k * NU..][..NU])?;
            if k > 0 {
                self.stage_gain(k);
                self.stage_closed_loop(k);
                self.stage_cost_to_go(k);
                Self::add_diagonal(&mut self.p, &weight.x[(k - 1) * x..][..x]);
            }
        }
        Ok(())
    }

    /// The recursion without barrier terms down to P_0, so that K_0 exists too: a linear-quadratic regulator over the horizon.
    pub(crate) fn regulate(&mut self) -> Result<(), NotPositive> {
        self.begin(&[Lane::ZERO; MAX_LANES][..Self::RX]);
        for k in (0..self.horizon).rev() {
            self.stage_pivot(k, &[0.0; NU])?;
            self.stage_gain(k);
            self.stage_closed_loop(k);
            self.stage_cost_to_go(k);
        }
        Ok(())
    }

    /// The gain K_k of the last factorization, rows first.
    pub(crate) fn gain(&self, k: usize) -> [[f64; NX]; NU] {
        let rows = &self.k[k * NU * Self::RX..][..NU * Self::RX];
        core::array::from_fn(|i| core::array::from_fn(|j| at(&rows[i * Self::RX..][..Self::RX], j)))
    }

    /// The cost-to-go matrix that the last factorization ended with.
    pub(crate) fn cost_to_go(&self) -> [[f64; NX]; NX] {
        core::array::from_fn(|i| {
            core::array::from_fn(|j| at(&self.p[j * Self::RX..][..Self::RX], i))
        })
    }

    /// The terminal cost-to-go.
    #[inline(always)]
    fn begin(&mut self, sigma: &[Lane]) {
        self.p.copy_from_slice(&self.terminal);
        Self::add_diagonal(&mut self.p, sigma);
        if self.rate.is_some() {
            self.s.fill(Lane::ZERO);
            self.v = [[0.0; NU]; NU];
        }
    }

    /// `P⁺c`, for the linear part of the cost-to-go of `x⁺ = A x + B u + c`.
    fn stage_affine(&mut self, k: usize, c: &[Lane]) {
        let x = Self::RX;
        let p = &self.p[..];
        product::<NX, 1, false>(
            &mut self.pc[k * x..][..x],
            x,
            NX,
            |i, r| p[i * x + r],
            |i, _| at(c, i),
            |_, _| Lane::ZERO,
        );
        if self.rate.is_some() {
            self.sc[k] = core::array::from_fn(|j| dot(&self.s[j * x..][..x], c));
        }
    }

    #[inline(always)]
    fn add_diagonal(p: &mut [Lane], sigma: &[Lane]) {
        let sigma = flat(sigma);
        let p = flat_mut(p);
        for i in 0..NX {
            p[i * Self::RX * WIDTH + i] += sigma[i];
        }
    }

    /// `T = P⁺B (+ S⁺)` and `Λ D Λᵀ = R̃ + BᵀP⁺B (+ …)`.
    #[inline(always)]
    fn stage_pivot(&mut self, k: usize, rho: &[f64]) -> Result<(), NotPositive> {
        let x = Self::RX;
        let b = &self.b[k * NU * x..][..NU * x];
        let (p, s, rate) = (&self.p[..], &self.s[..], self.rate.is_some());
        product::<NX, NU, false>(
            &mut self.pb,
            x,
            NX,
            |i, r| p[i * x + r],
            |i, c| at(&b[c * x..][..x], i),
            |c, r| if rate { s[c * x + r] } else { Lane::ZERO },
        );
        let mut h = self.r;
        for i in 0..NU {
            for j in 0..=i {
                h[i][j] += dot(&b[i * x..][..x], &self.pb[j * x..][..x]);
            }
            h[i][i] += rho[i];
        }
        if let Some(w) = &self.rate {
            for i in 0..NU {
                for j in 0..=i {
                    h[i][j] +=
                        w[i][j] + self.v[i][j] + dot(&self.s[i * x..][..x], &b[j * x..][..x]);
                }
            }
        }
        self.ldl[k] = factor_ldl(h)?;
        Ok(())
    }

    /// `Y`, `−D⁻¹Y` and `K`; `S`, `V` and `K_v` where the change of the input has a weight.
    #[inline(always)]
    fn stage_gain(&mut self, k: usize) {
        let x = Self::RX;
        let a = &self.a[k * NX * x..][..NX * x];
        let pb = &self.pb[..];
        product::<NX, NU, false>(
            &mut self.y,
            x,
            NX,
            |i, r| a[i * x + r],
            |i, c| at(&pb[c * x..][..x], i),
            |_, _| Lane::ZERO,
        );
        let l = &self.ldl[k];
        let gain = &mut self.k[k * NU * x..][..NU * x];
        for r in 0..x {
            for i in 0..NU {
                let mut sum = self.y[i * x + r];
                for j in 0..i {
                    sum = self.y[j * x + r].mul_neg_add(Lane::splat(l[i][j]), sum);
                }
                self.y[i * x + r] = sum;
                self.z[i * x + r] = sum * Lane::splat(-l[i][i]);
            }
            for i in (0..NU).rev() {
                let mut sum = self.z[i * x + r];
                for j in i + 1..NU {
                    sum = gain[j * x + r].mul_neg_add(Lane::splat(l[j][i]), sum);
                }
                gain[i * x + r] = sum;
            }
        }
        if let Some(w) = self.rate {
            self.stage_rate(k, &w);
        }
    }

    /// `K_v = (Λ D Λᵀ)⁻¹ W`, `S = KᵀH_uv = −KᵀW`, `V = W − W K_v`.
    #[inline(always)]
    fn stage_rate(&mut self, k: usize, w: &[[f64; NU]; NU]) {
        let x = Self::RX;
        let gain = &self.k[k * NU * x..][..NU * x];
        let kv = &mut self.kv[k];
        for j in 0..NU {
            let column = solve_ldl(&self.ldl[k], &w[j]);
            for i in 0..NU {
                kv[i][j] = column[i];
            }
        }
        for j in 0..NU {
            for r in 0..x {
                let mut sum = Lane::ZERO;
                for i in 0..NU {
                    sum = gain[i * x + r].mul_neg_add(Lane::splat(w[i][j]), sum);
                }
                self.s[j * x + r] = sum;
            }
            for i in 0..=j {
                let v = w[i][j] - (0..NU).map(|m| w[i][m] * kv[m][j]).sum::<f64>();
                self.v[i][j] = v;
                self.v[j][i] = v;
            }
        }
    }

    /// `Φ = A + B K`.
    #[inline(always)]
    fn stage_closed_loop(&mut self, k: usize) {
        let x = Self::RX;
        let a = &self.a[k * NX * x..][..NX * x];
        let b = &self.b[k * NU * x..][..NU * x];
        let gain = &self.k[k * NU * x..][..NU * x];
        product::<NX, NX, false>(
            &mut self.phi[k * NX * x..][..NX * x],
            x,
            NU,
            |j, r| gain[j * x + r],
            |j, c| at(&b[j * x..][..x], c),
            |c, r| a[c * x + r],
        );
    }

    /// `P = Q + AᵀP⁺A − YᵀD⁻¹Y`: the lower blocks by product, the upper ones by symmetry.
    #[inline(always)]
    fn stage_cost_to_go(&mut self, k: usize) {
        let x = Self::RX;
        let a = &self.a[k * NX * x..][..NX * x];
        let p = &self.p[..];
        product::<NX, NX, false>(
            &mut self.pa,
            x,
            NX,
            |i, r| p[i * x + r],
            |i, c| at(&a[i * x..][..x], c),
            |_, _| Lane::ZERO,
        );
        let (pa, y, z, q) = (&self.pa[..], &self.y[..], &self.z[..], &self.q[..]);
        product::<NX, NX, true>(
            &mut self.p,
            x,
            NX + NU,
            |i, r| {
                if i < NX {
                    a[i * x + r]
                } else {
                    y[(i - NX) * x + r]
                }
            },
            |i, c| {
                if i < NX {
                    at(&pa[c * x..][..x], i)
                } else {
                    at(&z[(i - NX) * x..][..x], c)
                }
            },
            |c, r| q[c * x + r],
        );
        mirror::<NX>(&mut self.p, x);
    }

    /// The minimizer `step` for the linear costs `gradient`; `affine` as for [`Self::factorize`].
    #[inline(always)]
    pub(crate) fn solve(
        &self,
        gradient: &Trajectory,
        step: &mut Trajectory,
        affine: Option<&[Lane]>,
    ) {
        self.backward(gradient, flat_mut(&mut step.u), affine.is_some());
        self.forward(flat_mut(&mut step.u), &mut step.x, affine);
    }

    /// The backward sweep: feed-forward terms `d_k` into `d`.
    #[inline(always)]
    fn backward(&self, gradient: &Trajectory, d: &mut [f64], affine: bool) {
        let n = Self::RX;
        let rate = self.rate.is_some();
        let mut p = [Lane::ZERO; MAX_LANES];
        let mut pv = [0.0; NU];
        p[..n].copy_from_slice(&gradient.x[(self.horizon - 1) * n..][..n]);
        for k in (0..self.horizon).rev() {
            let mut e: [f64; NU] = core::array::from_fn(|j| flat(&gradient.u)[k * NU + j]);
            if rate {
                e = core::array::from_fn(|j| e[j] + pv[j]);
            }
            if affine {
                for r in 0..n {
                    p[r] += self.pc[k * n + r];
                }
                if rate {
                    let s = &self.sc[k];
                    e = core::array::from_fn(|j| e[j] + s[j]);
                }
            }
            let b = &self.b[k * NU * n..][..NU * n];
            let w: [f64; NU] = core::array::from_fn(|j| e[j] + dot(&b[j * n..][..n], &p[..n]));
            let step = solve_ldl(&self.ldl[k], &w);
            for j in 0..NU {
                d[k * NU + j] = -step[j];
            }
            if k == 0 {
                break;
            }
            if rate {
                pv = core::array::from_fn(|j| (0..NU).map(|i| self.kv[k][i][j] * w[i]).sum());
            }
            self.costate(k, &gradient.x[(k - 1) * n..][..n], &e, &mut p);
        }
    }

    /// `p = g + Kᵀe + Φᵀp⁺`.
    #[inline(always)]
    fn costate(&self, k: usize, g: &[Lane], e: &[f64; NU], p: &mut [Lane; MAX_LANES]) {
        let n = Self::RX;
        let phi = &self.phi[k * NX * n..][..NX * n];
        let gain = &self.k[k * NU * n..][..NU * n];
        let old = *p;
        for r in 0..n {
            let mut sum = [g[r], Lane::ZERO];
            for j in 0..NU {
                sum[0] = gain[j * n + r].mul_add(Lane::splat(e[j]), sum[0]);
            }
            for i in 0..NX {
                sum[i % 2] = phi[i * n + r].mul_add(Lane::splat(at(&old, i)), sum[i % 2]);
            }
            p[r] = sum[0] + sum[1];
        }
    }

    /// The forward sweep: from the feed-forward terms in `u` to inputs and states.
    #[inline(always)]
    fn forward(&self, u: &mut [f64], x: &mut [Lane], affine: Option<&[Lane]>) {
        let n = Self::RX;
        let rate = self.rate.is_some();
        let mut state = [Lane::ZERO; MAX_LANES];
        let mut last = [0.0; NU];
        for k in 0..self.horizon {
            let b = &self.b[k * NU * n..][..NU * n];
            let u = &mut u[k * NU..][..NU];
            if rate && k > 0 {
                for i in 0..NU {
                    u[i] += (0..NU).map(|j| self.kv[k][i][j] * last[j]).sum::<f64>();
                }
            }
            let mut next = [Lane::ZERO; MAX_LANES];
            if let Some(c) = affine {
                next[..n].copy_from_slice(&c[k * n..][..n]);
            }
            if k > 0 {
                add_product::<NX>(&self.phi[k * NX * n..][..NX * n], &state, &mut next, n);
            }
            for j in 0..NU {
                for r in 0..n {
                    next[r] = b[j * n + r].mul_add(Lane::splat(u[j]), next[r]);
                }
            }
            if k > 0 {
                let gain = &self.k[k * NU * n..][..NU * n];
                for j in 0..NU {
                    u[j] += dot(&gain[j * n..][..n], &state[..n]);
                }
            }
            last = core::array::from_fn(|j| u[j]);
            x[k * n..][..n].copy_from_slice(&next[..n]);
            state = next;
        }
    }

    /// States of `x⁺ = A x + B u + c` for given inputs, `A_0 x_0` included in c_0.
    pub(crate) fn roll_out(&self, z: &mut Trajectory, affine: &[Lane]) {
        let n = Self::RX;
        let mut state = [Lane::ZERO; MAX_LANES];
        for k in 0..self.horizon {
            let mut next = [Lane::ZERO; MAX_LANES];
            next[..n].copy_from_slice(&affine[k * n..][..n]);
            if k > 0 {
                add_product::<NX>(&self.a[k * NX * n..][..NX * n], &state, &mut next, n);
            }
            let u: [f64; NU] = z.input(k);
            for j in 0..NU {
                for r in 0..n {
                    next[r] = self.b[(k * NU + j) * n + r].mul_add(Lane::splat(u[j]), next[r]);
                }
            }
            z.x[k * n..][..n].copy_from_slice(&next[..n]);
            state = next;
        }
    }

    /// `gradient = H z + linear` for the weights (without barrier terms). Returns `(zᵀHz, linearᵀz)`.
    #[inline(always)]
    pub(crate) fn gradient(
        &self,
        z: &Trajectory,
        linear: &Trajectory,
        gradient: &mut Trajectory,
    ) -> (f64, f64) {
        let n = Self::RX;
        for k in 0..self.horizon {
            let weight = if k + 1 == self.horizon {
                &self.terminal
            } else {
                &self.q
            };
            let state = &z.x[k * n..][..n];
            for r in 0..n {
                let mut sum = [linear.x[k * n + r], Lane::ZERO];
                for j in 0..NX {
                    sum[j % 2] = weight[j * n + r].mul_add(Lane::splat(at(state, j)), sum[j % 2]);
                }
                gradient.x[k * n + r] = sum[0] + sum[1];
            }
        }
        self.input_gradient(flat(&z.u), flat(&linear.u), flat_mut(&mut gradient.u));
        let (mut both, mut line) = (Lane::ZERO, Lane::ZERO);
        for ((z, g), l) in
            z.x.iter()
                .zip(&gradient.x)
                .zip(&linear.x)
                .chain(z.u.iter().zip(&gradient.u).zip(&linear.u))
        {
            both = g.mul_add(*z, both);
            line = l.mul_add(*z, line);
        }
        let line = line.reduce_add();
        (both.reduce_add() - line, line)
    }

    #[inline(always)]
    fn input_gradient(&self, u: &[f64], linear: &[f64], gradient: &mut [f64]) {
        for (k, (u, g)) in u
            .chunks_exact(NU)
            .zip(gradient.chunks_exact_mut(NU))
            .take(self.horizon)
            .enumerate()
        {
            for i in 0..NU {
                g[i] = linear[k * NU + i] + (0..NU).map(|j| self.r[i][j] * u[j]).sum::<f64>();
            }
        }
        if let Some(w) = &self.rate {
            let change =
                |k: usize, j: usize| u[k * NU + j] - if k > 0 { u[(k - 1) * NU + j] } else { 0.0 };
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

    /// `½ Σ_k Δu_kᵀ (Λ D Λᵀ)_k Δu_k` of the last factorization: what moving the inputs costs above the minimum.
    pub(crate) fn input_energy(&self, u: &Trajectory) -> f64 {
        let mut sum = 0.0;
        for (k, l) in self.ldl.iter().enumerate() {
            let v: [f64; NU] = u.input(k);
            for j in 0..NU {
                let w = v[j] + (j + 1..NU).map(|i| l[i][j] * v[i]).sum::<f64>();
                sum += 0.5 * w * w / l[j][j];
            }
        }
        sum
    }

    /// Largest entry of Q, P and R.
    pub(crate) fn largest_weight(&self) -> f64 {
        let entries = flat(&self.q)
            .iter()
            .chain(flat(&self.terminal))
            .chain(self.r.iter().flatten());
        entries.fold(0.0, |max, w| w.abs().max(max))
    }

    /// Largest reduced gradient of the inputs, `|h + Bᵀp|` with the costate `p = g + Aᵀp⁺`, for the gradients of the Lagrangian without dynamics.
    pub(crate) fn reduced_gradient(&self, gradient: &Trajectory) -> f64 {
        let n = Self::RX;
        let mut p = [Lane::ZERO; MAX_LANES];
        let mut worst = 0.0_f64;
        for k in (0..self.horizon).rev() {
            let mut next = [Lane::ZERO; MAX_LANES];
            for r in 0..n {
                next[r] = gradient.x[k * n + r];
                if k + 1 < self.horizon {
                    for i in 0..NX {
                        next[r] = self.a[((k + 1) * NX + i) * n + r]
                            .mul_add(Lane::splat(at(&p, i)), next[r]);
                    }
                }
            }
            p = next;
            let h: [f64; NU] = gradient.input(k);
            for j in 0..NU {
                let reduced = h[j] + dot(&self.b[(k * NU + j) * n..][..n], &p[..n]);
                worst = if reduced.is_nan() {
                    f64::NAN
                } else {
                    worst.max(reduced.abs())
                };
            }
        }
        worst
    }
}

/// Mean of a matrix and its transpose.
fn symmetric<const N: usize>(m: &[[f64; N]; N]) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (m[i][j] + m[j][i])))
}

/// `next += M state`, the rows of M given.
#[inline(always)]
fn add_product<const NX: usize>(
    rows: &[Lane],
    state: &[Lane; MAX_LANES],
    next: &mut [Lane; MAX_LANES],
    n: usize,
) {
    for r in 0..n {
        next[r] += reduce4(core::array::from_fn(|i| {
            rows_dot::<NX>(rows, r * WIDTH + i, n, state)
        }));
    }
}

/// Lane-wise products of row `i` with a state, not yet summed over the lane; zero for padding rows.
#[inline(always)]
fn rows_dot<const NX: usize>(rows: &[Lane], i: usize, n: usize, state: &[Lane; MAX_LANES]) -> Lane {
    if i >= NX {
        return Lane::ZERO;
    }
    let mut sum = rows[i * n] * state[0];
    for r in 1..n {
        sum = rows[i * n + r].mul_add(state[r], sum);
    }
    sum
}

/// `out[c][r] = start(c, r) + Σ_i left(i, r) right(i, c)`, `CN` columns of `n` lanes; with `LOWER` only the blocks on and below the diagonal.
#[inline(always)]
fn product<const NX: usize, const CN: usize, const LOWER: bool>(
    out: &mut [Lane],
    n: usize,
    depth: usize,
    left: impl Fn(usize, usize) -> Lane,
    right: impl Fn(usize, usize) -> f64,
    start: impl Fn(usize, usize) -> Lane,
) {
    let mut c0 = 0;
    while c0 < CN {
        let mut r0 = if LOWER { c0 / 4 } else { 0 };
        while r0 < n {
            match ((n - r0).min(ROWS), (CN - c0).min(COLUMNS)) {
                (1, 1) => block::<1, 1>(out, n, depth, r0, c0, &left, &right, &start),
                (1, 2) => block::<1, 2>(out, n, depth, r0, c0, &left, &right, &start),
                (1, 3) => block::<1, 3>(out, n, depth, r0, c0, &left, &right, &start),
                (1, _) => block::<1, 4>(out, n, depth, r0, c0, &left, &right, &start),
                (2, 1) => block::<2, 1>(out, n, depth, r0, c0, &left, &right, &start),
                (2, 2) => block::<2, 2>(out, n, depth, r0, c0, &left, &right, &start),
                (2, 3) => block::<2, 3>(out, n, depth, r0, c0, &left, &right, &start),
                (2, _) => block::<2, 4>(out, n, depth, r0, c0, &left, &right, &start),
                (_, 1) => block::<3, 1>(out, n, depth, r0, c0, &left, &right, &start),
                (_, 2) => block::<3, 2>(out, n, depth, r0, c0, &left, &right, &start),
                (_, 3) => block::<3, 3>(out, n, depth, r0, c0, &left, &right, &start),
                (_, _) => block::<3, 4>(out, n, depth, r0, c0, &left, &right, &start),
            }
            r0 += ROWS;
        }
        c0 += COLUMNS;
    }
}

/// One block of [`product`], accumulated in registers.
#[inline(always)]
#[expect(
    clippy::too_many_arguments,
    reason = "the inner kernel of `product`, inlined into it"
)]
fn block<const R: usize, const C: usize>(
    out: &mut [Lane],
    n: usize,
    depth: usize,
    r0: usize,
    c0: usize,
    left: &impl Fn(usize, usize) -> Lane,
    right: &impl Fn(usize, usize) -> f64,
    start: &impl Fn(usize, usize) -> Lane,
) {
    let mut acc: [[Lane; R]; C] =
        core::array::from_fn(|c| core::array::from_fn(|r| start(c0 + c, r0 + r)));
    accumulate(
        &mut acc,
        depth,
        |i, r| left(i, r0 + r),
        |i, c| right(i, c0 + c),
    );
    for c in 0..C {
        for r in 0..R {
            out[(c0 + c) * n + r0 + r] = acc[c][r];
        }
    }
}

/// Makes a matrix of `NX` padded columns symmetric: blocks above the diagonal from those below, blocks on it by the mean with their transpose.
/// Needed, not cosmetic: rounding leaves an antisymmetric part E, which the recursion would carry on as `AᵀEA`, by the open loop.
#[inline(always)]
fn mirror<const NX: usize>(p: &mut [Lane], n: usize) {
    for rb in 0..n {
        let width = (NX - rb * WIDTH).min(WIDTH);
        let block: [Lane; WIDTH] = core::array::from_fn(|j| {
            if j < width {
                p[(rb * WIDTH + j) * n + rb]
            } else {
                Lane::ZERO
            }
        });
        let transposed = Lane::transpose(block);
        for j in 0..width {
            p[(rb * WIDTH + j) * n + rb] = (block[j] + transposed[j]) * Lane::HALF;
        }
    }
    for rb in 1..n {
        for cb in 0..rb {
            let below = Lane::transpose(core::array::from_fn(|j| p[(cb * 4 + j) * n + rb]));
            for j in 0..(NX - rb * 4).min(4) {
                p[(rb * 4 + j) * n + cb] = below[j];
            }
        }
    }
}

/// `Λ` strictly below the diagonal and `D⁻¹` on it, of the symmetric matrix whose lower triangle is given.
#[inline(always)]
fn factor_ldl<const NU: usize>(mut h: [[f64; NU]; NU]) -> Result<[[f64; NU]; NU], NotPositive> {
    let mut positive = true;
    for j in 0..NU {
        let pivot = h[j][j];
        positive &= pivot > 0.0;
        let inverse = 1.0 / pivot;
        for i in j + 1..NU {
            let l = h[i][j] * inverse;
            for m in j + 1..=i {
                h[i][m] -= l * h[m][j];
            }
        }
        for i in j + 1..NU {
            h[i][j] *= inverse;
        }
        h[j][j] = inverse;
    }
    if positive { Ok(h) } else { Err(NotPositive) }
}

/// `(Λ D Λᵀ)⁻¹ w`.
#[inline(always)]
fn solve_ldl<const NU: usize>(l: &[[f64; NU]; NU], w: &[f64; NU]) -> [f64; NU] {
    let mut v = *w;
    for i in 0..NU {
        for j in 0..i {
            v[i] -= l[i][j] * v[j];
        }
    }
    for i in 0..NU {
        v[i] *= l[i][i];
    }
    for i in (0..NU).rev() {
        for j in i + 1..NU {
            v[i] -= l[j][i] * v[j];
        }
    }
    v
}
