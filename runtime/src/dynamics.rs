//! The bridge between generated modules and generic code: [`Dynamics`], [`Differentiable`], and the macros that wrap a
//! module in one line.
//!
//! Generated files have no dependencies, so they cannot implement a trait themselves. [`dynamics!`](crate::dynamics!)
//! does it for them; every method then is a call of the generated function, nothing else.

/// Equations of motion `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a robot with `N` coordinates and `M` inputs, with
/// `q = gravity + springs − friction`.
///
/// Arrays are indexed by coordinate or input in the order of the module's `JOINT_NAMES` and `INPUT_NAMES`, matrices rows
/// first; units are rad or m, s, N m or N. `y`, `v`, `a`, `u` are the coordinates, velocities, accelerations and inputs.
///
/// The methods with a body combine the others, for modules that were generated without these functions. What a module
/// has is faster, because it shares work.
pub trait Dynamics<const N: usize, const M: usize> {
    /// Limits of joints and inputs.
    fn limits(&self) -> Limits<N, M>;

    /// Mass matrix `M(y)`, symmetric and positive definite.
    fn mass_matrix(&self, y: &[f64; N]) -> [[f64; N]; N];

    /// Coriolis, centrifugal and gyroscopic forces `k(y, ẏ)`, on the left-hand side.
    fn coriolis_forces(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N];

    /// Generalized forces of gravity, a part of q.
    fn gravity_forces(&self, y: &[f64; N]) -> [f64; N];

    /// Generalized forces of springs and dampers, a part of q.
    fn spring_forces(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N];

    /// Joint friction `τ(ẏ)`, positive for positive velocity; q holds −τ.
    fn friction_torques(&self, v: &[f64; N]) -> [f64; N];

    /// Input matrix `B`, constant; holds the gear ratios.
    fn input_matrix(&self) -> [[f64; M]; N];

    /// Applied forces `q(y, ẏ) = gravity + springs − τ`.
    fn applied_forces(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        let (gravity, springs) = (self.gravity_forces(y), self.spring_forces(y, v));
        let friction = self.friction_torques(v);
        core::array::from_fn(|i| gravity[i] + springs[i] - friction[i])
    }

    /// Bias forces `k − gravity`, what other libraries call `nle`.
    fn bias_forces(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        let (coriolis, gravity) = (self.coriolis_forces(y, v), self.gravity_forces(y));
        core::array::from_fn(|i| coriolis[i] - gravity[i])
    }

    /// M, k and q at once.
    fn equations_of_motion(
        &self,
        y: &[f64; N],
        v: &[f64; N],
    ) -> ([[f64; N]; N], [f64; N], [f64; N]) {
        (
            self.mass_matrix(y),
            self.coriolis_forces(y, v),
            self.applied_forces(y, v),
        )
    }

    /// Forces `M ÿ + k − q` that the inputs must make at the joints.
    fn inverse_dynamics(&self, y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> [f64; N] {
        let (mass, coriolis, applied) = self.equations_of_motion(y, v);
        core::array::from_fn(|i| product(&mass[i], a) + coriolis[i] - applied[i])
    }

    /// Accelerations `ÿ = M⁻¹ (q + B u − k)`; NaN where M is not positive definite.
    fn forward_dynamics(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        let (mass, coriolis, applied) = self.equations_of_motion(y, v);
        let input_matrix = self.input_matrix();
        let forces =
            core::array::from_fn(|i| applied[i] + product(&input_matrix[i], u) - coriolis[i]);
        solve_positive_definite(mass, forces)
    }

    /// Kinetic energy `½ ẏᵀ M ẏ` in J.
    fn kinetic_energy(&self, y: &[f64; N], v: &[f64; N]) -> f64 {
        let mass = self.mass_matrix(y);
        let momentum: [f64; N] = core::array::from_fn(|i| product(&mass[i], v));
        0.5 * product(&momentum, v)
    }
}

/// Analytic derivatives of the equations of motion.
pub trait Differentiable<const N: usize, const M: usize>: Dynamics<N, M> {
    /// Inverse dynamics with its derivatives by coordinates and by velocities; row i belongs to force i. The third, by
    /// accelerations, is the mass matrix.
    fn inverse_dynamics_derivatives(
        &self,
        y: &[f64; N],
        v: &[f64; N],
        a: &[f64; N],
    ) -> ForceDerivatives<N>;

