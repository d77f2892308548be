//! Part of [`dynamics!`](crate::dynamics!) for positions and quaternions.

/// Implements the methods of [`Dynamics`](crate::dynamics::Dynamics) that operate on positions.
#[doc(hidden)]
#[macro_export]
macro_rules! dynamics_on_manifold {
    // The methods on positions call functions that are pasted as text into modules with quaternions.
    ($module:tt) => {
        fn position_names(&self) -> [&'static str; $crate::dynamics!(@positions $module)] {
            $crate::dynamics!(@position_names $module)
        }

        fn quaternion_joints(&self) -> &'static [$crate::dynamics::QuaternionJoint] {
            const WIDTHS: &[usize] = $crate::dynamics!(@widths $module);
            const COUNT: usize = $crate::dynamics::count_quaternions(WIDTHS);
            const JOINTS: [$crate::dynamics::QuaternionJoint; COUNT] =
                $crate::dynamics::quaternion_joints(&$crate::dynamics!(@joint_names $module), WIDTHS);
            &JOINTS
        }

        #[inline]
        fn neutral(&self) -> $crate::dynamics!(@type NY, $module) {
            $crate::dynamics::neutral($crate::dynamics!(@widths $module))
        }

        #[inline]
        fn integrate(
            &self,
            y: $crate::dynamics!(@argument NY, $module),
            d: $crate::dynamics!(@argument N, $module),
        ) -> $crate::dynamics!(@type NY, $module) {
            $crate::dynamics::integrate($crate::dynamics!(@widths $module), y, d)
        }

        #[inline]
        fn difference(
            &self,
            from: $crate::dynamics!(@argument NY, $module),
            to: $crate::dynamics!(@argument NY, $module),
        ) -> $crate::dynamics!(@type N, $module) {
            $crate::dynamics::difference($crate::dynamics!(@widths $module), from, to)
        }

        #[inline]
        fn integrate_derivatives(
            &self,
            _: $crate::dynamics!(@argument NY, $module),
            d: $crate::dynamics!(@argument N, $module),
        ) -> ($crate::dynamics!(@type matrix, $module), $crate::dynamics!(@type matrix, $module)) {
            $crate::dynamics::integrate_derivatives($crate::dynamics!(@widths $module), d)
        }

        #[inline]
        fn difference_derivatives(
            &self,
            d: $crate::dynamics!(@argument N, $module),
        ) -> ($crate::dynamics!(@type matrix, $module), $crate::dynamics!(@type matrix, $module)) {
            $crate::dynamics::difference_derivatives($crate::dynamics!(@widths $module), d)
        }

        #[inline]
        fn bracket(
            &self,
            a: $crate::dynamics!(@argument N, $module),
            b: $crate::dynamics!(@argument N, $module),
        ) -> $crate::dynamics!(@type N, $module) {
            $crate::dynamics::bracket($crate::dynamics!(@widths $module), a, b)
        }

        #[inline]
        fn normalize(&self, y: &mut $crate::dynamics!(@type NY, $module)) -> bool {
            $crate::dynamics::normalize($crate::dynamics!(@widths $module), y)
        }
    };
}
