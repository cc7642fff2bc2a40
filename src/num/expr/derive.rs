//! Symbolic differentiation, node by node: linear in the size of the expression.

use super::graph::{Graph, Id, Node, One, Two};
use super::{ExprError, MOST};

/// The derivative of the last node by a variable.
pub fn derivative(nodes: &[Node], variable: usize) -> Result<(Graph, Id), ExprError> {
    let mut g = Graph::default();
    let (mut here, mut slope): (Vec<Id>, Vec<Id>) = (Vec::new(), Vec::new());
    for &node in nodes {
        let (x, dx) = match node {
            Node::Number(_) => (g.push(node), g.number(0.0)),
            Node::Variable(v) => {
                (g.push(node), g.number(if v as usize == variable { 1.0 } else { 0.0 }))
            }
            Node::One(f, a) => {
                let (a, da) = (here[a as usize], slope[a as usize]);
                let x = g.push(Node::One(f, a));
                (x, chain(&mut g, f, [a, x], da))
            }
            Node::Two(f, a, b) => {
                let (i, j) = (a as usize, b as usize);
                let x = g.push(Node::Two(f, here[i], here[j]));
                (x, pair(&mut g, f, [here[i], here[j], x], [slope[i], slope[j]]))
            }
        };
        here.push(x);
        slope.push(dx);
        if g.len() > MOST {
            return Err(ExprError::Size { what: "the derivative", most: MOST, of: "operations" });
        }
    }
    let root = slope.last().copied().unwrap_or_else(|| g.number(0.0));
    Ok((g, root))
}

/// `f'(a) da`, where `x` is `f(a)`.
fn chain(g: &mut Graph, f: One, [a, x]: [Id; 2], da: Id) -> Id {
    if g.constant(da) == Some(0.0) {
        return da;
    }
    let factor = match f {
        One::Neg => return g.one(One::Neg, da),
        One::Sin => g.one(One::Cos, a),
        One::Cos => {
            let s = g.one(One::Sin, a);
            g.one(One::Neg, s)
        }
        One::Tan => {
            let square = g.two(Two::Mul, x, x);
            one_plus(g, square)
        }
        One::Asin | One::Acos => {
            let square = g.two(Two::Mul, a, a);
            let one = g.number(1.0);
            let inner = g.two(Two::Sub, one, square);
            let root = g.one(One::Sqrt, inner);
            let slope = g.two(Two::Div, da, root);
            return if f == One::Asin { slope } else { g.one(One::Neg, slope) };
        }
        One::Atan => {
            let square = g.two(Two::Mul, a, a);
            let below = one_plus(g, square);
            return g.two(Two::Div, da, below);
        }
        One::Sinh => g.one(One::Cosh, a),
        One::Cosh => g.one(One::Sinh, a),
        One::Tanh => {
            let square = g.two(Two::Mul, x, x);
            let one = g.number(1.0);
            g.two(Two::Sub, one, square)
        }
        One::Exp => x,
        One::Log => return g.two(Two::Div, da, a),
        One::Sqrt => {
            let two = g.number(2.0);
            let below = g.two(Two::Mul, two, x);
            return g.two(Two::Div, da, below);
        }
        One::Abs => g.one(One::Sign, a),
        One::Sign | One::Floor | One::Ceil => g.number(0.0),
    };
    g.two(Two::Mul, factor, da)
}

fn one_plus(g: &mut Graph, x: Id) -> Id {
    let one = g.number(1.0);
    g.two(Two::Add, one, x)
}

/// `f_a(a, b) da + f_b(a, b) db`, where `x` is `f(a, b)`.
fn pair(g: &mut Graph, f: Two, [a, b, x]: [Id; 3], [da, db]: [Id; 2]) -> Id {
    match f {
        Two::Add | Two::Sub => g.two(f, da, db),
        Two::Mul => {
            let (left, right) = (g.two(Two::Mul, da, b), g.two(Two::Mul, a, db));
            g.two(Two::Add, left, right)
        }
        Two::Div => {
            // (a / b)' = (a' - x b') / b
            let back = g.two(Two::Mul, x, db);
            let above = g.two(Two::Sub, da, back);
            g.two(Two::Div, above, b)
        }
        Two::Pow => power(g, [a, b, x], [da, db]),
        Two::Min | Two::Max => extreme(g, f, [a, b], [da, db]),
        Two::Atan2 => {
            let (left, right) = (g.two(Two::Mul, da, b), g.two(Two::Mul, a, db));
            let above = g.two(Two::Sub, left, right);
            let (aa, bb) = (g.two(Two::Mul, a, a), g.two(Two::Mul, b, b));
            let below = g.two(Two::Add, aa, bb);
            g.two(Two::Div, above, below)
        }
    }
}

fn power(g: &mut Graph, [a, b, x]: [Id; 3], [da, db]: [Id; 2]) -> Id {
    let zero = |g: &Graph, id| g.constant(id) == Some(0.0);
    // b a^(b - 1) a', which is right at a = 0 where the logarithm is not
    let by_base = if zero(g, da) {
        da
    } else {
        let one = g.number(1.0);
        let less = g.two(Two::Sub, b, one);
        let power = g.two(Two::Pow, a, less);
        let factor = g.two(Two::Mul, b, power);
        g.two(Two::Mul, factor, da)
    };
    if zero(g, db) {
        return by_base;
    }
    let log = g.one(One::Log, a);
    let growth = g.two(Two::Mul, x, log);
    let by_exponent = g.two(Two::Mul, growth, db);
    g.two(Two::Add, by_base, by_exponent)
}

/// max(a, b)' = (a' + b' + sign(a - b) (a' - b')) / 2, and min with the other sign.
fn extreme(g: &mut Graph, f: Two, [a, b]: [Id; 2], [da, db]: [Id; 2]) -> Id {
    let (gap, sum, turn) =
        (g.two(Two::Sub, a, b), g.two(Two::Add, da, db), g.two(Two::Sub, da, db));
    let side = g.one(One::Sign, gap);
    let swing = g.two(Two::Mul, side, turn);
    let twice = g.two(if f == Two::Max { Two::Add } else { Two::Sub }, sum, swing);
    let half = g.number(0.5);
    g.two(Two::Mul, half, twice)
}
