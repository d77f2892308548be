//! Tests of this package that may share the processors, as one program: it is linked once. Tests that keep real time
//! are in `loops.rs`.

#[path = "support/allocations.rs"]
mod allocations;
#[path = "../examples/powercube/methods/mod.rs"]
mod methods;
mod support;

#[path = "adaptation/main.rs"]
mod adaptation;
mod allocation;
mod computed_torque;
mod dependent_limits;
mod driven;
mod effort_limits;
mod example_errors;
mod extreme_numbers;
mod feed_forward;
mod frame_forces;
mod identification_bad_input;
mod identification_logs;
mod identification_powercube;
mod identification_schunk;
mod joint_lqr;
mod kinematics;
mod loop_allocation;
mod lqr;
mod manifold;
mod mechanisms;
mod midpoint;
mod mpc_allocation;
mod mpc_contract;
mod mpc_margins;
mod mpc_observer;
mod mpc_rows;
mod mpc_terminal;
mod mpc_tracking;
#[path = "mutations/main.rs"]
mod mutations;
mod online_target;
#[path = "plant/main.rs"]
mod plant;
mod plant_allocation;
mod power_balance;
mod qp_allocation;
mod qp_contract;
mod qp_oracle;
mod qp_random;
mod qp_rows;
mod qp_tied;
mod recording;
mod torque_speed;
mod trajectory;
mod via_points;
