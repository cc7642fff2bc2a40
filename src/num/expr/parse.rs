//! Text to expression, by recursive descent with a depth limit.

use super::ExprError;
use super::graph::{Graph, Id, Node, One, Two};
use crate::num::near::did_you_mean;
use std::f64::consts;

/// Longest text, bytes.
const LONGEST: usize = 4096;
/// Deepest nesting of parentheses, signs and powers.
const DEEPEST: usize = 64;

const ONES: &[(&str, One)] = &[
    ("sin", One::Sin),
    ("cos", One::Cos),
    ("tan", One::Tan),
    ("asin", One::Asin),
    ("acos", One::Acos),
    ("atan", One::Atan),
    ("sinh", One::Sinh),
    ("cosh", One::Cosh),
    ("tanh", One::Tanh),
    ("exp", One::Exp),
    ("log", One::Log),
    ("ln", One::Log),
    ("sqrt", One::Sqrt),
    ("abs", One::Abs),
    ("sign", One::Sign),
    ("floor", One::Floor),
    ("ceil", One::Ceil),
];

const TWOS: &[(&str, Two)] =
    &[("min", Two::Min), ("max", Two::Max), ("atan2", Two::Atan2), ("pow", Two::Pow)];

const CONSTANTS: &[(&str, f64)] = &[("pi", consts::PI), ("tau", consts::TAU), ("e", consts::E)];

/// Names of the functions an expression may call.
pub fn functions() -> impl Iterator<Item = &'static str> {
    ONES.iter().map(|f| f.0).chain(TWOS.iter().map(|f| f.0))
}

pub fn name_of_one(f: One) -> &'static str {
    ONES.iter().find(|(_, g)| *g == f).map_or("-", |(name, _)| name)
}

pub fn name_of_two(f: Two) -> &'static str {
    TWOS.iter().find(|(_, g)| *g == f).map_or("?", |(name, _)| name)
}

#[derive(Clone, Copy, PartialEq)]
enum Token<'a> {
    Number(f64),
    Name(&'a str),
    Sign(char),
    End,
}

struct Parser<'a> {
    text: &'a str,
    names: &'a [&'a str],
    /// Byte at which the token ahead starts, and where it ends.
    start: usize,
    end: usize,
    ahead: Token<'a>,
    graph: Graph,
    depth: usize,
}

/// The expression as a graph, and its root.
pub fn parse(text: &str, names: &[&str]) -> Result<(Graph, Id), ExprError> {
    if text.len() > LONGEST {
        return Err(ExprError::Size { what: "the text", most: LONGEST, of: "bytes" });
    }
    let mut parser = Parser {
        text,
        names,
        start: 0,
        end: 0,
        ahead: Token::End,
        graph: Graph::default(),
        depth: 0,
    };
    parser.advance()?;
    let root = parser.sum()?;
    match parser.ahead {
        Token::End => Ok((parser.graph, root)),
        Token::Sign(')') => Err(parser.wrong("`)` without a `(` before it")),
        _ => {
            let found = parser.found();
            let hint = match parser.ahead {
                Token::Name(_) | Token::Sign('(') => "; a product is written with `*`",
                _ => "",
            };
            Err(parser.wrong(format!("expected an operator, found {found}{hint}")))
        }
    }
}

impl<'a> Parser<'a> {
    fn wrong(&self, why: impl Into<String>) -> ExprError {
        let before = self.text.get(..self.start).unwrap_or(self.text);
        ExprError::Text { at: before.chars().count() + 1, why: why.into() }
    }

    /// The token ahead, for a message.
    fn found(&self) -> String {
        match self.ahead {
            Token::End => "the end".into(),
            _ => format!("`{}`", self.text.get(self.start..self.end).unwrap_or("")),
        }
    }

    fn advance(&mut self) -> Result<(), ExprError> {
        let rest = self.text.get(self.end..).unwrap_or("");
        let trimmed = rest.trim_start();
        self.start = self.end + rest.len() - trimmed.len();
        self.end = self.start;
        let Some(first) = trimmed.chars().next() else {
            self.ahead = Token::End;
            return Ok(());
        };
        let (token, length) = if first.is_ascii_digit() || first == '.' {
            let length = number_length(trimmed.as_bytes());
            self.end = self.start + length.max(1);
            let text = &trimmed[..length];
            match text.parse::<f64>() {
                Ok(x) if x.is_finite() => (Token::Number(x), length),
                _ => return Err(self.wrong(format!("`{text}` is no number"))),
            }
        } else if first.is_alphabetic() || first == '_' {
            let name = |c: char| !(c.is_alphanumeric() || c == '_');
            let length = trimmed.find(name).unwrap_or(trimmed.len());
            (Token::Name(&trimmed[..length]), length)
        } else if "+-*/^(),".contains(first) {
            if trimmed.starts_with("**") {
                return Err(self.wrong("`**` is no operator; a power is written `^`"));
            }
            (Token::Sign(first), 1)
        } else {
            return Err(self.wrong(format!("`{first}` means nothing in an expression")));
        };
        self.ahead = token;
        self.end = self.start + length;
        Ok(())
    }

    /// Whether the sign was ahead; it is then passed.
    fn take(&mut self, sign: char) -> Result<bool, ExprError> {
        let there = self.ahead == Token::Sign(sign);
        if there {
            self.advance()?;
        }
        Ok(there)
    }

