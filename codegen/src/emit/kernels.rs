//! Selects the elementary functions (kernels) whose texts a module includes.

use std::collections::BTreeSet;

use gelenk_kernels::math::Kernel;

use super::options::Scalar;
use crate::functions::function::Function;
use crate::program::Operation;

/// Returns the elementary function for the number type. `kernels` contains the function for f64, then the
/// function for f32.
pub(super) fn of_scalar(kernels: [Kernel; 2], scalar: Scalar) -> Kernel {
    match scalar {
        Scalar::F64 => kernels[0],
        Scalar::F32 => kernels[1],
    }
}

/// Elementary functions for sines and cosines of `lanes` = 2, 4 or 8 angles, for f64 and for f32.
pub(super) fn sin_cos_of(lanes: usize) -> [Kernel; 2] {
    match lanes {
        2 => [Kernel::SinCos2, Kernel::SinCos2F32],
        4 => [Kernel::SinCos4, Kernel::SinCos4F32],
        _ => [Kernel::SinCos8, Kernel::SinCos8F32],
    }
}

/// Whether a function contains a fused multiply-add.
pub(super) fn are_fused(functions: &[Function]) -> bool {
    let instructions = functions.iter().flat_map(|function| &function.program.instructions);
    instructions.into_iter().any(|instruction| matches!(instruction.operation, Operation::MultiplyAdd(..)))
}

/// The called elementary functions and all functions that they call, in the order of definition.
pub(super) fn needed(called: &BTreeSet<Kernel>) -> BTreeSet<Kernel> {
    let mut needed = BTreeSet::new();
    for &kernel in called {
        needed.extend(std::iter::successors(Some(kernel), |kernel| kernel.requires()));
    }
    needed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_needed_is_pasted_in_the_order_of_the_calls() {
        let names = |called: &[Kernel]| -> Vec<_> {
            let called = called.iter().copied().collect();
            needed(&called).iter().map(|kernel| kernel.name()).collect()
        };
        assert_eq!(names(&[Kernel::SinCos4]), ["sin_cos", "sin_cos_array", "sin_cos_4"]);
        assert_eq!(names(&[Kernel::TanhF32]), ["exp_reduced_f32", "tanh_f32"]);
        assert!(names(&[]).is_empty());
    }
}
