//! Macro that wraps a generated module as a type with traits.

/// Wraps a generated module as a type that implements [`Dynamics`](crate::dynamics::Dynamics). If the module
/// has derivatives, the type also implements [`Differentiable`](crate::dynamics::Differentiable) and
/// [`Discretizable`](crate::dynamics::Discretizable).
///
/// ```
/// use gelenk_dynamics::dynamics::Dynamics;
///
/// gelenk_dynamics::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// // In the upright position, the gravity forces of both joints are zero.
/// assert_eq!(PowerCube.gravity_forces(&[0.0, 0.0]), [0.0, 0.0]);
/// ```
///
/// Every method calls the function of the module with the same name. If the module was generated without this function, the method
/// computes the same result from other functions. These functions are always necessary:
///
/// - for [`Dynamics`](crate::dynamics::Dynamics): `mass_matrix`, `coriolis_forces`, `gravity_forces`, `spring_forces`,
///   `friction_torques` and `input_matrix`
/// - for [`Differentiable`](crate::dynamics::Differentiable): `inverse_dynamics_derivatives` and `linearize`
///
/// Limits and names of joints and inputs are constants of the module.
///
/// Traits can be listed after the module. The compiler then checks here that the module has the functions for these traits. Without
/// the list, a missing function is only reported at the first use of a trait.
///
/// ```
/// gelenk_dynamics::dynamics!(pub struct Ur5 = gelenk_generated::ur5: Differentiable + Discretizable);
/// ```
///
/// With `Discretizable []`, the type does not use the discrete-time functions of the module. Instead, the default methods of the
/// trait discretize the derivatives with one Runge–Kutta step per period, independently of `substeps` in the description:
///
/// ```
/// use gelenk_dynamics::dynamics::Discretizable;
///
/// gelenk_dynamics::dynamics!(struct Fine = gelenk_generated::powercube);
/// gelenk_dynamics::dynamics!(struct Coarse = gelenk_generated::powercube: Discretizable []);
///
/// assert_eq!((<Fine as Discretizable<2, 2>>::SUBSTEPS, <Coarse as Discretizable<2, 2>>::SUBSTEPS), (8, 1));
/// ```
///
/// A module with free parameters needs `{ parameters }`. The type then has a field `parameters` and implements `Default` with the
/// values of the description:
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
/// A module with driven joints needs `{ driven }` or `{ driven, parameters }`. The type then has a field `driven` with position,
/// velocity and acceleration of each driven joint, and represents the robot at one time. Its `Default` has NaN in this field,
/// because a default motion does not exist. `DrivenRobot` of `gelenk-runtime` adds a motion over time. `DrivenRobot` implements
/// [`Discretizable`](crate::dynamics::Discretizable), so plants and predictive controllers can use it.
///
/// ```
/// use gelenk_dynamics::dynamics::Dynamics;
///
/// gelenk_dynamics::dynamics!(pub struct RailArm { driven } = gelenk_generated::rail_arm);
///
/// let braking = RailArm { driven: [[0.2, 0.5, -1.0]] };
/// let rest = RailArm { driven: [[0.0; 3]] };
/// let force = |arm: &RailArm| arm.inverse_dynamics(&[0.0, 0.1], &[0.0; 2], &[0.0; 2]);
/// assert_ne!(force(&braking), force(&rest));
/// assert!(force(&RailArm::default())[0].is_nan());
/// ```
#[macro_export]
macro_rules! dynamics {
    ($(#[$meta:meta])* $visibility:vis struct $name:ident = $($module:ident)::+ $(: $first:ident $(+ $other:ident)* $([$($own:tt)*])?)?) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        $visibility struct $name;
        const _: fn() = || {
            // If the module has free parameters, its type `Parameters` is used instead of this type.
            #[allow(dead_code, reason = "only modules without free parameters need it")]
            type Parameters = ();
            // If the module has driven joints, its type `Driven` is used instead of this type.
            #[allow(dead_code, reason = "only modules without driven joints need it")]
            type Driven = ();
            {
                $crate::dynamics!(@import [$($module)::+]);
                $crate::dynamics::without_parameters::<Parameters>();
                $crate::dynamics::without_driven_joints::<Driven>();
            }
        };
        $crate::dynamics!(@implement $name, [$($module)::+], [], [$($first $(, $other)*)?], [$($([$($own)*])?)?]);
    };
    (
        $(#[$meta:meta])* $visibility:vis struct $name:ident { parameters } = $($module:ident)::+
        $(: $first:ident $(+ $other:ident)* $([$($own:tt)*])?)?
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        $visibility struct $name {
            /// Free parameters of the model.
            pub parameters: $($module)::+::Parameters,
        }
        const _: fn() = || {
            #[allow(dead_code, reason = "only modules without driven joints need it")]
            type Driven = ();
            {
                $crate::dynamics!(@import [$($module)::+]);
                $crate::dynamics::without_driven_joints::<Driven>();
            }
        };
        $crate::dynamics!(@implement $name, [$($module)::+], [parameters], [$($first $(, $other)*)?], [$($([$($own)*])?)?]);
    };
    (
        $(#[$meta:meta])* $visibility:vis struct $name:ident { driven } = $($module:ident)::+
        $(: $first:ident $(+ $other:ident)*)?
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        $visibility struct $name {
            /// Position, velocity and acceleration of each driven joint, in the order of `DRIVEN_NAMES`.
            pub driven: [[f64; 3]; $($module)::+::DRIVEN],
        }
        impl Default for $name {
            /// Returns the robot with unknown motion (NaN) of the driven joints.
            fn default() -> Self {
                Self { driven: $crate::dynamics::unknown() }
            }
        }
        const _: fn() = || {
            #[allow(dead_code, reason = "only modules without free parameters need it")]
            type Parameters = ();
            {
                $crate::dynamics!(@import [$($module)::+]);
                $crate::dynamics::without_parameters::<Parameters>();
            }
        };
        $crate::dynamics!(@driven $name, [$($module)::+], [driven], [$($first $(, $other)*)?]);
    };
    (
        $(#[$meta:meta])* $visibility:vis struct $name:ident { driven, parameters } = $($module:ident)::+
        $(: $first:ident $(+ $other:ident)*)?
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        $visibility struct $name {
            /// Position, velocity and acceleration of each driven joint, in the order of `DRIVEN_NAMES`.
            pub driven: [[f64; 3]; $($module)::+::DRIVEN],
            /// Free parameters of the model.
            pub parameters: $($module)::+::Parameters,
        }
        impl Default for $name {
            /// Returns the robot with unknown motion (NaN) of the driven joints, and with the parameters of the description.
            fn default() -> Self {
                Self { driven: $crate::dynamics::unknown(), parameters: Default::default() }
            }
        }
        $crate::dynamics!(@driven $name, [$($module)::+], [driven, parameters], [$($first $(, $other)*)?]);
    };

    // `Discretizable` is not implemented, because a step would need the motion of the driven joints over the period.
    (@driven $name:ident, $module:tt, $p:tt, [$($trait:ident),*]) => {
        $crate::dynamics!(@driven_joints $name, $module);
        $crate::dynamics!(@dynamics $name, $module, $p);
        $crate::dynamics!(@differentiable $name, $module, $p);
        $($crate::dynamics!(@check $trait, $name, $module);)*
    };
    (@driven_joints $name:ident, [$($module:ident)::+]) => {
        impl $crate::dynamics::DrivenJoints<{ $($module)::+::DRIVEN }> for $name {
            fn driven_names(&self) -> [&'static str; $($module)::+::DRIVEN] {
                $($module)::+::DRIVEN_NAMES
            }

            #[inline]
            fn with_driven(&self, driven: &[[f64; 3]; $($module)::+::DRIVEN]) -> Self {
                let mut robot = *self;
                robot.driven = *driven;
                robot
            }
        }
    };
    (@at_time [driven $(, $parameters:ident)?]) => {
        #[inline]
        fn at_time<R>(&self, _: f64, f: impl FnOnce(&Self) -> R) -> R {
            let mut robot = *self;
            robot.driven = $crate::dynamics::at_rest_or_unknown(&self.driven);
            f(&robot)
        }
    };
    (@at_time $p:tt) => {};

    (@implement $name:ident, $module:tt, $p:tt, [$($trait:ident),*], $own:tt) => {
        $crate::dynamics!(@dynamics $name, $module, $p);
        $crate::dynamics!(@differentiable $name, $module, $p);
        $crate::dynamics!(@discretizable $name, $module, $p, $own);
        $($crate::dynamics!(@check $trait, $name, $module);)*
    };
    (@check $trait:ident, $name:ident, [$($module:ident)::+]) => {
        const _: fn() = || {
            const fn is_implemented<T: $crate::dynamics::$trait<{ $($module)::+::N }, { $($module)::+::M }, { $crate::dynamics!(@positions [$($module)::+]) }>>() {}
            is_implemented::<$name>();
        };
    };

    (@dynamics $name:ident, [$($module:ident)::+], $p:tt) => {
        impl $crate::dynamics::Dynamics<
            { $($module)::+::N },
            { $($module)::+::M },
            { $crate::dynamics!(@positions [$($module)::+]) },
        > for $name {
            fn joint_names(&self) -> [&'static str; $($module)::+::N] {
                #[allow(unused_imports, reason = "only modules without quaternions need it")]
                use $($module)::+::JOINT_NAMES as VELOCITY_NAMES;
                {
                    $crate::dynamics!(@import [$($module)::+]);
                    VELOCITY_NAMES
                }
            }

            $crate::dynamics_on_manifold!([$($module)::+]);
            $crate::dynamics!(@at_time $p);
            $crate::driven_motion_of!($p);

            fn input_names(&self) -> [&'static str; $($module)::+::M] {
                $($module)::+::INPUT_NAMES
            }

            fn limits(&self) -> $crate::dynamics::Limits<{ $($module)::+::N }, { $($module)::+::M }> {
                $crate::dynamics::Limits {
                    position: $($module)::+::POSITION_LIMITS,
                    velocity: $($module)::+::VELOCITY_LIMITS,
                    effort: $($module)::+::EFFORT_LIMITS,
                    peak_effort: $($module)::+::PEAK_EFFORT_LIMITS,
                    input: $crate::dynamics!(@ranges [$($module)::+], INPUT_LIMITS),
                    peak_input: $crate::dynamics!(@ranges [$($module)::+], PEAK_INPUT_LIMITS),
                    dependent: $crate::dependent_joints_of!([$($module)::+]),
                    torque_speed: $crate::torque_speed_lines_of!([$($module)::+]),
                }
            }

            fn friction_jumps(&self) -> &'static [[usize; 2]] {
                &$($module)::+::FRICTION_JUMPS
            }

            fn drives(&self) -> usize {
                #[allow(unused_imports, reason = "only modules whose inputs all are drives need it")]
                use $crate::dynamics::ALL_DRIVES as DRIVES;
                {
                    $crate::dynamics!(@import [$($module)::+]);
                    if DRIVES < $($module)::+::M { DRIVES } else { $($module)::+::M }
                }
            }

            $crate::dynamics!(@required mass_matrix, [$($module)::+], $p, (y: NY), matrix);
            $crate::dynamics!(@required coriolis_forces, [$($module)::+], $p, (y: NY, v: N), vector);
            $crate::dynamics!(@required gravity_forces, [$($module)::+], $p, (y: NY), vector);
            $crate::dynamics!(@required spring_forces, [$($module)::+], $p, (y: NY, v: N), vector);
            $crate::dynamics!(@input_matrix [$($module)::+], $p);
            $crate::dynamics!(@friction [$($module)::+], $p);
            $crate::dynamics!(@provided load_friction, [$($module)::+], $p, (y: NY, v: N), vector);
            $crate::dynamics!(@provided applied_forces, [$($module)::+], $p, (y: NY, v: N), vector);
            $crate::dynamics!(@provided bias_forces, [$($module)::+], $p, (y: NY, v: N), vector);
            $crate::dynamics!(@provided equations_of_motion, [$($module)::+], $p, (y: NY, v: N), equations);
            $crate::dynamics!(@provided inverse_dynamics, [$($module)::+], $p, (y: NY, v: N, a: N), vector);
            $crate::dynamics!(@provided forward_dynamics, [$($module)::+], $p, (y: NY, v: N, u: M), vector);
            $crate::dynamics!(@provided kinetic_energy, [$($module)::+], $p, (y: NY, v: N), scalar);
        }
        impl $crate::dynamics::PhaseSpace<{ 2 * $($module)::+::N }> for $name {}
        impl $crate::dynamics::LimitRows<{
            $crate::dynamics::count_rows($crate::dependent_joints_of!([$($module)::+]))
                + $crate::torque_speed_lines_of!([$($module)::+]).len()
        }> for $name {}
    };
    (@differentiable $name:ident, [$($module:ident)::+], $p:tt) => {
        impl $crate::dynamics::Differentiable<
            { $($module)::+::N },
            { $($module)::+::M },
            { $crate::dynamics!(@positions [$($module)::+]) },
        > for $name
        where
            $crate::dynamics!(@has_derivatives [$($module)::+]): for<'a> $crate::dynamics::Yes<'a>,
        {
            $crate::dynamics!(
                @made inverse_dynamics_derivatives, [$($module)::+], $p, (y: NY, v: N, a: N),
                ForceDerivatives<N>
            );
            $crate::dynamics!(
                @made inverse_dynamics_derivatives_and_mass_matrix, [$($module)::+], $p, (y: NY, v: N, a: N),
                ForceDerivativesAndMass<N>, by_default
            );
            $crate::dynamics!(
                @provided input_forces_derivatives, [$($module)::+], $p, (y: NY, u: M), forces_by_coordinates
            );
            $crate::dynamics!(
                @made linearize, [$($module)::+], $p, (y: NY, v: N, u: M),
                Linearization<N, M, NY>
            );
            $crate::dynamics!(@linearize_along [$($module)::+], $p);
        }
    };
    // The default methods of the trait, which use the derivatives of the module.
    (@discretizable $name:ident, [$($module:ident)::+], $p:tt, [[]]) => {
        impl $crate::dynamics::Discretizable<
            { $($module)::+::N },
            { $($module)::+::M },
            { $crate::dynamics!(@positions [$($module)::+]) },
        > for $name
        where
            $crate::dynamics!(@has_derivatives [$($module)::+]): for<'a> $crate::dynamics::Yes<'a>,
        {
        }
    };
    (@discretizable $name:ident, [$($module:ident)::+], $p:tt, []) => {
        impl $crate::dynamics::Discretizable<
            { $($module)::+::N },
            { $($module)::+::M },
            { $crate::dynamics!(@positions [$($module)::+]) },
        > for $name
        where
            $crate::dynamics!(@has_derivatives [$($module)::+]): for<'a> $crate::dynamics::Yes<'a>,
        {
            const SUBSTEPS: usize = {
                #[allow(unused_imports, reason = "only modules without steps need it")]
                use $crate::dynamics::NO_SUBSTEPS as SUBSTEPS;
                {
                    $crate::dynamics!(@import [$($module)::+]);
                    SUBSTEPS
                }
            };
            $crate::dynamics!(
                @made discretize, [$($module)::+], $p, (y: NY, v: N, u: M, period: T),
                Discretization<N, M, NY>, by_default
            );
            $crate::dynamics!(@provided step, [$($module)::+], $p, (y: NY, v: N, u: M, period: T), state);
            $crate::dynamics!(
                @made step_derivatives, [$($module)::+], $p, (y: NY, v: N, u: M, period: T),
                Step<N, M, NY>, by_default
            );
        }
    };
    (@has_derivatives [$($module:ident)::+]) => {
        $crate::dynamics::HasDerivatives<{
            $crate::dynamics::has(&$($module)::+::FUNCTIONS, "inverse_dynamics_derivatives")
                && $crate::dynamics::has(&$($module)::+::FUNCTIONS, "linearize")
        }>
    };

    // The number of positions. Modules without quaternions do not have this constant.
    (@positions [$($module:ident)::+]) => {{
        #[allow(unused_imports, reason = "only modules without quaternions need it")]
        use $crate::dynamics::NO_POSITIONS as NY;
        {
            $crate::dynamics!(@import [$($module)::+]);
            $crate::dynamics::positions_of(NY, $($module)::+::N)
        }
    }};
    // The number of positions of each joint. Modules without quaternions do not have this constant.
    (@widths [$($module:ident)::+]) => {{
        #[allow(unused_imports, reason = "only modules without quaternions need it")]
        use $crate::dynamics::NO_WIDTHS as JOINT_POSITIONS;
        {
            $crate::dynamics!(@import [$($module)::+]);
            &JOINT_POSITIONS
        }
    }};
    (@joint_names [$($module:ident)::+]) => { $($module)::+::JOINT_NAMES };
    (@position_names [$($module:ident)::+]) => {{
        #[allow(unused_imports, reason = "only modules without quaternions need it")]
        use $($module)::+::JOINT_NAMES as POSITION_NAMES;
        {
            $crate::dynamics!(@import [$($module)::+]);
            POSITION_NAMES
        }
    }};

    // The ranges of the inputs: symmetric ranges from the magnitudes, or `INPUT_RANGES`.
    (@ranges [$($module:ident)::+], $magnitudes:ident) => {{
        #[allow(unused_imports, reason = "only modules whose inputs all are drives need it")]
        use $crate::dynamics::Missing as INPUT_RANGES;
        {
            $crate::dynamics!(@import [$($module)::+]);
            $crate::dynamics::InputRanges::within(&INPUT_RANGES, $($module)::+::$magnitudes)
        }
    }};
    // The function of a module has the argument y only if inputs act at frames.
    (@input_matrix [$($module:ident)::+], [$($p:ident),*]) => {
        #[inline]
        fn input_matrix(
            &self,
            y: $crate::dynamics!(@argument NY, [$($module)::+]),
        ) -> $crate::dynamics!(@type input_matrix, [$($module)::+]) {
            #[allow(unused_imports, reason = "only modules without this function need it")]
            use $crate::dynamics::Missing as input_matrix;
            {
                $crate::dynamics!(@import [$($module)::+]);
                $crate::dynamics!(@matrix input_matrix, y $(, &self.$p)*)
            }
        }
    };
    (@matrix $function:ident, $y:ident) => { $crate::dynamics::InputMatrix::at(&$function, $y) };
    (@matrix $function:ident, $y:ident, $p:expr) => {
        $crate::dynamics::InputMatrixWithParameters::at(&$function, $y, $p)
    };
    (@matrix $function:ident, $y:ident, $d:expr, $p:expr) => {
        $crate::dynamics::InputMatrixWithDriven::at(&$function, $y, $d, $p)
    };

    // The function of a module has the argument y only if a friction law depends on y.
    (@friction [$($module:ident)::+], [$($p:ident),*]) => {
        #[inline]
        fn friction_torques(
            &self,
            y: $crate::dynamics!(@argument NY, [$($module)::+]),
            v: &[f64; $($module)::+::N],
        ) -> [f64; $($module)::+::N] {
            #[allow(unused_imports, reason = "only modules without this function need it")]
            use $crate::dynamics::Missing as friction_torques;
            {
                $crate::dynamics!(@import [$($module)::+]);
                $crate::dynamics!(@torques friction_torques, y, v $(, &self.$p)*)
            }
        }
    };
    (@torques $function:ident, $y:ident, $v:ident) => { $crate::dynamics::FrictionLaw::torques(&$function, $y, $v) };
    (@torques $function:ident, $y:ident, $v:ident, $p:expr) => {
        $crate::dynamics::FrictionLawWithParameters::torques(&$function, $y, $v, $p)
    };
    (@torques $function:ident, $y:ident, $v:ident, $d:expr, $p:expr) => {
        $crate::dynamics::FrictionLawWithDriven::torques(&$function, $y, $v, $d, $p)
    };

    // A function that the module must have.
    (@required $function:ident, $module:tt, [$($p:ident),*], ($($argument:ident: $len:ident),*), $result:ident) => {
        #[inline]
        fn $function(&self, $($argument: $crate::dynamics!(@argument $len, $module)),*) -> $crate::dynamics!(@type $result, $module) {
            #[allow(unused_imports, reason = "only modules without this function need it")]
            use $crate::dynamics::Missing as $function;
            {
                $crate::dynamics!(@import $module);
                $crate::dynamics::Required::result(&$function, ($($argument,)* $(&self.$p,)*))
            }
        }
    };
    // The function of the module, or the default method of the trait.
    (@provided $function:ident, $module:tt, [$($p:ident),*], ($($argument:ident: $len:ident),*), $result:ident) => {
        #[inline]
        fn $function(&self, $($argument: $crate::dynamics!(@argument $len, $module)),*) -> $crate::dynamics!(@type $result, $module) {
            #[allow(unused_imports, reason = "only modules without this function need it")]
            use $crate::dynamics::Missing as $function;
            {
                $crate::dynamics!(@import $module);
                $crate::dynamics::OrElse::or_else(
                    &$function,
                    ($($argument,)* $(&self.$p,)*),
                    || $crate::dynamics::defaults::$function(self, $($argument),*),
                )
            }
        }
    };
    // Like `@provided`, but the result is converted to a type of the runtime.
    (
        @made $function:ident, $module:tt, [$($p:ident),*], ($($argument:ident: $len:ident),*),
        $made:ident<$($size:ident),*> $(, $by_default:ident)?
    ) => {
        #[inline]
        fn $function(&self, $($argument: $crate::dynamics!(@argument $len, $module)),*) -> $crate::dynamics!(@made $made<$($size),*>, $module) {
            #[allow(unused_imports, reason = "only modules without this function need it")]
            use $crate::dynamics::Missing as $function;
            {
                $crate::dynamics!(@import $module);
                $crate::dynamics::MadeOrElse::made_or_else(
                    &$function,
                    ($($argument,)* $(&self.$p,)*),
                    || $crate::dynamics!(@otherwise $function, (self, $($argument),*) $(, $by_default)?),
                )
            }
        }
    };
    // Equations with driven joints depend on the time, so the default method is used.
    (@linearize_along $module:tt, [driven $(, $parameters:ident)?]) => {};
    (@linearize_along [$($module:ident)::+], [$($p:ident)?]) => {
        fn linearize_along(
            &self,
            instructions: $crate::dynamics::Instructions,
            points: &[$crate::dynamics!(@made Point<N, M, NY>, [$($module)::+])],
            results: &mut [$crate::dynamics!(@made Linearization<N, M, NY>, [$($module)::+])],
        ) {
            #[allow(unused_imports, reason = "only modules without lanes need it")]
            use $crate::dynamics::{Missing as LINEARIZE_LANES, NoLanes as Lanes};
            {
                $crate::dynamics!(@import [$($module)::+]);
                $crate::dynamics::linearize_along(self, points, results, |points, results| {
                    $crate::dynamics::LinearizeLanes::linearize(
                        &LINEARIZE_LANES, instructions, ($(&self.$p,)?), Lanes, |lanes| &lanes.0, points, results,
                    )
                });
            }
        }
    };
    (@made $made:ident<N>, [$($module:ident)::+]) => { $crate::dynamics::$made<{ $($module)::+::N }> };
    (@made $made:ident<N, M, NY>, [$($module:ident)::+]) => {
        $crate::dynamics::$made<
            { $($module)::+::N },
            { $($module)::+::M },
            { $crate::dynamics!(@positions [$($module)::+]) },
        >
    };
    (@otherwise $function:ident, $arguments:tt, by_default) => { $crate::dynamics::defaults::$function $arguments };
    (@otherwise $function:ident, $arguments:tt) => {
        unreachable!("the trait is implemented where the module has the function")
    };
    (@import [$($module:ident)::+]) => {
        #[allow(unused_imports, clippy::wildcard_imports, reason = "whatever the module has")]
        use $($module)::+::*;
    };

    (@argument T, $module:tt) => { f64 };
    (@argument $len:ident, $module:tt) => { &$crate::dynamics!(@type $len, $module) };
    (@type scalar, [$($module:ident)::+]) => { f64 };
    (@type N, [$($module:ident)::+]) => { [f64; $($module)::+::N] };
    (@type NY, [$($module:ident)::+]) => { [f64; { $crate::dynamics!(@positions [$($module)::+]) }] };
    (@type M, [$($module:ident)::+]) => { [f64; $($module)::+::M] };
    (@type vector, $module:tt) => { $crate::dynamics!(@type N, $module) };
    (@type state, $module:tt) => { ($crate::dynamics!(@type NY, $module), $crate::dynamics!(@type N, $module)) };
    (@type matrix, [$($module:ident)::+]) => { [[f64; $($module)::+::N]; $($module)::+::N] };
    (@type input_matrix, [$($module:ident)::+]) => { [[f64; $($module)::+::M]; $($module)::+::N] };
    (@type forces_by_coordinates, $module:tt) => {
        ($crate::dynamics!(@type vector, $module), $crate::dynamics!(@type matrix, $module))
    };
    (@type equations, $module:tt) => {
        (
            $crate::dynamics!(@type matrix, $module),
            $crate::dynamics!(@type vector, $module),
            $crate::dynamics!(@type vector, $module),
        )
    };
}
