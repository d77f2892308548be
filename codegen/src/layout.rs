//! Lengths with names: meanings of the entries of an array.

/// The meaning of an array's entries, which gives its length a name in every language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Coordinates y.
    Coordinates,
    /// Entries of the positions y of a robot with quaternions, which has more of them than velocities.
    Positions,
    /// Joints of such a robot.
    Joints,
    /// Velocities ẏ, and quantities with one entry per velocity: accelerations, forces, derivatives by small motions.
    Velocities,
    /// Inputs u.
    Inputs,
    /// Parameters of a regressor.
    Parameters,
    /// Wrenches, six entries each: force, then moment.
    Wrenches,
    /// Driven coordinates, three entries each: position, velocity, acceleration.
    Driven,
    /// A number that does not depend on the robot, e.g. of axes in space.
    Fixed,
}

impl Dimension {
    /// The constant of a module that has the length, where it follows from the robot. Coordinates and velocities are as
    /// many without quaternions.
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

/// A length: number of entries, and their meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// The meaning of the entries.
    pub dimension: Dimension,
    /// How many there are.
    pub len: usize,
}

impl Extent {
    /// An extent of this number of entries.
    #[must_use]
    pub const fn new(dimension: Dimension, len: usize) -> Self {
        Self { dimension, len }
    }

    /// The length of its rows, where its entries come in rows.
    #[must_use]
    pub const fn row(&self) -> Option<usize> {
        match self.dimension {
            Dimension::Wrenches => Some(6),
            Dimension::Driven => Some(3),
            _ => None,
        }
    }

    /// A length without a name.
    #[must_use]
    pub const fn fixed(len: usize) -> Self {
        Self::new(Dimension::Fixed, len)
    }
}
