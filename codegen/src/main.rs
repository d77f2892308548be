//! The program `gelenk` generates Rust or C code from kinematic descriptions.

fn main() -> std::process::ExitCode {
    gelenk_codegen::cli::run()
}
