//! File formats of other programs, and a robot exported to one of them.

use crate::diagnostic::Diagnostics;

/// A file format of another program for robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// MJCF, the format of MuJoCo.
    Mjcf,
    /// URDF, the format of ROS.
    Urdf,
}

impl Format {
    /// Name of the format, for example `URDF`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "MJCF",
            Self::Urdf => "URDF",
        }
    }

    /// File extension of the format, without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Urdf => "urdf",
        }
    }
}

/// A robot exported to another format.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Text of the exported file.
    pub text: String,
    /// Notes and warnings about parts of the robot that the format cannot represent.
    pub notes: Diagnostics,
}
