//! Parts of [`dynamics!`](crate::dynamics!) for joints that follow other joints, torque–speed lines and driven joints.

/// Returns the joints of a module that follow other joints. Most modules do not have the constants for them.
#[doc(hidden)]
#[macro_export]
macro_rules! dependent_joints_of {
    ([$($module:ident)::+]) => {{
        #[allow(unused_imports, reason = "only modules without joints that follow need it")]
        use $crate::dynamics::{
            NO_NAMES as DEPENDENT_JOINT_NAMES, NO_NUMBERS as DEPENDENT_JOINT_OFFSETS,
            NO_NUMBERS as DEPENDENT_VELOCITY_LIMITS, NO_RANGES as DEPENDENT_POSITION_LIMITS,
            NO_ROWS as DEPENDENT_DRIVEN_RATIOS, NO_ROWS as DEPENDENT_JOINT_RATIOS,
        };
        {
            $crate::dynamics!(@import [$($module)::+]);
            const JOINTS: [$crate::dynamics::DependentJoint<{ $($module)::+::N }>; DEPENDENT_JOINT_RATIOS.len()] =
                $crate::dynamics::dependent_joints(
                    &DEPENDENT_JOINT_NAMES,
                    [DEPENDENT_JOINT_RATIOS.as_flattened(), DEPENDENT_DRIVEN_RATIOS.as_flattened()],
                    &DEPENDENT_JOINT_OFFSETS,
                    &DEPENDENT_POSITION_LIMITS,
                    &DEPENDENT_VELOCITY_LIMITS,
                );
            &JOINTS
        }
    }};
}

/// Returns the torque–speed lines of the motors of a module. Most modules do not have the constants for them.
#[doc(hidden)]
#[macro_export]
macro_rules! torque_speed_lines_of {
    ([$($module:ident)::+]) => {{
        #[allow(unused_imports, reason = "only modules without such motors need it")]
        use $crate::dynamics::{NO_NUMBERS as TORQUE_SPEED_LIMITS, NO_ROWS as TORQUE_SPEED_SLOPES};
        {
            $crate::dynamics!(@import [$($module)::+]);
            const LINES: [$crate::dynamics::TorqueSpeedLine<{ $($module)::+::N }>;
                $crate::dynamics::count_lines(&TORQUE_SPEED_LIMITS)] = $crate::dynamics::torque_speed_lines(
                &$($module)::+::INPUT_NAMES,
                TORQUE_SPEED_SLOPES.as_flattened(),
                &TORQUE_SPEED_LIMITS,
            );
            &LINES
        }
    }};
}

/// Implements `driven_motion` for a type with the field `driven`.
#[doc(hidden)]
#[macro_export]
macro_rules! driven_motion_of {
    ([driven $(, $parameters:ident)?]) => {
        #[inline]
        fn driven_motion(&self) -> &[[f64; 3]] {
            &self.driven
        }
    };
    ($p:tt) => {};
}
