//! The program `gelenk`, compiled with the tests: a build of the generator's own package would choose other features and compile
//! it a second time.

fn main() -> std::process::ExitCode {
    gelenk_codegen::cli::run()
}
