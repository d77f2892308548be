//! Formats of robots, and a file in one of them.

use crate::diagnostic::Diagnostics;

/// A format of robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// MJCF of MuJoCo.
    Mjcf,
    /// URDF of ROS.
    Urdf,
}

impl Format {
    /// Name of the format.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "MJCF",
            Self::Urdf => "URDF",
        }
    }

    /// File extension.
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
    /// Text of the file.
    pub text: String,
    /// Notes on parts that the format cannot represent.
    pub notes: Diagnostics,
}
