//! Programs that call the functions of a module as standard input asks for, in Rust and in C.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use super::lanes::{self, Lanes};
use gelenk_codegen::emit::{Scalar, SourceFile};
use gelenk_codegen::functions::function::ConstantValue;
use gelenk_codegen::functions::position_functions::{PositionFunction, extents};
use gelenk_codegen::layout::{Dimension, Extent};
use gelenk_codegen::module::Module;
use gelenk_codegen::program::Shape;
use gelenk_tests::table;

/// How a function is called: its name, the lengths of its inputs, and those of its results.
pub struct Face {
    name: String,
    /// The number by value among the inputs, a sample time.
    inputs: Vec<Input>,
    results: Results,
}

#[derive(Clone, Copy)]
enum Input {
    Array(usize),
    /// Position entries, which may hold quaternions.
    Positions(usize),
    Period,
}

enum Results {
    /// One number, which is returned.
    Number,
    /// Entries of each result.
    Arrays(Vec<usize>),
    /// The only argument is changed, with this number of entries; a truth value is returned.
    InPlace(usize),
}

impl Results {
    fn entries(&self) -> usize {
        match self {
            Self::Number => 1,
            Self::Arrays(results) => results.iter().sum(),
            Self::InPlace(entries) => entries + 1,
        }
    }
}

impl Face {
    /// The function over eight states, where there is one.
    fn lanes(&self, module: &Module, prefix: &str) -> Option<Lanes> {
        let is_there = module.lanes.contains(&self.name);
        is_there.then(|| Lanes {
            function: format!("{prefix}_{}", self.name),
            inputs: self.inputs.iter().map(|input| input.len()).collect(),
            results: match &self.results {
                Results::Arrays(results) => results.clone(),
                Results::Number | Results::InPlace(_) => vec![1],
            },
            is_number: matches!(self.results, Results::Number),
            has_parameters: !module.parameters.is_empty(),
        })
    }

    fn is_of_positions(&self) -> bool {
        PositionFunction::ALL.iter().any(|function| function.name() == self.name)
    }
}

impl Input {
    fn new(extent: &Extent) -> Self {
        match extent.dimension {
            Dimension::Positions => Self::Positions(extent.len),
            _ => Self::Array(extent.len),
        }
    }

    fn len(self) -> usize {
        match self {
            Self::Array(len) | Self::Positions(len) => len,
            Self::Period => 1,
        }
    }
}

/// All functions of a module, in its order.
fn faces(module: &Module) -> Vec<Face> {
    let (n, m) = (module.coordinates, module.inputs);
    let functions = module.functions.iter().map(|function| {
        let outputs = &function.program.outputs;
        let is_number = matches!(outputs.as_slice(), [output] if output.shape == Shape::Scalar);
        let inputs = function.program.inputs.iter();
        Face {
            name: function.name.clone(),
            inputs: inputs.map(|input| Input::new(&input.extent)).collect(),
            results: match is_number {
                true => Results::Number,
                false => Results::Arrays(outputs.iter().map(|output| output.entries.len()).collect()),
            },
        }
    });
    let compositions = module.compositions.iter().map(|each| {
        let results = each.results.iter();
        let entries = results.map(|result| result.extents.iter().map(|extent| extent.len).product());
        Face {
            name: each.composition.name().to_owned(),
            inputs: vec![Input::Positions(module.positions), Input::Array(n), Input::Array(m), Input::Period],
            results: Results::Arrays(entries.collect()),
        }
    });
    functions.chain(compositions).chain(position_faces(module)).collect()
}

/// The functions of positions, of robots with quaternions.
fn position_faces(module: &Module) -> Vec<Face> {
    if !module.has_quaternions() {
        return vec![];
    }
    let face = |function: PositionFunction| {
        let (arguments, results) = (function.arguments(), function.results());
        let lengths = |value| extents(value, module.positions, module.coordinates);
        let entries = |value| lengths(value).iter().map(|extent| extent.len).product();
        Face {
            name: function.name().to_owned(),
            inputs: arguments.iter().flat_map(lengths).map(|extent| Input::new(&extent)).collect(),
            results: match function {
                PositionFunction::Normalize => Results::InPlace(module.positions),
                _ => Results::Arrays(results.iter().map(entries).collect()),
            },
        }
    };
    PositionFunction::ALL.map(face).into()
}

/// The first entry of each quaternion among the positions.
fn quaternions(module: &Module) -> Vec<usize> {
    let indices = |name| {
        let constant = module.constants.iter().find(|constant| constant.name == name);
        match constant.map(|constant| &constant.value) {
            Some(ConstantValue::Indices(_, indices)) => indices.clone(),
            _ => vec![],
        }
    };
    let joints = indices("FIRST_POSITIONS").into_iter().zip(indices("JOINT_POSITIONS"));
    joints.filter(|(_, entries)| *entries > 1).map(|(first, entries)| first + entries - 4).collect()
}

