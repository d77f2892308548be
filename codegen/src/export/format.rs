//! The formats of robots, and a file in one of them.

use crate::diagnostic::Diagnostics;

/// A format of robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// MuJoCo's.
    Mjcf,
    /// That of ROS.
    Urdf,
}

impl Format {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "MJCF",
            Self::Urdf => "URDF",
        }
    }

    /// How the names of its files end.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Urdf => "urdf",
        }
    }
}

/// A file in another format.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Its text.
    pub text: String,
    /// Losses of the format, as notes.
    pub notes: Diagnostics,
}
