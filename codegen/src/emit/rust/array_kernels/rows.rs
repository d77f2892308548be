/// R rows of L entries, aligned like cache lines: vectors that straddle two of these cost a tenth of the time.
#[repr(align(64))]
pub struct Rows<const R: usize, const L: usize>(pub [[f64; L]; R]);
