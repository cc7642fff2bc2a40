//! The methods that can be compared: a name and what it changes of a recipe's `[morph]`.

use crate::recipe::{
    BlendEntry, InnerEntry, MethodEntry, MorphEntry, PlainOr, Recipe, WeightingKind, did_you_mean,
};
use crate::scene::applies;

/// A method to compare.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Its name: that of the recipe's method, and after a colon what differs from its default.
    pub name: &'static str,
    /// What it is, in a line.
    pub says: &'static str,
    change: fn(&mut MorphEntry),
}

/// A name of a method and the `[morph]` it stands for.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The name.
    pub name: String,
    /// What it is, in a line.
    pub says: String,
    /// The recipe's `[morph]` with this method.
    pub entry: MorphEntry,
}

/// The recipe's own `[morph]`, as it stands.
pub const OWN: &str = "recipe";
const OWN_SAYS: &str = "[morph] of the recipe as it stands";

/// Offset of `graft:paper` where the recipe has none, mm.
const PAPER_OFFSET: f64 = 4.0;

/// Every method there is, in the order of the rows.
pub const METHODS: &[Method] = &[
    Method {
        name: "linear",
        says: "weighted mean of the signed distances (paper 001, eq. 2)",
        change: |m| plain(m, MethodEntry::Linear),
    },
    Method {
        name: "space-time",
        says: "bounded blending in space-time, its height chosen so that the volume is kept",
        change: |m| plain(m, MethodEntry::SpaceTime),
    },
    Method {
        name: "feature-volume",
        says: "fields averaged feature by feature, inverse-square weights (Lerios 1995)",
        change: |m| plain(m, MethodEntry::FeatureVolume),
    },
    Method {
        name: "graft:fields",
        says: "paper 001, eq. 1 with eq. 5 and linear inside",
        change: |m| fields(m, InnerEntry::Linear),
    },
    Method {
        name: "graft:fields-space-time",
        says: "paper 001, eq. 1 with eq. 5 and space-time blending inside",
        change: |m| fields(m, InnerEntry::SpaceTime),
    },
    Method {
        name: "graft:paper",
        says: "Figure 7 d of paper 001: eq. 1, space-time blending and local offsets (the \
               recipe's, or 4 mm)",
        change: |m| {
            fields(m, InnerEntry::SpaceTime);
            m.offset = m.offset.or(Some(PAPER_OFFSET));
        },
    },
    Method {
        name: "graft",
        says: "positions blended, the lesser shape grows out of the dominant one",
        change: |m| maps(m, InnerEntry::Grow),
    },
    Method {
        name: "graft:erode",
        says: "positions blended, the lesser shape shrinks towards the dominant one",
        change: |m| maps(m, InnerEntry::Erode),
    },
    Method {
        name: "auto",
        says: "positions blended; what each part does is chosen by a search, and parts are found \
               where the recipe has no features",
        change: |m| plain(m, MethodEntry::Auto),
    },
    Method {
        name: "level-set",
        says: "the source's surface moves into the target's (Breen and Whitaker 2001)",
        change: |m| plain(m, MethodEntry::LevelSet),
    },
    Method {
        name: "transport",
        says: "matter is moved over the shortest way (Solomon et al. 2015)",
        change: |m| plain(m, MethodEntry::Transport),
    },
    Method {
        name: "warp",
        says: "shapes are pulled onto common anchors and averaged (Cohen-Or et al. 1998)",
        change: |m| plain(m, MethodEntry::Warp),
    },
    Method {
        name: "pde-boundary",
        says: "paper 000, method A: the curves are blended and the equation solved again",
        change: |m| plain(m, MethodEntry::PdeBoundary),
    },
    Method {
        name: "pde-modes",
        says: "paper 000, method B: the modes of one fade out, those of the other in",
        change: |m| plain(m, MethodEntry::PdeModes),
    },
    Method {
        name: "pde-combined",
        says: "paper 000, method C: the curves at the ends are blended, modes elsewhere",
        change: |m| plain(m, MethodEntry::PdeCombined),
    },
    Method {
        name: "pde-spine",
        says: "paper 000, method D: the spines are blended, then what stands on them",
        change: |m| plain(m, MethodEntry::PdeSpine),
    },
    Method {
        name: "nurbs-linear",
        says: "paper 003: the mean of the points of two rational B-splines",
        change: |m| plain(m, MethodEntry::NurbsLinear),
    },
    Method {
        name: "nurbs-weighted",
        says: "paper 003: the mean of the points by their masses",
        change: |m| plain(m, MethodEntry::NurbsWeighted),
    },
];

