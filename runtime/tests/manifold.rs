//! Robots whose positions are not velocities, by a quadrotor and a robot of several joints that are written by hand.

#![allow(clippy::unwrap_used, reason = "test code: a problem that cannot be set up ends the test")]

#[path = "manifold/control_loop.rs"]
mod control_loop;
#[path = "manifold/dynamics.rs"]
mod dynamics;
#[path = "manifold/geodesic.rs"]
mod geodesic;
#[path = "manifold/limits.rs"]
mod limits;
#[path = "manifold/lqr.rs"]
mod lqr;
#[path = "support/mixed.rs"]
#[allow(dead_code, reason = "it has the face of a generated module")]
mod mixed;
#[path = "manifold/mixed.rs"]
mod mixed_robot;
#[path = "manifold/mpc.rs"]
mod mpc;
#[path = "manifold/plant.rs"]
mod plant;
#[path = "support/quadrotor.rs"]
#[allow(dead_code, reason = "it has the face of a generated module")]
mod quadrotor;
#[path = "manifold/transport.rs"]
mod transport;

gelenk_runtime::dynamics!(struct Quadrotor = quadrotor: Differentiable + Discretizable);
gelenk_runtime::dynamics!(struct Mixed = mixed: Differentiable + Discretizable);
