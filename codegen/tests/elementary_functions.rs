//! Accuracy of the elementary functions, against a multiple-precision crate (dashu) and values from the
//! literature.
//!
//! Random points are screened with a double-double reference; every point that it finds above [`SUSPICIOUS`],
//! and a sample of the others, is decided by dashu with 200 bits. Points near multiples of π/2 go to dashu
//! directly. Full runs:
//! `cargo test --release -p gelenk-codegen --test all elementary_functions -- --ignored --nocapture`.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "elementary_functions/double_double.rs"]
mod double_double;

use dashu_float::{FBig, round::mode::HalfEven};
use double_double::DoubleDouble;
use gelenk_kernels::math;

type Real = FBig<HalfEven, 2>;

/// Error in ulp from which on a point is checked with multiple precision.
const SUSPICIOUS: f64 = 0.75;
/// Largest errors seen, rounded up; the docs of the kernels promise a little more.
const SIN_COS_BOUND: f64 = 0.8;
const EXP_BOUND: f64 = 0.74;
const TANH_BOUND: f64 = 0.86;

/// SplitMix64 (Steele, Lea and Flood 2014): seeded, so that every run sees the same points.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e3779b97f4a7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        z ^ (z >> 31)
    }

    /// Uniform in `[low, high)`.
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform exponent and sign: as many small numbers as large ones.
    fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        let size = self.uniform(low.ln(), high.ln()).exp();
        if self.bits() & 1 == 0 { size } else { -size }
    }
}

/// Distance of neighbouring f64 at `x`.
fn ulp(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52 & 0x7ff).max(1);
    f64::from_bits(exponent << 52) * f64::EPSILON
}

fn exact(x: f64) -> Real {
    Real::try_from(x).unwrap().with_precision(200).value()
}

/// Error in ulp of the correctly rounded result; exact down to the subnormals.
fn error(value: f64, reference: &Real) -> f64 {
    let unit = ulp(reference.to_f64().value());
    ((exact(value) - reference) / exact(unit)).to_f64().value().abs()
}

fn screened_error(value: f64, reference: DoubleDouble) -> f64 {
    (((value - reference.hi) - reference.low) / ulp(reference.hi)).abs()
}

/// Largest error of `function` over `points`, after screening; every 997th point is decided by dashu in any
/// case.
fn largest_error(
    points: impl Iterator<Item = f64>,
    function: impl Fn(f64) -> f64,
    screen: impl Fn(f64) -> DoubleDouble,
    reference: impl Fn(&Real) -> Real,
) -> (f64, f64) {
    let mut largest = (0.0, 0.0);
    for (index, x) in points.enumerate() {
        let value = function(x);
        let screened = screened_error(value, screen(x));
        let found = if screened.is_nan() || screened > SUSPICIOUS || index % 997 == 0 {
            let decided = error(value, &reference(&exact(x)));
            assert!((decided - screened).abs() < 1e-9, "the screen is wrong at {x:e}: {screened}, {decided}");
            decided
        } else {
            screened
        };
        if found > largest.0 {
            largest = (found, x);
        }
    }
    largest
}

/// The f64 on both sides of n π/2, for n spread over the range of the fast path.
fn near_multiples_of_half_pi(count: u32) -> impl Iterator<Item = f64> {
    let half_pi = Real::try_from(1.0_f64).unwrap().with_precision(400).value().asin();
    (0..count).flat_map(move |k| {
        let n = 1 + u64::from(k) * 63661 / u64::from(count);
        let nearest = (&half_pi * Real::from(n)).to_f64().value();
        [nearest, -nearest.next_up(), nearest.next_down()]
    })
}

