//! The program `gelenk`: from a kinematic description to plain Rust.

fn main() -> std::process::ExitCode {
    gelenk_codegen::cli::run()
}
