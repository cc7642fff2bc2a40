//! Arithmetic expressions over named variables: read from text, evaluated, differentiated exactly.
//!
//! ```
//! use fieldgraft::num::Expr;
//! let f = Expr::parse("1.5*exp(-t)*sin(v)^2", &["v", "t"])?;
//! let fv = f.derivative(0)?;
//! assert_eq!(f.eval(&[0.0, 0.0])?, 0.0);
//! assert!((fv.eval(&[0.5, 1.0])? - 1.5 * (-1.0f64).exp() * 1.0f64.sin()).abs() < 1e-15);
//! # Ok::<(), fieldgraft::num::ExprError>(())
//! ```
//!
//! Operators `+ - * / ^` (`^` binds tightest and to the right, so `-2^2` is -4), parentheses, the
//! constants `pi`, `tau` and `e`, and the functions of [`functions`]. Angles are radians and `log`
//! is the natural logarithm. Nothing else can be reached from an expression.

mod derive;
mod error;
mod graph;
mod parse;
mod print;
mod program;
mod terms;
#[cfg(test)]
mod tests;

pub use error::ExprError;
pub use parse::functions;
pub use program::Program;
pub use terms::{Sums, sums};

use graph::{Graph, Id, Node};
use std::sync::Arc;

/// An expression over a fixed list of variables.
///
/// Shared parts are held once, so that derivatives stay small.
#[derive(Clone, Debug)]
pub struct Expr {
    nodes: Arc<[Node]>,
    variables: Arc<[String]>,
}

impl Expr {
    /// The expression in `text`, where the names in `variables` may stand.
    ///
    /// # Errors
    /// The character (counted from 1) at which the text stops being an expression, and why.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, ExprError> {
        let (graph, root) = parse::parse(text, variables)?;
        let variables = variables.iter().map(|&v| v.to_owned()).collect();
        Ok(Self { nodes: graph.part(root).into(), variables })
    }

    /// A number that depends on none of the variables.
    pub fn number(value: f64, variables: &[&str]) -> Self {
        let variables = variables.iter().map(|&v| v.to_owned()).collect();
        Self { nodes: Arc::new([Node::Number(value)]), variables }
    }

    /// The names of the variables, in the order in which values are given.
    pub fn variables(&self) -> &[String] {
        &self.variables
    }

    /// The value at the given variables, in their order.
    ///
    /// # Errors
    /// A value that does not exist or is not finite on the way there (a division by zero, the root
    /// of a negative number), or the wrong number of values.
    pub fn eval(&self, values: &[f64]) -> Result<f64, ExprError> {
        if values.len() != self.variables.len() {
            let (got, expected) = (values.len(), self.variables.len());
            return Err(ExprError::Values { got, expected });
        }
        let mut small = [0.0; 48];
        let mut large = Vec::new();
        let slots = match small.get_mut(..self.nodes.len()) {
            Some(slots) => slots,
            None => {
                large.resize(self.nodes.len(), 0.0);
                &mut large[..]
            }
        };
        if graph::run(&self.nodes, values, slots) {
            return Ok(slots.last().copied().unwrap_or(0.0));
        }
        Err(self.fault(slots, values))
    }

    /// The exact partial derivative by a variable, given by its place in the list.
    ///
    /// Where the function has a corner (`abs`, `min`, `max`) it is the mean of both sides; steps
    /// (`sign`, `floor`, `ceil`) count as flat.
    ///
    /// # Errors
    /// When the derivative has more than [`MOST`] operations.
    pub fn derivative(&self, variable: usize) -> Result<Self, ExprError> {
        let (graph, root) = derive::derivative(&self.nodes, variable)?;
        Ok(self.like(&graph, root))
    }

    /// The same expression with a variable held at a value; it stays in the list of variables.
    #[must_use]
    pub fn with(&self, variable: usize, value: f64) -> Self {
        let mut graph = Graph::default();
        let root = graph.copy(&self.nodes, |g, node| match node {
            Node::Variable(v) if v as usize == variable => g.number(value),
            node => g.fold(node),
        });
        self.like(&graph, root)
    }

    /// Whether the variable occurs.
    pub fn depends_on(&self, variable: usize) -> bool {
        self.nodes.iter().any(|n| matches!(n, Node::Variable(v) if *v as usize == variable))
    }

    /// The value, when the expression is a bare number.
    pub fn as_number(&self) -> Option<f64> {
        match *self.nodes {
            [Node::Number(value)] => Some(value),
            _ => None,
        }
    }

    fn like(&self, graph: &Graph, root: Id) -> Self {
        Self { nodes: graph.part(root).into(), variables: self.variables.clone() }
    }

    /// What went wrong in a failed run.
    fn fault(&self, slots: &[f64], values: &[f64]) -> ExprError {
        error::fault(&self.nodes, &self.variables, slots, values)
    }
}

/// Most operations an expression or a derivative may have.
///
/// Far above the fourth derivative of anything written by hand; each further derivative of a long
/// text multiplies its size.
pub const MOST: usize = 200_000;
