//! The texts compile where they are pasted: without std, without warnings, without panics, for f64 and f32.

use gelenk_kernels::discrete_time::Text as DiscreteTime;
use gelenk_kernels::manifold::Text;
use gelenk_kernels::math::Kernel;

/// As in a generated module, and one function of each kind for a robot of three joints. The zero-order hold is left out:
/// in that of arms, which it calls, the compiler keeps a check of bounds that is never reached.
const CALLS: &str = "
pub const WIDTHS: [usize; 3] = [7, 1, 4];
pub fn integrate(y: &[f64; 12], d: &[f64; 10]) -> [f64; 12] { manifold::integrate(&WIDTHS, y, d) }
pub fn difference(a: &[f64; 12], b: &[f64; 12]) -> [f64; 10] { manifold::difference(&WIDTHS, a, b) }
pub fn integrate_derivatives(d: &[f64; 10]) -> ([[f64; 10]; 10], [[f64; 10]; 10]) {
    manifold::integrate_derivatives(&WIDTHS, d)
}
pub fn difference_derivatives(d: &[f64; 10]) -> ([[f64; 10]; 10], [[f64; 10]; 10]) {
    manifold::difference_derivatives(&WIDTHS, d)
}
pub fn bracket(a: &[f64; 10], b: &[f64; 10]) -> [f64; 10] { manifold::bracket(&WIDTHS, a, b) }
pub fn normalize(y: &mut [f64; 12]) -> bool { manifold::normalize(&WIDTHS, y) }
pub fn neutral() -> [f64; 12] { manifold::neutral(&WIDTHS) }
pub fn step(y: &[f64; 12], v: &[f64; 10], period: f64) -> ([f64; 12], [f64; 10]) {
    discrete_time::runge_kutta_on_manifold(&WIDTHS, y, v, period, 2, |_, v| *v)
}
pub fn step_derivatives(
    y: &[f64; 12], v: &[f64; 10], u: &[f64; 2], period: f64,
) -> discrete_time::SteppedOnManifold<10, 2, 12> {
    discrete_time::runge_kutta_on_manifold_derivatives(&WIDTHS, y, v, u, period, 2, |_, v| {
        ([[0.0; 10]; 10], [*v; 10], [[1.0; 2]; 10], *v)
    })
}
";

fn module() -> String {
    let math = [Kernel::SinCos, Kernel::Sqrt].map(Kernel::source).join("\n");
    let manifold = [Text::Joints, Text::Rotation, Text::Positions, Text::Bracket, Text::Tangents];
    let manifold = manifold.map(Text::source).join("\n");
    let discrete_time = [
        DiscreteTime::Sums,
        DiscreteTime::Halves,
        DiscreteTime::ZeroOrderHold,
        DiscreteTime::RungeKutta,
        DiscreteTime::Sensitivities,
    ];
    let discrete_time = discrete_time.map(DiscreteTime::source).join("\n");
    let steps = [Text::RungeKutta, Text::Sensitivities, Text::ZeroOrderHold].map(Text::source).join("\n");
    let used = Text::USED_IN_DISCRETE_TIME;
    format!(
        "{CALLS}\npub mod math {{\n{math}\n}}\npub mod manifold {{\nuse super::math::{{sin_cos, sqrt}};\n{manifold}\n}}\n\
         #[allow(dead_code)]\npub mod discrete_time {{\n{used}\n{discrete_time}\n{steps}\n}}\n"
    )
}

fn single(module: &str) -> String {
    let (before, after) = module.split_once("pub mod math {").unwrap();
    let (math, after) = after.split_once("pub mod manifold {").unwrap();
    let names = "use super::math::{sin_cos_f32 as sin_cos, sqrt_f32 as sqrt};";
    let after = after.replace("use super::math::{sin_cos, sqrt};", names).replace("f64", "f32");
    let math = [Kernel::SinCosF32.source(), Kernel::SqrtF32.source(), math].join("\n");
    format!("{}pub mod math {{{math}pub mod manifold {{{after}", before.replace("f64", "f32"))
}

#[test]
fn texts_compile_without_std_warnings_and_panics() {
    let module = module();
    for (name, text) in [("manifold_f64", module.clone()), ("manifold_f32", single(&module))] {
        let folder = env!("CARGO_TARGET_TMPDIR");
        let file = format!("{folder}/{name}.rs");
        std::fs::write(&file, format!("#![no_std]\n{text}")).unwrap();
        let output = std::process::Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into()))
            .args(["--edition", "2024", "--crate-type", "lib", "--emit", "obj", "-O", "-D", "warnings"])
            .args(["-C", "codegen-units=1", "-C", "panic=abort", "--out-dir", folder, &file])
            .output()
            .unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let object = std::fs::read(format!("{folder}/{name}.o")).unwrap();
        let panics = object.windows(9).any(|window| window == b"panicking");
        assert!(!panics, "{name} calls a panic of core");
    }
}
