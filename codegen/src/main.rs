//! The program `gelenk`: kinematic descriptions to plain Rust.

fn main() -> std::process::ExitCode {
    gelenk_codegen::cli::run()
}
