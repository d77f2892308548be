//! A robot whose functions are evaluated by the interpreter.

use super::formula::{self, Motion};
use crate::dynamics::load_friction;
use crate::functions::function::Function;
use crate::layout::Dimension;
use crate::model::{Actuator, Body, FollowedCoordinate, Joint, Link, Model};
use crate::program::interpret::interpret;
use gelenk_formula::Formula;
use gelenk_report::SceneSymbol;

/// A robot with its functions. Free parameters have the values of the description.
#[derive(Debug)]
pub(super) struct Robot<'a> {
    pub model: &'a Model,
    pub functions: &'a [Function],
    /// Values of the free parameters in the description.
    pub parameters: Vec<f64>,
    /// Names of the free parameters.
    pub parameter_names: Vec<String>,
    /// Position, velocity and acceleration of each driven joint (with a prescribed motion) on the page.
    driven: Vec<f64>,
}

impl<'a> Robot<'a> {
    pub fn new(model: &'a Model, functions: &'a [Function]) -> Self {
        let parameters = model.parameters.iter();
        Self {
            model,
            functions,
            parameters: parameters.clone().map(|one| one.default).collect(),
            parameter_names: parameters.map(|one| one.name.clone()).collect(),
            driven: vec![0.0; 3 * model.driven.len()],
        }
    }

    /// Symbol of a coordinate: the position of its joint, or the velocity for a joint with a quaternion. Driven
    /// coordinates have indices after the indices of the coordinates.
    pub(super) fn named(&self, coordinate: usize) -> SceneSymbol {
        match coordinate.checked_sub(self.n()) {
            Some(driven) => SceneSymbol::Driven(driven),
            None => match self.model.position_of(coordinate) {
                Some(position) => SceneSymbol::Position(position),
                None => SceneSymbol::Velocity(coordinate),
            },
        }
    }

    /// Symbol of a coordinate's position in LaTeX and as text.
    pub(super) fn symbol(&self, coordinate: usize) -> [String; 2] {
        let (latex, letter, index) = match self.named(coordinate) {
            SceneSymbol::Position(index) => ("y", "y", index),
            SceneSymbol::Velocity(index) => ("\\dot{y}", "v", index),
            SceneSymbol::Driven(index) => ("d", "d", index),
        };
        [format!("{latex}_{{{}}}", index + 1), format!("{letter}{}", index + 1)]
    }

    /// Symbols of the position and the velocity of a coordinate, for example y₂ and ẏ₂.
    pub(super) fn motion(&self, coordinate: usize) -> Motion {
        Motion { letter: 'y', position: self.model.first_position(coordinate) + 1, velocity: coordinate + 1 }
    }

    /// Position `\sum ratio y_i + offset` of a joint that follows coordinates, in LaTeX and as text.
    pub(super) fn followed(&self, terms: &[FollowedCoordinate], offset: f64) -> [String; 2] {
        let mut sums = [String::new(), String::new()];
        let mut add = |is_negative: bool, summand: [String; 2]| {
            for (sum, summand) in sums.iter_mut().zip(summand) {
                *sum += match (sum.is_empty(), is_negative) {
                    (true, false) => "",
                    (true, true) => "-",
                    (false, false) => " + ",
                    (false, true) => " - ",
                };
                *sum += &summand;
            }
        };
        for term in terms {
            let [latex, text] = self.symbol(term.coordinate);
            let ratio = term.ratio.as_number();
            let [by_latex, by_text] = match ratio.map(f64::abs) {
                Some(1.0) => Default::default(),
                Some(size) => [format!("{size}\\,"), format!("{size} ")],
                None => self.formula(&term.ratio).map(|ratio| format!("({ratio}) ")),
            };
            add(ratio.is_some_and(|ratio| ratio < 0.0), [by_latex + latex.as_str(), by_text + text.as_str()]);
        }
        if offset != 0.0 {
            add(offset < 0.0, [offset.abs().to_string(), offset.abs().to_string()]);
        }
        sums
    }

    /// A formula of free parameters in LaTeX and as text.
    pub(super) fn formula(&self, formula: &Formula) -> [String; 2] {
        [
            formula::latex(formula, &self.parameter_names, Motion::numbered('y', 0)),
            formula.text(&self.names()),
        ]
    }

    /// Names of the free parameters, for formulas in LaTeX.
    pub(super) fn names(&self) -> Vec<&str> {
        self.parameter_names.iter().map(String::as_str).collect()
    }

    /// Number of coordinates of the robot.
    pub fn n(&self) -> usize {
        self.model.coordinates.len()
    }

    /// Joints of the coordinates, in the order of the coordinates.
    pub fn joints(&self) -> Vec<&'a Joint> {
        self.model.joints().collect()
    }

    /// Inputs of the robot, in their order.
    pub fn inputs(&self) -> Vec<Actuator<'a>> {
        self.model.inputs().collect()
    }

    /// All bodies of the robot, each with its link.
    pub fn bodies(&self) -> Vec<(&'a Link, &'a Body)> {
        let links = self.model.links.iter();
        links.flat_map(|link| link.bodies.iter().map(move |body| (link, body))).collect()
    }

    /// Value of a formula that depends only on free parameters.
    pub fn value(&self, formula: &Formula) -> f64 {
        formula.evaluate(&self.parameters, 0.0, 0.0)
    }

    /// Values of three formulas that depend only on free parameters.
    pub fn vector(&self, formulas: &[Formula; 3]) -> [f64; 3] {
        formulas.each_ref().map(|formula| self.value(formula))
    }

    /// The generated function with this name; `None` if the robot lacks it.
    pub fn function(&self, name: &str) -> Option<&'a Function> {
        self.functions.iter().find(|function| function.name == name)
    }

    /// Whether the robot has load-dependent friction.
    pub fn has_load_friction(&self) -> bool {
        load_friction::is_there(self.model)
    }

    /// Friction torques at positions and velocities; `None` if the robot lacks the function.
    pub fn friction_torques(&self, positions: &[f64], velocities: &[f64]) -> Option<Vec<f64>> {
        let name = "friction_torques";
        let takes_driven = usize::from(self.takes_driven(self.function(name)?));
        match self.function(name)?.program.inputs.len() - takes_driven {
            1 => self.first(name, &[velocities]),
            _ => self.first(name, &[positions, velocities]),
        }
    }

    /// Results of a function, flat and row-major; `None` if no function has this name or inputs do not fit.
    pub fn call(&self, name: &str, inputs: &[&[f64]]) -> Option<Vec<Vec<f64>>> {
        self.results(self.function(name)?, inputs)
    }

    /// Whether prescribed motions of joints are the last argument of a function.
    fn takes_driven(&self, function: &Function) -> bool {
        let last = function.program.inputs.last();
        !self.driven.is_empty() && last.is_some_and(|input| input.extent.dimension == Dimension::Driven)
    }

    fn results(&self, function: &Function, inputs: &[&[f64]]) -> Option<Vec<Vec<f64>>> {
        let driven: &[&[f64]] = if self.takes_driven(function) { &[&self.driven] } else { &[] };
        let inputs = [inputs, driven].concat();
        interpret(&function.program, &inputs, &self.parameters).ok()
    }

    /// First result of a function, flat and row-major; `None` if no function has this name or inputs do not
    /// fit.
    pub fn first(&self, name: &str, inputs: &[&[f64]]) -> Option<Vec<f64>> {
        self.call(name, inputs)?.into_iter().next()
    }
}
