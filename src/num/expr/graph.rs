//! Nodes in an order in which operands come first, equal nodes held once.

use std::collections::HashMap;

/// Place of a node in its graph.
pub type Id = u32;

/// Functions of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum One {
    Neg,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Sqrt,
    Abs,
    Sign,
    Floor,
    Ceil,
}

/// Functions of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Two {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Min,
    Max,
    Atan2,
}

/// One operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    Number(f64),
    Variable(u32),
    One(One, Id),
    Two(Two, Id, Id),
}

impl One {
    /// The value at `x`.
    pub fn at(self, x: f64) -> f64 {
        match self {
            Self::Neg => -x,
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Exp => x.exp(),
            Self::Log => x.ln(),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            // f64::signum is 1 at 0
            Self::Sign => f64::from(i8::from(x > 0.0) - i8::from(x < 0.0)),
            Self::Floor => x.floor(),
            Self::Ceil => x.ceil(),
        }
    }
}

impl Two {
    /// The value at `a`, `b`.
    pub fn at(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Pow => power(a, b),
            Self::Min => a.min(b),
            Self::Max => a.max(b),
            Self::Atan2 => a.atan2(b),
        }
    }
}

fn power(a: f64, b: f64) -> f64 {
    match b {
        2.0 => a * a,
        3.0 => a * a * a,
        _ => a.powf(b),
    }
}

/// Fills `slots` with the value of every node; whether all of them are finite.
///
/// `slots` is as long as `nodes`, and `values` holds every variable.
pub fn run(nodes: &[Node], values: &[f64], slots: &mut [f64]) -> bool {
    let mut finite = true;
    for (i, node) in nodes.iter().enumerate() {
        let x = match *node {
            Node::Number(x) => x,
            Node::Variable(v) => values[v as usize],
            Node::One(f, a) => f.at(slots[a as usize]),
            Node::Two(f, a, b) => f.at(slots[a as usize], slots[b as usize]),
        };
        finite &= x.is_finite();
        slots[i] = x;
    }
    finite
}

/// A growing set of nodes.
#[derive(Default)]
pub struct Graph {
    nodes: Vec<Node>,
    known: HashMap<(u8, u32, u64), Id>,
}

impl Graph {
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The node at a place.
    pub fn node(&self, id: Id) -> Node {
        self.nodes[id as usize]
    }

    /// The place of a node, new or known, as it is.
    pub fn push(&mut self, node: Node) -> Id {
        let key = match node {
            Node::Number(x) => (0, 0, x.to_bits()),
            Node::Variable(v) => (1, v, 0),
            Node::One(f, a) => (2, a, f as u64),
            Node::Two(f, a, b) => (3 + f as u8, a, u64::from(b)),
        };
        let (nodes, next) = (&mut self.nodes, self.known.len() as Id);
        *self.known.entry(key).or_insert_with(|| {
            nodes.push(node);
            next
        })
    }

    /// A constant.
    pub fn number(&mut self, x: f64) -> Id {
        self.push(Node::Number(x))
    }

    /// Its value, when the node is a constant.
    pub fn constant(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Number(x) => Some(x),
            _ => None,
        }
    }

    /// The node, or its value when all operands are constants and it has a finite one.
    pub fn fold(&mut self, node: Node) -> Id {
        let value = match node {
            Node::One(f, a) => self.constant(a).map(|a| f.at(a)),
            Node::Two(f, a, b) => {
                self.constant(a).and_then(|a| self.constant(b).map(|b| f.at(a, b)))
            }
            _ => None,
        };
        match value {
            Some(x) if x.is_finite() => self.number(x),
            _ => self.push(node),
        }
    }

    /// `f(a)`, simplified.
    pub fn one(&mut self, f: One, a: Id) -> Id {
        match (f, self.node(a)) {
            (One::Neg, Node::One(One::Neg, inner)) => inner,
            _ => self.fold(Node::One(f, a)),
        }
    }

    /// `f(a, b)`, simplified by the neutral elements: a factor of zero ends everything it multiplies.
    pub fn two(&mut self, f: Two, a: Id, b: Id) -> Id {
        let (x, y) = (self.constant(a), self.constant(b));
        match (f, x, y) {
            (Two::Add | Two::Sub, _, Some(0.0))
            | (Two::Mul | Two::Div | Two::Pow, _, Some(1.0)) => a,
            (Two::Add, Some(0.0), _) | (Two::Mul, Some(1.0), _) => b,
            (Two::Sub, Some(0.0), _) | (Two::Mul, Some(-1.0), _) => self.one(One::Neg, b),
            (Two::Mul, _, Some(-1.0)) => self.one(One::Neg, a),
            (Two::Mul, Some(0.0), _) | (Two::Mul, _, Some(0.0)) | (Two::Div, Some(0.0), None) => {
                self.number(0.0)
            }
            (Two::Pow, _, Some(0.0)) => self.number(1.0),
            _ => self.fold(Node::Two(f, a, b)),
        }
    }

    /// Copies nodes, each remade by `make` after its operands; the place of the last.
    pub fn copy(&mut self, nodes: &[Node], mut make: impl FnMut(&mut Self, Node) -> Id) -> Id {
        let mut to: Vec<Id> = Vec::with_capacity(nodes.len());
        for &node in nodes {
            let node = match node {
                Node::One(f, a) => Node::One(f, to[a as usize]),
                Node::Two(f, a, b) => Node::Two(f, to[a as usize], to[b as usize]),
                leaf => leaf,
            };
            to.push(make(self, node));
        }
        to.last().copied().unwrap_or_else(|| self.number(0.0))
    }

    /// The nodes that `root` needs, itself last.
    pub fn part(&self, root: Id) -> Vec<Node> {
        self.parts(&[root]).0
    }

    /// The nodes that the roots need, and the places of the roots among them.
    pub fn parts(&self, roots: &[Id]) -> (Vec<Node>, Vec<Id>) {
        let mut needed = vec![false; self.nodes.len()];
        for &r in roots {
            needed[r as usize] = true;
        }
        for (i, node) in self.nodes.iter().enumerate().rev() {
            match *node {
                Node::One(_, a) if needed[i] => needed[a as usize] = true,
                Node::Two(_, a, b) if needed[i] => {
                    needed[a as usize] = true;
                    needed[b as usize] = true;
                }
                _ => {}
            }
        }
        let mut place = vec![0; self.nodes.len()];
        let mut kept = Vec::new();
        for (i, &node) in self.nodes.iter().enumerate().filter(|&(i, _)| needed[i]) {
            place[i] = kept.len() as Id;
            kept.push(match node {
                Node::One(f, a) => Node::One(f, place[a as usize]),
                Node::Two(f, a, b) => Node::Two(f, place[a as usize], place[b as usize]),
                leaf => leaf,
            });
        }
        (kept, roots.iter().map(|&r| place[r as usize]).collect())
    }
}
