/// The Lie bracket `ad_a b` of each joint; 0 for joints without quaternions.
///
/// For a floating joint, the bracket of `(a_l, a_ω)` and `(b_l, b_ω)` (linear, angular) is
/// `(a_ω × b_l + a_l × b_ω, a_ω × b_ω)`. Small deviations `δ = y ⊖ ȳ` from a motion with the velocities v̄
/// have the rate `δ̇ = v − v̄ − ad_v̄ δ`.
pub fn bracket<const J: usize, const N: usize>(
    widths: &[usize; J],
    a: &[f64; N],
    b: &[f64; N],
) -> [f64; N] {
    let mut result = [f64::NAN; N];
    for (width, _, first) in places(widths) {
        match width {
            1 => write(&mut result, first, &[0.0]),
            4 => write(&mut result, first, &cross(&read(a, first), &read(b, first))),
            7 => write(
                &mut result,
                first,
                &pose_bracket(&read(a, first), &read(b, first)),
            ),
            _ => {}
        }
    }
    result
}

/// The Lie bracket of se(3).
pub(super) fn pose_bracket([a, b, c, w @ ..]: &[f64; 6], [d, e, f, u @ ..]: &[f64; 6]) -> [f64; 6] {
    let (one, other) = (cross(w, &[*d, *e, *f]), cross(&[*a, *b, *c], u));
    let angular = cross(w, u);
    [
        one[0] + other[0],
        one[1] + other[1],
        one[2] + other[2],
        angular[0],
        angular[1],
        angular[2],
    ]
}
