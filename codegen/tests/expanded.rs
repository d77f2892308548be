//! Equations as sums: their values are those of the programs, their text is that of textbooks, and they are LaTeX.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use crate::common::Random;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::functions::selection;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::Model;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::read::{ReadOptions, from_toml, read};
use gelenk_codegen::report::{sums, sums_document};

const NAMES: [&str; 4] = ["mass_matrix", "coriolis_forces", "applied_forces", "input_matrix"];

fn derived(model: &Model) -> Vec<Function> {
    selection::derive_functions(model, &NAMES.map(str::to_owned), MOST_OPERATIONS).unwrap()
}

fn described(text: &str) -> Model {
    let none = &mut |name: &str| panic!("{name} is not asked for");
    from_toml(text, "arm.toml", &ReadOptions::default(), none).unwrap().0
}

/// Craig, *Introduction to Robotics*, 2005, equations 6.58 to 6.60: point masses m₁, m₂ at the ends of links l₁, l₂, with
/// angles from the horizontal; here from the vertical, so that his cosines of gravity are sines.
#[test]
fn the_planar_arm_reads_as_in_the_textbook() {
    let model = described(
        r#"
        name = "arm"
        [parameters]
        l1 = 0.5
        l2 = 0.4
        m1 = 3.0
        m2 = 2.0
        g = 9.81
        [[joints]]
        name = "shoulder"
        axis = [0, 1, 0]
        drive = "ideal"
        [[joints]]
        name = "elbow"
        axis = [0, 1, 0]
        origin = { xyz = [0, 0, "l1"] }
        drive = "ideal"
        [[bodies]]
        link = "shoulder"
        mass = "m1"
        center_of_mass = [0, 0, "l1"]
        [[bodies]]
        link = "elbow"
        mass = "m2"
        center_of_mass = [0, 0, "l2"]
        "#,
    );
    let found = sums(&model, &derived(&model)).unwrap();
    let sorted = |line: &str| {
        let (name, sum) = line.split_once(" = ").unwrap();
        let signed = sum.replace(" - ", " + -");
        let mut terms: Vec<String> = signed
            .split(" + ")
            .map(|term| {
                let sign = if term.starts_with('-') { "-" } else { "" };
                let mut factors: Vec<&str> = term.trim_start_matches('-').split(" \\, ").collect();
                factors.sort_unstable();
                format!("{sign}{}", factors.join(" "))
            })
            .collect();
        terms.sort();
        format!("{name} = {}", terms.join(" + "))
    };
    let expected = [
        r"M_{1,1} = m_{1} \, l_{1}^{2} + m_{2} \, l_{1}^{2} + m_{2} \, l_{2}^{2} + 2 \, m_{2} \, l_{1} \, l_{2} \, \cos\left(y_{2}\right)",
        r"M_{1,2} = m_{2} \, l_{2}^{2} + m_{2} \, l_{1} \, l_{2} \, \cos\left(y_{2}\right)",
        r"M_{2,2} = m_{2} \, l_{2}^{2}",
        r"k_{1} = -m_{2} \, l_{1} \, l_{2} \, \dot{y}_{2}^{2} \, \sin\left(y_{2}\right) - 2 \, m_{2} \, l_{1} \, l_{2} \, \dot{y}_{1} \, \dot{y}_{2} \, \sin\left(y_{2}\right)",
        r"k_{2} = m_{2} \, l_{1} \, l_{2} \, \dot{y}_{1}^{2} \, \sin\left(y_{2}\right)",
    ];
    for expected in expected {
        let name = expected.split(" = ").next().unwrap();
        let line = found.iter().find(|line| line.starts_with(name)).unwrap();
        assert_eq!(sorted(line), sorted(expected));
    }
}

/// A command of LaTeX with its function.
type Named = (&'static str, fn(f64) -> f64);

/// The value of LaTeX that a sum is written in.
struct Reader<'a> {
    rest: &'a str,
    y: &'a [f64],
    v: &'a [f64],
    parameters: &'a [(String, f64)],
}

