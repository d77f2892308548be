/// R rows of L entries, aligned to cache lines: vectors across two lines cost a tenth of the time.
#[repr(align(64))]
pub struct Rows<const R: usize, const L: usize>(pub [[f64; L]; R]);