fn check_sin_cos(random: usize, near: u32) {
    let points = || {
        let mut source = Random(1);
        (0..random).map(move |k| match k % 3 {
            0 => source.uniform(-7.0, 7.0),
            1 => source.uniform(-1e5, 1e5),
            _ => source.logarithmic(1e-9, 1e5),
        })
    };
    let sin = largest_error(points(), |x| math::sin_cos(x).0, |x| double_double::sin_cos(x)[0], Real::sin);
    let cos = largest_error(points(), |x| math::sin_cos(x).1, |x| double_double::sin_cos(x)[1], Real::cos);
    let mut hard = (0.0, 0.0);
    for x in near_multiples_of_half_pi(near) {
        let ((s, c), (sin, cos)) = (math::sin_cos(x), exact(x).sin_cos());
        let found = error(s, &sin).max(error(c, &cos));
        if found > hard.0 {
            hard = (found, x);
        }
    }
    println!("sin {sin:?}, cos {cos:?}, near multiples of π/2 {hard:?}");
    assert!(sin.0.max(cos.0).max(hard.0) <= SIN_COS_BOUND);
}

fn check_sin_cos_beyond(count: usize) {
    let mut source = Random(2);
    let mut largest = (0.0, 0.0);
    for k in 0..count {
        let x = source.logarithmic(1e5, if k % 2 == 0 { 1e12 } else { f64::MAX });
        let ((s, c), (sin, cos)) = (math::sin_cos(x), exact(x).sin_cos());
        let found = error(s, &sin).max(error(c, &cos));
        if found > largest.0 {
            largest = (found, x);
        }
    }
    println!("sin, cos beyond 1e5 {largest:?}");
    assert!(largest.0 <= SIN_COS_BOUND);
}

fn check_exp(random: usize, subnormal: usize) {
    let mut source = Random(3);
    let points = (0..random).map(|k| match k % 3 {
        0 => source.uniform(-1.0, 1.0),
        1 => source.uniform(-650.0, 709.0), // the low part of the screen is normal here
        _ => source.logarithmic(1e-20, 650.0),
    });
    let normal = largest_error(points, math::exp, double_double::exp, Real::exp);
    let mut source = Random(4);
    let small = (0..subnormal)
        .map(|_| source.uniform(-746.0, -650.0))
        .map(|x| (error(math::exp(x), &exact(x).exp()), x))
        .fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    println!("exp {normal:?}, towards zero {small:?}");
    assert!(normal.0 <= EXP_BOUND && small.0 <= 1.0);
}

fn check_tanh(random: usize) {
    let mut source = Random(5);
    let points = (0..random).map(|k| match k % 4 {
        0 => source.uniform(-1.0, 1.0),
        1 => source.uniform(0.5, 0.8),
        2 => source.uniform(-20.0, 20.0),
        _ => source.logarithmic(1e-20, 20.0),
    });
    let found = largest_error(points, math::tanh, double_double::tanh, Real::tanh);
    println!("tanh {found:?}");
    assert!(found.0 <= TANH_BOUND);
}

#[test]
fn short_runs_stay_within_the_bounds() {
    check_sin_cos(100_000, 300);
    check_sin_cos_beyond(300);
    check_exp(100_000, 300);
    check_tanh(100_000);
}

#[test]
#[ignore = "10⁷ points: minutes, in release mode"]
fn sin_cos_of_ten_million_points() {
    check_sin_cos(10_000_000, 10_000);
    check_sin_cos_beyond(10_000);
}

#[test]
#[ignore = "10⁷ points: minutes, in release mode"]
fn exp_of_ten_million_points() {
    check_exp(10_000_000, 10_000);
}

#[test]
#[ignore = "10⁷ points: minutes, in release mode"]
fn tanh_of_ten_million_points() {
    check_tanh(10_000_000);
}

#[test]
fn lanes_have_the_bits_of_the_scalar_functions() {
    let mut source = Random(6);
    for _ in 0..20_000 {
        let x: [f64; 8] = std::array::from_fn(|_| source.logarithmic(1e-5, 2e5));
        let (sin, cos) = math::sin_cos_array(x);
        let bits = |a: [f64; 8]| a.map(f64::to_bits);
        assert_eq!(bits(sin), bits(x.map(|x| math::sin_cos(x).0)));
        assert_eq!(bits(cos), bits(x.map(|x| math::sin_cos(x).1)));
        let mut lanes = [[0.0; 8]; 2];
        let [lane_sin, lane_cos] = &mut lanes;
        math::sin_cos_lanes(&x, lane_sin, lane_cos);
        assert_eq!(lanes.map(bits), [sin, cos].map(bits));
        let x = x.map(|x| x as f32);
        let (sin, cos) = math::sin_cos_array_f32(x);
        let bits = |a: [f32; 8]| a.map(f32::to_bits);
        assert_eq!(bits(sin), bits(x.map(|x| math::sin_cos_f32(x).0)));
        assert_eq!(bits(cos), bits(x.map(|x| math::sin_cos_f32(x).1)));
        let mut lanes = [[0.0; 8]; 2];
        let [lane_sin, lane_cos] = &mut lanes;
        math::sin_cos_lanes_f32(&x, lane_sin, lane_cos);
        assert_eq!(lanes.map(bits), [sin, cos].map(bits));
    }
}

