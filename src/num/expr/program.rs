use super::graph::{self, Graph, Id, Node};
use super::{Expr, ExprError, error};

/// Several expressions over the same variables, evaluated together; what they share is done once.
#[derive(Clone, Debug)]
pub struct Program {
    nodes: Vec<Node>,
    roots: Vec<Id>,
    variables: Vec<String>,
}

impl Program {
    /// The expressions, which have the same variables.
    pub fn new(expressions: &[Expr]) -> Self {
        let mut all = Graph::default();
        let roots: Vec<Id> =
            expressions.iter().map(|e| all.copy(&e.nodes, |g, node| g.push(node))).collect();
        let (nodes, roots) = all.parts(&roots);
        let variables = expressions.first().map_or_else(Vec::new, |e| e.variables.to_vec());
        Self { nodes, roots, variables }
    }

    /// Number of expressions.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
    }

    /// The values of all expressions, in order, into `out`; `scratch` is reused between calls.
    ///
    /// # Errors
    /// As [`Expr::eval`].
    pub fn eval(
        &self,
        values: &[f64],
        scratch: &mut Vec<f64>,
        out: &mut Vec<f64>,
    ) -> Result<(), ExprError> {
        if values.len() != self.variables.len() {
            let (got, expected) = (values.len(), self.variables.len());
            return Err(ExprError::Values { got, expected });
        }
        scratch.resize(self.nodes.len(), 0.0);
        if !graph::run(&self.nodes, values, scratch) {
            return Err(error::fault(&self.nodes, &self.variables, scratch, values));
        }
        out.clear();
        out.extend(self.roots.iter().map(|&r| scratch[r as usize]));
        Ok(())
    }
}
