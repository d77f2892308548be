//! Methods that predictive controllers delegate to their `horizon`.

/// The methods of the controllers themselves.
macro_rules! delegated_methods {
    () => {
        /// The model.
        pub fn model(&self) -> &D {
            self.horizon.model()
        }

        /// Notes from the construction of the controller, for example a trajectory beyond the soft limits or
        /// a row, or terminal weights with few accurate digits. Read them before the robot moves. Empty if
        /// there are no notes.
        pub fn notes(&self) -> &[$crate::mpc::MpcNote] {
            &self.horizon.notes
        }

        /// The observer with its estimates.
        pub fn observer(&self) -> &$crate::mpc::DisturbanceObserver<N, M, NY> {
            &self.horizon.observer
        }
    };
}
pub(super) use delegated_methods;

/// The methods of [`Controller`](crate::control_loop::Controller).
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
