//! Expressions: parsed texts before names are resolved.

use super::function::Function;
use std::ops::Range;

/// A parsed text. Names are not resolved, and constants are not folded.
///
/// Each operand has the kind that its operation requires: a number or a truth value.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    /// The outermost operation, with its operands.
    pub node: Node,
    /// Position of the expression in the text, in bytes.
    pub range: Range<usize>,
}

/// One operation of an expression.
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// A finite number as operand.
    Number(f64),
    /// The truth value `true` or `false`.
    Truth(bool),
    /// A name: a parameter, a channel of a log, position or velocity, or `pi`.
    Name(String),
    /// An operation on one operand, for example `-a`.
    Unary(Unary, Box<Expression>),
    /// An operation on two operands, for example `a + b`.
    Binary(Operator, Box<[Expression; 2]>),
    /// The power `pow(a, n)`.
    Power(Box<Expression>, u32),
}

/// Operations on one operand, for example `-a`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unary {
    /// `-a`
    Negate,
    /// `!a`
    Not,
    /// `ln(a)`
    Logarithm,
    /// `f(a)` with an elementary function `f`, for example `sin(a)`
    Call(Function),
}

/// Operations on two operands, for example `a + b`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a * b`
    Multiply,
    /// `a / b`
    Divide,
    /// `min(a, b)`
    Min,
    /// `max(a, b)`
    Max,
    /// `a < b`
    Less,
    /// `a <= b`
    LessEqual,
    /// `a > b`
    Greater,
    /// `a >= b`
    GreaterEqual,
    /// `a == b`
    Equal,
    /// `a != b`
    NotEqual,
    /// `a && b`
    And,
    /// `a || b`
    Or,
}

/// Whether an expression yields a number or a truth value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The expression yields a number.
    Number,
    /// The expression yields a truth value: true or false.
    Truth,
}

impl Expression {
    /// Kind of the expression's value: number or truth value.
    pub fn kind(&self) -> Kind {
        match &self.node {
            Node::Truth(_) => Kind::Truth,
            Node::Unary(operation, _) => operation.kind(),
            Node::Binary(operator, _) => operator.kind(),
            Node::Number(_) | Node::Name(_) | Node::Power(..) => Kind::Number,
        }
    }
}

impl Unary {
    /// Kind of the operand and of the value: a truth value for `!a`, otherwise a number.
    pub fn kind(self) -> Kind {
        if self == Self::Not { Kind::Truth } else { Kind::Number }
    }
}

impl Operator {
    /// Kind of the value: a number for arithmetic, a truth value for comparisons, `&&` and `||`.
    pub fn kind(self) -> Kind {
        match self {
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide | Self::Min | Self::Max => {
                Kind::Number
            }
            _ => Kind::Truth,
        }
    }

    /// Kind of the operands: truth values for `&&` and `||`, otherwise numbers.
    pub fn operands(self) -> Kind {
        if matches!(self, Self::And | Self::Or) { Kind::Truth } else { Kind::Number }
    }
}
