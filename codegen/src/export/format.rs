//! Formats of other programs, and an exported file.

use crate::diagnostic::Diagnostics;

/// A file format for robots.
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

    /// File extension of the format.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Urdf => "urdf",
        }
    }
}

/// An exported file.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Text of the file.
    pub text: String,
    /// Notes and warnings about parts of the robot that the format cannot represent.
    pub notes: Diagnostics,
}
