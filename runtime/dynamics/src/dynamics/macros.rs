//! Macros that make a generated module a type with its traits.

/// Makes a type of a generated module that implements [`Dynamics`](crate::dynamics::Dynamics).
///
/// ```
/// use gelenk_dynamics::dynamics::Dynamics;
///
/// gelenk_dynamics::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// // Upright and at rest, gravity drives neither joint.
/// assert_eq!(PowerCube.gravity_forces(&[0.0, 0.0]), [0.0, 0.0]);
/// ```
///
/// With the module's derivatives the type also is [`Differentiable`](crate::dynamics::Differentiable):
///
/// ```ignore
/// gelenk_dynamics::dynamics!(pub struct Ur5 = gelenk_generated::ur5: Dynamics + Differentiable);
/// ```
///
/// and with its functions of discrete time [`Discretizable`](crate::dynamics::Discretizable):
///
/// ```ignore
/// gelenk_dynamics::dynamics!(pub struct Ur5 = gelenk_generated::ur5: Dynamics + Differentiable + Discretizable);
/// ```
///
/// `Discretizable []` takes nothing from the module: the bodies of the trait discretize what `linearize` gives.
///
/// Limits and the names of joints and inputs are always taken from the module's constants.
///
/// A module with free parameters is wrapped with them; the type then has a field `parameters`, and `Default`:
///
/// ```
/// use gelenk_dynamics::dynamics::Dynamics;
///
/// gelenk_dynamics::dynamics!(pub struct Pendulum { parameters } = gelenk_generated::double_pendulum);
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
/// gelenk_dynamics::dynamics!(pub struct CartPole = gelenk_generated::cart_pole: Dynamics [
///     mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques, input_matrix
/// ]);
/// ```
#[macro_export]
macro_rules! dynamics {
    // What follows the module: nothing, `Dynamics`, `Dynamics [functions]`; then `+ Differentiable`; then
    // `+ Discretizable` or `+ Discretizable [functions]`.
    ($(#[$meta:meta])* $visibility:vis struct $name:ident = $($module:ident)::+ $(: $($traits:tt)+)?) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        $visibility struct $name;
        const _: fn() = || {
            // The module's own `Parameters`, where it has free ones, else this.
            #[allow(dead_code, reason = "only modules without free parameters need it")]
            type Parameters = ();
            {
                #[allow(unused_imports, clippy::wildcard_imports, reason = "whatever the module has")]
                use $($module)::+::*;
                $crate::dynamics::without_parameters::<Parameters>();
            }
        };
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
    (@traits $name:ident, $module:tt, $parameters:tt, [Dynamics + Differentiable + Discretizable $($functions:tt)?]) => {
        $crate::dynamics!(@traits $name, $module, $parameters, [Dynamics + Differentiable]);
        $crate::dynamics!(@discretizable $name, $module, $parameters, $($functions)?);
    };
    (@traits $name:ident, $module:tt, $parameters:tt,
        [Dynamics $dynamics:tt + Differentiable + Discretizable $($functions:tt)?]
    ) => {
        $crate::dynamics!(@traits $name, $module, $parameters, [Dynamics $dynamics + Differentiable]);
        $crate::dynamics!(@discretizable $name, $module, $parameters, $($functions)?);
    };
    (@traits $name:ident, [$($module:ident)::+], $parameters:tt, [Dynamics $functions:tt]) => {
        impl $crate::dynamics::Dynamics<{ $($module)::+::N }, { $($module)::+::M }> for $name {
            fn joint_names(&self) -> [&'static str; $($module)::+::N] {
                $($module)::+::JOINT_NAMES
            }

            fn input_names(&self) -> [&'static str; $($module)::+::M] {
                $($module)::+::INPUT_NAMES
            }

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
        $crate::dynamics!(@friction $module, $p);
    };
    // A module's function takes y only where a law depends on it.
    (@friction [$($module:ident)::+], []) => {
        #[inline]
        fn friction_torques(
            &self,
            y: &[f64; $($module)::+::N],
            v: &[f64; $($module)::+::N],
        ) -> [f64; $($module)::+::N] {
            $crate::dynamics::FrictionLaw::torques(&$($module)::+::friction_torques, y, v)
        }
    };
    (@friction [$($module:ident)::+], [$p:ident]) => {
        #[inline]
        fn friction_torques(
            &self,
            y: &[f64; $($module)::+::N],
            v: &[f64; $($module)::+::N],
        ) -> [f64; $($module)::+::N] {
            $crate::dynamics::FrictionLawWithParameters::torques(&$($module)::+::friction_torques, y, v, &self.$p)
        }
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

    (@discretizable $name:ident, $module:tt, $p:tt,) => {
        $crate::dynamics!(@discretizable $name, $module, $p, [SUBSTEPS, discretize, step, step_derivatives]);
    };
    (@discretizable $name:ident, [$($module:ident)::+], $p:tt, $functions:tt) => {
        impl $crate::dynamics::Discretizable<{ $($module)::+::N }, { $($module)::+::M }> for $name {
            $crate::dynamics!(@methods $functions, [$($module)::+], $p);
        }
        impl $crate::dynamics::PhaseSpace<{ 2 * $($module)::+::N }> for $name {}
    };
    (@method SUBSTEPS, [$($module:ident)::+], $p:tt) => {
        const SUBSTEPS: usize = $($module)::+::SUBSTEPS;
    };
    (@method discretize, $module:tt, $p:tt) => {
        $crate::dynamics!(@over_period discretize, $module, $p, Discretization, (state, input, affine));
    };
    (@method step, $module:tt, $p:tt) => {
        $crate::dynamics!(@over_period step, $module, $p, states, (y, v));
    };
    (@method step_derivatives, $module:tt, $p:tt) => {
        $crate::dynamics!(
            @over_period step_derivatives, $module, $p, Step, (coordinates, velocities, state, input)
        );
    };
    (@over_period $function:ident, [$($module:ident)::+], [$($p:ident)?], $result:ident, $values:tt) => {
        #[inline]
        fn $function(
            &self,
            y: &[f64; $($module)::+::N],
            v: &[f64; $($module)::+::N],
            u: &[f64; $($module)::+::M],
            period: f64,
        ) -> $crate::dynamics!(@over $result, [$($module)::+]) {
            let $values = $($module)::+::$function(y, v, u, period $(, &self.$p)?);
            $crate::dynamics!(@made $result, $values)
        }
    };
    (@over states, [$($module:ident)::+]) => { ([f64; $($module)::+::N], [f64; $($module)::+::N]) };
    (@over $result:ident, [$($module:ident)::+]) => {
        $crate::dynamics::$result<{ $($module)::+::N }, { $($module)::+::M }>
    };
    (@made states, $values:tt) => { $values };
    (@made $result:ident, ($($value:ident),*)) => { $crate::dynamics::$result { $($value),* } };
}

/// Includes a module that the build script generated: `include_model!(pub mod arm)` reads `$OUT_DIR/arm.rs`, which is named
/// after the robot (in a URDF: `<robot name="arm">`), not after the file. Where the build script generates no robot of that
/// name, the compiler's message says which it does. The documentation of the module is the robot's description.
///
/// ```ignore
/// // Needs a build script: gelenk_codegen::build("arm.toml");
/// gelenk_dynamics::include_model!(
///     /// The arm on the bench.
///     pub mod arm
/// );
/// gelenk_dynamics::dynamics!(pub struct Arm = arm);
/// ```
#[macro_export]
macro_rules! include_model {
    ($(#[$meta:meta])* $visibility:vis mod $name:ident $(;)?) => {
        $(#[$meta])*
        // For rustdoc alone: where the module is missing, one error says so. A paragraph of its own.
        #[cfg_attr(doc, doc = "")]
        #[cfg_attr(doc, doc = include_str!(concat!(env!("OUT_DIR"), "/gelenk.", stringify!($name), ".md")))]
        #[allow(dead_code, reason = "a program need not call all functions of its robot")]
        $visibility mod $name {
            include!(concat!(
                env!(
                    "OUT_DIR",
                    "include_model! needs a build script, build.rs beside Cargo.toml, that calls `gelenk_codegen::build`"
                ),
                "/gelenk.modules.rs"
            ));
            gelenk_module!($name);
        }
    };
}