    fn expect(&mut self, sign: char, after: &str) -> Result<(), ExprError> {
        if self.take(sign)? {
            return Ok(());
        }
        let found = self.found();
        Err(self.wrong(format!("expected `{sign}` after {after}, found {found}")))
    }

    /// `product (+ product | - product)*`
    fn sum(&mut self) -> Result<Id, ExprError> {
        let mut left = self.product()?;
        loop {
            let f = match self.ahead {
                Token::Sign('+') => Two::Add,
                Token::Sign('-') => Two::Sub,
                _ => return Ok(left),
            };
            self.advance()?;
            let right = self.product()?;
            left = self.graph.push(Node::Two(f, left, right));
        }
    }

    /// `factor (* factor | / factor)*`
    fn product(&mut self) -> Result<Id, ExprError> {
        let mut left = self.factor()?;
        loop {
            let f = match self.ahead {
                Token::Sign('*') => Two::Mul,
                Token::Sign('/') => Two::Div,
                _ => return Ok(left),
            };
            self.advance()?;
            let right = self.factor()?;
            left = self.graph.push(Node::Two(f, left, right));
        }
    }

    /// `- factor | + factor | atom (^ factor)?`; every nesting passes here, so here it is counted.
    fn factor(&mut self) -> Result<Id, ExprError> {
        if self.depth == DEEPEST {
            return Err(self.wrong(format!("nested deeper than {DEEPEST} levels")));
        }
        self.depth += 1;
        let id = if self.take('-')? {
            let inner = self.factor()?;
            self.graph.push(Node::One(One::Neg, inner))
        } else if self.take('+')? {
            self.factor()?
        } else {
            let base = self.atom()?;
            if self.take('^')? {
                let exponent = self.factor()?;
                self.graph.push(Node::Two(Two::Pow, base, exponent))
            } else {
                base
            }
        };
        self.depth -= 1;
        Ok(id)
    }

    /// A number, a name, a call, or a sum in parentheses.
    fn atom(&mut self) -> Result<Id, ExprError> {
        match self.ahead {
            Token::Number(x) => {
                self.advance()?;
                Ok(self.graph.number(x))
            }
            Token::Name(name) => self.name(name),
            Token::Sign('(') => {
                self.advance()?;
                let inner = self.sum()?;
                self.expect(')', "the parenthesis")?;
                Ok(inner)
            }
            _ => {
                let found = self.found();
                Err(self.wrong(format!("expected a number, a name or `(`, found {found}")))
            }
        }
    }

    fn name(&mut self, name: &'a str) -> Result<Id, ExprError> {
        let (start, end) = (self.start, self.end);
        self.advance()?;
        let called = self.ahead == Token::Sign('(');
        // an error here is about the name, not about what follows it
        let about = (self.start, self.end);
        if called && let Some(&(_, f)) = ONES.iter().find(|f| f.0 == name) {
            let [a] = self.arguments(name)?;
            return Ok(self.graph.push(Node::One(f, a)));
        }
        if called && let Some(&(_, f)) = TWOS.iter().find(|f| f.0 == name) {
            let [a, b] = self.arguments(name)?;
            return Ok(self.graph.push(Node::Two(f, a, b)));
        }
        if !called && let Some(v) = self.names.iter().position(|&n| n == name) {
            return Ok(self.graph.push(Node::Variable(v as u32)));
        }
        if !called && let Some(&(_, x)) = CONSTANTS.iter().find(|c| c.0 == name) {
            return Ok(self.graph.number(x));
        }
        (self.start, self.end) = (start, end);
        let error = self.wrong(self.unknown(name, called));
        (self.start, self.end) = about;
        Err(error)
    }

    fn unknown(&self, name: &str, called: bool) -> String {
        let values = || self.names.iter().copied().chain(CONSTANTS.iter().map(|c| c.0));
        if called {
            if values().any(|n| n == name) {
                return format!("`{name}` is no function; a product is written `{name}*(...)`");
            }
            return format!("unknown function `{name}`{}", did_you_mean(name, functions()));
        }
        if functions().any(|f| f == name) {
            return format!("`{name}` is a function; write `{name}(...)`");
        }
        let known = self.names.join(", ");
        let hint = did_you_mean(name, values());
        format!("unknown variable `{name}`{hint} (known here: {known})")
    }

    /// `( sum , sum ... )` of exactly N parts.
    fn arguments<const N: usize>(&mut self, name: &str) -> Result<[Id; N], ExprError> {
        self.advance()?;
        let mut parts = [0; N];
        for (i, part) in parts.iter_mut().enumerate() {
            if i > 0 {
                self.expect(',', &format!("argument {i} of `{name}`, which takes {N}"))?;
            }
            *part = self.sum()?;
        }
        if self.ahead == Token::Sign(',') {
            return Err(self.wrong(format!("too many arguments, `{name}` takes {N}")));
        }
        self.expect(')', &format!("the arguments of `{name}`"))?;
        Ok(parts)
    }
}

/// Bytes of the number a text starts with: digits, a point, an exponent only if digits follow it.
fn number_length(text: &[u8]) -> usize {
    let digits = |from: usize| {
        text.get(from..).unwrap_or(&[]).iter().take_while(|b| b.is_ascii_digit()).count()
    };
    let mut n = digits(0);
    if text.get(n) == Some(&b'.') {
        n += 1 + digits(n + 1);
    }
    if matches!(text.get(n), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(n + 1), Some(b'+' | b'-')));
        let power = digits(n + 1 + sign);
        if power > 0 {
            n += 1 + sign + power;
        }
    }
    n
}