    /// Linearization of the forward dynamics about a state and an input.
    fn linearize(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> Linearization<N, M>;
}

/// Inverse dynamics and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceDerivatives<const N: usize> {
    /// The forces `M ÿ + k − q`.
    pub forces: [f64; N],
    /// ∂forces/∂y.
    pub by_coordinates: [[f64; N]; N],
    /// ∂forces/∂ẏ.
    pub by_velocities: [[f64; N]; N],
}

/// Accelerations as an affine function of state and input: the lower halves of A, B_x and c of `ẋ = A x + B_x u + c`.
/// The upper halves are `[0 I]`, 0 and 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linearization<const N: usize, const M: usize> {
    /// ∂ÿ/∂y.
    pub by_coordinates: [[f64; N]; N],
    /// ∂ÿ/∂ẏ.
    pub by_velocities: [[f64; N]; N],
    /// ∂ÿ/∂u.
    pub by_inputs: [[f64; M]; N],
    /// What remains: ÿ where y, ẏ and u are zero.
    pub affine: [f64; N],
}

impl<const N: usize, const M: usize> Linearization<N, M> {
    /// Accelerations of the linearized robot.
    #[must_use]
    pub fn accelerations(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        core::array::from_fn(|i| {
            product(&self.by_coordinates[i], y)
                + product(&self.by_velocities[i], v)
                + product(&self.by_inputs[i], u)
                + self.affine[i]
        })
    }
}

/// Limits of joints and inputs; infinite where the description gives none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<const N: usize, const M: usize> {
    /// Lowest and highest position [rad or m].
    pub position: [[f64; 2]; N],
    /// Highest speed [rad/s or m/s].
    pub velocity: [f64; N],
    /// Nominal force at the joint [N m or N].
    pub effort: [f64; N],
    /// Peak force at the joint [N m or N].
    pub peak_effort: [f64; N],
    /// Magnitude of the input that its motor bears continuously.
    pub input: [f64; M],
    /// Magnitude of the input that its motor bears for a short time.
    pub peak_input: [f64; M],
}

fn product<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves `A x = b` by the factorization `A = L D Lᵀ` (Golub and Van Loan, Matrix Computations, 2013, section 4.1); NaN
/// where A is not positive definite.
fn solve_positive_definite<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for j in 0..N {
        let pivot = a[j][j];
        if pivot <= 0.0 {
            return [f64::NAN; N];
        }
        for i in j + 1..N {
            let factor = a[i][j] / pivot;
            for k in j + 1..=i {
                a[i][k] -= factor * a[k][j];
            }
            b[i] -= factor * b[j];
        }
    }
    for j in (0..N).rev() {
        let known: f64 = (j + 1..N).map(|i| a[i][j] * b[i]).sum();
        b[j] = (b[j] - known) / a[j][j];
    }
    b
}

