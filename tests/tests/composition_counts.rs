//! Operation counts of the functions over a sample time: their text runs over numbers that count, and the
//! counts are those of the documentation, at least and at most if they depend on the data.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::process::Command;

use gelenk_codegen::functions::composition::Composition;
use gelenk_codegen::program::cost::Cost;
use gelenk_kernels::discrete_time::Text;
use gelenk_tests::compiler::rustc;

/// A number that counts what is done with it.
const NUMBER: &str = "
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
static COUNTS: [AtomicUsize; 3] = [const { AtomicUsize::new(0) }; 3];
fn counted(kind: usize, value: f64) -> F { COUNTS[kind].fetch_add(1, Relaxed); F(value) }
#[derive(Clone, Copy, Default, PartialEq, PartialOrd)]
pub struct F(f64);
impl F { const INFINITY: F = F(f64::INFINITY); fn abs(self) -> F { F(self.0.abs()) } }
impl core::ops::Mul for F { type Output = F; fn mul(self, b: F) -> F { counted(0, self.0 * b.0) } }
impl core::ops::Mul<&F> for F { type Output = F; fn mul(self, b: &F) -> F { self * *b } }
impl core::ops::Add for F { type Output = F; fn add(self, b: F) -> F { counted(1, self.0 + b.0) } }
impl core::ops::Sub for F { type Output = F; fn sub(self, b: F) -> F { counted(1, self.0 - b.0) } }
impl core::ops::Div for F { type Output = F; fn div(self, b: F) -> F { counted(2, self.0 / b.0) } }
impl core::ops::AddAssign for F { fn add_assign(&mut self, b: F) { *self = *self + b; } }
impl core::ops::MulAssign for F { fn mul_assign(&mut self, b: F) { *self = *self * b; } }
";

const MAIN: &str = "
type Zeros<const N: usize, const M: usize> = ([[F; N]; N], [[F; N]; N], [[F; M]; N], [F; N]);
fn zeros<const N: usize, const M: usize>() -> Zeros<N, M> { ([[F(0.0); N]; N], [[F(0.0); N]; N], [[F(0.0); M]; N], [F(0.0); N]) }
fn report() {
    let counts = COUNTS.each_ref().map(|count| count.swap(0, Relaxed).to_string());
    println!(\"{}\", counts.join(\" \"));
}
fn all<const N: usize, const M: usize>(substeps: usize) {
    let (x, u, period) = ([F(0.0); N], [F(0.0); M], F(0.1));
    let _ = zero_order_hold::<N, M>(&zeros(), period);
    report();
    let mut stiffest = zeros();
    // So stiff that the most halvings of the period just suffice.
    stiffest.1[0][0] = F(0.999 * 80.0 * f64::from(1 << 18) / period.0);
    let _ = zero_order_hold::<N, M>(&stiffest, period);
    report();
    let _ = runge_kutta(x, x, period, substeps, |_: &[F; N], _: &[F; N]| x);
    report();
    let _ = runge_kutta_derivatives::<N, M>(&x, &x, &u, period, substeps, |_, _| zeros());
    report();
}
";

/// Coordinates, inputs, substeps.
const SIZES: [(usize, usize, usize); 4] = [(1, 1, 1), (2, 2, 3), (3, 1, 1), (6, 7, 2)];

/// `1.5` becomes `F(1.5)`; ranges and indices stay.
fn wrapped_literals(text: &str) -> String {
    let mut wrapped = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(|letter: char| letter.is_ascii_alphanumeric() || letter == '_') {
        let (before, word) = rest.split_at(start);
        let end = word.find(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_'));
        let (word, after) = word.split_at(end.unwrap_or(word.len()));
        let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).count();
        let fraction = after.strip_prefix('.').map_or(0, digits);
        wrapped.push_str(before);
        if digits(word) == word.len() && fraction > 0 {
            wrapped.push_str(&format!("F({word}{})", &after[..=fraction]));
            rest = &after[1 + fraction..];
        } else {
            wrapped.push_str(word);
            rest = after;
        }
    }
    wrapped + rest
}

/// The text over counting numbers.
fn counting_text() -> String {
    let texts = [Text::Sums, Text::Halves, Text::ZeroOrderHold, Text::RungeKutta, Text::Sensitivities];
    let text: String = texts.iter().map(|text| text.source()).collect();
    // The coefficients are made by the compiler, not by the function.
    let start = text.find("const COEFFICIENTS").expect("coefficients");
    let end = start + text[start..].find("};").expect("their end") + 2;
    let coefficients = "const COEFFICIENTS: [[f64; TERMS]; 3] = [[1.0; TERMS]; 3];";
    let text = [&text[..start], coefficients, &text[end..]].concat();
    let mut text = wrapped_literals(&text);
    for whole in ["(1_u32 << repetitions) as f64", "(1_u32 << doublings) as f64", "substeps as f64"] {
        assert!(text.contains(whole), "{whole}");
        text = text.replace(whole, &format!("F({})", whole.replace("f64", "real")));
    }
    text.replace("f64", "F").replace("as real)", "as f64)")
}

#[test]
fn counts_are_those_of_the_loops() {
    let calls: String =
        SIZES.iter().map(|(n, m, substeps)| format!("    all::<{n}, {m}>({substeps});\n")).collect();
    let text = format!("{NUMBER}{}{MAIN}fn main() {{\n{calls}}}\n", counting_text());
    let folder = tempfile::tempdir().expect("a folder");
    rustc(folder.path(), "main", &text, &["-A", "warnings"]).unwrap_or_else(|message| panic!("{message}"));
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    assert!(output.status.success());
    let found = String::from_utf8_lossy(&output.stdout).into_owned();
    let expected: String = SIZES
        .iter()
        .flat_map(|&(n, m, substeps)| {
            let least = Composition::Discretize.least_cost(n, m, substeps, Cost::default());
            let most = Composition::ALL.map(|each| each.cost(n, m, substeps, Cost::default()));
            [least].into_iter().chain(most)
        })
        .map(|cost| format!("{} {} {}\n", cost.multiplications, cost.additions, cost.divisions))
        .collect();
    assert_eq!(found, expected);
}