impl Reader<'_> {
    fn skip(&mut self, text: &str) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(text) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn need(&mut self, text: &str) {
        assert!(self.skip(text), "no {text} in {}", self.rest);
    }

    fn sum(&mut self) -> f64 {
        let mut sum = if self.skip("-") { -self.product() } else { self.product() };
        loop {
            if self.skip("+") {
                sum += self.product();
            } else if self.skip("-") {
                sum -= self.product();
            } else {
                return sum;
            }
        }
    }

    fn product(&mut self) -> f64 {
        let mut product = self.power();
        while self.skip("\\,") || self.skip("\\cdot") {
            product *= self.power();
        }
        product
    }

    fn power(&mut self) -> f64 {
        let base = self.factor();
        if !self.skip("^{") {
            return base;
        }
        let end = self.rest.find('}').unwrap();
        let exponent: i32 = self.rest[..end].parse().unwrap();
        self.rest = &self.rest[end + 1..];
        base.powi(exponent)
    }

    fn index(&mut self) -> usize {
        let end = self.rest.find('}').unwrap();
        let index: usize = self.rest[..end].parse().unwrap();
        self.rest = &self.rest[end + 1..];
        index - 1
    }

    fn argument(&mut self) -> f64 {
        self.need("\\left(");
        let value = self.sum();
        self.need("\\right)");
        value
    }

    fn factor(&mut self) -> f64 {
        for (name, value) in self.parameters {
            if self.skip(name) {
                return *value;
            }
        }
        if self.skip("\\dot{y}_{") {
            let index = self.index();
            return self.v[index];
        }
        if self.skip("y_{") {
            let index = self.index();
            return self.y[index];
        }
        let functions: [Named; 6] = [
            ("\\sin", f64::sin),
            ("\\cos", f64::cos),
            ("\\tanh", f64::tanh),
            ("\\exp", f64::exp),
            ("\\operatorname{sign}", |x| if x == 0.0 { 0.0 } else { x.signum() }),
            ("\\left|", f64::abs),
        ];
        for (name, function) in functions {
            if self.skip(name) {
                if name == "\\left|" {
                    let value = self.sum();
                    self.need("\\right|");
                    return value.abs();
                }
                return function(self.argument());
            }
        }
        if self.skip("\\frac{1}{") {
            let value = self.sum();
            self.need("}");
            return 1.0 / value;
        }
        if self.skip("\\sqrt{") {
            let value = self.sum();
            self.need("}");
            return value.sqrt();
        }
        if self.rest.starts_with("\\left(") {
            return self.argument();
        }
        self.rest = self.rest.trim_start();
        let end = self.rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(self.rest.len());
        let number = self.rest[..end].parse().unwrap_or_else(|_| panic!("no number in {}", self.rest));
        self.rest = &self.rest[end..];
        number
    }
}

fn letter(name: &str) -> String {
    let end = name.find(|c: char| c == '_' || c.is_ascii_digit()).unwrap_or(name.len());
    let (stem, index) = name.split_at(end);
    let word = |word: &str| match word {
        "alpha" | "beta" | "gamma" => format!("\\{word}"),
        _ if word.chars().filter(|c| c.is_alphabetic()).count() > 1 => format!("\\mathrm{{{word}}}"),
        _ => word.to_owned(),
    };
    let parts: Vec<String> = index.trim_matches('_').split('_').map(word).collect();
    match index {
        "" => word(stem),
        _ => format!("{}_{{{}}}", word(stem), parts.join(",")),
    }
}

