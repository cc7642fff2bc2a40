use super::graph::{Node, One, Two};
use super::print;

/// What can be wrong with an expression or its value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExprError {
    /// The text is no expression.
    #[error("character {at}: {why}")]
    Text {
        /// The character at which it stops being one, counted from 1.
        at: usize,
        /// What stands there, and what may.
        why: String,
    },
    /// There is no finite value.
    #[error("{why} in `{part}` at {place}")]
    Value {
        /// What has none, such as "division by zero".
        why: &'static str,
        /// The part of the expression at fault.
        part: String,
        /// The variables, such as `v = 0, t = 0.5`.
        place: String,
    },
    /// Not one value for every variable.
    #[error("got {got} values, the expression has {expected} variables")]
    Values {
        /// Number of values.
        got: usize,
        /// Number of variables.
        expected: usize,
    },
    /// An expression or derivative grows beyond all use.
    #[error("{what} has more than {most} {of}")]
    Size {
        /// The text, the derivative, the sum.
        what: &'static str,
        /// The limit.
        most: usize,
        /// What is counted.
        of: &'static str,
    },
}

/// Longest part of an expression shown in a message, characters.
const SHOWN: usize = 80;

/// The first node without a finite value, in words.
pub fn fault(nodes: &[Node], variables: &[String], slots: &[f64], values: &[f64]) -> ExprError {
    let at = slots.iter().position(|x| !x.is_finite()).unwrap_or(0);
    let slot = |id: u32| slots.get(id as usize).copied().unwrap_or(f64::NAN);
    let why = match nodes.get(at) {
        Some(Node::Variable(_)) => "a value that is not finite",
        Some(Node::Two(Two::Div, _, b)) if slot(*b) == 0.0 => "division by zero",
        Some(Node::Two(Two::Pow, a, b)) if slot(*a) == 0.0 && slot(*b) < 0.0 => "division by zero",
        Some(Node::Two(Two::Pow, a, _)) if slot(*a) < 0.0 && slots[at].is_nan() => {
            "a negative number to a fractional power"
        }
        Some(Node::One(One::Sqrt, _)) => "square root of a negative number",
        Some(Node::One(One::Log, _)) => "logarithm of a number that is not positive",
        Some(Node::One(One::Asin | One::Acos, _)) => "asin or acos outside [-1, 1]",
        _ => "overflow",
    };
    let places: Vec<String> =
        variables.iter().zip(values).map(|(name, x)| format!("{name} = {x}")).collect();
    let part = print::print(&nodes[..=at], variables, SHOWN);
    ExprError::Value { why, part, place: places.join(", ") }
}
