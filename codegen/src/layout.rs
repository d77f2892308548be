//! Meaning and number of the entries of function arguments and results. Lengths of arrays have names in
//! generated code.

/// Meaning of the entries of an array. It determines the name of the array's length in every language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Coordinates y of a robot without quaternions, one for each independent joint.
    Coordinates,
    /// Position entries y of a robot with quaternions. A quaternion has four position entries, but three
    /// velocities.
    Positions,
    /// One entry for each joint of a robot with quaternions.
    Joints,
    /// Velocities ẏ, and quantities with one entry for each velocity: accelerations, forces, and derivatives
    /// with respect to small motions.
    Velocities,
    /// Inputs u: motor torques, motor currents, or forces at frames.
    Inputs,
    /// Parameters of a regressor (the dynamics as a matrix times these parameters), one for each column.
    Parameters,
    /// Wrenches. Each has six entries: force, then moment.
    Wrenches,
    /// Driven coordinates (joints with a prescribed motion). Each has three entries: position, velocity and
    /// acceleration.
    Driven,
    /// A length that is the same for every robot, for example 3 for the axes of space.
    Fixed,
}

impl Dimension {
    /// Name of the module constant with this length, for example `N`; `None` if the length does not depend on
    /// the robot, or is the number of parameters of a regressor. Without quaternions, coordinates and velocities
    /// share a constant.
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

/// Length of an array, and the meaning of its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Meaning of the array's entries.
    pub dimension: Dimension,
    /// Number of entries of the array.
    pub len: usize,
}

impl Extent {
    /// Creates an extent (length and meaning of an array) with `len` entries of this meaning.
    #[must_use]
    pub const fn new(dimension: Dimension, len: usize) -> Self {
        Self { dimension, len }
    }

    /// Length of a row: 6 for wrenches, 3 for driven coordinates (position, velocity and acceleration);
    /// `None` for other arrays, which have no rows.
    #[must_use]
    pub const fn row(&self) -> Option<usize> {
        match self.dimension {
            Dimension::Wrenches => Some(6),
            Dimension::Driven => Some(3),
            _ => None,
        }
    }

    /// Creates an extent (length and meaning of an array) whose length is the same for all robots.
    #[must_use]
    pub const fn fixed(len: usize) -> Self {
        Self::new(Dimension::Fixed, len)
    }
}
