//! Programs without intermediate values: each entry of a result is printed as one sum, for readers.
//!
//! A value is a sum of terms `c · a₁^p₁ a₂^p₂ … · cos(n·y)` or `… · sin(n·y)` with integer multiples n of the
//! positions y. Products of sines and cosines are converted to sums, so equal terms combine and `sin² + cos²`
//! becomes 1. The factors a are positions outside of angles, velocities, parameters, and function calls such
//! as `tanh(20 ẏ₁)`.
//!
//! For each coefficient, the sum of the magnitudes of its contributions is stored. This sum is a bound for
//! the rounding error. A coefficient is printed with its reliable digits, and is left out if no digit is
//! reliable.

use std::collections::BTreeMap;

use super::display::{Notation, latex_letters, latex_number};
use super::{Operand, Operation, Output, Program, Shape};
use gelenk_formula::Function;

/// Largest number of terms in the sum for a value. A product of two values multiplies their numbers of terms,
/// and longer sums are not readable.
pub(crate) const MOST_TERMS: usize = 1000;
/// Rounding error of a term's coefficient, relative to the sum of the magnitudes of its contributions.
const ROUNDING: f64 = 1e-12;
/// Largest number of digits of a printed coefficient.
const DIGITS: i32 = 12;

/// An entry of a result, expanded to a sum in LaTeX.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpandedEntry {
    /// Symbol of the entry with indices from 1, for example `M_{1,2}`.
    pub name: String,
    /// The entry as a sum in LaTeX.
    pub value: String,
}

/// Returns the entries of all results, row-major. For a symmetric matrix, only the upper triangle is
/// returned. `None` if a value has more than 1000 terms.
#[must_use]
pub fn expanded(program: &Program, notation: &Notation, is_symmetric: bool) -> Option<Vec<ExpandedEntry>> {
    let mut expansion = Expansion { program, notation, factors: Vec::new(), values: Vec::new() };
    expansion.run()?;
    let mut entries = Vec::new();
    for output in &program.outputs {
        for (k, entry) in output.entries.iter().enumerate() {
            let [row, column] = place(output, k);
            if !is_symmetric || row <= column {
                let sum = expansion.known(*entry);
                entries.push(ExpandedEntry { name: name(output, k), value: expansion.latex(&sum) });
            }
        }
    }
    Some(entries)
}

/// Row and column of an entry in a result.
fn place(output: &Output, entry: usize) -> [usize; 2] {
    match output.shape {
        Shape::Matrix(_, columns) => [entry / columns.len.max(1), entry % columns.len.max(1)],
        Shape::Scalar | Shape::Vector(_) => [entry, 0],
    }
}

fn name(output: &Output, entry: usize) -> String {
    let letter = latex_letters(&output.name);
    let [row, column] = place(output, entry);
    match output.shape {
        Shape::Scalar => letter,
        Shape::Vector(_) => format!("{letter}_{{{}}}", row + 1),
        Shape::Matrix(..) => format!("{letter}_{{{},{}}}", row + 1, column + 1),
    }
}

/// The factors of a term except its numeric coefficient.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
struct Term {
    /// Indices of the term's factors with their exponents, in ascending order.
    powers: Vec<(usize, u32)>,
    /// Integer multiples of positions in the angle of the term's sine or cosine. The first non-zero multiple
    /// is positive. Empty if the term has no angle.
    multiples: BTreeMap<usize, i32>,
    /// Whether the term has the sine of the angle instead of its cosine.
    is_sine: bool,
}

#[derive(Debug, Clone, Copy, Default)]
struct Coefficient {
    value: f64,
    /// Sum of the magnitudes of all contributions to the coefficient, which bounds its rounding error.
    size: f64,
}

type Sum = BTreeMap<Term, Coefficient>;

/// A factor of terms: an input or a function call.
#[derive(Debug, Clone, PartialEq)]
enum Factor {
    /// An entry of an input array: index of the array, then index of the entry.
    Input(usize, usize),
    Parameter(usize),
    /// A function of a sum, for example `tanh(20 ẏ₁)`, as LaTeX.
    Call(String),
}

