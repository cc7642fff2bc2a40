//! What a morph is told: weights of the targets, masses, designs. And the design turned into masses.

use super::SurfaceError;
use super::net::{Net, is_mass, place};
use super::wrong;

/// A table of numbers as a net is: a row along u for each step along v.
pub type Rows = Vec<Vec<f64>>;

/// Which average of the targets a morph takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Averaging {
    /// Of the points as they are: all masses are one (the paper's section 3.1).
    Linear,
    /// Of the points with their masses, which by default are the targets' weights (section 3.2).
    #[default]
    Weighted,
}

/// How a morph goes through its targets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphOptions {
    /// Linear or weighted.
    pub averaging: Averaging,
    /// Weights of all targets at equal steps of time, linear between: with the rows [1, 0, 0] and
    /// [0.2, 0.3, 0.5] the morph goes from the first target to a mixture. Empty: from the first
    /// target to the second, for two targets.
    pub weights: Vec<Vec<f64>>,
    /// A factor on the masses of each target: above 1 it is left later, reached earlier (section
    /// 4.1). Empty: all 1.
    pub scale: Vec<f64>,
    /// Masses of each target on the common net (section 4.2), which leave its shape alone. Empty:
    /// its own weights.
    pub masses: Vec<Rows>,
    /// Wanted distances at times of their own.
    pub designs: Vec<Design>,
}

/// The normalised distances that are wanted at a time (the paper's section 4.3).
///
/// They give the masses at this time by eq. 9, in k targets m_i = W R_i / l_i. Before the first and
/// after the last design the masses stay as they are there; between two designs their logarithms
/// are linear in ln(t / (1 - t)), so that a control's distance rises with t whenever the designs'
/// does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Design {
    /// When, above 0 and below 1.
    pub t: f64,
    /// The distance R of each control from the first target, above 0 and below 1. With more than
    /// two targets: the share of each one but the first, which gets what is left.
    pub distance: Vec<Rows>,
    /// The weight W of each control, positive. None: as the morph has it without this design.
    pub weights: Option<Rows>,
}

/// A table as one list, if it has the shape of the net.
pub(super) fn flat(rows: &Rows, net: &Net, key: &str) -> Result<Vec<f64>, SurfaceError> {
    let (width, height) = (net.width(), net.along[1].count());
    if rows.len() != height {
        let why = format!("{} rows; the common net has {height}", rows.len());
        return wrong(key, why);
    }
    if let Some(j) = rows.iter().position(|r| r.len() != width) {
        let why = format!("row has {} numbers; the common net has {width} columns", rows[j].len());
        return wrong(format!("{key}[{j}]"), why);
    }
    Ok(rows.concat())
}

/// A table of masses as one list.
pub(super) fn masses(rows: &Rows, net: &Net, key: &str) -> Result<Vec<f64>, SurfaceError> {
    let list = flat(rows, net, key)?;
    match list.iter().position(|&m| !is_mass(m)) {
        None => Ok(list),
        Some(k) => {
            let at = place(key, k / net.width(), k % net.width());
            wrong(at, format!("mass is {}; expected a positive number", list[k]))
        }
    }
}

/// The shares R_i of all targets, the first included, as lists.
fn shares(design: &Design, nets: &[Net], key: &str) -> Result<Vec<Vec<f64>>, SurfaceError> {
    let net = &nets[0];
    if design.distance.len() + 1 != nets.len() {
        let (have, need) = (design.distance.len(), nets.len() - 1);
        let why = format!("{have} nets of distances; {} targets need {need}", nets.len());
        return wrong(format!("{key}.distance"), why);
    }
    let mut all = vec![vec![1.0; net.poles.len()]];
    for (i, rows) in design.distance.iter().enumerate() {
        // Two targets have a single net of distances, and files no list round it.
        let inner = if nets.len() == 2 { String::new() } else { format!("[{i}]") };
        let key = format!("{key}.distance{inner}");
        let list = flat(rows, net, &key)?;
        for (k, r) in list.iter().enumerate() {
            all[0][k] -= r;
            if !(*r > 0.0 && all[0][k] > 0.0) {
                let why = if nets.len() == 2 {
                    format!("distance is {r}; expected above 0 and below 1")
                } else {
                    format!("share is {r}; all have to be above 0 and their sum below 1")
                };
                return wrong(place(&key, k / net.width(), k % net.width()), why);
            }
        }
        all.push(list);
    }
    Ok(all)
}

/// Masses by inverse design: m_i = W R_i / l_i. `weights` are the l_i at the time of the design,
/// `old` its weights W unless it states its own.
pub(super) fn designed(
    design: &Design,
    nets: &[Net],
    weights: &[f64],
    old: Vec<f64>,
    key: &str,
) -> Result<Vec<Vec<f64>>, SurfaceError> {
    if let Some(i) = weights.iter().position(|l| *l <= 0.0) {
        let why = format!("target {i} has no weight at t = {}; a design needs all", design.t);
        return wrong(format!("{key}.t"), why);
    }
    let total = match &design.weights {
        Some(rows) => masses(rows, &nets[0], &format!("{key}.weights"))?,
        None => old,
    };
    let shares = shares(design, nets, key)?;
    let mut out = vec![];
    for (list, l) in shares.iter().zip(weights) {
        let list: Vec<f64> = list.iter().zip(&total).map(|(r, w)| w * r / l).collect();
        if let Some(k) = list.iter().position(|&m| !is_mass(m)) {
            let at = place(&format!("{key}.distance"), k / nets[0].width(), k % nets[0].width());
            return wrong(at, format!("leads to a mass of {}", list[k]));
        }
        out.push(list);
    }
    Ok(out)
}
