/// The sum `sum + a b`, rounded once.
#[inline(always)]
fn add_product(sum: f64, a: f64, b: f64) -> f64 {
    a.mul_add(b, sum)
}