struct Expansion<'a> {
    program: &'a Program,
    notation: &'a Notation,
    factors: Vec<Factor>,
    values: Vec<Sum>,
}

impl Expansion<'_> {
    fn run(&mut self) -> Option<()> {
        for instruction in &self.program.instructions {
            let value = self.value(instruction.operation)?;
            self.values.push(value);
        }
        Some(())
    }

    fn value(&mut self, operation: Operation) -> Option<Sum> {
        Some(match operation {
            Operation::Add(a, b) => added(self.known(a), &self.known(b), 1.0)?,
            Operation::Subtract(a, b) => added(self.known(a), &self.known(b), -1.0)?,
            Operation::Multiply(a, b) => product(&self.known(a), &self.known(b))?,
            Operation::Negate(a) => added(Sum::new(), &self.known(a), -1.0)?,
            Operation::MultiplyAdd(a, b, c) => {
                added(product(&self.known(a), &self.known(b))?, &self.known(c), 1.0)?
            }
            Operation::Divide(a, b) => {
                let (a, b) = (self.known(a), self.known(b));
                let inverse = match constant(&b) {
                    Some(number) => number_sum(1.0 / number),
                    None => self.letter(Factor::Call(format!("\\frac{{1}}{{{}}}", self.latex(&b)))),
                };
                product(&a, &inverse)?
            }
            Operation::SinCos(a) => {
                let angle = self.known(a);
                self.wave(&angle, Function::Sin)
            }
            Operation::CosineOf(pair) => match self.program.instructions[pair].operation {
                Operation::SinCos(a) => {
                    let angle = self.known(a);
                    self.wave(&angle, Function::Cos)
                }
                _ => unreachable!("a cosine names the instruction that makes its sine"),
            },
            Operation::Call(function, a) => {
                let argument = self.known(a);
                self.function(function, &argument)
            }
        })
    }

    /// The value of an operand as a sum of terms.
    fn known(&mut self, operand: Operand) -> Sum {
        match operand {
            Operand::Value(index) => self.values[index].clone(),
            Operand::Constant(number) => number_sum(number),
            Operand::Input(array, index) => self.letter(Factor::Input(array, index)),
            Operand::Parameter(index) => self.letter(Factor::Parameter(index)),
        }
    }

    /// A sum with one term, which consists of one factor.
    fn letter(&mut self, factor: Factor) -> Sum {
        let powers = vec![(self.number(factor), 1)];
        Sum::from([(Term { powers, ..Term::default() }, Coefficient { value: 1.0, size: 1.0 })])
    }

    fn number(&mut self, factor: Factor) -> usize {
        self.factors.iter().position(|known| *known == factor).unwrap_or_else(|| {
            self.factors.push(factor);
            self.factors.len() - 1
        })
    }

    fn function(&mut self, function: Function, argument: &Sum) -> Sum {
        let inner = self.latex(argument);
        self.letter(Factor::Call(match function {
            Function::Abs => format!("\\left|{inner}\\right|"),
            Function::Sqrt => format!("\\sqrt{{{inner}}}"),
            Function::Sign => format!("\\operatorname{{sign}}\\left({inner}\\right)"),
            _ => format!("\\{}\\left({inner}\\right)", function.name()),
        }))
    }

    /// Sine or cosine of a sum. The result has sines and cosines of `n·y` if the angle has the form
    /// `n·y + φ`; otherwise it is a function call. n are integer multiples of the positions y, and φ is a
    /// constant.
    fn wave(&mut self, angle: &Sum, function: Function) -> Sum {
        let Some((multiples, phase)) = self.multiples(angle) else {
            return self.function(function, angle);
        };
        let (sin, cos) = gelenk_kernels::math::sin_cos(phase);
        // sin(n·y + φ) = cos φ sin(n·y) + sin φ cos(n·y), cos(n·y + φ) = cos φ cos(n·y) − sin φ sin(n·y)
        let (of_sine, of_cosine) = if function == Function::Sin { (cos, sin) } else { (-sin, cos) };
        let mut sum = Sum::new();
        insert(&mut sum, vec![], multiples.clone(), true, Coefficient { value: of_sine, size: 1.0 });
        insert(&mut sum, vec![], multiples, false, Coefficient { value: of_cosine, size: 1.0 });
        sum
    }

    /// Integer multiples n of positions and constant φ of an angle `n·y + φ`; `None` for other angles.
    fn multiples(&self, angle: &Sum) -> Option<(BTreeMap<usize, i32>, f64)> {
        let (mut multiples, mut phase) = (BTreeMap::new(), 0.0);
        for (term, coefficient) in angle {
            match (term.powers.as_slice(), term.multiples.is_empty()) {
                ([], true) => phase = coefficient.value,
                ([(factor, 1)], true) => {
                    let Factor::Input(array, index) = self.factors[*factor] else { return None };
                    let is_small_integer = coefficient.value.fract() == 0.0 && coefficient.value.abs() < 1e6;
                    if self.program.inputs[array].name != "y" || !is_small_integer {
                        return None;
                    }
                    multiples.insert(index, coefficient.value as i32);
                }
                _ => return None,
            }
        }
        Some((multiples, phase))
    }

    fn latex(&self, sum: &Sum) -> String {
        let mut text = String::new();
        for (term, coefficient) in sum {
            let Some(number) = rounded(*coefficient) else { continue };
            let letters = self.letters(term);
            text += match (text.is_empty(), number < 0.0) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => " + ",
                (false, true) => " - ",
            };
            match (number.abs() == 1.0, letters.is_empty()) {
                (true, false) => {}
                (_, true) => text += &latex_number(number.abs()),
                (false, false) => text += &format!("{} \\, ", latex_number(number.abs())),
            }
            text += &letters.join(" \\, ");
        }
        if text.is_empty() { "0".to_owned() } else { text }
    }

    fn letters(&self, term: &Term) -> Vec<String> {
        let power = |&(factor, exponent): &(usize, u32)| match (&self.factors[factor], exponent) {
            (factor, 1) => self.factor(factor),
            (Factor::Call(latex), _) => format!("\\left({latex}\\right)^{{{exponent}}}"),
            (factor, _) => format!("{}^{{{exponent}}}", self.factor(factor)),
        };
        let mut letters: Vec<String> = term.powers.iter().map(power).collect();
        if !term.multiples.is_empty() {
            let mut angle = String::new();
            for (position, multiple) in &term.multiples {
                angle += match (angle.is_empty(), *multiple < 0) {
                    (true, false) => "",
                    (true, true) => "-",
                    (false, false) => " + ",
                    (false, true) => " - ",
                };
                if multiple.abs() != 1 {
                    angle += &format!("{} \\, ", multiple.abs());
                }
                angle += &format!("y_{{{}}}", position + 1);
            }
            let function = if term.is_sine { "sin" } else { "cos" };
            letters.push(format!("\\{function}\\left({angle}\\right)"));
        }
        letters
    }

    fn factor(&self, factor: &Factor) -> String {
        match factor {
            Factor::Call(latex) => latex.clone(),
            Factor::Parameter(index) => latex_letters(&self.notation.parameters[*index]),
            Factor::Input(array, index) => match self.program.inputs[*array].name.as_str() {
                "v" => format!("\\dot{{y}}_{{{}}}", index + 1),
                "a" => format!("\\ddot{{y}}_{{{}}}", index + 1),
                other => latex_letters(&format!("{other}_{}", index + 1)),
            },
        }
    }
}

