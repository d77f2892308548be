/// Adds `factor · a`.
#[inline]
fn add_scaled(sum: &mut [f64], factor: f64, a: &[f64]) {
    for (entry, a) in sum.iter_mut().zip(a) {
        *entry += factor * a;
    }
}
