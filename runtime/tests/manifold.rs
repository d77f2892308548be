//! Robots whose positions are not velocities, by a quadrotor and a robot of several joints that are written by hand.

#![allow(clippy::unwrap_used, reason = "test code: a problem that cannot be set up ends the test")]

mod control_loop;
mod dynamics;
mod geodesic;
mod limits;
mod lqr;
#[path = "manifold/mixed.rs"]
mod mixed_robot;
mod mpc;
mod plant;
mod transport;

use crate::support::{mixed, quadrotor};

gelenk_runtime::dynamics!(struct Quadrotor = quadrotor: Differentiable + Discretizable);
gelenk_runtime::dynamics!(struct Mixed = mixed: Differentiable + Discretizable);