fn number_sum(number: f64) -> Sum {
    let coefficient = Coefficient { value: number, size: number.abs() };
    if number == 0.0 { Sum::new() } else { Sum::from([(Term::default(), coefficient)]) }
}

/// The value of a sum that is a constant; otherwise `None`.
fn constant(sum: &Sum) -> Option<f64> {
    let (term, coefficient) = sum.first_key_value()?;
    (sum.len() == 1 && *term == Term::default()).then_some(coefficient.value)
}

/// The sum `a + sign · b`; `None` if it has too many terms.
fn added(mut a: Sum, b: &Sum, sign: f64) -> Option<Sum> {
    for (term, coefficient) in b {
        let entry = a.entry(term.clone()).or_default();
        entry.value += sign * coefficient.value;
        entry.size += coefficient.size;
    }
    within_limit(a)
}

fn product(a: &Sum, b: &Sum) -> Option<Sum> {
    let mut sum = Sum::new();
    for (one, first) in a {
        for (other, second) in b {
            let powers = joined(&one.powers, &other.powers);
            let (value, size) = (first.value * second.value, first.size * second.size);
            if one.multiples.is_empty() || other.multiples.is_empty() {
                let wave = if one.multiples.is_empty() { other } else { one };
                let whole = Coefficient { value, size };
                insert(&mut sum, powers, wave.multiples.clone(), wave.is_sine, whole);
                continue;
            }
            let (plus, minus) = (angle(one, other, 1), angle(one, other, -1));
            // cos a cos b and sin a sin b become cosines of a ± b. sin a cos b and cos a sin b become sines
            // of a ± b.
            let is_sine = one.is_sine != other.is_sine;
            let sign_of_plus = if one.is_sine && other.is_sine { -1.0 } else { 1.0 };
            let sign_of_minus = if !one.is_sine && other.is_sine { -1.0 } else { 1.0 };
            let half = |sign: f64| Coefficient { value: 0.5 * sign * value, size: 0.5 * size };
            insert(&mut sum, powers.clone(), plus, is_sine, half(sign_of_plus));
            insert(&mut sum, powers, minus, is_sine, half(sign_of_minus));
        }
        if sum.len() > 4 * MOST_TERMS {
            return None;
        }
    }
    within_limit(sum)
}

