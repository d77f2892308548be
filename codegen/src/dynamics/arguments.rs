//! Arguments of the equations of motion, as scalars of the expression graph.

use crate::graph::Scalar;
use crate::spatial::Force;

/// Arguments of a generated function. Arguments that the function does not have are empty. The last entries
/// of y, v and a belong to driven coordinates, whose motion is prescribed.
pub struct Arguments<'g> {
    /// Positions y of the coordinates.
    pub y: Vec<Scalar<'g>>,
    /// Velocities ẏ of the coordinates.
    pub v: Vec<Scalar<'g>>,
    /// Accelerations ÿ of the coordinates.
    pub a: Vec<Scalar<'g>>,
    /// Inputs u: motor torques, motor currents, or forces at frames.
    pub u: Vec<Scalar<'g>>,
    /// Multipliers λ, one for each generalized force, for the Hessian of `λᵀ (M ÿ + k − q)`. M is the mass
    /// matrix, k are the Coriolis forces, and q are the applied forces.
    pub lambda: Vec<Scalar<'g>>,
    /// Prescribed accelerations of the driven coordinates.
    pub driven: Vec<Scalar<'g>>,
    /// Wrenches w at frames. The moment of a wrench is about the origin of the wrench's frame.
    pub w: Vec<Force<'g>>,
}
