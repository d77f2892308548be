//! Connections to robots: in process, over UDP, over a CAN bus, or with your own [`Transport`]. Read
//! [`attaching_hardware`] before an arm moves.

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
