//! Loops in real time, as one program.

mod support;

mod connection;
mod loop_measured;
mod loop_mpc;
mod loop_survival;
mod loop_udp;
mod loop_warm_up;
