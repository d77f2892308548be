/// Positions and velocities after the steps, then the blocks of their derivatives with respect to the initial
/// state and to the inputs. Derivatives of positions, and with respect to positions, are taken along ⊕.
pub type SteppedOnManifold<const N: usize, const M: usize, const NY: usize> =
    ([f64; NY], [f64; N], [[Matrix<N>; 2]; 2], [[[f64; M]; N]; 2]);

/// Performs the steps of [`runge_kutta_on_manifold`], and computes the exact derivatives of their result by
/// the chain rule over the stages.
///
/// `linearize` returns `∂v̇/∂y` along ⊕, `∂v̇/∂v`, `∂v̇/∂u`, and the affine remainder
/// `v̇ − ∂v̇/∂v v − ∂v̇/∂u u`.
pub fn runge_kutta_on_manifold_derivatives<
    const J: usize,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    widths: &[usize; J],
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
    substeps: usize,
    linearize: impl Fn(&[f64; NY], &[f64; N]) -> Linear<N, M>,
) -> SteppedOnManifold<N, M, NY> {
    let h = period / substeps as f64;
    // `moved` has only derivatives, and y has the values of the positions, because the affine remainder
    // refers to the displacement 0.
    let (mut y, mut moved, mut v) = (*y, Motion::initial(&[0.0; N], 0), Motion::initial(v, 1));
    let zero = Motion {
        value: [0.0; N],
        by_state: [[[0.0; N]; 2]; N],
        by_inputs: [[0.0; M]; N],
    };
    for _ in 0..substeps {
        let first = Motion::acceleration(&linearize(&y, &v.value), &moved, &v, u);
        let rates = |d: &Motion<N, M>, v: &Motion<N, M>| {
            let linear = linearize(&integrate(widths, &y, &d.value), &v.value);
            let position = moved_on(widths, &moved, d);
            (
                displacement_rates(widths, d, v),
                Motion::acceleration(&linear, &position, v, u),
            )
        };
        let (d, next) = step_in_chart(zero, v, first, h, rates);
        moved = moved_on(widths, &moved, &d);
        (y, v) = (integrate(widths, &y, &d.value), next);
    }
    let mut state = [[[[0.0; N]; N]; 2]; 2];
    for i in 0..N {
        for block in 0..2 {
            state[0][block][i] = moved.by_state[i][block];
            state[1][block][i] = v.by_state[i][block];
        }
    }
    (y, v.value, state, [moved.by_inputs, v.by_inputs])
}

/// The derivatives of `y ⊕ d` from the derivatives of y and d.
fn moved_on<const J: usize, const N: usize, const M: usize>(
    widths: &[usize; J],
    y: &Motion<N, M>,
    d: &Motion<N, M>,
) -> Motion<N, M> {
    let mut sum = Motion {
        value: [0.0; N],
        by_state: [[[0.0; N]; 2]; N],
        by_inputs: [[0.0; M]; N],
    };
    for (width, _, first) in places(widths) {
        match width {
            1 => add_blocks(&mut sum, &[[[1.0]], [[1.0]]], [y, d], first),
            4 => {
                let blocks = rotation_tangents(&read(&d.value, first));
                add_blocks(&mut sum, &blocks, [y, d], first);
            }
            7 => add_blocks(
                &mut sum,
                &pose_tangents(&read(&d.value, first)),
                [y, d],
                first,
            ),
            _ => {}
        }
    }
    sum
}

/// The rate of the displacement with its derivatives.
fn displacement_rates<const J: usize, const N: usize, const M: usize>(
    widths: &[usize; J],
    d: &Motion<N, M>,
    v: &Motion<N, M>,
) -> Motion<N, M> {
    let value = displacement_rate(widths, &d.value, &v.value);
    let mut rate = Motion {
        value,
        by_state: [[[0.0; N]; 2]; N],
        by_inputs: [[0.0; M]; N],
    };
    for (width, _, first) in places(widths) {
        match width {
            1 => add_blocks(&mut rate, &[[[0.0]], [[1.0]]], [d, v], first),
            4 => {
                let (d_value, v_value) = (read(&d.value, first), read(&v.value, first));
                add_blocks(
                    &mut rate,
                    &chart_rates(cross, &d_value, &v_value),
                    [d, v],
                    first,
                );
            }
            7 => {
                let (d_value, v_value) = (read(&d.value, first), read(&v.value, first));
                add_blocks(
                    &mut rate,
                    &chart_rates(pose_bracket, &d_value, &v_value),
                    [d, v],
                    first,
                );
            }
            _ => {}
        }
    }
    rate
}

/// The derivatives of `v + ½ [δ, v] + 1/12 [δ, [δ, v]]` with respect to δ and v.
fn chart_rates<const K: usize>(
    bracket: impl Fn(&[f64; K], &[f64; K]) -> [f64; K],
    d: &[f64; K],
    v: &[f64; K],
) -> [[[f64; K]; K]; 2] {
    let once = bracket(d, v);
    let (mut by_d, mut by_v) = ([[0.0; K]; K], [[0.0; K]; K]);
    for j in 0..K {
        let mut unit = [0.0; K];
        unit[j] = 1.0;
        let changed = bracket(&unit, v);
        let (outer, deeper) = (bracket(&unit, &once), bracket(d, &changed));
        let column = chart_rate(&bracket, d, &unit);
        for i in 0..K {
            by_d[i][j] = changed[i] / 2.0 + (outer[i] + deeper[i]) / 12.0;
            by_v[i][j] = column[i];
        }
    }
    [by_d, by_v]
}

/// Adds the products of a joint's blocks and the derivatives of two motions.
#[inline]
fn add_blocks<const K: usize, const N: usize, const M: usize>(
    sum: &mut Motion<N, M>,
    blocks: &[[[f64; K]; K]; 2],
    motions: [&Motion<N, M>; 2],
    first: usize,
) {
    for (block, motion) in blocks.iter().zip(motions) {
        let rows = sum.by_state.iter_mut().skip(first).zip(block);
        for (row, factors) in rows {
            for (factor, other) in factors.iter().zip(motion.by_state.iter().skip(first)) {
                add_scaled(row.as_flattened_mut(), *factor, other.as_flattened());
            }
        }
        let rows = sum.by_inputs.iter_mut().skip(first).zip(block);
        for (row, factors) in rows {
            for (factor, other) in factors.iter().zip(motion.by_inputs.iter().skip(first)) {
                add_scaled(row, *factor, other);
            }
        }
    }
}
