//! Riccati recursion, which factorizes and solves the equality-constrained optimal-control problem.
//!
//! The stage Hessians are `Q̃_k = Q + diag(σ_k)` and `R̃_k = R + diag(ρ_k)`, with the barrier terms σ and ρ of the bounds.
//! The Newton step of the interior-point method minimizes `Σ ½ xᵀQ̃x + gᵀx + ½ uᵀR̃u + hᵀu` subject to `x⁺ = A x + B u`,
//! `x_0 = 0`. The backward recursion begins with `P_N = Q̃_N`:
//!
//! ```text
//!     Λ D Λᵀ = R̃ + Bᵀ P⁺ B          Y = Λ⁻¹ Bᵀ P⁺ A
//!     K = −Λ⁻ᵀ D⁻¹ Y                P = Q̃ + Aᵀ P⁺ A − Yᵀ D⁻¹ Y         Φ = A + B K
//!     d = −(Λ D Λᵀ)⁻¹ (h + Bᵀ p⁺)   p = g + Kᵀ h + Φᵀ p⁺
//! ```
//!
//! The forward recursion is `u = K x + d`, `x⁺ = Φ x + B d`. If the change of the input has a weight W,
//! `½ (u_k − u_{k−1})ᵀ W (u_k − u_{k−1})`, then v = u_{k−1} is an additional state with `v⁺ = u`. The rows of this state in
//! the dynamics are an identity and need no products. S = P_xv and V = P_vv are blocks of the cost-to-go matrix:
//!
//! ```text
//!     T = P⁺B + S⁺     Λ D Λᵀ = R̃ + W + BᵀT + S⁺ᵀB + V⁺     Y = Λ⁻¹TᵀA     Y_v = −Λ⁻¹W
//!     K_v = −Λ⁻ᵀ D⁻¹ Y_v    S = −YᵀD⁻¹Y_v    V = W − Y_vᵀD⁻¹Y_v    e = h + p_v⁺    p = g + Kᵀe + Φᵀp⁺    p_v = K_vᵀ(e + Bᵀp⁺)
//! ```
//!
//! [`super::rows`] describes the terms that rows `C x + D u` of a stage add to R̃, Q̃ and `BᵀP⁺A`.
//!
//! The weight W adds O(n m²) operations to a factorization, for n states and m inputs. A general state of n + m numbers
//! would need about twice as many operations. The number of operations is linear in the horizon. It is O((n + m)³) per
//! stage for a factorization and O((n + m)²) per stage for each further right-hand side. The closed-loop matrix Φ is
//! computed once per factorization. Both sweeps then have only one matrix-vector product per stage in their chain of
//! dependent operations.
//!
//! Sources: Rao, Wright, Rawlings, *Application of interior-point methods to model predictive control*, JOTA
//! 99 (1998), section 3; Frison, Jørgensen, *Efficient implementation of the Riccati recursion for solving
//! linear-quadratic control problems*, CCA 2013 (symmetric updates, fused products); Frison, Diehl, *HPIPM*,
//! IFAC 2020.

use super::kernels::{Right, Term, add_combination, product};
use super::lanes::{MAX_WIDTH, Vector, at, dot, flat, flat_mut, lanes, largest, pack, vectorized, zeros};
use super::ldl::{NotPositive, factor_ldl, solve_ldl};
use super::rows::Rows;
use super::trajectory::Trajectory;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Largest number of lanes of a vector of states or inputs.
pub(super) const MAX_LANES: usize = 8;

