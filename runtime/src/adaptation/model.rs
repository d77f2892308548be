//! Model of a robot with learned friction, for controllers.

use crate::dynamics::{
    Differentiable, Discretizable, Dynamics, ForceDerivatives, ForceDerivativesAndMass, InputLimits,
    LimitRows, Limits, Linearization, PhaseSpace, load, under_load,
};
use gelenk_adaptation::{
    Adaptation, AdaptationError, DescribedForces, JointScale, TERMS, input_inverse, terms,
};
use gelenk_kernels::math::sqrt;

/// Step of the numerical derivatives of friction, relative to the position or velocity, or to 1 at smaller values.
const STEP: f64 = 1e-6;

/// Model of a robot whose joints have a learned friction in addition to the described friction.
///
/// The equations of motion of the described robot are `M ÿ + k = q + B u` with inputs u and input matrix B.
/// The learned friction torques τ_δ, see [`terms`], act like an input:
///
/// ```text
///     M ÿ + k = q − τ_δ + B u = q + B (u − B⁺ τ_δ)
/// ```
///
/// Therefore forward dynamics and linearization are those of the described robot at the input `u − B⁺ τ_δ`.
/// Derivatives of τ_δ are difference quotients. Load-dependent friction per unit of load is `s₁ (1 + δ₅)`, but at most
/// `(1 + |s₁|)/2`, so that the load is unique for given inputs. The inputs must be able to exert a force on each learned joint
/// alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnedFriction<D, const N: usize, const M: usize> {
    robot: D,
    scales: [Option<JointScale>; N],
    rests: [f64; N],
    /// Coefficients δ of the learned friction terms of each joint.
    deltas: [[f64; TERMS]; N],
    /// Expected products of the errors of the coefficients δ, for each joint.
    errors: [[[f64; TERMS]; TERMS]; N],
    /// Input matrix B of the drives (`matrix`), and its pseudo-inverse B⁺.
    matrix: [[f64; M]; N],
    inverse: [[f64; N]; M],
    /// Whether the friction of a joint depends on the motion of others, as friction of coupled drives does.
    is_coupled: bool,
}

/// Described and learned friction of a joint at a state.
#[derive(Debug, Clone, Copy)]
struct JointLaw {
    described: f64,
    /// Learned friction torque without its load-dependent part [N m or N].
    learned: f64,
    /// Described load-dependent friction per unit of load.
    described_share: f64,
    learned_share: f64,
}

/// Learned friction torque τ_δ, and its derivative with respect to the force that determines the load.
type Learned = (f64, f64);

impl JointLaw {
    /// Learned friction if the inverse dynamics of the described robot are given.
    ///
    /// - `force`: inverse dynamics of the described robot
    fn of_described_force(&self, force: f64) -> Learned {
        self.of_load(force - self.described, self.described_share)
    }

    /// Learned friction if the force of the drive is given.
    ///
    /// - `force`: force of the drive
    fn of_drive_force(&self, force: f64) -> Learned {
        self.of_load(force - self.described - self.learned, self.learned_share)
    }

    /// Learned friction if the sum of the load and its friction is given.
    ///
    /// - `exerted`: load and load-dependent friction
    /// - `share`: load-dependent friction per unit of load
    fn of_load(&self, exerted: f64, share: f64) -> Learned {
        let (load, side) = (load(exerted, share), if exerted < 0.0 { -1.0 } else { 1.0 });
        let change = under_load(load, self.learned_share) - under_load(load, self.described_share);
        let slope = side * (self.learned_share - self.described_share) / (1.0 + side * share);
        (self.learned + change, slope)
    }
}

/// Derivatives of the learned friction torques with respect to positions and velocities, at constant forces.
/// Row i belongs to joint i.
struct Slopes<const N: usize> {
    by_coordinates: [[f64; N]; N],
    by_velocities: [[f64; N]; N],
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize> LearnedFriction<D, N, M> {
    /// The model of `robot` with the laws that currently act in `adaptation`.
    ///
    /// # Errors
    /// [`AdaptationError::Inputs`] for robots with inputs at frames or driven joints, and if the inputs
    /// cannot exert a force on a learned joint alone.
    pub fn new(robot: D, adaptation: &Adaptation<N>) -> Result<Self, AdaptationError> {
        let matrix = robot.drive_matrix();
        let inverse = input_inverse(&matrix, |joint| adaptation.scales()[joint].is_some())?;
        if robot.drives() != M || !robot.driven_motion().is_empty() {
            return Err(AdaptationError::Inputs);
        }
        let rests = core::array::from_fn(|i| adaptation.rest(i));
        let (deltas, errors) = (adaptation.acting(), adaptation.acting_errors());
        let is_coupled = (0..N).any(|k| moves_others(&robot, k));
        Ok(Self { robot, scales: *adaptation.scales(), rests, deltas, errors, matrix, inverse, is_coupled })
    }

    /// The described robot.
    pub fn robot(&self) -> &D {
        &self.robot
    }

    pub(super) fn set_robot(&mut self, robot: D) {
        self.robot = robot;
    }

    /// Returns the model with the laws that currently act in `adaptation`.
    #[must_use]
    pub fn with_laws(mut self, adaptation: &Adaptation<N>) -> Self {
        (self.deltas, self.errors) = (adaptation.acting(), adaptation.acting_errors());
        self
    }

    /// Learned friction at velocities v without load-dependent friction.
    ///
    /// - `described`: described friction at these velocities
    fn learned(&self, described: &[f64; N], v: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| dot(&self.terms(i, described[i], v[i], 0.0), &self.deltas[i]))
    }

