//! Loops in real time, as one program. The loop's tests run twice: with controllers that have the described friction, and with ones that
//! learn it.

#![allow(clippy::duplicate_mod, reason = "the same tests of other controllers")]

mod support;

mod connection;

#[path = "."]
mod described {
    use crate::support::robot::{Pd, made, pd};

    mod loop_measured;
    mod loop_mpc;
    mod loop_survival;
    mod loop_udp;
    mod loop_warm_up;
}

#[path = "."]
mod learning {
    use crate::support::learning::{Pd, assert_acts, made, pd};
    use crate::support::robot::{Watched, loop_with, settings};
    use gelenk_runtime::control_loop::End;

    mod loop_faults;
    mod loop_measured;
    mod loop_mpc;
    mod loop_survival;
    mod loop_udp;
    mod loop_warm_up;

    #[test]
    fn the_learned_law_acts_from_start_to_end() {
        for rate in [50.0, 1000.0] {
            let mut robot = Watched::at_start(rate);
            let mut control = loop_with(settings(rate), pd(rate), &mut robot);
            let report = control.run();
            assert_eq!(report.end, End::Finished, "{report}");
            assert_acts(control.controller().adaptation());
        }
    }
}
