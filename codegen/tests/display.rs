//! Programs as people read them.

use super::common::{every_operation, mass_matrix};
use gelenk_codegen::program::display::{Notation, latex, text};

#[test]
fn mass_matrix_as_text_and_latex() {
    let program = mass_matrix().program;
    insta::assert_snapshot!("mass_matrix_text", text(&program, &Notation::default()));
    insta::assert_snapshot!("mass_matrix_latex", latex(&program, &Notation::default()));
}

#[test]
fn every_operation_as_text_and_latex() {
    let mut program = every_operation().program;
    for (instruction, name) in program.instructions.iter_mut().zip(["beta", "omega_12", "h_c2", "s1_2"]) {
        instruction.name = name.into();
    }
    insta::assert_snapshot!("every_operation_text", text(&program, &Notation::default()));
    insta::assert_snapshot!("every_operation_latex", latex(&program, &Notation::default()));
}
