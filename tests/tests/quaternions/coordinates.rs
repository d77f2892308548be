//! Pinocchio's coordinates and ours: its planar joints have velocities in the body's frame, and their angle is given by
//! cosine and sine.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{DMatrix, DVector};

/// A state in both coordinates: `v = P v'` and `a = P a' + Ṗ v'` with Pinocchio's v' and a'.
pub struct State {
    pub y: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    /// Our accelerations `Ṗ v'` where Pinocchio's are 0.
    pub steady: Vec<f64>,
    /// It turns the velocities of planar joints.
    pub p: DMatrix<f64>,
    planar: Vec<Planar>,
    /// Pinocchio's velocities and accelerations.
    theirs: [DVector<f64>; 2],
}

struct Planar {
    /// Its first velocity.
    first: usize,
    angle: f64,
    rate: f64,
}

impl Planar {
    /// Derivative of its block of P by the angle, of an order.
    fn turned(&self, n: usize, order: f64) -> DMatrix<f64> {
        let (sine, cosine) = (self.angle + order * FRAC_PI_2).sin_cos();
        let mut block = DMatrix::zeros(n, n);
        block.view_mut((self.first, self.first), (2, 2)).copy_from_slice(&[cosine, sine, -sine, cosine]);
        block
    }
}

impl State {
    /// - `planar`: first position and velocity of each planar joint of Pinocchio
    pub fn new(mut y: Vec<f64>, planar: &[[usize; 2]], v: Vec<f64>, a: Vec<f64>) -> Self {
        let n = v.len();
        let (v, a) = (DVector::from_vec(v), DVector::from_vec(a));
        let (mut p, mut rate) = (DMatrix::identity(n, n), DMatrix::zeros(n, n));
        let mut joints = vec![];
        for &[position, first] in planar.iter().rev() {
            let angle = y[position + 3].atan2(y[position + 2]);
            y.splice(position + 2..position + 4, [angle]);
            let joint = Planar { first, angle, rate: v[first + 2] };
            p.view_mut((first, first), (2, 2)).fill(0.0);
            p += joint.turned(n, 0.0);
            rate += joint.turned(n, 1.0) * joint.rate;
            joints.push(joint);
        }
        let own = |x: DVector<f64>| x.as_slice().to_vec();
        let steady = &rate * &v;
        Self {
            y,
            v: own(&p * &v),
            a: own(&p * &a + &steady),
            steady: own(steady),
            p,
            planar: joints,
            theirs: [v, a],
        }
    }

    fn len(&self) -> usize {
        self.v.len()
    }

    pub fn matrix(&self, flat: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.len(), flat.len() / self.len(), flat)
    }

    /// Pinocchio's forces.
    pub fn forces(&self, ours: &[f64]) -> DVector<f64> {
        self.p.transpose() * DVector::from_column_slice(ours)
    }

    /// Pinocchio's accelerations.
    pub fn accelerations(&self, ours: &[f64]) -> DVector<f64> {
        self.p.transpose() * self.beyond_steady(ours)
    }

    fn beyond_steady(&self, ours: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(ours) - DVector::from_column_slice(&self.steady)
    }

    /// A matrix whose columns at the planar joints' angles are given.
    fn by_angles(&self, column: impl Fn(&Planar) -> DVector<f64>) -> DMatrix<f64> {
        let mut result = DMatrix::zeros(self.len(), self.len());
        for joint in &self.planar {
            result.column_mut(joint.first + 2).copy_from(&column(joint));
        }
        result
    }

    /// Derivatives of `P x` along Pinocchio's tangent.
    fn turned(&self, x: &DVector<f64>) -> DMatrix<f64> {
        self.by_angles(|joint| joint.turned(self.len(), 1.0) * x)
    }

    /// Derivatives of `Pᵀ x` along Pinocchio's tangent.
    fn turned_back(&self, x: &DVector<f64>) -> DMatrix<f64> {
        self.by_angles(|joint| joint.turned(self.len(), 1.0).transpose() * x)
    }

    /// Derivatives of `Ṗ v'` along Pinocchio's tangent, and by v'.
    fn of_steady(&self) -> [DMatrix<f64>; 2] {
        let (n, [v, _]) = (self.len(), &self.theirs);
        let by_position = self.by_angles(|joint| joint.turned(n, 2.0) * v * joint.rate);
        let rates = self.planar.iter().map(|joint| joint.turned(n, 1.0) * joint.rate);
        [by_position, rates.fold(self.turned(v), |sum, rate| sum + rate)]
    }

    /// Pinocchio's Jacobians of `Pᵀ f(y, P v', P a' + Ṗ v')` from ours of f.
    pub fn inverse_jacobians(&self, [forces, by_y, by_v, mass]: [&[f64]; 4]) -> [DMatrix<f64>; 2] {
        let [v, a] = &self.theirs;
        let [by_y, by_v, mass] = [by_y, by_v, mass].map(|flat| self.matrix(flat));
        let [steady_by_q, steady_by_v] = self.of_steady();
        let by_q = &by_y * &self.p + &by_v * self.turned(v) + &mass * (self.turned(a) + steady_by_q);
        let back = self.turned_back(&DVector::from_column_slice(forces));
        let by_rates = &by_v * &self.p + &mass * steady_by_v;
        [self.p.transpose() * by_q + back, self.p.transpose() * by_rates]
    }

    /// Pinocchio's Jacobians of `Pᵀ (f(y, P v', P τ') − Ṗ v')` from ours of the accelerations f.
    ///
    /// - `torques`: τ'
    pub fn forward_jacobians(
        &self,
        [accelerations, by_y, by_v, by_forces]: [&[f64]; 4],
        torques: &DVector<f64>,
    ) -> [DMatrix<f64>; 2] {
        let [by_y, by_v, by_forces] = [by_y, by_v, by_forces].map(|flat| self.matrix(flat));
        let [steady_by_q, steady_by_v] = self.of_steady();
        let turned = &by_v * self.turned(&self.theirs[0]) + &by_forces * self.turned(torques);
        let by_q = &by_y * &self.p + turned - steady_by_q;
        let back = self.turned_back(&self.beyond_steady(accelerations));
        let by_rates = &by_v * &self.p - steady_by_v;
        [self.p.transpose() * by_q + back, self.p.transpose() * by_rates]
    }
}