/// Data and factors of the recursion over one horizon. All memory is allocated by [`Riccati::new`].
#[derive(Debug, Clone)]
pub(crate) struct Riccati<V, const NX: usize, const NU: usize> {
    pub(super) horizon: usize,
    /// Rows of the state matrices `A_k`, `NX` padded rows per stage.
    pub(super) a: Vec<V>,
    /// Columns of the input matrices `B_k`, `NU` padded columns per stage.
    pub(super) b: Vec<V>,
    /// Rows of the input matrices `B_k`, `NX` padded rows per stage.
    pub(super) b_rows: Vec<V>,
    /// Columns of the state weight Q.
    pub(super) q: Vec<V>,
    /// Columns of the terminal weight.
    pub(super) terminal: Vec<V>,
    /// Rows of the input weight R.
    pub(super) r: [[f64; NU]; NU],
    /// Largest magnitude of an entry of the weights of states, inputs and input changes.
    pub(super) largest: f64,
    /// Weight W of the change of the input; `None` if the change has no weight.
    pub(super) rate: Option<[[f64; NU]; NU]>,
    /// Rows of the feedback gains `K_k`.
    pub(super) k: Vec<V>,
    /// Rows of the closed-loop matrices `Φ_k = A_k + B_k K_k`, with the system matrices A_k and B_k and the
    /// gains K_k.
    pub(super) phi: Vec<V>,
    /// Factors of the input Hessians `Λ D Λᵀ`: `Λ` below the diagonal and `D⁻¹` on the diagonal.
    pub(super) ldl: Vec<[[f64; NU]; NU]>,
    /// Columns of the cost-to-go matrix: `P⁺` of the next stage and, after a stage, `P` of this stage.
    p: Vec<V>,
    /// Columns of `P⁺ A` with the cost-to-go matrix P⁺ of the next stage and the state matrix A.
    pa: Vec<V>,
    /// Columns of `P⁺ B` with the cost-to-go matrix P⁺ of the next stage and the input matrix B.
    pb: Vec<V>,
    /// Columns of the lower triangle of the input Hessian `R̃ + BᵀP⁺B`, with the input weights R̃, the input
    /// matrix B and the cost-to-go matrix P⁺ of the next stage.
    h: Vec<V>,
    /// Rows of `Y = Λ⁻¹BᵀP⁺A`, with the factor Λ of the input Hessian, the system matrices A and B, and the
    /// cost-to-go matrix P⁺ of the next stage.
    y: Vec<V>,
    /// Rows of `−D⁻¹Y` with the factors D of the input Hessian and `Y` of the gain.
    z: Vec<V>,
    /// Columns of `S`, the block of the cost-to-go matrix for the state and the previous input.
    s: Vec<V>,
    v: [[f64; NU]; NU],
    pub(super) kv: Vec<[[f64; NU]; NU]>,
    /// Vectors `P_{k+1} c_k` of the cost-to-go matrices and the affine terms c_k of the dynamics.
    pub(super) pc: Vec<V>,
    /// Vectors `S_{k+1}ᵀ c_k` of the affine terms c_k of the dynamics. S is the block of the cost-to-go
    /// matrix for the state and the previous input.
    pub(super) sc: Vec<[f64; NU]>,
}

impl<V: Vector, const NX: usize, const NU: usize> Riccati<V, NX, NU> {
    /// Clears the results of factorizations and solves. The data of the problem are kept.
    pub(super) fn forget(&mut self) {
        let of_lanes = [
            &mut self.k,
            &mut self.phi,
            &mut self.p,
            &mut self.pa,
            &mut self.pb,
            &mut self.h,
            &mut self.y,
            &mut self.z,
            &mut self.s,
            &mut self.pc,
        ];
        for lanes in of_lanes {
            lanes.fill(V::zero());
        }
        self.ldl.fill([[0.0; NU]; NU]);
        self.kv.fill([[0.0; NU]; NU]);
        self.sc.fill([0.0; NU]);
        self.v = [[0.0; NU]; NU];
    }

    /// Number of lanes of a state vector.
    pub(crate) const RX: usize = lanes::<V>(NX);
    /// Number of lanes of an input vector.
    pub(super) const RU: usize = lanes::<V>(NU);

    pub(crate) fn new(horizon: usize) -> Self {
        let x = Self::RX;
        Self {
            horizon,
            a: zeros(horizon * NX * x),
            b: zeros(horizon * NU * x),
            b_rows: zeros(horizon * NX * Self::RU),
            q: zeros(NX * x),
            terminal: zeros(NX * x),
            r: [[0.0; NU]; NU],
            largest: 0.0,
            rate: None,
            k: zeros(horizon * NU * x),
            phi: zeros(horizon * NX * x),
            ldl: vec![[[0.0; NU]; NU]; horizon],
            p: zeros(NX * x),
            pa: zeros(NX * x),
            pb: zeros(NU * x),
            h: zeros(NU * Self::RU),
            y: zeros(NU * x),
            z: zeros(NU * x),
            s: zeros(NU * x),
            v: [[0.0; NU]; NU],
            kv: vec![[[0.0; NU]; NU]; horizon],
            pc: zeros(horizon * x),
            sc: vec![[0.0; NU]; horizon],
        }
    }

