//! The described robot with its learned friction, for controllers.

use crate::dynamics::{
    Differentiable, Discretizable, Dynamics, ForceDerivatives, ForceDerivativesAndMass, InputLimits,
    LimitRows, Limits, Linearization, PhaseSpace,
};
use gelenk_adaptation::{Adaptation, AdaptationError, JointScale, TERMS, input_inverse, terms};
use gelenk_kernels::math::sqrt;

/// Steps of the numerical derivative of friction, as shares of the velocity, of at least 1.
const STEP: f64 = 1e-6;

/// A robot with a learned friction of its drives in addition to the described one.
///
/// The learned friction `τ_δ(v)` of [`terms`] acts like an input,
///
/// ```text
///     M ÿ + k = q − τ_δ + B u = q + B (u − B⁺ τ_δ)
/// ```
///
/// so forward dynamics and linearization are those of the described robot at the input u − B⁺ τ_δ, with
/// `∂ÿ/∂ẏ − B_x B⁺ ∂τ_δ/∂ẏ`. Inputs must load the learned joints separately, which [`Adaptation`] requires.
/// The offset is part of τ_δ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnedFriction<D, const N: usize, const M: usize> {
    robot: D,
    scales: [Option<JointScale>; N],
    rests: [f64; N],
    /// δ of each joint.
    deltas: [[f64; TERMS]; N],
    /// Mean of the products of their errors.
    errors: [[[f64; TERMS]; TERMS]; N],
    /// B⁺ of the drives.
    inverse: [[f64; N]; M],
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize> LearnedFriction<D, N, M> {
    /// The robot with its described friction.
    ///
    /// - `adaptation`: estimator whose laws it will use
    ///
    /// # Errors
    /// [`AdaptationError::Inputs`] for robots with inputs at frames or driven joints, and if the inputs
    /// cannot load a learned joint separately.
    pub fn new(robot: D, adaptation: &Adaptation<N>) -> Result<Self, AdaptationError> {
        let inverse = input_inverse(&robot.drive_matrix(), |joint| adaptation.scales()[joint].is_some())?;
        if robot.drives() != M || !robot.driven_motion().is_empty() {
            return Err(AdaptationError::Inputs);
        }
        let rests = core::array::from_fn(|i| adaptation.rest(i));
        let (deltas, errors) = (adaptation.acting(), adaptation.acting_errors());
        Ok(Self { robot, scales: *adaptation.scales(), rests, deltas, errors, inverse })
    }

    /// The described robot.
    pub fn robot(&self) -> &D {
        &self.robot
    }

    pub(super) fn set_robot(&mut self, robot: D) {
        self.robot = robot;
    }

    /// The robot with the currently acting laws.
    #[must_use]
    pub fn with_laws(mut self, adaptation: &Adaptation<N>) -> Self {
        (self.deltas, self.errors) = (adaptation.acting(), adaptation.acting_errors());
        self
    }

    /// τ_δ at velocities v, for the described friction there.
    fn learned(&self, described: &[f64; N], v: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| dot(&self.terms(i, described[i], v[i]), &self.deltas[i]))
    }

    /// Terms of a joint; zero if it is not learned.
    fn terms(&self, joint: usize, described: f64, v: f64) -> [f64; TERMS] {
        let terms = |scale: &JointScale| terms(scale.shape(described, v, self.rests[joint]), v);
        self.scales[joint].as_ref().map_or([0.0; TERMS], terms)
    }

    /// τ_δ and its derivative by the velocity of its joint. Differences are taken on the side of the velocity, so a jump of the
    /// described friction at rest is not part of it.
    fn learned_slopes(&self, y: &[f64; N], v: &[f64; N]) -> ([f64; N], [f64; N]) {
        let at = |steps: f64| -> [f64; N] {
            let moved: [f64; N] = core::array::from_fn(|i| {
                let side = if v[i] < 0.0 { -1.0 } else { 1.0 };
                v[i] + side * steps * STEP * v[i].abs().max(1.0)
            });
            self.learned(&self.robot.friction_torques(y, &moved), &moved)
        };
        let (near, far) = (at(1.0), at(2.0));
        let slope = |i: usize| {
            let side = if v[i] < 0.0 { -1.0 } else { 1.0 };
            side * (far[i] - near[i]) / (STEP * v[i].abs().max(1.0))
        };
        (self.learned(&self.robot.friction_torques(y, v), v), core::array::from_fn(slope))
    }

    /// B⁺ τ_δ, subtracted from u.
    fn relieved(&self, u: &[f64; M], learned: &[f64; N]) -> [f64; M] {
        core::array::from_fn(|j| {
            u[j] - self.inverse[j].iter().zip(learned).map(|(b, torque)| b * torque).sum::<f64>()
        })
    }
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Methods that call those of the described robot.
macro_rules! of_the_robot {
    ($(fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(
            #[inline]
            fn $name(&self, $($argument: $type),*) -> $result {
                self.robot.$name($($argument),*)
            }
        )*
    };
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize> Dynamics<N, M> for LearnedFriction<D, N, M> {
    of_the_robot! {
        fn joint_names() -> [&'static str; N];
        fn input_names() -> [&'static str; M];
        fn limits() -> Limits<N, M>;
        fn drives() -> usize;
        fn drive_matrix() -> [[f64; M]; N];
        fn input_limits() -> InputLimits<M>;
        fn mass_matrix(y: &[f64; N]) -> [[f64; N]; N];
        fn coriolis_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn gravity_forces(y: &[f64; N]) -> [f64; N];
        fn spring_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn load_friction(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn friction_jumps() -> &'static [[usize; 2]];
        fn load_friction_at_rest(y: &[f64; N]) -> [[f64; 2]; N];
        fn input_matrix(y: &[f64; N]) -> [[f64; M]; N];
        fn kinetic_energy(y: &[f64; N], v: &[f64; N]) -> f64;
    }

    fn friction_torques(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        let described = self.robot.friction_torques(y, v);
        let learned = self.learned(&described, v);
        core::array::from_fn(|i| described[i] + learned[i])
    }

    fn friction_uncertainty(&self, y: &[f64; N], v: &[f64; N]) -> [[f64; N]; M] {
        let described = self.robot.friction_torques(y, v);
        let deviation = |i: usize| {
            let phi = self.terms(i, described[i], v[i]);
            let square = dot(&phi, &self.errors[i].each_ref().map(|row| dot(row, &phi)));
            sqrt(square.max(0.0))
        };
        let deviations: [f64; N] = core::array::from_fn(deviation);
        self.inverse.each_ref().map(|row| core::array::from_fn(|j| row[j] * deviations[j]))
    }

    fn friction_at_rest(&self, y: &[f64; N]) -> [[f64; 2]; N] {
        let described = self.robot.friction_at_rest(y);
        let side = |k: usize| {
            let sided: [f64; N] = core::array::from_fn(|i| described[i][k]);
            self.learned(&sided, &[0.0; N])
        };
        let [before, after] = [side(0), side(1)];
        core::array::from_fn(|i| [described[i][0] + before[i], described[i][1] + after[i]])
    }

    fn inverse_dynamics(&self, y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> [f64; N] {
        let forces = self.robot.inverse_dynamics(y, v, a);
        let learned = self.learned(&self.robot.friction_torques(y, v), v);
        core::array::from_fn(|i| forces[i] + learned[i])
    }

    fn forward_dynamics(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        let learned = self.learned(&self.robot.friction_torques(y, v), v);
        self.robot.forward_dynamics(y, v, &self.relieved(u, &learned))
    }
}

impl<D: Differentiable<N, M>, const N: usize, const M: usize> Differentiable<N, M>
    for LearnedFriction<D, N, M>
{
    fn inverse_dynamics_derivatives(&self, y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> ForceDerivatives<N> {
        let mut derivatives = self.robot.inverse_dynamics_derivatives(y, v, a);
        self.add_learned(&mut derivatives, y, v);
        derivatives
    }

    fn inverse_dynamics_derivatives_and_mass_matrix(
        &self,
        y: &[f64; N],
        v: &[f64; N],
        a: &[f64; N],
    ) -> ForceDerivativesAndMass<N> {
        let (mut derivatives, mass) = self.robot.inverse_dynamics_derivatives_and_mass_matrix(y, v, a);
        self.add_learned(&mut derivatives, y, v);
        (derivatives, mass)
    }

    of_the_robot! {
        fn input_forces_derivatives(y: &[f64; N], u: &[f64; M]) -> ([f64; N], [[f64; N]; N]);
    }

    fn linearize(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> Linearization<N, M> {
        let (learned, slopes) = self.learned_slopes(y, v);
        let relieved = self.relieved(u, &learned);
        let mut linear = self.robot.linearize(y, v, &relieved);
        for i in 0..N {
            // ÿ = A_y y + A_v v + B_x (u − B⁺ τ_δ(v)) + c, and τ_δ(v) is linearized about v̄.
            for j in 0..M {
                linear.affine[i] += linear.by_inputs[i][j] * (relieved[j] - u[j]);
            }
            for k in 0..N {
                let by_torque: f64 = (0..M).map(|j| linear.by_inputs[i][j] * self.inverse[j][k]).sum();
                linear.by_velocities[i][k] -= by_torque * slopes[k];
                linear.affine[i] += by_torque * slopes[k] * v[k];
            }
        }
        linear
    }
}

impl<D: Differentiable<N, M>, const N: usize, const M: usize> LearnedFriction<D, N, M> {
    fn add_learned(&self, derivatives: &mut ForceDerivatives<N>, y: &[f64; N], v: &[f64; N]) {
        let (learned, slopes) = self.learned_slopes(y, v);
        for i in 0..N {
            derivatives.forces[i] += learned[i];
            derivatives.by_velocities[i][i] += slopes[i];
        }
    }
}

/// The methods of discrete time are those of the traits, on the functions above.
impl<D: Discretizable<N, M>, const N: usize, const M: usize> Discretizable<N, M>
    for LearnedFriction<D, N, M>
{
    const SUBSTEPS: usize = D::SUBSTEPS;
}

impl<D: PhaseSpace<NX>, const N: usize, const M: usize, const NX: usize> PhaseSpace<NX>
    for LearnedFriction<D, N, M>
{
}
impl<D: LimitRows<NR>, const N: usize, const M: usize, const NR: usize> LimitRows<NR>
    for LearnedFriction<D, N, M>
{
}
