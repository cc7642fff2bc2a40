//! Expressions as text that reads back as the same expression.

use super::Expr;
use super::graph::{Id, Node, One, Two};
use super::parse;
use std::fmt::{self, Display, Write};

/// How tightly a form binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Sum,
    Product,
    Sign,
    Power,
    Atom,
}

enum Piece {
    Text(&'static str),
    /// A node where at least this level is needed.
    Node(Id, Level),
}

/// Longest text of an expression, characters; a derivative written out can be far longer than it is.
const LONGEST: usize = 100_000;

impl Display for Expr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&print(&self.nodes, &self.variables, LONGEST))
    }
}

/// The last node as text, cut off with an ellipsis after about `most` characters.
pub fn print(nodes: &[Node], variables: &[String], most: usize) -> String {
    let mut out = String::new();
    let Some(last) = nodes.len().checked_sub(1) else { return out };
    let mut todo = vec![Piece::Node(last as Id, Level::Sum)];
    while let Some(piece) = todo.pop() {
        if out.len() > most {
            out.push('…');
            break;
        }
        match piece {
            Piece::Text(text) => out.push_str(text),
            Piece::Node(id, needed) => {
                let node = nodes[id as usize];
                let level = level(node);
                if level < needed {
                    out.push('(');
                    todo.push(Piece::Text(")"));
                }
                open(node, variables, &mut out, &mut todo);
            }
        }
    }
    out
}

fn level(node: Node) -> Level {
    match node {
        Node::Two(Two::Add | Two::Sub, ..) => Level::Sum,
        Node::Two(Two::Mul | Two::Div, ..) => Level::Product,
        Node::One(One::Neg, _) => Level::Sign,
        Node::Number(x) if x.is_sign_negative() => Level::Sign,
        Node::Two(Two::Pow, ..) => Level::Power,
        _ => Level::Atom,
    }
}

/// Writes what comes first of a node, and stacks the rest, last piece first.
fn open(node: Node, variables: &[String], out: &mut String, todo: &mut Vec<Piece>) {
    match node {
        Node::Number(x) => {
            let text = format!("{x:?}");
            out.push_str(text.strip_suffix(".0").unwrap_or(&text));
        }
        Node::Variable(v) => out.push_str(variables.get(v as usize).map_or("?", String::as_str)),
        Node::One(One::Neg, a) => {
            out.push('-');
            todo.push(Piece::Node(a, Level::Sign));
        }
        Node::One(f, a) => {
            let _ = write!(out, "{}(", parse::name_of_one(f));
            todo.extend([Piece::Text(")"), Piece::Node(a, Level::Sum)]);
        }
        Node::Two(f, a, b) => {
            let (left, sign, right) = match f {
                Two::Add => (Level::Sum, " + ", Level::Product),
                Two::Sub => (Level::Sum, " - ", Level::Product),
                Two::Mul => (Level::Product, "*", Level::Sign),
                Two::Div => (Level::Product, "/", Level::Sign),
                Two::Pow => (Level::Atom, "^", Level::Sign),
                Two::Min | Two::Max | Two::Atan2 => {
                    let _ = write!(out, "{}(", parse::name_of_two(f));
                    let end = [Piece::Text(")"), Piece::Node(b, Level::Sum), Piece::Text(", ")];
                    todo.extend(end);
                    todo.push(Piece::Node(a, Level::Sum));
                    return;
                }
            };
            todo.extend([Piece::Node(b, right), Piece::Text(sign), Piece::Node(a, left)]);
        }
    }
}