    /// Learned load-dependent friction per unit of load, computed from the described one.
    fn learned_shares(&self, described: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| {
            let most = 0.5 * (1.0 + described[i].abs());
            (described[i] * (1.0 + self.deltas[i][TERMS - 1])).clamp(-most, most)
        })
    }

    fn laws(&self, y: &[f64; N], v: &[f64; N]) -> [JointLaw; N] {
        let (described, shares) = (self.robot.friction_torques(y, v), self.robot.load_friction(y, v));
        let (learned, learned_shares) = (self.learned(&described, v), self.learned_shares(&shares));
        core::array::from_fn(|i| JointLaw {
            described: described[i],
            learned: learned[i],
            described_share: shares[i],
            learned_share: learned_shares[i],
        })
    }

    /// Terms of a joint; zero if it is not learned.
    fn terms(&self, joint: usize, described: f64, v: f64, load: f64) -> [f64; TERMS] {
        let terms = |scale: &JointScale| terms(scale.shape(described, v, self.rests[joint]), v, load);
        self.scales[joint].as_ref().map_or([0.0; TERMS], terms)
    }

    /// Joint forces `B u` of the inputs u, with the input matrix B.
    fn drive_forces(&self, u: &[f64; M]) -> [f64; N] {
        self.matrix.each_ref().map(|row| row.iter().zip(u).map(|(b, u)| b * u).sum())
    }

    /// Derivatives of the learned friction torques at constant forces, as one-sided difference quotients.
    ///
    /// - `laws`: laws at this state
    /// - `of`: function that returns the learned friction torque of a joint
    fn slopes(
        &self,
        y: &[f64; N],
        v: &[f64; N],
        laws: &[JointLaw; N],
        of: impl Fn(usize, &JointLaw) -> f64,
    ) -> Slopes<N> {
        let mut slopes = Slopes { by_coordinates: [[0.0; N]; N], by_velocities: [[0.0; N]; N] };
        let step = |x: f64| STEP * x.abs().max(1.0);
        let side = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
        for k in 0..if self.is_coupled { N } else { 1 } {
            let moved = |x: &[f64; N], steps: [f64; N]| -> [f64; N] {
                let is_moved = |i: usize| !self.is_coupled || i == k;
                core::array::from_fn(|i| if is_moved(i) { x[i] + steps[i] * step(x[i]) } else { x[i] })
            };
            let elsewhere = self.laws(&moved(y, [1.0; N]), v);
            // Velocities of one sign, so that a jump of the described friction at rest is not part of the quotient.
            let [near, far] = [1.0, 2.0].map(|steps| self.laws(y, &moved(v, v.map(|v| steps * side(v)))));
            for i in 0..N {
                let j = if self.is_coupled { k } else { i };
                slopes.by_coordinates[i][j] = (of(i, &elsewhere[i]) - of(i, &laws[i])) / step(y[j]);
                slopes.by_velocities[i][j] = side(v[j]) * (of(i, &far[i]) - of(i, &near[i])) / step(v[j]);
            }
        }
        slopes
    }

    /// The input `u − B⁺ τ_δ`, which is the input u without the part that overcomes the learned friction τ_δ.
    /// B⁺ is the pseudo-inverse of the input matrix.
    fn relieved(&self, u: &[f64; M], learned: &[f64; N]) -> [f64; M] {
        core::array::from_fn(|j| {
            u[j] - self.inverse[j].iter().zip(learned).map(|(b, torque)| b * torque).sum::<f64>()
        })
    }
}

