//! Scalars of an expression graph with arithmetic operators, so that algorithms read like their papers.

use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use super::build::Graph;
use super::node::{Edge, Node};
use gelenk_formula::Function;

/// A signed reference to a node, together with its graph.
#[derive(Clone, Copy)]
pub struct Scalar<'g> {
    graph: &'g Graph,
    edge: Edge,
}

impl Graph {
    /// A scalar with a finite constant value.
    pub fn constant(&self, value: f64) -> Scalar<'_> {
        debug_assert!(value.is_finite(), "constants of the graph are finite");
        let edge = self.intern(Node::Constant(value.abs().to_bits()));
        self.scalar(edge.negate_if(value < 0.0))
    }

    /// The scalar for entry `index` of input array `array`.
    pub fn input(&self, array: usize, index: usize) -> Scalar<'_> {
        self.scalar(self.intern(Node::Input(array as u32, index as u32)))
    }

    /// The scalar for the free parameter with this index.
    pub fn parameter(&self, index: usize) -> Scalar<'_> {
        self.scalar(self.intern(Node::Parameter(index as u32)))
    }

    /// The scalar for an edge, which is a signed reference to a node of this graph.
    pub fn scalar(&self, edge: Edge) -> Scalar<'_> {
        Scalar::new(self, edge)
    }
}

impl<'g> Scalar<'g> {
    pub(super) fn new(graph: &'g Graph, edge: Edge) -> Self {
        Self { graph, edge }
    }

    /// The edge: a signed reference to the scalar's node.
    pub fn edge(self) -> Edge {
        self.edge
    }

    /// The graph that owns the scalar's node.
    pub fn graph(self) -> &'g Graph {
        self.graph
    }

    /// A constant of the same graph as this scalar.
    pub fn constant(self, value: f64) -> Self {
        self.graph.constant(value)
    }

    /// The value of a constant; `None` if the scalar is not a constant.
    pub fn value(self) -> Option<f64> {
        self.graph.value(self.edge)
    }

    /// Whether the scalar is the constant 0.
    pub fn is_zero(self) -> bool {
        self.value() == Some(0.0)
    }

    /// The value `f(self)` of an elementary function.
    pub fn call(self, function: Function) -> Self {
        Self::new(self.graph, self.graph.call(function, self.edge))
    }

    /// The quotient `self / divisor`.
    pub fn divided_by(self, divisor: Self) -> Self {
        Self::new(self.graph, self.graph.div(self.edge, divisor.edge))
    }

    /// The square `self · self`.
    pub fn squared(self) -> Self {
        self * self
    }

    /// `self`, or `−self` if `direction` is negative.
    pub fn signed(self, direction: f64) -> Self {
        if direction < 0.0 { -self } else { self }
    }

    /// Suggests a name for this value in generated text.
    pub fn named(self, name: impl FnOnce() -> String) -> Self {
        self.graph.label(self.edge, name);
        self
    }

    /// The constant 0 if the scalar is a constant with a magnitude below `tolerance`, otherwise the scalar.
    pub fn cleaned(self, tolerance: f64) -> Self {
        match self.value() {
            Some(value) if value.abs() < tolerance => self.constant(0.0),
            _ => self,
        }
    }
}

impl Add for Scalar<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.graph, self.graph.add(self.edge, other.edge))
    }
}

impl Sub for Scalar<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl Neg for Scalar<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        let negated = if self.is_zero() { self.edge } else { self.edge.negate_if(true) };
        Self::new(self.graph, negated)
    }
}

impl Mul for Scalar<'_> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.graph, self.graph.mul(self.edge, other.edge))
    }
}

impl Mul<f64> for Scalar<'_> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self * self.constant(factor)
    }
}

impl PartialEq for Scalar<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.edge == other.edge
    }
}

impl fmt::Debug for Scalar<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.value() {
            Some(value) => write!(f, "{value}"),
            None => write!(f, "{}#{}", if self.edge.is_negative() { "-" } else { "" }, self.edge.index()),
        }
    }
}
