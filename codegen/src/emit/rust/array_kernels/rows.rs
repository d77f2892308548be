/// R rows of L entries, aligned to cache lines. If vectors crossed cache lines, functions would take a tenth
/// more time.
#[repr(align(64))]
pub struct Rows<const R: usize, const L: usize>(pub [[f64; L]; R]);
