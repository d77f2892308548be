//! The Panda with friction at its joints, which its published URDF does not have.

use gelenk_runtime::dynamics::{
    Differentiable, Discretizable, Dynamics, ForceDerivatives, LimitRows, Limits, Linearization, PhaseSpace,
};

gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda);

/// The friction at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// `tanh 50 ẏ`.
    Smooth,
    /// As it is.
    Exact,
}

/// Viscous [N m s/rad] and dry [N m] friction of each joint.
const VISCOUS: [f64; 7] = [3.0, 3.0, 3.0, 3.0, 1.0, 1.0, 1.0];
const DRY: [f64; 7] = [4.0, 4.0, 4.0, 4.0, 1.0, 1.0, 1.0];

/// Inputs are joint torques, so that friction is an input with another sign.
#[derive(Debug, Clone, Copy)]
pub struct Rubbing {
    /// Scale of each joint's friction.
    pub scale: [f64; 7],
    pub sign: Sign,
}

impl Rubbing {
    fn slopes(&self, v: &[f64; 7]) -> [f64; 7] {
        core::array::from_fn(|i| {
            let tanh = (50.0 * v[i]).tanh();
            self.scale[i] * (VISCOUS[i] + 50.0 * DRY[i] * (1.0 - tanh * tanh))
        })
    }
}

impl Dynamics<7, 7> for Rubbing {
    fn limits(&self) -> Limits<7, 7> {
        Panda.limits()
    }
    fn mass_matrix(&self, y: &[f64; 7]) -> [[f64; 7]; 7] {
        Panda.mass_matrix(y)
    }
    fn coriolis_forces(&self, y: &[f64; 7], v: &[f64; 7]) -> [f64; 7] {
        Panda.coriolis_forces(y, v)
    }
    fn gravity_forces(&self, y: &[f64; 7]) -> [f64; 7] {
        Panda.gravity_forces(y)
    }
    fn spring_forces(&self, y: &[f64; 7], v: &[f64; 7]) -> [f64; 7] {
        Panda.spring_forces(y, v)
    }
    fn friction_torques(&self, y: &[f64; 7], v: &[f64; 7]) -> [f64; 7] {
        let described = Panda.friction_torques(y, v);
        core::array::from_fn(|i| {
            let sign = match self.sign {
                Sign::Smooth => (50.0 * v[i]).tanh(),
                Sign::Exact if v[i] == 0.0 => 0.0,
                Sign::Exact => v[i].signum(),
            };
            described[i] + self.scale[i] * (VISCOUS[i] * v[i] + DRY[i] * sign)
        })
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        match self.sign {
            Sign::Smooth => &[],
            Sign::Exact => &[[0, 0], [1, 1], [2, 2], [3, 3], [4, 4], [5, 5], [6, 6]],
        }
    }
    fn input_matrix(&self, y: &[f64; 7]) -> [[f64; 7]; 7] {
        Panda.input_matrix(y)
    }
}

impl Differentiable<7, 7> for Rubbing {
    fn inverse_dynamics_derivatives(&self, y: &[f64; 7], v: &[f64; 7], a: &[f64; 7]) -> ForceDerivatives<7> {
        let mut derivatives = Panda.inverse_dynamics_derivatives(y, v, a);
        for (i, slope) in self.slopes(v).into_iter().enumerate() {
            derivatives.by_velocities[i][i] += slope;
        }
        derivatives.forces = self.inverse_dynamics(y, v, a);
        derivatives
    }

    fn linearize(&self, y: &[f64; 7], v: &[f64; 7], u: &[f64; 7]) -> Linearization<7, 7> {
        let (all, described) = (self.friction_torques(y, v), Panda.friction_torques(y, v));
        let added: [f64; 7] = core::array::from_fn(|i| all[i] - described[i]);
        let mut linear = Panda.linearize(y, v, &core::array::from_fn(|i| u[i] - added[i]));
        let slopes = self.slopes(v);
        for i in 0..7 {
            for j in 0..7 {
                let (by_input, slope) = (linear.by_inputs[i][j], slopes[j]);
                linear.by_velocities[i][j] -= by_input * slope;
                linear.affine[i] += by_input * (slope * v[j] - added[j]);
            }
        }
        linear
    }
}

impl Discretizable<7, 7> for Rubbing {}

impl PhaseSpace<14> for Rubbing {}

impl LimitRows<0> for Rubbing {}