/// Whether the friction of a joint depends on the velocity of joint k.
fn moves_others<D: Dynamics<N, M>, const N: usize, const M: usize>(robot: &D, k: usize) -> bool {
    let friction = |speed: f64| {
        let v = core::array::from_fn(|i| if i == k { speed } else { 0.0 });
        robot.friction_torques(&robot.neutral(), &v)
    };
    let (at_rest, moving) = (friction(0.0), friction(1.0));
    (0..N).any(|i| i != k && at_rest[i] != moving[i])
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Implements methods by calls of the same methods of the described robot.
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
        fn friction_jumps() -> &'static [[usize; 2]];
        fn input_matrix(y: &[f64; N]) -> [[f64; M]; N];
        fn kinetic_energy(y: &[f64; N], v: &[f64; N]) -> f64;
    }

    fn friction_torques(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        let described = self.robot.friction_torques(y, v);
        let learned = self.learned(&described, v);
        core::array::from_fn(|i| described[i] + learned[i])
    }

    fn load_friction(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        self.learned_shares(&self.robot.load_friction(y, v))
    }

    /// The load-dependent part is evaluated for the load at zero acceleration.
    fn friction_uncertainty(&self, y: &[f64; N], v: &[f64; N]) -> [[f64; N]; M] {
        let (described, shares) = (self.robot.friction_torques(y, v), self.robot.load_friction(y, v));
        let forces =
            if shares == [0.0; N] { described } else { self.robot.inverse_dynamics(y, v, &[0.0; N]) };
        let DescribedForces { load_friction, .. } = DescribedForces::new(forces, described, &shares);
        let deviation = |i: usize| {
            let phi = self.terms(i, described[i], v[i], load_friction[i]);
            let square = dot(&phi, &self.errors[i].each_ref().map(|row| dot(row, &phi)));
            sqrt(square.max(0.0))
        };
        let deviations: [f64; N] = core::array::from_fn(deviation);
        self.inverse.each_ref().map(|row| core::array::from_fn(|j| row[j] * deviations[j]))
    }

    fn friction_at_rest(&self, y: &[f64; N]) -> [[f64; 2]; N] {
        let described = self.robot.friction_at_rest(y);
        let [before, after] = [0, 1].map(|side| self.learned(&described.map(|sides| sides[side]), &[0.0; N]));
        core::array::from_fn(|i| [described[i][0] + before[i], described[i][1] + after[i]])
    }

    fn load_friction_at_rest(&self, y: &[f64; N]) -> [[f64; 2]; N] {
        let described = self.robot.load_friction_at_rest(y);
        let [before, after] = [0, 1].map(|side| self.learned_shares(&described.map(|sides| sides[side])));
        core::array::from_fn(|i| [before[i], after[i]])
    }

    fn inverse_dynamics(&self, y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> [f64; N] {
        let (forces, laws) = (self.robot.inverse_dynamics(y, v, a), self.laws(y, v));
        core::array::from_fn(|i| forces[i] + laws[i].of_described_force(forces[i]).0)
    }

    fn forward_dynamics(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        let (forces, laws) = (self.drive_forces(u), self.laws(y, v));
        let learned = core::array::from_fn(|i| laws[i].of_drive_force(forces[i]).0);
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
        let (mut derivatives, mut mass) = self.robot.inverse_dynamics_derivatives_and_mass_matrix(y, v, a);
        let gains = self.add_learned(&mut derivatives, y, v);
        for (row, gain) in mass.iter_mut().zip(gains) {
            *row = row.map(|entry| entry + gain * entry);
        }
        (derivatives, mass)
    }

    of_the_robot! {
        fn input_forces_derivatives(y: &[f64; N], u: &[f64; M]) -> ([f64; N], [[f64; N]; N]);
    }

    fn linearize(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> Linearization<N, M> {
        let (forces, laws) = (self.drive_forces(u), self.laws(y, v));
        let learned: [Learned; N] = core::array::from_fn(|i| laws[i].of_drive_force(forces[i]));
        let slopes = self.slopes(y, v, &laws, |i, law| law.of_drive_force(forces[i]).0);
        let mut linear = self.robot.linearize(y, v, &self.relieved(u, &learned.map(|(torque, _)| torque)));
        // ÿ = A_y y + A_v v + B_x (u − B⁺ τ_δ) + c, and τ_δ is linearized about ȳ, v̄ and ū.
        for i in 0..N {
            let by_torque: [f64; N] =
                core::array::from_fn(|k| (0..M).map(|j| linear.by_inputs[i][j] * self.inverse[j][k]).sum());
            for (k, by_torque) in by_torque.iter().enumerate() {
                let (torque, gain) = learned[k];
                linear.affine[i] += by_torque * (gain * forces[k] - torque);
                for j in 0..N {
                    let [by_y, by_v] =
                        [&slopes.by_coordinates, &slopes.by_velocities].map(|d| by_torque * d[k][j]);
                    linear.by_coordinates[i][j] -= by_y;
                    linear.by_velocities[i][j] -= by_v;
                    linear.affine[i] += by_y * y[j] + by_v * v[j];
                }
                for j in 0..M {
                    linear.by_inputs[i][j] -= by_torque * gain * self.matrix[k][j];
                }
            }
        }
        linear
    }
}

impl<D: Differentiable<N, M>, const N: usize, const M: usize> LearnedFriction<D, N, M> {
    /// Adds the learned friction torques to the inverse dynamics. Returns their derivatives with respect to
    /// the forces of the described robot.
    fn add_learned(&self, derivatives: &mut ForceDerivatives<N>, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        let (forces, laws) = (derivatives.forces, self.laws(y, v));
        let slopes = self.slopes(y, v, &laws, |i, law| law.of_described_force(forces[i]).0);
        core::array::from_fn(|i| {
            let (torque, gain) = laws[i].of_described_force(forces[i]);
            derivatives.forces[i] += torque;
            for j in 0..N {
                let by_y = &mut derivatives.by_coordinates[i][j];
                *by_y += gain * *by_y + slopes.by_coordinates[i][j];
                let by_v = &mut derivatives.by_velocities[i][j];
                *by_v += gain * *by_v + slopes.by_velocities[i][j];
            }
            gain
        })
    }
}

/// Uses the default discrete-time methods of the trait, which call the dynamics with the learned friction.
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
