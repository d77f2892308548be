//! What the equations are written in.

use crate::graph::Scalar;
use crate::spatial::Vector3;

/// Scalars of the arguments of a function; those that it does not have are empty.
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
    /// w
    pub w: Vec<WrenchArgument<'g>>,
}

/// A wrench at the origin of its frame.
#[derive(Debug, Clone, Copy)]
pub struct WrenchArgument<'g> {
    /// Force (N).
    pub force: Vector3<Scalar<'g>>,
    /// Moment about the origin (N m).
    pub moment: Vector3<Scalar<'g>>,
}

impl<'g> WrenchArgument<'g> {
    /// Force, then moment.
    pub fn of(entries: &[Scalar<'g>]) -> Self {
        let part = |start: usize| Vector3(std::array::from_fn(|k| entries[start + k]));
        Self { force: part(0), moment: part(3) }
    }
}