    /// Sets the constant weights Q of the states, R of the inputs, P of the last state and W of the input
    /// changes. Only their symmetric parts are used. W = 0 means that the change of the input has no weight.
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
        let of_lanes = self.q.iter().chain(&self.terminal);
        let largest = vectorized!(V, { largest(of_lanes.fold(V::zero(), |max, w| max.fast_max(w.abs()))) });
        let of_inputs = self.r.iter().chain(&rate).flatten();
        self.largest = of_inputs.fold(largest, |max, w| w.abs().max(max));
        self.rate = rate.iter().flatten().any(|w| *w != 0.0).then_some(rate);
    }

    /// Sets the state matrix A and the input matrix B of the dynamics `x⁺ = A x + B u` of stage `k`.
    pub(crate) fn set_stage(&mut self, k: usize, a: &[[f64; NX]; NX], b: &[[f64; NU]; NX]) {
        let x = Self::RX;
        for (row, lanes) in a.iter().zip(self.a[k * NX * x..][..NX * x].chunks_exact_mut(x)) {
            pack(lanes, row);
        }
        for (j, lanes) in self.b[k * NU * x..][..NU * x].chunks_exact_mut(x).enumerate() {
            let column: [f64; NX] = core::array::from_fn(|i| b[i][j]);
            pack(lanes, &column);
        }
        for (row, lanes) in
            b.iter().zip(self.b_rows[k * NX * Self::RU..][..NX * Self::RU].chunks_exact_mut(Self::RU))
        {
            pack(lanes, row);
        }
    }

    /// Factorizes with the diagonal terms of inputs, states and rows in `weight`. If `affine` is given, the
    /// solution for dynamics `x⁺ = A x + B u + c` with these affine terms c is prepared too. The first affine
    /// term includes the contribution of the initial state.
    ///
    /// # Errors
    /// [`NotPositive`] if a pivot is not positive.
    pub(crate) fn factorize<const NR: usize>(
        &mut self,
        weight: &Trajectory<V>,
        affine: Option<&[V]>,
        rows: &Rows<V, NX, NU, NR>,
    ) -> Result<(), NotPositive> {
        vectorized!(V, {
            let x = Self::RX;
            let rho = flat(&weight.u);
            self.begin(&weight.x[(self.horizon - 1) * x..][..x]);
            if NR > 0 {
                rows.add_to_cost(self.horizon, weight, &mut self.p);
                mirror::<V, NX>(&mut self.p, x);
            }
            for k in (0..self.horizon).rev() {
                if let Some(c) = affine {
                    self.stage_affine(k, &c[k * x..][..x]);
                }
                let with_rows = |h: &mut _| rows.add_to_pivot(k, weight, h);
                self.stage_pivot(k, &rho[k * NU..][..NU], with_rows)?;
                if k > 0 {
                    self.stage_gain(k, |y| rows.add_to_coupling(k, weight, y));
                    self.stage_closed_loop(k);
                    self.stage_cost_to_go(k, |p| rows.add_to_cost(k, weight, p));
                    Self::add_diagonal(&mut self.p, &weight.x[(k - 1) * x..][..x]);
                }
            }
            Ok(())
        })
    }

    /// Computes the recursion without barrier terms down to the first stage, whose gain is computed too. The
    /// result is a linear-quadratic regulator over the horizon.
    ///
    /// # Errors
    /// [`NotPositive`] if a pivot is not positive.
    pub(crate) fn regulate(&mut self) -> Result<(), NotPositive> {
        vectorized!(V, {
            self.begin(&[V::zero(); MAX_LANES][..Self::RX]);
            for k in (0..self.horizon).rev() {
                self.stage_pivot(k, &[0.0; NU], |_| {})?;
                self.stage_gain(k, |_| {});
                self.stage_closed_loop(k);
                self.stage_cost_to_go(k, |_| {});
            }
            Ok(())
        })
    }

    /// Gain K_k of the last factorization, row by row.
    pub(crate) fn gain(&self, k: usize) -> [[f64; NX]; NU] {
        let rows = &self.k[k * NU * Self::RX..][..NU * Self::RX];
        core::array::from_fn(|i| core::array::from_fn(|j| at(&rows[i * Self::RX..][..Self::RX], j)))
    }

    /// Cost-to-go matrix P of the first stage after the last factorization.
    pub(crate) fn cost_to_go(&self) -> [[f64; NX]; NX] {
        core::array::from_fn(|i| core::array::from_fn(|j| at(&self.p[j * Self::RX..][..Self::RX], i)))
    }

    /// Begins the recursion with the terminal cost-to-go.
    #[inline(always)]
    fn begin(&mut self, sigma: &[V]) {
        self.p.copy_from_slice(&self.terminal);
        Self::add_diagonal(&mut self.p, sigma);
        if self.rate.is_some() {
            self.s.fill(V::zero());
            self.v = [[0.0; NU]; NU];
        }
    }

    /// Computes `P⁺c` for dynamics `x⁺ = A x + B u + c`, with the cost-to-go matrix P⁺ of the next stage.
    #[inline(always)]
    fn stage_affine(&mut self, k: usize, c: &[V]) {
        let x = Self::RX;
        let pc = &mut self.pc[k * x..][..x];
        pc.fill(V::zero());
        add_combination(pc, &self.p, &flat(c)[..NX], x);
        if self.rate.is_some() {
            for j in 0..NU {
                self.sc[k][j] = dot(&self.s[j * x..][..x], c);
            }
        }
    }

    #[inline(always)]
    fn add_diagonal(p: &mut [V], sigma: &[V]) {
        let sigma = flat(sigma);
        let p = flat_mut(p);
        for i in 0..NX {
            p[i * Self::RX * V::WIDTH + i] += sigma[i];
        }
    }

    /// Computes `T = P⁺B (+ S⁺)` and the factors of the input Hessian `R̃ + BᵀP⁺B (+ …)`. P⁺ and S⁺ are the
    /// blocks of the cost-to-go matrix of the next stage. The terms in parentheses appear if the change of
    /// the input has a weight.
    #[inline(always)]
    fn stage_pivot(
        &mut self,
        k: usize,
        rho: &[f64],
        add_rows: impl FnOnce(&mut [[f64; NU]; NU]),
    ) -> Result<(), NotPositive> {
        let x = Self::RX;
        let b = &self.b[k * NU * x..][..NU * x];
        let b_rows = &self.b_rows[k * NX * Self::RU..][..NX * Self::RU];
        product::<V, NX, NU, false, 1>(
            &mut self.pb,
            self.rate.is_some().then_some(&self.s),
            [Term { left: &self.p, right: Right::columns(flat(b), x * V::WIDTH), depth: NX }],
        );
        product::<V, NU, NU, true, 1>(
            &mut self.h,
            None,
            [Term { left: b_rows, right: Right::columns(flat(&self.pb), x * V::WIDTH), depth: NX }],
        );
        let mut h = self.r;
        for j in 0..NU {
            let column = &flat(&self.h)[j * Self::RU * V::WIDTH..][..NU];
            for i in j..NU {
                h[i][j] += column[i];
            }
            h[j][j] += rho[j];
        }
        add_rows(&mut h);
        if let Some(w) = &self.rate {
            for i in 0..NU {
                for j in 0..=i {
                    h[i][j] += w[i][j] + self.v[i][j] + dot(&self.s[i * x..][..x], &b[j * x..][..x]);
                }
            }
        }
        self.ldl[k] = factor_ldl(h)?;
        Ok(())
    }

    /// Computes the gain `K` and its factors `Y` and `−D⁻¹Y`. If the change of the input has a weight, the
    /// gain `K_v` of the previous input and the blocks `S` and `V` of the cost-to-go matrix follow.
    #[inline(always)]
    fn stage_gain(&mut self, k: usize, add_rows: impl FnOnce(&mut [V])) {
        let x = Self::RX;
        let a = &self.a[k * NX * x..][..NX * x];
        product::<V, NX, NU, false, 1>(
            &mut self.y,
            None,
            [Term { left: a, right: Right::columns(flat(&self.pb), x * V::WIDTH), depth: NX }],
        );
        add_rows(&mut self.y);
        let l = &self.ldl[k];
        let gain = &mut self.k[k * NU * x..][..NU * x];
        for r in 0..x {
            for i in 0..NU {
                let mut sum = self.y[i * x + r];
                for j in 0..i {
                    sum = self.y[j * x + r].mul_neg_add(V::splat(l[i][j]), sum);
                }
                self.y[i * x + r] = sum;
                self.z[i * x + r] = sum * V::splat(-l[i][i]);
            }
            for i in (0..NU).rev() {
                let mut sum = self.z[i * x + r];
                for j in i + 1..NU {
                    sum = gain[j * x + r].mul_neg_add(V::splat(l[j][i]), sum);
                }
                gain[i * x + r] = sum;
            }
        }
        if let Some(w) = self.rate {
            self.stage_rate(k, &w);
        }
    }

    /// Computes the gain `K_v = (Λ D Λᵀ)⁻¹ W` of the previous input, and the blocks `S = KᵀH_uv = −KᵀW` and
    /// `V = W − W K_v` of the cost-to-go matrix. W is the weight of the change of the input.
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
                let mut sum = V::zero();
                for i in 0..NU {
                    sum = gain[i * x + r].mul_neg_add(V::splat(w[i][j]), sum);
                }
                self.s[j * x + r] = sum;
            }
            for i in 0..=j {
                let mut v = w[i][j];
                for m in 0..NU {
                    v -= w[i][m] * kv[m][j];
                }
                self.v[i][j] = v;
                self.v[j][i] = v;
            }
        }
    }

    /// Computes the closed-loop matrix `Φ = A + B K` of the system matrices A and B and the gain K.
    #[inline(always)]
    fn stage_closed_loop(&mut self, k: usize) {
        let x = Self::RX;
        let a = &self.a[k * NX * x..][..NX * x];
        let b = &self.b[k * NU * x..][..NU * x];
        let gain = &self.k[k * NU * x..][..NU * x];
        product::<V, NX, NX, false, 1>(
            &mut self.phi[k * NX * x..][..NX * x],
            Some(a),
            [Term { left: gain, right: Right::rows(flat(b), x * V::WIDTH), depth: NU }],
        );
    }

    /// Computes the cost-to-go matrix `P = Q + AᵀP⁺A − YᵀD⁻¹Y` of a stage. Q are the state weights, A is the
    /// state matrix, P⁺ is the cost-to-go matrix of the next stage, and Y and D are factors of the gain. The
    /// lower blocks are computed by products, the upper blocks by symmetry.
    #[inline(always)]
    fn stage_cost_to_go(&mut self, k: usize, add_rows: impl FnOnce(&mut [V])) {
        let x = Self::RX;
        let a = &self.a[k * NX * x..][..NX * x];
        product::<V, NX, NX, false, 1>(
            &mut self.pa,
            None,
            [Term { left: &self.p, right: Right::rows(flat(a), x * V::WIDTH), depth: NX }],
        );
        product::<V, NX, NX, true, 2>(
            &mut self.p,
            Some(&self.q),
            [
                Term { left: a, right: Right::columns(flat(&self.pa), x * V::WIDTH), depth: NX },
                Term { left: &self.y, right: Right::rows(flat(&self.z), x * V::WIDTH), depth: NU },
            ],
        );
        add_rows(&mut self.p);
        mirror::<V, NX>(&mut self.p, x);
    }
}

