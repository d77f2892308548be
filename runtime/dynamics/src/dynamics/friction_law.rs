//! Generated friction functions, with or without the coordinates as an argument.
//!
//! A module has `friction_torques(v)`, or `friction_torques(y, v)` if a friction law depends on the position.
//! The macro [`dynamics!`](crate::dynamics!) cannot distinguish them; the compiler selects the implementation
//! that fits the function.

/// A generated `friction_torques`. `Arguments` tells the implementations apart and is inferred.
#[diagnostic::on_unimplemented(
    message = "the module has no `friction_torques` as a function of velocities, or of positions and velocities",
    label = "generate it with friction_torques",
    note = "a type of a module with free parameters is `struct Name {{ parameters }} = module`, otherwise \
            `struct Name = module`"
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

/// A generated `friction_torques` of a module with free parameters `P`; or with driven joints, whose motion then is `P`.
#[diagnostic::on_unimplemented(
    message = "the module has no `friction_torques` as a function of velocities, or of positions and velocities",
    label = "generate it with friction_torques",
    note = "a type of a module with free parameters is `struct Name {{ parameters }} = module`, otherwise \
            `struct Name = module`"
)]
pub trait FrictionLawWithParameters<Arguments, P, const N: usize, const NY: usize> {
    /// Friction torques [N m or N] at positions `y` and velocities `v`.
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

/// A generated `friction_torques` of a module with driven joints and free parameters `P`.
#[diagnostic::on_unimplemented(
    message = "the module has no `friction_torques` as a function of velocities, or of positions and velocities",
    label = "generate it with friction_torques"
)]
pub trait FrictionLawWithDriven<Arguments, D, P, const N: usize, const NY: usize> {
    /// Friction torques [N m or N] at positions `y`, velocities `v` and driven joints `d`.
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

/// Represents the argument y in the list of a function's arguments.
#[derive(Debug, Clone, Copy)]
pub struct Coordinates;

/// Represents the argument v in the list of a function's arguments.
#[derive(Debug, Clone, Copy)]
pub struct Velocities;
