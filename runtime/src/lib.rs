//! Control of robots whose equations of motion `gelenk` has generated.
//!
//! A generated module consists of functions on arrays: M, k, q, B of the equations of motion
//! `M ÿ + k = q + B u`, and their derivatives. The macro [`dynamics!`] wraps the module as a type. The
//! functions here are generic over the traits of this type.
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
//! // 2. What it shall do [rad, s].
//! let start = [0.1, 0.0];
//! let motion = RestToRest::new(start, [0.4, -0.2], 1.5)?;
//!
//! // 3. How: 100 times a second, with gains from the mass matrix and limits from the description.
//! let settings = LoopSettings::for_robot(100.0, &PowerCube);
//! let law = JointPd::new(PowerCube, JointGains::from_bandwidth(&PowerCube, &start, 12.0, 0.8))?;
//! let controller = FeedForwardPd::new(law.clone(), motion, 0.01, 0.01)?;
//!
//! // 4. On what: a simulated robot with encoders of 0.1 mrad. A real one is another `Transport`.
//! let options = PlantOptions { encoder_resolution: [1e-4; 2], ..PlantOptions::default() };
//! let mut plant = Plant::new(PowerCube, options)?;
//! plant.reset(start, [0.0; 2])?;
//! let clock = VirtualClock::new();
//! let robot = InProcess::new(plant, clock.clone(), settings.period());
//!
//! // 5. The loop, with the same law to fall back on.
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
//!  trajectory, kinematics   what is wanted                     identification   log → friction, masses → description
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
//!    while the robot moves. [`kinematics`]: joint angles for poses of six-axis arms with a spherical wrist.
//!    [`limits`]: check whether a motion keeps a model's limits. [`driven`]: robots with driven joints, whose
//!    motion is prescribed.
//! 3. [`feed_forward`]: the inputs with which the model follows a trajectory.
//! 4. [`plant`]: a simulated robot with dry friction, brakes, encoders, delays and losses, for tests of
//!    controllers.
//! 5. [`control_loop`]: the loop at a fixed rate with its limits, guards, log and report, and joint PD and
//!    computed torque. Its guide is [how to write a controller](control_loop::write_a_controller).
//! 6. [`transport`]: connections that read positions from a robot and write its inputs, in process, over UDP
//!    or over CAN. Its guide is [how to attach hardware](transport::attaching_hardware).
//! 7. [`mpc`]: linear time-varying and nonlinear predictive control with a disturbance observer, and a guide
//!    to [its tuning](mpc::tune). It uses [`qp`], an interior-point solver without allocation, [`lqr`], and
//!    [`lanes`], computations for many states at once.
//! 8. The crate `gelenk-identification`: identification of friction and inertial parameters from a log, and a
//!    description with the results that `gelenk generate` reads.
//! 9. The crate `gelenk-report`: pages of results, which load nothing from a network.
//!
//! The guide [from a URDF to a moving robot](from_urdf) uses most of these modules in order. The examples in
//! `runtime/examples` are complete programs. A page in this folder lists them.
//!
//! # Conventions
//!
//! All quantities are in SI units. `y`, `v`, `a`, `u` are coordinates, velocities, accelerations and inputs
//! in the order of `JOINT_NAMES` and `INPUT_NAMES` of the module. Matrices have their rows first. For robots
//! with spherical or floating joints, `y` has NY position entries in the order of `POSITION_NAMES`, and `v`
//! and `a` have N entries in the order of `VELOCITY_NAMES`. The entries of joint j begin at
//! `FIRST_POSITIONS[j]` and `FIRST_VELOCITIES[j]`.
//!
//! A function that can fail returns an error with the place, the fault and the allowed range. Errors name
//! joints as the description does. Fields called `joint` or `input` are indices from 0. Functions that run in
//! a loop neither allocate nor panic.
//!
//! # Features
//!
//! The feature `socketcan` adds the transport over a CAN bus (Linux). The feature `online-targets` adds
//! targets that change while the robot moves.
//!
//! Without the feature `std`, which is on by default, the crate only needs an allocator and compiles for
//! microcontrollers. It then has [`feed_forward`] (with friction compensation if the model has friction),
//! [`lqr`], [`qp`], the laws of [`control_loop`] ([`JointPd`](control_loop::JointPd),
//! [`ComputedTorque`](control_loop::ComputedTorque), [`LawController`](control_loop::LawController)), and
//! [`trajectory`] except for recordings, poses and online targets. Numbers are f64 there too. Generated
//! modules in f32 are used without this crate.

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