/// Mean of a matrix and its transpose.
fn symmetric<const N: usize>(m: &[[f64; N]; N]) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (m[i][j] + m[j][i])))
}

/// Makes a matrix of `NX` padded columns symmetric. Blocks above the diagonal are copied from below. Blocks on the diagonal
/// are replaced by the mean with their transpose. Otherwise the recursion would propagate an antisymmetric rounding error E
/// as `AᵀEA` with the open-loop matrix A.
#[inline(always)]
fn mirror<V: Vector, const NX: usize>(p: &mut [V], n: usize) {
    for rb in 0..n {
        let width = (NX - rb * V::WIDTH).min(V::WIDTH);
        let mut block = [V::zero(); MAX_WIDTH];
        for j in 0..width {
            block[j] = p[(rb * V::WIDTH + j) * n + rb];
        }
        let mut transposed = block;
        V::transpose(&mut transposed);
        for j in 0..width {
            p[(rb * V::WIDTH + j) * n + rb] = (block[j] + transposed[j]) * V::splat(0.5);
        }
    }
    for rb in 1..n {
        for cb in 0..rb {
            let mut block = [V::zero(); MAX_WIDTH];
            for j in 0..V::WIDTH {
                block[j] = p[(cb * V::WIDTH + j) * n + rb];
            }
            V::transpose(&mut block);
            for j in 0..(NX - rb * V::WIDTH).min(V::WIDTH) {
                p[(rb * V::WIDTH + j) * n + cb] = block[j];
            }
        }
    }
}
