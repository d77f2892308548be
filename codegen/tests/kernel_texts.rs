//! The texts that the emitter pastes compile alone: `no_std`, without warnings, in the order that `requires`
//! gives.

use std::process::Command;

use gelenk_kernels::math::Kernel;

/// All but those that only others use.
const ALL: [Kernel; 18] = [
    Kernel::SinCos,
    Kernel::SinCosArray,
    Kernel::SinCosF32,
    Kernel::SinCosArrayF32,
    Kernel::SinCosLanes,
    Kernel::SinCosLanesF32,
    Kernel::SinCos2,
    Kernel::SinCos4,
    Kernel::SinCos8,
    Kernel::SinCos2F32,
    Kernel::SinCos4F32,
    Kernel::SinCos8F32,
    Kernel::Exp,
    Kernel::ExpF32,
    Kernel::Tanh,
    Kernel::TanhF32,
    Kernel::Sqrt,
    Kernel::SqrtF32,
];

fn text(kernel: Kernel) -> String {
    let before = kernel.requires().map(text).unwrap_or_default();
    before + kernel.source()
}

#[test]
fn each_text_compiles_without_std_and_without_warnings() {
    for kernel in ALL {
        let file = format!("{}/{kernel:?}.rs", env!("CARGO_TARGET_TMPDIR"));
        let source = format!("#![no_std]\npub mod math {{\n{}\n}}\n", text(kernel));
        std::fs::write(&file, source).unwrap();
        let output = Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into()))
            .args([
                "--edition",
                "2024",
                "--crate-type",
                "lib",
                "--emit",
                "metadata",
                "-D",
                "warnings",
                "--out-dir",
            ])
            .args([env!("CARGO_TARGET_TMPDIR"), &file])
            .output()
            .unwrap();
        assert!(output.status.success(), "{kernel:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
