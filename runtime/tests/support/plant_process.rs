//! Starts the program `plant_process`, and ends it.
#![allow(clippy::expect_used, reason = "test code: a plant that does not start ends the test")]

use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A running plant process; killed when dropped.
pub struct PlantProcess {
    child: Child,
    pub address: SocketAddr,
}

impl PlantProcess {
    /// Starts the program and waits until it says where it listens.
    pub fn start(program: &Path, arguments: &[&str]) -> Self {
        let mut child = Command::new(program)
            .args(arguments)
            .env_remove("GELENK_EXAMPLE_SHORT")
            .stdout(Stdio::piped())
            .spawn()
            .expect("the plant process starts");
        let output = child.stdout.take().expect("its output is piped");
        let mut line = String::new();
        BufReader::new(output).read_line(&mut line).expect("its output can be read");
        let address = line
            .trim()
            .strip_prefix("listening on ")
            .and_then(|address| address.parse().ok())
            .unwrap_or_else(|| panic!("no address in {line:?}"));
        Self { child, address }
    }

    /// Ends it at once, without a chance to do anything, and waits until its socket is gone.
    pub fn kill(mut self) -> SocketAddr {
        self.end();
        self.address
    }

    fn end(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for PlantProcess {
    fn drop(&mut self) {
        self.end();
    }
}