/// The text is read back and evaluated, and agrees with the interpreted program; numbers are printed to 12 digits.
fn compare(model: &Model) -> usize {
    let functions = derived(model);
    let Ok(lines) = sums(model, &functions) else { return 0 };
    let defaults: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    let letters: Vec<(String, f64)> =
        model.parameters.iter().map(|parameter| (letter(&parameter.name), parameter.default)).collect();
    let mut random = Random(5);
    let n = model.coordinates.len();
    for _ in 0..20 {
        let mut vector = |len: usize| -> Vec<f64> { (0..len).map(|_| 0.5 * random.number()).collect() };
        let (y, v) = (vector(model.position_count()), vector(n));
        let mut at = 0;
        for function in NAMES.iter().filter_map(|name| functions.iter().find(|one| one.name == *name)) {
            let inputs: Vec<&[f64]> = function
                .program
                .inputs
                .iter()
                .map(|input| if input.name == "y" { y.as_slice() } else { v.as_slice() })
                .collect();
            let values = interpret(&function.program, &inputs, &defaults).unwrap().concat();
            let size = values.iter().fold(1e-3_f64, |most, x| most.max(x.abs()));
            for (k, value) in values.iter().enumerate() {
                if function.name == "mass_matrix" && k / n > k % n {
                    continue;
                }
                let (name, sum) = lines[at].split_once(" = ").unwrap();
                let mut reader = Reader { rest: sum, y: &y, v: &v, parameters: &letters };
                let found = reader.sum();
                assert_eq!(reader.rest.trim(), "", "{name}");
                assert!((found - value).abs() < 1e-9 * size, "{}: {name}: {found} {value}", model.name);
                at += 1;
            }
        }
        assert_eq!(at, lines.len(), "{}", model.name);
    }
    lines.len()
}

#[test]
fn sums_have_the_values_of_the_programs() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut compared = Vec::new();
    for name in [
        "powercube",
        "powercube_alpha",
        "powercube_alpha_parameters",
        "powercube_parameters",
        "double_pendulum",
        "cart_pole",
    ] {
        let model = read(&folder.join(format!("{name}.toml")), &ReadOptions::default()).unwrap().model;
        if compare(&model) > 0 {
            compared.push(name);
        }
    }
    assert!(compared.len() >= 5, "{compared:?}");
    // Three joints of general directions, and a slide.
    let spatial = described(
        r#"
        name = "spatial"
        [[joints]]
        name = "a"
        drive = "ideal"
        [[joints]]
        name = "b"
        axis = [0, 1, 0]
        origin = { xyz = [0.1, 0.2, 0.3], rpy = [0.3, 0, 0] }
        spring = "-5*pow(y, 3)"
        friction = "0.1*v + 0.2*tanh(20*v) + 0.1*abs(v)*v"
        [[joints]]
        name = "c"
        type = "prismatic"
        origin = { xyz = [0.3, 0, 0.1] }
        drive = "ideal"
        [[bodies]]
        link = "a"
        mass = 3
        center_of_mass = [0.1, 0.05, 0.2]
        inertia = [0.1, 0.2, 0.15]
        [[bodies]]
        link = "b"
        mass = 2
        center_of_mass = [0.15, -0.05, 0.1]
        inertia = [0.1, 0.12, 0.05]
        [[bodies]]
        link = "c"
        mass = 1
        center_of_mass = [0.02, 0.01, 0.1]
        inertia = [0.02, 0.02, 0.01]
        "#,
    );
    assert_eq!(compare(&spatial), 6 + 3 + 3 + 6);
}

#[test]
fn numbers_are_rounded_to_what_they_mean() {
    let model = described(
        r#"
        name = "arm"
        gravity = [0, 0, -9.81]
        [[joints]]
        name = "swing"
        axis = [0, 1, 0]
        [[bodies]]
        link = "swing"
        mass = 0.3
        center_of_mass = [0, 0, 0.7]
        inertia = 0.067
        "#,
    );
    let document = sums_document(&model, &derived(&model)).unwrap();
    // 0.3 · 0.7² + 0.067, which is 0.21400000000000002 in f64.
    assert!(document.contains("M_{1,1} = 0.214 \\\\"), "{document}");
    assert!(document.contains("q_{1} = 2.0601 \\, \\sin\\left(y_{1}\\right)"), "{document}");
    assert!(document.starts_with("% arm: ") && document.ends_with("\\end{document}\n"));
}

#[test]
fn large_robots_are_refused_with_the_reason() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let model = read(&folder.join("scara.toml"), &ReadOptions::default()).unwrap().model;
    let reason = sums(&model, &[]).unwrap_err();
    assert!(reason.contains("up to 3 coordinates") && reason.contains("has 5"), "{reason}");
}
