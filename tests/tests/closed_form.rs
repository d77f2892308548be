//! The PowerCube's linearization against dual numbers through its published closed form (Nicodemus et al.
//! 2022).

use gelenk_generated::powercube;
use gelenk_tests::relative_error;
use num_dual::{Dual64, DualNum};

/// Published numbers: gear ratio, rotor inertia [kg m²], coupling of the inertias [kg m²].
const GEAR: f64 = 161.0;
const ROTOR: f64 = 5.267e-5;
const COUPLING: f64 = 0.3107549862;
const GRAVITY: f64 = 9.80665;

/// `ÿ = M⁻¹ (q + B u − k)` as published.
fn accelerations(y: [Dual64; 2], v: [Dual64; 2], u: [Dual64; 2]) -> [Dual64; 2] {
    let (sin, cos) = (y[1].sin(), y[1].cos());
    let m11 = cos * (2.0 * COUPLING) + (ROTOR * GEAR * GEAR + 0.9560375168565);
    let m12 = cos * COUPLING + (ROTOR * GEAR + 0.6608899068565);
    let m22 = Dual64::from(ROTOR * GEAR * GEAR + 0.6608899068565);
    let k1 = sin * (v[0] * v[1] * 2.0 + v[1] * v[1]) * -COUPLING;
    let k2 = sin * v[0] * v[0] * COUPLING;
    let tanh = |slope: f64, v: Dual64| (v * slope).tanh();
    let outer = (y[0] + y[1]).sin() * (1.72641659 * GRAVITY);
    let q1 = y[0].sin() * (1.626138 * GRAVITY) + outer
        - tanh(5.0, v[0]) * 3.924
        - tanh(10.0, v[0]) * 10.838
        - tanh(20.0, v[0]) * 2.236
        - v[0] * 76.556;
    let q2 = outer
        - tanh(5.0, v[1]) * 0.368
        - tanh(10.0, v[1]) * 0.368
        - tanh(100.0, v[1]) * 8.342
        - 0.492 * v[1].re.signum()
        - v[1] * 56.231;
    let (f1, f2) = (q1 + u[0] * GEAR - k1, q2 + u[1] * GEAR - k2);
    let determinant = m11 * m22 - m12 * m12;
    [(m22 * f1 - m12 * f2) / determinant, (m11 * f2 - m12 * f1) / determinant]
}

#[test]
fn the_linearization_of_the_powercube_is_that_of_its_published_closed_form() {
    let mut rng = fastrand::Rng::with_seed(7);
    for sample in 0..500 {
        // Creeping to full speed: friction is steep below 0.01 rad/s.
        let speed = [0.003, 0.03, 0.3, 2.6][sample % 4];
        let mut signed = |size: f64| size * (2.0 * rng.f64() - 1.0);
        let (y, v) = ([signed(3.0), signed(3.0)], [signed(speed), signed(speed)]);
        let u = [signed(0.5), signed(0.5)];
        // One pass for each variable, which moves by 1.
        let dual = |moved: usize| {
            let pair = |first: usize, x: [f64; 2]| {
                [0, 1].map(|i| Dual64::new(x[i], f64::from(u8::from(first + i == moved))))
            };
            accelerations(pair(0, y), pair(2, v), pair(4, u))
        };
        let (by_y, by_v, by_u, remainder) = powercube::linearize(&y, &v, &u);
        let blocks = [by_y, by_v, by_u];
        for (block, found) in blocks.iter().enumerate() {
            let expected = |i: usize, j: usize| dual(2 * block + j)[i].eps;
            let expected = [[expected(0, 0), expected(0, 1)], [expected(1, 0), expected(1, 1)]];
            let error = relative_error(&found.concat(), &expected.concat());
            assert!(error <= 1e-12, "block {block} at {y:?}, {v:?}: {error:e}");
        }
        // What the parts of ÿ sum up to, relative to the largest of them.
        let parts = |i: usize| {
            let x = [y, v, u];
            let products = (0..3).flat_map(|k| [blocks[k][i][0] * x[k][0], blocks[k][i][1] * x[k][1]]);
            products.chain([remainder[i]]).collect::<Vec<_>>()
        };
        for i in 0..2 {
            let scale = parts(i).iter().fold(0.0_f64, |scale, x| scale.max(x.abs()));
            let difference = parts(i).iter().sum::<f64>() - dual(0)[i].re;
            assert!(difference.abs() <= 1e-12 * scale, "ÿ at {y:?}, {v:?}: {difference:e}");
        }
    }
}
