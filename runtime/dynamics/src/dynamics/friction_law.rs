//! Traits for generated functions `friction_torques` with different arguments.
//!
//! A module has `friction_torques(v)`, or `friction_torques(y, v)` if a friction law depends on the position. The macro
//! [`dynamics!`](crate::dynamics!) cannot distinguish these functions. The compiler selects the implementation of a trait by the
//! type of the function.

/// A generated function `friction_torques`. The type `Arguments` distinguishes the implementations and is
/// inferred.
#[diagnostic::on_unimplemented(
    message = "the module has no `friction_torques` as a function of velocities, or of positions and velocities",
    label = "generate this module with the function friction_torques",
    note = "if the module has free parameters, write `dynamics!(struct Name {{ parameters }} = module)`. If the \
            module has driven joints, write `dynamics!(struct Name {{ driven }} = module)`. If it has both, write \
            `{{ driven, parameters }}`. For all other modules, write `dynamics!(struct Name = module)`"
)]
pub trait FrictionLaw<Arguments, const N: usize, const NY: usize> {
    /// Friction torques [N m or N] at positions `y` and velocities `v`.
    fn torques(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];
}

impl<F: Fn(&[f64; N]) -> [f64; N], const N: usize, const NY: usize> FrictionLaw<(Velocities,), N, NY> for F {
    #[inline]
    fn torques(&self, _: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        self(v)
    }
}

impl<F, const N: usize, const NY: usize> FrictionLaw<(Coordinates, Velocities), N, NY> for F
where
    F: Fn(&[f64; NY], &[f64; N]) -> [f64; N],
{
    #[inline]
    fn torques(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        self(y, v)
    }
}

/// A generated function `friction_torques` of a module with free parameters `P`, or of a module with driven
/// joints. In the second case `P` is the motion of the driven joints.
#[diagnostic::on_unimplemented(
    message = "the module has no `friction_torques` as a function of velocities, or of positions and velocities",
    label = "generate this module with the function friction_torques",
    note = "if the module has free parameters, write `dynamics!(struct Name {{ parameters }} = module)`. If the \
            module has driven joints, write `dynamics!(struct Name {{ driven }} = module)`. If it has both, write \
            `{{ driven, parameters }}`. For all other modules, write `dynamics!(struct Name = module)`"
)]
pub trait FrictionLawWithParameters<Arguments, P, const N: usize, const NY: usize> {
    /// Friction torques [N m or N] at positions `y` and velocities `v`, with parameters or driven joints `p`.
    fn torques(&self, y: &[f64; NY], v: &[f64; N], p: &P) -> [f64; N];
}

impl<F, P, const N: usize, const NY: usize> FrictionLawWithParameters<(Velocities,), P, N, NY> for F
where
    F: Fn(&[f64; N], &P) -> [f64; N],
{
    #[inline]
    fn torques(&self, _: &[f64; NY], v: &[f64; N], p: &P) -> [f64; N] {
        self(v, p)
    }
}

impl<F, P, const N: usize, const NY: usize> FrictionLawWithParameters<(Coordinates, Velocities), P, N, NY>
    for F
where
    F: Fn(&[f64; NY], &[f64; N], &P) -> [f64; N],
{
    #[inline]
    fn torques(&self, y: &[f64; NY], v: &[f64; N], p: &P) -> [f64; N] {
        self(y, v, p)
    }
}

/// A generated function `friction_torques` of a module with driven joints and free parameters `P`.
#[diagnostic::on_unimplemented(
    message = "the module has no `friction_torques` as a function of velocities, or of positions and velocities",
    label = "generate this module with the function friction_torques"
)]
pub trait FrictionLawWithDriven<Arguments, D, P, const N: usize, const NY: usize> {
    /// Friction torques [N m or N] at positions `y` and velocities `v`, with driven joints `d` and parameters
    /// `p`.
    fn torques(&self, y: &[f64; NY], v: &[f64; N], d: &D, p: &P) -> [f64; N];
}

impl<F, D, P, const N: usize, const NY: usize> FrictionLawWithDriven<(Velocities,), D, P, N, NY> for F
where
    F: Fn(&[f64; N], &D, &P) -> [f64; N],
{
    #[inline]
    fn torques(&self, _: &[f64; NY], v: &[f64; N], d: &D, p: &P) -> [f64; N] {
        self(v, d, p)
    }
}

impl<F, D, P, const N: usize, const NY: usize> FrictionLawWithDriven<(Coordinates, Velocities), D, P, N, NY>
    for F
where
    F: Fn(&[f64; NY], &[f64; N], &D, &P) -> [f64; N],
{
    #[inline]
    fn torques(&self, y: &[f64; NY], v: &[f64; N], d: &D, p: &P) -> [f64; N] {
        self(y, v, d, p)
    }
}

/// Represents the argument y in the type `Arguments` of a function.
#[derive(Debug, Clone, Copy)]
pub struct Coordinates;

/// Represents the argument v in the type `Arguments` of a function.
#[derive(Debug, Clone, Copy)]
pub struct Velocities;
