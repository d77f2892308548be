//! Methods that predictive controllers delegate to their `horizon`.

/// Defines methods that both predictive controllers have.
macro_rules! delegated_methods {
    () => {
        /// The model.
        pub fn model(&self) -> &D {
            self.horizon.model()
        }

        /// Notes from the construction of the controller, see [`MpcNote`](crate::mpc::MpcNote). For example, a note
        /// reports that the trajectory exceeds the soft limits. Print the notes before the robot moves.
        pub fn notes(&self) -> &[$crate::mpc::MpcNote] {
            &self.horizon.notes
        }

        /// The disturbance observer with its estimates.
        pub fn observer(&self) -> &$crate::mpc::DisturbanceObserver<N, M, NY> {
            &self.horizon.observer
        }
    };
}
pub(super) use delegated_methods;

/// Defines the methods of [`Controller`](crate::control_loop::Controller) that both predictive controllers share.
macro_rules! delegated_controller_methods {
    () => {
        fn planned(&self, periods: u32) -> Option<[f64; M]> {
            self.horizon.planned(periods)
        }

        fn estimate(&self) -> Option<$crate::control_loop::Estimate<N, NY>> {
            Some(self.horizon.estimate())
        }
    };
}
pub(super) use delegated_controller_methods;