/// The processor's square root is correctly rounded (IEEE 754).
#[test]
fn square_roots_are_those_of_the_processor() {
    let mut random = Random(11);
    let special = [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -1.0, f64::MIN_POSITIVE, 5e-324];
    let largest = [f64::MAX, 1.0, 2.0, 4.0, 1.0 - f64::EPSILON / 2.0, 1.0 + f64::EPSILON];
    let any: Vec<f64> = (0..200_000).map(|_| f64::from_bits(random.bits())).collect();
    // Squares of numbers with few digits and of the middles between two numbers, and their neighbours.
    let squares = (0..50_000).flat_map(|_| {
        let root = random.uniform(1.0, 2.0);
        let middle = root * root + root * f64::EPSILON;
        [root * root, middle, middle.next_up(), middle.next_down(), f64::from(root as f32).powi(2)]
    });
    let squares: Vec<f64> = squares.collect();
    for x in special.into_iter().chain(largest).chain(any).chain(squares) {
        let (own, reference) = (math::sqrt(x), x.sqrt());
        assert!(own.to_bits() == reference.to_bits() || own.is_nan() && reference.is_nan(), "{x:e}: {own:e}");
        let (x, own) = (x as f32, math::sqrt_f32(x as f32));
        assert!(own.to_bits() == x.sqrt().to_bits() || own.is_nan() && x.sqrt().is_nan(), "{x:e}: {own:e}");
    }
}

#[test]
fn signed_zeros_infinities_and_saturation() {
    assert_eq!(math::sin_cos(-0.0).0.to_bits(), (-0.0_f64).to_bits());
    assert_eq!(math::sin_cos(0.0).0.to_bits(), 0);
    assert_eq!(math::sin_cos(5e-324), (5e-324, 1.0));
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (sin, cos) = math::sin_cos(x);
        let (lane_sin, lane_cos) = math::sin_cos_array([0.5, x]);
        assert!(sin.is_nan() && cos.is_nan() && lane_sin[1].is_nan() && lane_cos[1].is_nan());
        assert_eq!((lane_sin[0], lane_cos[0]), math::sin_cos(0.5));
    }
    assert_eq!(
        [f64::INFINITY, 709.79, 0.0, -745.2, f64::NEG_INFINITY].map(math::exp),
        [f64::INFINITY, f64::INFINITY, 1.0, 0.0, 0.0]
    );
    assert_eq!([709.78, -745.13].map(math::exp), [709.78_f64.exp(), 5e-324]);
    assert_eq!([19.07, f64::INFINITY, -19.07, f64::NEG_INFINITY].map(math::tanh), [1.0, 1.0, -1.0, -1.0]);
    assert_eq!(math::tanh(-0.0).to_bits(), (-0.0_f64).to_bits());
    assert_eq!(math::tanh(5e-324), 5e-324);
    assert!(math::exp(f64::NAN).is_nan() && math::tanh(f64::NAN).is_nan());
}

/// Largest error in ulp of f32 against the f64 functions of the standard library, and where.
fn largest_error_f32(
    points: impl Iterator<Item = f32>,
    function: impl Fn(f32) -> f32,
    reference: impl Fn(f64) -> f64,
) -> (f64, f32) {
    let mut largest = (0.0, 0.0);
    for x in points {
        let reference = reference(f64::from(x));
        let nearest = reference as f32;
        let unit = f64::from(f32::from_bits((nearest.to_bits() >> 23 & 0xff).max(1) << 23))
            * f64::from(f32::EPSILON);
        let found = (f64::from(function(x)) - reference).abs() / unit;
        if found.is_nan() || found > largest.0 {
            largest = (found, x);
        }
    }
    largest
}