fn plain(m: &mut MorphEntry, method: MethodEntry) {
    m.method = Some(method);
    (m.blend, m.inner) = (None, None);
}

/// Two shapes are grafted, more are a group.
fn grafted(m: &mut MorphEntry, blend: BlendEntry, inner: InnerEntry) {
    let pair = m.between.is_some() || m.among.as_ref().is_some_and(|a| a.len() == 2);
    m.method = Some(if pair { MethodEntry::Graft } else { MethodEntry::Group });
    (m.blend, m.inner) = (Some(blend), Some(inner));
}

fn maps(m: &mut MorphEntry, inner: InnerEntry) {
    grafted(m, BlendEntry::Maps, inner);
}

/// As the paper prints it, unless the recipe names a weighting.
fn fields(m: &mut MorphEntry, inner: InnerEntry) {
    grafted(m, BlendEntry::Fields, inner);
    m.weighting = m.weighting.clone().or(Some(PlainOr::Plain(WeightingKind::Transfinite)));
}

/// The methods asked for, in their order; all that apply to the recipe where none is. `base` is
/// the `[morph]` that they change.
///
/// # Errors
/// A name that is none, with the nearest one.
pub fn choose(
    wanted: &[String],
    recipe: &Recipe,
    base: &MorphEntry,
) -> Result<Vec<Chosen>, String> {
    if wanted.is_empty() {
        // parts are sought on meshes and solids only
        let surfaces = recipe.shapes.values().any(|s| s.surface.is_some());
        let applies = |c: &Chosen| {
            let auto = c.entry.method == Some(MethodEntry::Auto);
            !(auto && surfaces) && applies(&c.entry, recipe, "morph").is_ok()
        };
        return Ok(METHODS.iter().map(|m| m.chosen(base)).filter(applies).collect());
    }
    let mut all: Vec<Chosen> = Vec::with_capacity(wanted.len());
    for name in wanted {
        if all.iter().any(|c| c.name == *name) {
            continue;
        }
        all.push(match METHODS.iter().find(|m| m.name == name) {
            Some(method) => method.chosen(base),
            None if name == OWN => {
                Chosen { name: OWN.into(), says: OWN_SAYS.into(), entry: base.clone() }
            }
            None => {
                let names = METHODS.iter().map(|m| m.name).chain([OWN]);
                let hint = did_you_mean(name, names);
                return Err(format!("no method `{name}`{hint}; `--methods help` lists them"));
            }
        });
    }
    Ok(all)
}

/// All names and what they are, a line each.
pub fn help() -> String {
    let lines = METHODS.iter().map(|m| (m.name, m.says)).chain([(OWN, OWN_SAYS)]);
    lines.map(|(name, says)| format!("{name:<26}{says}\n")).collect()
}

impl Method {
    fn chosen(&self, base: &MorphEntry) -> Chosen {
        let mut entry = base.clone();
        (self.change)(&mut entry);
        Chosen { name: self.name.into(), says: self.says.into(), entry }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_chosen_by_what_is_there_or_by_name() {
        let base = MorphEntry {
            among: Some(["a", "b", "c"].map(str::to_owned).to_vec()),
            ..MorphEntry::default()
        };
        let names = |c: &[Chosen]| c.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
        let plain = choose(&[], &Recipe::default(), &base).unwrap();
        assert_eq!(names(&plain)[..2], ["linear", "space-time"]);
        assert!(!names(&plain).iter().any(|n| n.starts_with("graft")), "no features");
        let wanted = ["graft", "recipe", "graft"].map(str::to_owned);
        let two = choose(&wanted, &Recipe::default(), &base).unwrap();
        assert_eq!(names(&two), ["graft", "recipe"]);
        assert_eq!(two[0].entry.method, Some(MethodEntry::Group), "three shapes");
        let e = choose(&["graft:erod".to_owned()], &Recipe::default(), &base).unwrap_err();
        assert!(e.contains("did you mean `graft:erode`?"), "{e}");
        assert!(METHODS.iter().all(|m| help().contains(m.name)));
    }
}
