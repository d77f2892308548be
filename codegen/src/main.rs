//! The program `gelenk`: it writes plain Rust or C from kinematic descriptions.

fn main() -> std::process::ExitCode {
    gelenk_codegen::cli::run()
}