/// Requests to the programs: in each line a function, parameters, and inputs; numbers as bits of their f64.
pub struct Requests {
    faces: Vec<Face>,
    quaternions: Vec<usize>,
    defaults: Vec<f64>,
    text: String,
    functions: Vec<usize>,
}

impl Requests {
    pub fn new(module: &Module) -> Self {
        let defaults = module.parameters.iter().map(|parameter| parameter.default);
        Self {
            faces: faces(module),
            quaternions: quaternions(module),
            defaults: defaults.collect(),
            text: String::new(),
            functions: vec![],
        }
    }

    /// How many functions there are.
    pub fn functions(&self) -> usize {
        self.faces.len()
    }

    /// The function of a request.
    pub fn name(&self, request: usize) -> &str {
        &self.faces[self.functions[request]].name
    }

    /// Tells whether a function is one of positions alone, which costs next to nothing.
    pub fn is_of_positions(&self, function: usize) -> bool {
        self.faces[function].is_of_positions()
    }

    /// Asks for a function once more. Quaternions are of unit length in every second request, and attitudes that are
    /// compared lie near each other in every third one.
    pub fn add(&mut self, function: usize, number: &mut impl FnMut() -> f64) {
        let count = self.functions.len();
        self.functions.push(function);
        let _ = write!(self.text, "{function}");
        let parameters = self.defaults.iter().map(|default| default + 0.1 * number());
        let parameters: Vec<f64> = parameters.map(|x| f64::from(x as f32)).collect();
        let face = &self.faces[function];
        let inputs = face.inputs.iter().map(|input| match input {
            Input::Array(len) | Input::Positions(len) => (0..*len).map(|_| number()).collect(),
            Input::Period => vec![0.125 * (1.0 + number().abs())],
        });
        let mut inputs: Vec<Vec<f64>> = inputs.collect();
        if face.name == PositionFunction::Difference.name() && count.is_multiple_of(3) {
            inputs[1] = inputs[0].iter().map(|x| x + 0.01 * number()).collect();
        }
        let positions = inputs.iter_mut().zip(&face.inputs);
        let positions = positions.filter(|(_, input)| matches!(input, Input::Positions(_)));
        for (positions, _) in positions.filter(|_| count.is_multiple_of(2)) {
            self.quaternions.iter().for_each(|&first| to_unit_length(&mut positions[first..first + 4]));
        }
        let mut numbers = parameters;
        numbers.extend(inputs.concat());
        for x in numbers {
            let _ = write!(self.text, " {}", x.to_bits());
        }
        self.text.push('\n');
    }
}

/// Gives a quaternion unit length, where it has one.
fn to_unit_length(quaternion: &mut [f64]) {
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length.is_normal() {
        quaternion.iter_mut().for_each(|x| *x /= length);
    }
}

/// The program in Rust.
pub fn rust(module: &Module, text: &str) -> String {
    let fields = table::parameters(text);
    let count = fields.len();
    let fields = fields.iter().enumerate().map(|(index, field)| format!("{field}: number(x[{index}])"));
    let fields = fields.collect::<Vec<_>>().join(", ");
    let mut arms = String::new();
    for (index, face) in faces(module).iter().enumerate() {
        let mut at = count;
        let mut arguments: Vec<String> = vec![];
        for input in &face.inputs {
            arguments.push(match input {
                Input::Period => format!("number(x[{at}])"),
                _ => format!("&array(&x[{at}..{}])", at + input.len()),
            });
            at += input.len();
        }
        let _ = match face.results {
            Results::InPlace(entries) => writeln!(
                arms,
                "{index} => {{ let mut r = array(&x[{count}..{}]); let is = robot::{}(&mut r); flat(&(r, f64::from(is))) }}",
                count + entries,
                face.name
            ),
            _ => {
                let has_parameters = count > 0 && !face.is_of_positions();
                arguments.extend(has_parameters.then(|| format!("&robot::Parameters {{ {fields} }}")));
                writeln!(arms, "{index} => flat(&robot::{}({})),", face.name, arguments.join(", "))
            }
        };
    }
    format!(
        r#"
mod flat;
mod robot {{ include!("robot.rs"); }}
use flat::*;
fn call(function: usize, x: &[f64]) -> Vec<f64> {{
    match function {{ {arms} _ => panic!() }}
}}
fn main() {{
    for line in std::io::stdin().lines() {{
        let line = line.unwrap();
        let mut words = line.split(' ').map(|word| word.parse::<u64>().unwrap());
        let function = words.next().unwrap() as usize;
        let x: Vec<f64> = words.map(f64::from_bits).collect();
        let bits = call(function, &x).iter().map(|x| x.to_bits().to_string()).collect::<Vec<_>>();
        println!("{{}}", bits.join(" "));
    }}
}}
"#
    )
}

