//! Connections to robots: in the same process, over UDP, over a CAN bus, or by another implementation of [`Transport`].
//! Read [`attaching_hardware`] before a real robot moves.

#[doc = include_str!("attaching_hardware.md")]
pub mod attaching_hardware {}
pub mod can_frame;
mod connection;
pub mod datagram;
mod in_process;
mod plant_server;
#[cfg(all(feature = "socketcan", target_os = "linux"))]
mod socketcan;
mod udp;

use connection::require_finite;
pub use connection::{Brakes, Reading, Transport, TransportError};
pub use in_process::InProcess;
pub use plant_server::{Pace, PlantServer, ServerError, ServerOptions};
#[cfg(all(feature = "socketcan", target_os = "linux"))]
pub use socketcan::CanTransport;
pub use udp::UdpTransport;