/// Largest errors seen of all numbers (`f32_functions_at_every_number`), rounded up; the docs of the kernels promise a
/// little more.
const SIN_COS_F32_BOUND: f64 = 0.84;
const EXP_F32_BOUND: f64 = 0.79;
const TANH_F32_BOUND: f64 = 0.9;

/// Numbers from `low` to `high` that are not negative, every one of `step`, in the order of their bits.
fn numbers_f32(low: f32, high: f32, step: usize) -> impl Iterator<Item = f32> {
    (low.to_bits()..=high.to_bits()).step_by(step).map(f32::from_bits)
}

/// Every one of `step` numbers of all that are not negative; of exp those of both signs.
fn check_f32(step: usize) {
    // In addition numbers close to n π/2, where most digits cancel, on both sides of the fast path's end.
    let near = (1..20_000).map(|n| (f64::from(n) * std::f64::consts::FRAC_PI_2) as f32);
    let angles = || numbers_f32(0.0, f32::MAX, step).chain(near.clone());
    let sin = largest_error_f32(angles(), |x| math::sin_cos_f32(x).0, f64::sin);
    let cos = largest_error_f32(angles(), |x| math::sin_cos_f32(x).1, f64::cos);
    // Below the largest number; beyond it the result is infinite.
    let exponents = numbers_f32(0.0, 88.72, step).chain(numbers_f32(0.0, 110.0, step).map(|x| -x));
    let exp = largest_error_f32(exponents, math::exp_f32, f64::exp);
    let tanh = largest_error_f32(numbers_f32(0.0, 12.0, step), math::tanh_f32, f64::tanh);
    println!("f32: sin {sin:?}, cos {cos:?}, exp {exp:?}, tanh {tanh:?}");
    assert!(sin.0.max(cos.0) <= SIN_COS_F32_BOUND && exp.0 <= EXP_F32_BOUND && tanh.0 <= TANH_F32_BOUND);
    // Mantissas with both parities of the exponent are all there is to a square root.
    for x in numbers_f32(1.0, 4.0, step.min(97)) {
        assert_eq!(math::sqrt_f32(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
    }
}

#[test]
fn f32_functions_stay_within_the_bounds() {
    check_f32(9973);
    for (x, y) in [(1e-3, 1.0), (3.0, 500.0), (1e6, 1e30)] {
        let ((s, c), (t, d)) = (math::sin_cos_f32(x), math::sin_cos_f32(-x));
        assert_eq!([s, c].map(f32::to_bits), [-t, d].map(f32::to_bits));
        assert_eq!(math::tanh_f32(y).to_bits(), (-math::tanh_f32(-y)).to_bits());
    }
    let not_finite = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    assert!(
        not_finite.into_iter().all(|x| math::sin_cos_f32(x).0.is_nan() && math::sin_cos_f32(x).1.is_nan())
    );
    assert!(math::exp_f32(f32::NAN).is_nan() && math::tanh_f32(f32::NAN).is_nan());
    assert_eq!(math::sin_cos_f32(-0.0).0.to_bits(), (-0.0_f32).to_bits());
    assert_eq!(math::tanh_f32(-0.0).to_bits(), (-0.0_f32).to_bits());
    assert_eq!([89.0, -104.0, f32::NEG_INFINITY].map(math::exp_f32), [f32::INFINITY, 0.0, 0.0]);
    assert_eq!([9.1, -9.1, f32::INFINITY].map(math::tanh_f32), [1.0, -1.0, 1.0]);
}

#[test]
#[ignore = "2³¹ numbers for each function: minutes, in release mode"]
fn f32_functions_at_every_number() {
    check_f32(1);
}

/// The double closest to a multiple of π/2 in relative terms, 6381956970095103 · 2⁷⁹⁷, and its cosine,
/// −4.68716592425462761112e−19 (Muller, Elementary Functions, 2016, chapter on range reduction).
#[test]
fn worst_case_of_the_range_reduction() {
    let x = 6381956970095103.0 * 2.0_f64.powi(797);
    assert_eq!(math::sin_cos(x).1, -4.687165924254628e-19);
}
