//! Arguments of the equations.

use crate::graph::Scalar;
use crate::spatial::Force;

/// Scalars of the arguments of a function; unused arguments are empty. In y, v and a, entries of driven
/// coordinates are last.
pub struct Arguments<'g> {
    /// y
    pub y: Vec<Scalar<'g>>,
    /// ẏ
    pub v: Vec<Scalar<'g>>,
    /// ÿ
    pub a: Vec<Scalar<'g>>,
    /// u
    pub u: Vec<Scalar<'g>>,
    /// λ
    pub lambda: Vec<Scalar<'g>>,
    /// Accelerations of the driven coordinates.
    pub driven: Vec<Scalar<'g>>,
    /// Wrenches w, each about the origin of its frame.
    pub w: Vec<Force<'g>>,
}