/// Makes a type of a generated module that implements [`Dynamics`](crate::dynamics::Dynamics).
///
/// ```
/// use gelenk_runtime::dynamics::Dynamics;
///
/// gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// // Upright and at rest, gravity drives neither joint.
/// assert_eq!(PowerCube.gravity_forces(&[0.0, 0.0]), [0.0, 0.0]);
/// ```
///
/// With the module's derivatives the type also is [`Differentiable`](crate::dynamics::Differentiable):
///
/// ```ignore
/// gelenk_runtime::dynamics!(pub struct Ur5 = gelenk_generated::ur5: Dynamics + Differentiable);
/// ```
///
/// A module with free parameters is wrapped with them; the type then has a field `parameters`, and `Default`:
///
/// ```
/// use gelenk_runtime::dynamics::Dynamics;
///
/// gelenk_runtime::dynamics!(pub struct Pendulum { parameters } = gelenk_generated::double_pendulum);
///
/// let mut heavier = Pendulum::default();
/// heavier.parameters.m2 *= 2.0;
/// let effort = |pendulum: &Pendulum| pendulum.gravity_forces(&[0.3, 0.2])[1].abs();
/// assert!(effort(&heavier) > effort(&Pendulum::default()));
/// ```
///
/// A module that was generated with some of the functions names them; those that the trait cannot compute from others
/// must be among them:
///
/// ```
/// gelenk_runtime::dynamics!(pub struct CartPole = gelenk_generated::cart_pole: Dynamics [
///     mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques, input_matrix
/// ]);
/// ```
#[macro_export]
macro_rules! dynamics {
    // What follows the module: nothing, `Dynamics`, `Dynamics + Differentiable`, `Dynamics [functions]`.
    ($(#[$meta:meta])* $visibility:vis struct $name:ident = $($module:ident)::+ $(: $($traits:tt)+)?) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        $visibility struct $name;
        $crate::dynamics!(@traits $name, [$($module)::+], [], [$($($traits)+)?]);
    };
    ($(#[$meta:meta])* $visibility:vis struct $name:ident { parameters } = $($module:ident)::+ $(: $($traits:tt)+)?) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        $visibility struct $name {
            /// Free parameters of the model.
            pub parameters: $($module)::+::Parameters,
        }
        $crate::dynamics!(@traits $name, [$($module)::+], [parameters], [$($($traits)+)?]);
    };

    (@traits $name:ident, $module:tt, $parameters:tt, []) => {
        $crate::dynamics!(@traits $name, $module, $parameters, [Dynamics]);
    };
    (@traits $name:ident, $module:tt, $parameters:tt, [Dynamics]) => {
        $crate::dynamics!(@traits $name, $module, $parameters, [Dynamics [
            mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques, input_matrix, applied_forces,
            bias_forces, equations_of_motion, inverse_dynamics, forward_dynamics, kinetic_energy
        ]]);
    };
    (@traits $name:ident, $module:tt, $parameters:tt, [Dynamics + Differentiable]) => {
        $crate::dynamics!(@traits $name, $module, $parameters, [Dynamics]);
        $crate::dynamics!(@differentiable $name, $module, $parameters);
    };
    (@traits $name:ident, $module:tt, $parameters:tt, [Dynamics $functions:tt + Differentiable]) => {
        $crate::dynamics!(@traits $name, $module, $parameters, [Dynamics $functions]);
        $crate::dynamics!(@differentiable $name, $module, $parameters);
    };
    (@traits $name:ident, [$($module:ident)::+], $parameters:tt, [Dynamics $functions:tt]) => {
        impl $crate::dynamics::Dynamics<{ $($module)::+::N }, { $($module)::+::M }> for $name {
            fn limits(&self) -> $crate::dynamics::Limits<{ $($module)::+::N }, { $($module)::+::M }> {
                $crate::dynamics::Limits {
                    position: $($module)::+::POSITION_LIMITS,
                    velocity: $($module)::+::VELOCITY_LIMITS,
                    effort: $($module)::+::EFFORT_LIMITS,
                    peak_effort: $($module)::+::PEAK_EFFORT_LIMITS,
                    input: $($module)::+::INPUT_LIMITS,
                    peak_input: $($module)::+::PEAK_INPUT_LIMITS,
                }
            }
            $crate::dynamics!(@methods $functions, [$($module)::+], $parameters);
        }
    };

    (@methods [], $module:tt, $p:tt) => {};
    (@methods [$first:ident $(, $other:ident)* $(,)?], $module:tt, $p:tt) => {
        $crate::dynamics!(@method $first, $module, $p);
        $crate::dynamics!(@methods [$($other),*], $module, $p);
    };

    (@method mass_matrix, $module:tt, $p:tt) => {
        $crate::dynamics!(@define mass_matrix, $module, $p, (y: N), matrix);
    };
    (@method coriolis_forces, $module:tt, $p:tt) => {
        $crate::dynamics!(@define coriolis_forces, $module, $p, (y: N, v: N), vector);
    };
    (@method gravity_forces, $module:tt, $p:tt) => {
        $crate::dynamics!(@define gravity_forces, $module, $p, (y: N), vector);
    };
    (@method spring_forces, $module:tt, $p:tt) => {
        $crate::dynamics!(@define spring_forces, $module, $p, (y: N, v: N), vector);
    };
    (@method friction_torques, $module:tt, $p:tt) => {
        $crate::dynamics!(@define friction_torques, $module, $p, (v: N), vector);
    };
    (@method input_matrix, $module:tt, $p:tt) => {
        $crate::dynamics!(@define input_matrix, $module, $p, (), input_matrix);
    };
    (@method applied_forces, $module:tt, $p:tt) => {
        $crate::dynamics!(@define applied_forces, $module, $p, (y: N, v: N), vector);
    };
    (@method bias_forces, $module:tt, $p:tt) => {
        $crate::dynamics!(@define bias_forces, $module, $p, (y: N, v: N), vector);
    };
    (@method equations_of_motion, $module:tt, $p:tt) => {
        $crate::dynamics!(@define equations_of_motion, $module, $p, (y: N, v: N), equations);
    };
    (@method inverse_dynamics, $module:tt, $p:tt) => {
        $crate::dynamics!(@define inverse_dynamics, $module, $p, (y: N, v: N, a: N), vector);
    };
    (@method forward_dynamics, $module:tt, $p:tt) => {
        $crate::dynamics!(@define forward_dynamics, $module, $p, (y: N, v: N, u: M), vector);
    };
    (@method kinetic_energy, $module:tt, $p:tt) => {
        $crate::dynamics!(@define kinetic_energy, $module, $p, (y: N, v: N), scalar);
    };

    (@define $function:ident, $module:tt, [$($p:ident)?], ($($argument:ident: $len:ident),*), $result:ident) => {
        #[inline]
        fn $function(
            &self,
            $($argument: &$crate::dynamics!(@type $len, $module)),*
        ) -> $crate::dynamics!(@type $result, $module) {
            $crate::dynamics!(@call $function, $module, ($($argument,)* $(&self.$p)?))
        }
    };
    (@call $function:ident, [$($module:ident)::+], $arguments:tt) => { $($module)::+::$function $arguments };

    (@type scalar, [$($module:ident)::+]) => { f64 };
    (@type N, [$($module:ident)::+]) => { [f64; $($module)::+::N] };
    (@type M, [$($module:ident)::+]) => { [f64; $($module)::+::M] };
    (@type vector, $module:tt) => { $crate::dynamics!(@type N, $module) };
    (@type matrix, [$($module:ident)::+]) => { [[f64; $($module)::+::N]; $($module)::+::N] };
    (@type input_matrix, [$($module:ident)::+]) => { [[f64; $($module)::+::M]; $($module)::+::N] };
    (@type equations, $module:tt) => {
        (
            $crate::dynamics!(@type matrix, $module),
            $crate::dynamics!(@type vector, $module),
            $crate::dynamics!(@type vector, $module),
        )
    };

    (@differentiable $name:ident, [$($module:ident)::+], [$($p:ident)?]) => {
        impl $crate::dynamics::Differentiable<{ $($module)::+::N }, { $($module)::+::M }> for $name {
            #[inline]
            fn inverse_dynamics_derivatives(
                &self,
                y: &[f64; $($module)::+::N],
                v: &[f64; $($module)::+::N],
                a: &[f64; $($module)::+::N],
            ) -> $crate::dynamics::ForceDerivatives<{ $($module)::+::N }> {
                let (forces, by_coordinates, by_velocities) =
                    $($module)::+::inverse_dynamics_derivatives(y, v, a $(, &self.$p)?);
                $crate::dynamics::ForceDerivatives { forces, by_coordinates, by_velocities }
            }

            #[inline]
            fn linearize(
                &self,
                y: &[f64; $($module)::+::N],
                v: &[f64; $($module)::+::N],
                u: &[f64; $($module)::+::M],
            ) -> $crate::dynamics::Linearization<{ $($module)::+::N }, { $($module)::+::M }> {
                let (by_coordinates, by_velocities, by_inputs, affine) =
                    $($module)::+::linearize(y, v, u $(, &self.$p)?);
                $crate::dynamics::Linearization { by_coordinates, by_velocities, by_inputs, affine }
            }
        }
    };
}

/// Includes a module that the build script generated: `include_model!(pub mod arm)` reads `$OUT_DIR/arm.rs`.
///
/// ```ignore
/// // Needs a build script: gelenk_codegen::build("arm.toml");
/// gelenk_runtime::include_model!(
///     /// The arm on the bench.
///     pub mod arm
/// );
/// gelenk_runtime::dynamics!(pub struct Arm = arm);
/// ```
#[macro_export]
macro_rules! include_model {
    ($(#[$meta:meta])* $visibility:vis mod $name:ident $(;)?) => {
        $(#[$meta])*
        #[allow(dead_code, reason = "a program need not call all functions of its robot")]
        $visibility mod $name {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($name), ".rs"));
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cart-pole with unit masses and length, written by hand like a generated module: ideal force on the cart.
    /// Equations: Barto, Sutton and Anderson 1983, frictionless, point mass, angle from upright.
    mod cart_pole {
        pub const N: usize = 2;
        pub const M: usize = 1;
        pub const POSITION_LIMITS: [[f64; 2]; N] =
            [[-1.0, 1.0], [f64::NEG_INFINITY, f64::INFINITY]];
        pub const VELOCITY_LIMITS: [f64; N] = [f64::INFINITY; N];
        pub const EFFORT_LIMITS: [f64; N] = [f64::INFINITY; N];
        pub const PEAK_EFFORT_LIMITS: [f64; N] = [f64::INFINITY; N];
        pub const INPUT_LIMITS: [f64; M] = [10.0];
        pub const PEAK_INPUT_LIMITS: [f64; M] = [20.0];

        pub fn mass_matrix(y: &[f64; N]) -> [[f64; N]; N] {
            [[2.0, y[1].cos()], [y[1].cos(), 1.0]]
        }
        pub fn coriolis_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N] {
            [-y[1].sin() * v[1] * v[1], 0.0]
        }
        pub fn gravity_forces(y: &[f64; N]) -> [f64; N] {
            [0.0, 9.81 * y[1].sin()]
        }
        pub fn spring_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
            [0.0; N]
        }
        pub fn friction_torques(v: &[f64; N]) -> [f64; N] {
            [0.5 * v[0], 0.0]
        }
        pub fn input_matrix() -> [[f64; M]; N] {
            [[1.0], [0.0]]
        }
    }

    /// A module with all functions of the trait; those here are marked by impossible values.
    mod full {
        pub use super::cart_pole::*;

        pub fn applied_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
            [1.0; N]
        }
        pub fn bias_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
            [2.0; N]
        }
        pub fn equations_of_motion(
            _: &[f64; N],
            _: &[f64; N],
        ) -> ([[f64; N]; N], [f64; N], [f64; N]) {
            ([[3.0; N]; N], [3.0; N], [3.0; N])
        }
        pub fn inverse_dynamics(_: &[f64; N], _: &[f64; N], _: &[f64; N]) -> [f64; N] {
            [4.0; N]
        }
        pub fn forward_dynamics(_: &[f64; N], _: &[f64; N], _: &[f64; M]) -> [f64; N] {
            [5.0; N]
        }
        pub fn kinetic_energy(_: &[f64; N], _: &[f64; N]) -> f64 {
            6.0
        }
    }

    /// The same with a free friction coefficient.
    mod free {
        pub use super::cart_pole::*;

        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct Parameters {
            pub friction: f64,
        }
        pub fn mass_matrix(y: &[f64; N], _: &Parameters) -> [[f64; N]; N] {
            super::cart_pole::mass_matrix(y)
        }
        pub fn coriolis_forces(y: &[f64; N], v: &[f64; N], _: &Parameters) -> [f64; N] {
            super::cart_pole::coriolis_forces(y, v)
        }
        pub fn gravity_forces(y: &[f64; N], _: &Parameters) -> [f64; N] {
            super::cart_pole::gravity_forces(y)
        }
        pub fn spring_forces(y: &[f64; N], v: &[f64; N], _: &Parameters) -> [f64; N] {
            super::cart_pole::spring_forces(y, v)
        }
        pub fn friction_torques(v: &[f64; N], p: &Parameters) -> [f64; N] {
            [p.friction * v[0], 0.0]
        }
        pub fn input_matrix(_: &Parameters) -> [[f64; M]; N] {
            super::cart_pole::input_matrix()
        }
        pub fn inverse_dynamics_derivatives(
            _: &[f64; N],
            _: &[f64; N],
            _: &[f64; N],
            _: &Parameters,
        ) -> ([f64; N], [[f64; N]; N], [[f64; N]; N]) {
            ([1.0; N], [[2.0; N]; N], [[3.0; N]; N])
        }
        #[allow(clippy::type_complexity, reason = "as generated")]
        pub fn linearize(
            _: &[f64; N],
            _: &[f64; N],
            _: &[f64; M],
            p: &Parameters,
        ) -> ([[f64; N]; N], [[f64; N]; N], [[f64; M]; N], [f64; N]) {
            ([[1.0; N]; N], [[2.0; N]; N], [[3.0; M]; N], [p.friction; N])
        }
    }

    crate::dynamics!(
        /// The robot under test.
        pub struct CartPole = cart_pole: Dynamics [
            mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques, input_matrix
        ]
    );
    crate::dynamics!(struct Free { parameters } = free: Dynamics [
        mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques, input_matrix
    ] + Differentiable);

    crate::dynamics!(struct Full = full);

    const Y: [f64; 2] = [0.1, 0.7];
    const V: [f64; 2] = [-0.3, 1.1];

    /// Published closed form of the accelerations, solved for θ̈ and ẍ.
    fn published(force: f64) -> [f64; 2] {
        let (sin, cos) = Y[1].sin_cos();
        let pushed = force - 0.5 * V[0] + V[1] * V[1] * sin;
        let x = (pushed - 9.81 * sin * cos) / (2.0 - cos * cos);
        [x, 9.81 * sin - x * cos]
    }

    #[test]
    fn accelerations_follow_the_published_closed_form() {
        let computed = CartPole.forward_dynamics(&Y, &V, &[4.0]);
        for (a, b) in computed.iter().zip(published(4.0)) {
            assert!((a - b).abs() < 1e-13, "{a} and {b}");
        }
    }

    #[test]
    fn inverse_dynamics_gives_the_input_back() {
        let forces = CartPole.inverse_dynamics(&Y, &V, &published(4.0));
        assert!(
            (forces[0] - 4.0).abs() < 1e-13 && forces[1].abs() < 1e-13,
            "{forces:?}"
        );
    }

    #[test]
    fn an_indefinite_mass_matrix_gives_nan() {
        let x = solve_positive_definite([[1.0, 2.0], [2.0, 1.0]], [1.0, 1.0]);
        assert!(x.iter().all(|x| x.is_nan()));
    }

    #[test]
    fn a_system_of_three_is_solved() {
        // Moler matrix with α = −1: x was chosen, b = A x by hand.
        let a = [[1.0, -1.0, -1.0], [-1.0, 2.0, 0.0], [-1.0, 0.0, 3.0]];
        assert_eq!(
            solve_positive_definite(a, [-4.0, 3.0, 8.0]),
            [1.0, 2.0, 3.0]
        );
    }

    #[test]
    fn parameters_and_blocks_are_passed_on() {
        let robot = Free {
            parameters: free::Parameters { friction: 7.0 },
        };
        assert_eq!(robot.friction_torques(&[2.0, 0.0]), [14.0, 0.0]);
        assert_eq!(Free::default().friction_torques(&[2.0, 0.0]), [0.0, 0.0]);
        let linear = robot.linearize(&Y, &V, &[0.0]);
        assert_eq!(
            linear.accelerations(&[1.0, 1.0], &[1.0, 1.0], &[1.0]),
            [2.0 + 4.0 + 3.0 + 7.0; 2]
        );
        assert_eq!(
            robot.inverse_dynamics_derivatives(&Y, &V, &V).by_velocities,
            [[3.0; 2]; 2]
        );
        assert_eq!(robot.limits().peak_input, [20.0]);
    }

    #[test]
    fn what_a_module_has_is_called() {
        assert_eq!(Full.applied_forces(&Y, &V), [1.0; 2]);
        assert_eq!(Full.bias_forces(&Y, &V), [2.0; 2]);
        assert_eq!(Full.equations_of_motion(&Y, &V).0, [[3.0; 2]; 2]);
        assert_eq!(Full.inverse_dynamics(&Y, &V, &V), [4.0; 2]);
        assert_eq!(Full.forward_dynamics(&Y, &V, &[0.0]), [5.0; 2]);
        assert_eq!(Full.kinetic_energy(&Y, &V), 6.0);
    }

    #[test]
    fn generic_code_needs_only_the_trait() {
        fn power<const N: usize, const M: usize>(robot: &impl Dynamics<N, M>, v: &[f64; N]) -> f64 {
            product(&robot.friction_torques(v), v)
        }
        assert_eq!(power(&CartPole, &[2.0, 0.0]), 2.0);
    }
}
