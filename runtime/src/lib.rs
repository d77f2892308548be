//! Control of robots with equations of motion that `gelenk` has generated.
//!
//! The equations of motion of the coordinates y with the inputs u are `M ÿ + k = q + B u`. A generated module has
//! functions for M, k, q, B and their derivatives. The macro [`dynamics!`] wraps the module as a type with traits.
//! The functions of this crate are generic over these traits.
//!
//! # A first example
//!
//! An arm of two joints moves by feed-forward and joint PD, on a simulated robot:
//!
//! ```
//! use gelenk_runtime::control_loop::{
//!     ControlLoop, End, FeedForwardPd, JointGains, JointPd, LoopSettings, VirtualClock,
//! };
//! use gelenk_runtime::plant::{Plant, PlantOptions};
//! use gelenk_runtime::trajectory::RestToRest;
//! use gelenk_runtime::transport::InProcess;
//!
//! // 1. The robot: a generated module as a type. Yours comes from build.rs and `include_model!`.
//! gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
//!
//! // 2. The motion [rad, s].
//! let start = [0.1, 0.0];
//! let motion = RestToRest::new(start, [0.4, -0.2], 1.5)?;
//!
//! // 3. Rate, limits and controller: 100 Hz, limits from the description, gains from the mass matrix.
//! let settings = LoopSettings::for_robot(100.0, &PowerCube);
//! let law = JointPd::new(PowerCube, JointGains::from_bandwidth(&PowerCube, &start, 12.0, 0.8))?;
//! let controller = FeedForwardPd::new(law.clone(), motion, 0.01, 0.01)?;
//!
//! // 4. A simulated robot with encoders of 0.1 mrad. A real robot is another `Transport`.
//! let options = PlantOptions { encoder_resolution: [1e-4; 2], ..PlantOptions::default() };
//! let mut plant = Plant::new(PowerCube, options)?;
//! plant.reset(start, [0.0; 2])?;
//! let clock = VirtualClock::new();
//! let robot = InProcess::new(plant, clock.clone(), settings.period());
//!
//! // 5. The loop, with the same law as fallback.
//! let mut control = ControlLoop::new(settings, law, motion, controller, robot, clock)?;
//! let report = control.run();
//! assert_eq!(report.end, End::Finished, "{report}");
//! let (positions, _) = control.transport().plant().state();
//! assert!((positions[0] - 0.4).abs() < 2e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules
//!
//! ```text
//!  trajectory, kinematics   desired motion                     identification   log → friction, masses → description
//!         │                                                           ▲
//!         ▼                                                           │ log
//!  feed_forward, lqr, mpc  →  control_loop  →  transport  →  plant or hardware
//!         │
//!         ▼
//!         qp
//! ```
//!
//! A reader who is new to the crate should read the modules in this order:
//!
//! 1. [`mod@dynamics`]: the traits [`Dynamics`](dynamics::Dynamics),
//!    [`Differentiable`](dynamics::Differentiable) and [`Discretizable`](dynamics::Discretizable), the macros
//!    [`dynamics!`] and [`include_model!`], and limits and names of joints.
//! 2. [`trajectory`]: motions from rest to rest, through points with and without a stop, from recordings, for
//!    identification, and between poses of robots that fly or have spherical joints
//!    ([`GeodesicMotion`](trajectory::GeodesicMotion)). The feature `online-targets` adds targets that change
//!    while the robot moves. Related modules are [`kinematics`] (joint angles for poses of six-axis arms with a
//!    spherical wrist), [`limits`] (check of a motion against the limits of a model) and [`driven`] (robots with
//!    joints whose motion is prescribed).
//! 3. [`feed_forward`]: the inputs with which the model follows a trajectory.
//! 4. [`plant`]: a simulated robot with dry friction, brakes, encoders, delays and losses, for tests of
//!    controllers.
//! 5. [`control_loop`]: the loop at a fixed rate with limits, plausibility checks, log and report, and the control
//!    laws joint PD, computed torque and LQR. Its guide is
//!    [how to write a controller](control_loop::write_a_controller).
//! 6. [`transport`]: connections that read positions from a robot and write its inputs, in process, over UDP
//!    or over CAN. Its guide is [how to attach hardware](transport::attaching_hardware).
//! 7. [`mpc`]: linear time-varying and nonlinear predictive control with a disturbance observer, and a guide
//!    to [its tuning](mpc::tune). It uses [`qp`] (an interior-point solver for quadratic programs), [`lqr`] and
//!    [`lanes`] (computations for several states at once).
//! 8. The crate `gelenk-identification`: identification of friction and inertial parameters from a log. It writes
//!    the results as a description that `gelenk generate` reads.
//! 9. The crate `gelenk-report`: HTML pages of results, which load nothing from a network.
//!
//! The guide [from a URDF to a moving robot](from_urdf) uses most of these modules in order. The examples in
//! `runtime/examples` are complete programs. A page in this folder lists them.
//!
//! # Conventions
//!
//! All quantities are in SI units. `y`, `v` and `a` are coordinates, velocities and accelerations in the order of
//! `JOINT_NAMES` of the module. `u` are inputs in the order of `INPUT_NAMES`. Matrices are stored row by row. For
//! robots with spherical or floating joints, `y` has NY position entries in the order of `POSITION_NAMES`, and
//! `v` and `a` have N entries in the order of `VELOCITY_NAMES`. The entries of joint j begin at
//! `FIRST_POSITIONS[j]` and `FIRST_VELOCITIES[j]`.
//!
//! A function that can fail returns an error with the place, the fault and the allowed range. Errors name
//! joints as the description does. Fields called `joint` or `input` are indices from 0. Functions that run in
//! a loop neither allocate nor panic.
//!
//! # Features
//!
//! - `std` (default): all modules. Without this feature the crate only needs an allocator and compiles for
//!   microcontrollers, see below.
//! - `socketcan`: the transport over a CAN bus (Linux).
//! - `online-targets`: targets that change while the robot moves.
//!
//! Without `std`, the crate has [`feed_forward`] (with friction compensation if the model has friction), [`lqr`],
//! [`qp`], the laws of [`control_loop`] ([`JointPd`](control_loop::JointPd),
//! [`ComputedTorque`](control_loop::ComputedTorque), [`LawController`](control_loop::LawController)), and
//! [`trajectory`] except recordings, poses and online targets. All numbers are f64. Generated modules in f32 do
//! not work with this crate; call their functions directly.

#![cfg_attr(not(feature = "std"), no_std)]
#![cfg_attr(
    not(feature = "std"),
    allow(dead_code, unused_imports, reason = "the loop and the predictive controllers call it")
)]

#[cfg(not(feature = "std"))]
extern crate alloc;

pub use gelenk_dynamics::{dynamics, include_model};

pub mod adaptation;
#[cfg(feature = "std")]
mod clock;
pub mod control_loop;
pub mod driven;
pub mod feed_forward;
mod input_limits;
#[doc = include_str!("from_urdf.md")]
pub mod from_urdf {}
#[cfg(feature = "std")]
pub mod kinematics;
pub mod lanes;
pub mod limits;
pub mod lqr;
#[cfg(feature = "std")]
pub mod mpc;
#[cfg(not(feature = "std"))]
mod no_std;
#[cfg(feature = "std")]
pub mod plant;
pub mod qp;
pub mod trajectory;
#[cfg(feature = "std")]
pub mod transport;
