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

    /// The values of all expressions, in order, into `out`, one place each.
    ///
    /// # Errors
    /// As [`Expr::eval`].
    pub fn eval(&self, values: &[f64], out: &mut [f64]) -> Result<(), ExprError> {
        for (got, expected) in [(values.len(), self.variables.len()), (out.len(), self.roots.len())]
        {
            if got != expected {
                return Err(ExprError::Values { got, expected });
            }
        }
        graph::with_slots(self.nodes.len(), |slots| {
            if !graph::run(&self.nodes, values, slots) {
                return Err(error::fault(&self.nodes, &self.variables, slots, values));
            }
            for (x, &r) in out.iter_mut().zip(&self.roots) {
                *x = slots[r as usize];
            }
            Ok(())
        })
    }
}