/// The call of a function with its results printed.
///
/// - `count`: of the free parameters, which stand before the arguments
fn call_in_c(face: &Face, prefix: &str, count: usize) -> String {
    let (mut at, mut arguments) = (count, vec![]);
    for input in &face.inputs {
        match input {
            Input::Period => arguments.push(format!("x[{at}]")),
            _ => arguments.push(format!("&x[{at}]")),
        }
        at += input.len();
    }
    arguments.extend((count > 0 && !face.is_of_positions()).then(|| "&p".to_owned()));
    let function = format!("{prefix}_{}", face.name);
    match &face.results {
        Results::Number => format!("r[0] = {function}({}); print(r, 1);", arguments.join(", ")),
        Results::InPlace(entries) => format!(
            "memcpy(r, &x[{count}], {entries} * sizeof *r); r[{entries}] = {function}(r) ? 1 : 0; print(r, {});",
            entries + 1
        ),
        Results::Arrays(results) => {
            let total = face.results.entries();
            let mut start = 0;
            for len in results {
                arguments.push(format!("&r[{start}]"));
                start += len;
            }
            format!("{function}({}); print(r, {total});", arguments.join(", "))
        }
    }
}

/// The program in C99, also C++. Results hold NaN before a call, so that an entry which is not written shows.
pub fn c(module: &Module, source: &SourceFile, scalar: Scalar) -> String {
    let ty = match scalar {
        Scalar::F64 => "double",
        Scalar::F32 => "float",
    };
    let (prefix, count) = (&source.name, module.parameters.len());
    let mut cases = String::new();
    let mut checks = if module.lanes.is_empty() { String::new() } else { lanes::same(ty) };
    for (index, face) in faces(module).iter().enumerate() {
        let check = format!("lanes_{index}");
        let over_lanes = face.lanes(module, prefix);
        checks.extend(over_lanes.iter().map(|lanes| lanes.check(&check, prefix, ty)));
        let checked = match (over_lanes.is_some(), count) {
            (false, _) => String::new(),
            (true, 0) => format!("{check}(x);"),
            (true, _) => format!("{check}(&x[{count}], &p);"),
        };
        let call = call_in_c(face, prefix, count);
        let _ = writeln!(cases, "    case {index}: {call} {checked} break;");
    }
    let largest = faces(module).iter().map(|face| face.results.entries()).max();
    let parameters = match count {
        0 => String::new(),
        _ => format!("{prefix}_parameters p;\n        memcpy(&p, x, sizeof p);"),
    };
    let room = largest.unwrap_or(0).max(1);
    c_program(ty, &checks, &cases, &parameters, room)
}

/// The text of the program, with room for the results of a call.
fn c_program(ty: &str, checks: &str, cases: &str, parameters: &str, room: usize) -> String {
    format!(
        r#"#include "robot.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static void print(const {ty} *r, int count)
{{
    for (int i = 0; i < count; ++i) {{
        double x = (double)r[i];
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        printf("%s%lu", i ? " " : "", (unsigned long)bits);
    }}
    printf("\n");
}}
{checks}
int main(void)
{{
    static char line[1 << 20];
    static {ty} x[4096], r[{room}];
    while (fgets(line, sizeof line, stdin)) {{
        char *next = line;
        int function = (int)strtoul(next, &next, 10);
        for (int i = 0; *next == ' '; ++i) {{
            uint64_t bits = strtoul(next, &next, 10);
            double number;
            memcpy(&number, &bits, sizeof number);
            x[i] = ({ty})number;
        }}
        memset(r, 0xff, sizeof r);
        {parameters}
        switch (function) {{
{cases}        default: return 1;
        }}
    }}
    return 0;
}}
"#
    )
}

/// The results of each request.
pub fn run(program: &Path, requests: &Requests) -> Vec<Vec<f64>> {
    let mut child =
        Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
    let mut stdin = child.stdin.take().expect("standard input");
    let text = requests.text.clone();
    // In a thread of its own: both pipes may be full.
    let writer = std::thread::spawn(move || stdin.write_all(text.as_bytes()));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("no panic").expect("all is read");
    assert!(output.status.success(), "{}", program.display());
    let text = String::from_utf8(output.stdout).expect("numbers");
    let number = |bits: &str| f64::from_bits(bits.parse().expect("bits"));
    text.lines().map(|line| line.split(' ').filter(|word| !word.is_empty()).map(number).collect()).collect()
}

/// IEEE 754 leaves sign and payload of a NaN open; all other values must agree in every bit.
pub fn assert_same_bits(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        let same = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        assert!(same, "{what}[{index}]: C {a:?}, Rust {b:?}");
    }
}
