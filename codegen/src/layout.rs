//! Meanings of array entries, and the names of array lengths in generated code.

/// Meaning of the entries of an array. It determines the name of the array's length in generated code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Coordinates y.
    Coordinates,
    /// Positions of a robot with quaternions. There are more positions than velocities.
    Positions,
    /// One entry for each joint of a robot with quaternions.
    Joints,
    /// Velocities ẏ, and quantities with one entry per velocity: accelerations, forces, derivatives by small motions.
    Velocities,
    /// Inputs u.
    Inputs,
    /// Parameters of a regressor, one for each column.
    Parameters,
    /// Wrenches. Each wrench has six entries: force [N], then moment [N m].
    Wrenches,
    /// Coordinates of driven joints. Each coordinate has three entries: position, velocity, acceleration.
    Driven,
    /// A fixed length for all robots, for example the three axes of space.
    Fixed,
}

impl Dimension {
    /// Name of the module constant with this length; `None` if the length does not depend on the robot.
    /// Coordinates and velocities have the same constant `N`.
    #[must_use]
    pub const fn length(self) -> Option<&'static str> {
        match self {
            Self::Coordinates | Self::Velocities => Some("N"),
            Self::Positions => Some("NY"),
            Self::Joints => Some("JOINTS"),
            Self::Inputs => Some("M"),
            Self::Wrenches => Some("WRENCHES"),
            Self::Driven => Some("DRIVEN"),
            Self::Parameters | Self::Fixed => None,
        }
    }
}

/// Length of an array, with the meaning of the entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Meaning of the entries.
    pub dimension: Dimension,
    /// Number of entries.
    pub len: usize,
}

impl Extent {
    /// An extent with this number of entries.
    #[must_use]
    pub const fn new(dimension: Dimension, len: usize) -> Self {
        Self { dimension, len }
    }

    /// Length of a row for arrays of wrenches (6) or driven coordinates (3); `None` for other arrays.
    #[must_use]
    pub const fn row(&self) -> Option<usize> {
        match self.dimension {
            Dimension::Wrenches => Some(6),
            Dimension::Driven => Some(3),
            _ => None,
        }
    }

    /// An extent with a fixed length for all robots.
    #[must_use]
    pub const fn fixed(len: usize) -> Self {
        Self::new(Dimension::Fixed, len)
    }
}
