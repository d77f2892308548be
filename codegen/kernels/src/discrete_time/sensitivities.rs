/// Coordinates and velocities after the steps, then the blocks of their derivatives with respect to the
/// initial state and to the inputs.
pub type Stepped<const N: usize, const M: usize> =
    ([f64; N], [f64; N], [[Matrix<N>; 2]; 2], [[[f64; M]; N]; 2]);

/// Coordinates, velocities or accelerations, with their derivatives with respect to the initial state and to
/// the inputs.
#[derive(Clone, Copy)]
pub struct Motion<const N: usize, const M: usize> {
    /// Value of the quantity.
    pub value: [f64; N],
    /// Derivatives with respect to the initial coordinates and velocities.
    pub by_state: Half<N>,
    /// Derivatives with respect to the inputs.
    pub by_inputs: [[f64; M]; N],
}

impl<const N: usize, const M: usize> Advance for Motion<N, M> {
    fn advanced(&self, factor: f64, rate: &Self) -> Self {
        let mut sum = *self;
        add_scaled(&mut sum.value, factor, &rate.value);
        add_scaled_half(&mut sum.by_state, factor, &rate.by_state);
        add_scaled(
            sum.by_inputs.as_flattened_mut(),
            factor,
            rate.by_inputs.as_flattened(),
        );
        sum
    }
}

impl<const N: usize, const M: usize> Motion<N, M> {
    /// Coordinates (block 0) or velocities (block 1) of the initial state.
    fn initial(value: &[f64; N], block: usize) -> Self {
        let mut by_state = [[[0.0; N]; 2]; N];
        for i in 0..N {
            by_state[i][block % 2][i] = 1.0;
        }
        let by_inputs = [[0.0; M]; N];
        Self {
            value: *value,
            by_state,
            by_inputs,
        }
    }

    /// Computes the acceleration with its derivatives by the chain rule.
    fn acceleration(linear: &Linear<N, M>, y: &Self, v: &Self, u: &[f64; M]) -> Self {
        let (by_y, by_v, by_u, remainder) = linear;
        let mut a = Self {
            value: *remainder,
            by_state: [[[0.0; N]; 2]; N],
            by_inputs: *by_u,
        };
        for i in 0..N {
            a.value[i] += dot(&by_y[i], &y.value) + dot(&by_v[i], &v.value) + dot(&by_u[i], u);
            add_combination(&mut a.by_inputs[i], &by_y[i], &y.by_inputs);
            add_combination(&mut a.by_inputs[i], &by_v[i], &v.by_inputs);
        }
        add_product(&mut a.by_state, by_y.iter(), &y.by_state);
        add_product(&mut a.by_state, by_v.iter(), &v.by_state);
        a
    }
}

/// Performs the steps of [`runge_kutta`] and computes the exact derivatives of their result.
pub fn runge_kutta_derivatives<const N: usize, const M: usize>(
    y: &[f64; N],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
    substeps: usize,
    linearize: impl Fn(&[f64; N], &[f64; N]) -> Linear<N, M>,
) -> Stepped<N, M> {
    let (y, v) = (Motion::initial(y, 0), Motion::initial(v, 1));
    let acceleration = |y: &Motion<N, M>, v: &Motion<N, M>| {
        Motion::acceleration(&linearize(&y.value, &v.value), y, v, u)
    };
    let (y, v) = runge_kutta(y, v, period, substeps, acceleration);
    let mut state = [[[[0.0; N]; N]; 2]; 2];
    for i in 0..N {
        for block in 0..2 {
            state[0][block][i] = y.by_state[i][block];
            state[1][block][i] = v.by_state[i][block];
        }
    }
    (y.value, v.value, state, [y.by_inputs, v.by_inputs])
}