/// Removes terms that cancelled in a sum. `None` if too many terms remain.
fn within_limit(mut sum: Sum) -> Option<Sum> {
    sum.retain(|_, coefficient| coefficient.value.abs() > ROUNDING * coefficient.size);
    (sum.len() <= MOST_TERMS).then_some(sum)
}

fn joined(a: &[(usize, u32)], b: &[(usize, u32)]) -> Vec<(usize, u32)> {
    let mut powers: BTreeMap<usize, u32> = a.iter().copied().collect();
    for (factor, exponent) in b {
        *powers.entry(*factor).or_default() += exponent;
    }
    powers.into_iter().collect()
}

fn angle(a: &Term, b: &Term, sign: i32) -> BTreeMap<usize, i32> {
    let mut multiples = a.multiples.clone();
    for (position, multiple) in &b.multiples {
        *multiples.entry(*position).or_default() += sign * multiple;
    }
    multiples
}

/// Adds a term to a sum. The signs of its angle and coefficient are changed so that the first multiple of a
/// position is positive.
fn insert(
    sum: &mut Sum,
    powers: Vec<(usize, u32)>,
    mut multiples: BTreeMap<usize, i32>,
    is_sine: bool,
    mut coefficient: Coefficient,
) {
    multiples.retain(|_, multiple| *multiple != 0);
    if multiples.is_empty() && is_sine {
        return;
    }
    if multiples.values().next().is_some_and(|first| *first < 0) {
        multiples.values_mut().for_each(|multiple| *multiple = -*multiple);
        if is_sine {
            coefficient.value = -coefficient.value;
        }
    }
    let is_sine = is_sine && !multiples.is_empty();
    let entry = sum.entry(Term { powers, multiples, is_sine }).or_default();
    entry.value += coefficient.value;
    entry.size += coefficient.size;
}

/// Rounds a coefficient to its reliable digits; `None` if no digit is reliable.
fn rounded(coefficient: Coefficient) -> Option<f64> {
    let Coefficient { value, size } = coefficient;
    if value.abs() <= ROUNDING * size {
        return None;
    }
    let lost = libm::log10(size / value.abs()).max(0.0).ceil() as i32;
    let digits = (DIGITS - lost).clamp(1, DIGITS);
    format!("{value:.*e}", (digits - 1) as usize).parse().ok()
}
