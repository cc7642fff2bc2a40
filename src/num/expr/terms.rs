//! Expressions as sums: a number times a function, and so on.

use super::Expr;
use super::graph::{Graph, Id, Node, One, Two};
use std::collections::HashMap;

/// Most terms one sum is multiplied out into; what would have more stays one function.
const WIDEST: usize = 64;
/// Largest whole power that is multiplied out.
const HIGHEST: f64 = 16.0;

/// Expressions as sums over one list of functions.
#[derive(Clone, Debug)]
pub struct Sums {
    /// The functions, without constant factors, no two alike, in order of appearance.
    pub functions: Vec<Expr>,
    /// For every expression its terms: place of the function, and the number it is multiplied by.
    pub terms: Vec<Vec<(usize, f64)>>,
}

/// Whole powers of nodes, in order of nodes; empty for 1.
type Powers = Vec<(Id, i32)>;
type Sum = Vec<(Powers, f64)>;

/// Multiplies the expressions out into sums: `2*(1 - t)*sin(v)` has the functions `sin(v)` and
/// `t*sin(v)`, with 2 and -2.
///
/// Functions that are equal only by an identity (`sin(-v)` and `sin(v)`) stay apart.
pub fn sums(expressions: &[Expr]) -> Sums {
    let mut graph = Graph::default();
    let mut known: HashMap<Powers, usize> = HashMap::new();
    let mut functions = Vec::new();
    let mut terms = Vec::new();
    for e in expressions {
        let mut row = Vec::new();
        for (powers, factor) in sum(&mut graph, &e.nodes) {
            let place = *known.entry(powers).or_insert_with_key(|powers| {
                let root = product(&mut graph, powers);
                functions.push(e.like(&graph, root));
                functions.len() - 1
            });
            row.push((place, factor));
        }
        terms.push(row);
    }
    Sums { functions, terms }
}

fn sum(g: &mut Graph, nodes: &[Node]) -> Sum {
    let (mut here, mut sums): (Vec<Id>, Vec<Sum>) = (Vec::new(), Vec::new());
    for &node in nodes {
        let (id, sum) = match node {
            Node::Number(_) | Node::Variable(_) => (g.push(node), None),
            Node::One(f, a) => {
                let a = a as usize;
                let sum = (f == One::Neg).then(|| times(&sums[a], &[(Vec::new(), -1.0)]));
                (g.one(f, here[a]), sum.flatten())
            }
            Node::Two(f, a, b) => {
                let (a, b) = (a as usize, b as usize);
                (g.two(f, here[a], here[b]), pair(f, &sums[a], &sums[b]))
            }
        };
        let whole = match g.constant(id) {
            Some(0.0) => Vec::new(),
            Some(x) => vec![(Vec::new(), x)],
            None => sum.unwrap_or_else(|| vec![(vec![(id, 1)], 1.0)]),
        };
        here.push(id);
        sums.push(whole);
    }
    sums.pop().unwrap_or_default()
}

/// The sum for an operation on two sums; nothing where there is none of a useful size.
fn pair(f: Two, a: &Sum, b: &Sum) -> Option<Sum> {
    match f {
        Two::Add => collect(a.iter().chain(b).cloned()),
        Two::Sub => collect(a.iter().cloned().chain(b.iter().map(|(p, x)| (p.clone(), -x)))),
        Two::Mul => times(a, b),
        Two::Div => times(a, &inverse(b)?),
        Two::Pow => match b.as_slice() {
            [] => Some(vec![(Vec::new(), 1.0)]),
            [(p, n)] if p.is_empty() && n.fract() == 0.0 && n.abs() <= HIGHEST => {
                let base = if *n < 0.0 { inverse(a)? } else { a.clone() };
                let one = vec![(Vec::new(), 1.0)];
                (0..n.abs() as u32).try_fold(one, |all, _| times(&all, &base))
            }
            _ => None,
        },
        Two::Min | Two::Max | Two::Atan2 => None,
    }
}

fn inverse(a: &Sum) -> Option<Sum> {
    match a.as_slice() {
        [(powers, x)] if *x != 0.0 => {
            Some(vec![(powers.iter().map(|&(id, n)| (id, -n)).collect(), 1.0 / x)])
        }
        _ => None,
    }
}

fn times(a: &[(Powers, f64)], b: &[(Powers, f64)]) -> Option<Sum> {
    // both are at most WIDEST, so this is bounded before like terms are joined
    collect(a.iter().flat_map(|(p, x)| b.iter().map(move |(q, y)| (joined(p, q), x * y))))
}

fn joined(p: &Powers, q: &Powers) -> Powers {
    let mut all = p.clone();
    for &(id, n) in q {
        match all.binary_search_by_key(&id, |f| f.0) {
            Ok(i) => all[i].1 += n,
            Err(i) => all.insert(i, (id, n)),
        }
    }
    all.retain(|f| f.1 != 0);
    all
}

/// Joins like terms, in order of appearance.
fn collect(terms: impl Iterator<Item = (Powers, f64)>) -> Option<Sum> {
    let mut places: HashMap<Powers, usize> = HashMap::new();
    let mut all: Sum = Vec::new();
    for (powers, x) in terms {
        let place = *places.entry(powers.clone()).or_insert(all.len());
        match all.get_mut(place) {
            Some(term) => term.1 += x,
            None => all.push((powers, x)),
        }
    }
    all.retain(|t| t.1 != 0.0);
    (all.len() <= WIDEST && all.iter().all(|t| t.1.is_finite())).then_some(all)
}

fn product(g: &mut Graph, powers: &Powers) -> Id {
    let mut all = g.number(1.0);
    for &(id, n) in powers {
        let n = g.number(f64::from(n));
        let factor = g.two(Two::Pow, id, n);
        all = g.two(Two::Mul, all, factor);
    }
    all
}
