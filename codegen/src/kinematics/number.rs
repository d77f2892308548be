//! Number types of mechanisms: scalars of a graph, or values without a graph.

use std::fmt;

use crate::graph::{Edge, Graph, Nodes, Scalar};

/// A type of numbers for mechanisms: [`Scalar`] or [`Number`].
pub trait Numbers: Copy {
    /// Owner of the formulas: the graph for [`Scalar`], a list of nodes for [`Number`].
    type Graph;
}

/// Scalars of a graph as numbers of a mechanism.
impl<'g> Numbers for Scalar<'g> {
    type Graph = &'g Graph;
}

/// Constants and formulas without a graph as numbers of a mechanism. Formulas refer to the nodes that the
/// mechanism stores.
impl Numbers for Number {
    type Graph = Nodes;
}

/// A number of a mechanism without a graph.
#[derive(Clone, Copy, PartialEq)]
pub enum Number {
    /// A number that depends on no parameter.
    Constant(f64),
    /// A formula of free parameters, as an edge to a node of the mechanism.
    Formula(Edge),
}

impl Number {
    /// The value of a constant; `None` for a formula.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(value),
            Self::Formula(_) => None,
        }
    }
}

impl From<Scalar<'_>> for Number {
    fn from(scalar: Scalar<'_>) -> Self {
        scalar.value().map_or(Self::Formula(scalar.edge()), Self::Constant)
    }
}

impl fmt::Debug for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(value) => write!(f, "{value}"),
            Self::Formula(edge) => {
                write!(f, "{}#{}", if edge.is_negative() { "-" } else { "" }, edge.index())
            }
        }
    }
}
