/// The sum `sum + a b`.
#[inline(always)]
fn add_product(sum: f64, a: f64, b: f64) -> f64 {
    sum + a * b
}
